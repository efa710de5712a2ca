//! `PAIRS`: a folder of images with known depth, of `fit` and `evaluate depth`.

use std::path::Path;

use anyhow::anyhow;
use aquafuse_data::files::display;
use aquafuse_data::pairs::{self, Pair};

use crate::failure::Failure;
use crate::report::output;

/// The pairs in a folder. Refuses a folder without pairs, and names the files that have no partner unless `quiet`.
pub(crate) fn list_pairs(folder: &Path, quiet: bool) -> Result<Vec<Pair>, Failure> {
    let listing = pairs::list(folder).map_err(Failure::usage)?;
    if listing.pairs.is_empty() {
        let others = listing.without_partner.len();
        return Err(Failure::usage(anyhow!(
            "{} holds no pair: {others} files of rgb/ and depth/ have no partner with the same stem. Give the two \
             files of a pair the same stem",
            display(folder)
        )));
    }
    if !quiet && !listing.without_partner.is_empty() {
        let names = listing.without_partner.join(", ");
        output::complain(&format!("skipped, no partner with the same stem: {names}"));
    }
    Ok(listing.pairs)
}

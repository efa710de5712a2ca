//! What the estimators are worth, on scenes whose truth is known.
//!
//! cargo run --release -p aquafuse --example truth_table -- estimates|shares|shares-linear

mod chance;
mod estimates;
mod exchange;
mod rivals;
mod scenes;
mod shares;
mod statistics;

use aquafuse::image::{Encoded, Linear};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    match std::env::args().nth(1).as_deref() {
        Some("estimates") => Ok(estimates::print()?),
        Some("shares") => Ok(shares::print::<Encoded>()?),
        Some("shares-linear") => Ok(shares::print::<Linear>()?),
        _ => Err("say which table: estimates, shares or shares-linear".into()),
    }
}

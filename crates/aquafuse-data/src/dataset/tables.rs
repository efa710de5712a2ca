//! Parquet as Hugging Face lays out images: tables with a column of structs of `bytes` and `path`, and any others.

#[cfg(feature = "parquet")]
mod limits;
#[cfg(feature = "parquet")]
mod rows;

#[cfg(feature = "fuzz-targets")]
#[cfg(feature = "parquet")]
pub(crate) use rows::try_parse;
#[cfg(feature = "parquet")]
pub(crate) use rows::{Cell, Table, binary, cell, strings};

use super::tree::Tree;
use super::{Dataset, Sample, split};

/// Tables of ours are about images, and hold none.
const MANIFEST: &str = "manifest.";

fn tables(tree: &Tree) -> impl Iterator<Item = &String> {
    tree.ending(".parquet").filter(|path| !split(path).1.starts_with(MANIFEST))
}

pub(super) fn evidence(tree: &Tree) -> Option<String> {
    // img2dataset writes a table about each of its shards, without images.
    let shard_of = |path: &str| tree.any_case(&format!("{}.tar", path.rsplit_once('.')?.0));
    let path = tables(tree).find(|path| shard_of(path).is_none())?;
    Some(format!("{path} is a table"))
}

/// Each table is a sample of the dataset: it is made as a whole.
pub(super) fn read(tree: &Tree, dataset: &mut Dataset) {
    dataset.samples = tables(tree).map(|path| Sample::new(path, Vec::new())).collect();
}

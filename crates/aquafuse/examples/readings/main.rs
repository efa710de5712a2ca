//! What each way to read the paper does to the scores, on scenes whose truth is known.
//!
//! cargo run --release -p aquafuse --example readings -- [TABLE]
//!
//! The exchanges are made as those of `aquafuse evaluate truth`, of the same places in other waters.

mod reading;
mod scores;
mod tables;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    tables::print(std::env::args().nth(1).as_deref())
}

//! What each way to read the paper does to the scores, on scenes whose truth is known.
//!
//! cargo run --release -p aquafuse --example readings -- [TABLE]
//!
//! The exchanges are made as those of `truth_table`, of the same places in other waters.

#[path = "../truth_table/chance.rs"]
mod chance;
#[path = "../truth_table/exchange.rs"]
mod exchange;
mod reading;
#[path = "../truth_table/scenes.rs"]
#[expect(dead_code, reason = "verdicts are tried by the other example")]
mod scenes;
mod scores;
mod tables;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    tables::print(std::env::args().nth(1).as_deref())
}

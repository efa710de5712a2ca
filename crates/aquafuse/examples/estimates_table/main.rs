//! What the estimators are worth, on scenes whose truth is known.
//!
//! cargo run --release -p aquafuse --example estimates_table
//!
//! How much of the true change fusion then makes is `aquafuse evaluate truth`.

mod estimates;
mod statistics;

fn main() -> Result<(), aquafuse::image::ImageError> {
    estimates::print()
}

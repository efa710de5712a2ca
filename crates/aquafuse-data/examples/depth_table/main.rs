//! How well each way from colour to depth orders measured depth.
//!
//! cargo run --release -p aquafuse-data --example depth_table -- DATA
//!
//! DATA is the folder of real pictures; `depth_pairs/` in it is read.

mod pairs;

use std::path::PathBuf;

use aquafuse::depth::DepthModel;
use aquafuse::metrics::spearman;
use pairs::{Pair, by_place, read_all};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let data = std::env::args_os().nth(1).ok_or("give the folder of real pictures")?;
    let pairs = read_all(&PathBuf::from(data))?;
    let names: Vec<&str> = pairs.iter().map(|pair| pair.name.trim_start_matches("flsea_")).collect();
    println!("| model | {} | mean by place |", names.join(" | "));
    println!("|---|{}---|", "---|".repeat(names.len()));
    for model in DepthModel::ALL {
        print_row(&format!("`{}`", model.name()), &pairs, |pair| pair.score(model));
    }
    print_row("row", &pairs, |pair| spearman(&pair.rows, &pair.metres));
    Ok(())
}

fn print_row(name: &str, pairs: &[Pair], score: impl Fn(&Pair) -> Option<f64>) {
    let scores: Vec<f64> = pairs.iter().map(|pair| score(pair).unwrap_or(f64::NAN)).collect();
    let columns: Vec<String> = scores.iter().map(|score| format!("{score:.2}")).collect();
    println!("| {name} | {} | {:.2} |", columns.join(" | "), by_place(pairs, &scores));
}

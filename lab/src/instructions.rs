//! Instructions of each kernel, counted by valgrind: unlike seconds, they do not change with the load of the machine.
//!
//! `cargo xtask test` holds them to `benches/instructions.tsv`, which `lab instructions` writes.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use xtask::shell::{cargo, command, output, root, run as call, say, succeeds, target};

use crate::synthetic::images;

/// What the program `kernels` can do.
const KERNELS: [&str; 5] = ["depth", "waterbody", "fusion", "bilateral", "frame"];
/// How the core is built: with its plain code alone, and with vectors.
const LEVELS: [(&str, &[&str]); 2] = [("plain", &[]), ("avx2", &["--features", "simd"])];
const CEILINGS: &str = "benches/instructions.tsv";
/// Another compiler or C library moves counts by a few percent; what is worth a look moves them by more.
const MARGIN: f64 = 1.08;

/// Instructions of one call, by kernel and level.
type Counts = BTreeMap<(String, String), u64>;

/// `lab instructions`: counts and writes the ceilings again.
pub(crate) fn renew() -> Result<()> {
    if let Some(why) = obstacle() {
        bail!("cannot count instructions: {why}");
    }
    let counts = count()?;
    let [rust, valgrind] = ["rustc", "valgrind"].map(version);
    let mut table = format!(
        "# Instructions of one call on an image of 256 x 256, by {valgrind}, built by {rust}.\n\
         # `cargo lab instructions` writes this file; `cargo xtask test` allows {:.0} % more.\n\
         kernel\tplain\tavx2\n",
        100.0 * (MARGIN - 1.0)
    );
    for kernel in KERNELS {
        let of = |level: &str| counts[&(kernel.to_owned(), level.to_owned())];
        writeln!(table, "{kernel}\t{}\t{}", of("plain"), of("avx2"))?;
    }
    print!("{table}");
    std::fs::write(root().join(CEILINGS), table).with_context(|| format!("cannot write {CEILINGS}"))
}

/// The guard of `cargo xtask test`: no kernel may need more than it did. Why it was skipped, if it was.
pub(crate) fn guard() -> Result<Option<String>> {
    if let Some(why) = obstacle() {
        return Ok(Some(why));
    }
    let table = std::fs::read_to_string(root().join(CEILINGS))
        .with_context(|| format!("cannot read {CEILINGS}; `cargo lab instructions` writes it"))?;
    let over = over(&count()?, &read(&table)?)?;
    if !over.is_empty() {
        bail!(
            "kernels need more instructions than they did:\n{over}\
             If that is meant, `cargo lab instructions` writes the new counts to {CEILINGS}; commit them and say why."
        );
    }
    Ok(None)
}

/// The kernels that need more than the margin allows, one a line.
fn over(counts: &Counts, ceilings: &Counts) -> Result<String> {
    let mut over = String::new();
    for (of, &count) in counts {
        let (kernel, level) = of;
        let missing = || format!("{CEILINGS} has no {kernel}, {level}; `cargo lab instructions` writes it");
        let ceiling = *ceilings.get(of).with_context(missing)?;
        let times = count as f64 / ceiling as f64;
        eprintln!("   {kernel:<10} {level:<6} {count:>12}, {times:.3} times what it was");
        if times > MARGIN {
            writeln!(over, "  {kernel}, {level}: {count}, {ceiling} before")?;
        }
    }
    Ok(over)
}

/// Why instructions cannot be counted here.
fn obstacle() -> Option<String> {
    #[cfg(target_arch = "x86_64")]
    let avx2 = std::arch::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    let avx2 = false;
    if !avx2 {
        return Some("the ceilings are of a processor with AVX2, which this one has not".to_owned());
    }
    let found = succeeds(command("valgrind", &["--version"]));
    (!found).then(|| "there is no valgrind".to_owned())
}

fn count() -> Result<Counts> {
    say("Counting instructions");
    let image = images((256, 256))?.join("blue.ppm");
    let mut counts = Counts::new();
    for (level, features) in LEVELS {
        let program = build(features)?;
        for kernel in KERNELS {
            let [one, three] = [1, 3].map(|times| total(&program, &image, kernel, times));
            counts.insert((kernel.to_owned(), level.to_owned()), (three? - one?) / 2);
        }
    }
    Ok(counts)
}

/// The program that runs a kernel.
fn build(features: &[&str]) -> Result<PathBuf> {
    let build = ["build", "--release", "--quiet", "--locked", "--package", "kernels"];
    call(cargo(&[&build[..], features].concat()))?;
    Ok(target().join("release/kernels"))
}

/// Instructions of the whole program.
fn total(program: &Path, image: &Path, kernel: &str, times: u64) -> Result<u64> {
    let mut counting = command("valgrind", &["--tool=callgrind", "--callgrind-out-file=/dev/null"]);
    counting.arg(program).arg(kernel).arg(image).arg(times.to_string());
    let counted = counting.output().context("cannot start valgrind")?;
    let said = String::from_utf8_lossy(&counted.stderr);
    let number = said.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok());
    number.with_context(|| format!("valgrind counted nothing of {kernel}:\n{said}"))
}

fn read(table: &str) -> Result<Counts> {
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap_or_default().split('\t').collect();
    let mut counts = Counts::new();
    for line in lines {
        let mut cells = line.split('\t');
        let kernel = cells.next().unwrap_or_default();
        for (level, cell) in header.iter().skip(1).zip(cells) {
            let count = cell.parse().with_context(|| format!("{CEILINGS}: `{cell}` is no count"))?;
            counts.insert((kernel.to_owned(), (*level).to_owned()), count);
        }
    }
    Ok(counts)
}

fn version(program: &str) -> String {
    let said = output(command(program, &["--version"])).unwrap_or_default();
    said.trim().split(" (").next().unwrap_or(program).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ceilings_are_read_by_kernel_and_level() {
        let counts = read("# said\nkernel\tplain\tavx2\ndepth\t30\t4\nframe\t50\t6\n").unwrap();
        let of = |kernel: &str, level: &str| counts[&(kernel.to_owned(), level.to_owned())];
        assert_eq!((of("depth", "plain"), of("depth", "avx2"), of("frame", "avx2")), (30, 4, 6));
        assert!(read("kernel\tplain\ndepth\tmany\n").is_err());
    }

    #[test]
    fn what_is_over_the_margin_is_named_and_what_has_no_ceiling_refused() {
        let [stored, now] = ["depth\t100\nframe\t100\n", "depth\t107\nframe\t109\n"]
            .map(|rows| read(&format!("kernel\tplain\n{rows}")).unwrap());
        assert_eq!(over(&now, &stored).unwrap(), "  frame, plain: 109, 100 before\n");
        assert!(over(&now, &Counts::new()).is_err());
    }
}

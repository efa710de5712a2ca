//! What went wrong, counted.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::trials::{Given, Trial};
use crate::forge::{Right, crc32};
use crate::runner::{End, Outcome};

/// The folder of a dataset that is made.
pub(super) const DATASET: &str = "set";
/// From here on a refusal is called slow, in milliseconds.
const SLOW: f64 = 2000.0;

/// What is counted, in the order of the table.
pub(super) const FAULTS: [&str; 7] = [
    "panics",
    "killed",
    "refused after more than 2 s",
    "half outputs",
    "unnamed errors",
    "bad ones taken",
    "good ones refused",
];

/// How often each fault was seen in how many runs.
#[derive(Clone, Copy, Default)]
pub(super) struct Tally {
    pub(super) tried: usize,
    pub(super) faults: [usize; FAULTS.len()],
}

impl Tally {
    pub(super) fn add(&mut self, other: &Self) {
        self.tried += other.tried;
        for (mine, theirs) in self.faults.iter_mut().zip(other.faults) {
            *mine += theirs;
        }
    }
}

/// The faults of one run, whose output was to stand alone in `folder`.
pub(super) fn judge(trial: &Trial, outcome: &Outcome, folder: &Path) -> Tally {
    let Outcome { end, said, .. } = outcome;
    let accepted = *end == End::Exit(0);
    let faults = [
        // One that was caught is an error of its file, which says so in other words.
        said.contains("panicked at") || *end == End::Exit(101),
        matches!(end, End::Signal | End::Late),
        // What is taken may be a large image; how long that took is in the second table.
        !accepted && outcome.milliseconds > SLOW,
        match &trial.given {
            Given::As(_) => is_half(accepted, folder),
            Given::In(_) => is_half_dataset(accepted, folder),
        },
        matches!(end, End::Exit(code) if *code != 0 && (!matches!(code, 1 | 2) || !said.contains(&trial.name()))),
        trial.right == Right::Refuse && accepted,
        trial.right == Right::Accept && !accepted,
    ];
    Tally { tried: 1, faults: faults.map(usize::from) }
}

/// Whether an output is there that should not be, or is not whole, or anything else was left beside it.
fn is_half(accepted: bool, folder: &Path) -> bool {
    let Ok(entries) = fs::read_dir(folder) else { return true };
    let names: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    match &names[..] {
        [] => accepted,
        [output] => !(accepted && fs::read(output).is_ok_and(|bytes| is_whole_png(&bytes))),
        _ => true,
    }
}

/// Whether a refused dataset has left any file, or one that was taken lacks its manifest or its whole variant.
fn is_half_dataset(accepted: bool, folder: &Path) -> bool {
    let out = folder.join(DATASET);
    let variant = fs::read(out.join("images/a__water__0.png"));
    match accepted {
        true => !(out.join("manifest.jsonl").is_file() && variant.is_ok_and(|bytes| is_whole_png(&bytes))),
        false => fs::read_dir(&out).is_ok_and(|mut entries| entries.next().is_some()),
    }
}

/// Whether every chunk is there with its right checksum, pixels among them, and the last one is the end.
fn is_whole_png(bytes: &[u8]) -> bool {
    let Some(mut rest) = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n") else { return false };
    let mut pixels = false;
    while let Some((length, after)) = rest.split_first_chunk() {
        let length = u32::from_be_bytes(*length) as usize;
        let Some((named, after)) = length.checked_add(4).and_then(|end| after.split_at_checked(end)) else {
            return false;
        };
        let Some((checksum, after)) = after.split_first_chunk() else { return false };
        if crc32(named) != u32::from_be_bytes(*checksum) {
            return false;
        }
        pixels |= named.starts_with(b"IDAT");
        if named == b"IEND" {
            return pixels && after.is_empty();
        }
        rest = after;
    }
    false
}

/// A row of the table: ours / the rival's.
pub(super) fn row(kind: &str, [ours, theirs]: &[Tally; 2]) -> String {
    let mut row = format!("| {kind} | {} / {} |", ours.tried, theirs.tried);
    for (ours, theirs) in ours.faults.iter().zip(theirs.faults) {
        // Writing into a string does not fail.
        let _ = write!(row, " {ours} / {theirs} |");
    }
    row + "\n"
}

/// The names of the faults of one run.
pub(super) fn names(tally: &Tally) -> String {
    let seen = FAULTS.iter().zip(tally.faults).filter(|(_, count)| *count > 0);
    seen.map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::is_whole_png;

    #[test]
    fn a_png_is_whole_with_pixels_checksums_and_end() {
        let chunk = |name: &[u8], checksum: u32| [&[0; 4], name, &checksum.to_be_bytes()].concat();
        let (data, end) = (chunk(b"IDAT", 0x35af_061e), chunk(b"IEND", 0xae42_6082));
        let file = |chunks: &[&[u8]]| [b"\x89PNG\r\n\x1a\n", &chunks.concat()[..]].concat();
        assert!(is_whole_png(&file(&[&data, &end])));
        assert!(!is_whole_png(&file(&[&end])), "no pixels");
        assert!(!is_whole_png(&file(&[&data])), "no end");
        assert!(!is_whole_png(&file(&[&data, &end[..11]])), "half an end");
        assert!(!is_whole_png(&file(&[&chunk(b"IDAT", 1), &end])), "wrong checksum");
        assert!(!is_whole_png(b""), "nothing");
    }
}

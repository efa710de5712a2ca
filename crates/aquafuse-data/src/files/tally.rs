//! A count of the work that this process has done: it shows that no step is done twice.
//!
//! The counters belong to the process, not to a run. They order nothing and cost one relaxed addition a step, which is
//! nothing beside decoding an image.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// A step of work that should not be done twice for one result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// A folder was listed to find its images.
    FolderListed,
    /// The pixels of an image file were decoded.
    ImageDecoded,
    /// The water of an image was estimated.
    WaterEstimated,
    /// The cameras of a scene were parsed.
    CamerasParsed,
}

/// How often each [`Step`] was done.
///
/// # Examples
///
/// ```
/// use aquafuse_data::files::Tally;
///
/// let tally = Tally { folders_listed: 1, images_decoded: 9, ..Tally::default() };
/// assert_eq!(tally.to_string(), "1 folder listed, 9 images decoded");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Folders listed to find their images.
    pub folders_listed: u64,
    /// Image files decoded.
    pub images_decoded: u64,
    /// Waters estimated from images.
    pub waters_estimated: u64,
    /// Sets of cameras parsed.
    pub cameras_parsed: u64,
}

static FOLDERS_LISTED: AtomicU64 = AtomicU64::new(0);
static IMAGES_DECODED: AtomicU64 = AtomicU64::new(0);
static WATERS_ESTIMATED: AtomicU64 = AtomicU64::new(0);
static CAMERAS_PARSED: AtomicU64 = AtomicU64::new(0);

/// Counts a step; whoever does it calls this.
pub fn count(step: Step) {
    let counter = match step {
        Step::FolderListed => &FOLDERS_LISTED,
        Step::ImageDecoded => &IMAGES_DECODED,
        Step::WaterEstimated => &WATERS_ESTIMATED,
        Step::CamerasParsed => &CAMERAS_PARSED,
    };
    counter.fetch_add(1, Ordering::Relaxed);
}

/// The work of this process so far.
pub fn tally() -> Tally {
    let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
    Tally {
        folders_listed: read(&FOLDERS_LISTED),
        images_decoded: read(&IMAGES_DECODED),
        waters_estimated: read(&WATERS_ESTIMATED),
        cameras_parsed: read(&CAMERAS_PARSED),
    }
}

impl fmt::Display for Tally {
    /// Every step that was done, in words; `nothing` when none was.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            (self.folders_listed, ["folder listed", "folders listed"]),
            (self.images_decoded, ["image decoded", "images decoded"]),
            (self.waters_estimated, ["water estimated", "waters estimated"]),
            (self.cameras_parsed, ["set of cameras parsed", "sets of cameras parsed"]),
        ];
        let said = parts.into_iter().filter(|(count, _)| *count > 0).map(|(count, [one, several])| {
            let words = if count == 1 { one } else { several };
            format!("{count} {words}")
        });
        let said: Vec<String> = said.collect();
        f.write_str(if said.is_empty() { "nothing" } else { "" })?;
        f.write_str(&said.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tally_says_what_was_done_and_how_often() {
        let tally = Tally { folders_listed: 1, images_decoded: 9, waters_estimated: 10, cameras_parsed: 1 };
        let said = "1 folder listed, 9 images decoded, 10 waters estimated, 1 set of cameras parsed";
        assert_eq!(tally.to_string(), said);
        assert_eq!(Tally::default().to_string(), "nothing");
    }
}

//! What is printed once a video is written.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Error, anyhow};
use aquafuse_data::files::display;
use aquafuse_data::video::{Damage, Summary};
use serde_json::json;

use crate::failure::Failure;

/// A run that has ended.
pub(super) struct Report<'a> {
    pub(super) input: &'a Path,
    pub(super) output: &'a Path,
    pub(super) summary: &'a Summary,
    /// How long it took.
    pub(super) seconds: f64,
    pub(super) notes: &'a [String],
    pub(super) is_lenient: bool,
}

impl Report<'_> {
    pub(super) fn text(&self) -> String {
        let Summary { frames, verdicts, reasons, clipped, flicker, .. } = self.summary;
        let [good, doubtful, failed] = verdicts;
        let estimates = match good + doubtful + failed {
            0 => String::new(),
            _ => format!("estimates: {good} good, {doubtful} doubtful, {failed} failed; "),
        };
        let mut text = format!(
            "{}: {frames} frames written; {estimates}{:.2} % of the values clipped; {:.1} frames a second\n",
            display(self.output),
            100.0 * clipped,
            self.rate(),
        );
        if !reasons.is_empty() {
            let each: Vec<String> = reasons
                .iter()
                .map(|(reason, frames)| format!("{} ({frames} frames)", reason.describe()))
                .collect();
            let _ = writeln!(
                text,
                "  reasons: {}; `aquafuse inspect --help` says what they mean and what helps",
                each.join(", ")
            );
        }
        if let Some(flicker) = flicker {
            let (frame, change) = flicker.largest();
            let _ = match flicker.ratio() {
                Some(ratio) => writeln!(
                    text,
                    "  flicker: mean colours change {ratio:.2} times as much from frame to frame as in the video; most, by {:.2} of \
                     255, at frame {frame}",
                    255.0 * change
                ),
                None => writeln!(text, "  flicker: the mean colours of the video do not change"),
            };
        }
        if let (Some(damage), true) = (&self.summary.damage, self.is_lenient) {
            let _ = writeln!(text, "  WARNING: {}", self.damage(damage));
        }
        text
    }

    fn rate(&self) -> f64 {
        self.summary.frames as f64 / self.seconds.max(1e-3)
    }

    /// What is wrong with the video.
    pub(super) fn damage(&self, Damage { last, cause, .. }: &Damage) -> Error {
        let input = if self.input == Path::new("-") { Path::new("standard input") } else { self.input };
        anyhow!(
            "{} is damaged or cut: {} has its {} frames that can be decoded, the last one at {} ({cause}). Get an intact copy if \
             there should be more; --lenient accepts it",
            display(input),
            display(self.output),
            self.summary.frames,
            clock(*last),
        )
    }

    /// One record; `schema` changes when a field changes its meaning or goes.
    pub(super) fn json(&self) -> Result<String, Failure> {
        let Summary { frames, verdicts: [good, doubtful, failed], reasons, clipped, flicker, damage, .. } =
            self.summary;
        let reasons: Vec<_> =
            reasons.iter().map(|(reason, frames)| json!({ "reason": reason, "frames": frames })).collect();
        let record = json!({
            "schema": 1,
            "input": display(self.input).to_string(),
            "output": display(self.output).to_string(),
            "frames": frames,
            "frames_per_second": self.rate(),
            "estimates": { "good": good, "doubtful": doubtful, "failed": failed },
            "reasons": reasons,
            "clipped": clipped,
            "flicker": flicker.as_ref().map(|flicker| json!({
                "ratio": flicker.ratio(),
                "mean_change": flicker.changes(),
                "largest": { "frame": flicker.largest().0, "change": flicker.largest().1 },
            })),
            "damage": damage.as_ref().map(|damage| json!({ "last_frame_at": damage.last, "cause": damage.cause })),
            "notes": self.notes,
        });
        serde_json::to_string(&record).map(|record| record + "\n").map_err(Failure::work)
    }
}

/// A time of a video: `0:01:02.50`.
pub(super) fn clock(seconds: f64) -> String {
    let (sign, hundredths) = (if seconds < 0.0 { "-" } else { "" }, (seconds.abs() * 100.0).round() as u64);
    let (minutes, hundredths) = (hundredths / 6000, hundredths % 6000);
    format!("{sign}{}:{:02}:{:02}.{:02}", minutes / 60, minutes % 60, hundredths / 100, hundredths % 100)
}

#[cfg(test)]
mod tests {
    use super::clock;

    #[test]
    fn times_have_hours_minutes_and_hundredths() {
        assert_eq!([0.0, 62.5, 3599.999].map(clock), ["0:00:00.00", "0:01:02.50", "1:00:00.00"]);
        assert_eq!(clock(-0.02), "-0:00:00.02");
    }
}

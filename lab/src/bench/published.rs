//! Speeds that the paper prints, from `testdata/published.toml`.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use serde::Deserialize;

use super::Size;
use xtask::shell::root;

#[derive(Deserialize)]
struct File {
    speed: Published,
}

/// Frames a second on machines that are not ours.
#[derive(Deserialize)]
pub(super) struct Published {
    sizes: Vec<String>,
    fps: BTreeMap<String, Vec<f64>>,
    pub(super) raspberry_pi_4: RaspberryPi,
}

#[derive(Deserialize)]
pub(super) struct RaspberryPi {
    pub(super) size: String,
    pub(super) fps: f64,
}

impl Published {
    pub(super) fn read() -> Result<Self> {
        let path = root().join("testdata/published.toml");
        let text =
            std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let File { speed } =
            toml::from_str(&text).with_context(|| format!("cannot read {}", path.display()))?;
        Ok(speed)
    }

    /// The paper's own method at this size.
    pub(super) fn fps(&self, (width, height): Size) -> Option<f64> {
        let at = self.sizes.iter().position(|size| *size == format!("{width}x{height}"))?;
        self.fps.get("AquaFuse")?.get(at).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_speeds_are_found_by_size() {
        let published = Published::read().unwrap();
        assert_eq!(published.fps((1920, 1080)), Some(9.53));
        assert_eq!(published.fps((7, 7)), None);
        assert_eq!(published.raspberry_pi_4.size, "256x256");
    }
}

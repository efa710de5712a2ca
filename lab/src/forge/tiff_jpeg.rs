//! TIFF whose strips are JPEG: each strip has a size of its own, which need not be the page's.

use anyhow::Result;

use super::list::Right::{Any, Refuse};
use super::list::{Files, Role};
use super::seeds;
use super::tiff_bytes::{BYTE_COUNTS, COMPRESSION, PHOTOMETRIC, Tiff};

const LIES: &str = "header lies";

pub(crate) fn add(files: &mut Files) -> Result<()> {
    let whole = seeds::image("jpg")?;
    // The frame's height and width stand behind its marker, length and precision.
    let frame = whole.windows(2).position(|bytes| bytes == [0xff, 0xc0]).unwrap_or(0);
    let of_size = |side: [u8; 2]| {
        let mut strip = whole.clone();
        strip[frame + 5..frame + 9].copy_from_slice(&[side, side].concat());
        strip
    };
    let cut = whole[..whole.len() / 2].to_vec();
    for (name, right, strip) in [
        ("as-it-is", Any, whole.clone()),
        ("of-65500x65500", Refuse, of_size([0xff, 0xdc])),
        ("of-1x1", Refuse, of_size([0, 1])),
        ("cut-short", Refuse, cut),
        ("without-a-scan", Refuse, whole[..frame].to_vec()),
        ("empty", Refuse, Vec::new()),
    ] {
        for (kind, compression) in [("old-jpeg", 6), ("jpeg", 7)] {
            let length = strip.len() as u32;
            let tiff = Tiff::grey().with(COMPRESSION, compression).with(PHOTOMETRIC, 6);
            let tiff = tiff.with(277, 3).with(BYTE_COUNTS, length).data(strip.clone());
            files.add(LIES, Role::Image, right, &format!("{kind}-strip-{name}.tiff"), tiff.bytes());
        }
    }
    Ok(())
}

//! COLMAP's depth maps of dense reconstruction, `IMAGE.geometric.bin`: columns, rows and channels as text, each with a `&`
//! behind it, then rows of little-endian floats from the top. 0 is no depth.

use std::io::{BufRead, Read, Seek};

use super::{Fault, Raster, Wanted, check_size, read_values};

/// What the names end in, behind the name of the image. Maps before the geometric check are called `.photometric.bin`; they
/// are in the same folder, and are not taken for a second map.
pub(super) const END: &str = ".geometric.bin";
/// A number of the header has no more digits.
const DIGITS: u8 = 10;

/// Whether a file begins as such a map does.
pub(super) fn begins(head: &[u8]) -> bool {
    let digits = head.iter().take_while(|byte| byte.is_ascii_digit()).count();
    (1..=usize::from(DIGITS)).contains(&digits) && head.get(digits) == Some(&b'&')
}

pub(super) fn decode(mut reader: impl BufRead + Seek, wanted: Wanted) -> Result<Raster, Fault> {
    let mut number = || -> Result<u64, Fault> {
        let mut text = Vec::new();
        reader.by_ref().take(u64::from(DIGITS).saturating_add(1)).read_until(b'&', &mut text)?;
        let digits = text.strip_suffix(b"&").and_then(|digits| std::str::from_utf8(digits).ok());
        let number = digits.and_then(|digits| digits.parse().ok());
        number.ok_or_else(|| Fault::Damaged("its header is not three numbers with & behind each".into()))
    };
    let (columns, rows, channels) = (number()?, number()?, number()?);
    if channels != 1 {
        return Err(Fault::Unsupported(
            format!("{channels} channels, as COLMAP's maps of normals"),
            "Give the map of depth, from depth_maps/",
        ));
    }
    let size @ (width, height) = check_size(wanted, columns, rows, 4)?;
    let values = read_values(reader, size, f32::from_le_bytes)?;
    Ok(Raster { width, height, values, full_range: None })
}

//! PFM, the portable float map: `Pf`, columns, rows and a scale as text, then rows of floats from the **bottom**.
//!
//! A negative scale says little-endian. Its size is not applied: writers do not agree on whether values are to be
//! multiplied or divided by it.

use std::io::{BufRead, Read, Seek, Write};

use aquafuse::depth::DepthMap;

use super::{Fault, Raster, Wanted, check_size, read_values};

/// Words of the header are numbers; longer ones are none.
const LONGEST_WORD: usize = 32;

pub(super) fn decode(mut reader: impl BufRead + Seek, wanted: Wanted) -> Result<Raster, Fault> {
    if word(&mut reader)? != "Pf" {
        return Err(Fault::Unsupported("three channels".into(), "Save one channel (Pf)"));
    }
    let (columns, rows, scale) = (number(&mut reader)?, number(&mut reader)?, number::<f64>(&mut reader)?);
    if !scale.is_finite() || scale == 0.0 {
        return Err(Fault::Damaged(format!("its scale is {scale}")));
    }
    let size @ (width, height) = check_size(wanted, columns, rows, 4)?;
    let little_endian = scale < 0.0;
    let value = |bytes| if little_endian { f32::from_le_bytes(bytes) } else { f32::from_be_bytes(bytes) };
    let values = flipped(&read_values(reader, size, value)?, width);
    Ok(Raster { width, height, values, full_range: None })
}

/// The same rows in opposite order.
fn flipped(values: &[f32], width: usize) -> Vec<f32> {
    values.chunks_exact(width).rev().flatten().copied().collect()
}

fn number<T: std::str::FromStr>(reader: &mut impl Read) -> Result<T, Fault> {
    let word = word(reader)?;
    word.parse().map_err(|_| Fault::Damaged(format!("its header has {word:?} instead of a number")))
}

/// The next word, and the one white space that ends it.
fn word(reader: &mut impl Read) -> Result<String, Fault> {
    let mut word = String::new();
    loop {
        let mut byte = [0];
        reader.read_exact(&mut byte)?;
        match byte[0] {
            space if space.is_ascii_whitespace() && word.is_empty() => {}
            space if space.is_ascii_whitespace() => return Ok(word),
            letter if letter.is_ascii_graphic() && word.len() < LONGEST_WORD => word.push(letter.into()),
            _ => return Err(Fault::Damaged("its header is invalid".into())),
        }
    }
}

pub(super) fn encode(out: &mut dyn Write, depth: &DepthMap) -> std::io::Result<()> {
    write!(out, "Pf\n{} {}\n-1.0\n", depth.width(), depth.height())?;
    let bytes: Vec<u8> =
        flipped(&depth.distances(), depth.width()).into_iter().flat_map(f32::to_le_bytes).collect();
    out.write_all(&bytes)
}

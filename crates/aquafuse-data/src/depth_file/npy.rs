//! NPY, the file of one NumPy array (NumPy Enhancement Proposal 1).
//!
//! A file is `\x93NUMPY`, a version, the length of a header, the header, the values. The header is a Python literal:
//! `{'descr': '<f4', 'fortran_order': False, 'shape': (480, 640), }`. It is short enough to read ourselves; the crates
//! that do bring a parser of all Python literals.

use std::io::{BufRead, Read, Seek, Write};

use super::{Fault, Raster, Wanted, check_size, narrowed, read_values};

/// Headers are one line of some hundred bytes; more is refused before it is read.
const LONGEST_HEADER: u32 = 1 << 16;
/// Bytes of a header that we write, but for the line feed that ends it. Rows, columns and a number of channels fit in, and
/// with 10 bytes before it the values begin at 128, a multiple of 64 as the format asks for.
const PADDED: usize = 117;

pub(super) fn decode(mut reader: impl BufRead + Seek, wanted: Wanted) -> Result<Raster, Fault> {
    let mut start = [0; 8];
    reader.read_exact(&mut start)?;
    let length = match start[6] {
        1 => u32::from(u16::from_le_bytes(read_array(&mut reader)?)),
        2 | 3 => u32::from_le_bytes(read_array(&mut reader)?),
        version => return Err(Fault::Damaged(format!("NPY has no version {version}"))),
    };
    if length > LONGEST_HEADER {
        return Err(Fault::Damaged(format!("its header declares a length of {length} bytes")));
    }
    let mut header = vec![0; length as usize];
    reader.read_exact(&mut header)?;
    let header = Header::parse(&header).ok_or_else(|| Fault::Damaged("its header is invalid".into()))?;
    let &[rows, columns] = &header.shape[..] else {
        return Err(Fault::Unsupported(
            format!("an array of {} dimensions", header.shape.len()),
            "Save a plane of rows and columns, for one by np.squeeze",
        ));
    };
    let size @ (width, height) = check_size(wanted, columns, rows, 8)?;
    let (values, full_range) = match header.descr.as_str() {
        "|u1" | "<u1" | ">u1" => (read_values(reader, size, |[byte]| f32::from(byte))?, Some(255.0)),
        "<u2" => (read_values(reader, size, |b| f32::from(u16::from_le_bytes(b)))?, Some(65535.0)),
        ">u2" => (read_values(reader, size, |b| f32::from(u16::from_be_bytes(b)))?, Some(65535.0)),
        "<i2" => (read_values(reader, size, |b| f32::from(i16::from_le_bytes(b)))?, None),
        ">i2" => (read_values(reader, size, |b| f32::from(i16::from_be_bytes(b)))?, None),
        "<i4" => (read_values(reader, size, |b| narrowed(i32::from_le_bytes(b).into()))?, None),
        ">i4" => (read_values(reader, size, |b| narrowed(i32::from_be_bytes(b).into()))?, None),
        "<f2" => (read_values(reader, size, |b| half(u16::from_le_bytes(b)))?, None),
        ">f2" => (read_values(reader, size, |b| half(u16::from_be_bytes(b)))?, None),
        "<f4" => (read_values(reader, size, f32::from_le_bytes)?, None),
        ">f4" => (read_values(reader, size, f32::from_be_bytes)?, None),
        "<f8" => (read_values(reader, size, |b| narrowed(f64::from_le_bytes(b)))?, None),
        ">f8" => (read_values(reader, size, |b| narrowed(f64::from_be_bytes(b)))?, None),
        other => {
            let remedy = "Save z.astype('float32')";
            return Err(Fault::Unsupported(format!("values of type {other}"), remedy));
        }
    };
    let values = if header.fortran_order { by_rows(&values, height) } else { values };
    Ok(Raster { width, height, values, full_range })
}

/// A float of 16 bits: a sign, 5 bits of exponent and 10 of fraction.
fn half(bits: u16) -> f32 {
    let (sign, fraction) = (if bits >> 15 == 0 { 1.0 } else { -1.0 }, f32::from(bits & 0x3ff));
    let size = match i32::from((bits >> 10) & 0x1f) {
        0 => fraction * 2_f32.powi(-24),
        0x1f if fraction == 0.0 => f32::INFINITY,
        0x1f => f32::NAN,
        exponent => (1.0 + fraction / 1024.0) * 2_f32.powi(exponent.saturating_sub(15)),
    };
    sign * size
}

fn read_array<const N: usize>(reader: &mut impl Read) -> Result<[u8; N], Fault> {
    let mut bytes = [0; N];
    reader.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Values that stand column by column, row by row.
fn by_rows(values: &[f32], height: usize) -> Vec<f32> {
    (0..height).flat_map(|y| values.iter().skip(y).step_by(height)).copied().collect()
}

struct Header {
    descr: String,
    fortran_order: bool,
    shape: Vec<u64>,
}

impl Header {
    fn parse(bytes: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(bytes).ok()?.trim();
        let mut rest = text.strip_prefix('{')?.strip_suffix('}')?.trim();
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        while !rest.is_empty() {
            let (key, after) = quoted(rest)?;
            let value = after.trim_start().strip_prefix(':')?.trim_start();
            let after = match key {
                "descr" => {
                    let (text, after) = quoted(value)?;
                    descr = Some(text.to_owned());
                    after
                }
                "fortran_order" => {
                    let word = if value.starts_with("True") { "True" } else { "False" };
                    fortran_order = Some(word == "True");
                    value.strip_prefix(word)?
                }
                "shape" => {
                    let (inside, after) = value.strip_prefix('(')?.split_once(')')?;
                    let numbers = inside.split(',').map(str::trim).filter(|number| !number.is_empty());
                    shape = Some(numbers.map(|number| number.parse().ok()).collect::<Option<Vec<u64>>>()?);
                    after
                }
                _ => return None,
            };
            let after = after.trim_start();
            rest = match after.strip_prefix(',') {
                Some(more) => more.trim_start(),
                None if after.is_empty() => after,
                None => return None,
            };
        }
        Some(Self { descr: descr?, fortran_order: fortran_order?, shape: shape? })
    }
}

/// The content of the quotes that `text` begins with, and what follows them.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|quote| matches!(quote, '\'' | '"'))?;
    text.strip_prefix(quote)?.split_once(quote)
}

/// Writes an array of floats, row by row. `shape` is the inside of a Python tuple: `480, 640`.
pub(super) fn encode(
    out: &mut dyn Write,
    shape: &str,
    values: impl IntoIterator<Item = f32>,
) -> std::io::Result<()> {
    let literal = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape}), }}");
    let header = format!("{literal:PADDED$}\n");
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&u16::try_from(header.len()).unwrap_or(u16::MAX).to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    let bytes: Vec<u8> = values.into_iter().flat_map(f32::to_le_bytes).collect();
    out.write_all(&bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_of_16_bits_are_what_numpy_says() {
        for (bits, value) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x3555, 0.333_251_95),
            (0x0001, 5.960_464_5e-8),
            (0x7bff, 65504.0),
        ] {
            assert_eq!(half(bits).to_bits(), f32::to_bits(value), "{bits:x}");
        }
        assert!(half(0x7c00).is_infinite() && half(0x7e00).is_nan());
    }
}

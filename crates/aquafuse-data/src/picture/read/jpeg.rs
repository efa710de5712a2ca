//! JPEG: grey, colour and CMYK.

use std::io::{BufRead, Cursor, Seek, SeekFrom};

use aquafuse::image::Image;
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;

use super::super::limits::Size;
use super::super::metadata::{Metadata, Resolution, ResolutionUnit};
use super::super::pixels::Layers;
use super::{Decoded, Fault, Pixels, XMP};

/// Scans of a progressive picture; more is an attack on our time.
const MOST_SCANS: usize = 50;
const END_OF_IMAGE: u8 = 0xd9;
const START_OF_SCAN: u8 = 0xda;
const PROGRESSIVE: u8 = 0xc2;

/// Size and components as the frame header has them, read as far as the first scan, which tells how they are coded.
pub(super) fn header(reader: &mut (impl BufRead + Seek)) -> Result<Size, Fault> {
    let mut fixed = [0; 2];
    reader.read_exact(&mut fixed)?;
    let mut frame: Option<(u8, [u8; 6])> = None;
    loop {
        let marker = next_marker(reader)?;
        if matches!(marker, 0x01 | 0xd0..=0xd8) {
            continue;
        }
        let mut length = [0; 2];
        if marker != END_OF_IMAGE {
            reader.read_exact(&mut length)?;
        }
        let mut rest = i64::from(u16::from_be_bytes(length)) - 2;
        match (marker, frame) {
            (START_OF_SCAN, Some((marker, [_, y1, y0, x1, x0, components]))) => {
                let mut scanned = [0];
                reader.read_exact(&mut scanned)?;
                let side = |high, low| u64::from(u16::from_be_bytes([high, low]));
                // All of the picture's coefficients are held where they come in more than one scan; grey is tripled.
                let in_scans = marker == PROGRESSIVE || scanned[0] < components;
                let coefficients = if in_scans { 2 * u64::from(components) } else { 0 };
                let beside = coefficients + u64::from(components == 1);
                return Ok(Size {
                    width: side(x1, x0),
                    height: side(y1, y0),
                    channels: 3,
                    sample: 1,
                    beside,
                });
            }
            (START_OF_SCAN | END_OF_IMAGE, _) => {
                return Err(Fault::Damaged("it does not say how large it is".into()));
            }
            _ if is_frame(marker) => {
                let mut found = [0; 6];
                reader.read_exact(&mut found)?;
                frame = frame.or(Some((marker, found)));
                rest -= 6;
            }
            _ => {}
        }
        if rest < 0 {
            return Err(Fault::Damaged("a part of it says that it is shorter than it can be".into()));
        }
        reader.seek(SeekFrom::Current(rest))?;
    }
}

/// Frames of every coding; 0xc4, 0xc8 and 0xcc among them are tables.
fn is_frame(code: u8) -> bool {
    matches!(code, 0xc0..=0xcf) && !matches!(code, 0xc4 | 0xc8 | 0xcc)
}

/// The code of the next marker; fill bytes before it are passed over.
fn next_marker(reader: &mut impl BufRead) -> Result<u8, Fault> {
    let mut byte = [0];
    reader.read_exact(&mut byte)?;
    if byte != [0xff] {
        return Err(Fault::Damaged("it holds something between its parts".into()));
    }
    while byte == [0xff] {
        reader.read_exact(&mut byte)?;
    }
    Ok(byte[0])
}

/// The marks of a file: where the image ends, which a file that was cut short does not say, and its scans.
#[derive(Default)]
struct Marks {
    end: Option<usize>,
    scans: usize,
    /// Bytes of coded data in the first scan.
    first_scan: usize,
    progressive: bool,
    /// Columns and rows.
    size: (usize, usize),
}

impl Marks {
    fn of(bytes: &[u8]) -> Self {
        let mut marks = Self::default();
        let mut at = 2;
        while let Some(&[mark, code]) = bytes.get(at..at + 2).and_then(|pair| pair.first_chunk()) {
            match (mark, code) {
                (0xff, END_OF_IMAGE) => {
                    marks.end = Some(at);
                    break;
                }
                (0xff, 0xff) => at += 1,
                (0xff, 0x01 | 0xd0..=0xd8) => at += 2,
                (0xff, 0x00) | (..0xff, _) => break,
                (0xff, code) => {
                    let Some(&length) = bytes.get(at + 2..at + 4).and_then(|length| length.first_chunk())
                    else {
                        break;
                    };
                    if is_frame(code)
                        && let Some(&[y1, y0, x1, x0]) =
                            bytes.get(at + 5..at + 9).and_then(|size| size.first_chunk())
                    {
                        let side = |high, low| usize::from(u16::from_be_bytes([high, low]));
                        (marks.progressive, marks.size) = (code == PROGRESSIVE, (side(x1, x0), side(y1, y0)));
                    }
                    at += 2 + usize::from(u16::from_be_bytes(length));
                    if code == START_OF_SCAN {
                        let began = at;
                        at = end_of_scan(bytes, at);
                        if marks.scans == 0 {
                            marks.first_scan = at.saturating_sub(began);
                        }
                        marks.scans += 1;
                    }
                }
            }
        }
        marks
    }

    /// Whether the first scan is too short for a bit to each block: the first scan of every coding has one.
    fn lacks_data(&self) -> bool {
        let blocks = self.size.0.div_ceil(LARGEST_BLOCK) * self.size.1.div_ceil(LARGEST_BLOCK);
        8 * self.first_scan < blocks
    }
}

/// Side of what may be coded as one, in pixels: four blocks of eight.
const LARGEST_BLOCK: usize = 32;

/// Where the coded data that begins at `at` ends: at a marker that is neither stuffing nor a restart.
fn end_of_scan(bytes: &[u8], mut at: usize) -> usize {
    while let Some(pair) = bytes.get(at..at + 2) {
        match pair {
            [0xff, 0x00 | 0xd0..=0xd7] => at += 2,
            [0xff, 0xff] => at += 1,
            [0xff, _] => return at,
            _ => at += 1,
        }
    }
    bytes.len()
}

pub(super) fn decode(bytes: &[u8], lenient: bool) -> Result<Decoded, Fault> {
    let marks = Marks::of(bytes);
    if marks.scans > MOST_SCANS {
        return Err(Fault::Unsupported(
            format!("in {} scans", marks.scans),
            "Save it as a baseline JPEG first",
        ));
    }
    // Without the mark of the end the decoder can tell data that is missing from data that is there: where it
    // meets a mark it takes zeros for the rest. Of a progressive picture it wants to see the mark.
    let strictly = match marks.end {
        Some(end) if !marks.progressive => &bytes[..end],
        _ => bytes,
    };
    let cause = match (try_decode(strictly, true), marks.end) {
        (Ok(_), _) if marks.lacks_data() => "there are more blocks of pixels than bits in it".into(),
        (Ok(decoded), Some(_)) => return Ok(decoded),
        (Ok(_), None) => "its end is missing".into(),
        (Err(Fault::Damaged(cause)), _) => cause,
        (Err(other), _) => return Err(other),
    };
    if lenient {
        let decoded = try_decode(bytes, false)?;
        return Ok(Decoded { damage: Some(cause), ..decoded });
    }
    Err(if marks.end.is_none() { Fault::CutShort(cause) } else { Fault::Damaged(cause) })
}

fn try_decode(bytes: &[u8], strict: bool) -> Result<Decoded, Fault> {
    // A second frame header must not make it larger than what memory was reserved for.
    let most = header(&mut Cursor::new(bytes))?;
    let side = |length: u64| usize::try_from(length).unwrap_or(usize::MAX);
    let options = DecoderOptions::default()
        .set_strict_mode(strict)
        .set_max_width(side(most.width))
        .set_max_height(side(most.height))
        .jpeg_set_max_scans(MOST_SCANS);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers()?;
    let source = decoder.input_colorspace();
    let grey = source == Some(ColorSpace::Luma);
    let out = if grey { ColorSpace::Luma } else { ColorSpace::RGB };
    decoder.set_options(decoder.options().jpeg_set_out_colorspace(out));
    let (width, height) = decoder.dimensions().ok_or_else(|| Fault::Damaged("it has no size".into()))?;
    let samples = decoder.decode()?;
    let pixels = if grey {
        Layers::of_grey::<1>(width, height, &samples).map(Pixels::Bytes)
    } else {
        Image::from_raw(width, height, samples).map(Pixels::from)
    };
    let mut metadata = Metadata { resolution: resolution(bytes), ..Metadata::default() };
    metadata.set_profile(decoder.icc_profile());
    metadata.set_exif(decoder.exif().cloned());
    metadata.leave_out(decoder.xmp().is_some(), XMP);
    metadata.leave_out(decoder.iptc().is_some(), "its IPTC");
    Ok(Decoded { pixels: pixels.map_err(|size| Fault::Damaged(size.to_string()))?, metadata, damage: None })
}

/// The density in the JFIF segment, which comes first.
fn resolution(bytes: &[u8]) -> Option<Resolution> {
    let segment = bytes.get(2..18)?;
    if segment[..2] != [0xff, 0xe0] || &segment[4..9] != b"JFIF\0" {
        return None;
    }
    let unit = match segment[11] {
        0 => ResolutionUnit::Unknown,
        1 => ResolutionUnit::Inch,
        2 => ResolutionUnit::Centimetre,
        _ => return None,
    };
    let density = |at: usize| f64::from(u16::from_be_bytes([segment[at], segment[at + 1]]));
    // Square pixels without a unit are what every file says that knows nothing.
    let known = Resolution { density: (density(12), density(14)), unit };
    (known.density.0 > 0.0
        && known.density.1 > 0.0
        && (unit, known.density) != (ResolutionUnit::Unknown, (1.0, 1.0)))
        .then_some(known)
}

impl From<DecodeErrors> for Fault {
    fn from(error: DecodeErrors) -> Self {
        match error {
            DecodeErrors::Unsupported(_) => Self::Unsupported(
                format!("coded in a rare way: {error:?}"),
                "Save it as a baseline or progressive JPEG first",
            ),
            DecodeErrors::LargeDimensions(_) => Self::TooLarge(format!("{error:?}")),
            // Its `Display` is silent about some errors.
            other => Self::Damaged(format!("{other:?}").replace('\n', " ")),
        }
    }
}

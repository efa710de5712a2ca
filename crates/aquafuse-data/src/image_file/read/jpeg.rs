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

/// Scans of a progressive image; more is an attack on our time.
const MOST_SCANS: usize = 50;
const END_OF_IMAGE: u8 = 0xd9;
const START_OF_SCAN: u8 = 0xda;
const PROGRESSIVE: u8 = 0xc2;

/// Size and components as the frame header has them, read as far as the first scan, which defines their coding.
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
        if let Some(coding) = other_coding(marker) {
            return Err(Fault::Unsupported(coding.into(), "Save it as an ordinary JPEG, as PNG or as TIFF"));
        }
        let read = match (marker, frame) {
            (START_OF_SCAN, Some((marker, [_, y1, y0, x1, x0, components]))) => {
                let mut scanned = [0];
                reader.read_exact(&mut scanned)?;
                let side = |high, low| u64::from(u16::from_be_bytes([high, low]));
                // All of the image's coefficients are held where they come in more than one scan; grey is tripled.
                let in_scans = marker == PROGRESSIVE || scanned[0] < components;
                let coefficients = if in_scans { u64::from(components).saturating_mul(2) } else { 0 };
                let beside = coefficients.saturating_add(u64::from(components == 1));
                return Ok(Size {
                    width: side(x1, x0),
                    height: side(y1, y0),
                    channels: 3,
                    sample: 1,
                    beside,
                    tables: 0,
                });
            }
            (START_OF_SCAN | END_OF_IMAGE, _) => {
                return Err(Fault::Damaged("it does not state its size".into()));
            }
            _ if is_frame(marker) => {
                let mut found = [0; 6];
                reader.read_exact(&mut found)?;
                frame = frame.or(Some((marker, found)));
                8
            }
            _ => 2,
        };
        // The length counts itself.
        let Some(rest) = u16::from_be_bytes(length).checked_sub(read) else {
            return Err(Fault::Damaged("a segment declares an impossible length".into()));
        };
        reader.seek(SeekFrom::Current(rest.into()))?;
    }
}

/// Frames of every coding; 0xc4, 0xc8 and 0xcc among them are tables.
fn is_frame(code: u8) -> bool {
    matches!(code, 0xc0..=0xcf) && !matches!(code, 0xc4 | 0xc8 | 0xcc)
}

/// What a frame is whose coding is not read: cameras, scanners and medicine have them.
fn other_coding(code: u8) -> Option<&'static str> {
    match code {
        0xc3 => Some("a lossless JPEG"),
        0xc5..=0xc7 | 0xcd..=0xcf => Some("a hierarchical JPEG"),
        0xc9..=0xcb => Some("a JPEG with arithmetic coding"),
        0xf7 => Some("a JPEG-LS"),
        _ => None,
    }
}

/// The code of the next marker; fill bytes before it are passed over.
fn next_marker(reader: &mut impl BufRead) -> Result<u8, Fault> {
    let mut byte = [0];
    reader.read_exact(&mut byte)?;
    if byte != [0xff] {
        return Err(Fault::Damaged("it holds data between its segments".into()));
    }
    while byte == [0xff] {
        reader.read_exact(&mut byte)?;
    }
    Ok(byte[0])
}

/// The marks of a file: where the image ends, which a file that was cut short does not say, and its scans.
#[derive(Default)]
struct Marks<'a> {
    /// The file up to where the image ends.
    before_end: Option<&'a [u8]>,
    scans: usize,
    /// Bytes of coded data in the first scan.
    first_scan: usize,
    progressive: bool,
    /// Columns and rows.
    size: (usize, usize),
}

impl<'a> Marks<'a> {
    fn of(bytes: &'a [u8]) -> Self {
        let mut marks = Self::default();
        let mut rest = bytes.get(2..).unwrap_or_default();
        loop {
            rest = match rest {
                [0xff, END_OF_IMAGE, ..] => {
                    marks.before_end = bytes.strip_suffix(rest);
                    break;
                }
                [0xff, 0x01 | 0xd0..=0xd8, after @ ..] => after,
                [0xff, after @ ..] if after.starts_with(&[0xff]) => after,
                &[0xff, code @ (0x02..), ref part @ ..] => {
                    let Some(length) = part.first_chunk() else { break };
                    if is_frame(code)
                        && let Some(&[_, _, _bits, y1, y0, x1, x0]) = part.first_chunk()
                    {
                        let side = |high, low| usize::from(u16::from_be_bytes([high, low]));
                        (marks.progressive, marks.size) = (code == PROGRESSIVE, (side(x1, x0), side(y1, y0)));
                    }
                    // The length counts itself.
                    let after = part.get(usize::from(u16::from_be_bytes(*length))..).unwrap_or_default();
                    if code == START_OF_SCAN {
                        let (coded, after) = split_coded(after);
                        if marks.scans == 0 {
                            marks.first_scan = coded.len();
                        }
                        marks.scans = marks.scans.saturating_add(1);
                        after
                    } else {
                        after
                    }
                }
                _ => break,
            }
        }
        marks
    }

    /// Whether the first scan is too short for a bit to each block: the first scan of every coding has one.
    fn lacks_data(&self) -> bool {
        let (across, down) = (self.size.0.div_ceil(LARGEST_BLOCK), self.size.1.div_ceil(LARGEST_BLOCK));
        self.first_scan < across.saturating_mul(down).div_ceil(8)
    }
}

/// Side of what may be coded as one, in pixels: four blocks of eight.
const LARGEST_BLOCK: usize = 32;

/// Splits where coded data ends: at a marker that is neither stuffing, nor a restart, nor fill.
fn split_coded(bytes: &[u8]) -> (&[u8], &[u8]) {
    let marker = bytes.windows(2).position(|pair| matches!(pair, [0xff, 0x01..=0xcf | 0xd8..=0xfe]));
    marker.and_then(|at| bytes.split_at_checked(at)).unwrap_or((bytes, &[]))
}

pub(super) fn decode(bytes: &[u8], lenient: bool) -> Result<Decoded, Fault> {
    let marks = Marks::of(bytes);
    if marks.scans > MOST_SCANS {
        return Err(Fault::Unsupported(
            format!("in {} scans", marks.scans),
            "Save it as a baseline JPEG first",
        ));
    }
    // Without the mark of the end the decoder can distinguish missing data from present data: where it
    // meets a mark it takes zeros for the rest. Of a progressive image it wants to see the mark.
    let strictly = marks.before_end.filter(|_| !marks.progressive).unwrap_or(bytes);
    let cause = match (try_decode(strictly, true), marks.before_end) {
        (Ok(_), _) if marks.lacks_data() => "it declares more blocks of pixels than it has bits".into(),
        (Ok(decoded), Some(_)) => return Ok(decoded),
        (Ok(_), None) => "its end is missing".into(),
        (Err(Fault::Damaged(cause)), _) => cause,
        (Err(other), _) => return Err(other),
    };
    if lenient {
        let decoded = try_decode(bytes, false)?;
        return Ok(Decoded { damage: Some(cause), ..decoded });
    }
    Err(if marks.before_end.is_none() { Fault::CutShort(cause) } else { Fault::Damaged(cause) })
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
        Layers::of_grey(width, height, &samples).map(Pixels::Bytes)
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
    let &[0xff, 0xe0, _, _, b'J', b'F', b'I', b'F', 0, _, _, unit, x1, x0, y1, y0] =
        bytes.get(2..)?.first_chunk()?
    else {
        return None;
    };
    let unit = match unit {
        0 => ResolutionUnit::Unknown,
        1 => ResolutionUnit::Inch,
        2 => ResolutionUnit::Centimetre,
        _ => return None,
    };
    let density = |high, low| f64::from(u16::from_be_bytes([high, low]));
    // Square pixels without a unit are what every file says that knows nothing.
    let known = Resolution { density: (density(x1, x0), density(y1, y0)), unit };
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

//! JPEG within TIFF (the new way, compression 7): each strip or tile is a JPEG stream, whose tables the page may hold.

use std::io::{Cursor, Read, Seek};

use ::tiff::decoder::{ChunkType, Decoder};
use ::tiff::tags::Tag;
use aquafuse::image::Image;

use super::super::super::limits::Size;
use super::super::{Fault, Pixels, jpeg};

/// The number of this compression.
const JPEG: u16 = 7;
/// The numbers of a page's colours: grey, RGB, and brightness with two differences of colour.
const GREY: u16 = 1;
const RGB: u16 = 2;
const YCBCR: u16 = 6;
const START_OF_IMAGE: [u8; 2] = [0xff, 0xd8];
const END_OF_IMAGE: [u8; 2] = [0xff, 0xd9];
/// Adobe's segment up to its last byte: whether three components are RGB (0) or differences of colour (1). A piece does not
/// say so, but its page does.
const ADOBE: [u8; 15] = [0xff, 0xee, 0, 14, b'A', b'd', b'o', b'b', b'e', 0, 100, 0, 0, 0, 0];
/// Bytes of a pixel that decoding a piece takes: its samples, and its coefficients where it comes in several scans.
const DECODING: u64 = 3 + 1 + 6;

/// Whether a page is compressed in this way.
pub(super) fn is_jpeg(page: &mut Decoder<impl Read + Seek>) -> bool {
    page.find_tag_unsigned::<u16>(Tag::Compression).is_ok_and(|way| way == Some(JPEG))
}

/// Size and memory of such a page, as its fields say.
pub(super) fn header(page: &mut Decoder<impl Read + Seek>) -> Result<Size, Fault> {
    let grid = Grid::of(page)?;
    let [width, height] = grid.page.map(u64::from);
    let [across, down] = grid.piece.map(u64::from);
    let tables = across.saturating_mul(down).saturating_mul(DECODING);
    Ok(Size { width, height, channels: 3, sample: 1, beside: 0, tables })
}

/// How a page is cut into pieces, and what their pixels are.
struct Grid {
    /// Columns and rows of the page, and of a whole piece.
    page: [u32; 2],
    piece: [u32; 2],
    /// Whether the pieces are padded to one size: tiles are.
    is_padded: bool,
    /// What Adobe calls the transform of its three components; none where it is grey.
    transform: Option<u8>,
}

impl Grid {
    fn of(page: &mut Decoder<impl Read + Seek>) -> Result<Self, Fault> {
        let mut field =
            |tag, default| page.find_tag_unsigned::<u16>(tag).map(|value| value.unwrap_or(default));
        let (samples, planes) = (field(Tag::SamplesPerPixel, 1)?, field(Tag::PlanarConfiguration, 1)?);
        let colours = field(Tag::PhotometricInterpretation, GREY)?;
        let transform = match (colours, samples, planes) {
            (GREY, 1, 1) => None,
            (RGB, 3, 1) => Some(0),
            (YCBCR, 3, 1) => Some(1),
            _ => {
                return Err(Fault::Unsupported(
                    "a TIFF compressed as JPEG that is neither grey nor RGB nor YCbCr".into(),
                    "Save it with LZW, deflate or no compression, or as a JPEG",
                ));
            }
        };
        let (width, height) = page.dimensions()?;
        let (across, down) = page.chunk_dimensions();
        let is_padded = matches!(page.get_chunk_type(), ChunkType::Tile);
        let piece = if is_padded { [across, down] } else { [width, down.min(height)] };
        let grid = Self { page: [width, height], piece, is_padded, transform };
        match piece {
            [(1..), (1..)] => Ok(grid),
            [across, down] => {
                Err(Fault::Damaged(format!("its strips or tiles are of {across}x{down} pixels")))
            }
        }
    }

    /// The first column and row of a piece, and how many of its columns and rows are of the page; `None` below the page.
    fn place(&self, number: u32) -> Option<([u32; 2], [u32; 2])> {
        let ([width, height], [wide, high]) = (self.page, self.piece);
        let across = width.div_ceil(wide);
        let column = number.checked_rem(across)?.checked_mul(wide)?;
        let row = number.checked_div(across)?.checked_mul(high)?;
        let rest = [width.checked_sub(column)?, height.checked_sub(row).filter(|rest| *rest > 0)?];
        Some(([column, row], [wide.min(rest[0]), high.min(rest[1])]))
    }
}

/// Decodes such a page. A piece is measured before it is decoded: none may be larger than its place.
pub(super) fn decode(bytes: &[u8]) -> Result<Pixels, Fault> {
    let mut page = Decoder::new(Cursor::new(bytes))?;
    let grid = Grid::of(&mut page)?;
    let (offsets, lengths) = if grid.is_padded {
        (Tag::TileOffsets, Tag::TileByteCounts)
    } else {
        (Tag::StripOffsets, Tag::StripByteCounts)
    };
    let (mut offsets, mut lengths) =
        (page.get_tag_u64_vec(offsets)?.into_iter(), page.get_tag_u64_vec(lengths)?.into_iter());
    let tables = match page.find_tag(Tag::JPEGTables)? {
        Some(tables) => tables.into_u8_vec()?,
        None => Vec::new(),
    };
    let says = grid.transform.map(|transform| [&ADOBE[..], &[transform]].concat()).unwrap_or_default();
    let begin = [&START_OF_IMAGE[..], &says, between_ends(&tables)].concat();
    let [width, height] = grid.page.map(|side| side as usize);
    let mut samples = vec![0; width.saturating_mul(height).saturating_mul(3)];
    let mut number = 0_u32;
    while let Some((corner, of_page)) = grid.place(number) {
        let damaged = |cause: &str| Fault::Damaged(format!("its strip or tile {number} {cause}"));
        let (Some(first), Some(length)) = (offsets.next(), lengths.next()) else {
            return Err(damaged("is missing"));
        };
        let piece = part(bytes, first, length).ok_or_else(|| damaged("lies beyond the file's end"))?;
        let coded = piece.strip_prefix(&START_OF_IMAGE).ok_or_else(|| damaged("is no JPEG"))?;
        let image = decode_piece(&grid, of_page, &[&begin, coded].concat()).map_err(|fault| match fault {
            Fault::Damaged(cause) | Fault::CutShort(cause) => damaged(&format!("is damaged: {cause}")),
            other => other,
        })?;
        let [column, row, columns, rows] =
            [corner[0], corner[1], of_page[0], of_page[1]].map(|side| side as usize);
        let below = samples.chunks_exact_mut(width.saturating_mul(3)).skip(row).take(rows);
        for (to, from) in below.zip(image.rows()) {
            let to = to.iter_mut().skip(column.saturating_mul(3));
            to.zip(from.as_flattened().iter().take(columns.saturating_mul(3)))
                .for_each(|(to, from)| *to = *from);
        }
        number = number.saturating_add(1);
    }
    Image::from_raw(width, height, samples).map(Pixels::from).map_err(|size| Fault::Damaged(size.to_string()))
}

/// Decodes a piece of which so many columns and rows are of the page.
fn decode_piece(grid: &Grid, of_page: [u32; 2], stream: &[u8]) -> Result<Image<u8>, Fault> {
    let found = jpeg::header(&mut Cursor::new(stream))?;
    let fits = [grid.piece, of_page].iter().any(|size| [found.width, found.height] == size.map(u64::from));
    if !fits {
        let (Size { width, height, .. }, [across, down]) = (found, grid.piece);
        return Err(Fault::Damaged(format!("it has {width}x{height} pixels instead of {across}x{down}")));
    }
    match jpeg::decode(stream, false)?.pixels {
        Pixels::Bytes(layers) => Ok(layers.image),
        _ => Err(Fault::Damaged("it is not of bytes".into())),
    }
}

/// Tables without the marks of begin and end around them.
fn between_ends(tables: &[u8]) -> &[u8] {
    let tables = tables.strip_prefix(&START_OF_IMAGE).unwrap_or(tables);
    tables.strip_suffix(&END_OF_IMAGE).unwrap_or(tables)
}

fn part(bytes: &[u8], first: u64, length: u64) -> Option<&[u8]> {
    let first = usize::try_from(first).ok()?;
    bytes.get(first..first.checked_add(usize::try_from(length).ok()?)?)
}

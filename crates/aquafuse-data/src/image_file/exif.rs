//! EXIF blocks: what has to be read of them, and how they get from one format into another.
//!
//! JPEG, PNG and WebP hold EXIF as a block, which is a TIFF file without pixels; in a TIFF file it is part of the
//! file's own directory. Between blocks it travels byte for byte, but for two fields changed in place. Into and out
//! of TIFF the fields are written again: all of the main, the EXIF, the GPS and the interoperability directory.

use std::io::Cursor;
use std::ops::Range;

use ::tiff::TiffResult;
use ::tiff::encoder::{DirectoryEncoder, TiffEncoder, TiffKindStandard};
use ::tiff::tags::{Tag, Type};

use super::metadata::{Resolution, ResolutionUnit};

/// Fields of the directories of an EXIF block or a TIFF file; values in this machine's byte order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Exif {
    fields: Vec<Field>,
    /// Directories that a field of the main one, or of the EXIF one, points to.
    inner: Vec<(u16, Exif)>,
}

#[derive(Clone, Debug, PartialEq)]
struct Field {
    tag: u16,
    kind: Type,
    bytes: Vec<u8>,
}

const ORIENTATION: u16 = 0x0112;
const DESCRIPTION: u16 = 0x010e;
const X_RESOLUTION: u16 = 0x011a;
const Y_RESOLUTION: u16 = 0x011b;
/// Fields that point to further directories: EXIF, GPS, and, in EXIF, interoperability.
const INNER: [u16; 3] = [0x8769, 0x8825, 0xa005];
/// Tags about how pixels are stored: they hold only for their own file. Size, bits, compression,
/// strips, tiles, planes, palette, predictor, sample format, JPEG tables, subsampling, reference black and white.
const OF_STORAGE: [u16; 32] = [
    0x00fe, 0x00ff, 0x0100, 0x0101, 0x0102, 0x0103, 0x0106, 0x010a, 0x0111, 0x0115, 0x0116, 0x0117, 0x0118,
    0x0119, 0x011c, 0x013d, 0x0140, 0x0142, 0x0143, 0x0144, 0x0145, 0x014a, 0x0152, 0x0153, 0x015b, 0x0200,
    0x0201, 0x0202, 0x0211, 0x0212, 0x0213, 0x0214,
];
/// The colour profile of a TIFF file travels by itself.
const PROFILE: u16 = 0x8773;
/// More fields than any camera writes, in all directories together.
const MOST_FIELDS: usize = 4096;
/// EXIF in main, interoperability in EXIF: deeper there is nothing, but a loop.
const INNER_LEVELS: usize = 2;
/// Bytes of an entry.
const ENTRY: usize = 12;

/// What is still taken: fields may all point to the same bytes, and would grow without end.
struct Allowance {
    fields: usize,
    bytes: usize,
}

/// Reads numbers of a block in its byte order; none past its end.
struct Block<'a> {
    bytes: &'a [u8],
    little: bool,
}

/// An entry of a directory: what kind of value a tag has, and how many of them.
struct Entry {
    tag: u16,
    kind: Option<Type>,
    count: usize,
    /// Where the value stands, if it does not fit into four bytes.
    offset: usize,
    /// Where the four bytes of the offset stand, or of the value that fits into them.
    place: Range<usize>,
}

impl<'a> Block<'a> {
    fn new(bytes: &'a [u8]) -> Option<Self> {
        let little = match bytes.get(..4)? {
            [b'I', b'I', 42, 0] => true,
            [b'M', b'M', 0, 42] => false,
            _ => return None,
        };
        Some(Self { bytes, little })
    }

    /// Takes a number of 16 bits.
    fn short(&self, rest: &mut &[u8]) -> Option<u16> {
        let bytes = *rest.split_off(..2)?.first_chunk()?;
        Some(if self.little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) })
    }

    /// Takes a number of 32 bits: a count or an offset.
    fn long(&self, rest: &mut &[u8]) -> Option<usize> {
        let bytes = *rest.split_off(..4)?.first_chunk()?;
        let long = if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) };
        usize::try_from(long).ok()
    }

    /// Where the main directory stands.
    fn main(&self) -> Option<usize> {
        self.long(&mut self.bytes.get(4..)?)
    }

    /// Where the entries of the directory at `at` stand.
    fn directory(&self, at: usize) -> Option<Range<usize>> {
        let count = self.short(&mut self.bytes.get(at..)?)?;
        let first = at.checked_add(2)?;
        let end = usize::from(count).checked_mul(ENTRY)?.checked_add(first)?;
        (end <= self.bytes.len()).then_some(first..end)
    }

    fn entries(&self, at: usize) -> Option<impl Iterator<Item = Entry>> {
        Some(self.directory(at)?.step_by(ENTRY).map_while(|at| self.entry(at)))
    }

    fn entry(&self, at: usize) -> Option<Entry> {
        let (value, end) = (at.checked_add(8)?, at.checked_add(ENTRY)?);
        let mut rest = self.bytes.get(at..end)?;
        Some(Entry {
            tag: self.short(&mut rest)?,
            kind: Type::from_u16(self.short(&mut rest)?),
            count: self.long(&mut rest)?,
            offset: self.long(&mut rest)?,
            place: value..end,
        })
    }

    /// The value of an entry in this machine's byte order.
    fn value(&self, entry: &Entry) -> Option<Field> {
        let (kind, place) = entry.value()?;
        let mut bytes = self.bytes.get(place)?.to_vec();
        let size = size_of_kind(kind)?;
        if self.little != cfg!(target_endian = "little") {
            let word = if matches!(kind, Type::RATIONAL | Type::SRATIONAL) { 4 } else { size };
            bytes.chunks_exact_mut(word).for_each(<[u8]>::reverse);
        }
        Some(Field { tag: entry.tag, kind, bytes })
    }

    /// The entry of a tag in the main directory.
    fn main_entry(&self, tag: u16) -> Option<Entry> {
        self.entries(self.main()?)?.find(|entry| entry.tag == tag)
    }
}

impl Entry {
    /// What kind of value it has, and where: in itself where it fits.
    fn value(&self) -> Option<(Type, Range<usize>)> {
        let kind = self.kind?;
        let length = size_of_kind(kind)?.checked_mul(self.count)?;
        let at = if length <= 4 { self.place.start } else { self.offset };
        Some((kind, at..at.checked_add(length)?))
    }
}

fn size_of_kind(kind: Type) -> Option<usize> {
    match kind {
        Type::BYTE | Type::ASCII | Type::SBYTE | Type::UNDEFINED => Some(1),
        Type::SHORT | Type::SSHORT => Some(2),
        Type::LONG | Type::SLONG | Type::FLOAT | Type::IFD => Some(4),
        Type::RATIONAL | Type::SRATIONAL | Type::DOUBLE => Some(8),
        _ => None,
    }
}

impl Exif {
    /// The fields of a block, or of a TIFF file; none if it is neither. A field whose value lies outside is left out.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let block = Block::new(bytes)?;
        let mut left = Allowance { fields: MOST_FIELDS, bytes: bytes.len() };
        let mut exif = Self::directory(&block, block.main()?, INNER_LEVELS, &mut left)?;
        exif.fields.retain(|field| !OF_STORAGE.contains(&field.tag) && field.tag != PROFILE);
        Some(exif)
    }

    fn directory(block: &Block<'_>, at: usize, levels: usize, left: &mut Allowance) -> Option<Self> {
        let mut read = Self::default();
        for entry in block.entries(at)? {
            left.fields = left.fields.checked_sub(1)?;
            let tag = entry.tag;
            if INNER.contains(&tag) {
                let inner = levels
                    .checked_sub(1)
                    .and_then(|levels| Self::directory(block, entry.offset, levels, left));
                if read.inner.iter().all(|(known, _)| *known != tag) {
                    read.inner.extend(inner.map(|inner| (tag, inner)));
                }
            } else if read.fields.iter().all(|field| field.tag != tag) {
                // Of two fields of one tag, which no directory may hold, readers take the first.
                let length = entry.value().map_or(0, |(_, place)| place.len());
                left.bytes = left.bytes.checked_sub(length)?;
                read.fields.extend(block.value(&entry));
            }
        }
        Some(read)
    }

    /// The resolution of the main directory; inches where it names no unit.
    pub(super) fn resolution(&self) -> Option<Resolution> {
        let density = |tag: u16| {
            let field = self.fields.iter().find(|field| field.tag == tag && field.kind == Type::RATIONAL)?;
            let ratio = field.bytes.as_chunks().0.first_chunk()?;
            let [above, below] = ratio.map(|long| f64::from(u32::from_ne_bytes(long)));
            Some(above / below).filter(|density| *density > 0.0)
        };
        let unit = self.fields.iter().find(|field| field.tag == 0x0128 && field.kind == Type::SHORT);
        let unit = match unit.map(|field| field.bytes.as_slice()) {
            Some(&[a, b, ..]) if u16::from_ne_bytes([a, b]) == 1 => ResolutionUnit::Unknown,
            Some(&[a, b, ..]) if u16::from_ne_bytes([a, b]) == 3 => ResolutionUnit::Centimetre,
            _ => ResolutionUnit::Inch,
        };
        let density = (density(X_RESOLUTION)?, density(Y_RESOLUTION)?);
        (density.0.is_finite() && density.1.is_finite()).then_some(Resolution { density, unit })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.fields.is_empty() && self.inner.is_empty()
    }

    /// Sets a text of the main directory, after what stands there.
    fn add_description(&mut self, text: &str) {
        let before = self.fields.iter().position(|field| field.tag == DESCRIPTION);
        let mut bytes = before.map(|at| self.fields.remove(at).bytes).unwrap_or_default();
        bytes.retain(|&byte| byte != 0);
        if !bytes.is_empty() {
            bytes.extend(b"; ");
        }
        bytes.extend(text.bytes().filter(u8::is_ascii));
        bytes.push(0);
        self.fields.push(Field { tag: DESCRIPTION, kind: Type::ASCII, bytes });
    }

    /// As a block.
    pub(super) fn to_block(&self) -> TiffResult<Vec<u8>> {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file)?;
        let inner = self.write_inner(&mut encoder)?;
        let mut directory = encoder.image_directory()?;
        self.write_fields(&mut directory, &inner)?;
        directory.finish()?;
        Ok(file.into_inner())
    }

    /// Writes the directories that fields point to, and says where.
    pub(super) fn write_inner<W: std::io::Write + std::io::Seek>(
        &self,
        encoder: &mut TiffEncoder<W, TiffKindStandard>,
    ) -> TiffResult<Vec<(u16, u32)>> {
        let mut written = Vec::new();
        for (tag, exif) in &self.inner {
            let further = exif.write_inner(encoder)?;
            let mut directory = encoder.extra_directory()?;
            exif.write_fields(&mut directory, &further)?;
            written.push((*tag, directory.finish_with_offsets()?.offset));
        }
        Ok(written)
    }

    /// Writes the fields into a directory, `inner` among them.
    pub(super) fn write_fields<W: std::io::Write + std::io::Seek>(
        &self,
        directory: &mut DirectoryEncoder<'_, W, TiffKindStandard>,
        inner: &[(u16, u32)],
    ) -> TiffResult<()> {
        for field in &self.fields {
            let entry = directory.write_entry_bytes(field.kind, &field.bytes)?;
            directory
                .extend_from(&::tiff::Directory::from_iter([(Tag::from_u16_exhaustive(field.tag), entry)]));
        }
        for &(tag, at) in inner {
            directory.write_tag(Tag::from_u16_exhaustive(tag), at)?;
        }
        Ok(())
    }
}

/// The colour profile of a TIFF file.
pub(super) fn profile(file: &[u8]) -> Option<Vec<u8>> {
    let block = Block::new(file)?;
    Some(block.value(&block.main_entry(PROFILE)?)?.bytes)
}

/// The orientation a block holds, 1 to 8; 1 where it holds none.
pub(super) fn orientation(block: &[u8]) -> u8 {
    let read = || {
        let block = Block::new(block)?;
        let field = block.value(&block.main_entry(ORIENTATION)?)?;
        let value = match field.kind {
            Type::SHORT => u32::from(u16::from_ne_bytes(*field.bytes.first_chunk()?)),
            Type::LONG => u32::from_ne_bytes(*field.bytes.first_chunk()?),
            Type::BYTE => u32::from(*field.bytes.first()?),
            _ => return None,
        };
        u8::try_from(value).ok().filter(|value| (1..=8).contains(value))
    };
    read().unwrap_or(1)
}

/// Sets the orientation of a block to 1, if it holds one.
pub(super) fn set_upright(bytes: &mut [u8]) {
    let place = Block::new(bytes).and_then(|block| {
        let (kind, place) = block.main_entry(ORIENTATION)?.value()?;
        let value: &[u8] = match (kind, block.little) {
            (Type::BYTE, _) => &[1],
            (Type::SHORT, true) => &[1, 0],
            (Type::SHORT, false) => &[0, 1],
            (Type::LONG, true) => &[1, 0, 0, 0],
            (Type::LONG, false) => &[0, 0, 0, 1],
            _ => return None,
        };
        Some((place, value))
    });
    if let Some((place, value)) = place
        && let Some(stored) = bytes.get_mut(place)
        && let Some(first) = stored.get_mut(..value.len())
    {
        first.copy_from_slice(value);
    }
}

/// Exchanges the resolutions across and down, for an image that is turned onto its side.
pub(super) fn exchange_resolution(bytes: &mut [u8]) {
    let offsets = Block::new(bytes).and_then(|block| {
        let offset = |tag: u16| {
            let entry = block.main_entry(tag)?;
            (entry.kind == Some(Type::RATIONAL) && entry.count == 1).then_some(entry.place)
        };
        Some([offset(X_RESOLUTION)?, offset(Y_RESOLUTION)?])
    });
    if let Some(offsets) = offsets
        && let Ok([x, y]) = bytes.get_disjoint_mut(offsets)
    {
        x.swap_with_slice(y);
    }
}

/// Takes the link to the thumbnail away: it shows the image as it was.
pub(super) fn unlink_thumbnail(bytes: &mut [u8]) {
    // It stands behind the entries.
    let link = Block::new(bytes).and_then(|block| Some(block.directory(block.main()?)?.end));
    if let Some(link) = link.and_then(|at| bytes.get_mut(at..)?.first_chunk_mut::<4>()) {
        link.fill(0);
    }
}

/// A block with `text` in its description, after what stands there already.
pub(super) fn with_description(block: Option<&[u8]>, text: &str) -> TiffResult<Vec<u8>> {
    let mut exif = block.and_then(Exif::read).unwrap_or_default();
    exif.add_description(text);
    exif.to_block()
}

/// Does with a block whatever is ever done with one: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_exif(bytes: &[u8]) {
    let _ = (orientation(bytes), profile(bytes), with_description(Some(bytes), "fuzz"));
    if let Some(exif) = Exif::read(bytes) {
        let _ = exif.resolution();
        let block = exif.to_block().expect("fields that were read can be written");
        assert_eq!(Exif::read(&block).expect("what was written can be read").fields.len(), exif.fields.len());
    }
    let mut block = bytes.to_vec();
    unlink_thumbnail(&mut block);
    set_upright(&mut block);
    assert_eq!(orientation(&block), 1);
}

#[cfg(test)]
mod tests;

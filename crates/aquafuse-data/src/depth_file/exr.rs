//! OpenEXR: one channel of one flat layer.

use std::io::{self, BufRead, Cursor, Read, Seek};

use ::exr::block;
use ::exr::compression::Compression;
use ::exr::error::Error;
use ::exr::image::write::WritableImage;
use ::exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image};
use ::exr::math::Vec2;
use ::exr::meta::attribute::LineOrder;
use ::exr::meta::header::Header;
use ::exr::prelude::{ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _, Text, read};
use aquafuse::depth::DepthMap;

use super::{Fault, MOST_BYTES, Raster, Wanted, check_size};

/// The names of depth, in the order in which they are looked for.
const CHANNELS: [&str; 3] = ["Z", "Y", "R"];

/// Attributes of all headers of a file; programs write some tens.
const MOST_ATTRIBUTES: usize = 10_000;
/// Bytes of them together; a preview has some tens of thousands.
const MOST_OF_ATTRIBUTES: u64 = 4 << 20;

pub(super) fn decode(mut reader: impl BufRead + Seek, wanted: Wanted) -> Result<Raster, Fault> {
    check_attributes(&mut reader)?;
    reader.rewind()?;
    let chunks = block::read(reader, false)?;
    for header in chunks.headers() {
        check(header, wanted)?;
    }
    let name = chunks.headers().first().and_then(channel).ok_or_else(|| {
        Fault::Unsupported(
            "several channels, none of them Z, Y or R".into(),
            "Save the one channel that is depth, named Z",
        )
    })?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(name)
        .collect_pixels(
            |size: Vec2<usize>, _| Raster {
                width: size.0,
                height: size.1,
                values: vec![0.0; size.0.saturating_mul(size.1)],
                full_range: None,
            },
            |raster, Vec2(x, y), (value,): (f32,)| {
                // The decoder names no position outside of the declared size.
                let place = y.checked_mul(raster.width).and_then(|row| row.checked_add(x));
                if let Some(stored) = place.and_then(|place| raster.values.get_mut(place)) {
                    *stored = value;
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_chunks(chunks)?;
    Ok(image.layer_data.channel_data.pixels)
}

/// Refuses headers of more attributes, or of longer ones, than any program writes: each takes the decoder a kilobyte, be it
/// of ten bytes, and an empty text in one tenfold its length. What is no header is left to the decoder.
fn check_attributes(reader: &mut (impl BufRead + Seek)) -> Result<(), Fault> {
    let (mut start, mut attributes, mut names, mut bytes) = ([0; 8], 0_usize, 0_usize, 0_u64);
    reader.read_exact(&mut start)?;
    let has_parts = start[5] & 0x10 != 0;
    loop {
        // An empty name ends a header, and an empty header the last one.
        match (reader.fill_buf()?.first(), names) {
            (Some(0), 0) => return Ok(()),
            (Some(0), _) if !has_parts => return Ok(()),
            (Some(0), _) => {
                reader.consume(1);
                names = 0;
                continue;
            }
            (Some(_), _) => {}
            (None, _) => return Ok(()),
        }
        let mut length = [0; 4];
        if !pass_text(reader)? || !pass_text(reader)? || reader.read_exact(&mut length).is_err() {
            return Ok(());
        }
        let Ok(length) = u32::try_from(i32::from_le_bytes(length)) else { return Ok(()) };
        (attributes, names) = (attributes.saturating_add(1), names.saturating_add(1));
        bytes = bytes.saturating_add(length.into());
        if attributes > MOST_ATTRIBUTES || bytes > MOST_OF_ATTRIBUTES {
            return Err(Fault::Unsupported(
                format!("headers of {attributes} attributes and {bytes} bytes or more"),
                "Save it again with only the depth channel",
            ));
        }
        reader.seek_relative(length.into())?;
    }
}

/// Passes a text as the decoder does: a letter, whatever it is, and all up to the next zero. False where it is none.
fn pass_text(reader: &mut impl BufRead) -> io::Result<bool> {
    let mut text = Vec::new();
    reader.take(1).read_to_end(&mut text)?;
    reader.take(1 << 10).read_until(0, &mut text)?;
    Ok(text.len() > 1 && text.ends_with(&[0]))
}

/// Refuses what would take too much memory, and what is no flat image.
fn check(header: &Header, wanted: Wanted) -> Result<(), Fault> {
    if header.deep {
        return Err(Fault::Unsupported("deep data".into(), "Flatten it to one value per pixel"));
    }
    // The decoder of DWA makes room for as many numbers as a block says, and a block can say anything.
    use Compression::{B44, B44A, PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
    if !matches!(header.compression, Uncompressed | RLE | ZIP1 | ZIP16 | PIZ | PXR24 | B44 | B44A) {
        return Err(Fault::Unsupported(
            format!("numbers in {}", header.compression),
            "Save it with ZIP, PIZ or no compression",
        ));
    }
    let whole = |length: usize| length as u64;
    let bytes = whole(header.channels.bytes_per_pixel);
    check_size(wanted, whole(header.layer_size.0), whole(header.layer_size.1), bytes)?;
    let Vec2(columns, rows) = header.max_block_pixel_size();
    let block = whole(columns).checked_mul(whole(rows)).and_then(|pixels| pixels.checked_mul(bytes.max(4)));
    if block.is_none_or(|block| block > MOST_BYTES) {
        return Err(Fault::TooLarge(format!("blocks of {columns}x{rows} values exceed the limit")));
    }
    Ok(())
}

fn channel(header: &Header) -> Option<Text> {
    let channels = &header.channels.list;
    let known = CHANNELS.into_iter().find_map(|name| channels.iter().find(|channel| channel.name == *name));
    let only = channels.first().filter(|_| channels.len() == 1);
    known.or(only).map(|channel| channel.name.clone())
}

pub(super) fn encode(depth: &DepthMap) -> Result<Vec<u8>, String> {
    let [name, ..] = CHANNELS;
    let channels = AnyChannels::sort(vec![AnyChannel::new(name, FlatSamples::F32(depth.distances()))].into());
    let mut file = Cursor::new(Vec::new());
    // Scan lines and ZIP: what every reader can.
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    Image::from_encoded_channels(depth.size(), encoding, channels)
        .write()
        .non_parallel()
        .to_buffered(&mut file)
        .map_err(|error| error.to_string())?;
    Ok(file.into_inner())
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        match error {
            Error::Io(error) => error.into(),
            Error::NotSupported(found) => {
                Self::Unsupported(found.into_owned(), "Save it as one flat channel of 32-bit float, named Z")
            }
            other => Self::Damaged(other.to_string()),
        }
    }
}

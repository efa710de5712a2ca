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

pub(super) fn decode(mut reader: impl BufRead + Seek, wanted: Wanted) -> Result<Raster, Fault> {
    if count_attributes(&mut reader)? > MOST_ATTRIBUTES {
        return Err(Fault::TooLarge(format!("its headers have more than {MOST_ATTRIBUTES} attributes")));
    }
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
                // The decoder names no place outside of the size that it told.
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

/// Counts the attributes of the headers, as far as they go: each takes the decoder a kilobyte, be it of ten bytes.
fn count_attributes(reader: &mut (impl BufRead + Seek)) -> io::Result<usize> {
    let (mut start, mut attributes, mut names) = ([0; 8], 0, 0_usize);
    reader.read_exact(&mut start)?;
    let has_parts = start[5] & 0x10 != 0;
    while attributes <= MOST_ATTRIBUTES {
        match text_length(reader)? {
            // An empty name ends a header, and an empty header the last one.
            Some(0) if !has_parts || names == 0 => break,
            Some(0) => names = 0,
            Some(_) => {
                let mut length = [0; 4];
                if text_length(reader)?.is_none() || reader.read_exact(&mut length).is_err() {
                    break;
                }
                reader.seek_relative(i32::from_le_bytes(length).max(0).into())?;
                (attributes, names) = (attributes.saturating_add(1), names.saturating_add(1));
            }
            None => break,
        }
    }
    Ok(attributes)
}

/// Letters of a text that ends in zero, if it is none of more than 255.
fn text_length(reader: &mut impl BufRead) -> io::Result<Option<usize>> {
    let mut text = Vec::new();
    reader.take(256).read_until(0, &mut text)?;
    Ok(text.strip_suffix(&[0]).map(<[u8]>::len))
}

/// Refuses what would take too much memory, and what is no flat picture.
fn check(header: &Header, wanted: Wanted) -> Result<(), Fault> {
    if header.deep {
        return Err(Fault::Unsupported("deep data".into(), "Flatten it to one value a pixel"));
    }
    let whole = |length: usize| length as u64;
    let bytes = whole(header.channels.bytes_per_pixel);
    check_size(wanted, whole(header.layer_size.0), whole(header.layer_size.1), bytes)?;
    let Vec2(columns, rows) = header.max_block_pixel_size();
    let block = whole(columns).checked_mul(whole(rows)).and_then(|pixels| pixels.checked_mul(bytes.max(4)));
    if block.is_none_or(|block| block > MOST_BYTES) {
        return Err(Fault::TooLarge(format!("blocks of {columns}x{rows} values are too many")));
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

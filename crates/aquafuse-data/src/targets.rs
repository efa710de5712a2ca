//! Every parser by itself: what is fuzzed, and what the tests replay.
//!
//! A target takes any bytes. It returns when they were refused with an error or read, and panics when a promise
//! about what was read is broken.

mod replay;

use std::path::Path;

use aquafuse::depth::SuppliedKind;
use aquafuse::fusion::Options;
use aquafuse::image::{Image, Sample as _, TopEdge};
use aquafuse::scene_area::Border;
use aquafuse::waterbody::WaterMap;

use crate::augment::try_coco;
use crate::augment::try_manifest;
use crate::bag::try_message;
use crate::batch;
use crate::dataset::{try_shards, try_tables, try_voc, try_yolo};
use crate::depth_file;
use crate::depth_network::{DepthNetwork, NetworkKind, NetworkOptions};
use crate::files::FileError;
use crate::image_file::{Format, ImageFile, Pixels, ReadOptions, try_exif};
use crate::model_file::ModelFile;
use crate::pipeline::{DepthSource, Operation, PixelEncoding, analyse_in};
use crate::video::{try_log, try_y4m};
use crate::water_file::WaterFile;

pub use replay::replay;

/// A parser that takes bytes from outside.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name, and that of its folder of examples.
    pub name: &'static str,
    /// Feeds it.
    pub run: fn(&[u8]),
}

/// Messages in logs of robots.
pub const BAG_MESSAGE: Target = Target { name: "bag-message", run: |bytes| try_message(bytes, &LIMITS) };
/// Images as BMP.
pub const BMP: Target = Target { name: "bmp", run: |bytes| image(Format::Bmp, bytes) };
/// EXIF blocks.
pub const EXIF: Target = Target { name: "exif", run: try_exif };
/// Images as GIF.
pub const GIF: Target = Target { name: "gif", run: |bytes| image(Format::Gif, bytes) };
/// Images as JPEG.
pub const JPEG: Target = Target { name: "jpeg", run: |bytes| image(Format::Jpeg, bytes) };
/// Images as PNG.
pub const PNG: Target = Target { name: "png", run: |bytes| image(Format::Png, bytes) };
/// Images as TIFF.
pub const TIFF: Target = Target { name: "tiff", run: |bytes| image(Format::Tiff, bytes) };
/// Images as WebP.
pub const WEBP: Target = Target { name: "webp", run: |bytes| image(Format::WebP, bytes) };
/// Depth maps of COLMAP.
pub const DEPTH_COLMAP: Target = Target { name: "depth-colmap", run: |bytes| depth(b"", bytes) };
/// Depth maps as OpenEXR.
pub const DEPTH_EXR: Target = Target { name: "depth-exr", run: |bytes| depth(b"\x76\x2f\x31\x01", bytes) };
/// Networks of depth as ONNX.
pub const DEPTH_NETWORK: Target = Target { name: "depth-network", run: network };
/// Depth maps as NPY.
pub const DEPTH_NPY: Target = Target { name: "depth-npy", run: |bytes| depth(b"\x93NUMPY", bytes) };
/// Depth maps as PFM.
pub const DEPTH_PFM: Target = Target { name: "depth-pfm", run: |bytes| depth(b"Pf", bytes) };
/// Depth maps as PNG.
pub const DEPTH_PNG: Target = Target { name: "depth-png", run: |bytes| depth(b"\x89PNG", bytes) };
/// Depth maps as TIFF.
pub const DEPTH_TIFF: Target = Target { name: "depth-tiff", run: |bytes| depth(b"", bytes) };
/// Annotations of COCO.
pub const DATASET_COCO: Target = Target { name: "dataset-coco", run: |bytes| text(bytes, try_coco) };
/// Tables of images.
pub const DATASET_PARQUET: Target =
    Target { name: "dataset-parquet", run: |bytes| files_of_many(bytes, try_tables) };
/// Tar shards of WebDataset.
pub const DATASET_SHARDS: Target =
    Target { name: "dataset-shards", run: |bytes| files_of_many(bytes, try_shards) };
/// Annotations of Pascal VOC, in any encoding.
pub const DATASET_VOC: Target = Target { name: "dataset-voc", run: try_voc };
/// Labels, `data.yaml` and lists of YOLO.
pub const DATASET_YOLO: Target = Target { name: "dataset-yolo", run: |bytes| text(bytes, try_yolo) };
/// Records of a folder's job.
pub const JOB_RECORD: Target = Target { name: "job-record", run: batch::try_parse };
/// Manifests of augmented datasets.
pub const MANIFEST: Target = Target { name: "manifest", run: try_manifest };
/// Models of depth from colour.
pub const MODEL_FILE: Target = Target { name: "model-file", run: model };
/// What ffmpeg says about a video.
pub const VIDEO_LOG: Target = Target { name: "video-log", run: try_log };
/// Headers of YUV4MPEG2.
pub const VIDEO_Y4M: Target = Target { name: "video-y4m", run: try_y4m };
/// Water files.
pub const WATER_FILE: Target = Target { name: "water-file", run: water };

/// Every parser there is. A program that fuzzes one names that one alone, so that the others are not linked to it.
pub const ALL: [Target; 26] = [
    BAG_MESSAGE,
    BMP,
    EXIF,
    GIF,
    JPEG,
    PNG,
    TIFF,
    WEBP,
    DEPTH_COLMAP,
    DEPTH_EXR,
    DEPTH_NETWORK,
    DEPTH_NPY,
    DEPTH_PFM,
    DEPTH_PNG,
    DEPTH_TIFF,
    DATASET_COCO,
    DATASET_PARQUET,
    DATASET_SHARDS,
    DATASET_VOC,
    DATASET_YOLO,
    JOB_RECORD,
    MANIFEST,
    MODEL_FILE,
    VIDEO_LOG,
    VIDEO_Y4M,
    WATER_FILE,
];

/// Small enough that no execution takes long.
const LIMITS: ReadOptions = ReadOptions {
    max_pixels: 1 << 12,
    max_pixels_per_byte: u64::MAX,
    max_memory: 64 << 20,
    lenient: false,
    border: Border::None,
    water_map: WaterMap::Rules,
};

fn image(format: Format, bytes: &[u8]) {
    if Format::of_content(bytes) != Some(format) {
        return;
    }
    // Drawn from what is in the file, for fuzzers like some lengths better than others.
    let drawn = bytes.iter().copied().fold(0, u8::wrapping_add);
    let lenient = drawn % 2 == 1;
    match ImageFile::from_bytes(Path::new(NAME), bytes, &ReadOptions { lenient, ..LIMITS }) {
        // Fusing takes a hundred times as long as reading: one in so many is enough.
        Ok(read) if drawn < 4 => check(&read, lenient),
        Ok(_) => {}
        Err(error) => check_error(&error),
    }
}

/// What the file is called.
pub const NAME: &str = "a fuzzed file";

/// What must hold of every refusal: it names the file and says a cause and what to do, on one line.
///
/// # Panics
///
/// When it does not.
pub fn check_error(error: &impl std::fmt::Display) {
    let said = error.to_string();
    assert!(
        said.contains(NAME) && said.len().saturating_sub(NAME.len()) > 20 && !said.contains('\n'),
        "{said:?}"
    );
}

/// What must hold of whatever was read: it is fused to finite values within the range, upright and not.
fn check(image: &ImageFile, lenient: bool) {
    assert!(lenient || image.damage.is_none(), "damage passed for whole");
    let (width, height) = image.pixels.size();
    assert!(width.saturating_mul(height) as u64 <= LIMITS.max_pixels);
    let found = analyse_in(PixelEncoding::Encoded, image, &DepthSource::default())
        .expect("depth from colour never fails");
    let operation = Operation::Fuse { reference: found.estimate, options: Options::default() };
    let mut fused = image.clone();
    operation.apply(&mut fused.pixels, Some(&found)).expect("of one size");
    if let Pixels::Floats(layers) = &fused.pixels {
        assert!(layers.image.as_raw().iter().all(|value| (0.0..=1.0).contains(&value.to_unit())));
    }
    let turned = fused.upright();
    let expected = if image.metadata.orientation() > 4 { (height, width) } else { (width, height) };
    assert_eq!((turned.pixels.size(), turned.metadata.orientation()), (expected, 1));
}

fn depth(magic: &[u8], bytes: &[u8]) {
    if !bytes.starts_with(magic) {
        return;
    }
    for kind in [SuppliedKind::Metres, SuppliedKind::Inverse] {
        if let Err(error) = depth_file::from_bytes(Path::new(NAME), bytes, kind) {
            check_error(&error);
        }
    }
}

fn network(bytes: &[u8]) {
    let kind = Some(NetworkKind::Inverse);
    // A network of a fixed size takes no other.
    let read = [Some(28), None].map(|side| {
        DepthNetwork::from_bytes(
            Path::new(NAME),
            bytes.to_vec(),
            &NetworkOptions { kind, side, ..NetworkOptions::default() },
        )
    });
    for network in read {
        match network {
            Ok(network) if network.memory() <= LIMITS.max_memory => {
                let values = (0..=u8::MAX).cycle().map(|value| value.wrapping_mul(37));
                let pixels = values.take(32 * 24 * 3).collect();
                let image = Image::<u8>::from_raw(32, 24, pixels).expect("a value for each channel");
                match network.depth(&image, TopEdge::First) {
                    Ok(found) => assert_eq!(found.depth.size(), image.size()),
                    Err(error) => check_error(&error),
                }
            }
            Ok(_) => {}
            Err(error) => check_error(&error),
        }
    }
}

fn files_of_many(bytes: &[u8], parse: fn(&Path, &[u8]) -> Result<(), FileError>) {
    if let Err(error) = parse(Path::new(NAME), bytes) {
        check_error(&error);
    }
}

fn text(bytes: &[u8], parse: fn(&str)) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        parse(text);
    }
}

fn model(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes)
        && let Err(error) = ModelFile::from_text(Path::new(NAME), text)
    {
        check_error(&error);
    }
}

fn water(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match WaterFile::from_text(Path::new(NAME), text, PixelEncoding::Encoded) {
        Ok(file) => {
            let again = WaterFile::from_text(Path::new(NAME), &file.to_text(), PixelEncoding::Encoded)
                .expect("what is written is read");
            assert_eq!(file, again);
        }
        Err(error) => check_error(&error),
    }
}

//! Borders of real photographs: none is found where there is none, and none is missed of those made around them.

use std::path::{Path, PathBuf};

use aquafuse::image::Image;
use aquafuse::random::split_mix;
use aquafuse::scene_area::{Border, Margins, SceneArea};
use aquafuse_data::image_file::{ImageFile, ReadOptions};

/// Folders of photographs, and of other programs' outputs.
const FOLDERS: [&str; 13] = [
    "scenes",
    "annotated_suim/images",
    "annotated_yolo_deepfish/images",
    "depth_pairs/rgb",
    "depth_pairs_estimated/rgb",
    "restoration_pairs/lsui/raw",
    "restoration_pairs/lsui/reference",
    "restoration_pairs/uieb/raw",
    "restoration_pairs/uieb/reference",
    "sequence_subvo_pool/images",
    "ustyle_pairs/content/images",
    "ustyle_pairs/style/images",
    "video/deepfish_7434_F1/frames",
];
/// Photographs that have a border, by eye: black bars (those of the fish), and a few black columns at the sides.
const BORDERED: [&str; 3] = ["deepfish", "lsui/raw/4948", "lsui/reference/4948"];
/// One through the port of a housing: its soft vignette ends in a few black columns. Either answer is right.
const EITHER: &str = "usod_test_225";

fn photographs(data: &Path) -> Vec<PathBuf> {
    let list = |folder: &&str| aquafuse_data::image_file::list(&data.join(folder)).unwrap().images;
    FOLDERS.iter().flat_map(list).filter(|path| !path.to_string_lossy().contains(EITHER)).collect()
}

fn has_border(path: &Path) -> bool {
    BORDERED.iter().any(|name| path.to_string_lossy().contains(name))
}

fn read(path: &Path) -> Image<u8> {
    ImageFile::read(path).unwrap().pixels.into_bytes()
}

/// As JPEG shows it; colour at half the resolution or not.
fn as_jpeg(image: &Image<u8>, quality: u8, is_halved: bool) -> Image<u8> {
    let mut bytes = Vec::new();
    let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, quality);
    let factor =
        if is_halved { jpeg_encoder::SamplingFactor::F_2_2 } else { jpeg_encoder::SamplingFactor::F_1_1 };
    encoder.set_sampling_factor(factor);
    let [width, height] = [image.width(), image.height()].map(|side| u16::try_from(side).unwrap());
    encoder.encode(image.as_raw(), width, height, jpeg_encoder::ColorType::Rgb).unwrap();
    ImageFile::from_bytes("made.jpg".as_ref(), &bytes, &ReadOptions::default()).unwrap().pixels.into_bytes()
}

fn found(image: &Image<u8>) -> SceneArea {
    SceneArea::of(image, Border::Auto).unwrap()
}

/// As stored, and through JPEG, which makes open water flatter than it is.
#[test]
fn no_border_is_found_in_photographs_that_have_none() {
    let Some(data) = super::folder() else { return };
    let (mut none, mut bars) = (0, 0);
    for path in photographs(&data) {
        let image = read(&path);
        let name = path.display();
        if has_border(&path) {
            assert!(!found(&image).is_whole(), "{name}: missed");
            bars += 1;
            continue;
        }
        none += 1;
        assert!(found(&image).is_whole(), "{name}: {}", found(&image).margins());
        for quality in [40, 70] {
            let again = found(&as_jpeg(&image, quality, true));
            assert!(again.is_whole(), "{name} with quality {quality}: {}", again.margins());
        }
    }
    eprintln!("{none} photographs without a border: 0 false; {bars} with one: 0 missed");
    assert!(none >= 300);
}

/// What is chosen by chance.
struct Chance(u64);

impl Chance {
    fn below(&mut self, most: usize) -> usize {
        (split_mix(&mut self.0) % most as u64) as usize
    }
}

/// A photograph with a border around it.
fn bordered(scene: &Image<u8>, margins: Margins, colour: [u8; 3]) -> Image<u8> {
    let width = scene.width() + margins.left + margins.right;
    let height = scene.height() + margins.top + margins.bottom;
    let mut image = Image::from_raw(width, height, colour.repeat(width * height)).unwrap();
    let area = SceneArea::of(&image, Border::Given(margins)).unwrap();
    area.put_back(scene, &mut image).unwrap();
    image
}

/// The digits 0 to 9 in three columns and five rows, bit by bit.
const DIGITS: [u16; 10] = [0x7B6F, 0x2C97, 0x73E7, 0x73CF, 0x5BC9, 0x79CF, 0x79EF, 0x7249, 0x7BEF, 0x7BCF];

/// Writes digits into the rows of a bar, over a part of its width.
fn write(image: &mut Image<u8>, rows: std::ops::Range<usize>, ink: [u8; 3], chance: &mut Chance) {
    let scale = (rows.len() / 9).max(1);
    let top = rows.start + (rows.len() - 5 * scale) / 2;
    let width = image.width();
    let length = (width / (4 * scale)).saturating_sub(2) * (3 + chance.below(5)) / 10;
    for i in 0..length {
        let digit = DIGITS[chance.below(10)];
        for (x, y) in (0..5 * scale).flat_map(|y| (0..3 * scale).map(move |x| (x, y))) {
            if digit >> (14 - (3 * (y / scale) + x / scale)) & 1 == 1 {
                image.pixels_mut()[(top + y) * width + (4 * i + 4) * scale + x] = ink;
            }
        }
    }
}

/// 200 borders: letterboxes, pillars, frames, single bars and bars with text, in grey of 0, 16, 114 and 255 or any colour,
/// as PNG or as JPEG of quality 40 to 95 with colour at full or half the resolution.
#[test]
fn none_of_two_hundred_made_borders_is_missed() {
    let Some(data) = super::folder() else { return };
    let photographs: Vec<PathBuf> = photographs(&data).into_iter().filter(|path| !has_border(path)).collect();
    let mut missed = Vec::new();
    for number in 0..200 {
        let mut chance = Chance(number as u64 + 1);
        let path = &photographs[chance.below(photographs.len())];
        let scene = read(path);
        let wide = |side: usize, chance: &mut Chance| 4 + chance.below(side / 5);
        let (across, down) = scene.size();
        let (a, b) = (wide(down, &mut chance), wide(across, &mut chance));
        let text = 18 + chance.below(40);
        let margins = match number % 5 {
            0 => Margins { top: a, bottom: a + chance.below(3), ..Margins::default() },
            1 => Margins { left: b, right: b + chance.below(3), ..Margins::default() },
            2 => {
                Margins { top: a, right: b, bottom: wide(down, &mut chance), left: wide(across, &mut chance) }
            }
            3 => Margins { top: text, ..Margins::default() },
            _ => match chance.below(4) {
                0 => Margins { top: a, ..Margins::default() },
                1 => Margins { right: b, ..Margins::default() },
                2 => Margins { bottom: a, ..Margins::default() },
                _ => Margins { left: b, ..Margins::default() },
            },
        };
        let any = chance.below(256) as u8;
        let colour = match chance.below(5) {
            i @ 0..3 => [[0, 16, 255][i]; 3],
            3 => [114; 3],
            _ => [any, chance.below(256) as u8, chance.below(256) as u8],
        };
        let mut image = bordered(&scene, margins, colour);
        if number % 5 == 3 {
            let ink = if colour[1] < 128 { [255; 3] } else { [10, 10, 30] };
            write(&mut image, 0..text, ink, &mut chance);
        }
        let quality = (chance.below(7) > 0).then(|| 40 + chance.below(56) as u8);
        if let Some(quality) = quality {
            image = as_jpeg(&image, quality, chance.below(2) == 0);
        }
        let area = found(&image);
        let at = area.margins();
        let pairs = [
            (at.top, margins.top),
            (at.right, margins.right),
            (at.bottom, margins.bottom),
            (at.left, margins.left),
        ];
        if pairs.iter().any(|&(found, made)| found.abs_diff(made) > 1) || area.has_outline() {
            missed.push(format!("{number}: {at} for {margins}, {colour:?}, {quality:?}, {}", path.display()));
        }
    }
    assert!(missed.is_empty(), "{} of 200:\n{}", missed.len(), missed.join("\n"));
}

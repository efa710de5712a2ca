//! Small files for each parser of a scene, from which fuzzing starts.

use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result};
use aquafuse::truth::Size;
use aquafuse_scene::files::{ply_bytes, spz_bytes};
use aquafuse_scene::medium::Water;
use aquafuse_scene::splats::Splats;
use aquafuse_scene::train::loss::Target;
use aquafuse_scene::train::{Options, TrainView, Trainer};
use aquafuse_scene::truth::views;

use super::add;

const CAMERAS: &str =
    "# Camera list\n1 SIMPLE_RADIAL 64 48 50.5 32 24 -0.04\n2 OPENCV 64 48 50 51 32 24 .1 0 0 -.1\n";
const IMAGES: &str = "1 1 0 0 0 .5 1 2 1 a b.jpg\n\n2 .8 .36 -.48 0 0 0 1 1 dir/c.jpg\n1 2 3\n";
const POINTS: &str = "# X, Y, Z\n10 1.5 -2 3 255 0 51 .8 15 22 14 34\n11 0 0 9 1 2 3 0\n";
const TRANSFORMS: &str = r#"{"camera_angle_x": 0.9, "w": 64, "h": 48.0, "k1": 0.01, "frames": [
{"file_path": "./a", "transform_matrix": [[1,0,0,2],[0,1,0,3],[0,0,1,4],[0,0,0,1]]},
{"file_path": "b.jpg", "fl_x": 50, "fl_y": 51, "cx": 32, "cy": 24,
"transform_matrix": [[0,0,1,2],[1,0,0,3],[0,1,0,4],[0,0,0,1]]}]}
"#;

/// Writes them, each into the folder of its parser.
pub(super) fn add_all(corpus: &Path) -> Result<()> {
    for (name, text) in [("cameras.txt", CAMERAS), ("images.txt", IMAGES), ("points3D.txt", POINTS)] {
        add(corpus, "scene-colmap-text", name, text.as_bytes())?;
    }
    add(corpus, "scene-transforms", "transforms.json", TRANSFORMS.as_bytes())?;
    for (name, bytes) in [("cameras.bin", cameras()), ("images.bin", images()), ("points3D.bin", points())] {
        add(corpus, "scene-colmap-binary", name, &bytes)?;
    }
    for degree in [0, 1] {
        let mut splats = Splats::<f32>::new(degree);
        splats.push(&Splats::<f32>::ball(degree, [0.1, 0.2, 4.0], 0.3, 0.5, [0.9, 0.5, 0.1]));
        splats.push(&Splats::<f32>::ball(degree, [0.0, 0.0, 5.0], 0.1, 0.9, [0.2; 3]));
        add(corpus, "scene-ply", &format!("degree_{degree}.ply"), &ply_bytes(&splats))?;
        let packed = spz_bytes(&splats).context("splats near the origin fit")?;
        let mut raw = Vec::new();
        flate2::read::GzDecoder::new(&packed[..]).read_to_end(&mut raw)?;
        add(corpus, "scene-spz", &format!("degree_{degree}"), &raw)?;
        // Version 2: one byte less in each quaternion.
        let turns = 16 + 2 * 16;
        raw.drain(turns + 7..turns + 8);
        raw.drain(turns + 3..turns + 4);
        raw[4] = 2;
        add(corpus, "scene-spz", &format!("degree_{degree}_version_2"), &raw)?;
        add(corpus, "scene-checkpoint", &format!("degree_{degree}"), &state(splats))?;
    }
    add(corpus, "scene-ply", "compressed.ply", &compressed())
}

/// Splats as SuperSplat compresses them: the bounds of a chunk, four words for each of two, and a harmonic's byte.
fn compressed() -> Vec<u8> {
    let names = |kind: &str, names: &[&str]| {
        names.iter().map(|name| format!("property {kind} {name}\n")).collect::<String>()
    };
    let axes = |of: &str| ["min", "max"].map(|end| ["x", "y", "z"].map(|axis| format!("{end}{of}_{axis}")));
    let bounds = [axes(""), axes("_scale")].concat().concat();
    let bounds: Vec<&str> = bounds.iter().map(String::as_str).chain(COLOURS).collect();
    let harmonics: Vec<String> = (0..9).map(|i| format!("f_rest_{i}")).collect();
    let harmonics: Vec<&str> = harmonics.iter().map(String::as_str).collect();
    let head = [
        "ply\nformat binary_little_endian 1.0\nelement chunk 1\n",
        &names("float", &bounds),
        "element vertex 2\n",
        &names("uint", &["packed_position", "packed_rotation", "packed_scale", "packed_color"]),
        "element sh 2\n",
        &names("uchar", &harmonics),
        "end_header\n",
    ];
    let values = [[-1.0_f32; 3], [1.0; 3], [-6.0; 3], [-2.0; 3], [0.0; 3], [1.0; 3]];
    let values = values.as_flattened().iter().flat_map(|v| v.to_le_bytes());
    let words = [0x8420_1234_u32, 0xdfff_0abc, 0x4080_8080, 0x80ff_40ff].map(u32::to_le_bytes).concat();
    head.concat().into_bytes().into_iter().chain(values).chain(words.repeat(2)).chain([100; 18]).collect()
}

const COLOURS: [&str; 6] = ["min_r", "min_g", "min_b", "max_r", "max_g", "max_b"];

/// A checkpoint without its mark, its options and what the images come to.
fn state(splats: Splats<f32>) -> Vec<u8> {
    let view = views(1, Size { width: 8, height: 6 }, 1, 1).remove(0);
    let shot = TrainView { target: Target::new(8, 6, view.clear().pixels()), camera: view.camera };
    let water = (splats.sh_degree() > 0).then(|| Water::new([0.1, 0.3, 0.5], [0.2; 3], [0.2; 3]));
    let mut trainer = Trainer::new(Options::default(), vec![shot.clone(), shot], splats, water);
    trainer.step();
    let bytes = trainer.checkpoint();
    let (_, rest) = bytes.split_at(16);
    let (length, rest) = rest.split_first_chunk::<8>().expect("a length");
    rest[u64::from_le_bytes(*length) as usize + 8..].to_vec()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// As COLMAP writes them: a count, then one after the other.
fn cameras() -> Vec<u8> {
    let camera = |id: u32, model: u32, parameters: &[f64]| {
        let start = [id.to_le_bytes(), model.to_le_bytes()].concat();
        [start, [64_u64, 48].map(u64::to_le_bytes).concat(), doubles(parameters)].concat()
    };
    let two = [camera(1, 1, &[50.0, 51.0, 32.0, 24.0]), camera(2, 2, &[50.5, 32.0, 24.0, -0.04])];
    [2_u64.to_le_bytes().to_vec(), two.concat()].concat()
}

fn images() -> Vec<u8> {
    let image = |id: u32, name: &str, seen: u64| {
        let pose = doubles(&[0.8, 0.36, -0.48, 0.0, 0.5, 1.0, 2.0]);
        let spots = doubles(&vec![1.5; 3 * seen as usize]);
        let name = [name.as_bytes(), b"\0"].concat();
        [
            id.to_le_bytes().to_vec(),
            pose,
            1_u32.to_le_bytes().to_vec(),
            name,
            seen.to_le_bytes().to_vec(),
            spots,
        ]
        .concat()
    };
    [2_u64.to_le_bytes().to_vec(), image(1, "a.jpg", 2), image(2, "dir/b c.jpg", 0)].concat()
}

fn points() -> Vec<u8> {
    let point = |id: u64, track: u64| {
        let place =
            [id.to_le_bytes().to_vec(), doubles(&[1.5, -2.0, 3.0]), vec![255, 0, 51], doubles(&[0.8])];
        [place.concat(), track.to_le_bytes().to_vec(), vec![1; 8 * track as usize]].concat()
    };
    [2_u64.to_le_bytes().to_vec(), point(10, 2), point(11, 0)].concat()
}

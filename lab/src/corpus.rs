//! `lab corpus`: the examples that fuzzing starts from and the tests replay, made again.

mod logs;
mod networks;
mod scenes;
#[cfg(feature = "parquet")]
mod tables;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use xtask::shell::{root, say};

use crate::forge::{self, Forged, Role};

/// Larger files slow every execution down and hold nothing that smaller ones do not.
const MOST_BYTES: usize = 2048;
/// Where the forged files go, by role and extension.
const TARGETS: [(Role, &str, &str); 13] = [
    (Role::Image, "bmp", "bmp"),
    (Role::Image, "gif", "gif"),
    (Role::Image, "jpg", "jpeg"),
    (Role::Image, "png", "png"),
    (Role::Image, "tif", "tiff"),
    (Role::Image, "tiff", "tiff"),
    (Role::Image, "webp", "webp"),
    (Role::Depth, "bin", "depth-colmap"),
    (Role::Depth, "exr", "depth-exr"),
    (Role::Depth, "npy", "depth-npy"),
    (Role::Depth, "pfm", "depth-pfm"),
    (Role::Depth, "png", "depth-png"),
    (Role::Depth, "tiff", "depth-tiff"),
];
/// What fuzzing makes of a good file by itself in no time.
const EASY: [&str; 2] = ["bit flips", "cut short"];

const RECORD: &str = r#"{"job":{"schema":1,"settings":"0.1.0 blue"}}
{"begun":{"output":"a.png","source":{"path":"/a.png","content":{"bytes":7,"modified_ns":1},"depth":"Estimated(Ratio)","map":null},"before":null}}
{"done":{"output":"a.png","source":{"path":"/a.png","content":{"bytes":7,"modified_ns":1},"depth":"Estimated(Ratio)","map":null},"stamp":{"bytes":9,"modified_ns":2}}}
{"failed":{"output":[255,46,112,110,103],"error":"cannot read"}}
"#;
const MODEL: &str = "schema = 1\nmodel = \"eq3\"\nmu = [0.5, 0.5, -6.0, -0.5, -2.0]\n\n[fit]\ndata = \"pairs\"\npairs = 1\n\
    depth_kind = \"metres\"\nscale = \"shared\"\ntarget = \"order\"\nrank_score = 0.75\nloss = 0.1\ndoubts = []\n\n\
    [[fit.scores]]\nname = \"a\"\nrank_score = 0.75\n";

const WATER: &str = r#"{"schema":1,"from":["a.png"],"encoding":"encoded","depth":{"kind":"relative","model":"eq3"},
"waterbody":{"veiling_light":[0.1,0.4,0.5],"backscatter_coefficient":[1.5,1,0.9],
"attenuation":[[2,0,0.5,-1],[1,0,0,0],[0.9,0,0,0]],"attenuation_held_beyond":[0.8,0.8,0]},
"intervals":{"veiling_light":[[0,0.2],[0.3,0.5],[0.4,0.6]],"backscatter_coefficient":[[1,2],[0.5,2],[0.4,2]]},
"veiling_light_source":"open_water","veiling_light_share":0.2,
"quality":{"verdict":"doubtful","reasons":["few_dark_pixels"]}}
"#;

const COCO: &str = r#"{"info": {"year": 2024}, "images": [{"id": 7, "file_name": "a.jpg", "width": 64, "height": 48},
{"file_name": "b.jpg", "id": 9}], "annotations": [{"id": 3, "image_id": 7, "bbox": [1.0, 2, 30, 40], "category_id": 1},
{"id": 5, "image_id": 9, "caption": "two fish"}], "categories": [{"id": 1, "name": "fish"}]}
"#;
const VOC: &str = "<annotation><filename>a &amp; b.jpg</filename><path>/p/a.jpg</path><size><width>64</width><height>48</height></size>
<object><name>fish</name><bndbox><xmin>1</xmin><ymin>2.5</ymin><xmax>64</xmax><ymax>48</ymax></bndbox></object></annotation>
";
const YOLO: &str = "0 0.5 0.5 0.25 0.5\n1 0.1 0.1 0.9 0.1 0.5 0.9\n2 0.5 0.5 0.2 0.2 0.5 0.5 2 0.1 0.1 0\n";
const MANIFEST: &str = r#"{"line":"job","schema":1,"version":"0.1.0","dataset":"fish","layout":"yolo","encoding":"encoded","settings":{"seed":1,"per_image":1,"with_replacement":false,"theta_range":[0.0,60.0],"alpha_range":[1.0,1.0],"model":"aquafuse","most_gain":2.0,"smooth":"none","depth":{"model":"ratio"},"on_doubtful":"flag","on_bad_annotation":"refuse","keep_originals":true,"quality":95,"lenient":false},"waters":[{"name":"w.jpg","sha256":"00","water":{}}],"instead":null}
{"line":"original","key":"a.jpg","output":"a.jpg","bytes":3,"sha256":"01","companions":[{"output":"a.txt","bytes":1,"sha256":"02"}]}
{"line":"variant","key":"a.jpg","number":0,"water":0,"theta":12.5,"alpha":1.0,"source":{"bytes":3,"sha256":"01","depth_sha256":null},"verdict":"good","reasons":[],"clipped":0.25,"instead":false,"output":"a__w__0.jpg","bytes":3,"sha256":"03","companions":[]}
{"line":"skipped","key":"b.jpg","why":"doubtful"}
{"line":"failed","key":"c.jpg","error":"cannot read"}
{"line":"index","output":"data.yaml","bytes":4,"sha256":"04"}
{"line":"end","sha256":"05"}
"#;
const VIDEO_LOG: &str = "\
[info] Input #0, matroska,webm, from 'file:a.mkv':
[info]   Metadata:
[info]     title           : reef
[info]   Duration: 00:01:02.50, start: -0.007000, bitrate: 1000 kb/s
[info]   Stream #0:0: Video: h264 (High 10), yuv420p10le(tv, bt709, progressive), 64x48 [SAR 4:3 DAR 16:9], 30 fps, 30 tbr, 1k tbn
[info]   Stream #0:1(deu): Audio: opus, 48000 Hz, mono, fltp (default)
[info]   Stream #0:2: Subtitle: subrip
[info]   Stream #0:3: Video: mjpeg (Baseline), yuvj420p(pc), 8x8, 90k tbr (attached pic)
[Parsed_showinfo_0 @ 0x55b3460db700] [info] config in time_base: 1/1000, frame_rate: 30000/1001
[Parsed_showinfo_0 @ 0x55b3460db700] [info] n:   0 pts:      7 pts_time:0.007   pos:      643 fmt:yuv420p10le sar:4/3 s:64x48 i:P iskey:1 type:I
[Parsed_showinfo_0 @ 0x55b3460db700] [info] color_range:tv color_space:bt709 color_primaries:bt709 color_trc:bt709
[matroska,webm @ 0x55b3460db700] [error] File ended prematurely
[info] frame=    1 fps=0.0 q=-0.0 Lsize=N/A time=00:00:00.06 bitrate=N/A speed=1.53x
";
const VIDEO_Y4M: &str = "YUV4MPEG2 W64 H48 F30000:1001 Ip A4:3 C422p10 XYSCSS=422P10 XCOLORRANGE=FULL\n";

/// Text files, one each.
const TEXTS: [(&str, &str, &str); 10] = [
    ("depth-colmap", "small.geometric.bin", "2&1&1&@@@@AAAA"),
    ("dataset-coco", "instances.json", COCO),
    ("dataset-voc", "a.xml", VOC),
    ("dataset-yolo", "a.txt", YOLO),
    ("job-record", "job.jsonl", RECORD),
    ("manifest", "manifest.jsonl", MANIFEST),
    ("model-file", "model.toml", MODEL),
    ("video-log", "a.log", VIDEO_LOG),
    ("video-y4m", "a.y4m", VIDEO_Y4M),
    ("water-file", "a.water.json", WATER),
];

pub(crate) fn run() -> Result<()> {
    let tables = tables()?;
    say("Making the corpus of fuzz/ again");
    let corpus = root().join("fuzz/corpus");
    if corpus.exists() {
        fs::remove_dir_all(&corpus)?;
    }
    for Forged { name, kind, role, bytes, .. } in forge::files()?.iter() {
        let extension = name.rsplit('.').next().unwrap_or_default();
        let target = TARGETS.iter().find(|(r, e, _)| (*r, *e) == (*role, extension));
        let Some((_, _, target)) = target.filter(|_| !EASY.contains(kind)) else { continue };
        if (1..=MOST_BYTES).contains(&bytes.len()) {
            add(&corpus, target, name, bytes)?;
            if name.starts_with("exif-") {
                add_exif(&corpus, name, bytes)?;
            }
        }
    }
    for (target, name, text) in TEXTS {
        add(&corpus, target, name, text.as_bytes())?;
    }
    let shard = [member("a.jpg", b"no image"), member("a.txt", b"0"), vec![0; 1024]].concat();
    add(&corpus, "dataset-shards", "a.tar", &shard)?;
    for (name, table) in tables {
        add(&corpus, "dataset-parquet", name, &table)?;
    }
    logs::add_all(&corpus)?;
    networks::add_all(&corpus)?;
    scenes::add_all(&corpus)?;
    counts(&corpus)
}

#[cfg(feature = "parquet")]
fn tables() -> Result<[(&'static str, Vec<u8>); 3]> {
    tables::all()
}

/// A corpus without them would be another one.
#[cfg(not(feature = "parquet"))]
fn tables() -> Result<[(&'static str, Vec<u8>); 0]> {
    anyhow::bail!(
        "the corpus has tables of Parquet: `cargo run --release --package lab --features parquet -- corpus`"
    )
}

/// A member of a tar file (POSIX.1-1988).
fn member(name: &str, bytes: &[u8]) -> Vec<u8> {
    let mut block = vec![0_u8; 512];
    let mut put = |at: usize, text: &str| block[at..at + text.len()].copy_from_slice(text.as_bytes());
    put(0, name);
    put(100, "0000644");
    put(124, &format!("{:011o}", bytes.len()));
    put(136, "00000000000");
    put(148, "        0");
    put(257, "ustar\u{0}00");
    let sum: u32 = block.iter().map(|byte| u32::from(*byte)).sum();
    block[148..156].copy_from_slice(format!("{sum:06o}\u{0} ").as_bytes());
    block.extend(bytes);
    block.resize(block.len().next_multiple_of(512), 0);
    block
}

fn add(corpus: &Path, target: &str, name: &str, bytes: &[u8]) -> Result<()> {
    let folder = corpus.join(target);
    fs::create_dir_all(&folder)?;
    fs::write(folder.join(name), bytes).with_context(|| format!("cannot write {name}"))
}

/// The EXIF block of a JPEG, by itself.
fn add_exif(corpus: &Path, name: &str, jpeg: &[u8]) -> Result<()> {
    let name_of_segment = b"Exif\0\0";
    let Some(at) = jpeg.windows(6).position(|window| window == name_of_segment) else { return Ok(()) };
    let length = usize::from(u16::from_be_bytes([jpeg[at - 2], jpeg[at - 1]]));
    let end = (at - 2 + length).min(jpeg.len());
    let block = jpeg.get(at + 6..end).unwrap_or_default();
    if block.is_empty() { Ok(()) } else { add(corpus, "exif", &name.replace(".jpg", ".tiff"), block) }
}

fn counts(corpus: &Path) -> Result<()> {
    let mut counts = BTreeMap::new();
    for folder in fs::read_dir(corpus)? {
        let folder = folder?;
        counts.insert(folder.file_name(), fs::read_dir(folder.path())?.count());
    }
    for (target, files) in counts {
        eprintln!("   {:<12} {files} files", target.to_string_lossy());
    }
    Ok(())
}

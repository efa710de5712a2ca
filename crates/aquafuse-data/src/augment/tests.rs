mod drawn;
mod gathered;
mod safety;
#[cfg(feature = "parquet")]
mod tables;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use aquafuse::depth::{DepthKind, DepthModel, SuppliedKind};
use aquafuse::truth::{Scene, Size, waters};
use aquafuse::waterbody::Estimate;

use std::num::NonZeroUsize;

use gathered::{check, remake};

use super::*;
use crate::image_file::ReadOptions;
use crate::image_file::{ImageFile, WriteOptions};
use crate::pipeline::MapSize;
use crate::water_file::WaterFile;

/// A dataset of four small images with labels.
fn dataset(root: &Path) {
    for folder in ["images/train", "labels/train"] {
        fs::create_dir_all(root.join(folder)).unwrap();
    }
    for (seed, name) in ["a.png", "b.jpg", "c.png", "d.tif"].into_iter().enumerate() {
        let scene = Scene::new(seed as u64, Size { width: 48, height: 32 });
        let image = scene.seen_through(&waters()[seed % 3].water).convert::<u8>();
        ImageFile::new(image)
            .write(
                &root.join("images/train").join(name),
                &WriteOptions { overwrite: true, ..WriteOptions::default() },
            )
            .unwrap();
        let label = format!("labels/train/{}.txt", &name[..1]);
        fs::write(root.join(label), format!("0 0.5 0.5 0.{seed}1 0.25\r\n")).unwrap();
    }
}

fn water(name: &str, which: usize) -> Water {
    let estimate = Estimate::given(waters()[which].water).into();
    let file = WaterFile { from: vec![name.into()], depth_kind: DepthKind::Relative, estimate };
    Water { name: name.into(), sha256: None, file }
}

fn job(root: &Path, output: &Path) -> Augmentation {
    Augmentation {
        dataset: Dataset::open(root, None, &ReadOptions::default()).unwrap(),
        output: output.to_owned(),
        recipe: Recipe {
            waters: vec![water("w/green.jpg", 1), water("preset:jerlov-3C", 2)],
            sea: None,
            encoding: PixelEncoding::Encoded,
            per_image: 3,
            draws: Draws { seed: 1, with_replacement: false, theta: (0.0, 60.0), alpha: (0.5, 1.5) },
            options: Options::default(),
            smoothing: Smoothing::default(),
            depth: DepthPlan::Estimated(DepthModel::default().into()),
            on_doubtful: OnDoubtful::Flag,
            on_bad_annotation: "refuse",
            keep_originals: true,
            keep_share: 0.0,
            splits: Splits::All,
            quality: 95,
        },
        shard: Shard::default(),
        overwrite: false,
        manifest_table: false,
        preview: 0,
        run_options: RunOptions::default(),
    }
}

fn run(job: &Augmentation) -> Summary {
    fs::create_dir_all(&job.output).unwrap();
    job.run(&job.plan().unwrap(), &|_| {}).unwrap()
}

/// Every file below a folder with what is in it.
fn files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut left = vec![root.to_owned()];
    while let Some(folder) = left.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                left.push(path);
            } else {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().to_owned();
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

#[test]
fn every_image_has_its_variants_with_its_own_labels() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("fish"), place.path().join("out"));
    dataset(&root);
    let ended = run(&job(&root, &out));
    assert_eq!((ended.done, ended.failed, ended.left), (4, 0, 0));
    let (before, after) = (files(&root), files(&out));
    assert_eq!(after.len(), 2 * (4 + 4 * 3) + 1);
    for (name, bytes) in &before {
        assert_eq!(after.get(name), Some(bytes), "{name}");
    }
    let labels = after.iter().filter(|(name, _)| name.contains("__"));
    for (name, bytes) in labels.filter(|(name, _)| name.starts_with("labels/")) {
        let (stem, _) = name.split_once("__").unwrap();
        assert_eq!(bytes, &before[&format!("{stem}.txt")], "{name}");
        let image_files = name.replace("labels/", "images/").replace(".txt", ".");
        assert!(after.keys().any(|other| other.starts_with(&image_files)), "{name}");
    }
    let checked = check(&out, Some(&root), &ReadOptions::default()).unwrap();
    assert_eq!((checked.files, checked.wrong), (after.len() + 4, Vec::new()));
}

#[test]
fn threads_stops_and_shards_change_no_byte() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("fish");
    dataset(&root);
    let clean = job(&root, &place.path().join("clean"));
    run(&clean);
    let clean = files(&place.path().join("clean"));

    let mut one = job(&root, &place.path().join("one"));
    one.run_options.threads = NonZeroUsize::new(1);
    run(&one);
    assert!(files(&one.output) == clean, "one thread");

    // As if it had been killed within a line, with one file too many and one too few.
    let again = job(&root, &place.path().join("again"));
    run(&again);
    let manifest = again.output.join("manifest.jsonl");
    let text = fs::read(&manifest).unwrap();
    fs::write(&manifest, &text[..text.len() * 3 / 4]).unwrap();
    fs::remove_file(again.output.join("labels/train/a.txt")).unwrap();
    let ended = run(&again);
    assert!(ended.skipped > 0 && ended.done > 0, "{ended:?}");
    assert!(files(&again.output) == clean, "gone on with");
    assert_eq!(run(&again).skipped, 4);
    assert!(files(&again.output) == clean, "nothing to do");

    let mut parts = job(&root, &place.path().join("parts"));
    let mut done = 0;
    for number in 1..=2 {
        parts.shard = Shard { number, of: 2 };
        done += run(&parts).done;
    }
    assert_eq!(done, 4);
    parts.shard = Shard::default();
    assert_eq!(run(&parts).skipped, 4);
    let mut joined = files(&parts.output);
    joined.retain(|name, _| !name.contains(".shard-"));
    assert!(joined == clean, "joined");
}

#[test]
fn what_changed_is_made_again_and_other_settings_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("fish"), place.path().join("out"));
    dataset(&root);
    let mut job = job(&root, &out);
    run(&job);
    let before = files(&out);
    fs::write(root.join("labels/train/a.txt"), "0 0.5 0.5 0.9 0.9\n").unwrap();
    assert_eq!((run(&job).done, check(&out, None, &ReadOptions::default()).unwrap().wrong), (1, Vec::new()));
    assert_eq!(files(&out)["labels/train/a.txt"], b"0 0.5 0.5 0.9 0.9\n");

    job.recipe.draws.seed = 2;
    let refused = job.run(&job.plan().unwrap(), &|_| {}).unwrap_err().to_string();
    assert!(refused.contains("other settings") && refused.contains("--overwrite"), "{refused}");
    job.overwrite = true;
    run(&job);
    let after = files(&out);
    assert_eq!(after.len(), before.len());
    assert!(check(&out, None, &ReadOptions::default()).unwrap().wrong.is_empty());
}

#[test]
fn a_depth_map_that_changed_makes_its_variants_anew() {
    let place = tempfile::tempdir().unwrap();
    let (root, out, maps) = (place.path().join("fish"), place.path().join("out"), place.path().join("depth"));
    dataset(&root);
    let map = |name: &str, seed: u64| {
        let depth = Scene::new(seed, Size { width: 48, height: 32 }).depth;
        let options = WriteOptions { overwrite: true, ..WriteOptions::default() };
        crate::depth_file::write(&maps.join("images/train").join(name), &depth, &options).unwrap();
    };
    fs::create_dir_all(maps.join("images/train")).unwrap();
    for (seed, name) in ["a.npy", "b.npy", "c.npy", "d.npy"].into_iter().enumerate() {
        map(name, seed as u64);
    }
    let mut job = job(&root, &out);
    job.recipe.depth =
        DepthPlan::Maps { folder: maps.clone(), kind: SuppliedKind::Metres, size: MapSize::Exact };
    assert_eq!((run(&job).done, run(&job).skipped), (4, 4));
    map("b.npy", 9);
    let ended = run(&job);
    assert_eq!((ended.done, ended.skipped), (1, 3));
    fs::remove_file(maps.join("images/train/b.npy")).unwrap();
    assert_eq!(run(&job).failed, 1);
}

#[test]
fn one_bad_image_is_listed_and_spoils_nothing() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("fish"), place.path().join("out"));
    dataset(&root);
    let whole = fs::read(root.join("images/train/b.jpg")).unwrap();
    fs::write(root.join("images/train/b.jpg"), "no image").unwrap();
    let job = job(&root, &out);
    let ended = run(&job);
    assert_eq!((ended.done, ended.failed), (3, 1));
    let text = fs::read_to_string(out.join("manifest.jsonl")).unwrap();
    assert!(text.contains(r#"{"line":"failed","key":"images/train/b.jpg","error":"cannot read"#), "{text}");
    assert!(!files(&out).keys().any(|name| name.contains("train/b")));
    fs::write(root.join("images/train/b.jpg"), whole).unwrap();
    assert_eq!((run(&job).done, run(&job).skipped), (1, 4));
}

#[test]
fn every_flipped_bit_is_found() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("fish"), place.path().join("out"));
    dataset(&root);
    run(&job(&root, &out));
    let all = files(&out);
    let mut number = 0_usize;
    for (name, bytes) in all.iter().cycle().take(100) {
        number += 1;
        let mut flipped = bytes.clone();
        let at = (number * 7919) % bytes.len();
        flipped[at] ^= 1 << (number % 8);
        fs::write(out.join(name), &flipped).unwrap();
        let found = check(&out, None, &ReadOptions::default());
        assert!(found.is_err() || !found.unwrap().wrong.is_empty(), "bit {number} of byte {at} of {name}");
        fs::write(out.join(name), bytes).unwrap();
    }
    assert!(check(&out, None, &ReadOptions::default()).unwrap().wrong.is_empty());
}

fn making<'a>(only: Option<&'a str>, dataset: Option<&'a Path>, output: &'a Path) -> Again<'a> {
    Again {
        only,
        dataset,
        output,
        overwrite: false,
        reading: ReadOptions::default(),
        encoding: PixelEncoding::Encoded,
        network_seconds: None,
    }
}

#[test]
fn a_variant_is_made_again_from_its_manifest() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("fish"), place.path().join("out"));
    dataset(&root);
    run(&job(&root, &out));
    let moved = place.path().join("moved");
    fs::rename(&root, &moved).unwrap();
    let again = place.path().join("again");
    let manifest = out.join("manifest.jsonl");
    let only = Some("images/train/b.jpg");
    let made = remake(&manifest, &making(only, Some(&moved), &again)).unwrap();
    assert_eq!((made.equal.len(), made.different.len(), made.failed.len()), (3, 0, 0));
    for (name, bytes) in files(&again) {
        assert_eq!(files(&out)[&name], bytes, "{name}");
    }
    let none = remake(&manifest, &making(Some("x"), Some(&moved), &again));
    assert!(none.unwrap_err().to_string().contains("no variant and no image \"x\""));
}

#[test]
fn outputs_that_are_not_ours_to_fill_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("fish");
    dataset(&root);
    let foreign = place.path().join("mine");
    fs::create_dir(&foreign).unwrap();
    fs::write(foreign.join("thesis.txt"), "").unwrap();
    for (output, said) in [
        (foreign, "no manifest of `aquafuse augment`"),
        (root.join("out"), "contains the other"),
        (place.path().to_owned(), "contains the other"),
    ] {
        let refused = job(&root, &output).plan().unwrap_err().to_string();
        assert!(refused.contains(said), "{refused}");
    }
    let mut equal = job(&root, &place.path().join("out"));
    equal.recipe.draws = Draws { theta: (45.0, 45.0), alpha: (1.0, 1.0), ..equal.recipe.draws };
    assert!(equal.plan().unwrap_err().to_string().contains("some would be equal"));
    equal.recipe.draws.with_replacement = true;
    let plan = equal.plan().unwrap();
    assert_eq!((plan.files(), plan.variants()), (4, 12));
}

/// An image as a file of JPEG holds it.
fn image_file(seed: u64) -> Vec<u8> {
    let scene = Scene::new(seed, Size { width: 48, height: 32 });
    let image = scene.seen_through(&waters()[1].water).convert::<u8>();
    ImageFile::new(image).encode("a.jpg".as_ref(), 95).unwrap()
}

/// A shard of three images with a label and a mask each.
fn shard(root: &Path) {
    fs::create_dir_all(root).unwrap();
    let mut builder = tar::Builder::new(fs::File::create(root.join("train-000.tar")).unwrap());
    for seed in 0..3 {
        let image_file = image_file(seed);
        for (end, bytes) in
            [("jpg", image_file), ("json", vec![b'0'; 700]), ("mask.png", vec![seed as u8; 5])]
        {
            let mut header = tar::Header::new_gnu();
            header.set_size(bytes.len() as u64);
            header.set_mtime(1000);
            builder.append_data(&mut header, format!("reef/{seed}.{end}"), bytes.as_slice()).unwrap();
        }
    }
    builder.finish().unwrap();
}

/// The members of a tar file, in their order.
fn members(path: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    let options = ReadOptions::default();
    let bytes = fs::read(path).unwrap();
    crate::dataset::shards::groups(path, bytes.as_slice(), &options, &mut |_| {}, &mut |group| {
        found.extend(group.members.into_iter().map(|member| (member.path, member.bytes)));
        Ok(())
    })
    .unwrap();
    found
}

/// A sample is held as a whole: it is its members' sum that counts, not the largest.
#[test]
fn a_sample_of_a_shard_whose_members_are_too_much_together_is_refused() {
    let mut shard = tar::Builder::new(Vec::new());
    for (name, length) in [("a.0", 600_u64), ("b.0", 600), ("b.1", 600)] {
        let mut header = tar::Header::new_gnu();
        header.set_size(length);
        shard.append_data(&mut header, name, &[0_u8; 600][..]).unwrap();
    }
    let bytes = shard.into_inner().unwrap();
    let options = ReadOptions { max_memory: 1_000, ..ReadOptions::default() };
    let mut seen = Vec::new();
    let path = Path::new("a.tar");
    let read = crate::dataset::shards::groups(path, bytes.as_slice(), &options, &mut |_| {}, &mut |group| {
        seen.extend(group.members.into_iter().map(|member| member.path));
        Ok(())
    });
    let refused = read.unwrap_err().to_string();
    assert!(refused.contains("b in it has 1200 bytes or more, 1000 are allowed"), "{refused}");
    assert_eq!(seen, ["a.0"]);
}

#[test]
fn shards_are_multiplied_as_a_whole() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("shards"), place.path().join("out"));
    shard(&root);
    let job = job(&root, &out);
    assert_eq!(run(&job).done, 1);
    let (before, after) = (members(&root.join("train-000.tar")), members(&out.join("train-000.tar")));
    assert_eq!(after.len(), 4 * before.len());
    // The sample itself, then its variants, each with what is about it.
    assert_eq!(after[..3], before[..3]);
    assert!(after[3].0.starts_with("reef/0__") && after[3].0.ends_with("__0.jpg"), "{}", after[3].0);
    assert_eq!((&after[4].1, &after[5].1), (&before[1].1, &before[2].1));
    assert!(after[5].0.ends_with("__0.mask.png"));
    assert_eq!(run(&job).skipped, 1);
    let clean = files(&out);
    fs::remove_file(out.join("manifest.jsonl")).unwrap();
    fs::remove_file(out.join("train-000.tar")).unwrap();
    run(&job);
    assert!(files(&out) == clean);
    assert!(check(&out, Some(&root), &ReadOptions::default()).unwrap().wrong.is_empty());

    let again = place.path().join("again");
    let manifest = out.join("manifest.jsonl");
    let only = Some("train-000.tar/reef/1.jpg");
    let made = remake(&manifest, &making(only, None, &again)).unwrap();
    assert_eq!((made.equal.len(), made.failed.len()), (3, 0));
    for (name, bytes) in files(&again) {
        assert!(after.contains(&(name.clone(), bytes)), "{name}");
    }
}

#[test]
fn shards_that_are_cut_short_or_lead_out_are_refused_and_a_bad_image_spoils_nothing() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("shards"), place.path().join("out"));
    shard(&root);
    let path = root.join("train-000.tar");
    let whole = fs::read(&path).unwrap();
    let job = job(&root, &out);
    // Within a member, between two of them, and without its end.
    for cut in [whole.len() / 2, 512, whole.len() - 1024] {
        fs::write(&path, &whole[..cut]).unwrap();
        let ended = run(&job);
        assert_eq!((ended.failed, files(&out).len()), (1, 1), "cut at {cut}");
    }
    let mut outside = tar::Builder::new(Vec::new());
    let mut header = tar::Header::new_gnu();
    header.set_size(1);
    let name = b"../a.jpg";
    header.as_old_mut().name[..name.len()].copy_from_slice(name);
    header.set_cksum();
    outside.append(&header, &b"x"[..]).unwrap();
    fs::write(&path, outside.into_inner().unwrap()).unwrap();
    run(&job);
    let manifest = fs::read_to_string(out.join("manifest.jsonl")).unwrap();
    assert!(manifest.contains("with `..`"), "{manifest}");

    let image_file = whole.windows(2).position(|two| two == [0xff, 0xd8]).unwrap();
    let mut bad = whole.clone();
    bad[image_file] = 0;
    fs::write(&path, bad).unwrap();
    let ended = run(&job);
    assert_eq!((ended.failed, ended.left), (1, 0));
    assert_eq!(members(&out.join("train-000.tar")).len(), 9 + 2 * 9);
    fs::write(&path, whole).unwrap();
    assert_eq!((run(&job).done, run(&job).skipped), (1, 1));
    assert_eq!(members(&out.join("train-000.tar")).len(), 36);
}

#[test]
fn a_manifest_with_a_number_too_large_for_its_settings_is_none() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("fish"), place.path().join("out"));
    dataset(&root);
    run(&job(&root, &out));
    let path = out.join("manifest.jsonl");
    let text = fs::read_to_string(&path).unwrap();
    for (from, large, line) in [
        ("\"most_gain\":2.0", "\"most_gain\":1e39", 1),
        ("\"theta\":", "\"theta\":1e39,\"was\":", 3),
        ("\"theta\":", "\"theta\":91,\"was\":", 3),
        ("\"alpha\":", "\"alpha\":-1,\"was\":", 3),
    ] {
        let at = text.find(from).unwrap();
        let end = at + from.len();
        fs::write(&path, format!("{}{large}{}", &text[..at], &text[end..])).unwrap();
        let refused = check(&out, None, &ReadOptions::default()).unwrap_err();
        assert!(matches!(refused, AugmentError::Manifest { line: told, .. } if told == line), "{refused}");
    }
}

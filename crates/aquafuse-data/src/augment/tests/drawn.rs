//! Waters of the sea, variants that are drawn again, and copies of originals.

use aquafuse::depth::RelativeScale;
use serde_json::Value;

use super::*;
use crate::pipeline::Outcome;

fn sea() -> Sea {
    Sea { depth_kind: DepthKind::Relative, scale: RelativeScale::default(), visibility: None }
}

/// The variants in a manifest.
fn variants(out: &Path) -> Vec<Value> {
    let text = fs::read_to_string(out.join("manifest.jsonl")).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    lines.filter(|line| line["line"] == "variant").collect()
}

/// Runs it clean, by one thread and after a stop; its files are the same each time, and replayed.
fn clean(root: &Path, place: &Path, change: impl Fn(&mut Augmentation)) -> BTreeMap<String, Vec<u8>> {
    let new = |name: &str| {
        let mut new = job(root, &place.join(name));
        change(&mut new);
        new
    };
    let (whole, mut again) = (new("clean"), new("again"));
    run(&whole);
    let clean = files(&whole.output);
    again.run_options.threads = NonZeroUsize::new(1);
    run(&again);
    assert!(files(&again.output) == clean, "one thread");
    let manifest = again.output.join("manifest.jsonl");
    let text = fs::read(&manifest).unwrap();
    fs::write(&manifest, &text[..text.len() * 2 / 3]).unwrap();
    assert!(run(&again).done > 0);
    assert!(files(&again.output) == clean, "gone on with");
    assert_eq!(run(&again).done, 0);
    let made =
        remake(&whole.output.join("manifest.jsonl"), &making(None, None, &place.join("made"))).unwrap();
    let count = variants(&whole.output).len();
    assert_eq!((made.equal.len(), made.different.len(), made.failed.len()), (count, 0, 0));
    let checked = check(&whole.output, Some(root), &ReadOptions::default()).unwrap();
    assert_eq!((checked.wrong.len(), checked.unlisted.len()), (0, 0));
    clean
}

#[test]
fn each_variant_has_a_water_of_its_own_from_the_sea() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("fish");
    dataset(&root);
    let files = clean(&root, place.path(), |job| {
        job.recipe.waters = Vec::new();
        job.recipe.sea = Some(sea());
        job.recipe.draws.theta = (0.0, 0.0);
        job.recipe.draws.alpha = (1.0, 1.0);
    });
    let mut numbers: Vec<u64> =
        variants(&place.path().join("clean")).iter().filter_map(|made| made["sea"].as_u64()).collect();
    numbers.sort_unstable();
    numbers.dedup();
    assert_eq!(numbers.len(), 4 * 3);
    assert!(
        files.contains_key("labels/train/a__sea__2.txt") && files.contains_key("images/train/b__sea__0.jpg")
    );
}

#[test]
fn every_second_variant_is_of_the_sea_if_there_are_references() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("fish");
    dataset(&root);
    let files = clean(&root, place.path(), |job| {
        job.recipe.sea = Some(sea());
        job.recipe.per_image = 4;
        job.recipe.draws.theta = (0.0, 0.0);
        job.recipe.draws.alpha = (1.0, 1.0);
    });
    for (name, count) in [("__sea__", 8), ("__green__", 4), ("__jerlov-3C__", 4)] {
        assert_eq!(files.keys().filter(|key| key.starts_with("images") && key.contains(name)).count(), count);
    }
    let mut more = job(&root, &place.path().join("more"));
    more.recipe.sea = Some(sea());
    more.recipe.per_image = 5;
    more.recipe.draws = Draws { theta: (0.0, 0.0), alpha: (1.0, 1.0), ..more.recipe.draws };
    assert!(more.plan().unwrap_err().to_string().contains("some would be equal"));
    more.recipe.sea = Some(Sea { visibility: Some(-1.0), ..sea() });
    more.recipe.per_image = 1;
    assert!(more.plan().unwrap_err().to_string().contains("--visibility"));
}

#[test]
fn what_is_hidden_or_hardly_changed_is_drawn_again() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("fish");
    dataset(&root);
    clean(&root, place.path(), |job| {
        job.recipe.per_image = 6;
        job.recipe.draws.theta = (0.0, 90.0);
        job.recipe.options = Options::for_model(aquafuse::fusion::Model::Relight);
    });
    let made = variants(&place.path().join("clean"));
    let times = |made: &Value| made["redrawn"].as_u64().unwrap_or(0);
    assert!(made.iter().any(|made| times(made) > 0) && made.iter().all(|made| times(made) < 8));
    let changed = made.iter().filter(|made| made["change"].as_f64().unwrap() >= Outcome::UNCHANGED);
    assert_eq!(changed.count(), made.len(), "a water that differs has an angle at which that is seen");
}

#[test]
fn where_no_draw_is_better_the_best_is_taken_and_counted() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("fish");
    dataset(&root);
    let count = std::sync::Mutex::new((0, 0));
    for (name, theta) in [("fixed", (90.0, 90.0)), ("free", (89.0, 90.0))] {
        let mut still = job(&root, &place.path().join(name));
        still.recipe.per_image = 1;
        still.recipe.draws = Draws { theta, alpha: (1.0, 1.0), ..still.recipe.draws };
        fs::create_dir_all(&still.output).unwrap();
        *count.lock().unwrap() = (0, 0);
        let listen = |event: crate::run::Event<'_, str, Multiplied>| {
            if let Event::Done { result, .. } = event {
                let mut count = count.lock().unwrap();
                *count = (count.0 + result.unchanged, count.1 + result.redrawn);
            }
        };
        still.run(&still.plan().unwrap(), &listen).unwrap();
        let (unchanged, redrawn) = *count.lock().unwrap();
        assert_eq!((unchanged, redrawn > 0), (4, name == "free"));
        let made =
            remake(&still.output.join("manifest.jsonl"), &making(None, None, &place.path().join("made")));
        assert_eq!(made.unwrap().different.len(), 0);
    }
}

#[test]
fn a_share_of_the_originals_is_copied_with_their_labels() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("fish");
    dataset(&root);
    fs::write(root.join("train.txt"), "images/train/a.png\nimages/train/b.jpg\nimages/train/c.png\n")
        .unwrap();
    let with = |job: &mut Augmentation, seed: u64| {
        job.recipe.per_image = 1;
        job.recipe.keep_originals = false;
        job.recipe.keep_share = 0.3;
        job.recipe.draws.seed = seed;
    };
    let some = (0..).find(|&seed| {
        let mut tried = job(&root, &place.path().join("tried"));
        with(&mut tried, seed);
        tried.plan().unwrap().originals() == 2
    });
    let change = |job: &mut Augmentation| with(job, some.unwrap());
    let after = clean(&root, place.path(), change);
    let before = files(&root);
    let copied: Vec<&String> =
        before.keys().filter(|name| after.contains_key(*name) && name.starts_with("images")).collect();
    let mut again = job(&root, &place.path().join("again"));
    change(&mut again);
    assert_eq!(copied.len(), again.plan().unwrap().originals());
    assert_eq!(copied.len(), 2);
    for name in copied {
        let label = format!("labels/train/{}.txt", &name["images/train/".len()..][..1]);
        assert_eq!((&after[name], &after[&label]), (&before[name], &before[&label]));
        let list = String::from_utf8_lossy(&after["train.txt"]);
        assert_eq!(list.lines().filter(|line| line == name).count(), usize::from(!name.ends_with("d.tif")));
    }
    // Three variants of each: a quarter are copies once every image is copied, and no image is copied twice.
    let mut more = job(&root, &place.path().join("more"));
    more.recipe.keep_originals = false;
    more.recipe.keep_share = 0.25;
    run(&more);
    let images = files(&more.output).into_keys().filter(|name| name.starts_with("images")).count();
    assert_eq!(images, 4 + 4 * 3);
}

#[test]
fn a_share_of_the_members_of_a_shard_is_copied() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("set");
    shard(&root);
    let mut few = job(&root, &place.path().join("few"));
    few.recipe.per_image = 1;
    few.recipe.keep_originals = false;
    few.recipe.keep_share = 0.4;
    few.recipe.sea = Some(sea());
    few.recipe.waters = Vec::new();
    run(&few);
    let names: Vec<String> =
        members(&few.output.join("train-000.tar")).into_iter().map(|(name, _)| name).collect();
    let copied = names.iter().filter(|name| name.ends_with(".jpg") && !name.contains("__")).count();
    let text = fs::read_to_string(few.output.join("manifest.jsonl")).unwrap();
    let line: Value = serde_json::from_str(text.lines().nth(1).unwrap()).unwrap();
    assert_eq!(line["originals"].as_array().map_or(0, Vec::len), copied);
    assert!((1..3).contains(&copied), "{names:?}");
    assert_eq!(names.len(), 3 * (3 + copied));
    let made = remake(&few.output.join("manifest.jsonl"), &making(None, None, &place.path().join("made")));
    assert_eq!(made.unwrap().equal.len(), 3);
}

#[test]
fn a_manifest_of_before_is_read() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("fish"), place.path().join("out"));
    dataset(&root);
    run(&job(&root, &out));
    let path = out.join("manifest.jsonl");
    let text = fs::read_to_string(&path).unwrap();
    let fields = text.lines().map(|line| {
        let mut line: Value = serde_json::from_str(line).unwrap();
        for name in ["change", "redrawn", "sea"] {
            line.as_object_mut().unwrap().remove(name);
        }
        if let Some(settings) = line.get_mut("settings") {
            settings.as_object_mut().unwrap().remove("keep_share");
        }
        line.to_string() + "\n"
    });
    fs::write(&path, fields.filter(|line| !line.contains("\"line\":\"end\"")).collect::<String>()).unwrap();
    let made = remake(&path, &making(None, None, &place.path().join("made"))).unwrap();
    assert_eq!((made.equal.len(), made.different.len()), (4 * 3, 0));
}

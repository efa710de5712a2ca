//! `aquafuse evaluate`, as a user runs it.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::depth_file;
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use run::{Run, scene};
use serde_json::Value;

/// Two blue images, two green ones and a clear one, named by their water.
fn dives(run: &Run) {
    std::fs::create_dir(run.path("dives")).unwrap();
    let all = [("blue", 1), ("blue", 2), ("green", 3), ("green", 4), ("clear", 5)];
    for (water, seed) in all {
        scene(&run.path(&format!("dives/{water}_{seed}.png")), seed, water);
    }
}

const FUSION: [&str; 6] = ["evaluate", "fusion", "--contents", "dives", "--references", "dives"];

fn with<'a>(start: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [start, more].concat()
}

fn json(run: &Run, arguments: &[&str]) -> Value {
    serde_json::from_str(&run.ok(&with(arguments, &["--json"])).stdout).unwrap()
}

/// The first row of a table whose labels are these.
fn row<'a>(report: &'a Value, table: &str, labels: &[(&str, &str)]) -> &'a Value {
    let tables = report["tables"].as_array().unwrap();
    let rows = tables.iter().find(|found| found["name"] == table).unwrap()["rows"].as_array().unwrap();
    rows.iter().find(|row| labels.iter().all(|(name, label)| row[*name] == *label)).unwrap()
}

#[test]
fn each_group_has_a_row_and_each_format_its_file() {
    let run = Run::new();
    dives(&run);
    let said =
        run.ok(&with(&FUSION, &["--model", "aquafuse", "--group-by", "prefix", "--rivals", "-o", "report"]));
    let said = said.stdout;
    assert!(said.contains("| AquaFuse | green | 2 | 6 |") && said.contains("report: written"), "{said}");
    assert!(said.contains("published, other machine: Table 1") && said.contains("PhotoWCT2"), "{said}");

    let text = |name: &str| String::from_utf8(run.bytes(name)).unwrap();
    let report: Value = serde_json::from_str(&text("report/report.json")).unwrap();
    assert_eq!((&report["schema"], &report["command"]), (&Value::from(1), &Value::from("evaluate fusion")));
    // 5 contents: blue and green meet the 3 of the other groups, clear meets 4; by five methods.
    assert_eq!(report["items"].as_array().unwrap().len(), (4 * 3 + 4) * 5);
    assert_eq!(text("report/items.csv").lines().count(), 1 + (4 * 3 + 4) * 5);
    let all = row(&report, "likeness", &[("method", "histogram matching"), ("group", "all")]);
    assert_eq!(all["pairs"], 16.0);
    let [low, high] = [0, 1].map(|end| all["ssim"]["interval"][end].as_f64().unwrap());
    assert!((low..=high).contains(&all["ssim"]["mean"].as_f64().unwrap()));
    assert!(text("report/report.md").contains("| Reinhard | clear | 1 | 4 |"));
    assert!(text("report/report.csv").contains("likeness,gray world,blue,depth_consistency,6,0,"));
    assert!(text("report/report.csv").contains("likeness,Reinhard,blue,near_change,6,0,"));
    assert!(text("report/report.md").contains("| way to the water, % | near change, ΔE | sharpness ratio |"));
    // A pair whose waters are alike is left out, whatever the method.
    let way = |method| &row(&report, "likeness", &[("method", method), ("group", "all")])["way_percent"];
    for method in ["AquaFuse", "Reinhard"] {
        let [count, left_out] = ["count", "left_out"].map(|key| way(method)[key].as_u64().unwrap());
        assert!(count > 0 && count + left_out == 16, "{count} and {left_out}");
        assert_eq!(way(method)["left_out"], way("gray world")["left_out"]);
    }
    // The page needs nothing that is not in it.
    let page = text("report/report.html");
    assert!(page.contains("<svg") && page.contains("src=\"data:image/jpeg;base64,"));
    assert!(!page.contains("http") && !page.contains("<script") && page.matches("src=").count() >= 7);

    let refused = run.fails(2, &with(&FUSION, &["-o", "report"])).stderr;
    assert!(refused.contains("report.md") && refused.contains("--overwrite"), "{refused}");
}

#[test]
fn threads_and_the_time_of_day_change_no_byte_of_any_format() {
    let run = Run::new();
    dives(&run);
    let evaluate = |output, threads| {
        let more = ["--group-by", "prefix", "--pairs", "2", "--rivals", "--seed", "5", "--threads", threads];
        run.ok(&with(&with(&FUSION, &more), &["-o", output]));
    };
    evaluate("alone", "1");
    evaluate("together", "4");
    for name in ["report.md", "report.csv", "report.json", "report.html", "items.csv"] {
        let [alone, together] = ["alone", "together"].map(|folder| run.bytes(&format!("{folder}/{name}")));
        assert!(!alone.is_empty() && alone == together, "{name} differs");
    }
}

#[test]
fn what_changes_nothing_scores_as_nothing_changed() {
    let run = Run::new();
    dives(&run);
    let report = json(&run, &with(&FUSION, &["--model", "aquafuse", "--theta", "90"]));
    let all = row(&report, "likeness", &[("method", "AquaFuse")]);
    assert_eq!(all["psnr"], Value::Null);
    assert_eq!(all["ssim"]["mean"].as_f64().unwrap(), 1.0);
    assert_eq!(all["depth_rmse_percent"]["mean"].as_f64().unwrap(), 0.0);
    assert_eq!(all["depth_consistency"]["interval"][0].as_f64().unwrap(), 100.0);
    for (score, expected) in [("way_percent", 0.0), ("near_change", 0.0), ("sharpness_ratio", 1.0)] {
        assert_eq!(all[score]["interval"], serde_json::json!([expected, expected]), "{score}");
    }
}

#[test]
fn another_tools_images_are_scored_as_ours_and_what_is_missing_is_named() {
    let run = Run::new();
    std::fs::create_dir(run.path("c")).unwrap();
    std::fs::create_dir(run.path("r")).unwrap();
    scene(&run.path("c/reef.png"), 1, "blue");
    scene(&run.path("c/wall.png"), 2, "clear");
    scene(&run.path("r/milky.png"), 3, "turbid");
    for stem in ["reef", "wall"] {
        let (content, output) = (format!("c/{stem}.png"), format!("mine/{stem}__milky.png"));
        run.ok(&["fuse", &content, "r/milky.png", "-o", &output, "--model", "physical"]);
    }
    let evaluate = [
        "evaluate",
        "fusion",
        "--contents",
        "c",
        "--references",
        "r",
        "--model",
        "physical",
        "--method",
        "mine=mine",
    ];
    let report = json(&run, &evaluate);
    let [ours, theirs] =
        ["AquaFuse physical", "mine"].map(|name| row(&report, "likeness", &[("method", name)]));
    for score in ["psnr", "ssim", "depth_rmse_levels", "way_percent", "near_change", "sharpness_ratio"] {
        assert_eq!(ours[score]["mean"], theirs[score]["mean"], "{score}");
    }

    std::fs::remove_file(run.path("mine/wall__milky.png")).unwrap();
    let ended = run.fails(1, &with(&evaluate, &["-o", "report.md"]));
    assert!(ended.stderr.contains("mine holds 0 images with the stem wall__milky"), "{}", ended.stderr);
    assert!(ended.stdout.contains("| mine | all | 1 | 1 |"), "{}", ended.stdout);
    let report = String::from_utf8(run.bytes("report.md")).unwrap();
    assert!(
        report.contains("## What failed") && report.contains("wall.png in milky.png by mine"),
        "{report}"
    );

    let small = Scene::new(1, Size { width: 40, height: 30 }).clear.convert::<u8>();
    ImageFile::new(small).write(&run.path("mine/wall__milky.png"), &WriteOptions::default()).unwrap();
    let ended = run.fails(1, &evaluate).stderr;
    assert!(ended.contains("has 40x30 pixels") && ended.contains("96x64"), "{ended}");
    let twice = run.fails(2, &with(&evaluate, &["--method", "mine=mine"])).stderr;
    assert!(twice.contains("two methods are named mine"), "{twice}");
}

#[test]
fn supplied_depth_says_what_is_far_and_no_method_sees_it() {
    let run = Run::new();
    for folder in ["c", "r", "zc", "zr"] {
        std::fs::create_dir(run.path(folder)).unwrap();
    }
    for (seed, name, water) in [(1, "c/reef", 0), (2, "r/green", 2)] {
        let place = Scene::new(seed, Size { width: 96, height: 64 });
        let image = place.seen_through(&waters()[water].water).convert::<u8>();
        ImageFile::new(image).write(&run.path(&format!("{name}.png")), &WriteOptions::default()).unwrap();
        let depth = run.path(&format!("z{name}.tiff"));
        depth_file::write(&depth, &place.depth, &WriteOptions::default()).unwrap();
    }
    let evaluate = ["evaluate", "fusion", "--contents", "c", "--references", "r", "--rivals"];
    let contents = ["--depth", "zc", "--depth-kind", "metres"];
    let supplied = with(&contents, &["--water-depth", "zr", "--water-depth-kind", "metres"]);
    let [plain, measured] = [json(&run, &evaluate), json(&run, &with(&evaluate, &supplied))];
    assert_eq!(
        (&plain["settings"]["content_depth"], &measured["settings"]["content_depth"]),
        (&Value::Null, &Value::from("metres"))
    );
    for (plain, measured) in
        plain["items"].as_array().unwrap().iter().zip(measured["items"].as_array().unwrap())
    {
        for same in ["psnr", "ssim", "sharpness_ratio"] {
            assert_eq!(plain[same], measured[same], "{same}");
        }
        assert_ne!(plain["near_change"], measured["near_change"]);
    }

    for (arguments, expected) in [
        (&contents[..2], "--depth-kind"),
        (&contents[2..], "--depth"),
        (&["--water-depth", "zr"], "--water-depth-kind"),
        (&["--depth", "nowhere", "--depth-kind", "metres"], "nowhere"),
    ] {
        let refused = run.fails(2, &with(&evaluate, arguments)).stderr;
        assert!(refused.contains(expected), "{arguments:?}: {refused}");
    }
    std::fs::remove_file(run.path("zc/reef.tiff")).unwrap();
    let ended = run.fails(1, &with(&evaluate, &contents)).stderr;
    assert!(ended.contains("zc") && ended.contains("reef.png"), "{ended}");
}

#[test]
fn a_bad_image_spoils_nothing_but_itself() {
    let run = Run::new();
    dives(&run);
    let whole = json(&run, &with(&FUSION, &["--group-by", "prefix"]));
    std::fs::write(run.path("dives/blue_9.png"), "no image").unwrap();
    let ended = run.fails(1, &with(&FUSION, &["--group-by", "prefix", "-o", "report.json"]));
    assert!(ended.stderr.contains("blue_9.png") && ended.stderr.contains("failed"), "{}", ended.stderr);
    let report: Value = serde_json::from_slice(&run.bytes("report.json")).unwrap();
    assert_eq!(report["items"], whole["items"]);
    assert_eq!(report["tables"], whole["tables"]);
    let failed = report["failed"].as_array().unwrap();
    assert!(!failed.is_empty() && failed.iter().all(|one| one["name"] == "blue_9.png"), "{failed:?}");
}

#[test]
fn what_cannot_be_evaluated_is_refused_before_work_begins() {
    let run = Run::new();
    dives(&run);
    std::fs::create_dir(run.path("empty")).unwrap();
    for (arguments, expected) in [
        (with(&FUSION, &["-o", "report.pdf"]), "must end in .md"),
        (with(&FUSION, &["--group-by", "folder"]), "no content has a reference of another group"),
        (with(&FUSION, &["--method", "mine"]), "NAME=DIR"),
        (with(&FUSION, &["--method", "mine=empty"]), "empty holds no"),
        (with(&FUSION, &["--pairs", "0"]), "--pairs"),
        (vec!["evaluate", "fusion", "--contents", "empty", "--references", "dives"], "empty holds no"),
        (vec!["evaluate", "enhancement", "nowhere"], "nowhere"),
        (vec!["evaluate", "depth", "dives", "--depth-kind", "metres"], "dives/rgb"),
        (vec!["evaluate", "depth", "dives", "--depth-kind", "metres", "--maps", "net=maps"], "NAME"),
    ] {
        let refused = run.fails(2, &arguments).stderr;
        assert!(refused.contains(expected), "{arguments:?}: {refused}");
    }
    assert!(!run.path("report.pdf").exists());
}

#[test]
fn truth_tells_the_methods_apart() {
    let run = Run::new();
    let report = json(&run, &["evaluate", "truth", "--exchanges", "4"]);
    let share = |way: &str, method: &str| {
        row(&report, "truth", &[("way", way), ("method", method)])["share_a"]["mean"].as_f64().unwrap()
    };
    assert!(share("everything given: the ceiling", "`physical`") > 0.9);
    assert!(share("colours alone", "Monge–Kantorovich") < 0.9);
    assert_eq!(share("the truth itself", "A"), 1.0);
    let linear = json(&run, &["evaluate", "truth", "--exchanges", "4", "--linear"]);
    assert_eq!(linear["settings"]["encoding"], "linear");
    assert_ne!(linear["items"], report["items"]);
}

#[test]
fn enhancement_is_told_image_by_image() {
    let run = Run::new();
    dives(&run);
    let evaluate = ["evaluate", "enhancement", "dives", "--reference", "dives", "--method", "same=dives"];
    let report = json(&run, &evaluate);
    // Quiet hides progress, not what was asked for; a file is what was asked for, if there is one.
    let quiet = run.ok(&[&evaluate[..], &["--quiet"]].concat());
    assert!(quiet.stdout.contains("| AquaFuse enhance |") && quiet.stderr.is_empty());
    assert_eq!(run.ok(&[&evaluate[..], &["--quiet", "--output", "r.md"]].concat()).stdout, "");
    // The references are the images themselves here, so that each change is a loss.
    let score =
        |method: &str, score: &str| row(&report, "scores", &[("method", method)])[score]["mean"].as_f64();
    assert_eq!((score("before", "psnr"), score("before", "ssim")), (None, Some(1.0)));
    for method in ["AquaFuse enhance", "AquaFuse restore", "stretch, 1 to 99 %", "gray world"] {
        assert!(score(method, "psnr").is_some_and(|psnr| (5.0..60.0).contains(&psnr)), "{method}");
    }
    let change = |method: &str, score: &str| {
        row(&report, "change", &[("method", method)])[score]["mean"].as_f64().unwrap()
    };
    // The images as they are, called another tool's, change nothing.
    assert_eq!((change("same", "uciqe"), change("same", "sharpness")), (0.0, 0.0));
    assert!(change("AquaFuse enhance", "contrast") > 0.0);
    // One image's figures are those of the command itself.
    let single = run.ok(&["enhance", "dives/green_3.png", "-o", "g.png", "--json"]).stdout;
    let single: Value = serde_json::from_str(&single).unwrap();
    let items = report["items"].as_array().unwrap();
    let of = |method: &str| {
        items.iter().find(|item| item["picture"] == "green_3.png" && item["method"] == method).unwrap()
    };
    for score in ["uciqe", "uiqm", "colour", "contrast", "sharpness"] {
        assert_eq!(of("before")[score], single["scores"]["before"][score], "{score}");
        assert_eq!(of("AquaFuse enhance")[score], single["scores"]["after"][score], "{score}");
    }
}

#[test]
fn depth_maps_are_measured_by_their_declared_kind() {
    let run = Run::new();
    for folder in ["pairs", "pairs/rgb", "pairs/depth", "near"] {
        std::fs::create_dir(run.path(folder)).unwrap();
    }
    for (seed, name) in [(1, "a"), (2, "b"), (3, "c")] {
        let place = Scene::new(seed, Size { width: 96, height: 64 });
        let image = place.seen_through(&waters()[0].water).convert::<u8>();
        ImageFile::new(image)
            .write(&run.path(&format!("pairs/rgb/{name}.png")), &WriteOptions::default())
            .unwrap();
        let depth = run.path(&format!("pairs/depth/{name}.tiff"));
        depth_file::write(&depth, &place.depth, &WriteOptions::default()).unwrap();
        // What a stereo pair would give of the same place: 3 / z, as text that is a PFM.
        let values = place.depth.distances().into_iter().map(|z| 3.0 / z);
        let rows: Vec<Vec<u8>> = values
            .collect::<Vec<f32>>()
            .chunks(96)
            .rev()
            .map(|row| row.iter().flat_map(|value| value.to_le_bytes()).collect())
            .collect();
        std::fs::write(
            run.path(&format!("near/{name}.pfm")),
            [b"Pf 96 64 -1\n".to_vec(), rows.concat()].concat(),
        )
        .unwrap();
    }
    let evaluate =
        ["evaluate", "depth", "pairs", "--depth-kind", "metres", "--maps", "stereo=disparity:near"];
    let report = json(&run, &with(&evaluate, &["--maps", "inverted=metres:near"]));
    let score =
        |name: &str, score: &str| row(&report, "depth", &[("depth", name)])[score]["mean"].as_f64().unwrap();
    assert!((score("stereo", "spearman") - 1.0).abs() < 1e-9);
    assert!(score("stereo", "rmse_metres") < 1e-3 && score("stereo", "delta_percent") == 100.0);
    assert!((score("inverted", "spearman") + 1.0).abs() < 1e-9);
    // It is worth what the mean is worth, and no more.
    assert!(score("inverted", "rmse_metres") > score("`eq3`", "rmse_metres"));
    assert!(score("image row", "spearman") > 0.5);

    std::fs::remove_file(run.path("near/b.pfm")).unwrap();
    let ended = run.fails(1, &evaluate);
    assert!(ended.stderr.contains("near") && ended.stderr.contains("b.png"), "{}", ended.stderr);
    assert!(ended.stdout.contains("| stereo | 2 |"), "{}", ended.stdout);
}

//! The command as a user runs it.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::path::Path;

use run::{Run, scene, scenes_folder};

#[test]
fn an_image_is_fused_and_the_clipping_reported() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    scene(&run.path("water.png"), 2, "green");
    let done = run.ok(&["fuse", "content.png", "water.png", "-o", "out/fused.png", "--model", "physical"]);
    assert!(done.stdout.contains("fused.png") && done.stdout.contains("clipped"), "{}", done.stdout);
    let (before, after) = (pixels(&run.path("content.png")), pixels(&run.path("out/fused.png")));
    let green = |pixels: &[u8]| pixels.chunks(3).take(96).map(|p| u32::from(p[1])).sum::<u32>();
    assert!(green(&after) > green(&before), "the top row did not turn green");
}

#[test]
fn a_folder_gets_one_line_of_counts_and_verbose_names_the_images() {
    let run = Run::new();
    std::fs::create_dir(run.path("photos")).unwrap();
    scene(&run.path("photos/reef.png"), 1, "blue");
    let night = aquafuse::image::Image::<u8>::from_raw(64, 64, vec![0; 64 * 64 * 3]).unwrap();
    let night = aquafuse_data::image_file::ImageFile::new(night);
    night.write(&run.path("photos/night.png"), &Default::default()).unwrap();
    scene(&run.path("water.png"), 2, "clear");
    let bright = ["fuse", "photos", "water.png", "-o", "out", "--model", "physical", "--alpha", "4"];
    let said = run.ok(&bright).stdout;
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines.len(), 4, "the water, the counts, and what needs an eye: {said}");
    assert!(lines[2].contains("night.png: the water is nearly black"), "{said}");
    assert!(lines[3].contains("reef.png (1 % of the contrast left)"), "{said}");
    assert!(lines[1].starts_with("2 images written; estimates: 1 good, 0 doubtful, 1 failed; "), "{said}");
    let counts = lines[1].strip_suffix("; -v names the images").unwrap();
    assert!(counts.ends_with(" % of the values clipped"), "{said}");

    std::fs::remove_dir_all(run.path("out")).unwrap();
    let said = run.ok(&[&bright[..], &["-v"]].concat()).stdout;
    assert!(said.starts_with(&format!("{}\n{counts}\n", lines[0])), "{said}");
    let clipped = said.split_once("  much clipped:\n").unwrap().1;
    assert!(clipped.lines().next().unwrap().contains("reef.png: "), "{said}");
    let failed = said.split_once("  estimate failed:\n").unwrap().1;
    let night = "night.png: no open water was found, all depths are alike,";
    assert!(failed.lines().next().unwrap().contains(night), "{said}");
    run.fails(2, &[&bright[..], &["-v", "--quiet"]].concat());
}

#[test]
fn what_holds_for_every_image_is_said_once() {
    let run = Run::new();
    scenes_folder(&run.path("photos"));
    let limited = "  all 3 images: limited by safety bounds";
    let said = run.ok(&["restore", "photos", "-o", "out", "-v", "--max-gain", "8"]).stdout;
    assert_eq!(said.matches(limited).count(), 1, "{said}");
    assert_eq!(said.matches("a.png").count(), 0, "{said}");
}

#[test]
fn the_line_on_a_single_image_gives_the_verdict_and_its_reasons() {
    let run = Run::new();
    let night = aquafuse::image::Image::<u8>::from_raw(64, 64, vec![0; 64 * 64 * 3]).unwrap();
    let night = aquafuse_data::image_file::ImageFile::new(night);
    night.write(&run.path("night.png"), &Default::default()).unwrap();
    let said = run.ok(&["restore", "night.png", "-o", "day.png"]).stdout;
    assert!(said.starts_with("day.png: written; estimate failed (no open water was found, "), "{said}");
    // And where they are explained.
    assert!(said.lines().nth(1).unwrap().contains("`aquafuse inspect --help`"), "{said}");
    let said = run.ok(&["restore", "night.png", "-o", "day.png", "--overwrite", "-v"]).stdout;
    assert_eq!(said.matches("all depths are alike").count(), 1, "{said}");
}

#[test]
fn at_ninety_degrees_the_content_comes_back() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    scene(&run.path("water.png"), 2, "green");
    for model in ["aquafuse", "physical", "exchange"] {
        run.ok(&[
            "fuse",
            "content.png",
            "water.png",
            "-o",
            "same.png",
            "--overwrite",
            "--theta",
            "90",
            "--model",
            model,
        ]);
        assert_eq!(pixels(&run.path("content.png")), pixels(&run.path("same.png")));
    }
}

#[test]
fn a_folder_is_fused_whatever_the_number_of_threads() {
    let run = Run::new();
    scenes_folder(&run.path("photos"));
    scene(&run.path("water.jpg"), 9, "turbid");
    run.ok(&["fuse", "photos", "water.jpg", "-o", "one", "--threads", "1"]);
    let two = run.ok(&["fuse", "photos", "water.jpg", "-o", "two", "--threads", "2"]);
    assert!(two.stdout.contains("\n3 images written"), "{}", two.stdout);
    for name in ["a.png", "b.png", "c.jpg"] {
        assert_eq!(run.bytes(&format!("one/{name}")), run.bytes(&format!("two/{name}")), "{name}");
    }
    assert!(!run.path("two/notes.txt").exists());
}

#[test]
fn one_bad_image_does_not_spoil_the_folder() {
    let run = Run::new();
    scenes_folder(&run.path("photos"));
    std::fs::write(run.path("photos/bad.png"), "this is no image").unwrap();
    scene(&run.path("water.png"), 9, "turbid");
    let ended = run.fails(1, &["fuse", "photos", "water.png", "-o", "fused"]);
    assert!(
        ended.stderr.contains("bad.png") && ended.stderr.contains("none of PNG, JPEG"),
        "{}",
        ended.stderr
    );
    assert!(ended.stderr.contains("1 of 4 images failed"), "{}", ended.stderr);
    assert_eq!(std::fs::read_dir(run.path("fused")).unwrap().count(), 3 + 1, "three images and the record");
}

#[test]
fn what_exists_is_not_replaced_unasked() {
    let run = Run::new();
    scenes_folder(&run.path("photos"));
    scene(&run.path("water.png"), 9, "turbid");
    std::fs::create_dir(run.path("fused")).unwrap();
    std::fs::write(run.path("fused/b.png"), "somebody's").unwrap();
    let fuse = ["fuse", "photos", "water.png", "-o", "fused"];
    let refused = run.fails(2, &fuse);
    assert!(refused.stderr.contains("b.png") && refused.stderr.contains("--overwrite"), "{}", refused.stderr);
    assert_eq!(run.bytes("fused/b.png"), b"somebody's");
    assert!(!run.path("fused/a.png").exists(), "a refused run must do nothing");
    run.ok(&[&fuse[..], &["--overwrite"]].concat());
    assert!(run.path("fused/a.png").exists() && run.bytes("fused/b.png") != b"somebody's");

    std::fs::create_dir(run.path("mine")).unwrap();
    std::fs::write(run.path("mine/sheet.jpg"), "mine").unwrap();
    assert!(run.fails(2, &["demo", "-o", "mine"]).stderr.contains("mine is not empty"));
    assert_eq!(run.bytes("mine/sheet.jpg"), b"mine");
}

#[test]
fn wrong_usage_ends_with_two_and_says_what_to_do() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    scenes_folder(&run.path("photos"));
    std::fs::create_dir(run.path("empty")).unwrap();
    let cases: [(&[&str], &str); 15] = [
        (&["fuse", "content.png", "content.png", "-o", "out.gif"], ".png, .jpg, .jpeg, .tif"),
        (&["fuse", "missing.png", "content.png", "-o", "out.png"], "cannot read missing.png"),
        (&["fuse", "content.png", "missing.png", "-o", "out.png"], "cannot read missing.png"),
        (&["inspect", "missing.png"], "cannot read missing.png"),
        (
            &["fuse", "content.png", "content.png", "-o", "o.png", "--theta", "91"],
            "from 0° (most fusion) to 90°",
        ),
        (&["fuse", "content.png", "content.png", "-o", "o.png", "--alpha", "-1"], "0 or more"),
        (&["fuse", "photos", "content.png", "-o", "photos"], "both content and output"),
        (&["fuse", "photos", "content.png", "-o", "content.png"], "output must be a folder"),
        (&["fuse", "photos", "content.png", "-o", "new.jpg"], "output must be a folder"),
        (&["fuse", "content.png", "photos", "-o", "o.png"], "Name an image in it"),
        (&["fuse", "photos/a.png", "content.png", "-o", "content.png", "--overwrite"], "is an input"),
        (&["fuse", "photos/a.png", "content.png", "-o", "content.png/o.png"], "there is a file of that name"),
        (&["--threads", "1000000", "inspect", "content.png"], "1..=512"),
        (&["fuse", "empty", "content.png", "-o", "out"], "holds no .png, .jpg, .jpeg"),
        (&["depth", "content.png", "-o", "depth.jpg"], "must end in .png"),
    ];
    for (arguments, expected) in cases {
        let refused = run.fails(2, arguments);
        assert!(refused.stderr.contains(expected), "{arguments:?}: {}", refused.stderr);
    }
}

#[test]
fn an_image_that_cannot_be_read_ends_with_one() {
    let run = Run::new();
    std::fs::write(run.path("bad.png"), "no image").unwrap();
    for arguments in [&["inspect", "bad.png"][..], &["depth", "bad.png", "-o", "z.png"]] {
        let failed = run.fails(1, arguments);
        assert!(failed.stderr.contains("bad.png: its content is none of PNG, JPEG"), "{}", failed.stderr);
    }
    assert!(!run.path("z.png").exists());
}

#[test]
fn inspect_speaks_json_of_a_known_schema() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    let report: serde_json::Value =
        serde_json::from_str(&run.ok(&["inspect", "content.png", "--json"]).stdout).unwrap();
    assert_eq!(report["schema"], 1);
    assert_eq!(report["image"], serde_json::json!({"width": 96, "height": 64}));
    assert_eq!((&report["depth"]["source"], &report["depth"]["kind"]), (&"eq3".into(), &"relative".into()));
    assert_eq!(report["veiling_light_source"], "open_water");
    let water = &report["waterbody"];
    let veil: Vec<f64> = (0..3).map(|c| water["veiling_light"][c].as_f64().unwrap()).collect();
    assert!(veil[0] < veil[1] && veil[1] < veil[2], "blue water has the veil {veil:?}");
    assert_eq!(water["attenuation"].as_array().unwrap().len(), 3);
    assert_eq!(water["attenuation"][0].as_array().unwrap().len(), 4);
    let share = &report["water_share"];
    assert!(share["seen"].as_f64().unwrap() > 0.5, "open water is in view: {share}");
    assert!((0.1..0.9).contains(&share["mean"].as_f64().unwrap()), "it is a part of the image: {share}");
    let text = run.ok(&["inspect", "content.png"]).stdout;
    assert!(text.contains("open water") && text.contains("% of the image; "), "{text}");
    let factors = report["depth_factor"].as_array().unwrap();
    assert_eq!((factors.len(), &factors[0]), (256, &serde_json::json!([1.0, 1.0, 1.0])));
    run.ok(&["depth", "content.png", "-o", "z.png"]);
    let given = run.ok(&["inspect", "content.png", "--json", "--depth", "z.png", "--depth-kind", "relative"]);
    let given: serde_json::Value = serde_json::from_str(&given.stdout).unwrap();
    assert!(given.get("depth_factor").is_none(), "of given depth β_B tells F");
}

#[test]
fn every_command_takes_the_depth_model_it_is_told() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "turbid");
    scene(&run.path("water.png"), 2, "green");
    let mut outputs = Vec::new();
    for model in ["eq3", "eq3-median", "ratio", "ulap", "udepth", "layout", "network"] {
        let depth = format!("z_{model}.png");
        run.ok(&["depth", "content.png", "-o", &depth, "--depth-model", model]);
        let fused = format!("f_{model}.png");
        run.ok(&["fuse", "content.png", "water.png", "-o", &fused, "--depth-model", model]);
        let report = run.ok(&["inspect", "content.png", "--json", "--depth-model", model]).stdout;
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["depth"]["source"], model);
        outputs.push((run.bytes(&depth), run.bytes(&fused)));
    }
    for (i, one) in outputs.iter().enumerate() {
        assert!(outputs[..i].iter().all(|other| other.0 != one.0 && other.1 != one.1));
    }
    run.fails(2, &["inspect", "content.png", "--depth-model", "guess"]);
}

#[test]
fn the_map_of_open_water_is_chosen_recorded_and_no_part_of_the_published_settings() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "turbid");
    scene(&run.path("water.png"), 2, "green");
    let fuse = |map: &str| {
        let output = format!("f_{map}.png");
        let report = format!("f_{map}.json");
        run.ok(&["fuse", "content.png", "water.png", "-o", &output, "--water-map", map, "--report", &report]);
        let report: serde_json::Value = serde_json::from_slice(&run.bytes(&report)).unwrap();
        assert_eq!(report["settings"]["water_map"], map);
        run.bytes(&output)
    };
    let (both, rules, network) = (fuse("both"), fuse("rules"), fuse("network"));
    assert_ne!(both, rules);
    assert_ne!(both, network);
    assert_ne!(fuse("published"), rules);
    run.ok(&["fuse", "content.png", "water.png", "-o", "default.png"]);
    assert_eq!(run.bytes("default.png"), both);
    run.fails(
        2,
        &["fuse", "content.png", "water.png", "-o", "p.png", "--as-published", "--water-map", "network"],
    );
    run.fails(2, &["fuse", "content.png", "water.png", "-o", "p.png", "--water-map", "guess"]);
}

#[test]
fn exchange_changes_more_than_the_veil_and_leaves_an_image_in_its_own_water() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    scene(&run.path("water.png"), 2, "green");
    let fuse = |water: &str, output: &str, model: &str| {
        run.ok(&["fuse", "content.png", water, "-o", output, "--model", model]);
        pixels(&run.path(output))
    };
    assert_eq!(fuse("content.png", "same.png", "exchange"), pixels(&run.path("content.png")));
    let (whole, veil) =
        (fuse("water.png", "whole.png", "exchange"), fuse("water.png", "veil.png", "physical"));
    let apart = whole.iter().zip(&veil).map(|(a, b)| u32::from(a.abs_diff(*b))).max();
    assert!(apart > Some(10), "exchange and physical differ by {apart:?}");
}

#[test]
fn smoothing_wears_fine_texture_down_and_nothing_is_smoothed_unasked() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    let fuse = |output: &str, more: &[&str]| {
        run.ok(&[&["fuse", "content.png", "content.png", "-o", output], more].concat());
        pixels(&run.path(output))
    };
    let plain = fuse("plain.png", &[]);
    assert_eq!(plain, fuse("none.png", &["--smooth", "none"]));
    let roughness =
        |pixels: &[u8]| -> u32 { pixels.windows(4).map(|p| u32::from(p[0].abs_diff(p[3]))).sum() };
    let smooth = fuse("smooth.png", &["--smooth", "bilateral"]);
    assert!(roughness(&smooth) < roughness(&plain), "{} {}", roughness(&smooth), roughness(&plain));
}

#[test]
fn as_published_is_a_name_for_its_settings_and_allows_none_beside_it() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    scene(&run.path("water.png"), 2, "green");
    let fuse = ["fuse", "content.png", "water.png", "-o", "named.png", "--as-published"];
    run.ok(&fuse);
    let spelt = "fuse content.png water.png -o spelt.png --model aquafuse --theta 45 --alpha 1.5 --smooth bilateral \
                 --depth-model eq3-median --water-map published --border none";
    run.ok(&spelt.split_whitespace().collect::<Vec<_>>());
    assert_eq!(run.bytes("named.png"), run.bytes("spelt.png"));
    for setting in ["--model aquafuse", "--theta 45", "--alpha 1", "--smooth none", "--depth-model eq3"] {
        let words: Vec<&str> = setting.split(' ').collect();
        let refused = run.fails(2, &[&fuse[..], &words, &["--overwrite"]].concat());
        assert!(refused.stderr.contains("--as-published"), "{setting}: {}", refused.stderr);
    }
}

#[test]
fn depth_is_a_sixteen_bit_image_of_the_same_size() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    run.ok(&["depth", "content.png", "-o", "z.png"]);
    let depth = image::open(run.path("z.png")).unwrap();
    assert!(matches!(depth, image::DynamicImage::ImageLuma16(_)));
    let depth = depth.into_luma16();
    assert_eq!(depth.dimensions(), (96, 64));
    assert!(depth.get_pixel(48, 2).0 > depth.get_pixel(48, 62).0, "open water is nearer than the sand");
}

#[test]
fn demo_makes_what_fuse_makes_of_the_same_images() {
    let run = Run::new();
    let said = run.ok(&["demo", "-o", "demo"]).stdout;
    assert!(said.contains("sheet.jpg") && said.contains("estimated"), "{said}");
    let files = 3 + 2 + 2 * 3 * 2 + 1;
    assert_eq!(std::fs::read_dir(run.path("demo")).unwrap().count(), files + 2, "and two folders");
    for model in ["physical", "aquafuse"] {
        run.ok(&[
            "fuse",
            "demo/content_blue.png",
            "demo/reference_green.png",
            "-o",
            "f.png",
            "--overwrite",
            "--model",
            model,
        ]);
        assert_eq!(run.bytes("f.png"), run.bytes(&format!("demo/content_blue__green__{model}.png")));
    }
}

#[test]
fn what_demo_labels_is_a_dataset_and_its_depth_is_read() {
    let run = Run::new();
    run.ok(&["demo", "-o", "demo"]);
    for name in ["content_blue.png", "content_turbid.png"] {
        assert_eq!(run.bytes(&format!("demo/fish/images/{name}")), run.bytes(&format!("demo/{name}")));
        let mask = image::open(run.path(&format!("demo/fish/masks/{name}"))).unwrap().into_luma8();
        let fish = mask.pixels().filter(|pixel| pixel.0 == [255]).count();
        let rest = mask.pixels().filter(|pixel| pixel.0 == [0]).count();
        assert!(fish > 100 && rest > 10 * fish && fish + rest == 480 * 320, "{name}: {fish}, {rest}");
    }
    run.ok(&["augment", "demo/fish", "demo/reference_green.png", "-o", "more"]);
    assert!(run.path("more/masks").is_dir() && run.path("more/preview.jpg").exists());
    let depth = ["--depth", "demo/depth/content_blue.png", "--depth-kind", "millimetres"];
    run.ok(
        &[&["fuse", "demo/content_blue.png", "demo/reference_green.png", "-o", "f.png"][..], &depth].concat()
    );
}

#[test]
fn quiet_says_nothing() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    let quiet = run.ok(&["--quiet", "fuse", "content.png", "content.png", "-o", "a.png"]);
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
}

#[test]
fn a_closed_pipe_is_no_error() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    std::fs::write(run.path("bad.png"), "no image").unwrap();
    let nobody = || {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        writer
    };
    let told = run.command(&["inspect", "content.png"]).stdout(nobody()).output().unwrap();
    assert_eq!((told.status.code(), told.stderr.as_slice()), (Some(0), &b""[..]));
    let failed = run.command(&["inspect", "bad.png"]).stderr(nobody()).output().unwrap();
    assert_eq!(failed.status.code(), Some(1));
}

#[test]
fn every_real_scene_can_be_fused() {
    let Some(data) = std::env::var_os("AQUAFUSE_TEST_DATA") else {
        eprintln!("skipped: AQUAFUSE_TEST_DATA does not name the folder of real images");
        return;
    };
    let scenes = Path::new(&data).join("scenes");
    let count = std::fs::read_dir(&scenes).unwrap().count();
    let run = Run::new();
    let (scenes, water) = (scenes.to_str().unwrap(), scenes.join("greenish_07.jpg"));
    for model in ["aquafuse", "physical", "exchange"] {
        run.ok(&["fuse", scenes, water.to_str().unwrap(), "-o", model, "--model", model]);
        assert_eq!(
            std::fs::read_dir(run.path(model)).unwrap().count(),
            count + 1,
            "all of them, and the record"
        );
    }
}

fn pixels(path: &Path) -> Vec<u8> {
    image::open(path).unwrap().into_rgb8().into_raw()
}

#[test]
fn a_preset_named_without_its_prefix_is_guessed() {
    let run = Run::new();
    scene(&run.path("a.png"), 1, "blue");
    let said = run.fails(2, &["fuse", "a.png", "jerlov-3C", "-o", "b.png"]).stderr;
    assert!(said.contains("did you mean preset:jerlov-3C?"), "{said}");
}

#[test]
fn what_is_swept_is_not_given_too() {
    let run = Run::new();
    scene(&run.path("a.png"), 1, "blue");
    let sweep =
        ["fuse", "a.png", "preset:jerlov-3C", "-o", "b.png", "--sweep", "theta=0,30", "--theta", "40"];
    let said = run.fails(2, &sweep).stderr;
    assert!(said.contains("leave one of them out"), "{said}");
}

#[test]
fn a_scene_that_thick_water_hides_is_named_in_a_warning() {
    let run = Run::new();
    scene(&run.path("a.png"), 1, "blue");
    let thick =
        ["fuse", "a.png", "preset:jerlov-9C", "-o", "b.png", "--model", "exchange", "--metres-at-one", "100"];
    let said = run.ok(&thick).stdout;
    assert!(
        said.contains("WARNING: a.png (")
            && said.contains("WATER hides the scene; say how far one sees in it with --visibility"),
        "{said}"
    );
}

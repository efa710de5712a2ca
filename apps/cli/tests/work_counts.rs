//! Nothing is done twice: what each command lists, decodes, estimates and parses, as `--verbose` counts it.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use run::{Run, reef, scene, scenes_folder};

/// What a command says that it has done, on standard error.
fn work(run: &Run, arguments: &[&str]) -> String {
    let said = run.ok(&[arguments, &["--verbose"]].concat()).stderr;
    let line = said.lines().find_map(|line| line.strip_prefix("work: "));
    line.unwrap_or_else(|| panic!("no line of work in {said:?}")).to_owned()
}

#[test]
fn a_folder_is_listed_once_and_each_image_is_decoded_once() {
    let run = Run::new();
    scenes_folder(&run.path("photos"));
    scene(&run.path("green.png"), 3, "green");
    assert_eq!(
        work(&run, &["fuse", "photos", "green.png", "-o", "fused"]),
        "1 folder listed, 4 images decoded, 4 waters estimated"
    );
    // Clear water comes from a table: there is no reference to decode.
    assert_eq!(
        work(&run, &["enhance", "photos", "preset:jerlov-I", "-o", "clearer"]),
        "1 folder listed, 3 images decoded, 3 waters estimated"
    );
    // Levels need no water.
    assert_eq!(work(&run, &["enhance", "photos", "-o", "levelled"]), "1 folder listed, 3 images decoded");
}

#[test]
fn each_image_of_a_scene_is_decoded_and_its_water_estimated_once() {
    let run = Run::new();
    reef(&run);
    scene(&run.path("green.png"), 3, "green");
    let fuse = |output| ["scene", "fuse", "reef", "green.png", "-o", output, "--model", "physical"];
    let once = "1 folder listed, 10 images decoded, 10 waters estimated, 1 set of cameras parsed";
    assert_eq!(work(&run, &fuse("fused")), once);
    // A run that has nothing left to do needs the shared water for its record, and decodes nothing for that twice.
    assert_eq!(work(&run, &fuse("fused")), once);
}

#[test]
fn training_parses_the_cameras_once_and_decodes_each_image_once() {
    let run = Run::new();
    reef(&run);
    let train = |output| ["scene", "train", "reef", "-o", output, "--iterations", "2"];
    assert_eq!(work(&run, &train("dry.ply")), "1 folder listed, 9 images decoded, 1 set of cameras parsed");
    assert_eq!(
        work(&run, &[&train("wet.ply")[..], &["--water", "learn"]].concat()),
        "1 folder listed, 9 images decoded, 9 waters estimated, 1 set of cameras parsed"
    );
}

#[test]
fn inspecting_an_image_decodes_it_and_estimates_its_water_once() {
    let run = Run::new();
    scene(&run.path("reef.png"), 1, "blue");
    let once = "1 image decoded, 1 water estimated";
    assert_eq!(work(&run, &["inspect", "reef.png"]), once);
    // Estimate and evidence come of one pass.
    assert_eq!(work(&run, &["inspect", "reef.png", "--plots", "plots"]), once);
}

#[test]
fn a_command_that_reads_nothing_has_done_nothing() {
    let run = Run::new();
    assert_eq!(work(&run, &["water", "list"]), "nothing");
    assert!(!run.ok(&["water", "list"]).stderr.contains("work:"));
}

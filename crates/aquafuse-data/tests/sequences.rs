//! Folders whose images are frames of a sequence.

#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "a test that cannot set up its case should fail loudly"
)]

use std::path::Path;

use aquafuse::formation::RestoreOptions;
use aquafuse::fusion::{Model, Options};
use aquafuse::image::Image;
use aquafuse::levels::{LevelsOptions, Setting};
use aquafuse::truth::{Pose, Scene, Size, View, waters};
use aquafuse_data::batch::{Plan, PlanError, Recipe, Request};
use aquafuse_data::image_file::{ImageFile, ReadOptions, WriteOptions};
use aquafuse_data::pipeline::{DepthSource, DepthSupply, Operation, PixelEncoding, analyse_in};
use aquafuse_data::run::RunOptions;

const FRAMES: u8 = 6;

fn frame(number: u8) -> Image<u8> {
    let t = f32::from(number) / f32::from(FRAMES);
    let pose = Pose { moved: [0.4 * t, 0.0, 0.4 * t], yaw: 0.1 * t, ..Pose::default() };
    let seen = Scene::from(View::default(), 1, &pose, Size { width: 64, height: 48 });
    let seen = seen.seen_through(&waters()[0].water);
    let lit = seen.as_raw().iter().map(|value| (1.0 - 0.1 * t) * value).collect();
    Image::<f32>::from_raw(64, 48, lit).unwrap().convert()
}

fn frames(folder: &Path) {
    std::fs::create_dir_all(folder).unwrap();
    for number in 0..FRAMES {
        let path = folder.join(format!("{number}.png"));
        ImageFile::new(frame(number)).write(&path, &WriteOptions::default()).unwrap();
    }
}

fn operations(encoding: PixelEncoding) -> Vec<Operation> {
    let reference =
        Scene::new(3, Size { width: 64, height: 48 }).seen_through(&waters()[1].water).convert::<u8>();
    let found = analyse_in(encoding, &ImageFile::new(reference), &DepthSource::default()).unwrap();
    let options = RestoreOptions::default();
    let plain = LevelsOptions::default().with_white(Setting::None).with_exposure(Setting::None);
    let fuse = |model| Operation::Fuse { reference: found.estimate, options: Options::for_model(model) };
    vec![
        fuse(Model::Physical),
        fuse(Model::Exchange),
        Operation::Restore { options, levels: LevelsOptions::default(), encoding },
        Operation::Restore { options, levels: plain, encoding },
        Operation::Enhance { levels: LevelsOptions::default() },
    ]
}

fn made(content: &Path, output: &Path, recipe: &Recipe) -> Vec<Vec<u8>> {
    let depth = DepthSupply::Estimated(Default::default());
    let plan = Plan::new(&Request::new(&[content.to_owned()], output, &depth)).unwrap();
    let summary = plan.run(recipe, &RunOptions::default(), &|_| {}).unwrap();
    assert_eq!((summary.failed, summary.left), (0, 0));
    (0..FRAMES).map(|number| std::fs::read(output.join(format!("{number}.png"))).unwrap()).collect()
}

#[test]
fn a_sequence_begins_as_the_image_by_itself_and_one_that_was_stopped_ends_as_one_that_was_not() {
    let folder = tempfile::tempdir().unwrap();
    let content = folder.path().join("frames");
    frames(&content);
    let encodings = [PixelEncoding::Encoded, PixelEncoding::Linear];
    for (i, operation) in encodings.into_iter().flat_map(operations).enumerate() {
        let apart = Recipe::new(operation);
        let recipe = Recipe { steady_over: Some(8), ..apart.clone() };
        let place = |name: &str| folder.path().join(format!("{i}-{name}"));
        let (apart, whole) =
            (made(&content, &place("apart"), &apart), made(&content, &place("whole"), &recipe));
        assert_eq!(apart[0], whole[0], "operation {i}");
        assert_ne!(apart[1..], whole[1..], "operation {i}");
        // As if it had been stopped after the third frame.
        let stopped = place("stopped");
        made(&content, &stopped, &recipe);
        for number in 3..FRAMES {
            std::fs::remove_file(stopped.join(format!("{number}.png"))).unwrap();
        }
        assert_eq!(made(&content, &stopped, &recipe), whole, "operation {i}");
    }
}

#[test]
fn maps_of_a_sequence_are_refused_and_other_settings_are_other_settings() {
    let folder = tempfile::tempdir().unwrap();
    let content = folder.path().join("frames");
    frames(&content);
    let recipe = Recipe { steady_over: Some(4), ..Recipe::new(operations(PixelEncoding::Encoded).remove(0)) };
    let depth = DepthSupply::Estimated(Default::default());
    let (output, maps) = (folder.path().join("fused"), folder.path().join("maps"));
    let contents = [content.clone()];
    let request = Request { maps: Some(&maps), ..Request::new(&contents, &output, &depth) };
    let refused = Plan::new(&request).unwrap().run(&recipe, &RunOptions::default(), &|_| {});
    assert!(matches!(refused, Err(PlanError::MapsOfSequence { .. })), "{refused:?}");
    assert!(!output.join("0.png").exists() && !maps.exists());
    let reading = ReadOptions::default();
    let apart = Recipe { steady_over: None, ..recipe.clone() };
    assert_ne!(recipe.fingerprint(&reading), apart.fingerprint(&reading));
}

use super::*;
use crate::truth;
use aquafuse::fusion::{Model, Options};
use aquafuse::truth::{Size, waters};
use aquafuse::waterbody::Estimate;
use aquafuse_data::pipeline::Operation;
use aquafuse_data::run::Stop;
use std::num::NonZeroUsize;
use tempfile::TempDir;

const IMAGES: usize = 4;

fn scene() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let views = truth::views(1, Size { width: 64, height: 48 }, IMAGES, 1);
    let images: Vec<_> = views.iter().map(|view| view.seen_through(&waters()[0].water)).collect();
    let points = truth::points(&views, &images, 16);
    truth::write(&folder.path().join("reef"), &views, &images, points).unwrap();
    folder
}

fn recipe() -> Recipe {
    let reference = Estimate::given(waters()[1].water);
    Recipe::new(Operation::Fuse { reference: reference.into(), options: Options::for_model(Model::Physical) })
}

fn plan(folder: &TempDir, output: &str) -> Plan {
    let (scene, output) = (folder.path().join("reef"), folder.path().join(output));
    let depth_model = &DepthEstimator::default();
    Plan::new(&Request {
        scene: &scene,
        output: &output,
        depth_model,
        inputs: &[],
        reading: &ReadOptions::default(),
        skip_missing: false,
        overwrite: false,
    })
    .unwrap()
}

fn bytes(folder: &TempDir, output: &str) -> Vec<Vec<u8>> {
    let path = |i: usize| folder.path().join(output).join(format!("images/view_{i:03}.png"));
    (0..IMAGES).map(|i| std::fs::read(path(i)).unwrap()).collect()
}

#[test]
fn neither_threads_nor_memory_change_a_byte() {
    let folder = scene();
    plan(&folder, "a").run(&recipe(), &RunOptions::default(), &|_| {}).unwrap();
    // What a scene takes that has all memory it asks for; then just enough for one image at a time, and for all to stay.
    let needs = plan(&folder, "b").needs(&RunOptions::default()).unwrap();
    let largest = needs.iter().map(|need| need.work).max().unwrap();
    let all: u64 = needs.iter().map(|need| need.kept).sum();
    for (output, threads, beyond, stay) in [("b", 1, 0, 0), ("c", 3, all, IMAGES)] {
        let mut options = RunOptions { threads: NonZeroUsize::new(threads), ..RunOptions::default() };
        options.reading.max_memory = largest + beyond;
        let plan = plan(&folder, output);
        let kept = plan.needs(&options).unwrap().iter().filter(|need| need.is_kept).count();
        assert_eq!(kept, stay);
        let fused = plan.run(&recipe(), &options, &|_| {}).unwrap();
        assert_eq!((fused.summary.done, fused.summary.skipped), (IMAGES, 0));
        assert_eq!(bytes(&folder, output), bytes(&folder, "a"));
    }
    let model = |output: &str| std::fs::read(folder.path().join(output).join("sparse/0/images.txt")).unwrap();
    assert_eq!(model("b"), model("reef"));
}

#[test]
fn open_water_takes_the_colour_of_the_other_water() {
    let folder = scene();
    let fused = plan(&folder, "green").run(&recipe(), &RunOptions::default(), &|_| {}).unwrap();
    assert!(fused.change.unwrap() > 5.0, "{:?}", fused.change);
    let image = ImageFile::read(&folder.path().join("green/images/view_000.png")).unwrap();
    let top = image.bytes().pixels()[32].map(|value| f32::from(value) / 255.0);
    let off = top.into_iter().zip(waters()[1].water.veiling_light.rgb()).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f32::max) < 0.06, "{top:?}");
}

#[test]
fn a_run_that_is_stopped_goes_on_where_it_stopped() {
    let folder = scene();
    let whole = plan(&folder, "whole").run(&recipe(), &RunOptions::default(), &|_| {}).unwrap();
    assert!(whole.shared.unit.is_some());
    let stop = Stop::default();
    let options = RunOptions { threads: NonZeroUsize::new(1), stop: stop.clone(), ..RunOptions::default() };
    let halfway = |event: Event<'_, Path>| {
        if let Event::Done { item, .. } = event
            && item.ends_with("stopped/images/view_001.png")
        {
            stop.stop();
        }
    };
    let ended = plan(&folder, "stopped").run(&recipe(), &options, &halfway);
    assert!(matches!(ended, Err(FuseError::Stopped(_))), "{ended:?}");
    let there = |i: usize| folder.path().join(format!("stopped/images/view_{i:03}.png")).exists();
    assert!(there(1) && !there(IMAGES - 1));
    let fused = plan(&folder, "stopped").run(&recipe(), &RunOptions::default(), &|_| {}).unwrap();
    assert!(fused.summary.skipped >= 2 && fused.summary.done >= 1, "{:?}", fused.summary);
    assert_eq!(bytes(&folder, "stopped"), bytes(&folder, "whole"));
}

#[test]
fn a_folder_with_other_files_is_refused_before_anything_is_written() {
    let folder = scene();
    let output = folder.path().join("mine");
    std::fs::create_dir_all(output.join("images")).unwrap();
    assert!(!plan(&folder, "mine").items().is_empty());
    std::fs::write(output.join("images/notes.txt"), "mine").unwrap();
    let request = Request {
        scene: &folder.path().join("reef"),
        output: &output,
        depth_model: &DepthEstimator::default(),
        inputs: &[],
        reading: &ReadOptions::default(),
        skip_missing: false,
        overwrite: false,
    };
    assert!(matches!(Plan::new(&request), Err(FuseError::Filled { .. })));
    assert!(Plan::new(&Request { overwrite: true, ..request }).is_ok());
}

#[test]
fn no_input_is_written_whatever_its_folder_is_called() {
    let folder = scene();
    let (scene, water) = (folder.path().join("reef"), folder.path().join("new/images/water.png"));
    std::fs::create_dir_all(water.parent().unwrap()).unwrap();
    let ask = |output: &Path, inputs: &[&Path]| {
        let depth_model = &DepthEstimator::default();
        Plan::new(&Request {
            scene: &scene,
            output,
            depth_model,
            inputs,
            reading: &ReadOptions::default(),
            skip_missing: false,
            overwrite: true,
        })
    };
    let is_refused = |asked: Result<Plan, FuseError>| matches!(asked, Err(FuseError::Input { .. }));
    assert!(is_refused(ask(&scene, &[])) && is_refused(ask(&folder.path().join("reef/../reef"), &[])));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&scene, folder.path().join("link")).unwrap();
        assert!(is_refused(ask(&folder.path().join("link"), &[])));
        std::fs::create_dir(folder.path().join("half")).unwrap();
        std::os::unix::fs::symlink(scene.join("images"), folder.path().join("half/images")).unwrap();
        assert!(is_refused(ask(&folder.path().join("half"), &[])));
    }
    let output = folder.path().join("new");
    let taken = ask(&output, &[]).unwrap().items()[0].output.clone();
    std::fs::write(&taken, "water").unwrap();
    assert!(is_refused(ask(&output, &[&taken])));
}

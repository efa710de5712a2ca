use super::*;
use crate::truth;
use aquafuse::truth::{Size, waters};
use aquafuse_data::run::Stop;
use tempfile::TempDir;

fn scene() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let views = truth::views(1, Size { width: 40, height: 30 }, 5, 1);
    let images: Vec<_> = views.iter().map(|view| view.seen_through(&waters()[0].water)).collect();
    let points = truth::points(&views, &images, 40);
    truth::write(&folder.path().join("reef"), &views, &images, points).unwrap();
    folder
}

fn request(folder: &TempDir, output: &str) -> Request {
    Request {
        scene: folder.path().join("reef"),
        images: None,
        skip_missing: false,
        output: folder.path().join(output),
        options: Options { iterations: 12, max_splats: 500, ..Options::default() },
        sh_degree: 0,
        learns_water: true,
        longest: 400,
        hold_out: Some(4),
        overwrite: false,
    }
}

fn load(request: Request) -> Training {
    Plan::new(request, &ReadOptions::default()).unwrap().load(&RunOptions::default()).unwrap()
}

#[test]
fn a_run_that_is_stopped_ends_in_the_same_splats() {
    let folder = scene();
    let whole = load(request(&folder, "whole.ply"));
    assert_eq!((whole.views().training.len(), whole.views().held_out.len()), (3, 2));
    let expected = whole.run(&RunOptions::default(), &|_| {}).unwrap();
    let scores = whole.held_out_scores(&expected).unwrap();
    assert!(scores.views == 2 && scores.psnr > 10.0 && scores.ssim > 0.0, "{scores:?}");

    let again = load(request(&folder, "again.ply"));
    let stop = Stop::default();
    let options = RunOptions { stop: stop.clone(), ..RunOptions::default() };
    let ended = again.run(&options, &|event| {
        if matches!(event, Event::Done { item: 5, .. }) {
            stop.stop();
        }
    });
    assert!(matches!(ended, Err(TrainingError::Stopped(_))), "{ended:?}");
    let skipped = std::sync::atomic::AtomicUsize::new(0);
    let found = again.run(&RunOptions::default(), &|event| {
        if matches!(event, Event::Skipped { .. }) {
            skipped.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        }
    });
    assert_eq!(skipped.into_inner(), 5);
    let found = found.unwrap();
    assert_eq!((&found.splats, &found.medium), (&expected.splats, &expected.medium));
    again.write(&found).unwrap();
    assert!(folder.path().join("again.water.json").is_file());
    assert!(!folder.path().join("again.ply.checkpoint").exists());
}

#[test]
fn more_memory_than_is_allowed_is_refused_before_an_image_is_read() {
    let folder = scene();
    std::fs::remove_file(folder.path().join("reef/images/view_002.png")).unwrap();
    let plan = Plan::new(request(&folder, "a.ply"), &ReadOptions::default()).unwrap();
    let mut options = RunOptions::default();
    options.reading.max_memory = plan.memory() - 1;
    assert!(matches!(plan.clone().load(&options), Err(TrainingError::Memory { .. })));
    options.reading.max_memory = plan.memory().max(64 << 20);
    assert!(matches!(
        plan.load(&options),
        Err(TrainingError::Images(CaptureError::Missing { missing: 1, .. }))
    ));
}

#[test]
fn no_image_to_train_on_is_an_error() {
    let folder = scene();
    let all = Request { hold_out: Some(1), ..request(&folder, "a.ply") };
    let ended = Plan::new(all, &ReadOptions::default()).unwrap().load(&RunOptions::default());
    assert!(matches!(ended, Err(TrainingError::NothingToTrainOn)));
}

#[test]
fn a_run_killed_while_it_writes_is_finished_by_the_next() {
    let folder = scene();
    let path = |name: &str| folder.path().join(name);
    let run = |training: &Training| training.run(&RunOptions::default(), &|_| {}).unwrap();
    let first = load(request(&folder, "reef.ply"));
    let model = run(&first);
    assert!(path("reef.ply.checkpoint").is_file());

    // Killed after the water, then after the splats.
    for written in [&["reef.water.json"][..], &["reef.water.json", "reef.ply"]] {
        model.write(&path("other.ply"), &folder.path().join("reef"), true).unwrap();
        for name in written {
            std::fs::copy(path(&name.replace("reef.", "other.")), path(name)).unwrap();
        }
        let next = load(request(&folder, "reef.ply"));
        let checkpoint = std::fs::read(path("reef.ply.checkpoint")).unwrap();
        next.write(&run(&next)).unwrap();
        assert_eq!(std::fs::read(path("reef.ply")).unwrap(), std::fs::read(path("other.ply")).unwrap());
        assert!(!path("reef.ply.checkpoint").exists());
        std::fs::write(path("reef.ply.checkpoint"), checkpoint).unwrap();
        std::fs::remove_file(path("reef.ply")).unwrap();
        std::fs::remove_file(path("reef.water.json")).unwrap();
    }

    // Splats that are not of this run stay.
    std::fs::write(path("reef.ply"), "mine").unwrap();
    let next = load(request(&folder, "reef.ply"));
    assert!(matches!(next.write(&model), Err(TrainingError::Model(_))));
    assert_eq!(std::fs::read(path("reef.ply")).unwrap(), b"mine");
    // And so do those beside a run that has not ended.
    let longer = Request {
        options: Options { iterations: 13, ..first.request().options.clone() },
        ..request(&folder, "reef.ply")
    };
    assert!(matches!(
        Plan::new(longer, &ReadOptions::default()),
        Err(TrainingError::File(FileError::Exists { .. }))
    ));
}

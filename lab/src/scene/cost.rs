//! What a step of training costs, and its parts, on one thread.

use aquafuse::truth::Size;
use aquafuse_scene::medium::Medium;
use aquafuse_scene::render::render;
use aquafuse_scene::train::loss::{Target, loss};
use aquafuse_scene::train::{Options, TrainView, Trainer};
use aquafuse_scene::truth::TruthView;
use aquafuse_scene::{points, truth};
use xtask::clock;

use super::training::SIZE;

/// The table.
pub(super) fn table() -> String {
    let [middle, large] = [(256, 192), (512, 384)].map(|(width, height)| Size { width, height });
    let cases = [(SIZE, 5000), (middle, 5000), (middle, 10_000), (middle, 20_000), (large, 20_000)];
    let head = "| pixels | splats | in view | draw | loss | back | whole step, ms CPU |\n|---|---|---|---|---|---|---|\n";
    head.to_owned() + &cases.map(|(size, splats)| row(size, splats)).concat()
}

/// Steps that are timed.
const TIMED: u32 = 40;

/// What a step costs, and its parts, a few steps into training.
fn row(size: Size, splats: usize) -> String {
    let views = truth::views(1, size, 2, 1);
    let images: Vec<_> = views.iter().map(TruthView::clear).collect();
    let mut points = truth::points(&views, &images, 2);
    // As many as asked for, evenly from all.
    let share = points.len() as f64 / splats as f64;
    points = (0..splats).map(|i| points[(i as f64 * share) as usize]).collect();
    let begin = points::splats(&points, 0);
    let camera = &views[1].camera;
    let target = Target::new(size.width, size.height, images[1].pixels());
    let shot = TrainView { camera: camera.clone(), target: target.clone() };
    let mut trainer =
        Trainer::new(Options { iterations: 100_000, ..Options::default() }, vec![shot], begin, None);
    for _ in 0..TIMED {
        trainer.step();
    }
    let timed = |work: &mut dyn FnMut()| {
        let began = clock::processor_seconds().own;
        (0..TIMED).for_each(|_| work());
        1e3 * (clock::processor_seconds().own - began) / f64::from(TIMED)
    };
    let whole = timed(&mut || {
        trainer.step();
    });
    let splats = trainer.splats();
    let drawn = render(splats, 0, camera, &Medium::Air);
    let (_, gradient) = loss(&drawn.rendering, &target, 0.2);
    let draw = timed(&mut || drop(render(splats, 0, camera, &Medium::Air)));
    let compared = timed(&mut || drop(loss(&drawn.rendering, &target, 0.2)));
    let back = timed(&mut || drop(drawn.back(splats, &Medium::Air, &gradient)));
    format!(
        "| {}x{} | {} | {} | {draw:.1} | {compared:.1} | {back:.1} | {whole:.1} |\n",
        size.width,
        size.height,
        splats.len(),
        drawn.seen()
    )
}

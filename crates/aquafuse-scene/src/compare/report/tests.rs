use super::*;
use crate::medium::Medium;
use crate::points;
use crate::splats::Splats;
use crate::truth::{self, TruthView};
use aquafuse::truth::{Size, waters};

/// A truth scene as it stands, seen through a water: nothing is trained.
fn side(name: &str, seed: u64, water: usize) -> Side {
    let water = waters()[water].water;
    let views = truth::views(seed, Size { width: 48, height: 36 }, 4, 1);
    let clear: Vec<_> = views.iter().map(TruthView::clear).collect();
    let splats = points::splats(&truth::points(&views, &clear, 4), 0);
    let held_out = views.iter().enumerate().map(|(i, view)| View {
        name: format!("{i}.png").into(),
        camera: view.camera.clone(),
        image: view.seen_through(&water),
    });
    Side {
        name: name.into(),
        held_out: held_out.collect(),
        model: Model { splats: opaque(&splats), medium: Medium::Known { water, per_unit: 1.0 } },
    }
}

/// Points begin nearly transparent, and then there is no surface.
fn opaque(splats: &Splats<f32>) -> Splats<f32> {
    let mut solid = splats.clone();
    let width = solid.width();
    for row in solid.rows_mut().chunks_exact_mut(width) {
        row[crate::splats::OPACITY] = 4.0;
    }
    solid
}

fn number(report: &Report, table: usize, row: usize, column: usize) -> Option<f64> {
    match report.tables[table].rows[row].cells[column] {
        Cell::Summary(summary) => Some(summary.mean),
        Cell::Number(number) => Some(number),
        Cell::Nothing => None,
    }
}

#[test]
fn a_scene_in_another_water_has_the_surfaces_of_the_original() {
    let (original, fused) = (side("reef", 1, 0), side("green", 1, 1));
    let mut model = original.model.clone();
    let width = model.splats.width();
    for row in model.splats.rows_mut().chunks_exact_mut(width) {
        row[2] += 0.02 * row[0].sin();
    }
    let comparison = Comparison::new(original, Some(model), vec![fused], None).unwrap();
    let report = comparison.report(&|_| {}).unwrap();
    // The original is compared with nothing, and splats are the same in both waters.
    assert_eq!(report.tables[0].rows.len(), 3);
    assert_eq!(number(&report, 0, 0, 2), None);
    assert!(number(&report, 0, 1, 2).unwrap() > 0.05);
    assert!(number(&report, 0, 2, 2).unwrap() < 1e-5);
    assert!(number(&report, 1, 0, 2).unwrap() < 1e-4);
    assert!(number(&report, 0, 0, 0).unwrap() > 10.0);
    assert_eq!(report.items.rows.len(), 3 * 4);
    // Two views three times, and one from above; an image of each side.
    assert_eq!(report.gallery.len(), 2 * 3 + 1);
    assert!(report.gallery.iter().all(|strip| strip.images.len() == 3));
}

#[test]
fn shares_are_those_of_the_means() {
    let comparison = Comparison::new(side("reef", 1, 0), None, vec![side("green", 1, 1)], None).unwrap();
    let report = comparison.report(&|_| {}).unwrap();
    let share =
        |column| 100.0 * number(&report, 0, 1, column).unwrap() / number(&report, 0, 0, column).unwrap();
    assert!((number(&report, 1, 0, 0).unwrap() - share(0)).abs() < 1e-9);
    assert!((number(&report, 1, 0, 1).unwrap() - share(1)).abs() < 1e-9);
    // Without a floor there is no unit to measure surfaces by.
    assert_eq!(number(&report, 1, 0, 2), None);
}

#[test]
fn scenes_of_other_cameras_are_refused() {
    let mut other = side("other", 1, 1);
    other.held_out[2].camera.focal[0] += 1.0;
    let refused = |fused| Comparison::new(side("reef", 1, 0), None, vec![fused], None).unwrap_err();
    assert!(refused(other).to_string().contains("other has other cameras than reef"));
    let mut fewer = side("fewer", 1, 1);
    fewer.held_out.pop();
    assert!(matches!(refused(fewer), CompareError::OtherCameras { .. }));
    let empty = Side { held_out: Vec::new(), ..side("reef", 1, 0) };
    assert!(matches!(
        Comparison::new(empty, None, Vec::new(), None),
        Err(CompareError::NothingHeldOut { .. })
    ));
}

use super::*;
use std::num::NonZeroUsize;

fn run(exchanges: usize, linear: bool, threads: usize) -> Report {
    of_scenes(None, exchanges, linear, threads)
}

fn of_scenes(lit: Option<LitWaters>, exchanges: usize, linear: bool, threads: usize) -> Report {
    let run_options = RunOptions { threads: NonZeroUsize::new(threads), ..RunOptions::default() };
    let places = aquafuse::truth::Site::Harbour;
    Truth { exchanges, places, lit, linear, seed: 0, run_options }.run(&|_| {}).unwrap()
}

fn mean(report: &Report, way: &str, method: &str, key: &str) -> f64 {
    let table = &report.tables[0];
    let place = table.scores.iter().position(|score| score.key == key).unwrap();
    let row = table.rows.iter().find(|row| row.labels == [way, method]).unwrap();
    match row.cells[place] {
        Cell::Summary(summary) => summary.mean,
        Cell::Number(number) => number,
        Cell::Nothing => panic!("{way}, {method} has no {key}"),
    }
}

#[test]
fn the_truth_makes_the_whole_change_and_what_it_makes_of_the_other_truth_is_not_more() {
    for linear in [false, true] {
        let report = run(4, linear, 2);
        for (truth, key, rmse) in [("A", "share_a", "rmse_a"), ("B", "share_b", "rmse_b")] {
            assert_eq!(mean(&report, "the truth itself", truth, key), 1.0);
            assert_eq!(mean(&report, "the truth itself", truth, rmse), 0.0);
        }
        assert!(mean(&report, "the truth itself", "A", "share_b") < 1.0);
    }
}

#[test]
fn with_everything_given_the_models_are_near_their_truths() {
    let report = run(6, false, 2);
    let ceiling = "everything given: the ceiling";
    assert!(mean(&report, ceiling, "`physical`", "share_a") > 0.9);
    // Truth B needs the fading as well, which only one model exchanges.
    assert!(
        mean(&report, ceiling, "`exchange`", "share_b") > mean(&report, ceiling, "`physical`", "share_b")
    );
    // The paper's model is subtle: it keeps most structure and makes least of the change.
    let subtle = mean(&report, ceiling, "`aquafuse`", "share_a");
    assert!(subtle < mean(&report, ceiling, "`physical`", "share_a"));
}

#[test]
fn with_true_metres_exchanging_the_whole_water_comes_nearer_to_it_than_exchanging_its_veil() {
    // The water itself is estimated. Before β_D was estimated beside β_B, this did not hold.
    let report = run(12, false, 2);
    let share = |model: &str| mean(&report, "z given, water ours", model, "share_b");
    let (exchange, physical) = (share("`exchange`"), share("`physical`"));
    assert!(exchange > physical + 0.1, "{exchange} {physical}");
}

#[test]
fn of_scenes_lit_by_their_water_the_light_is_exchanged_too() {
    let report = of_scenes(Some(LitWaters::Jerlov), 12, false, 2);
    assert_eq!(mean(&report, "the truth itself", "C", "share_c"), 1.0);
    // A compressed content is no nearer to the truth than the truth.
    let sea = of_scenes(Some(LitWaters::Sea), 3, false, 2);
    assert_eq!(mean(&sea, "the truth itself", "C", "share_c"), 1.0);
    assert_ne!(mean(&sea, "z given, water ours", "`relight`", "share_c"), 0.0);
    let share = |model: &str| mean(&report, "z given, water ours", model, "share_c");
    assert!(
        share("`relight`") > share("`physical`") + 0.03,
        "{} {}",
        share("`relight`"),
        share("`physical`")
    );
    let labels = &report.tables[0].rows;
    assert!(labels.iter().all(|row| !row.labels[0].starts_with("everything given")));
    assert_eq!(report.items.scores.len(), report.items.rows[0].values.len());
}

#[test]
fn the_number_of_threads_changes_no_byte_of_any_format() {
    let (alone, together) = (run(3, false, 1), run(3, false, 4));
    for format in [super::super::report::markdown, super::super::report::json, super::super::report::html] {
        assert_eq!(format(&alone), format(&together));
    }
    assert_eq!(alone.items.rows, together.items.rows);
}

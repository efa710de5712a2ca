//! Estimated depth against measured depth.

use super::pairs::{Pair, by_place, read_all};
use aquafuse::depth::DepthModel;
use aquafuse::depth::fit::{Fitter, Options, Target};
use aquafuse::metrics::spearman;

fn measured() -> Option<Vec<Pair>> {
    let Some(data) = std::env::var_os("AQUAFUSE_TEST_DATA") else {
        eprintln!("skipped: AQUAFUSE_TEST_DATA does not name the folder of real images");
        return None;
    };
    let pairs = read_all(data.as_ref()).unwrap();
    assert!(!pairs.is_empty());
    Some(pairs)
}

fn mean_score(pairs: &[Pair], model: impl Fn(&Pair) -> DepthModel) -> f64 {
    let scores: Vec<f64> =
        pairs.iter().map(|pair| spearman(&pair.estimated(model(pair)), &pair.metres()).unwrap()).collect();
    by_place(pairs, &scores)
}

#[test]
fn each_way_orders_measured_depth_as_well_as_is_said_of_it() {
    let Some(pairs) = measured() else { return };
    for (model, least) in [(DepthModel::default(), 0.75), (DepthModel::Layout, 0.85)] {
        let mean = mean_score(&pairs, |_| model);
        assert!(mean >= least, "{}: {mean}", model.name());
    }
}

#[test]
fn fitted_to_other_places_eq3_orders_this_one_well() {
    let Some(pairs) = measured() else { return };
    let elsewhere = |pair: &Pair| {
        let mut fitter = Fitter::new(Options::default().with_target(Target::Order));
        for other in pairs.iter().filter(|other| other.place() != pair.place()) {
            let weight = other.share_of_place(&pairs);
            fitter.add_weighted(&other.image, &other.distances, weight).unwrap();
        }
        DepthModel::Eq3(fitter.solve().unwrap().eq3)
    };
    let mean = mean_score(&pairs, elsewhere);
    // Four places to learn from and one to be asked about; .75 when fitted to.
    assert!(mean >= 0.74, "{mean}");
}

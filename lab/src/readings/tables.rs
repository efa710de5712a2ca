//! The tables: in each, one choice is made each way and all others stay at our defaults.

use anyhow::Result;
use aquafuse::depth::DepthModel;
use aquafuse::fusion::{Gain, Model, Options};
use aquafuse::image::{Encoded, Encoding, Linear};
use aquafuse::smooth::Smoothing;
use aquafuse::truth::{Exchange, Trials};
use aquafuse::waterbody::{BackscatterMethod, EstimateOptions, WaterMap};

use super::reading::{Depth, Direct, Reading};
use super::scores::{Scores, mean, rms};

/// Exchanges of each row; half of them with open water in view.
const EXCHANGES: usize = 48;
/// Number of the first; those of `aquafuse evaluate truth` end before it.
const FIRST: usize = 200;

type Table = fn(&[Exchange<Encoded>]) -> Result<String>;

/// Each by the name of its section in the page.
pub(super) const TABLES: [(&str, Table); 9] = [
    ("direct", direct),
    ("direct-laws", direct_laws),
    ("water", water),
    ("depth", depth),
    ("smoothing", smoothing),
    ("gain", gain),
    ("incidence", incidence),
    ("light", light),
    ("together", together),
];

/// The two models that are a shift: the paper's, and the one that makes the whole change of truth A.
const SHIFTS: [Model; 2] = [Model::Aquafuse, Model::Physical];
const DIRECT: [(&str, Direct); 2] =
    [("U1* of Eq. 10 (ours)", Direct::Modulated), ("U1 − B1", Direct::WithoutBackscatter)];

pub(super) fn exchanges<E: Encoding>() -> Vec<Exchange<E>> {
    let trials = Trials::default();
    (FIRST..FIRST + EXCHANGES).map(|number| trials.exchange(number)).collect()
}

fn header(first: &str) -> String {
    format!("| {first} | model | {}\n", Scores::HEADER)
}

fn row<E: Encoding, F: Encoding>(name: &str, exchanges: &[Exchange<E>], reading: &Reading) -> Result<String> {
    let scores =
        exchanges.iter().map(|one| Scores::of::<E, F>(one, reading)).collect::<Result<Vec<_>, _>>()?;
    Ok(format!("| {name} | `{}` | {}\n", reading.options.model.name(), Scores::cells(&scores)))
}

fn direct(exchanges: &[Exchange<Encoded>]) -> Result<String> {
    let mut table = header("I1 e^(−τ)");
    for (name, direct) in DIRECT {
        table += &row::<_, Encoded>(name, exchanges, &Reading { direct, ..Reading::ours(Model::Aquafuse) })?;
    }
    Ok(table)
}

fn direct_laws(exchanges: &[Exchange<Encoded>]) -> Result<String> {
    let mut table =
        String::from("| I1 e^(−τ) | own water, θ = 0° | another water, θ = 90° |\n|---|---|---|\n");
    for (name, direct) in DIRECT {
        let reading = Reading { direct, ..Reading::ours(Model::Aquafuse) };
        let changed = |degrees: f32, own: bool| -> Result<f64> {
            let of = |one: &Exchange<Encoded>| {
                let reference = if own { &one.content } else { &one.reference };
                let fused = reading.at(degrees).fuse::<_, Encoded>(&one.content, reference)?;
                Ok(255.0 * rms(fused.as_raw(), one.content.image.to_unit().as_raw()))
            };
            Ok(mean(exchanges.iter().map(of).collect::<Result<Vec<f64>>>()?.into_iter()))
        };
        table += &format!("| {name} | {:.1} | {:.1} |\n", changed(0.0, true)?, changed(90.0, false)?);
    }
    Ok(table)
}

fn water(exchanges: &[Exchange<Encoded>]) -> Result<String> {
    let mut table = header("z; B∞; β_B");
    let depths = [("`eq3`", Depth::Colour(DepthModel::default())), ("given", Depth::Given)];
    let veils = [("open water", WaterMap::BEST), ("farthest 5 %", WaterMap::Published)];
    let growths = [("envelope", BackscatterMethod::Envelope), ("darkest 1 %", BackscatterMethod::Published)];
    for model in SHIFTS {
        for (z, depth) in depths {
            for (veil, water_map) in veils {
                for (growth, backscatter) in growths {
                    let water =
                        EstimateOptions::default().with_water_map(water_map).with_backscatter(backscatter);
                    let name = format!("{z}; {veil}; {growth}");
                    table += &row::<_, Encoded>(
                        &name,
                        exchanges,
                        &Reading { depth, water, ..Reading::ours(model) },
                    )?;
                }
            }
        }
    }
    Ok(table)
}

fn depth(exchanges: &[Exchange<Encoded>]) -> Result<String> {
    let mut table = header("z");
    let mut ways: Vec<(String, Depth)> =
        DepthModel::ALL.iter().map(|model| (format!("`{}`", model.name()), Depth::Colour(*model))).collect();
    ways.insert(2, ("`eq3`, neither".to_owned(), Depth::Unfiltered(DepthModel::default())));
    ways.push(("given".to_owned(), Depth::Given));
    for model in SHIFTS {
        for (name, depth) in &ways {
            table += &row::<_, Encoded>(name, exchanges, &Reading { depth: *depth, ..Reading::ours(model) })?;
        }
    }
    Ok(table)
}

fn smoothing(exchanges: &[Exchange<Encoded>]) -> Result<String> {
    let mut table = header("last step");
    for model in SHIFTS {
        for &smoothing in Smoothing::ALL {
            let name = smoothing.name();
            table += &row::<_, Encoded>(name, exchanges, &Reading { smoothing, ..Reading::ours(model) })?;
        }
    }
    Ok(table)
}

fn gain(exchanges: &[Exchange<Encoded>]) -> Result<String> {
    let mut table = header("α");
    for model in SHIFTS {
        for gain in [1.0, 1.5] {
            let options = Options::for_model(model).with_gain(Gain::new(gain).expect("in range"));
            table += &row::<_, Encoded>(
                &gain.to_string(),
                exchanges,
                &Reading { options, ..Reading::ours(model) },
            )?;
        }
    }
    Ok(table)
}

fn incidence(exchanges: &[Exchange<Encoded>]) -> Result<String> {
    let mut table = header("θ");
    for model in SHIFTS {
        for degrees in [0.0, 30.0, 45.0, 60.0, 90.0] {
            table +=
                &row::<_, Encoded>(&format!("{degrees}°"), exchanges, &Reading::ours(model).at(degrees))?;
        }
    }
    Ok(table)
}

fn light(exchanges: &[Exchange<Encoded>]) -> Result<String> {
    let mut table = header("scene formed in; fused in");
    let linear = self::exchanges::<Linear>();
    for model in SHIFTS {
        let ours = Reading::ours(model);
        table += &row::<_, Encoded>("encoded; encoded (ours)", exchanges, &ours)?;
        table += &row::<_, Linear>("encoded; linear", exchanges, &ours)?;
        table += &row::<_, Encoded>("linear; encoded (ours)", &linear, &ours)?;
        table += &row::<_, Linear>("linear; linear", &linear, &ours)?;
    }
    Ok(table)
}

fn together(exchanges: &[Exchange<Encoded>]) -> Result<String> {
    let mut table = header("settings");
    for &model in Model::ALL {
        table += &row::<_, Encoded>("our defaults", exchanges, &Reading::ours(model))?;
    }
    let published = Reading {
        options: Options::as_published(),
        smoothing: Smoothing::Bilateral,
        ..Reading::ours(Model::Aquafuse)
    };
    table += &row::<_, Encoded>("`--as-published`", exchanges, &published)?;
    let papers = Reading { water: EstimateOptions::as_published(), ..published };
    table += &row::<_, Encoded>("the same, B∞ and β_B the paper's way", exchanges, &papers)?;
    let other = Reading { direct: Direct::WithoutBackscatter, ..papers };
    table += &row::<_, Encoded>("the same, U1 − B1 in Eq. 11", exchanges, &other)?;
    Ok(table)
}

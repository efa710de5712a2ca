//! How good depth must be: true depth made worse step by step, as a network's is, and the share of the true change by it.

use std::fmt::Write;

use anyhow::Result;
use aquafuse::depth::{DepthModel, Supplied, SuppliedKind};
use aquafuse::formation::RestoreOptions;
use aquafuse::fusion::{Incidence, Model, Options};
use aquafuse::image::{Encoded, Image};
use aquafuse::levels::{LevelsOptions, Setting};
use aquafuse::metrics::spearman;
use aquafuse::truth::{Case, Exchange, Trials};
use aquafuse::waterbody::{Estimate, WaterShare};
use aquafuse_data::image_file::{ImageFile, Pixels};
use aquafuse_data::pipeline::{
    Analysis, DepthSource, Operation, PixelEncoding, WaterEstimate, analyse_coarse, analyse_in,
    analyse_supplied,
};
use rayon::prelude::*;

use crate::chance::Chance;

const EXCHANGES: usize = 120;
/// Columns and rows of the image that become one of the map.
const CELL: usize = 16;
/// Cells across a segment that is wrong.
const SEGMENT: usize = 3;

/// Where depth comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Depth {
    /// The truth.
    True(Unit),
    /// The truth at a sixteenth of the columns and rows; `blurred` by its neighbours; with this share of the cells in wrong segments.
    Coarse { unit: Unit, blurred: bool, wrong: f32 },
    /// A model of colours, by its name.
    Colour(&'static str),
}

/// What the numbers of a map are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Unit {
    Metres,
    /// 1 / z, by an unknown scale and shift.
    Inverse,
}

/// Depth at a sixteenth of the resolution, from the best to the worst.
const STEPS: [(&str, bool, f32); 7] = [
    ("and at 1/16 of the resolution", false, 0.0),
    ("and blurred", true, 0.0),
    ("and 5 % in wrong segments", true, 0.05),
    ("and 10 %", true, 0.1),
    ("and 20 %", true, 0.2),
    ("and 40 %", true, 0.4),
    ("and 80 %", true, 0.8),
];

/// A row: its name, where depth comes from, and whether the waters are given.
type Row = (&'static str, Depth, bool);

fn rows() -> Vec<Row> {
    let ladder = |first: &'static str, unit, is_given| {
        let steps = STEPS
            .iter()
            .map(move |&(name, blurred, wrong)| (name, Depth::Coarse { unit, blurred, wrong }, is_given));
        [(first, Depth::True(unit), is_given)].into_iter().chain(steps)
    };
    let colour = |name, model| (name, Depth::Colour(model), false);
    let estimated = [("true z, in metres", Depth::True(Unit::Metres), false)].into_iter();
    estimated
        .chain(ladder("1 / z, of unknown scale and shift", Unit::Inverse, false))
        .chain([colour("colour, `eq3`", "eq3"), colour("colour, `ratio`", "ratio")])
        .chain(ladder("true z, in metres", Unit::Metres, true))
        .collect()
}

/// What one exchange says of one row.
#[derive(Clone, Copy, Debug)]
struct Found {
    /// The rank correlation of the depth with the true one.
    order: f64,
    /// Shares of the true change: `physical` to A and to B, `exchange` to B, `restore` to the clear image.
    shares: [f64; 4],
}

const HEADING: &str = "| water | depth | Spearman with true z | `physical`, truth A | `physical`, truth B | `exchange`, truth B | median | \
    `restore`, clear image | `exchange` nearer to B than `physical`, % of the exchanges |\n|---|---|---|---|---|---|---|---|---|\n";
/// Percent that a block of the curve is.
const BLOCK: f64 = 5.0;

/// The table, and what it says.
pub(super) fn table() -> Result<String> {
    let (trials, rows) = (Trials::default(), rows());
    let found: Vec<Vec<Found>> = (0..EXCHANGES)
        .into_par_iter()
        .map(|number| {
            let exchange = trials.exchange::<Encoded>(number);
            rows.iter().map(|row| of(&exchange, row, number)).collect()
        })
        .collect::<Result<_>>()?;
    let mut text = HEADING.to_owned();
    let mut wins = Vec::new();
    for (place, (name, _, is_given)) in rows.iter().enumerate() {
        let column = |of: &dyn Fn(&Found) -> f64| -> Vec<f64> {
            let mut values: Vec<f64> = found.iter().map(|all| of(&all[place])).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let share = |k: usize| mean(&column(&|one| one.shares[k]));
        let nearer = 100.0 * mean(&column(&|one| f64::from(u8::from(one.shares[2] > one.shares[1]))));
        writeln!(
            text,
            "| {} | {name} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {nearer:.0} {} |",
            if *is_given { "given" } else { "estimated" },
            mean(&column(&|one| one.order)),
            share(0),
            share(1),
            share(2),
            column(&|one| one.shares[2])[EXCHANGES / 2],
            share(3),
            "█".repeat((nearer / BLOCK).round() as usize),
        )?;
        wins.push((*name, *is_given, share(2) > share(1)));
    }
    writeln!(text, "\nOne block is {BLOCK} %.")?;
    for (is_given, water) in [(false, "estimated"), (true, "given")] {
        let last =
            wins.iter().filter(|(_, given, _)| *given == is_given).take_while(|(.., wins)| *wins).last();
        match last {
            Some((name, ..)) => writeln!(
                text,
                "With water {water}, `exchange` comes nearer to truth B than `physical`, in the mean, down to \"{name}\"."
            )?,
            None => writeln!(
                text,
                "With water {water}, `exchange` comes no nearer to truth B than `physical`, in the mean, however good depth is."
            )?,
        }
    }
    Ok(text)
}

fn of(exchange: &Exchange<Encoded>, row: &Row, number: usize) -> Result<Found> {
    let content = analysed(&exchange.content, row, &mut Chance(2 * number as u64))?;
    let reference = analysed(&exchange.reference, row, &mut Chance(2 * number as u64 + 1))?.estimate;
    let image = &exchange.content.image;
    let share = |operation: &Operation, truth: &Image<f32>| -> Result<f64> {
        let mut made = Pixels::from(image.to_unit());
        operation.apply(&mut made, Some(&content))?;
        let Pixels::Floats(made) = made else { unreachable!("floats stay floats") };
        let distance = |from: &Image<f32>| {
            let squares = from.as_raw().iter().zip(truth.as_raw()).map(|(a, b)| f64::from(a - b).powi(2));
            squares.sum::<f64>().sqrt()
        };
        Ok(1.0 - distance(&made.image) / distance(&image.to_unit()))
    };
    let fuse = |model| {
        let all = Incidence::from_degrees(0.0).expect("in range");
        Operation::Fuse { reference, options: Options::for_model(model).with_incidence(all) }
    };
    let no_levels = LevelsOptions::default().with_white(Setting::None).with_exposure(Setting::None);
    let restore = Operation::Restore {
        options: RestoreOptions::default(),
        levels: no_levels,
        encoding: PixelEncoding::Encoded,
    };
    let [a, b] = &exchange.truths;
    let (physical, whole) = (fuse(Model::Physical), fuse(Model::Exchange));
    let order = spearman(&content.depth.distances(), &exchange.content.depth.distances());
    Ok(Found {
        order: order.unwrap_or(0.0),
        shares: [
            share(&physical, a)?,
            share(&physical, b)?,
            share(&whole, b)?,
            share(&restore, &exchange.content.clear)?,
        ],
    })
}

fn analysed(
    case: &Case<Encoded>,
    &(_, depth, is_given): &Row,
    chance: &mut Chance,
) -> Result<Analysis<WaterEstimate>> {
    let image = ImageFile::new(case.image.clone());
    let encoding = PixelEncoding::Encoded;
    let (width, height) = case.image.size();
    let inverse: Vec<f32> = case.depth.distances().iter().map(|z| 1.0 / z).collect();
    let map = |values: Vec<f32>, (width, height), unit, chance: &mut Chance| match unit {
        Unit::Metres => {
            Supplied::new(width, height, values.iter().map(|v| 1.0 / v).collect(), SuppliedKind::Metres)
        }
        Unit::Inverse => {
            Supplied::new(width, height, of_unknown_scale(values, chance), SuppliedKind::Inverse)
        }
    };
    let found = match depth {
        Depth::True(unit) => {
            analyse_supplied(encoding, &image, map(inverse, (width, height), unit, chance)?)?
        }
        Depth::Coarse { unit, blurred, wrong } => {
            let (mut cells, size) = cells(&inverse, (width, height));
            if blurred {
                cells = smoothed(&cells, size);
            }
            segments(&mut cells, size, wrong, chance);
            analyse_coarse(encoding, &image, &map(cells, size, unit, chance)?)?
        }
        Depth::Colour(name) => {
            let model: DepthModel = name.parse()?;
            analyse_in(encoding, &image, &DepthSource::Estimated(model.into()))?
        }
    };
    let known = || Estimate::given(case.water).into();
    Ok(match is_given {
        true => Analysis { estimate: known(), share: WaterShare::none((width, height)), ..found },
        false => found,
    })
}

/// The mean of 1 / z in each cell.
fn cells(inverse: &[f32], (width, height): (usize, usize)) -> (Vec<f32>, (usize, usize)) {
    let (columns, rows) = (width / CELL, height / CELL);
    let mean = |i: usize| {
        let (x, y) = (i % columns * CELL, i / columns * CELL);
        let inside = (y..y + CELL).flat_map(|y| (x..x + CELL).map(move |x| inverse[y * width + x]));
        inside.sum::<f32>() / (CELL * CELL) as f32
    };
    ((0..columns * rows).map(mean).collect(), (columns, rows))
}

/// Each cell with its neighbours by 1, 2, 1 across and down.
fn smoothed(cells: &[f32], (columns, rows): (usize, usize)) -> Vec<f32> {
    let weighed = |i: usize| {
        let (x, y) = ((i % columns) as i64, (i / columns) as i64);
        let near = |v: i64, most: usize| v.clamp(0, most as i64 - 1) as usize;
        let beside = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
        let sum = beside.map(|(dx, dy): (i64, i64)| {
            let weight = ((2 - dx.abs()) * (2 - dy.abs())) as f32;
            weight * cells[near(y + dy, rows) * columns + near(x + dx, columns)]
        });
        sum.sum::<f32>() / 16.0
    };
    (0..cells.len()).map(weighed).collect()
}

/// Gives squares of cells the value of some other cell, until this share of all is wrong.
fn segments(cells: &mut [f32], (columns, rows): (usize, usize), share: f32, chance: &mut Chance) {
    let mut is_wrong = vec![false; cells.len()];
    while (is_wrong.iter().filter(|wrong| **wrong).count() as f32) < share * cells.len() as f32 {
        let value = cells[chance.below(cells.len())];
        let (x, y) = (chance.below(columns), chance.below(rows));
        for y in y..(y + SEGMENT).min(rows) {
            for x in x..(x + SEGMENT).min(columns) {
                (cells[y * columns + x], is_wrong[y * columns + x]) = (value, true);
            }
        }
    }
}

/// Scaled by a half to two, and shifted by up to a third of the range.
fn of_unknown_scale(values: Vec<f32>, chance: &mut Chance) -> Vec<f32> {
    let mut share = || chance.below(1000) as f32 / 1000.0;
    let range = values.iter().copied().fold(0.0, f32::max);
    let (scale, shift) = (0.5 + 1.5 * share(), range * share() / 3.0);
    values.into_iter().map(|value| scale * (value + shift)).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blur_keeps_what_is_flat_and_segments_change_the_share_that_is_asked() {
        let size = (15, 10);
        assert_eq!(smoothed(&[0.5; 150], size), [0.5; 150]);
        let before: Vec<f32> = (0..150).map(|i| i as f32).collect();
        for share in [0.0, 0.1, 0.8] {
            let mut cells = before.clone();
            segments(&mut cells, size, share, &mut Chance(3));
            let changed = cells.iter().zip(&before).filter(|(a, b)| a != b).count() as f32 / 150.0;
            assert!((changed - share).abs() < 0.07, "{changed} instead of {share}");
        }
    }

    #[test]
    fn an_unknown_scale_keeps_the_order() {
        let values = of_unknown_scale((0..50).map(|i| i as f32).collect(), &mut Chance(5));
        assert!(values.windows(2).all(|pair| pair[0] < pair[1]) && values[0] >= 0.0);
    }
}

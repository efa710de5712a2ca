//! The paper's own figures (`testdata/published.toml`), as tables of their own: other images, another machine.

use aquafuse_data::evaluate::Summary;
use aquafuse_data::evaluate::report::{Cell, Row, Score, Shown, Table};
use serde::Deserialize;

/// A mean and a variance, as the paper prints them.
type Printed = [f64; 2];

#[derive(Deserialize)]
struct Published {
    label: String,
    image_similarity: ImageSimilarity,
    reconstruction: Reconstruction,
    style_transfer: StyleTransfer,
}

/// Fused images against their contents, by the depth of the site.
#[derive(Deserialize)]
struct ImageSimilarity {
    table: String,
    depth_feet: Vec<u32>,
    psnr: Vec<Printed>,
    ssim: Vec<Printed>,
    rmse: Vec<Printed>,
}

/// Views of scenes trained on originals and on fused images, by the depth of the site.
#[derive(Deserialize)]
struct Reconstruction {
    table: String,
    depth_feet: Vec<u32>,
    original: Views,
    fused: Views,
    normal_deviation_percent: Vec<f64>,
}

#[derive(Deserialize)]
struct Views {
    psnr: Vec<f64>,
    ssim: Vec<f64>,
    lpips: Vec<f64>,
}

/// The same of other methods.
#[derive(Deserialize)]
struct StyleTransfer {
    table: String,
    depth_feet: Vec<u32>,
    method: Vec<PublishedMethod>,
}

#[derive(Deserialize)]
struct PublishedMethod {
    name: String,
    ssim: Vec<Printed>,
    rmse: Vec<Printed>,
}

const PSNR: Score = Score { key: "psnr", title: "PSNR, dB", digits: 2, shown: Shown::MeanAndVariance };
const SSIM: Score = Score { key: "ssim", title: "SSIM", digits: 3, shown: Shown::MeanAndVariance };
/// On which of the two scales the paper does not say.
const RMSE: Score = Score {
    key: "depth_rmse",
    title: "depth RMSE, scale not said",
    digits: 2,
    shown: Shown::MeanAndVariance,
};

fn read() -> Result<Published, toml::de::Error> {
    toml::from_str(include_str!("../../../../testdata/published.toml"))
}

/// What the paper prints about its own method; with `methods`, about others too.
pub(crate) fn tables(methods: bool) -> Result<Vec<Table>, toml::de::Error> {
    let Published { label, image_similarity: own, style_transfer: others, .. } = read()?;
    let site = |feet: &u32| format!("site at {feet}'");
    let rows = own.depth_feet.iter().zip(own.psnr.iter().zip(&own.ssim).zip(&own.rmse));
    let of_site = |(feet, ((psnr, ssim), rmse)): (&u32, ((&Printed, &Printed), &Printed))| Row {
        labels: vec!["AquaFuse".into(), site(feet)],
        cells: [psnr, ssim, rmse].map(cell).to_vec(),
    };
    let table = |name, number: &str, scores: &[Score], rows| Table {
        name,
        title: format!("{label}: {number} of the paper"),
        labels: vec!["method", "group"],
        scores: scores.to_vec(),
        rows,
    };
    let mut tables = vec![table("published", &own.table, &[PSNR, SSIM, RMSE], rows.map(of_site).collect())];
    if methods {
        let of_method = |method: &PublishedMethod| -> Vec<Row> {
            let scores = others.depth_feet.iter().zip(method.ssim.iter().zip(&method.rmse));
            let row = |(feet, (ssim, rmse)): (&u32, (&Printed, &Printed))| Row {
                labels: vec![method.name.clone(), site(feet)],
                cells: [ssim, rmse].map(cell).to_vec(),
            };
            scores.map(row).collect()
        };
        let rows = others.method.iter().flat_map(of_method).collect();
        // Printed with two digits.
        let ssim = Score { digits: 2, ..SSIM };
        tables.push(table("published_methods", &others.table, &[ssim, RMSE], rows));
    }
    Ok(tables)
}

/// What the paper prints about view synthesis: for each site the original and what was fused.
pub(crate) fn reconstruction() -> Result<Table, toml::de::Error> {
    let Published { label, reconstruction, .. } = read()?;
    let Reconstruction { table, depth_feet, original, fused, normal_deviation_percent: deviations } =
        reconstruction;
    let row = |feet: u32, images: &str, views: &Views, place: usize, deviation: Option<f64>| {
        let scores = [&views.psnr, &views.ssim, &views.lpips].map(|of| of.get(place).copied());
        let number = |value: Option<f64>| value.map_or(Cell::Nothing, Cell::Number);
        Row {
            labels: vec![format!("site at {feet}'"), images.into()],
            cells: scores.into_iter().chain([deviation]).map(number).collect(),
        }
    };
    let sites = depth_feet.into_iter().zip(deviations).enumerate();
    let rows = sites.flat_map(|(place, (feet, deviation))| {
        [row(feet, "original", &original, place, None), row(feet, "fused", &fused, place, Some(deviation))]
    });
    let score = |key, title, digits| Score { key, title, digits, shown: Shown::Number };
    Ok(Table {
        name: "published",
        title: format!("{label}: {table} of the paper"),
        labels: vec!["scene", "pictures"],
        scores: vec![
            score("psnr", "PSNR, dB", 2),
            score("ssim", "SSIM", 4),
            score("lpips", "LPIPS", 4),
            score("normal_deviation_percent", "SND, %", 3),
        ],
        rows: rows.collect(),
    })
}

fn cell(&[mean, variance]: &Printed) -> Cell {
    Cell::Summary(Summary { count: 0, left_out: 0, mean, variance, interval: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_site_was_trained_on_twice_and_its_deviation_stands_once() {
        let table = reconstruction().unwrap();
        assert_eq!(table.rows.len(), 12);
        for (place, row) in table.rows.iter().enumerate() {
            assert_eq!(row.cells.len(), table.scores.len());
            let missing = row.cells.iter().filter(|cell| **cell == Cell::Nothing).count();
            assert_eq!(missing, 1 - place % 2, "{:?}", row.labels);
        }
    }

    #[test]
    fn each_site_has_each_score_and_they_agree_with_the_table_that_repeats_them() {
        let Published { image_similarity: table_1, style_transfer: table_3, .. } = read().unwrap();
        let ours = table_3.method.iter().find(|method| method.name == "AquaFuse").unwrap();
        let sites = table_1.depth_feet.len();
        assert_eq!((table_1.psnr.len(), &table_3.depth_feet), (sites, &table_1.depth_feet));
        for (repeated, expected) in [(&ours.ssim, &table_1.ssim), (&ours.rmse, &table_1.rmse)] {
            assert_eq!((repeated.len(), expected.len()), (sites, sites));
            for (repeated, expected) in repeated.iter().flatten().zip(expected.iter().flatten()) {
                // Printed there with two digits.
                assert!((repeated - expected).abs() < 0.0051, "{repeated} for {expected}");
            }
        }
        assert!(
            table_3
                .method
                .iter()
                .all(|method| [&method.ssim, &method.rmse].iter().all(|of| of.len() == sites))
        );
    }
}

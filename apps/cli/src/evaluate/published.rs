//! The paper's own figures (`testdata/published.toml`), as tables of their own: other pictures, another machine.

use aquafuse_data::evaluate::Summary;
use aquafuse_data::evaluate::report::{Cell, Row, Score, Shown, Table};
use serde::Deserialize;

/// A mean and a variance, as the paper prints them.
type Printed = [f64; 2];

#[derive(Deserialize)]
struct Published {
    label: String,
    image_similarity: ImageSimilarity,
    style_transfer: StyleTransfer,
}

/// Fused pictures against their contents, by the depth of the site.
#[derive(Deserialize)]
struct ImageSimilarity {
    table: String,
    depth_feet: Vec<u32>,
    psnr: Vec<Printed>,
    ssim: Vec<Printed>,
    rmse: Vec<Printed>,
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
pub(super) fn tables(methods: bool) -> Result<Vec<Table>, toml::de::Error> {
    let Published { label, image_similarity: own, style_transfer: others } = read()?;
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

fn cell(&[mean, variance]: &Printed) -> Cell {
    Cell::Summary(Summary { count: 0, left_out: 0, mean, variance, interval: None })
}

#[cfg(test)]
mod tests {
    use super::*;

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

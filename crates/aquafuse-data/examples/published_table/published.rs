//! The paper's own figures (`testdata/published.toml`).

use serde::Deserialize;

/// A mean and a variance, as the paper prints them.
pub(crate) type Printed = [f64; 2];

#[derive(Deserialize)]
pub(crate) struct Published {
    pub(crate) label: String,
    pub(crate) image_similarity: ImageSimilarity,
}

/// Fused pictures against their contents, by the depth of the site.
#[derive(Deserialize)]
pub(crate) struct ImageSimilarity {
    pub(crate) table: String,
    pub(crate) depth_feet: Vec<u32>,
    pub(crate) psnr: Vec<Printed>,
    pub(crate) ssim: Vec<Printed>,
    /// Of depth; on which scale the paper does not say.
    pub(crate) rmse: Vec<Printed>,
}

pub(crate) fn read() -> Result<Published, toml::de::Error> {
    toml::from_str(include_str!("../../../../testdata/published.toml"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_site_has_each_score_and_they_agree_with_the_table_that_repeats_them() {
        let table_1 = read().unwrap().image_similarity;
        let all: toml::Table = toml::from_str(include_str!("../../../../testdata/published.toml")).unwrap();
        let methods = all["style_transfer"]["method"].as_array().unwrap();
        let ours = methods.iter().find(|method| method["name"].as_str() == Some("AquaFuse")).unwrap();
        let sites = table_1.depth_feet.len();
        assert_eq!(table_1.psnr.len(), sites);
        for (score, expected) in [("ssim", &table_1.ssim), ("rmse", &table_1.rmse)] {
            let repeated: Vec<Printed> = ours[score].clone().try_into().unwrap();
            assert_eq!((repeated.len(), expected.len()), (sites, sites));
            for (repeated, expected) in repeated.iter().flatten().zip(expected.iter().flatten()) {
                // Printed there with two digits.
                assert!((repeated - expected).abs() < 0.0051, "{repeated} for {expected}");
            }
        }
        assert!(methods.iter().all(|method| {
            ["ssim", "rmse"].iter().all(|score| method[*score].as_array().unwrap().len() == sites)
        }));
    }
}

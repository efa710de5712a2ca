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

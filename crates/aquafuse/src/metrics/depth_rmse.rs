//! What fusion does to depth.

use crate::depth::DepthModel;
use crate::image::{ImageError, ImageRef, Sample, check_same_size};

/// Root mean square difference of two depth maps, on the paper's two scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRmse(
    /// RMSE of z in `[0, 1]`.
    pub f64,
);

impl DepthRmse {
    /// In percent of the range.
    pub fn percent(&self) -> f64 {
        100.0 * self.0
    }

    /// In levels, 0 to 255.
    pub fn levels(&self) -> f64 {
        255.0 * self.0
    }

    /// Depth consistency, 100 % - RMSE.
    pub fn consistency(&self) -> f64 {
        100.0 - self.percent()
    }
}

/// Compares depth estimated again from a fused image with the depth estimated from its content.
///
/// Both by `model`, median included; the paper uses Eq. 3.
///
/// # Errors
///
/// [`ImageError`] when the images differ in size.
///
/// # Examples
///
/// ```
/// use aquafuse::{depth::DepthModel, image::Image, metrics::depth_rmse};
///
/// let image = Image::<u8>::from_raw(2, 1, vec![10, 90, 120, 200, 80, 60])?;
/// assert_eq!(depth_rmse(&image, &image, DepthModel::default())?.consistency(), 100.0);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
pub fn depth_rmse<'a, 'b, T: Sample, U: Sample>(
    content: impl Into<ImageRef<'a, T>>,
    fused: impl Into<ImageRef<'b, U>>,
    model: DepthModel,
) -> Result<DepthRmse, ImageError> {
    let (content, fused) = (content.into(), fused.into());
    check_same_size(content.size(), fused.size())?;
    let (before, after) = (model.estimate(content).distances(), model.estimate(fused).distances());
    let squares = before.iter().zip(&after).map(|(a, b)| f64::from(a - b).powi(2));
    Ok(DepthRmse((squares.sum::<f64>() / before.len() as f64).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    #[test]
    fn red_turned_to_blue_moves_depth_over_its_whole_range() {
        let image = |rgb: [u8; 3]| Image::<u8>::from_raw(8, 8, rgb.repeat(64)).unwrap();
        let error = depth_rmse(&image([255, 0, 0]), &image([0, 0, 255]), DepthModel::default()).unwrap();
        assert_eq!((error.percent(), error.levels(), error.consistency()), (100.0, 255.0, 0.0));
    }
}

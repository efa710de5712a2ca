//! How much more a sequence changes from frame to frame than its source.

use crate::image::{ImageError, ImageRef, Sample, check_same_size};

/// How much the mean colour of a sequence changes from frame to frame, beside the sequence it was made of.
///
/// The change of a frame is the mean over the channels of `|m_t - m_(t-1)|`, with m the mean of a channel in `[0, 1]`.
///
/// # Examples
///
/// ```
/// use aquafuse::{image::Image, metrics::Flicker};
///
/// let grey = |value| Image::<u8>::from_raw(1, 1, vec![value; 3]);
/// let mut flicker = Flicker::default();
/// for (source, output) in [(50, 80), (52, 86), (54, 80)] {
///     flicker.add(&grey(source)?, &grey(output)?)?;
/// }
/// assert!((flicker.ratio().expect("three frames that change") - 3.0).abs() < 1e-9);
/// assert!((flicker.largest().1 - 6.0 / 255.0).abs() < 1e-9);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flicker {
    last: Option<[[f64; 3]; 2]>,
    changes: [f64; 2],
    frames: usize,
    largest: (usize, f64),
}

impl Flicker {
    /// Adds the next frame, and what was made of it.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the two differ in size.
    pub fn add<'a, 'b, T: Sample>(
        &mut self,
        source: impl Into<ImageRef<'a, T>>,
        output: impl Into<ImageRef<'b, T>>,
    ) -> Result<(), ImageError> {
        let (source, output) = (source.into(), output.into());
        check_same_size(source.size(), output.size())?;
        let means = [mean(source), mean(output)];
        if let Some(last) = self.last {
            let [of_source, of_output] =
                [0, 1].map(|i| (0..3).map(|c| (means[i][c] - last[i][c]).abs()).sum::<f64>() / 3.0);
            self.changes[0] += of_source;
            self.changes[1] += of_output;
            if of_output > self.largest.1 {
                self.largest = (self.frames, of_output);
            }
        }
        self.frames += 1;
        self.last = Some(means);
        Ok(())
    }

    /// The change of the output over the change of the source; `None` where the source does not change.
    #[must_use]
    pub fn ratio(&self) -> Option<f64> {
        (self.changes[0] > 0.0).then(|| self.changes[1] / self.changes[0])
    }

    /// The frame at which the output changes most, counted from 0, and by how much.
    #[must_use]
    pub fn largest(&self) -> (usize, f64) {
        self.largest
    }

    /// The mean change of a frame, of the source and of the output.
    #[must_use]
    pub fn changes(&self) -> [f64; 2] {
        self.changes.map(|sum| sum / self.frames.saturating_sub(1).max(1) as f64)
    }
}

/// The mean of each channel, in `[0, 1]`.
fn mean<T: Sample>(image: ImageRef<'_, T>) -> [f64; 3] {
    let mut sums = [0_u64; 3];
    for pixel in image.pixels() {
        (0..3).for_each(|c| sums[c] += pixel[c].to_steps());
    }
    let whole = T::from_unit(1.0).to_steps() as f64 * (image.width() * image.height()) as f64;
    sums.map(|sum| sum as f64 / whole)
}

/// The warping error of a frame: how much it differs from the frame before, each pixel compared with where the flow says it was.
///
/// `flow` has for each pixel, row by row, how many columns and rows further it was in the frame before. The result is the mean of the
/// absolute differences in `[0, 1]` over all channels of the pixels that were in view, bilinearly interpolated; 0 if none was.
///
/// # Errors
///
/// [`ImageError`] when the frames differ in size.
///
/// # Panics
///
/// When `flow` has not one entry for each pixel.
///
/// # Examples
///
/// ```
/// use aquafuse::{image::Image, metrics::warping_error};
///
/// let row = |values: [u8; 4]| Image::<u8>::from_raw(4, 1, values.iter().flat_map(|v| [*v; 3]).collect());
/// // All moves one column to the right: what is new at the left was not in view.
/// let (before, after) = (row([10, 20, 40, 80])?, row([90, 10, 20, 40])?);
/// assert_eq!(warping_error(&before, &after, &[[-1.0, 0.0]; 4])?, 0.0);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
pub fn warping_error<'a, 'b>(
    before: impl Into<ImageRef<'a, u8>>,
    after: impl Into<ImageRef<'b, u8>>,
    flow: &[[f32; 2]],
) -> Result<f64, ImageError> {
    let (before, after) = (before.into(), after.into());
    check_same_size(before.size(), after.size())?;
    let (width, height) = after.size();
    assert_eq!(flow.len(), width * height, "a flow has one entry for each pixel");
    let [right, bottom] = [width, height].map(|length| (length - 1) as f32);
    let (mut sum, mut count) = (0.0, 0_u64);
    for y in 0..height {
        for (x, pixel) in after.row(y).iter().enumerate() {
            let [dx, dy] = flow[y * width + x];
            let (u, v) = (x as f32 + dx, y as f32 + dy);
            if !(0.0..=right).contains(&u) || !(0.0..=bottom).contains(&v) {
                continue;
            }
            let [left, top] = [u, v].map(|place| place as usize);
            let rows = [top, (top + 1).min(height - 1)].map(|y| before.row(y));
            let (s, t) = (u - left as f32, v - top as f32);
            for c in 0..3 {
                let across = rows.map(|row| {
                    let [from, to] = [row[left][c], row[(left + 1).min(width - 1)][c]].map(f32::from);
                    from + s * (to - from)
                });
                let was = across[0] + t * (across[1] - across[0]);
                sum += f64::from((f32::from(pixel[c]) - was).abs());
            }
            count += 1;
        }
    }
    Ok(sum / (3 * 255 * count.max(1)) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    #[test]
    fn a_sequence_that_is_its_source_has_ratio_one_and_one_that_stands_still_none() {
        let image = |value: u8| Image::<u8>::from_raw(2, 1, vec![value, 0, 9, 3, value, 1]).unwrap();
        let mut moving = Flicker::default();
        let mut still = Flicker::default();
        for value in [3, 9, 200] {
            moving.add(&image(value), &image(value)).unwrap();
            still.add(&image(3), &image(value)).unwrap();
        }
        assert_eq!((moving.ratio(), still.ratio(), moving.largest().0), (Some(1.0), None, 2));
        assert!(moving.add(&image(3), &Image::<u8>::from_raw(1, 1, vec![0; 3]).unwrap()).is_err());
    }

    #[test]
    fn half_a_column_is_between_two_pixels() {
        let image = |values: [u8; 2]| {
            Image::<u8>::from_raw(2, 1, values.iter().flat_map(|v| [*v; 3]).collect()).unwrap()
        };
        let error = warping_error(&image([10, 20]), &image([15, 0]), &[[0.5, 0.0], [9.0, 0.0]]);
        assert_eq!(error, Ok(0.0));
        assert!(warping_error(&image([10, 20]), &image([25, 0]), &[[0.5, 0.0], [9.0, 0.0]]).unwrap() > 0.03);
    }
}

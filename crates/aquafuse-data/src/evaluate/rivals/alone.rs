//! What others do with an image alone, in a few lines.

use aquafuse::image::{Image, Sample};

/// A way to improve an image that knows nothing of water or depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alone {
    /// Each channel from its 1 % to its 99 % percentile.
    Stretch,
    /// Each channel times what brings its mean to the mean of all channels (G. Buchsbaum, "A spatial processor model for object colour
    /// perception", 1980).
    GrayWorld,
}

impl Alone {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Stretch, Self::GrayWorld];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stretch => "stretch, 1 to 99 %",
            Self::GrayWorld => "gray world",
        }
    }

    /// The image, improved.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::image::Image;
    /// use aquafuse_data::evaluate::Alone;
    ///
    /// let blue = Image::<u8>::from_raw(2, 1, vec![10, 20, 30, 30, 60, 90])?;
    /// assert_eq!(Alone::Stretch.image(&blue).pixels(), [[0; 3], [255; 3]]);
    /// assert_eq!(Alone::GrayWorld.image(&blue).pixels(), [[20; 3], [60; 3]]);
    /// # Ok::<(), aquafuse::image::ImageError>(())
    /// ```
    pub fn image(self, image: &Image<u8>) -> Image<u8> {
        let lines: [[f64; 2]; 3] = match self {
            Self::Stretch => [0, 1, 2].map(|c| {
                let [low, high] = percentiles(image, c);
                let gain = 255.0 / (high - low).max(1.0);
                [gain, -low * gain]
            }),
            Self::GrayWorld => {
                let mean = |c: usize| image.pixels().iter().map(|pixel| f64::from(pixel[c])).sum::<f64>();
                let means = [0, 1, 2].map(mean);
                let grey = means.iter().sum::<f64>() / 3.0;
                means.map(|mean| [if mean > 0.0 { grey / mean } else { 1.0 }, 0.0])
            }
        };
        let changed = |pixel: &[u8; 3]| {
            let value = |c: usize| (lines[c][0] * f64::from(pixel[c]) + lines[c][1]) / 255.0;
            [0, 1, 2].map(|c| u8::from_unit(value(c) as f32))
        };
        let (width, height) = image.size();
        let samples = image.pixels().iter().flat_map(changed).collect();
        Image::from_raw(width, height, samples).expect("a colour for each pixel")
    }
}

/// The 1 % and the 99 % percentile of a channel.
fn percentiles(image: &Image<u8>, c: usize) -> [f64; 2] {
    let mut counts = [0_usize; 256];
    image.pixels().iter().for_each(|pixel| counts[usize::from(pixel[c])] += 1);
    let all = image.pixels().len();
    [1, 99].map(|percent| {
        let wanted = (all - 1) * percent / 100;
        let mut seen = 0;
        let found = counts.iter().position(|count| {
            seen += count;
            seen > wanted
        });
        found.unwrap_or(255) as f64
    })
}

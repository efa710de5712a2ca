//! Everything in the paper that can be read in more than one way.

use aquafuse::depth::{DepthMap, DepthModel};
use aquafuse::fusion::{Bounded, Incidence, Model, Options, TransferLaw};
use aquafuse::image::{Encoding, Image, ImageError};
use aquafuse::smooth::Smoothing;
use aquafuse::truth::Case;
use aquafuse::waterbody::{EstimateOptions, WaterMap, estimate, estimate_with_share};

/// One way to read all of it.
#[derive(Clone, Copy)]
pub(crate) struct Reading {
    pub(crate) depth: Depth,
    pub(crate) water: EstimateOptions,
    pub(crate) direct: Direct,
    pub(crate) options: Options,
    pub(crate) smoothing: Smoothing,
}

/// How depth is obtained.
#[derive(Clone, Copy)]
pub(crate) enum Depth {
    /// The truth.
    Given,
    Colour(DepthModel),
    /// From colour, pixel by pixel.
    Unfiltered(DepthModel),
}

/// What stands for the direct signal I1 e^(-τ) of Eq. 11.
#[derive(Clone, Copy)]
pub(crate) enum Direct {
    /// U1* of Eq. 10.
    Modulated,
    /// U1 - B1, which is what Eq. 2 put into Eq. 11 says.
    WithoutBackscatter,
}

impl Depth {
    fn of<E: Encoding>(self, case: &Case<E>) -> DepthMap {
        match self {
            Self::Given => case.depth.clone(),
            Self::Colour(model) => model.estimate(&case.image),
            Self::Unfiltered(model) => model.estimate_unfiltered(&case.image),
        }
    }
}

impl Reading {
    /// The defaults of a model, as the command has them.
    pub(crate) fn ours(model: Model) -> Self {
        Self {
            depth: Depth::Colour(DepthModel::default()),
            water: EstimateOptions::default().with_water_map(WaterMap::BEST),
            direct: Direct::Modulated,
            options: Options::for_model(model),
            smoothing: Smoothing::None,
        }
    }

    pub(crate) fn at(self, degrees: f32) -> Self {
        let incidence = Incidence::from_degrees(degrees).expect("in range");
        Self { options: self.options.with_incidence(incidence), ..self }
    }

    /// The content in the reference's water: fused in the encoding `F`, handed back encoded and not clipped.
    ///
    /// Smoothing acts on bytes, as in the command, and so clips.
    pub(crate) fn fuse<E: Encoding, F: Encoding>(
        &self,
        content: &Case<E>,
        reference: &Case<E>,
    ) -> Result<Image<f32>, ImageError> {
        let z = self.depth.of(content);
        let (own, share) = estimate_with_share::<F>(&content.image, &z, &self.water)?;
        let other = estimate::<F>(&reference.image, &self.depth.of(reference), &self.water)?;
        let bounded = Bounded::new(&own, &other, self.options);
        let law = TransferLaw::new(bounded.waters(), &bounded.options);
        let mut fused = content.image.to_unit();
        let (width, reads_share) = (fused.width(), self.options.model != Model::Aquafuse);
        for (i, (pixel, z)) in fused.pixels_mut().iter_mut().zip(z.distances()).enumerate() {
            let w = if reads_share { share.at(i % width, i / width, *pixel) } else { 0.0 };
            let mut out = law.in_share(law.at(z), w).of(pixel.map(F::from_encoded));
            if let Direct::WithoutBackscatter = self.direct {
                // Eq. 10 has taken cosθ F of the backscatter away already.
                let (backscatter, factor) = (own.water.backscatter(z), own.water.depth_factor(z));
                let cosine = self.options.incidence.cosine();
                (0..3).for_each(|c| out[c] -= backscatter[c] * (1.0 - cosine * factor[c]));
            }
            *pixel = out.map(F::to_encoded);
        }
        Ok(match self.smoothing {
            Smoothing::None => fused,
            way => way.apply(fused.convert::<u8>()).to_unit(),
        })
    }
}

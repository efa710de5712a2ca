//! `--border`: what surrounds the scene of an image.

use aquafuse::scene_area::Border;
use clap::Args;

use crate::args::common::Common;

#[derive(Args)]
pub(crate) struct BorderArgument {
    /// What surrounds the scene: bars, frames and padding of one colour, bars with text, the round of a fish-eye,
    /// transparent pixels. It is left out of every estimate and stays as it is, byte for byte. `auto` finds it in each
    /// image, `none` takes every pixel for scene, and TOP,RIGHT,BOTTOM,LEFT gives rows and columns of the stored image
    /// (in references it is then found). --as-published takes every pixel.
    #[arg(long, value_name = "auto|none|T,R,B,L", default_value_t)]
    border: Border,
}

impl BorderArgument {
    /// The same options, with images cut to their scene.
    pub(crate) fn cutting(&self, common: &Common) -> Common {
        common.clone().with_border(self.border)
    }
}

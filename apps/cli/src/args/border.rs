//! `--border` and `--water-map`: what surrounds the scene of an image, and where it shows open water.

use aquafuse::scene_area::Border;
use aquafuse::waterbody::WaterMap;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::args::common::Common;

#[derive(Args)]
pub(crate) struct BorderArgument {
    /// What surrounds the scene: bars, frames and padding of one colour, bars with text, the round of a fish-eye,
    /// transparent pixels. It is left out of every estimate and stays as it is, byte for byte. `auto` finds it in each
    /// image, `none` takes every pixel for scene, and TOP,RIGHT,BOTTOM,LEFT gives rows and columns of the stored image
    /// (in references it is then found). Where there is --as-published, that takes every pixel.
    #[arg(long, value_name = "auto|none|T,R,B,L", default_value_t)]
    border: Border,
    /// What says where open water is: its share of each pixel, the colour that is read there, and whether there is any. `rules` weigh
    /// smoothness, height in the image, depth and brightness. `network` asks a network of 145 kB that is part of this program and was
    /// trained on synthetic scenes alone; it never saw a photograph and paints nothing itself. `both` weighs the odds of both together.
    /// `published` is the paper's way: B∞ is the median of the farthest 5 % of the pixels, and no pixel is open water.
    #[arg(long, value_name = "M", default_value = WaterMap::BEST.name(), value_parser = water_map())]
    water_map: WaterMap,
}

impl BorderArgument {
    /// The same options, with images cut to their scene, and open water found as asked.
    pub(crate) fn cutting(&self, common: &Common) -> Common {
        common.clone().with_border(self.border).with_water_map(self.water_map)
    }
}

fn water_map() -> impl TypedValueParser<Value = WaterMap> {
    PossibleValuesParser::new(WaterMap::ALL.iter().map(|map| map.name()))
        .try_map(|name| name.parse::<WaterMap>())
}

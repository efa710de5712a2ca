//! The ways to find open water in an image.

/// What says where an image shows open water: for the share of water of each pixel, for the region that B∞ is read in, and for whether
/// open water is in view at all. What follows from that is computed in closed form.
///
/// | map | looks at | use it |
/// |---|---|---|
/// | [`Rules`](Self::Rules) | smoothness, height in the image, depth, brightness | in streams, where each millisecond counts: the default of this crate |
/// | `Network`, with the feature `network` | the image as a whole, 128 x 96 pixels of it | to see what it says alone |
/// | [`Published`](Self::Published) | depth and colour: B∞ is the median of the farthest 5 %, with the paper's fallbacks, and no pixel is open water | to compare with the paper |
/// | `Both`, with the feature `network` | both; whether by their odds together, the share of a pixel by either, B∞ by the network | for still images: nearer to the water on every set we have, and 2 ms slower: [`BEST`](Self::BEST) |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum WaterMap {
    /// Signs of water, weighed.
    #[default]
    Rules,
    /// The paper's: nothing says where open water is, and B∞ is read in the farthest 5 % of the pixels.
    Published,
    /// The network of this crate, trained on synthetic scenes alone: [`Sight`](crate::network::Sight).
    #[cfg(feature = "network")]
    Network,
    /// Rules and the network together.
    #[cfg(feature = "network")]
    Both,
}

impl WaterMap {
    /// All that this build has.
    pub const ALL: &'static [Self] = &[
        Self::Rules,
        Self::Published,
        #[cfg(feature = "network")]
        Self::Network,
        #[cfg(feature = "network")]
        Self::Both,
    ];

    /// What finds the water of photographs best, of all that this build has: what the command and the Python package use for still
    /// images.
    #[cfg(feature = "network")]
    pub const BEST: Self = Self::Both;
    /// What finds the water of photographs best, of all that this build has.
    #[cfg(not(feature = "network"))]
    pub const BEST: Self = Self::Rules;

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rules => "rules",
            Self::Published => "published",
            #[cfg(feature = "network")]
            Self::Network => "network",
            #[cfg(feature = "network")]
            Self::Both => "both",
        }
    }
}

crate::names::named!(WaterMap, "map of open water");

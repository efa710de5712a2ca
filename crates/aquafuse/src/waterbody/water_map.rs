//! The ways to find open water in an image.

/// What says where an image shows open water: for the share of water of each pixel, for the region that B∞ is read in, and for whether
/// open water is in view at all. What follows from that is computed in closed form.
///
/// | map | looks at | use it |
/// |---|---|---|
/// | [`Rules`](Self::Rules) | smoothness, height in the image, depth, brightness | explained in one page: the default |
/// | `Network`, with the feature `network` | the image as a whole, 128 x 96 pixels of it | to see what it says alone |
/// | `Both`, with the feature `network` | both; whether by their odds together, the share of a pixel by either, B∞ by the network | for still images: nearer to the water on every set we have, and slower |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum WaterMap {
    /// Signs of water, weighed.
    #[default]
    Rules,
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
        #[cfg(feature = "network")]
        Self::Network,
        #[cfg(feature = "network")]
        Self::Both,
    ];

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rules => "rules",
            #[cfg(feature = "network")]
            Self::Network => "network",
            #[cfg(feature = "network")]
            Self::Both => "both",
        }
    }
}

crate::names::named!(WaterMap, "map of open water");

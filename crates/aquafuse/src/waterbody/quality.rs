//! Whether an estimate can be relied on, and if not, why not.

/// What an estimate is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Verdict {
    /// Nothing speaks against it.
    #[default]
    Good,
    /// Something does: it may be right, look at the image.
    Doubtful,
    /// The image does not show what its water is; the numbers are a guess.
    Failed,
}

/// What speaks against an estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Reason {
    /// No smooth open water was found: the veiling light was read from things, or from corners.
    NoOpenWater,
    /// It is not sure that open water is in view: a smooth thing, night or a lamp may look like it.
    OpenWaterUnsure,
    /// All depths are alike: growth with distance cannot be seen.
    FlatDepth,
    /// Much of the depth lies at one end of its range.
    SaturatedDepth,
    /// The veiling light is no colour of water: red leads, or it is nearly white. Glare, a lamp, the surface.
    LightOutsideWaterHues,
    /// The dark envelope does not follow the curve of backscatter.
    LargeResidual,
    /// Too few dark things: their own light cannot be separated from backscatter.
    FewDarkPixels,
    /// Hardly any red is left: its water, and depth from colour, are not known.
    DeadRed,
    /// The direct signal does not fade along any curve β_D(z) of the model: L_z of the paper is too large.
    AttenuationNotConverged,
    /// Given depth looks inverted: near and far exchanged.
    InvertedDepth,
}

impl Reason {
    /// All reasons, in the order they are reported in.
    pub const ALL: &'static [Self] = &[
        Self::NoOpenWater,
        Self::OpenWaterUnsure,
        Self::FlatDepth,
        Self::SaturatedDepth,
        Self::LightOutsideWaterHues,
        Self::LargeResidual,
        Self::FewDarkPixels,
        Self::DeadRed,
        Self::AttenuationNotConverged,
        Self::InvertedDepth,
    ];

    /// The reason in words, for people.
    pub fn describe(self) -> &'static str {
        match self {
            Self::NoOpenWater => "no open water was found",
            Self::OpenWaterUnsure => "open water is likely, not sure",
            Self::FlatDepth => "all depths are alike",
            Self::SaturatedDepth => "much of the depth lies at one end of its range",
            Self::LightOutsideWaterHues => "the veiling light has no colour of water",
            Self::LargeResidual => "the dark things do not follow the curve of backscatter",
            Self::FewDarkPixels => "too few dark things",
            Self::DeadRed => "hardly any red is left",
            Self::AttenuationNotConverged => "the scene's light fades along no curve of the model",
            Self::InvertedDepth => "the given depth looks inverted",
        }
    }
}

/// A set of [`Reason`]s.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub struct Reasons(u16);

impl Reasons {
    /// Adds a reason where it holds.
    pub(crate) fn add_if(&mut self, holds: bool, reason: Reason) {
        self.0 |= u16::from(holds) << reason as u16;
    }

    /// Whether this is one of them.
    pub fn contains(self, reason: Reason) -> bool {
        self.0 >> reason as u16 & 1 == 1
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Each of them, in the order of [`Reason::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Reason> {
        Reason::ALL.iter().copied().filter(move |reason| self.contains(*reason))
    }
}

impl std::fmt::Debug for Reasons {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_set().entries(self.iter()).finish()
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Reasons {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Reasons {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut reasons = Self::default();
        Vec::<Reason>::deserialize(deserializer)?.into_iter().for_each(|reason| reasons.add_if(true, reason));
        Ok(reasons)
    }
}

/// As it is written to files: the verdict must follow from the reasons.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredQuality {
    verdict: Verdict,
    reasons: Reasons,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredQuality> for Quality {
    type Error = String;

    fn try_from(StoredQuality { verdict, reasons }: StoredQuality) -> Result<Self, String> {
        let quality = Self::of(reasons);
        if quality.verdict == verdict {
            Ok(quality)
        } else {
            Err(format!("the verdict is {verdict}, but these reasons make it {}", quality.verdict))
        }
    }
}

/// A verdict on an estimate, with its reasons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "StoredQuality")
)]
#[non_exhaustive]
pub struct Quality {
    /// What it is worth.
    pub verdict: Verdict,
    /// What speaks against it; empty for a good one.
    pub reasons: Reasons,
}

impl Quality {
    /// This with one more reason.
    #[must_use]
    pub fn with(mut self, reason: Reason) -> Self {
        self.reasons.add_if(true, reason);
        Self::of(self.reasons)
    }

    /// The verdict that follows from these reasons.
    ///
    /// Inverted depth, and flat depth without open water in view, leave nothing to rely on; each other reason
    /// makes doubtful.
    pub(crate) fn of(reasons: Reasons) -> Self {
        let fatal = reasons.contains(Reason::FlatDepth) && reasons.contains(Reason::NoOpenWater)
            || reasons.contains(Reason::InvertedDepth);
        let verdict = match (fatal, reasons.is_empty()) {
            (true, _) => Verdict::Failed,
            (false, true) => Verdict::Good,
            (false, false) => Verdict::Doubtful,
        };
        Self { verdict, reasons }
    }
}

impl Verdict {
    /// All verdicts, from good to bad.
    pub const ALL: &'static [Self] = &[Self::Good, Self::Doubtful, Self::Failed];

    /// The word used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Doubtful => "doubtful",
            Self::Failed => "failed",
        }
    }
}

crate::names::named!(Verdict, "verdict");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_makes_doubtful_and_what_leaves_nothing_makes_failed() {
        assert_eq!(Quality::default().verdict, Verdict::Good);
        for &reason in Reason::ALL {
            let quality = Quality::default().with(reason);
            let expected = if reason == Reason::InvertedDepth { Verdict::Failed } else { Verdict::Doubtful };
            assert_eq!(
                (quality.verdict, quality.reasons.iter().collect::<Vec<_>>()),
                (expected, vec![reason])
            );
        }
        let nothing = Quality::default().with(Reason::NoOpenWater).with(Reason::FlatDepth);
        assert_eq!(nothing.verdict, Verdict::Failed);
    }
}

//! Explanations of the verdicts on an estimate.

use std::fmt::Write;

use aquafuse::waterbody::Reason;

/// The end of `inspect --help`.
pub(crate) fn explained() -> String {
    let mut text = String::from(
        "The verdict is good, doubtful (check the image) or failed (the numbers are a guess). Where it is not good,\n\
         `physical`, `relight` and `exchange` change the image less.\n\
         Reasons for a verdict, and remedies:\n",
    );
    for &reason in Reason::ALL {
        let _ = write!(text, "\n  {}:\n      {}", reason.describe(), meant(reason));
    }
    text
}

fn meant(reason: Reason) -> &'static str {
    match reason {
        Reason::NoOpenWater => {
            "B∞ comes from objects that look most like water. Use an image of the same dive that shows open water"
        }
        Reason::OpenWaterUnsure => {
            "what looks like open water may be a smooth object, a dark background or the night. Check it with --plots"
        }
        Reason::FlatDepth => {
            "no effect of distance can be measured. Use an image of near and far objects, or give --depth"
        }
        Reason::SaturatedDepth => {
            "depth from colour exceeds its range. Try another --depth-model, or give --depth"
        }
        Reason::LightOutsideWaterHues => {
            "it is reddish or nearly white: glare, a lamp or the surface was mistaken for water"
        }
        Reason::LargeResidual => {
            "depth is wrong, or a lamp lights near objects. Try another --depth-model, or give --depth"
        }
        Reason::FewDarkPixels => {
            "backscatter cannot be separated from the colours of the objects: β_B is uncertain"
        }
        Reason::DeadRed => "red depth and water are unknown; the change of red is limited",
        Reason::AttenuationNotConverged => {
            "β_D is uncertain. This matters only for `restore` and --model exchange"
        }
        Reason::InvertedDepth => "near and far look swapped. Check --depth-kind",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_is_explained() {
        assert!(Reason::ALL.iter().copied().all(|reason| !meant(reason).is_empty()));
        assert!(explained().ends_with(meant(Reason::ALL[Reason::ALL.len() - 1])));
    }
}

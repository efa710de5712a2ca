//! The verdicts on an estimate, explained.

use std::fmt::Write;

use aquafuse::waterbody::Reason;

/// What `inspect --help` ends with.
pub(crate) fn explained() -> String {
    let mut text = String::from(
        "The verdict is good, doubtful (it may be right: look at the image) or failed (the numbers are a guess).\n\
         What may speak against an estimate, and what helps:\n",
    );
    for &reason in Reason::ALL {
        let _ = write!(text, "\n  {}:\n      {}", reason.describe(), meant(reason));
    }
    text
}

fn meant(reason: Reason) -> &'static str {
    match reason {
        Reason::NoOpenWater => {
            "B∞ was read from the farthest things, or from corners. Take an image of the same dive that shows open water"
        }
        Reason::FlatDepth => {
            "nothing can be told to grow with distance. Take an image of near and far things, or give --depth"
        }
        Reason::SaturatedDepth => {
            "depth from colour ran out of its range. Try another --depth-model, or give --depth"
        }
        Reason::LightOutsideWaterHues => {
            "red leads, or it is nearly white: glare, a lamp or the surface was taken for water"
        }
        Reason::LargeResidual => {
            "depth is wrong, or a lamp lights what is near. Try another --depth-model, or give --depth"
        }
        Reason::FewDarkPixels => {
            "what backscatter adds cannot be told from what things are: β_B is uncertain"
        }
        Reason::DeadRed => {
            "its water, and depth from colour, are not known; what is painted in red is bounded"
        }
        Reason::AttenuationNotConverged => {
            "β_D is uncertain, which matters to `restore` and --model exchange alone"
        }
        Reason::InvertedDepth => "near and far look exchanged. Check --depth-kind",
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

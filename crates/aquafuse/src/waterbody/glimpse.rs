//! What the network saw in one frame, kept for those after it: it says where water is, which changes slowly.

#[cfg(feature = "network")]
use crate::image::{ImageRef, TopEdge};
#[cfg(feature = "network")]
use crate::network::Sight;

/// Frames of one scene after which the network looks again: a third of a second of video. Its 2 ms then cost a quarter of one a frame.
const EVERY: usize = 8;

/// What the network saw last.
#[derive(Clone, Debug, Default)]
pub(crate) struct Glimpse {
    #[cfg(feature = "network")]
    sight: Option<Sight>,
    /// Frames that it has been used for.
    age: usize,
}

impl Glimpse {
    /// Another image comes: of the same scene as the one before it, or not.
    pub(crate) fn next(&mut self, is_same_scene: bool) {
        if !is_same_scene || self.age == EVERY {
            *self = Self::default();
        }
        self.age += 1;
    }

    /// What it sees in this image, or saw in the one that it looked at last.
    #[cfg(feature = "network")]
    pub(super) fn sight(&mut self, image: ImageRef<'_, u8>, top: TopEdge) -> &Sight {
        self.sight.get_or_insert_with(|| Sight::of(image, top))
    }
}

#[cfg(all(test, feature = "network"))]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::truth::{Scene, Size, waters};

    #[test]
    fn it_looks_at_the_first_frame_at_each_eighth_and_at_another_scene() {
        let frames: Vec<Image<u8>> = (0..20)
            .map(|seed| {
                let scene = Scene::new(seed, Size { width: 64, height: 48 });
                scene.seen_through(&waters()[0].water).convert()
            })
            .collect();
        let mut glimpse = Glimpse::default();
        let mut seen = |frame: usize, is_same_scene: bool| {
            glimpse.next(is_same_scene);
            glimpse.sight(frames[frame].view(), TopEdge::First).clone()
        };
        let by_itself = |frame: usize| Sight::of(&frames[frame], TopEdge::First);
        let first = seen(0, false);
        assert_eq!(first, by_itself(0));
        (1..8).for_each(|frame| assert_eq!(seen(frame, true), first));
        assert_eq!(seen(8, true), by_itself(8));
        assert_eq!(seen(9, true), by_itself(8));
        assert_eq!(seen(10, false), by_itself(10));
        assert_eq!(seen(11, false), by_itself(11));
    }
}

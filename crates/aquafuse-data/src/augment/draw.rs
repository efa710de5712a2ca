//! Which water, θ and α each variant has.

use sha2::{Digest, Sha256};

/// What is drawn for one variant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// Which of the waters.
    pub water: usize,
    /// The number of the water, if that one is [the sea](super::Sea).
    pub sea: u32,
    /// θ, in degrees.
    pub theta: f32,
    /// α.
    pub alpha: f32,
    /// How often the variant was drawn before.
    pub redrawn: u32,
}

/// How draws are made. Each depends on the seed, the image's key and the variant's number alone: not on threads, on
/// order, nor on which other images there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draws {
    /// The seed.
    pub seed: u64,
    /// Whether a water may come again before every other has come.
    pub with_replacement: bool,
    /// The least θ and the greatest, in degrees.
    pub theta: (f32, f32),
    /// The least α and the greatest.
    pub alpha: (f32, f32),
}

/// What a number is drawn for.
#[derive(Clone, Copy)]
enum Purpose {
    Water,
    Theta,
    Alpha,
    Shard,
    Sea,
    Keep,
}

impl Draws {
    /// What variant `number` of the image of a key is made with, of so many waters.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse_data::augment::Draws;
    ///
    /// let draws = Draws { seed: 7, with_replacement: false, theta: (0.0, 60.0), alpha: (1.0, 1.0) };
    /// let waters: Vec<usize> = (0..3).map(|number| draws.draw("reef.jpg", number, 3).water).collect();
    /// // Without replacement every water comes once before any comes again.
    /// assert!((0..3).all(|water| waters.contains(&water)));
    /// assert_eq!(draws.draw("reef.jpg", 1, 3), draws.draw("reef.jpg", 1, 3));
    /// ```
    pub fn draw(&self, key: &str, number: u32, waters: usize) -> Draw {
        self.redraw(key, number, waters, 0)
    }

    /// What the variant is made with if `redrawn` draws before were no good. The water stays whose turn it is; the number of a
    /// water from [the sea](super::Sea), θ and α are others.
    pub fn redraw(&self, key: &str, number: u32, waters: usize, redrawn: u32) -> Draw {
        let between = |(low, high): (f32, f32), purpose| {
            // 24 bits, as many as the float has.
            let share = (self.number(purpose, key, number, redrawn) >> 40) as f32 / (1_u32 << 24) as f32;
            low + (high - low) * share
        };
        let water = match self.with_replacement {
            true => below(self.number(Purpose::Water, key, number, 0), waters),
            false => self.shuffled(key, number, waters),
        };
        let sea = (self.number(Purpose::Sea, key, number, redrawn) >> 32) as u32;
        let (theta, alpha) = (between(self.theta, Purpose::Theta), between(self.alpha, Purpose::Alpha));
        Draw { water, sea, theta, alpha, redrawn }
    }

    /// Whether θ and α are the same in every draw.
    pub(super) fn are_fixed(&self) -> bool {
        self.theta.0 == self.theta.1 && self.alpha.0 == self.alpha.1
    }

    /// Whether the image of a key is copied beside its variants, of which there are `per_image`, so that `share` of all images
    /// written are copies. There is at most one copy of an image: above `per_image` / (`per_image` + 1) every image is copied.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse_data::augment::Draws;
    ///
    /// let draws = Draws { seed: 7, with_replacement: false, theta: (0.0, 0.0), alpha: (1.0, 1.0) };
    /// // Three variants and the image: a quarter of the four are copies.
    /// assert!(draws.keeps("reef.jpg", 3, 0.25));
    /// assert!(!draws.keeps("reef.jpg", 3, 0.0));
    /// ```
    pub fn keeps(&self, key: &str, per_image: u32, share: f64) -> bool {
        // 53 bits, as many as the float has.
        let at = (self.number(Purpose::Keep, key, 0, 0) >> 11) as f64 / (1_u64 << 53) as f64;
        // Of n variants and p copies of an image p / (n + p) are copies.
        at * (1.0 - share) < f64::from(per_image) * share
    }

    /// The water of a variant where all come once, in an order of the image's own, before they come again in another.
    fn shuffled(&self, key: &str, number: u32, waters: usize) -> usize {
        let many = u32::try_from(waters).unwrap_or(u32::MAX);
        let (Some(round), Some(place)) = (number.checked_div(many), number.checked_rem(many)) else {
            return 0;
        };
        let mut left: Vec<usize> = (0..waters).collect();
        let mut taken = 0;
        for turn in 0..=place {
            taken = left.swap_remove(below(self.number(Purpose::Water, key, round, turn), left.len()));
        }
        taken
    }

    /// Which of `shards` parts of a dataset an image belongs to. All seeds share them.
    pub fn shard(key: &str, shards: u32) -> u32 {
        let number = Self { seed: 0, with_replacement: false, theta: (0.0, 0.0), alpha: (0.0, 0.0) }.number(
            Purpose::Shard,
            key,
            0,
            0,
        );
        u32::try_from(number.checked_rem(shards.into()).unwrap_or(0)).unwrap_or(0)
    }

    /// 64 bits of a digest of everything that they depend on.
    fn number(&self, purpose: Purpose, key: &str, number: u32, turn: u32) -> u64 {
        let mut digest = Sha256::new();
        digest.update(b"aquafuse draw 1");
        digest.update([purpose as u8]);
        digest.update(self.seed.to_le_bytes());
        digest.update(number.to_le_bytes());
        digest.update(turn.to_le_bytes());
        digest.update(key);
        let mut first = [0; 8];
        for (byte, digit) in first.iter_mut().zip(digest.finalize()) {
            *byte = digit;
        }
        u64::from_le_bytes(first)
    }
}

/// A number below `most`, as uniform as 64 bits allow.
fn below(number: u64, most: usize) -> usize {
    let scaled = u128::from(number).saturating_mul(most as u128) >> 64;
    usize::try_from(scaled).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRAWS: Draws = Draws { seed: 3, with_replacement: false, theta: (10.0, 50.0), alpha: (0.5, 1.5) };

    #[test]
    fn every_water_comes_as_often_as_any_other() {
        let mut counts = [[0; 4]; 2];
        for (with_replacement, counts) in [false, true].into_iter().zip(&mut counts) {
            let draws = Draws { with_replacement, ..DRAWS };
            for image in 0..2000 {
                for number in 0..4 {
                    counts[draws.draw(&format!("{image}.jpg"), number, 4).water] += 1;
                }
            }
        }
        assert_eq!(counts[0], [2000; 4]);
        // Five standard deviations of a binomial of 8,000.
        assert!(counts[1].iter().all(|&count: &i32| (count - 2000).abs() < 194), "{:?}", counts[1]);
    }

    #[test]
    fn orders_of_waters_are_even() {
        let mut firsts = [0; 3];
        for image in 0..3000 {
            firsts[DRAWS.draw(&format!("{image}"), 0, 3).water] += 1;
        }
        assert!(firsts.iter().all(|&count: &i32| (count - 1000).abs() < 130), "{firsts:?}");
    }

    #[test]
    fn ranges_are_kept_and_filled() {
        let thetas: Vec<f32> = (0..1000).map(|number| DRAWS.draw("a", number, 1).theta).collect();
        assert!(thetas.iter().all(|theta| (10.0..=50.0).contains(theta)));
        let mean = thetas.iter().sum::<f32>() / 1000.0;
        // Five standard errors of a uniform law of width 40.
        assert!((mean - 30.0).abs() < 1.83, "{mean}");
        assert!(thetas.iter().any(|theta| *theta < 11.0) && thetas.iter().any(|theta| *theta > 49.0));
    }

    #[test]
    fn seed_key_and_number_each_matter() {
        let drawn = DRAWS.draw("a.jpg", 0, 5);
        assert_ne!(drawn.theta, DRAWS.draw("b.jpg", 0, 5).theta);
        assert_ne!(drawn.theta, DRAWS.draw("a.jpg", 1, 5).theta);
        assert_ne!(drawn.theta, Draws { seed: 4, ..DRAWS }.draw("a.jpg", 0, 5).theta);
    }

    #[test]
    fn a_redraw_keeps_the_water_and_draws_the_rest_again() {
        for number in 0..20 {
            let drawn: Vec<Draw> = (0..4).map(|times| DRAWS.redraw("a.jpg", number, 5, times)).collect();
            assert_eq!(drawn[0], DRAWS.draw("a.jpg", number, 5));
            assert!(drawn.iter().all(|draw| draw.water == drawn[0].water));
            for pair in drawn.windows(2) {
                assert!(pair[0].sea != pair[1].sea && pair[0].theta != pair[1].theta, "{pair:?}");
            }
        }
    }

    #[test]
    fn a_share_of_what_is_written_are_copies() {
        for (per_image, share, wanted) in [
            (1, 0.25, 1.0_f64 / 3.0),
            (2, 0.25, 2.0 / 3.0),
            (3, 0.25, 1.0),
            (9, 0.25, 1.0),
            (1, 0.0, 0.0),
            (1, 0.2, 0.25),
            (4, 1.0, 1.0),
        ] {
            let keeps = |image: &u32| DRAWS.keeps(&format!("{image}.jpg"), per_image, share);
            let count = (0..3000).filter(keeps).count() as f64;
            // Five standard deviations of a binomial.
            let spread = 5.0 * (3000.0 * wanted * (1.0 - wanted)).sqrt();
            assert!((count - 3000.0 * wanted).abs() <= spread, "{per_image} at {share}: {count}");
        }
    }

    #[test]
    fn these_draws_stay_what_they_are() {
        // A change here breaks every manifest that was written: it needs another name in the digest.
        let drawn: Vec<(usize, f32, f32)> = (0..3)
            .map(|number| DRAWS.draw("images/reef.jpg", number, 3))
            .map(|draw| (draw.water, draw.theta, draw.alpha))
            .collect();
        assert_eq!(drawn, FIXED);
        let other = DRAWS.redraw("images/reef.jpg", 0, 3, 1);
        assert_eq!((other.sea, other.theta), FIXED_REDRAW);
    }

    const FIXED_REDRAW: (u32, f32) = (2_490_252_296, 19.6664);

    const FIXED: [(usize, f32, f32); 3] =
        [(1, 42.105637, 0.6857983), (2, 46.238686, 1.3221126), (0, 47.172226, 1.2026781)];

    #[test]
    fn shards_share_the_images_out() {
        let mut counts = [0; 3];
        for image in 0..3000 {
            counts[Draws::shard(&format!("{image}.jpg"), 3) as usize] += 1;
        }
        assert!(counts.iter().all(|&count: &i32| (count - 1000).abs() < 130), "{counts:?}");
    }
}

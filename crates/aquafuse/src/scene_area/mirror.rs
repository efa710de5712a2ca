//! Fills what does not show the scene: the scene, mirrored at its outline.

use crate::image::{Encoding, Image, Sample};

/// Fills the pixels of `scene` that are not `shown`: in each row from the pixels of that row, then whole rows from other
/// rows.
pub(super) fn fill<T: Sample, E: Encoding>(scene: &mut Image<T, E>, shown: &[bool]) {
    let (width, _) = scene.size();
    let pixels = scene.pixels_mut();
    for (row, shown) in pixels.chunks_mut(width).zip(shown.chunks(width)) {
        if shown.contains(&false) && shown.contains(&true) {
            let filled: Vec<[T; 3]> =
                sources(shown).into_iter().map(|[a, b]| between(row[a], row[b])).collect();
            row.copy_from_slice(&filled);
        }
    }
    let rows: Vec<bool> = shown.chunks(width).map(|row| row.contains(&true)).collect();
    for (y, [above, below]) in sources(&rows).into_iter().enumerate().filter(|&(y, _)| !rows[y]) {
        for x in 0..width {
            pixels[y * width + x] = between(pixels[above * width + x], pixels[below * width + x]);
        }
    }
}

/// The mean of two pixels, rounded; halves go up.
fn between<T: Sample>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    if a == b {
        return a;
    }
    [0, 1, 2].map(|c| T::from_steps((a[c].to_steps() + b[c].to_steps()).div_ceil(2)))
}

/// Where each place of a line takes its value from: from itself if it is shown, else from its mirror image at the nearer
/// end of its gap. The middle of a gap is as near to both ends and takes their mean.
fn sources(shown: &[bool]) -> Vec<[usize; 2]> {
    let mut ends = vec![0];
    ends.extend(shown.chunk_by(|a, b| a == b).scan(0, |end, run| {
        *end += run.len();
        Some(*end)
    }));
    let mut sources = Vec::with_capacity(shown.len());
    for (r, run) in ends.windows(2).enumerate() {
        let (from, to) = (run[0], run[1]);
        for i in from..to {
            let (after, ahead) = (i - from, to - 1 - i);
            let left = r.checked_sub(1).map(|r| from - 1 - there_and_back(after, from - ends[r]));
            let right = ends.get(r + 2).map(|end| to + there_and_back(ahead, end - to));
            sources.push(match (left, right) {
                _ if shown[i] => [i; 2],
                (Some(left), Some(right)) if after == ahead => [left, right],
                (Some(left), Some(_)) if after < ahead => [left; 2],
                (Some(_), Some(right)) => [right; 2],
                (Some(only), None) | (None, Some(only)) => [only; 2],
                (None, None) => [i; 2],
            });
        }
    }
    sources
}

/// The place after so many steps along a run of places, turning round at either end.
fn there_and_back(steps: usize, length: usize) -> usize {
    let place = steps % (2 * length);
    if place < length { place } else { 2 * length - 1 - place }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(row: &[u8], shown: &[bool], width: usize) -> Vec<u8> {
        let samples = row.iter().flat_map(|&grey| [grey; 3]).collect();
        let mut image = Image::<u8>::from_raw(width, row.len() / width, samples).unwrap();
        fill(&mut image, shown);
        image.pixels().iter().map(|pixel| pixel[0]).collect()
    }

    #[test]
    fn a_gap_is_filled_by_the_mirror_images_of_its_neighbours() {
        let [o, i] = [false, true];
        assert_eq!(filled(&[0, 0, 0, 7, 8, 9], &[o, o, o, i, i, i], 6), [9, 8, 7, 7, 8, 9]);
        // A run shorter than the gap is gone along there and back.
        assert_eq!(filled(&[1, 2, 0, 0, 0, 0], &[i, i, o, o, o, o], 6), [1, 2, 2, 1, 1, 2]);
        // The middle takes the mean of both.
        assert_eq!(filled(&[1, 2, 0, 0, 0, 9], &[i, i, o, o, o, i], 6), [1, 2, 2, 5, 9, 9]);
    }

    #[test]
    fn rows_without_scene_are_filled_from_other_rows() {
        let [o, i] = [false, true];
        assert_eq!(filled(&[1, 2, 0, 0, 3, 0], &[i, i, o, o, i, o], 2), [1, 2, 2, 3, 3, 3]);
    }
}

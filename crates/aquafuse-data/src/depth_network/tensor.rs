//! An image as numbers for a network, and a network's numbers as a depth map.

use aquafuse::depth::{Supplied, SuppliedKind};
use aquafuse::image::TopEdge;

use super::NetworkKind;
use super::preset::{Colours, Unfit};

/// Mean and deviation of red, green and blue, from 0 to 1, over the photographs of ImageNet.
const MEAN: [f32; 3] = [0.485, 0.456, 0.406];
const DEVIATION: [f32; 3] = [0.229, 0.224, 0.225];

/// Turns rows of values so that the edge `top` is the first row; `back` undoes it.
pub(super) fn turned<T: Copy>(
    values: &[T],
    (width, height): (usize, usize),
    top: TopEdge,
    back: bool,
) -> (Vec<T>, (usize, usize)) {
    let size = match top {
        TopEdge::First | TopEdge::Last => (width, height),
        TopEdge::Left | TopEdge::Right => (height, width),
    };
    // The turn by which the left edge is up, and the one by which the right edge is, undo each other.
    let top = match (top, back) {
        (TopEdge::Left, true) => TopEdge::Right,
        (TopEdge::Right, true) => TopEdge::Left,
        (other, _) => other,
    };
    let (right, bottom) = (width.saturating_sub(1), height.saturating_sub(1));
    let mut turned = Vec::with_capacity(values.len());
    for y in 0..size.1 {
        for x in 0..size.0 {
            let (from_x, from_y) = match top {
                TopEdge::First => (x, y),
                TopEdge::Last => (right.saturating_sub(x), bottom.saturating_sub(y)),
                TopEdge::Left => (y, bottom.saturating_sub(x)),
                TopEdge::Right => (right.saturating_sub(y), x),
            };
            turned.extend(values.get(from_y.saturating_mul(width).saturating_add(from_x)));
        }
    }
    (turned, size)
}

/// Channel by channel, as the network takes colours.
pub(super) fn numbers(pixels: &[[u8; 3]], colours: Colours) -> Vec<f32> {
    let channel = |(c, (mean, deviation)): (usize, (f32, f32))| {
        pixels.iter().filter_map(move |pixel| pixel.get(c)).map(move |&value| match colours {
            Colours::ImageNet => (f32::from(value) / 255.0 - mean) / deviation,
            Colours::Unit => f32::from(value) / 255.0,
            Colours::Bytes => f32::from(value),
        })
    };
    MEAN.into_iter().zip(DEVIATION).enumerate().flat_map(channel).collect()
}

/// Columns and rows of an output: what is left of its shape without sides of 1.
pub(super) fn size_of(shape: &[usize]) -> Result<(usize, usize), Unfit> {
    let sides: Vec<usize> = shape.iter().copied().filter(|side| *side != 1).collect();
    match sides.as_slice() {
        &[rows, columns] if shape.len() <= 4 && rows > 0 && columns > 0 => Ok((columns, rows)),
        _ => {
            let shape = shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(" x ");
            let remedy = "Export the network again with one number for each pixel: 1 x height x width, or 1 x 1 x height x width";
            Err((format!("its output is {shape}"), remedy.into()))
        }
    }
}

/// Negative distances that a metric network may have near 0.
const FEW: f64 = 0.01;

/// The numbers of a network as a depth map.
pub(super) fn supplied(
    mut values: Vec<f32>,
    (width, height): (usize, usize),
    kind: NetworkKind,
) -> Result<Supplied, Unfit> {
    let bad = values.iter().filter(|value| !value.is_finite()).count();
    if bad > 0 {
        let remedy =
            "The file may be damaged, or of half precision: get it again, or export it in 32-bit floats";
        return Err((
            format!("{bad} of the {} numbers of its output are not finite", values.len()),
            remedy.into(),
        ));
    }
    let least = values.iter().copied().fold(f32::INFINITY, f32::min);
    let most = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    if least >= most {
        let remedy = "Check that it is the right file, and that its weights are in it";
        return Err((format!("every number of its output is {least}"), remedy.into()));
    }
    let negative = values.iter().filter(|value| **value < 0.0).count() as f64 / values.len() as f64;
    if kind != NetworkKind::Inverse && negative > FEW {
        let cause = format!("{:.0} % of its distances are negative", 100.0 * negative);
        return Err((cause, "If larger is nearer, add --depth-model-kind inverse".into()));
    }
    let (kind, range) = match kind {
        NetworkKind::Metric => (SuppliedKind::Metres, 1.0),
        NetworkKind::Relative => (SuppliedKind::Relative, most),
        NetworkKind::Inverse => {
            // Of unknown shift: below 0 is no other number than above.
            values.iter_mut().for_each(|value| *value -= least);
            (SuppliedKind::Inverse, 1.0)
        }
    };
    let map = Supplied::new(width, height, values, kind).expect("a value for each column of each row");
    Ok(map.with_full_range(range))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_is_turned_upright_and_back() {
        // 1 2 3
        // 4 5 6
        let values = [1, 2, 3, 4, 5, 6];
        let cases = [
            (TopEdge::First, vec![1, 2, 3, 4, 5, 6]),
            (TopEdge::Last, vec![6, 5, 4, 3, 2, 1]),
            // The left edge, from below, becomes the first row.
            (TopEdge::Left, vec![4, 1, 5, 2, 6, 3]),
            (TopEdge::Right, vec![3, 6, 2, 5, 1, 4]),
        ];
        for (top, expected) in cases {
            let (upright, size) = turned(&values, (3, 2), top, false);
            assert_eq!(upright, expected, "{top:?}");
            assert_eq!(turned(&upright, size, top, true), (values.to_vec(), (3, 2)), "{top:?}");
        }
    }
}

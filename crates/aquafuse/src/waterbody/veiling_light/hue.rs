//! Which colours can be water.

/// Whether a colour can be open water, by its green and blue alone.
///
/// The paper filters "non-background colors within the bluish-green range, ignoring the red channel" and
/// gives no rule. Ours: not black (the larger of the two is at least 1/16: below is night or shadow, not
/// water), not blown out (the smaller is below 15/16: lamps, white boards, the sun), and neither channel
/// under 1/8 of the other (purer green or blue is paint or a plant; water of one hue still scatters both).
pub(super) fn is_bluish_green(&[_, green, blue]: &[u8; 3]) -> bool {
    let (low, high) = (green.min(blue), green.max(blue));
    high >= 16 && low < 240 && low >= high / 8
}

//! Bytes as text (RFC 4648), for pages that need nothing else.

/// Bytes as letters, three as four.
pub fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let letter = |bits: u32| LETTERS.get((bits & 63) as usize).copied().map_or('=', char::from);
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let byte = |i: usize| three.get(i).copied().map_or(0, u32::from);
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        let filled = |i: usize, shift: u32| if i < three.len() { letter(bits >> shift) } else { '=' };
        text.extend([letter(bits >> 18), letter(bits >> 12), filled(1, 6), filled(2, 0)]);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        // Checked with Python's own.
        let cases: [(&[u8], &str); 5] = [
            (&[], ""),
            (&[255], "/w=="),
            (&[255, 254], "//4="),
            (&[251, 239, 190], "++++"),
            (&[0, 1, 2, 3], "AAECAw=="),
        ];
        for (bytes, expected) in cases {
            assert_eq!(base64(bytes), expected);
        }
    }
}

//! Files as text: UTF-8, or what a byte order mark says.

use std::borrow::Cow;

use encoding_rs::Encoding;

/// The text of a file, without its byte order mark; `None` where it is neither UTF-8 nor what its mark says.
pub(crate) fn text_of(bytes: &[u8]) -> Option<Cow<'_, str>> {
    match Encoding::for_bom(bytes) {
        Some((encoding, mark)) => decoded(encoding, bytes.get(mark..)?),
        None => std::str::from_utf8(bytes).ok().map(Cow::Borrowed),
    }
}

/// The text of bytes in an encoding, if all of them are text there.
pub(crate) fn decoded<'a>(encoding: &'static Encoding, bytes: &'a [u8]) -> Option<Cow<'a, str>> {
    encoding.decode_without_bom_handling_and_without_replacement(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_say_the_encoding_and_are_no_text() {
        assert_eq!(text_of(b"\xef\xbb\xbf\xc3\xa4"), Some("ä".into()));
        assert_eq!(text_of(b"\xff\xfea\0\xe4\0"), Some("aä".into()));
        assert_eq!(text_of(b"\xfe\xff\0a"), Some("a".into()));
        assert_eq!(text_of(b"\xe4"), None);
        // Half a character.
        assert_eq!(text_of(b"\xff\xfea"), None);
    }
}

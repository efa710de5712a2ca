//! File names, and content of files, in messages.

use std::fmt::{self, Write};
use std::path::Path;

/// Most characters of a message's part that is not ours: more than any name has, fewer than fill a screen.
const MOST: usize = 1_000;

/// A file name as it is shown to people: on one line whatever it holds.
///
/// Control characters, and those that turn the direction of text, are escaped, so that no name can break a message, hide
/// itself or move a terminal's cursor; bytes that are not UTF-8 become `\xff`. A very long name is cut.
///
/// # Examples
///
/// ```
/// use aquafuse_data::files::display;
///
/// assert_eq!(display("two\nlines.png".as_ref()).to_string(), "two\\nlines.png");
/// ```
pub fn display(path: &Path) -> impl fmt::Display + '_ {
    OneLine(path.as_os_str().as_encoded_bytes())
}

/// What others wrote, as it is shown to people: on one line, for it may quote a file.
pub fn one_line(said: &str) -> String {
    OneLine(said.trim().as_bytes()).to_string()
}

/// JSON as it is shown to people and programs alike: characters that move a terminal or turn the direction of text are
/// escaped as JSON does, so that it means the same.
pub fn plain_json(json: &str) -> String {
    let mut plain = String::with_capacity(json.len());
    for character in json.chars() {
        if turns_text(character) || (character.is_control() && character != '\n') {
            // None of them is beyond 16 bits.
            let _ = write!(plain, "\\u{:04x}", u32::from(character));
        } else {
            plain.push(character);
        }
    }
    plain
}

struct OneLine<'a>(&'a [u8]);

impl fmt::Display for OneLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut left = MOST;
        for chunk in self.0.utf8_chunks() {
            for character in chunk.valid().chars() {
                left = match left.checked_sub(1) {
                    Some(left) => left,
                    None => return f.write_char('…'),
                };
                match character {
                    _ if character.is_control() => write!(f, "{}", character.escape_default())?,
                    _ if turns_text(character) => write!(f, "{}", character.escape_unicode())?,
                    _ => f.write_char(character)?,
                }
            }
            for byte in chunk.invalid() {
                write!(f, "\\x{byte:02x}")?;
            }
        }
        Ok(())
    }
}

/// Whether a character changes the direction of the text around it.
fn turns_text(character: char) -> bool {
    matches!(character, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_is_not_ours_moves_a_terminal() {
        assert_eq!(one_line("\u{1b}[31mred\u{202e}gpj"), "\\u{1b}[31mred\\u{202e}gpj");
        assert_eq!(one_line(&"a".repeat(5_000_000)).chars().count(), MOST + 1);
    }

    #[cfg(unix)]
    #[test]
    fn json_means_the_same_and_moves_no_terminal() {
        let named = |name: &str| serde_json::json!({ "name": name, "more": [1, null] }).to_string() + "\n";
        for name in ["a.jpg", "\u{202e}gpj.a", "\u{9b}31m", "\u{1b}[31m", "ä\u{2066}"] {
            let plain = plain_json(&named(name));
            assert!(plain.trim_end().chars().all(|c| !c.is_control() && !turns_text(c)), "{plain:?}");
            let read: serde_json::Value = serde_json::from_str(&plain).unwrap();
            assert_eq!(read["name"], name);
        }
    }

    #[test]
    fn names_that_are_no_text_stay_apart() {
        use std::os::unix::ffi::OsStrExt;
        let shown = |bytes: &'static [u8]| display(std::ffi::OsStr::from_bytes(bytes).as_ref()).to_string();
        assert_eq!((shown(b"a\xff.jpg"), shown(b"a\xfe.jpg")), ("a\\xff.jpg".into(), "a\\xfe.jpg".into()));
    }
}

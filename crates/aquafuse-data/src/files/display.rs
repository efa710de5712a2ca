//! File names, and content of files, in messages.

use std::borrow::Cow;
use std::fmt::{self, Write};
use std::path::Path;

/// A file name as it is shown to people: on one line whatever it holds.
///
/// Control characters are escaped, so that no name can break a message, hide itself or move a terminal's cursor;
/// what is not UTF-8 becomes `\u{fffd}`.
///
/// # Examples
///
/// ```
/// use aquafuse_data::files::display;
///
/// assert_eq!(display("two\nlines.png".as_ref()).to_string(), "two\\nlines.png");
/// ```
pub fn display(path: &Path) -> impl fmt::Display + '_ {
    OneLine(path.to_string_lossy())
}

/// What a decoder says, as it is shown to people: on one line, for it may quote the file.
pub(crate) fn one_line(said: &str) -> String {
    OneLine(said.trim().into()).to_string()
}

struct OneLine<'a>(Cow<'a, str>);

impl fmt::Display for OneLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars() {
            if character.is_control() {
                write!(f, "{}", character.escape_default())?;
            } else {
                f.write_char(character)?;
            }
        }
        Ok(())
    }
}

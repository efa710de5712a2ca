//! What a person may have meant whose arguments are refused, where the parser cannot know.

use std::ffi::OsString;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, Error, ErrorKind};

/// A tip for refused arguments, of which the first is the name of the program.
pub(crate) fn tip(arguments: &[OsString], refusal: &Error) -> Option<&'static str> {
    let command = arguments.get(1).and_then(|command| command.to_str()).unwrap_or_default();
    let about = |kind: ContextKind, said: &str| {
        refusal.get(kind).is_some_and(|value| match value {
            ContextValue::String(value) => value.contains(said),
            ContextValue::Strings(values) => values.iter().any(|value| value.contains(said)),
            _ => false,
        })
    };
    match (refusal.kind(), command) {
        (ErrorKind::MissingRequiredArgument, "fuse") if about(ContextKind::InvalidArg, "CONTENT") => {
            Some("WATER comes last: the image whose water the others take, a water file or preset:NAME")
        }
        (ErrorKind::MissingRequiredArgument, "augment") if about(ContextKind::InvalidArg, "WATERS") => {
            Some("without waters of your own, --waters sea draws them")
        }
        (ErrorKind::UnknownArgument, "fuse" | "crossover" | "augment")
            if about(ContextKind::InvalidArg, "--strength") =>
        {
            Some("the strength of a fusion is --theta: 0 is the whole change, 90 none")
        }
        (ErrorKind::UnknownArgument, "enhance" | "restore") if is_name(refusal) => {
            Some("for several images, give their folder")
        }
        (ErrorKind::InvalidSubcommand, name) if Path::new(name).exists() => {
            Some("name a command first: `aquafuse fuse CONTENT WATER -o OUTPUT` puts CONTENT into WATER")
        }
        _ => None,
    }
}

/// Whether what is not known is a name, and no option.
fn is_name(refusal: &Error) -> bool {
    matches!(refusal.get(ContextKind::InvalidArg), Some(ContextValue::String(name)) if !name.starts_with('-'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser as _;

    fn tip_for(arguments: &[&str]) -> Option<&'static str> {
        let arguments: Vec<OsString> = arguments.iter().map(OsString::from).collect();
        let refusal = crate::Cli::try_parse_from(&arguments).err()?;
        tip(&arguments, &refusal)
    }

    #[test]
    fn a_forgotten_water_is_asked_for() {
        assert!(
            tip_for(&["aquafuse", "fuse", "a.jpg", "-o", "b.jpg"]).is_some_and(|tip| tip.contains("WATER"))
        );
        assert_eq!(tip_for(&["aquafuse", "fuse", "a.jpg", "b.jpg", "-o", "c.jpg"]), None);
        assert_eq!(
            tip_for(&["aquafuse", "fuse", "a.jpg", "b.jpg"]),
            None,
            "the parser says that --output is missing"
        );
        assert!(tip_for(&["aquafuse", "augment", "fish/", "-o", "x"]).is_some_and(|tip| tip.contains("sea")));
    }

    #[test]
    fn options_and_commands_of_others_are_named() {
        let strength = ["aquafuse", "fuse", "a.jpg", "b.jpg", "-o", "c.jpg", "--strength", "0.5"];
        assert!(tip_for(&strength).is_some_and(|tip| tip.contains("--theta")));
        assert!(tip_for(&["aquafuse", "Cargo.toml", "b.jpg"]).is_some_and(|tip| tip.contains("fuse")));
        assert_eq!(tip_for(&["aquafuse", "not-there.jpg"]), None);
        let three = ["aquafuse", "enhance", "a.jpg", "b.jpg", "c.jpg", "-o", "d.jpg"];
        assert!(tip_for(&three).is_some_and(|tip| tip.contains("folder")));
        assert_eq!(tip_for(&["aquafuse", "restore", "a.jpg", "-o", "b.jpg", "--nonsense"]), None);
    }
}

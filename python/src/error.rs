//! Errors of the libraries as the exceptions that `aquafuse._errors` defines.

use std::fmt::Display;

use aquafuse::NameError;
use aquafuse::depth::SuppliedError;
use aquafuse::fusion::OptionError;
use aquafuse::image::ImageError;
use aquafuse::scene_area::BorderError;
use aquafuse::waterbody::AttenuationError;
use aquafuse_data::files::FileError;
use aquafuse_data::pipeline::OperationError;
use aquafuse_data::water_file::WaterFileError;
use pyo3::prelude::*;

/// Which exception an error becomes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    Argument,
    Array,
    File,
    Run,
    Internal,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Argument => "ArgumentError",
            Self::Array => "ArrayError",
            Self::File => "FileError",
            Self::Run => "RunError",
            Self::Internal => "InternalError",
        }
    }
}

/// An error that has not reached Python yet: it can be made without the GIL.
#[derive(Debug)]
pub(crate) struct Fault {
    kind: Kind,
    message: String,
}

impl Fault {
    pub(crate) fn argument(message: impl Display) -> Self {
        Self { kind: Kind::Argument, message: message.to_string() }
    }

    pub(crate) fn array(message: impl Display) -> Self {
        Self { kind: Kind::Array, message: message.to_string() }
    }

    fn file(message: impl Display) -> Self {
        Self { kind: Kind::File, message: in_python(&message.to_string()) }
    }

    pub(crate) fn run(message: impl Display) -> Self {
        Self { kind: Kind::Run, message: in_python(&message.to_string()) }
    }

    /// A panic: its message is what the person who mends it needs.
    pub(crate) fn panic(payload: &(dyn std::any::Any + Send)) -> Self {
        let text = payload.downcast_ref::<&str>().copied();
        let text =
            text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
        let message = format!(
            "aquafuse panicked ({text}). This is a bug of aquafuse: please report it with the call, and the shape and dtype of its arrays"
        );
        Self { kind: Kind::Internal, message }
    }
}

/// A message of the libraries with the options of Python: `max_memory` for `--max-memory`, `output` for `-o`.
pub(crate) fn in_python(message: &str) -> String {
    let word = |word: &str| {
        let (before, option) = word.split_at(word.len() - word.trim_start_matches('(').len());
        let option = match option.strip_prefix("--") {
            Some("format") => "layout".to_owned(),
            Some(name) if name.starts_with(|c: char| c.is_ascii_lowercase()) => name.replace('-', "_"),
            _ if option == "-o" => "output".to_owned(),
            _ => option.to_owned(),
        };
        before.to_owned() + &option
    };
    message.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

impl From<Fault> for PyErr {
    fn from(Fault { kind, message }: Fault) -> Self {
        Python::attach(|py| {
            let family = py.import("aquafuse._errors").and_then(|module| module.getattr(kind.name()));
            match family.and_then(|exception| exception.call1((message,))) {
                Ok(exception) => PyErr::from_value(exception),
                Err(error) => error,
            }
        })
    }
}

/// An option has a value that it cannot have.
macro_rules! arguments {
    ($($error:ty),*) => {$(
        impl From<$error> for Fault {
            fn from(error: $error) -> Self {
                Self::argument(error)
            }
        }
    )*};
}
arguments!(NameError, OptionError, BorderError, AttenuationError, OperationError);

impl From<ImageError> for Fault {
    fn from(error: ImageError) -> Self {
        Self::array(error)
    }
}

impl From<SuppliedError> for Fault {
    fn from(error: SuppliedError) -> Self {
        let remedy = match error {
            SuppliedError::Size { .. } => "give one value for each pixel of the image",
            SuppliedError::AboveOne { .. } => {
                "divide the values by their largest one, or declare another depth_kind"
            }
            SuppliedError::TooFewValid { .. } => "leave depth out, and it is estimated from colour",
            _ => "leave depth out, or declare another depth_kind",
        };
        Self::array(format!("cannot use this array as depth: {error}; {remedy}"))
    }
}

impl From<FileError> for Fault {
    fn from(error: FileError) -> Self {
        match error {
            // The options of a network have these names in Python.
            FileError::UnfitNetwork { .. } => Self::file(
                error.to_string().replace("--depth-model-kind ", "kind=").replace("--depth-model-", ""),
            ),
            _ => Self::file(error),
        }
    }
}

impl From<WaterFileError> for Fault {
    fn from(error: WaterFileError) -> Self {
        match error {
            WaterFileError::Encoding { path, found, wanted } => Self::argument(format!(
                "{} holds a water of {found} values, and {wanted} ones are worked on here; use linear={} for both",
                path.display(),
                if found.name() == "linear" { "True" } else { "False" }
            )),
            error => Self::file(error),
        }
    }
}

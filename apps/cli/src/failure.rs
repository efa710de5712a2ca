//! Why the command ends without success, and with which exit code.

use std::fmt;
use std::process::ExitCode;

/// What went wrong: told once, in `main`.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The arguments cannot be carried out as they are; nothing was done.
    Usage(anyhow::Error),
    /// The work, or a part of it, failed.
    Work(anyhow::Error),
    /// The work failed, and a message of its own has said why.
    Told,
}

impl Failure {
    pub(crate) fn usage(cause: impl Into<anyhow::Error>) -> Self {
        Self::Usage(cause.into())
    }

    pub(crate) fn work(cause: impl Into<anyhow::Error>) -> Self {
        Self::Work(cause.into())
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::Work(_) | Self::Told => ExitCode::from(1),
            Self::Usage(_) => ExitCode::from(2),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // The whole chain on one line: the cause behind the context.
            Self::Usage(cause) | Self::Work(cause) => write!(f, "{cause:#}"),
            Self::Told => Ok(()),
        }
    }
}

impl From<aquafuse_data::files::FileError> for Failure {
    /// A name that cannot be written to, that nothing bears, or that is a folder's, is wrong usage; anything
    /// else happened to the work.
    fn from(error: aquafuse_data::files::FileError) -> Self {
        use aquafuse_data::files::FileError::{
            Busy, DamagedRecord, Exists, Folder, OtherSettings, Read, UnknownExtension,
        };
        use std::io::ErrorKind::{IsADirectory, NotFound};
        match &error {
            Busy { .. }
            | DamagedRecord { .. }
            | Exists { .. }
            | Folder { .. }
            | OtherSettings { .. }
            | UnknownExtension { .. } => Self::usage(error),
            Read { error: cause, .. } if matches!(cause.kind(), NotFound | IsADirectory) => {
                Self::usage(error)
            }
            _ => Self::work(error),
        }
    }
}

impl From<aquafuse_data::water_file::WaterFileError> for Failure {
    fn from(error: aquafuse_data::water_file::WaterFileError) -> Self {
        use aquafuse_data::water_file::WaterFileError::{Encoding, File};
        match error {
            File(error) => error.into(),
            Encoding { .. } => Self::usage(error),
            error => Self::work(error),
        }
    }
}

impl From<aquafuse_data::evaluate::EvaluateError> for Failure {
    /// What is refused before work begins, and is no image's fault, is wrong usage.
    fn from(error: aquafuse_data::evaluate::EvaluateError) -> Self {
        use aquafuse_data::evaluate::EvaluateError;
        match error {
            EvaluateError::File(error) => error.into(),
            error => Self::usage(error),
        }
    }
}

impl From<aquafuse_data::batch::PlanError> for Failure {
    /// A run that cannot begin is wrong usage, but where a file is at fault.
    fn from(error: aquafuse_data::batch::PlanError) -> Self {
        match error {
            aquafuse_data::batch::PlanError::File(error) => error.into(),
            error => Self::usage(error),
        }
    }
}

impl From<aquafuse_data::augment::AugmentError> for Failure {
    /// A dataset that cannot be multiplied as asked for is wrong usage, but where a file is at fault.
    fn from(error: aquafuse_data::augment::AugmentError) -> Self {
        use aquafuse_data::augment::AugmentError::{File, Water};
        match error {
            File(error) => error.into(),
            Water(error) => error.into(),
            error => Self::usage(error),
        }
    }
}

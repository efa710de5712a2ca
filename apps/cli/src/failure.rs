//! Why the command ends without success, and with which exit code.

use std::fmt;

/// What went wrong; `main` prints it, once.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The arguments are invalid; nothing was written.
    Usage(anyhow::Error),
    /// All or part of the work failed.
    Work(anyhow::Error),
    /// The work failed, and the message was printed already.
    Reported,
}

impl Failure {
    pub(crate) fn usage(cause: impl Into<anyhow::Error>) -> Self {
        Self::Usage(cause.into())
    }

    pub(crate) fn work(cause: impl Into<anyhow::Error>) -> Self {
        Self::Work(cause.into())
    }

    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Work(_) | Self::Reported => 1,
            Self::Usage(_) => 2,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // The whole chain on one line: the cause behind the context.
            Self::Usage(cause) | Self::Work(cause) => write!(f, "{cause:#}"),
            Self::Reported => Ok(()),
        }
    }
}

impl From<aquafuse_data::files::FileError> for Failure {
    /// An output that cannot be written, and an input that does not exist or is a folder, are wrong usage. Any other
    /// error is a failure of the work.
    fn from(error: aquafuse_data::files::FileError) -> Self {
        use aquafuse_data::files::FileError::{
            Busy, DamagedRecord, Exists, Folder, ForeignRecord, IsInput, OtherSettings, Read,
            UnknownExtension,
        };
        use std::io::ErrorKind::{IsADirectory, NotFound};
        match &error {
            Busy { .. }
            | DamagedRecord { .. }
            | Exists { .. }
            | Folder { .. }
            | ForeignRecord { .. }
            | IsInput { .. }
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
    /// An error that no file causes is found before the work begins: it is wrong usage.
    fn from(error: aquafuse_data::evaluate::EvaluateError) -> Self {
        use aquafuse_data::evaluate::EvaluateError;
        match error {
            EvaluateError::File(error) => error.into(),
            error @ EvaluateError::Stopped(_) => Self::work(error),
            error => Self::usage(error),
        }
    }
}

impl From<aquafuse_data::batch::PlanError> for Failure {
    /// A run that cannot begin is wrong usage, unless a file is the cause.
    fn from(error: aquafuse_data::batch::PlanError) -> Self {
        match error {
            aquafuse_data::batch::PlanError::File(error) => error.into(),
            error => Self::usage(error),
        }
    }
}

impl From<aquafuse_data::augment::AugmentError> for Failure {
    /// An augmentation that cannot begin is wrong usage, unless a file is the cause.
    fn from(error: aquafuse_data::augment::AugmentError) -> Self {
        use aquafuse_data::augment::AugmentError::{File, Water};
        match error {
            File(error) => error.into(),
            Water(error) => error.into(),
            error => Self::usage(error),
        }
    }
}

impl From<aquafuse_data::video::VideoError> for Failure {
    /// What the request makes impossible is wrong usage; what the files or ffmpeg do is a failure of the work.
    fn from(error: aquafuse_data::video::VideoError) -> Self {
        use aquafuse_data::video::VideoError::{Codec, File, Folder, Request};
        match error {
            File(error) => error.into(),
            error @ (Codec { .. } | Folder { .. } | Request(_)) => Self::usage(error),
            error => Self::work(error),
        }
    }
}

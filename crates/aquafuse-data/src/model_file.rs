//! Depth models as files: `aquafuse fit` writes them, `--depth-model FILE.toml` reads them.

use std::io::Read;
use std::path::{Path, PathBuf};

use aquafuse::depth::{Eq3, Eq3Error};
use serde::{Deserialize, Serialize};

use crate::files::{FileError, display, one_line, write_atomically};
use crate::image_file::open_file;

/// The version of the file; it changes when a field changes its meaning or goes.
const SCHEMA: u32 = 1;

/// A fitted model with what it was fitted to.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// The model.
    pub eq3: Eq3,
    /// How it was fitted; `None` for a file written by hand.
    pub fit: Option<FitRecord>,
}

/// The data of a fit, and its quality.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitRecord {
    /// Name of the folder of pairs.
    pub data: String,
    /// Pairs fitted to.
    pub pairs: usize,
    /// Kind of the labels, as `--depth-kind` names it.
    pub depth_kind: String,
    /// The scale that the labels of different images share, as `--scale` names it.
    pub scale: String,
    /// The target of the fit, as `--target` names it.
    pub target: String,
    /// Mean over pairs of Spearman's correlation of model and labels.
    pub rank_score: f64,
    /// Huber's loss, mean over pairs, in units of the labels' spread squared.
    pub loss: f64,
    /// Doubts about the fit, as sentences.
    pub doubts: Vec<String>,
    /// Each pair; a file has room for some thousand, and leaves out the last ones.
    #[serde(default, rename = "pair")]
    pub scores: Vec<PairScore>,
}

/// How well a model orders the labels of one pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairScore {
    /// Stem of its files.
    pub name: String,
    /// Spearman's correlation.
    pub rank_score: f64,
}

/// A model file could not be read. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFileError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// It is no TOML, or a field is missing or of the wrong kind.
    #[error(
        "{} is no depth model: {cause}. To make one, run `aquafuse fit PAIRS -o {}`",
        display(path),
        display(path)
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// What the parser said.
        cause: String,
    },
    /// It was written for another version of this program.
    #[error(
        "{} has schema {found}, but this version reads schema {SCHEMA}. Fit the model again with this version",
        display(path)
    )]
    Schema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        found: u32,
    },
    /// The coefficients give no valid depth.
    #[error("{}: with these coefficients mu, {error}. Correct them, or fit the model again", display(path))]
    Coefficients {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: Eq3Error,
    },
}

/// A model with the record of four thousand pairs; what is longer is none. While TOML is read, it takes up to two
/// hundred times its length.
const MOST_BYTES: usize = 256 << 10;

/// The file as it stands.
#[derive(Serialize, Deserialize)]
struct Stored {
    schema: u32,
    /// Which equation; there is one so far.
    model: Equation,
    mu: [f64; 5],
    fit: Option<FitRecord>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Equation {
    Eq3,
}

/// Read before the rest: a later schema may have other fields.
#[derive(Deserialize)]
struct Version {
    schema: u32,
}

impl ModelFile {
    /// Reads a model.
    ///
    /// # Errors
    ///
    /// [`ModelFileError`] when the file cannot be read, is of another format or schema, or breaks a law of depth.
    pub fn read(path: &Path) -> Result<Self, ModelFileError> {
        let failed = |error| FileError::Read { path: path.to_owned(), error };
        let (file, _) = open_file(path)?;
        let mut bytes = Vec::new();
        file.take((MOST_BYTES as u64).saturating_add(1)).read_to_end(&mut bytes).map_err(failed)?;
        Self::from_text(path, &String::from_utf8_lossy(&bytes))
    }

    /// Reads a model that is in memory already; errors call it `path`.
    ///
    /// # Errors
    ///
    /// [`ModelFileError`] when it is of another format or schema, or breaks a law of depth.
    pub fn from_text(path: &Path, text: &str) -> Result<Self, ModelFileError> {
        let no_model = |cause: String| ModelFileError::Format { path: path.to_owned(), cause };
        let format = |error: toml::de::Error| no_model(one_line(error.message()));
        if text.len() > MOST_BYTES {
            return Err(no_model(format!(
                "it has more than the {MOST_BYTES} bytes of any; the `[[fit.pair]]` at its end may be left out"
            )));
        }
        let Version { schema } = toml::from_str(text).map_err(format)?;
        if schema != SCHEMA {
            return Err(ModelFileError::Schema { path: path.to_owned(), found: schema });
        }
        let stored: Stored = toml::from_str(text).map_err(format)?;
        let eq3 = Eq3::new(stored.mu)
            .map_err(|error| ModelFileError::Coefficients { path: path.to_owned(), error })?;
        Ok(Self { eq3, fit: stored.fit })
    }

    /// Writes the model, whole or not at all.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the name does not end in `.toml`, the file exists and may not be replaced, or the
    /// system refuses.
    pub fn write(&self, path: &Path, overwrite: bool) -> Result<(), FileError> {
        check_name(path)?;
        let mut stored =
            Stored { schema: SCHEMA, model: Equation::Eq3, mu: self.eq3.mu, fit: self.fit.clone() };
        let failed =
            |error: toml::ser::Error| FileError::Write { path: path.to_owned(), cause: error.to_string() };
        let mut text = toml::to_string(&stored).map_err(failed)?;
        while let Some(fit) =
            stored.fit.as_mut().filter(|fit| text.len() > MOST_BYTES && !fit.scores.is_empty())
        {
            // In proportion, and a little more, for names differ in length.
            let fits = fit.scores.len().saturating_mul(MOST_BYTES).checked_div(text.len()).unwrap_or(0);
            fit.scores.truncate(fits.saturating_sub(fits / 64).saturating_sub(1));
            text = toml::to_string(&stored).map_err(failed)?;
        }
        write_atomically(path, overwrite, |out| out.write_all(text.as_bytes()))
    }
}

/// Checks that a name is one a model can be written to.
///
/// # Errors
///
/// [`FileError::UnknownExtension`] when it does not end in `.toml`.
pub fn check_name(path: &Path) -> Result<(), FileError> {
    match path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        true => Ok(()),
        false => Err(FileError::UnknownExtension { path: path.to_owned(), expected: ".toml" }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<ModelFile, ModelFileError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.toml");
        std::fs::write(&path, text).unwrap();
        ModelFile::read(&path)
    }

    #[test]
    fn what_is_written_is_read_again() {
        let scores = vec![PairScore { name: "a".into(), rank_score: 0.75 }];
        let fit = FitRecord {
            data: "pairs".into(),
            pairs: 1,
            depth_kind: "metres".into(),
            scale: "per-image".into(),
            target: "order".into(),
            rank_score: 0.75,
            loss: 0.1,
            doubts: vec!["\"so, so\"".into()],
            scores,
        };
        let model = ModelFile { eq3: Eq3::OURS, fit: Some(fit) };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.toml");
        model.write(&path, false).unwrap();
        assert_eq!(ModelFile::read(&path).unwrap(), model);
        assert!(matches!(model.write(&path, false), Err(FileError::Exists { .. })));
        model.write(&path, true).unwrap();
    }

    #[test]
    fn a_model_of_any_number_of_pairs_is_read_again() {
        let score = |number: usize| PairScore { name: format!("reef-{number:05}"), rank_score: 0.5 };
        let fit = FitRecord {
            data: "pairs".into(),
            pairs: 20_000,
            depth_kind: "metres".into(),
            scale: "per-image".into(),
            target: "order".into(),
            rank_score: 0.5,
            loss: 0.1,
            doubts: Vec::new(),
            scores: (0..20_000).map(score).collect(),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.toml");
        ModelFile { eq3: Eq3::OURS, fit: Some(fit) }.write(&path, false).unwrap();
        let fit = ModelFile::read(&path).unwrap().fit.unwrap();
        assert_eq!((fit.pairs, fit.scores[0].clone()), (20_000, score(0)));
        assert!((1_000..20_000).contains(&fit.scores.len()), "{}", fit.scores.len());
    }

    #[test]
    fn what_is_longer_than_any_model_is_not_parsed() {
        let text = format!("schema = 1\n{}", "# \n".repeat(MOST_BYTES / 3));
        let said = read(&text).unwrap_err().to_string();
        assert!(said.contains("bytes of any"), "{said}");
    }

    #[test]
    fn a_model_written_by_hand_needs_no_record() {
        let model = read("schema = 1\nmodel = \"eq3\"\nmu = [0.5, 0.5, -6.0, -0.5, -2.0]\n").unwrap();
        assert_eq!((model.eq3.mu[2], model.fit), (-6.0, None));
    }

    #[test]
    fn a_file_that_is_no_model_is_refused_by_cause() {
        let cases = [
            ("not toml at all", "is no depth model"),
            ("schema = 1\nmodel = \"eq3\"\n", "missing field `mu`"),
            ("schema = 1\nmodel = \"cubic\"\nmu = [0, 0, 0, 0, 0]\n", "unknown variant `cubic`"),
            ("schema = 1\nmodel = \"eq3\"\nmu = [0.5, 0.5]\n", "invalid length 2"),
            ("schema = 2\nother = 1\n", "has schema 2"),
            ("schema = 1\nmodel = \"eq3\"\nmu = [0.5, -0.5, -6.0, -0.5, -2.0]\n", "must not rise with red"),
            ("schema = 1\nmodel = \"eq3\"\nmu = [0.5, nan, -6.0, -0.5, -2.0]\n", "must be numbers"),
        ];
        for (text, expected) in cases {
            let said = read(text).unwrap_err().to_string();
            assert!(said.contains(expected) && said.contains("m.toml"), "{said}");
        }
    }
}

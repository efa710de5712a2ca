//! The programs that find cameras: pycolmap, or COLMAP's own command.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Steps of structure from motion, one after the other.
pub(super) const STEPS: [&str; 3] = ["features", "matches", "poses"];

/// What is to be done.
pub(super) struct Job<'a> {
    /// The folder of images.
    pub(super) images: &'a Path,
    /// Ours to work in: images.txt is there, database.db and models/ are made.
    pub(super) work: &'a Path,
    /// Whether one lens took all images.
    pub(super) is_one_camera: bool,
    /// Whether images are frames in their order, each matched with its neighbours only.
    pub(super) in_order: bool,
}

/// A program that finds cameras.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Tool {
    /// A Python that has pycolmap.
    Pycolmap(PathBuf),
    /// COLMAP's command.
    Colmap {
        program: PathBuf,
        /// Whether it has the mapper that finds all poses at once.
        is_global: bool,
        /// What its options about features and matching begin with: they were renamed in version 3.13.
        prefixes: [&'static str; 2],
    },
}

const SCRIPT: &str = include_str!("pycolmap.py");
/// Before anything is imported: the current folder, which may hold files of strangers, is no place for modules.
const APART: &str = "import sys; sys.path = [place for place in sys.path if place]\n";
/// Nor is what the environment names.
const NO_ENVIRONMENT: &str = "-E";
/// Pythons as they are called.
const PYTHONS: [&str; 2] = ["python3", "python"];

impl Tool {
    /// A Python, if it has pycolmap.
    pub(super) fn pycolmap(python: &Path) -> Option<Self> {
        let has = answer(python, &[NO_ENVIRONMENT, "-c", &format!("{APART}import pycolmap")]).is_some();
        has.then(|| Self::Pycolmap(python.to_owned()))
    }

    /// COLMAP's command, if it is there.
    pub(super) fn colmap(program: &Path) -> Option<Self> {
        let commands = answer(program, &["help"])?;
        let options = answer(program, &["feature_extractor", "-h"])?;
        let is_new = options.contains("FeatureExtraction.use_gpu");
        Some(Self::Colmap {
            program: program.to_owned(),
            is_global: commands.contains("global_mapper"),
            prefixes: if is_new {
                ["FeatureExtraction", "FeatureMatching"]
            } else {
                ["SiftExtraction", "SiftMatching"]
            },
        })
    }

    /// The first that is installed.
    pub(super) fn installed() -> Option<Self> {
        let pycolmap = PYTHONS.iter().find_map(|python| Self::pycolmap(python.as_ref()));
        pycolmap.or_else(|| Self::colmap("colmap".as_ref()))
    }

    /// What it is called.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Pycolmap(_) => "pycolmap",
            Self::Colmap { is_global: true, .. } => "colmap, all poses at once",
            Self::Colmap { .. } => "colmap",
        }
    }

    /// The command that does a step of [`STEPS`].
    pub(super) fn command(&self, step: &str, job: &Job<'_>) -> Command {
        match self {
            Self::Pycolmap(python) => {
                let mut command = Command::new(python);
                command
                    .args([NO_ENVIRONMENT, "-c", &format!("{APART}{SCRIPT}"), step])
                    .args([job.images, job.work]);
                command.arg(if job.is_one_camera { "SINGLE" } else { "AUTO" });
                command.arg(if job.in_order { "neighbours" } else { "all" });
                command
            }
            Self::Colmap { program, is_global, prefixes: [extraction, matching] } => {
                let mut command = Command::new(program);
                let (database, images) = (job.work.join("database.db"), job.work.join("images.txt"));
                let no_graphics = |prefix: &str| [format!("--{prefix}.use_gpu"), "0".into()];
                match step {
                    "features" => {
                        command.arg("feature_extractor").arg("--image_list_path").arg(images);
                        command
                            .args(["--ImageReader.single_camera", if job.is_one_camera { "1" } else { "0" }]);
                        command.arg("--image_path").arg(job.images).args(no_graphics(extraction));
                    }
                    "matches" => {
                        command.arg(if job.in_order { "sequential_matcher" } else { "exhaustive_matcher" });
                        command.args(no_graphics(matching));
                    }
                    _ => {
                        command.arg(if *is_global { "global_mapper" } else { "mapper" });
                        command.arg("--image_path").arg(job.images);
                        command.arg("--output_path").arg(job.work.join("models"));
                    }
                }
                command.arg("--database_path").arg(database);
                command
            }
        }
    }
}

/// What a program says to a question; none if it cannot be asked, or says no.
fn answer(program: &Path, question: &[&str]) -> Option<String> {
    let output = Command::new(program).args(question).stdin(Stdio::null()).output().ok()?;
    output.status.success().then(|| {
        let said = [output.stdout, output.stderr].concat();
        String::from_utf8_lossy(&said).into_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(tool: &Tool, step: &str, is_one_camera: bool, in_order: bool) -> String {
        let job = Job { images: "in".as_ref(), work: "work".as_ref(), is_one_camera, in_order };
        let command = tool.command(step, &job);
        let words = [command.get_program()].into_iter().chain(command.get_args());
        words.map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn every_step_has_its_command() {
        let colmap = Tool::Colmap {
            program: "colmap".into(),
            is_global: false,
            prefixes: ["SiftExtraction", "SiftMatching"],
        };
        assert_eq!(
            STEPS.map(|step| said(&colmap, step, true, false)),
            [
                "colmap feature_extractor --image_list_path work/images.txt --ImageReader.single_camera 1 \
                 --image_path in --SiftExtraction.use_gpu 0 --database_path work/database.db",
                "colmap exhaustive_matcher --SiftMatching.use_gpu 0 --database_path work/database.db",
                "colmap mapper --image_path in --output_path work/models --database_path work/database.db",
            ]
        );
        assert!(said(&colmap, "matches", true, true).contains("sequential_matcher"));
        let python = said(&Tool::Pycolmap("python3".into()), "matches", false, true);
        assert!(
            python.starts_with("python3 -E -c import sys; sys.path")
                && python.ends_with(" matches in work AUTO neighbours")
        );
    }

    #[test]
    fn what_is_not_there_is_no_tool() {
        assert_eq!(Tool::pycolmap("no such program".as_ref()), None);
        assert_eq!(Tool::colmap("no such program".as_ref()), None);
    }
}

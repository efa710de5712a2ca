//! No program is run that nobody asked for.

use super::run::{Run, program, reef};

#[test]
fn no_python_of_the_current_folder_runs_in_any_step() {
    let Ok(python) = std::process::Command::new("sh").args(["-c", "command -v python3"]).output() else {
        return;
    };
    let python = String::from_utf8(python.stdout).unwrap().trim().to_owned();
    if python.is_empty() {
        println!("skipped: no python3 here");
        return;
    }
    let run = Run::new();
    reef(&run);
    // A folder of photographs of a stranger, and a Python that would have a pycolmap elsewhere.
    for folder in ["", "reef/images", "reef3d"] {
        std::fs::create_dir_all(run.path(folder)).unwrap();
        for module in ["pycolmap", "sqlite3", "pathlib", "json", "os", "sitecustomize", "usercustomize"] {
            let path = run.path(folder).join(format!("{module}.py"));
            std::fs::write(path, format!("open({:?}, 'a').write({module:?})\n", run.path("was_run")))
                .unwrap();
        }
    }
    std::fs::remove_dir_all(run.path("reef3d")).unwrap();
    // It says that pycolmap is there, and runs what it is given.
    let lines = format!("case \"$*\" in *'import pycolmap') exit 0;; esac\nexec {python} \"$@\"");
    let with_pycolmap = program(&run, "python", &lines);
    for more in [&[][..], &["--python", &python], &["--python", &with_pycolmap]] {
        for path in [".", ""] {
            let sfm = [&["scene", "sfm", "reef/images", "-o", "reef3d", "--overwrite"][..], more].concat();
            let _ = run.command(&sfm).env("PYTHONPATH", path).output().unwrap();
            assert!(
                !run.path("was_run").exists(),
                "{more:?}: {:?}",
                std::fs::read_to_string(run.path("was_run"))
            );
        }
    }
}

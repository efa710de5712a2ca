//! A model as text, which every program that knows COLMAP reads.

use std::fmt::Write;
use std::path::Path;

use aquafuse_data::files::{display, write_text};

use crate::camera::Camera;
use crate::files::SceneFileError;
use crate::files::cameras::{Cameras, PosedImage};
use crate::lens::Lens;

/// Writes `cameras.txt`, `images.txt` and `points3D.txt` into a folder that is there, each whole or not at all.
///
/// Lenses become PINHOLE or, if they distort, OPENCV; images of one lens share a camera.
///
/// # Errors
///
/// [`SceneFileError`] when a name does not fit in a line of text, a file exists and may not be replaced, or the system
/// refuses.
pub fn write_cameras(folder: &Path, cameras: &Cameras, overwrite: bool) -> Result<(), SceneFileError> {
    let images = folder.join("images.txt");
    for one in &cameras.images {
        // Blanks separate fields: those at either end, or two in a row, would be lost.
        let name =
            one.name.to_str().filter(|name| name.split_whitespace().collect::<Vec<_>>().join(" ") == **name);
        if name.is_none() {
            let cause =
                format!("the name {} does not fit into a line of text; rename the image", display(&one.name));
            return Err(SceneFileError::content(&images, cause));
        }
    }
    let mut lenses: Vec<String> = Vec::new();
    let mut poses = String::new();
    for (number, one) in (1_usize..).zip(&cameras.images) {
        let lens = lens(&one.lens);
        let known = lenses.iter().position(|other| *other == lens);
        let id = known.unwrap_or_else(|| {
            lenses.push(lens);
            lenses.len().saturating_sub(1)
        });
        // The second line would hold what was seen where.
        let _ = writeln!(poses, "{number} {} {} {}\n", pose(one), id.saturating_add(1), one.name.display());
    }
    let lenses = lenses.iter().zip(1_usize..).map(|(lens, id)| format!("{id} {lens}\n"));
    let things = cameras.points.iter().zip(1_usize..).map(|(point, number)| {
        let ([x, y, z], [r, g, b]) =
            (point.position, point.colour.map(|value| (255.0 * value).round().clamp(0.0, 255.0)));
        format!("{number} {x} {y} {z} {r} {g} {b} 0\n")
    });
    write_text(&folder.join("cameras.txt"), &lenses.collect::<String>(), overwrite)?;
    write_text(&images, &poses, overwrite)?;
    write_text(&folder.join("points3D.txt"), &things.collect::<String>(), overwrite)?;
    Ok(())
}

/// Model, size and parameters.
fn lens(lens: &Lens) -> String {
    let Camera { width, height, focal: [fx, fy], centre: [cx, cy], .. } = lens.camera;
    match lens.distortion {
        [0.0, 0.0, 0.0, 0.0] => format!("PINHOLE {width} {height} {fx} {fy} {cx} {cy}"),
        [k1, k2, p1, p2] => format!("OPENCV {width} {height} {fx} {fy} {cx} {cy} {k1} {k2} {p1} {p2}"),
    }
}

/// Quaternion and t.
fn pose(one: &PosedImage) -> String {
    let [w, x, y, z] = one.lens.camera.quaternion();
    let [a, b, c] = one.lens.camera.translation;
    format!("{w} {x} {y} {z} {a} {b} {c}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use aquafuse_data::image_file::ReadOptions;

    use crate::files::read_cameras;
    use crate::points::Point;

    #[test]
    fn what_is_written_is_read_again() {
        let posed = |name: &str, quaternion, distortion| PosedImage {
            name: name.into(),
            lens: Lens {
                camera: Camera {
                    width: 40,
                    height: 30,
                    focal: [50.5, 45.25],
                    centre: [19.0, 16.5],
                    rotation: Camera::rotation_of(quaternion),
                    translation: [0.3, -1.0, 2.0],
                },
                distortion,
            },
        };
        let cameras = Cameras {
            images: vec![
                posed("a reef.png", [0.8, 0.36, -0.48, 0.0], [0.0; 4]),
                posed("b.png", [0.0, 0.0, 0.6, 0.8], [0.1, -0.02, 0.003, 0.0]),
                posed("c.png", [0.0, 1.0, 0.0, 0.0], [0.0; 4]),
                posed("d.png", [0.0, 0.6, 0.8, 0.0], [0.0; 4]),
            ],
            points: vec![Point { position: [1.5, -2.0, 3.25], colour: [0.0, 0.2, 1.0] }],
            model: "".into(),
        };
        let folder = tempfile::tempdir().unwrap();
        write_cameras(folder.path(), &cameras, false).unwrap();
        let read = read_cameras(folder.path(), &ReadOptions::default()).unwrap();
        assert_eq!(read.points, cameras.points);
        for (read, written) in read.images.iter().zip(&cameras.images) {
            assert_eq!((&read.name, read.lens.distortion), (&written.name, written.lens.distortion));
            let [a, b] = [read, written].map(|one| one.lens.camera.clone());
            assert_eq!((a.focal, a.centre, a.translation), (b.focal, b.centre, b.translation));
            let turned = a.rotation.as_flattened().iter().zip(b.rotation.as_flattened());
            assert!(turned.into_iter().all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
        }
        let lenses = std::fs::read_to_string(folder.path().join("cameras.txt")).unwrap();
        assert_eq!(lenses.lines().count(), 2, "{lenses}");
        assert!(write_cameras(folder.path(), &cameras, false).is_err());
    }

    #[test]
    fn a_name_that_would_be_read_as_another_is_refused() {
        let mut cameras = Cameras::default();
        let camera =
            crate::truth::views(1, aquafuse::truth::Size { width: 8, height: 6 }, 1, 1).remove(0).camera;
        cameras.images =
            vec![PosedImage { name: "two  blanks.png".into(), lens: Lens { camera, distortion: [0.0; 4] } }];
        let folder = tempfile::tempdir().unwrap();
        let said = write_cameras(folder.path(), &cameras, false).unwrap_err().to_string();
        assert!(said.contains("two  blanks.png") && said.contains("rename"), "{said}");
    }
}

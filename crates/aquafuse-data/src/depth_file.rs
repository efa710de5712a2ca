//! Depth maps as files.

use std::path::Path;

use aquafuse::depth::{DepthKind, DepthMap};

use crate::picture::{FileError, Format, WriteOptions, write_atomically};

/// Writes a depth map as 16-bit grey PNG, whole or not at all: relative depth with 65535 = 1, metres in
/// millimetres (65.535 m at most; what is farther is written as that).
///
/// # Errors
///
/// [`FileError`] when the name does not end in `.png`, the file exists and may not be replaced, or the
/// system refuses.
pub fn write(path: &Path, depth: &DepthMap, options: &WriteOptions) -> Result<(), FileError> {
    if Format::of(path) != Some(Format::Png) {
        return Err(FileError::UnknownExtension { path: path.to_owned(), expected: ".png" });
    }
    let steps_per_unit = match depth.kind() {
        DepthKind::Metres => 1000.0,
        _ => 65535.0,
    };
    let stored = |z: f32| (z * steps_per_unit).round().clamp(0.0, 65535.0) as u16;
    let values: Vec<u16> = depth.distances().into_iter().map(stored).collect();
    write_atomically(path, options.overwrite, |out| {
        crate::picture::encode_grey16(out, depth.width(), depth.height(), &values)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(depth: &DepthMap) -> Vec<u16> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("z.png");
        write(&path, depth, &WriteOptions::default()).unwrap();
        ::image::open(&path).unwrap().into_luma16().into_raw()
    }

    #[test]
    fn relative_depth_spans_sixteen_bits() {
        let depth = DepthMap::from_levels(3, 1, vec![0, 1, 255]).unwrap();
        assert_eq!(written(&depth), [0, 257, 65535]);
    }

    #[test]
    fn metres_are_written_as_millimetres() {
        let depth = DepthMap::from_distances(3, 1, DepthKind::Metres, vec![0.0, 1.5, 100.0]).unwrap();
        assert_eq!(written(&depth), [0, 1500, 65535]);
    }
}

//! Splats as PLY, in the layout that Kerbl et al. write and every viewer reads; the compressed one of SuperSplat
//! (`ply/compressed.rs`) is read too.
//!
//! Not with `serde-ply` (0.2.2 was tried): a header without an end costs it 20 s a GiB, of two properties of one name the
//! last wins, lines it does not know and whole numbers pass in silence, and its errors name no line.

mod compressed;

use std::io::Write;
use std::path::Path;

use aquafuse_data::files::write_bytes;
use aquafuse_data::image_file::ReadOptions;

use super::SceneFileError;
use super::bytes::{self, Bytes};
use crate::splats::{self, HARMONICS, LOG_SCALE, MAX_SH_DEGREE, MEAN, OPACITY, ROTATION, Splats};

/// The properties of a degree in the order of the layout, each with its place in a row; none is a normal, which is 0.
///
/// Harmonics beyond the first go channel by channel in the file, and one by one in a row.
fn layout(degree: u8) -> Vec<(String, Option<usize>)> {
    let numbered = |name: &'static str, count: usize, at: usize| {
        (0..count).map(move |i| (format!("{name}_{i}"), Some(at.saturating_add(i))))
    };
    let beyond = splats::harmonics(degree).saturating_sub(1);
    let rest = (0..3_usize).flat_map(|channel| {
        (0..beyond).map(move |k| k.saturating_add(1).saturating_mul(3).saturating_add(channel))
    });
    let rest = rest.zip(0_usize..).map(|(at, i)| (format!("f_rest_{i}"), Some(HARMONICS.saturating_add(at))));
    let position = ["x", "y", "z"].into_iter().zip(MEAN..).map(|(name, at)| (name.into(), Some(at)));
    position
        .chain(["nx", "ny", "nz"].map(|name| (name.into(), None)))
        .chain(numbered("f_dc", 3, HARMONICS))
        .chain(rest)
        .chain([("opacity".into(), Some(OPACITY))])
        .chain(numbered("scale", 3, LOG_SCALE))
        .chain(numbered("rot", 4, ROTATION))
        .collect()
}

/// Writes splats as a PLY file, whole or not at all.
///
/// # Errors
///
/// [`SceneFileError`] when the file exists and may not be replaced, or the system refuses.
pub fn write_ply(path: &Path, splats: &Splats<f32>, overwrite: bool) -> Result<(), SceneFileError> {
    Ok(write_bytes(path, &ply_bytes(splats), overwrite)?)
}

/// The bytes of such a file.
pub fn ply_bytes(splats: &Splats<f32>) -> Vec<u8> {
    let layout = layout(splats.sh_degree());
    let mut bytes = Vec::new();
    // Writing to memory does not fail.
    let _ = write!(bytes, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", splats.len());
    for (name, _) in &layout {
        let _ = writeln!(bytes, "property float {name}");
    }
    bytes.extend(b"end_header\n");
    for row in splats.rows().chunks_exact(splats.width()) {
        for (_, at) in &layout {
            let value = at.and_then(|at| row.get(at)).copied().unwrap_or(0.0);
            bytes.extend(value.to_le_bytes());
        }
    }
    bytes
}

/// Reads splats from a PLY file, properties by their names: others, and their order, do not matter.
///
/// # Errors
///
/// [`SceneFileError`] when it is no such file, lacks a property, is cut short, holds a value that is no number, or takes more
/// memory than `reading` allows.
pub(super) fn read(path: &Path, reading: &ReadOptions) -> Result<Splats<f32>, SceneFileError> {
    parse(path, &bytes::read(path, reading)?)
}

fn parse(path: &Path, file: &[u8]) -> Result<Splats<f32>, SceneFileError> {
    let Header { elements, length } = Header::read(path, file)?;
    let mut bytes = Bytes::new(path, file);
    bytes.skip(length)?;
    if compressed::is_one(&elements) {
        return compressed::parse(path, &elements, bytes);
    }
    let Some(header) = elements.first() else {
        return Err(SceneFileError::content(path, "it has no element. Name a PLY file of splats"));
    };
    let rest = header.properties.iter().filter(|property| property.name.starts_with("f_rest_")).count();
    let degree = (0..=MAX_SH_DEGREE)
        .find(|&degree| splats::harmonics(degree).saturating_sub(1).saturating_mul(3) == rest)
        .ok_or_else(|| {
            let cause = format!(
                "it has {rest} properties f_rest_*, but 0, 9, 24 or 45 make harmonics. Is it of splats?"
            );
            SceneFileError::content(path, cause)
        })?;
    // Where each property of the file goes in a row.
    let wanted: Vec<(String, usize)> =
        layout(degree).into_iter().filter_map(|(name, at)| Some((name, at?))).collect();
    let goes = |name: &str| wanted.iter().find(|(known, _)| known == name).map(|&(_, at)| at);
    for (name, _) in &wanted {
        if !header.properties.iter().any(|property| &property.name == name) {
            let cause = format!("it has no property {name:?}: it is no file of splats");
            return Err(SceneFileError::content(path, cause));
        }
    }
    for (property, number) in header.properties.iter().zip(0_usize..) {
        let is_wanted = goes(&property.name).is_some();
        if is_wanted && !matches!(property.kind, Kind::Float | Kind::Double) {
            let cause =
                format!("its property {:?} is of whole numbers, and splats have floats", property.name);
            return Err(SceneFileError::content(path, cause));
        }
        if is_wanted && header.properties.iter().take(number).any(|other| other.name == property.name) {
            let cause = format!("it has the property {:?} twice", property.name);
            return Err(SceneFileError::content(path, cause));
        }
    }
    let places: Vec<(Kind, Option<usize>)> =
        header.properties.iter().map(|property| (property.kind, goes(&property.name))).collect();

    let width = Splats::<f32>::width_of(degree);
    if bytes.left() < header.bytes() {
        let cause =
            format!("it promises {} splats of {} bytes, but is shorter", header.count, header.stride());
        return Err(bytes.wrong(cause));
    }
    let mut splats = Splats::new(degree);
    let mut row = vec![0.0; width];
    for _ in 0..header.count {
        for (kind, place) in &places {
            let value = kind.take(&mut bytes)?;
            if let Some(cell) = place.and_then(|at| row.get_mut(at)) {
                if !value.is_finite() {
                    return Err(bytes.wrong("a value that is no number"));
                }
                *cell = value;
            }
        }
        splats.push(&row);
    }
    Ok(splats)
}

/// Reads splats for fuzzing: what was read is written, and read as the same.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(path: &Path, file: &[u8]) -> Result<(), SceneFileError> {
    let splats = parse(path, file)?;
    assert_eq!(parse(path, &ply_bytes(&splats))?, splats);
    Ok(())
}

/// What kind of number a property is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Signed(usize),
    Unsigned(usize),
    Float,
    Double,
}

impl Kind {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Signed(1),
            "uchar" | "uint8" => Self::Unsigned(1),
            "short" | "int16" => Self::Signed(2),
            "ushort" | "uint16" => Self::Unsigned(2),
            "int" | "int32" => Self::Signed(4),
            "uint" | "uint32" => Self::Unsigned(4),
            "float" | "float32" => Self::Float,
            "double" | "float64" => Self::Double,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Signed(size) | Self::Unsigned(size) => size,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    #[allow(
        clippy::cast_possible_truncation,
        reason = "a double beyond the range of floats is infinite, and refused"
    )]
    fn take(self, bytes: &mut Bytes<'_>) -> Result<f32, SceneFileError> {
        Ok(match self {
            Self::Float => f32::from_le_bytes(bytes.take()?),
            Self::Double => bytes.double()? as f32,
            // Of no property that splats have: passed over.
            Self::Signed(size) | Self::Unsigned(size) => {
                bytes.skip(size)?;
                0.0
            }
        })
    }
}

struct Property {
    name: String,
    kind: Kind,
}

/// Things of one kind, one after the other.
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

impl Element {
    /// Bytes of one of them.
    fn stride(&self) -> usize {
        self.properties.iter().fold(0, |sum, property| sum.saturating_add(property.kind.size()))
    }

    fn bytes(&self) -> usize {
        self.count.saturating_mul(self.stride())
    }
}

struct Header {
    elements: Vec<Element>,
    /// Bytes until the first of them.
    length: usize,
}

/// The most bytes a header takes, and the most properties: what is longer is none of ours.
const MOST_HEADER: usize = 1 << 16;
const MOST_PROPERTIES: usize = 1 << 10;

impl Header {
    fn read(path: &Path, file: &[u8]) -> Result<Self, SceneFileError> {
        let end = b"end_header\n";
        let head = file.get(..MOST_HEADER.min(file.len())).unwrap_or_default();
        let at = head.windows(end.len()).position(|window| window == end);
        let text = at.and_then(|at| head.get(..at)).and_then(|text| std::str::from_utf8(text).ok());
        let Some(text) = text.filter(|text| text.starts_with("ply\n")) else {
            return Err(SceneFileError::content(path, "it is no PLY file. Name one of splats"));
        };
        let mut header = Self { elements: Vec::new(), length: text.len().saturating_add(end.len()) };
        for (line, number) in text.lines().zip(1_usize..) {
            let wrong = |cause: String| SceneFileError::line(path, number, cause);
            let words: Vec<&str> = line.split_whitespace().collect();
            match words.as_slice() {
                ["ply"] | ["comment" | "obj_info", ..] | [] => {}
                ["format", "binary_little_endian", "1.0"] => {}
                ["format", kind, ..] => {
                    return Err(wrong(format!("it is {kind}, but only binary_little_endian is read")));
                }
                ["element", name, count] => {
                    if header.elements.is_empty() && !matches!(*name, "vertex" | "chunk") {
                        return Err(wrong(format!("its first element is {name:?}, not \"vertex\"")));
                    }
                    let count = count.parse().map_err(|_| wrong(format!("{count:?} is no count")))?;
                    header.elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
                }
                // What other elements have comes after the splats.
                ["property", ..] if header.is_past_splats() => {}
                ["property", kind, name] => {
                    let kind =
                        Kind::named(kind).ok_or_else(|| wrong(format!("{kind:?} is no kind of number")))?;
                    let Some(element) = header.elements.last_mut() else { continue };
                    element.properties.push(Property { kind, name: (*name).to_owned() });
                }
                _ => return Err(wrong(format!("{line:?} is no line of a header of splats"))),
            }
            let properties = header.elements.last().map_or(0, |element| element.properties.len());
            if properties.max(header.elements.len()) > MOST_PROPERTIES {
                return Err(wrong(format!("it has more than {MOST_PROPERTIES} properties")));
            }
        }
        Ok(header)
    }

    /// Whether splats, which are the first element unless they are compressed, lie before the element that was begun.
    fn is_past_splats(&self) -> bool {
        self.elements.len() != 1 && !compressed::is_one(&self.elements)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some(degree: u8) -> Splats<f32> {
        let width = Splats::<f32>::width_of(degree);
        let rows = (0..3 * width).map(|i| (i as f32).sin()).collect();
        Splats::from_rows(degree, rows).unwrap()
    }

    #[test]
    fn splats_come_back_as_they_went() {
        for degree in 0..=3 {
            let splats = some(degree);
            assert_eq!(parse(Path::new("a.ply"), &ply_bytes(&splats)).unwrap(), splats);
        }
    }

    #[test]
    fn the_layout_is_the_published_one() {
        let names: Vec<String> = layout(3).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names.len(), 62);
        assert_eq!(names[..9].join(" "), "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2");
        assert_eq!(names[9..11].join(" "), "f_rest_0 f_rest_1");
        assert_eq!(
            names[53..].join(" "),
            "f_rest_44 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3"
        );
        // f_rest_0 is the second harmonic of red, f_rest_15 that of green.
        let places: Vec<Option<usize>> = layout(3).into_iter().map(|(_, at)| at).collect();
        assert_eq!([places[9], places[24]], [Some(HARMONICS + 3), Some(HARMONICS + 4)]);
    }

    #[test]
    fn properties_are_found_by_name_in_any_order_and_kind() {
        let splats = some(0);
        let mut names: Vec<(String, Option<usize>)> = layout(0);
        names.reverse();
        let mut file =
            b"ply\nformat binary_little_endian 1.0\ncomment of another program\nelement vertex 3\n".to_vec();
        file.extend(b"property uchar red\n");
        for (name, _) in &names {
            file.extend(format!("property double {name}\n").bytes());
        }
        file.extend(b"element face 0\nproperty list uchar int vertex_indices\nend_header\n");
        for i in 0..3 {
            file.push(9);
            for (_, at) in &names {
                file.extend(at.map_or(0.0, |at| f64::from(splats.row(i)[at])).to_le_bytes());
            }
        }
        assert_eq!(parse(Path::new("a.ply"), &file).unwrap(), splats);
    }

    #[test]
    fn a_property_of_splats_is_of_floats_and_stands_once() {
        let whole = String::from_utf8_lossy(&ply_bytes(&some(0))).into_owned();
        let of = |from: &str, to: &str| {
            parse(Path::new("a.ply"), whole.replace(from, to).as_bytes()).unwrap_err().to_string()
        };
        assert!(of("float opacity", "int opacity").contains("\"opacity\" is of whole numbers"));
        assert!(of("float nx", "float x").contains("the property \"x\" twice"));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let whole = ply_bytes(&some(1));
        let of = |file: &[u8]| parse(Path::new("a.ply"), file).unwrap_err().to_string();
        for end in 0..whole.len() {
            assert!(parse(Path::new("a.ply"), &whole[..end]).is_err(), "{end}");
        }
        let text = String::from_utf8_lossy(&whole[..900]).into_owned();
        let changed = |from: &str, to: &str| of(text.replace(from, to).as_bytes());
        assert!(changed("vertex 3", "vertex 99999999999").contains("but is shorter"));
        assert!(changed("vertex 3", "vertex -1").contains("line 3: \"-1\" is no count"));
        assert!(changed("float opacity", "float haze").contains("no property \"opacity\""));
        assert!(changed("f_rest_8", "f_past_8").contains("it has 8 properties f_rest_*"));
        assert!(changed("binary_little_endian", "ascii").contains("line 2: it is ascii"));
        let mut broken = whole;
        let last = broken.len() - 4;
        broken[last..].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(of(&broken).contains("no number"));
    }
}

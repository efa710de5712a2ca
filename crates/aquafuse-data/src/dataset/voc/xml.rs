//! The XML of an annotation: what can be wrong with it, and the names in it.
//!
//! Only two things in the XML are ours: the texts of `filename` and of `path` beside it. They are found by place,
//! so that everything else stays byte for byte.

use std::borrow::Cow;
use std::ops::Range;

use encoding_rs::{Encoding, UTF_8};
use quick_xml::Reader;
use quick_xml::events::Event;

use super::super::tree::NO_TEXT;
use crate::files::decoded;

/// Boxes count from 1 or from 0, in whole pixels or not: as far as this beyond the edge nothing is wrong.
const SLACK: f64 = 1.0;

/// The text of an XML file and its encoding: what its byte order mark says, or its first line declares.
pub(super) fn text(bytes: &[u8]) -> Result<(Cow<'_, str>, &'static Encoding), String> {
    if let Some((encoding, _)) = Encoding::for_bom(bytes) {
        // The mark stays with the text: it is written again with it.
        return decoded(encoding, bytes).map(|text| (text, encoding)).ok_or_else(|| NO_TEXT.to_owned());
    }
    let Some(label) = declared(bytes) else {
        let text = decoded(UTF_8, bytes).ok_or_else(|| NO_TEXT.to_owned())?;
        return Ok((text, UTF_8));
    };
    let name = String::from_utf8_lossy(label);
    let Some(encoding) = Encoding::for_label(label) else {
        return Err(format!("it declares the encoding {name:?}, which is not known; save it as UTF-8"));
    };
    let text = decoded(encoding, bytes)
        .ok_or_else(|| format!("it is not in the encoding {name:?} that it declares; save it as UTF-8"))?;
    Ok((text, encoding))
}

/// The encoding that the first line of an XML file declares, if it declares one.
fn declared(bytes: &[u8]) -> Option<&[u8]> {
    let line = bytes.strip_prefix(b"<?xml")?;
    let line = line.get(..line.iter().position(|byte| *byte == b'>')?)?;
    let at = line.windows(8).position(|word| word == b"encoding")?;
    let mut quoted = line.get(at..)?.splitn(3, |byte| matches!(byte, b'"' | b'\''));
    quoted.nth(1)
}

/// What an annotation says, as far as it can be wrong.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Annotation {
    pub(super) filename: Option<String>,
    size: [Option<f64>; 2],
    /// Left, top, right, bottom; NaN where one is missing or no number.
    boxes: Vec<[f64; 4]>,
}

impl Annotation {
    pub(super) fn into_boxes(self) -> Vec<[f64; 4]> {
        self.boxes
    }

    /// What is wrong with its boxes, in words.
    pub(super) fn faults(&self) -> impl Iterator<Item = String> {
        let [width, height] = self.size;
        let within = |low: f64, high: f64, size: Option<f64>| {
            low >= -SLACK && low <= high && size.is_none_or(|size| size <= 0.0 || high <= size + SLACK)
        };
        self.boxes.iter().filter_map(move |&[left, top, right, bottom]| {
            if [left, top, right, bottom].iter().any(|side| side.is_nan()) {
                return Some("a side of a box is missing or not a number".to_owned());
            }
            (!(within(left, right, width) && within(top, bottom, height)))
                .then(|| format!("the box {left}, {top}, {right}, {bottom} is not inside the image"))
        })
    }
}

/// An XML text, element by element.
struct Pieces<'a> {
    reader: Reader<&'a [u8]>,
    /// Where the reader begins: it drops a byte order mark and does not count it.
    begin: usize,
    stack: Vec<String>,
    /// Where the text of the last element begins, while no other one is in it.
    text: Option<usize>,
    /// The last piece was the text of the element on the stack, which has ended.
    ended: bool,
}

impl<'a> Pieces<'a> {
    fn of(text: &'a str) -> Self {
        let marked = text.len();
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = Reader::from_str(text);
        reader.config_mut().expand_empty_elements = true;
        Self { reader, begin: marked.saturating_sub(text.len()), stack: Vec::new(), text: None, ended: false }
    }

    /// The next begin of an element, or the text of one that holds nothing else; the stack names the elements it is in.
    fn next(&mut self) -> Result<Option<(Piece, Range<usize>)>, String> {
        if std::mem::take(&mut self.ended) {
            self.stack.pop();
        }
        loop {
            let from = self.place();
            let event = self.reader.read_event().map_err(|error| format!("it is not XML: {error}"))?;
            match event {
                Event::Eof if self.stack.is_empty() => return Ok(None),
                Event::Eof => return Err("it ends within an element".into()),
                Event::Start(start) => {
                    // Elements deeper than this are none of ours.
                    if self.stack.len() >= 64 {
                        return Err("its elements are nested too deep".into());
                    }
                    self.stack.push(start.local_name().as_ref().to_owned());
                    self.text = Some(self.place());
                    return Ok(Some((Piece::Start, from..from)));
                }
                Event::End(_) => match self.text.take() {
                    Some(begin) => {
                        self.ended = true;
                        return Ok(Some((Piece::Text, begin..from)));
                    }
                    None => {
                        self.stack.pop();
                    }
                },
                // Another reader may put a file of its machine in the place of an entity, or load the type from elsewhere.
                Event::DocType(kind) if is_unsafe(kind.as_ref()) => {
                    return Err("its document type defines entities or names another file; remove it".into());
                }
                _ => {}
            }
        }
    }

    fn place(&self) -> usize {
        self.begin.saturating_add(usize::try_from(self.reader.buffer_position()).unwrap_or(usize::MAX))
    }

    fn is_in(&self, path: &[&str]) -> bool {
        self.stack.iter().map(String::as_str).eq(path.iter().copied())
    }
}

/// Whether a document type is more than a name.
fn is_unsafe(kind: &str) -> bool {
    let small = kind.to_ascii_lowercase();
    ["entity", "system", "public"].iter().any(|word| small.contains(word))
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Piece {
    Start,
    Text,
}

/// Reads an annotation; what is wrong with it otherwise.
pub(super) fn parse(text: &str) -> Result<Annotation, String> {
    let (mut found, mut pieces) = (Annotation::default(), Pieces::of(text));
    let mut is_first = true;
    while let Some((piece, range)) = pieces.next()? {
        let root = pieces.stack.first().map(String::as_str);
        if is_first && piece == Piece::Start {
            if root != Some("annotation") {
                return Err("its first element is not `annotation`".into());
            }
            is_first = false;
        }
        if piece == Piece::Start {
            if pieces.is_in(&["annotation", "object", "bndbox"]) {
                found.boxes.push([f64::NAN; 4]);
            }
            continue;
        }
        let said = text.get(range).unwrap_or_default().trim();
        let number = || said.parse::<f64>().ok();
        if pieces.is_in(&["annotation", "filename"]) {
            let plain = quick_xml::escape::unescape(said);
            found.filename = Some(plain.map_or_else(|_| said.to_owned(), Cow::into_owned));
        }
        for (name, side) in ["width", "height"].into_iter().zip(&mut found.size) {
            if pieces.is_in(&["annotation", "size", name]) {
                *side = number();
            }
        }
        if let Some(last) = found.boxes.last_mut() {
            for (name, side) in ["xmin", "ymin", "xmax", "ymax"].into_iter().zip(last) {
                if pieces.is_in(&["annotation", "object", "bndbox", name]) {
                    *side = number().unwrap_or(f64::NAN);
                }
            }
        }
    }
    if is_first { Err("it has no element".into()) } else { Ok(found) }
}

/// The annotation with another image's name in `filename`, and as the last part of `path`.
pub(in super::super) fn renamed(bytes: &[u8], image: &str) -> Vec<u8> {
    let Ok((text, encoding)) = text(bytes) else { return bytes.to_vec() };
    let (mut out, mut done, mut pieces) = (String::with_capacity(text.len()), 0, Pieces::of(&text));
    let name = quick_xml::escape::escape(image);
    while let Ok(Some((piece, range))) = pieces.next() {
        let is_path = pieces.is_in(&["annotation", "path"]);
        if piece != Piece::Text || !(is_path || pieces.is_in(&["annotation", "filename"])) {
            continue;
        }
        let said = text.get(range.clone()).unwrap_or_default();
        if said.trim().is_empty() {
            continue;
        }
        // A comment among the text is no part of a path.
        let folders = if is_path && !said.contains('<') { said.rfind(['/', '\\']) } else { None };
        let kept = folders.map_or(0, |at| at.saturating_add(1));
        out.push_str(text.get(done..range.start).unwrap_or_default());
        out.push_str(said.get(..kept).unwrap_or_default());
        out.push_str(&name);
        done = range.end;
    }
    out.push_str(text.get(done..).unwrap_or_default());
    encoded(&out, encoding)
}

/// A text in an encoding. What the encoding cannot say becomes a reference to the character.
fn encoded(text: &str, encoding: &'static Encoding) -> Vec<u8> {
    match encoding.name() {
        // There is no encoder for them.
        "UTF-16LE" => text.encode_utf16().flat_map(u16::to_le_bytes).collect(),
        "UTF-16BE" => text.encode_utf16().flat_map(u16::to_be_bytes).collect(),
        _ => encoding.encode(text).0.into_owned(),
    }
}

/// Reads an annotation for nothing but that: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(bytes: &[u8]) {
    if let Ok((text, _)) = text(bytes)
        && let Ok(found) = parse(&text)
    {
        let _ = found.faults().count();
        let renamed = renamed(bytes, "a__b__0.jpg");
        let (again, _) = self::text(&renamed).expect("text stays text");
        let again = parse(&again).expect("what is renamed is read");
        assert!(
            again.boxes.iter().flatten().map(|side| side.to_bits()).eq(found
                .boxes
                .iter()
                .flatten()
                .map(|side| side.to_bits()))
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "<annotation verified=\"yes\">\n\t<filename>a &amp; b.jpg</filename><path>C:\\pics\\a.jpg</path>\n\
        <size><width>64</width><height>48</height><depth>3</depth></size><object><name>fish</name>\
        <part><name>filename</name></part>\
        <bndbox><xmin>1</xmin><ymin>2.5</ymin><xmax>64</xmax><ymax>48</ymax></bndbox></object></annotation>\n";

    #[test]
    fn an_annotation_is_read_and_nothing_but_the_names_changes() {
        let found = parse(GOOD).unwrap();
        assert_eq!(found.filename.as_deref(), Some("a & b.jpg"));
        assert_eq!(found.size, [Some(64.0), Some(48.0)]);
        assert_eq!(found.boxes, [[1.0, 2.5, 64.0, 48.0]]);
        assert_eq!(found.faults().count(), 0);
        let renamed = String::from_utf8(renamed(GOOD.as_bytes(), "a__<w>__0.jpg")).unwrap();
        let expected = GOOD
            .replace("a &amp; b.jpg", "a__&lt;w&gt;__0.jpg")
            .replace("pics\\a.jpg", "pics\\a__&lt;w&gt;__0.jpg");
        assert_eq!(renamed, expected);
    }

    #[test]
    fn a_byte_order_mark_moves_nothing() {
        let marked = format!("\u{feff}{GOOD}");
        assert_eq!(parse(&marked).unwrap(), parse(GOOD).unwrap());
        let expected = [b"\xef\xbb\xbf".to_vec(), renamed(GOOD.as_bytes(), "w.jpg")].concat();
        assert_eq!(renamed(marked.as_bytes(), "w.jpg"), expected);
    }

    #[test]
    fn a_declared_encoding_is_read_and_written_again() {
        let declared = GOOD.replace("<name>fish", "<name>\u{9b5a}");
        for (label, encoding) in [("gb2312", encoding_rs::GBK), ("Shift_JIS", encoding_rs::SHIFT_JIS)] {
            let whole = format!("<?xml version='1.0' encoding='{label}'?>{declared}");
            let bytes = encoding.encode(&whole).0.into_owned();
            assert!(std::str::from_utf8(&bytes).is_err());
            let (text, _) = super::text(&bytes).unwrap();
            assert_eq!((text.as_ref(), parse(&text)), (whole.as_str(), parse(GOOD)));
            let new = super::renamed(&bytes, "w.jpg");
            assert_eq!(
                encoding.decode(&new).0,
                String::from_utf8(super::renamed(whole.replace(label, "utf-8").as_bytes(), "w.jpg"))
                    .unwrap()
                    .replace("utf-8", label)
            );
        }
        let said = super::text(b"<?xml encoding=\"klingon\"?><annotation/>").unwrap_err();
        assert!(said.contains("klingon"), "{said}");
        let wide: Vec<u8> = format!("\u{feff}{GOOD}").encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(parse(&super::text(&wide).unwrap().0), parse(GOOD));
        assert_eq!(
            super::renamed(&wide, "a & b.jpg").len(),
            wide.len() - 2 * "C:\\pics\\a.jpg".len() + 2 * "C:\\pics\\a &amp; b.jpg".len()
        );
    }

    #[test]
    fn a_document_type_with_entities_is_refused() {
        let inner = "<!DOCTYPE annotation [<!ENTITY x SYSTEM \"file:///etc/hostname\">]>";
        assert!(parse(&format!("{inner}{GOOD}")).unwrap_err().contains("entities"));
        assert_eq!(parse(&format!("<!DOCTYPE annotation>{GOOD}")), parse(GOOD));
    }

    #[test]
    fn a_path_with_a_comment_in_it_is_replaced_as_a_whole() {
        let odd = GOOD.replace("C:\\pics\\a.jpg", "C:\\pics<!-- a/b -->\\a.jpg");
        let renamed = String::from_utf8(renamed(odd.as_bytes(), "w.jpg")).unwrap();
        assert!(renamed.contains("<path>w.jpg</path>") && parse(&renamed).is_ok(), "{renamed}");
    }

    #[test]
    fn boxes_outside_the_image_are_named() {
        for (from, to) in [("<xmax>64", "<xmax>90"), ("<ymin>2.5", "<ymin>49.5"), ("<ymin>2.5", "<ymin>a")] {
            let found = parse(&GOOD.replace(from, to)).unwrap();
            assert_eq!(found.faults().count(), 1, "{to}");
        }
        for wrong in ["", "<a></a>", "<annotation><object>", "plain text", "<annotation></b>"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}

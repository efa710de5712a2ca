//! Annotations of a dataset of one image, `images/a.png`: as tools write them, and what must not be taken.

use super::list::Right::{self, Accept, Any, Refuse};
use super::seeds::{HEIGHT, WIDTH};

/// A file of annotations.
pub(crate) struct Label {
    /// What is unusual, which names its dataset.
    pub(crate) name: String,
    pub(crate) right: Right,
    /// Its path in the dataset.
    pub(crate) path: &'static str,
    pub(crate) bytes: Vec<u8>,
}

const MARK: &[u8] = b"\xef\xbb\xbf";

/// Every file of annotations.
pub(crate) fn labels() -> Vec<Label> {
    [yolo(), coco(), voc(), lists()].into_iter().flatten().collect()
}

fn label(path: &'static str, right: Right, name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Label {
    Label { name: name.into(), right, path, bytes: bytes.into() }
}

fn utf16(text: &str) -> Vec<u8> {
    [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
}

fn yolo() -> Vec<Label> {
    let good = "0 0.5 0.5 0.2 0.2\n";
    let of = |right, name: &str, bytes: &[u8]| label("labels/a.txt", right, format!("yolo-{name}"), bytes);
    let mut all = vec![
        of(Accept, "byte-order-mark", &[MARK, good.as_bytes()].concat()),
        of(Accept, "windows-lines", b"0 0.5 0.5 0.2 0.2\r\n1 0.5 0.5 0.2 0.2\r\n"),
        of(Accept, "utf-16", &utf16(good)),
        of(Refuse, "zeros", &[0; 64]),
        of(Refuse, "lone-continuation", b"0 0.5 0.5 0.2 0.2 \x80\n"),
        of(Any, "megabytes-of-blanks", &b" ".repeat(4 << 20)),
        of(Any, "million-lines", good.repeat(1 << 20).as_bytes()),
        of(Refuse, "one-line-of-megabytes", "0.5 ".repeat(1 << 20).as_bytes()),
    ];
    for (name, text) in [
        ("empty", ""),
        ("blank-lines", "\n\n0 0.5 0.5 0.2 0.2\n\n"),
        ("tabs", "0\t0.5\t0.5\t0.2\t0.2"),
        ("float-class", "0.0 0.5 0.5 0.2 0.2"),
        ("overhang", "0 0.9 0.5 0.205 0.2"),
        ("confidence", "0 0.5 0.5 0.2 0.2 0.87"),
        ("outline", "0 0.1 0.1 0.9 0.1 0.5 0.9"),
        ("pose", "0 0.5 0.5 0.2 0.2 0.5 0.5 2 0.1 0.1 0"),
        ("exponents", "0 5e-1 5E-1 2e-1 2e-1"),
    ] {
        all.push(of(Accept, name, text.as_bytes()));
    }
    for (name, text) in [
        ("word", "fish 0.5 0.5 0.2 0.2"),
        ("negative-class", "-1 0.5 0.5 0.2 0.2"),
        ("half-class", "0.5 0.5 0.5 0.2 0.2"),
        ("nan", "0 nan 0.5 0.2 0.2"),
        ("infinity", "0 0.5 0.5 inf 0.2"),
        ("beyond-floats", "0 1e999 0.5 0.2 0.2"),
        ("three-numbers", "0 0.5 0.5 0.2"),
        ("outside", "0 0.9 0.5 0.9 0.2"),
        ("pixels", "0 24 16 10 10"),
        ("negative-width", "0 0.5 0.5 -0.2 0.2"),
        ("comma-decimals", "0 0,5 0,5 0,2 0,2"),
        ("commas", "0,0.5,0.5,0.2,0.2"),
        ("json", "[{\"class\": 0}]"),
    ] {
        all.push(of(Refuse, name, text.as_bytes()));
    }
    all
}

/// A file of COCO with this image and this annotation, beside others that are right.
fn coco_of(image: &str, annotation: &str) -> String {
    format!(
        r#"{{"images": [{{"id": 1, "file_name": "a.png", "width": {WIDTH}, "height": {HEIGHT}}}{image}],
        "annotations": [{{"id": 1, "image_id": 1, "category_id": 1, "bbox": [1, 2, 3, 4]}}{annotation}],
        "categories": [{{"id": 1, "name": "fish"}}]}}"#
    )
}

fn coco() -> Vec<Label> {
    let good = coco_of("", "");
    let of = |right, name: &str, bytes: &[u8]| label("instances.json", right, format!("coco-{name}"), bytes);
    let deep = format!(", \"x\": {}1{}", "[".repeat(100_000), "]".repeat(100_000));
    let long = format!("\"area\": {}", "9".repeat(1 << 20));
    let mut all = vec![
        of(Accept, "byte-order-mark", &[MARK, good.as_bytes()].concat()),
        of(Accept, "float-ids", good.replace("\"image_id\": 1", "\"image_id\": 1.0").as_bytes()),
        of(Accept, "empty-box", good.replace("[1, 2, 3, 4]", "[]").as_bytes()),
        of(Accept, "backslashes", good.replace("a.png", r"images\\a.png").as_bytes()),
        of(
            Accept,
            "string-ids",
            good.replace("\"id\": 1,", "\"id\": \"u\",")
                .replace("\"image_id\": 1", "\"image_id\": \"u\"")
                .as_bytes(),
        ),
        of(Accept, "utf-16", &utf16(&good)),
        of(Refuse, "lone-continuation", &[good.as_bytes(), b"\x80"].concat()),
        of(Refuse, "cut", &good.as_bytes()[..100]),
        of(Refuse, "nan", good.replace("\"bbox\"", "\"area\": NaN, \"bbox\"").as_bytes()),
        of(Refuse, "infinity", good.replace("\"bbox\"", "\"score\": -Infinity, \"bbox\"").as_bytes()),
        of(Refuse, "comma-too-many", good.replace("4]}", "4]},").as_bytes()),
        of(Refuse, "comments", format!("// fish\n{good}").as_bytes()),
        of(Refuse, "single-quotes", good.replace('"', "'").as_bytes()),
        of(
            Refuse,
            "lists-twice",
            good.replace("\"categories\"", "\"images\": [], \"categories\"").as_bytes(),
        ),
        of(Refuse, "brackets", "[".repeat(100_000).as_bytes()),
        of(Any, "deep-field", good.replacen("\"id\": 1", &format!("\"id\": 1{deep}"), 1).as_bytes()),
        of(Any, "long-number", good.replace("\"bbox\"", &format!("{long}, \"bbox\"")).as_bytes()),
    ];
    for (name, id) in [
        ("id-null", "null"),
        ("id-a-list", "[1]"),
        ("id-half", "1.5"),
        ("id-beyond", "9223372036854775808"),
        ("id-huge", "1e300"),
        ("id-missing", "2"),
    ] {
        let other = format!(", {{\"id\": 2, \"image_id\": {id}, \"bbox\": [1, 2, 3, 4]}}");
        all.push(of(Refuse, name, coco_of("", &other).as_bytes()));
    }
    for (name, sides) in [
        ("box-of-words", "[\"a\", 2, 3, 4]"),
        ("box-of-three", "[1, 2, 3]"),
        ("box-negative", "[1, 2, -3, 4]"),
        ("box-outside", "[1, 2, 900, 4]"),
        ("box-an-object", "{\"x\": 1}"),
    ] {
        let other = format!(", {{\"id\": 2, \"image_id\": 1, \"bbox\": {sides}}}");
        all.push(of(Refuse, name, coco_of("", &other).as_bytes()));
    }
    for (name, path) in [
        ("name-above", "../a.png"),
        ("name-absolute", "/etc/passwd"),
        ("name-with-drive", r"C:\\a.png"),
        ("name-empty", ""),
        ("name-with-zero", r"a\u0000.png"),
        ("name-missing-image", "b.png"),
    ] {
        let other = format!(", {{\"id\": 2, \"file_name\": \"{path}\"}}");
        all.push(of(Refuse, name, coco_of(&other, "").as_bytes()));
    }
    all
}

/// An annotation with other bytes for the name of its class.
fn with_bytes(annotation: &str, class: &[u8]) -> Vec<u8> {
    let (before, after) = annotation.split_once("fish").unwrap_or_default();
    [before.as_bytes(), class, after.as_bytes()].concat()
}

fn voc() -> Vec<Label> {
    let sides = "<xmin>1</xmin><ymin>1</ymin><xmax>9</xmax><ymax>9</ymax>";
    let object = |sides: &str| format!("<object><name>fish</name><bndbox>{sides}</bndbox></object>");
    let of_file = |name: &str, object: &str| {
        format!(
            "<annotation><filename>{name}</filename><size><width>{WIDTH}</width><height>{HEIGHT}</height></size>{object}</annotation>"
        )
    };
    let good = of_file("a.png", &object(sides));
    let of =
        |right, name: &str, bytes: &[u8]| label("Annotations/a.xml", right, format!("voc-{name}"), bytes);
    let entity = "<!DOCTYPE annotation [<!ENTITY a \"aa\"><!ENTITY b \"&a;&a;&a;&a;\">]>";
    // "Fish" in Chinese.
    let gb2312 = with_bytes(&good, &[0xd3, 0xe3]);
    let deep = format!("{}{}", "<part>".repeat(100_000), "</part>".repeat(100_000));
    vec![
        of(Accept, "byte-order-mark", &[MARK, good.as_bytes()].concat()),
        of(Accept, "gb2312", &[&b"<?xml version=\"1.0\" encoding=\"gb2312\"?>"[..], &gb2312].concat()),
        of(Accept, "comments", good.replace("<size>", "<!-- x --><size>").as_bytes()),
        of(Accept, "no-extension", of_file("a", &object(sides)).as_bytes()),
        of(Accept, "utf-16", &utf16(&good)),
        of(
            Refuse,
            "encoding-unknown",
            format!("<?xml version=\"1.0\" encoding=\"klingon\"?>{good}").as_bytes(),
        ),
        of(Refuse, "no-text", &with_bytes(&good, &[0xff])),
        of(Refuse, "cut", &good.as_bytes()[..good.len() / 2]),
        of(Refuse, "entities", format!("{entity}{}", good.replace("fish", "&b;")).as_bytes()),
        of(
            Refuse,
            "file-entity",
            format!(
                "<!DOCTYPE annotation [<!ENTITY x SYSTEM \"file:///etc/hostname\">]>{}",
                good.replace("fish", "&x;")
            )
            .as_bytes(),
        ),
        of(
            Refuse,
            "file-document-type",
            format!("<!DOCTYPE annotation SYSTEM \"http://localhost/x.dtd\">{good}").as_bytes(),
        ),
        of(Refuse, "name-above", of_file("../a.png", &object(sides)).as_bytes()),
        of(Refuse, "name-absolute", of_file("/etc/passwd", &object(sides)).as_bytes()),
        of(Refuse, "box-of-words", of_file("a.png", &object(&sides.replace('9', "wide"))).as_bytes()),
        of(Refuse, "box-nan", of_file("a.png", &object(&sides.replace('9', "NaN"))).as_bytes()),
        of(
            Refuse,
            "box-turned-round",
            of_file("a.png", &object("<xmin>9</xmin><ymin>9</ymin><xmax>1</xmax><ymax>1</ymax>")).as_bytes(),
        ),
        of(Refuse, "box-outside", of_file("a.png", &object(&sides.replace('9', "900"))).as_bytes()),
        of(
            Refuse,
            "box-of-three",
            of_file("a.png", &object("<xmin>1</xmin><ymin>1</ymin><xmax>9</xmax>")).as_bytes(),
        ),
        of(Any, "deep-parts", of_file("a.png", &deep).as_bytes()),
        of(
            Refuse,
            "tags-crossed",
            good.replace("</object></annotation>", "</annotation></object>").as_bytes(),
        ),
    ]
}

/// Lists of images beside labels that are right.
fn lists() -> Vec<Label> {
    let of = |right, name: &str, bytes: &[u8]| label("train.txt", right, format!("list-{name}"), bytes);
    vec![
        of(Accept, "byte-order-mark", &[MARK, b"images/a.png\n"].concat()),
        of(Accept, "windows", b"images\\a.png\r\n"),
        of(Accept, "other-machine", b"/home/me/fish/images/a.png\n"),
        of(Accept, "names", b"a\n"),
        of(Any, "missing-image", b"images/a.png\nimages/b.png\n"),
        of(Any, "name-above", b"../../etc/passwd\nimages/a.png\n"),
        of(Accept, "utf-16", &utf16("images/a.png\n")),
        of(Any, "million-lines", b"images/a.png\n".repeat(1 << 20).as_slice()),
    ]
}

//! Where the objects of an image are, as its annotations say: to be drawn, so that people see whether they fit.

use std::collections::BTreeMap;

use super::coco::{Annotation, Id, each, image_at, lists, object};
use super::{Companion, Layout, Naming, split, voc};

/// An outline in shares of the image's sides, from its left upper corner.
pub(crate) type Outline = Vec<[f64; 2]>;

/// Outlines of an image, at most: nobody could tell more apart, and drawing them would take minutes.
pub(crate) const MOST: usize = 1000;

/// The outline of a box.
fn of_box([left, top, right, bottom]: [f64; 4]) -> Outline {
    vec![[left, top], [right, top], [right, bottom], [left, bottom], [left, top]]
}

/// The outlines in a file about one image of `size` pixels.
pub(crate) fn of_companion(
    layout: Layout,
    companion: &Companion,
    bytes: &[u8],
    size: (usize, usize),
) -> Vec<Outline> {
    let in_shares = |sides: [f64; 4]| {
        let [width, height] = [size.0.max(1) as f64, size.1.max(1) as f64];
        let [left, top, right, bottom] = sides;
        of_box([left / width, top / height, right / width, bottom / height])
    };
    match (layout, companion.naming) {
        (_, Naming::Voc) => voc::boxes(bytes).into_iter().map(in_shares).take(MOST).collect(),
        (Layout::Yolo, Naming::Nothing) if companion.path.ends_with(".txt") => {
            String::from_utf8_lossy(bytes).lines().filter_map(of_line).take(MOST).collect()
        }
        _ => Vec::new(),
    }
}

/// The outline of a line of YOLO.
fn of_line(line: &str) -> Option<Outline> {
    let numbers: Vec<f64> =
        line.split_ascii_whitespace().skip(1).map_while(|text| text.parse().ok()).collect();
    match numbers.as_slice() {
        outline if outline.len() >= 6 && outline.len() % 2 == 0 => {
            let corners =
                outline.chunks_exact(2).filter_map(|corner| Some([*corner.first()?, *corner.last()?]));
            let corners: Outline = corners.collect();
            Some(corners.iter().chain(corners.first()).copied().collect())
        }
        &[x, y, w, h, ..] => Some(of_box([x - w / 2.0, y - h / 2.0, x + w / 2.0, y + h / 2.0])),
        _ => None,
    }
}

/// The boxes of the images of these keys in a file of COCO, in shares of their sides.
pub(crate) fn of_coco(text: &str, keys: &[&str]) -> BTreeMap<String, Vec<Outline>> {
    let (mut found, mut by_id) = (BTreeMap::<String, Vec<Outline>>::new(), BTreeMap::new());
    let Ok([images, annotations]) = lists(text) else { return found };
    let _ = each(images, &mut |place, raw| {
        let image = image_at(place, raw)?;
        let said = image.file_name.replace('\\', "/");
        let is_it = |key: &&&str| **key == said || key.ends_with(&format!("/{said}")) || split(key).1 == said;
        if let (Some(key), Ok(id), Some(size)) = (keys.iter().find(is_it), Id::of(image.id), image.size()) {
            by_id.insert(id, ((*key).to_owned(), size));
        }
        Ok(())
    });
    let _ = each(annotations, &mut |_, raw| {
        let Ok(annotation) = object::<Annotation<'_>>(raw.get()) else { return Ok(()) };
        let image = Id::of(annotation.image_id).ok().and_then(|id| by_id.get(&id));
        if let (Some((key, [width, height])), Some([x, y, w, h])) = (image, annotation.sides()) {
            let sides = [x / width, y / height, (x + w) / width, (y + h) / height];
            let outlines = found.entry(key.clone()).or_default();
            if outlines.len() < MOST {
                outlines.push(of_box(sides));
            }
        }
        Ok(())
    });
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_of_every_format_are_shares_of_the_image() {
        let square = of_box([0.25, 0.25, 0.75, 0.75]);
        assert_eq!(of_line("3 0.5 0.5 0.5 0.5"), Some(square.clone()));
        assert_eq!(of_line("3 0.25 0.25 0.75 0.25 0.75 0.75 0.25 0.75"), Some(square.clone()));
        assert_eq!(of_line(""), None);
        let voc = Companion { path: "a.xml".into(), naming: Naming::Voc };
        let xml = "<annotation><object><bndbox><xmin>10</xmin><ymin>5</ymin><xmax>30</xmax><ymax>15</ymax></bndbox></object></annotation>";
        assert_eq!(of_companion(Layout::Voc, &voc, xml.as_bytes(), (40, 20)), std::slice::from_ref(&square));
        let coco = r#"{"images": [{"id": 1, "file_name": "x\\a.jpg", "width": 40, "height": 20}],
            "annotations": [{"image_id": 1, "bbox": [10, 5, 20, 10]}, {"image_id": 2, "bbox": [0, 0, 1, 1]}]}"#;
        let found = of_coco(coco, &["images/x/a.jpg", "images/b.jpg"]);
        assert_eq!(found, BTreeMap::from([("images/x/a.jpg".to_owned(), vec![square])]));
        let yolo = Companion { path: "a.txt".into(), naming: Naming::Nothing };
        let many = "0 0.5 0.5 0.5 0.5\n".repeat(2 * MOST);
        assert_eq!(of_companion(Layout::Yolo, &yolo, many.as_bytes(), (40, 20)).len(), MOST);
    }
}

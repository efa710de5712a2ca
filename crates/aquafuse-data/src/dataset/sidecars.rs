//! Files of any kind that belong to one image: they have its stem and an extension that was given. They go with each variant,
//! and the name of the image in them becomes the variant's name.

use super::places::{Stems, of_images};
use super::tree::Tree;
use super::{Companion, Dataset, Naming, split, stem};

/// What folders of such files may be called beside their own names.
const FOLDERS: [&str; 10] =
    ["labels", "label", "annotations", "annotation", "annos", "anno", "json", "jsons", "meta", "sidecars"];

/// Gives each image its files with these extensions.
pub(super) fn attach(tree: &Tree, extensions: &[String], dataset: &mut Dataset) {
    for extension in extensions {
        let end = format!(".{}", extension.trim_start_matches('.').to_lowercase());
        let keys: Vec<String> = dataset.samples.iter().map(|sample| sample.key.clone()).collect();
        let stems = Stems::of(keys.iter());
        for path in tree.ending(&end) {
            let (folder, name) = split(path);
            let own = name.len().checked_sub(end.len()).and_then(|at| name.get(..at)).unwrap_or_default();
            let places = of_images(folder, &FOLDERS);
            // `NAME.json`, or `NAME.jpg.json`.
            let of_stem = |stem_of: &str| {
                let found = places.iter().find_map(|place| stems.get(place, stem_of).first().copied());
                found.and_then(|key| dataset.samples.binary_search_by(|sample| sample.key.cmp(key)).ok())
            };
            let Some(at) = of_stem(own).or_else(|| of_stem(stem(own))) else { continue };
            let Some(sample) = dataset.samples.get_mut(at) else { continue };
            if sample.companions.iter().all(|companion| companion.path != *path) {
                sample.companions.push(Companion { path: path.clone(), naming: Naming::Anywhere });
            }
        }
    }
}

/// A file in which the variant's file name replaces the image's. Pixels that labelme puts into its files are
/// those of the image: they are left out, so that labelme reads the variant.
pub(super) fn renamed(bytes: &[u8], image: &str, variant: &str) -> Vec<u8> {
    // Of files that are no text, the bytes that look like the name may be anything.
    if bytes.contains(&0) {
        return bytes.to_owned();
    }
    let mut out = Vec::with_capacity(bytes.len());
    let is_part = |byte: Option<&u8>| {
        byte.is_some_and(|byte| {
            byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.') || *byte >= 0x80
        })
    };
    let mut rest = bytes;
    let mut before = None;
    while let Some((first, after)) = rest.split_first() {
        if let Some(behind) = rest.strip_prefix(image.as_bytes())
            && !is_part(before.as_ref())
            && !is_part(behind.first().filter(|byte| **byte != b'.'))
        {
            out.extend_from_slice(variant.as_bytes());
            before = image.bytes().last();
            rest = behind;
            continue;
        }
        out.push(*first);
        before = Some(*first);
        rest = after;
    }
    without_pixels(out)
}

/// The value of `imageData` becomes null.
fn without_pixels(bytes: Vec<u8>) -> Vec<u8> {
    const KEY: &[u8] = b"\"imageData\"";
    let Some(at) = bytes.windows(KEY.len()).position(|word| word == KEY) else { return bytes };
    let (head, tail) = bytes.split_at(at.saturating_add(KEY.len()));
    let spaces = tail.iter().take_while(|byte| byte.is_ascii_whitespace() || **byte == b':').count();
    let (between, value) = tail.split_at(spaces);
    let Some(text) = value.strip_prefix(b"\"") else { return bytes };
    // Base64 has no escapes.
    let Some(end) = text.iter().position(|byte| *byte == b'"') else { return bytes };
    let behind = text.get(end.saturating_add(1)..).unwrap_or_default();
    [head, between, b"null", behind].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_the_image_becomes_that_of_the_variant_and_no_part_of_another_name() {
        let text = br#"{"imagePath": "..\\img\\a.jpg", "of": "a.jpg.", "not": "aa.jpg a.jpg2 b_a.jpg", "imageData": "/9j/4A=="}"#;
        let expected = br#"{"imagePath": "..\\img\\a__w__0.jpg", "of": "a__w__0.jpg.", "not": "aa.jpg a.jpg2 b_a.jpg", "imageData": null}"#;
        assert_eq!(renamed(text, "a.jpg", "a__w__0.jpg"), expected);
        assert_eq!(renamed(b"\xff\xfe a.jpg", "a.jpg", "b.jpg"), b"\xff\xfe b.jpg");
        assert_eq!(renamed(b"\0 a.jpg", "a.jpg", "b.jpg"), b"\0 a.jpg");
        assert_eq!(renamed(br#"{"imageData": null}"#, "a.jpg", "b.jpg"), br#"{"imageData": null}"#);
    }
}

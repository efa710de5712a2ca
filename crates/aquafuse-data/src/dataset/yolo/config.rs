//! Where the configuration of a dataset of YOLO says that the images of each split are.

use super::super::splits::Split;

/// The folders or lists of each split: `train: images/train`, `val: [a, b]`, or a list below.
pub(crate) fn splits_of_config(text: &str) -> Vec<(Split, String)> {
    let (mut found, mut of) = (Vec::new(), None);
    for line in text.lines() {
        let line = line.split(" #").next().unwrap_or_default().trim_end();
        let value = |text: &str| text.trim().trim_matches(['"', '\'']).to_owned();
        if let Some((name, rest)) = line.split_once(':').filter(|_| !line.starts_with([' ', '-', '#'])) {
            of = match name.trim() {
                "train" => Some(Split::Train),
                "val" | "valid" | "validation" => Some(Split::Val),
                "test" => Some(Split::Test),
                _ => None,
            };
            let list = rest.trim().trim_start_matches('[').trim_end_matches(']');
            found.extend(of.into_iter().flat_map(|of| list.split(',').map(move |one| (of, value(one)))));
        } else if let (Some(of), Some(one)) = (of, line.trim_start().strip_prefix("- ")) {
            found.push((of, value(one)));
        }
    }
    found.retain(|(_, place)| !place.is_empty());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_names_folders_and_lists() {
        let text = "path: ../fish\ntrain: ../train/images # most\nval: [a, 'b c']\ntest:\n  - x.txt\n- y\nnames:\n  0: train\nnc: 1\n";
        let expected = [
            (Split::Train, "../train/images"),
            (Split::Val, "a"),
            (Split::Val, "b c"),
            (Split::Test, "x.txt"),
            (Split::Test, "y"),
        ];
        assert_eq!(splits_of_config(text), expected.map(|(split, place)| (split, place.to_owned())));
        assert_eq!(splits_of_config("names:\n  0: train\n  train: 1\n"), []);
    }
}

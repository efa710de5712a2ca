//! Lists of images: a path a line, or a name without extension.

use std::collections::BTreeSet;

use super::places::Stems;
use super::tree::Tree;
use super::{Dataset, Index, split};

/// The folder of Pascal VOC that holds nothing but lists.
const LISTS: &str = "imagesets";

/// Finds the lists among the files that are not part of the dataset yet.
pub(super) fn attach(tree: &Tree, dataset: &mut Dataset) {
    let used: BTreeSet<&str> = {
        let companions = dataset.samples.iter().flat_map(|sample| &sample.companions);
        companions
            .map(|companion| companion.path.as_str())
            .chain(dataset.indices.iter().map(Index::path))
            .collect()
    };
    let keys: BTreeSet<&str> = dataset.samples.iter().map(|sample| sample.key.as_str()).collect();
    let stems = Stems::of(dataset.samples.iter().map(|sample| &sample.key));
    let folders: BTreeSet<&str> = keys.iter().map(|key| split(key).0).collect();
    let mut found = Vec::new();
    for path in tree.ending(".txt").filter(|path| !used.contains(path.as_str())) {
        let is_list = path.to_lowercase().split('/').any(|part| part == LISTS);
        let Ok(Some(text)) = tree.read(path) else { continue };
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        if lines.clone().any(|line| named(line, |name| keys.contains(name)).is_some()) {
            found.push(Index::Paths { path: path.clone() });
            continue;
        }
        let name = |line: &'_ str| line.split_whitespace().next().unwrap_or_default().to_owned();
        let of = |folder: &&&str| {
            let count = lines.clone().filter(|line| !stems.get(folder, &name(line)).is_empty()).count();
            count > 0 && (is_list || count.saturating_mul(2) > lines.clone().count())
        };
        match folders.iter().find(of) {
            Some(folder) => found.push(Index::Stems { path: path.clone(), folder: (*folder).to_owned() }),
            None if is_list && lines.next().is_none() => found.push(Index::Carried { path: path.clone() }),
            None => {}
        }
    }
    dataset.indices.extend(found);
}

/// The image that a line of a list names, whatever folders of another machine stand before its path.
pub(crate) fn named(line: &str, holds: impl Fn(&str) -> bool) -> Option<String> {
    let begins =
        std::iter::once(0).chain(line.match_indices(['/', '\\']).map(|(at, _)| at.saturating_add(1)));
    begins.filter_map(|at| line.get(at..)).find_map(|path| {
        let path = path.replace('\\', "/");
        holds(path.trim_end()).then(|| path.trim_end().to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_found_behind_folders_of_other_machines() {
        let holds = |path: &str| path == "images/a.jpg";
        for line in ["images/a.jpg", "./images/a.jpg", "data/images/a.jpg ", "C:\\x\\images\\a.jpg"] {
            assert_eq!(named(line, holds).as_deref(), Some("images/a.jpg"), "{line}");
        }
        assert_eq!(named("a.jpg", holds), None);
    }
}

//! Where the image of a `file_name` stands: by the habits of those who write such files, or wherever one image is called so.

use std::collections::HashMap;

use super::super::tree::Tree;
use super::super::{inside, join, split, stem};

/// Splits of datasets, by the beginnings of their names.
const SPLITS: [(&str, &str); 4] = [("train", "train"), ("val", "val"), ("test", "test"), ("dev", "val")];

/// The images of a dataset, by their names in small letters.
pub(super) struct Pictures<'t> {
    tree: &'t Tree,
    by_name: HashMap<String, Vec<&'t String>>,
}

/// The images that a name may mean.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Located<'t> {
    None,
    One(&'t String),
    /// More than one; the first two.
    Several(&'t String, &'t String),
}

impl<'t> Pictures<'t> {
    pub(super) fn of(tree: &'t Tree) -> Self {
        let mut by_name: HashMap<String, Vec<&String>> = HashMap::new();
        for path in tree.images() {
            by_name.entry(split(path).1.to_lowercase()).or_default().push(path);
        }
        Self { tree, by_name }
    }

    /// The image of a name in a file; why the name is none otherwise.
    pub(super) fn locate(&self, file: &str, said: &str) -> Result<Located<'t>, &'static str> {
        let name = inside(said)?;
        if let Some(found) = self.by_habit(file, &name) {
            return Ok(Located::One(found));
        }
        // Windows writes folders so.
        let name = name.replace('\\', "/");
        if let Some(found) = self.by_habit(file, &name) {
            return Ok(Located::One(found));
        }
        Ok(self.anywhere(file, &name))
    }

    /// The image in one of the folders where images of such a file stand.
    fn by_habit(&self, file: &str, name: &str) -> Option<&'t String> {
        let (folder, file_name) = split(file);
        let above = split(folder).0;
        let part = stem(file_name).rsplit('_').next().unwrap_or_default();
        let beside = [folder.to_owned(), join(folder, "images")];
        let around = ["".to_owned(), "images".into(), part.to_owned(), join("images", part)];
        let around = around.map(|folder| if above.is_empty() { folder } else { join(above, &folder) });
        beside.into_iter().chain(around).find_map(|folder| self.tree.any_case(&join(&folder, name)))
    }

    /// The image whose path ends so, if it is of the split of the file: of more than one that which is nearest.
    fn anywhere(&self, file: &str, name: &str) -> Located<'t> {
        let end = format!("/{}", name.to_lowercase());
        let split_of_file = split_of(file);
        let fits = |path: &&&String| {
            let own = split_of(split(path).0);
            format!("/{}", path.to_lowercase()).ends_with(&end)
                && (own.is_none() || split_of_file.is_none() || own == split_of_file)
        };
        let named = self.by_name.get(&split(name).1.to_lowercase());
        let mut found: Vec<&String> = named.into_iter().flatten().filter(fits).copied().collect();
        if split_of_file.is_some() && found.iter().any(|path| split_of(split(path).0) == split_of_file) {
            found.retain(|path| split_of(split(path).0) == split_of_file);
        }
        let shared =
            |path: &str| path.split('/').zip(file.split('/')).take_while(|(one, other)| one == other).count();
        let nearest = found.iter().map(|path| shared(path)).max();
        found.retain(|path| Some(shared(path)) == nearest);
        match found.as_slice() {
            [] => Located::None,
            [one] => Located::One(one),
            [one, other, ..] => Located::Several(one, other),
        }
    }
}

/// The split that a path names, the last one.
fn split_of(path: &str) -> Option<&'static str> {
    let small = path.to_lowercase();
    let words = small.rsplit(|character: char| !character.is_alphanumeric());
    let of = |word: &str| SPLITS.iter().find(|(begin, _)| word.starts_with(begin)).map(|(_, split)| *split);
    words.into_iter().find_map(of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image_file::ReadOptions;

    #[test]
    fn an_image_is_found_where_datasets_have_it() {
        let files = [
            "version/train/a.jpg",
            "version/val/a.jpg",
            "pics/deep/b.JPG",
            "SET/SET_pic/test/t.jpg",
            "one/twice.jpg",
            "two/twice.jpg",
        ];
        let tree =
            Tree::holding("".into(), files.map(str::to_owned).into_iter().collect(), &ReadOptions::default());
        let pictures = Pictures::of(&tree);
        for (file, said, path) in [
            ("version/instances_train_fish.json", "a.jpg", Some("version/train/a.jpg")),
            ("version/instances_val_fish.json", "a.jpg", Some("version/val/a.jpg")),
            ("annotations/instances_test2017.json", "a.jpg", None),
            ("labels.json", "b.jpg", Some("pics/deep/b.JPG")),
            ("labels.json", "deep\\b.jpg", Some("pics/deep/b.JPG")),
            ("labels.json", "wide/b.jpg", None),
            ("SET/SET_ANN/instances_test.json", "t.jpg", Some("SET/SET_pic/test/t.jpg")),
        ] {
            let found = match pictures.locate(file, said).unwrap() {
                Located::One(found) => Some(found.as_str()),
                _ => None,
            };
            assert_eq!(found, path, "{file}: {said}");
        }
        assert!(matches!(pictures.locate("labels.json", "twice.jpg"), Ok(Located::Several(..))));
        assert_eq!(
            pictures.locate("one/labels.json", "twice.jpg"),
            Ok(Located::One(tree.files.get("one/twice.jpg").unwrap()))
        );
        assert!(pictures.locate("labels.json", "..\\b.jpg").is_err());
    }
}

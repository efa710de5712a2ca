//! Images by groups, and which content meets which reference.

use std::path::{Path, PathBuf};

use super::chance::Chance;
use super::error::EvaluateError;
use crate::files::{FileError, display};
use crate::image_file;

/// An image of an evaluation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Where it stands.
    pub path: PathBuf,
    /// Its name in reports: the path from the folder on.
    pub name: String,
    /// Its group.
    pub group: String,
}

/// What makes images a group.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroupBy {
    /// Nothing: there is one group, of all.
    #[default]
    Nothing,
    /// The subfolders; images directly in the folder are the group with its name.
    Folder,
    /// What the name of the file has before its first `_`.
    Prefix,
}

/// Which pairs are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pairing {
    /// References of each content, drawn; none: all of them.
    pub references: Option<usize>,
    /// What they are drawn by.
    pub seed: u64,
}

impl GroupBy {
    /// The images of a folder with their groups, by name.
    ///
    /// # Errors
    ///
    /// [`EvaluateError`] when the folder cannot be listed, or holds no image.
    pub fn list(self, folder: &Path) -> Result<Vec<Member>, EvaluateError> {
        let mut members = self.members_in(folder, None)?;
        if self == Self::Folder {
            let failed = |error| FileError::Read { path: folder.to_owned(), error };
            for entry in std::fs::read_dir(folder).map_err(failed)? {
                let path = entry.map_err(failed)?.path();
                let name = path.file_name().unwrap_or_default();
                if path.is_dir() && !name.as_encoded_bytes().starts_with(b".") {
                    members.extend(self.members_in(&path, Some(&display(name.as_ref()).to_string()))?);
                }
            }
        }
        if members.is_empty() {
            return Err(EvaluateError::NoImages { folder: folder.to_owned() });
        }
        members.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(members)
    }

    /// The images that stand directly in a folder, or in one of its folders.
    fn members_in(self, folder: &Path, inner: Option<&str>) -> Result<Vec<Member>, EvaluateError> {
        let member = |path: PathBuf| {
            let file = display(path.file_name().unwrap_or_default().as_ref()).to_string();
            let group = match (self, inner) {
                (Self::Nothing, _) => "all".to_owned(),
                (Self::Folder, Some(inner)) => inner.to_owned(),
                (Self::Folder, None) => name_of(folder),
                (Self::Prefix, _) => {
                    let stem = display(path.file_stem().unwrap_or_default().as_ref()).to_string();
                    stem.split('_').next().unwrap_or_default().to_owned()
                }
            };
            let name = inner.map_or_else(|| file.clone(), |inner| format!("{inner}/{file}"));
            Member { path, name, group }
        };
        Ok(image_file::list(folder)?.images.into_iter().map(member).collect())
    }
}

/// The name of a folder, also of one that is called `.`.
fn name_of(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    display(whole.file_name().unwrap_or_default().as_ref()).to_string()
}

impl Member {
    /// Its name without folder and extension, as outputs are named after it.
    pub fn stem(&self) -> String {
        display(self.path.file_stem().unwrap_or_default().as_ref()).to_string()
    }
}

impl Pairing {
    /// The references of each content, as places in their list: those of another group, or, where there is but one
    /// group, all but the content's own file. What is drawn for a content depends on the names alone.
    pub(crate) fn pairs(&self, contents: &[Member], references: &[Member]) -> Vec<Vec<usize>> {
        let one_group = contents.iter().chain(references).all(|member| member.group == "all");
        let identity = |member: &Member| member.path.canonicalize().unwrap_or_else(|_| member.path.clone());
        let files: Vec<PathBuf> = references.iter().map(identity).collect();
        let of = |content: &Member| {
            let own = identity(content);
            let others = references.iter().zip(&files).enumerate();
            let mut meets: Vec<(u64, usize)> = others
                .filter(|(_, (reference, file))| match one_group {
                    true => **file != own,
                    false => reference.group != content.group,
                })
                .map(|(place, (reference, _))| {
                    (Chance::keyed(self.seed, &[&content.name, &reference.name]).number(), place)
                })
                .collect();
            if let Some(most) = self.references {
                meets.sort_unstable();
                meets.truncate(most);
            }
            let mut places: Vec<usize> = meets.into_iter().map(|(_, place)| place).collect();
            places.sort_unstable();
            places
        };
        contents.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn member(group: &str, name: &str) -> Member {
        Member { path: format!("{group}/{name}").into(), name: name.into(), group: group.into() }
    }

    fn groups() -> Vec<Member> {
        let groups = [("blue", 5), ("green", 4), ("turbid", 6)];
        groups
            .iter()
            .flat_map(|(group, count)| (0..*count).map(move |i| member(group, &format!("{group}_{i}"))))
            .collect()
    }

    #[test]
    fn every_content_meets_every_reference_of_another_group() {
        let all = groups();
        for (content, meets) in all.iter().zip(Pairing::default().pairs(&all, &all)) {
            let expected: Vec<usize> = (0..all.len()).filter(|&i| all[i].group != content.group).collect();
            assert_eq!(meets, expected);
        }
    }

    #[test]
    fn in_one_group_no_content_is_its_own_reference() {
        let all: Vec<Member> = (0..4).map(|i| member("all", &i.to_string())).collect();
        assert_eq!(Pairing::default().pairs(&all, &all)[2], [0, 1, 3]);
    }

    #[test]
    fn folders_and_prefixes_are_groups() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["blue", "green", ".hidden"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
        }
        for name in ["blue/a_1.png", "green/b.jpg", ".hidden/c.png", "near_1.png", "far_2.png"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let found = |by: GroupBy| {
            let members = by.list(folder.path()).unwrap();
            members.into_iter().map(|member| (member.name, member.group)).collect::<Vec<_>>()
        };
        let own = name_of(folder.path());
        let pair = |name: &str, group: &str| (name.to_owned(), group.to_owned());
        assert_eq!(
            found(GroupBy::Folder),
            [
                pair("blue/a_1.png", "blue"),
                pair("far_2.png", &own),
                pair("green/b.jpg", "green"),
                pair("near_1.png", &own)
            ]
        );
        assert_eq!(found(GroupBy::Prefix), [pair("far_2.png", "far"), pair("near_1.png", "near")]);
        assert_eq!(found(GroupBy::Nothing), [pair("far_2.png", "all"), pair("near_1.png", "all")]);
    }

    proptest! {
        #[test]
        fn what_is_drawn_for_a_content_depends_on_neither_the_order_nor_the_other_contents(
            seed: u64,
            most in 1..8_usize,
            turn in 0..15_usize,
        ) {
            let pairing = Pairing { references: Some(most), seed };
            let all = groups();
            let mut turned = all.clone();
            turned.rotate_left(turn);
            let names = |contents: &[Member], references: &[Member], content: &Member| {
                let place = contents.iter().position(|other| other == content).unwrap();
                let mut met: Vec<String> = pairing.pairs(contents, references)[place]
                    .iter()
                    .map(|&i| references[i].name.clone())
                    .collect();
                met.sort();
                met
            };
            for content in &all {
                let drawn = names(&all, &all, content);
                prop_assert_eq!(drawn.len(), most);
                prop_assert_eq!(&names(&turned, &turned, content), &drawn);
                prop_assert_eq!(&names(std::slice::from_ref(content), &all, content), &drawn);
            }
        }
    }
}

//! Names in files of others: they stay within the dataset.

/// A name as a path within the dataset; why it is none otherwise.
///
/// A leading `./` is left out. `..`, absolute names and names with a drive lead out of the dataset, even where they
/// lead back again: a file that says so was not made for this folder.
pub(crate) fn inside(name: &str) -> Result<String, &'static str> {
    if name.starts_with(['/', '\\']) || name.as_bytes().get(1) == Some(&b':') {
        return Err("an absolute name; names are within the dataset");
    }
    if name.contains('\0') || name.is_empty() {
        return Err("no name of a file");
    }
    let parts: Vec<&str> = name.split('/').filter(|part| !part.is_empty() && *part != ".").collect();
    if parts.contains(&"..") || name.split('\\').any(|part| part == "..") {
        return Err("a name with `..`, which leads out of the dataset");
    }
    match parts.as_slice() {
        [] => Err("no name of a file"),
        parts => Ok(parts.join("/")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_within_the_data_set() {
        assert_eq!(inside("./train//a.jpg").unwrap(), "train/a.jpg");
        for out in
            ["/etc/passwd", "../a.jpg", "a/../../b.jpg", "C:\\a.jpg", "\\\\host\\a", "..\\a", "", ".", "a\0b"]
        {
            assert!(inside(out).is_err(), "{out:?}");
        }
    }
}

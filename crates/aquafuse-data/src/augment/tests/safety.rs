//! Files that are not ours: never written, never followed to.

use super::*;

#[test]
fn a_file_that_is_no_manifest_keeps_its_content() {
    for text in ["no line end", "line\ntail", "\0\0\0", "{\"line\":\"diary\"}"] {
        let place = tempfile::tempdir().unwrap();
        let (root, out) = (place.path().join("fish"), place.path().join("out"));
        dataset(&root);
        fs::create_dir(&out).unwrap();
        fs::write(out.join("manifest.jsonl"), text).unwrap();
        let job = Augmentation { overwrite: true, ..job(&root, &out) };
        let refused = job.plan().map(|plan| job.run(&plan, &|_| {}).unwrap_err().to_string());
        assert!(refused.is_ok_and(|said| said.contains("line 1 is not of a manifest")), "{text:?}");
        assert_eq!(files(&out), BTreeMap::from([("manifest.jsonl".to_owned(), text.as_bytes().to_vec())]));
    }
}

#[cfg(unix)]
mod links {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn no_link_in_the_output_leads_a_file_out() {
        let place = tempfile::tempdir().unwrap();
        let path = |name: &str| place.path().join(name);
        dataset(&path("fish"));
        fs::create_dir(path("victim")).unwrap();
        run(&job(&path("fish"), &path("out")));
        fs::remove_dir_all(path("out/images")).unwrap();
        symlink(path("victim"), path("out/images")).unwrap();
        let job = job(&path("fish"), &path("out"));
        let said = job.run(&job.plan().unwrap(), &|_| {}).unwrap_err().to_string();
        assert!(said.contains("out/images: it is a link that is broken or leads out"), "{said}");

        let manifest = path("out/manifest.jsonl");
        fs::create_dir(path("again")).unwrap();
        symlink(path("victim"), path("again/images")).unwrap();
        let replayed = remake(&manifest, &making(None, None, &path("again"))).unwrap();
        assert_eq!((replayed.equal.len(), replayed.failed.len()), (0, 12));
        assert_eq!(files(&path("victim")), BTreeMap::new());
    }

    #[test]
    fn a_manifest_that_is_a_link_is_not_opened() {
        let place = tempfile::tempdir().unwrap();
        let path = |name: &str| place.path().join(name);
        dataset(&path("fish"));
        fs::create_dir(path("out")).unwrap();
        symlink(path("diary.jsonl"), path("out/manifest.jsonl")).unwrap();
        let job = Augmentation { overwrite: true, ..job(&path("fish"), &path("out")) };
        assert!(job.run(&job.plan().unwrap(), &|_| {}).is_err());
        assert!(!path("diary.jsonl").exists());
    }

    #[test]
    fn verify_and_replay_read_nothing_behind_a_link_that_leads_out() {
        let place = tempfile::tempdir().unwrap();
        let path = |name: &str| place.path().join(name);
        dataset(&path("fish"));
        run(&job(&path("fish"), &path("out")));
        fs::rename(path("fish/images/train/a.png"), path("a.png")).unwrap();
        symlink(path("a.png"), path("fish/images/train/a.png")).unwrap();
        let wrong =
            |dataset: Option<&Path>| check(&path("out"), dataset, &ReadOptions::default()).unwrap().wrong;
        assert_eq!(wrong(None), []);
        let found = wrong(Some(&path("fish")));
        assert!(found.len() == 1 && found[0].1.contains("a link that leads out"), "{found:?}");
        let only = Some("images/train/a.png");
        let replayed = remake(&path("out/manifest.jsonl"), &making(only, None, &path("again"))).unwrap();
        assert!(replayed.failed[0].to_string().contains("a link that leads out"), "{replayed:?}");

        fs::rename(path("out/images"), path("moved")).unwrap();
        symlink(path("moved"), path("out/images")).unwrap();
        assert_eq!(wrong(None).len(), 16);
    }
}

#[test]
fn a_line_without_an_end_takes_no_more_memory_than_is_allowed() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("manifest.jsonl"), "{".repeat(5_000)).unwrap();
    let tight = ReadOptions { max_memory: 4_000, ..ReadOptions::default() };
    assert!(matches!(check(&out, None, &tight), Err(AugmentError::Manifest { line: 1, .. })));
}

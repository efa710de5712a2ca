use super::*;
use crate::pipeline::DepthSource;
use serde_json::json;

fn item(folder: &Path, name: &str) -> Item {
    Item {
        input: folder.join(format!("in_{name}")),
        output: folder.join(name),
        depth: DepthSource::default(),
    }
}

fn write(path: &Path, text: &str) {
    std::fs::write(path, text).unwrap();
}

/// A folder with one item that is done, and its record closed.
fn done(name: &str) -> (tempfile::TempDir, Item) {
    let folder = tempfile::tempdir().unwrap();
    let item = item(folder.path(), name);
    write(&item.input, "content");
    let record = Record::open(folder.path(), &json!("blue"), false).unwrap();
    assert_eq!(record.state(&item, false), State::Missing);
    let sources = record.sources(&item).unwrap();
    record.begin(&item, &sources).unwrap();
    write(&item.output, "fused");
    record.done(&item, sources).unwrap();
    (folder, item)
}

#[test]
fn what_is_done_is_kept_by_the_next_run() {
    let (folder, item) = done("a.png");
    for overwrite in [false, true] {
        let record = Record::open(folder.path(), &json!("blue"), overwrite).unwrap();
        assert_eq!(record.state(&item, overwrite), State::Made);
    }
}

#[test]
fn what_was_begun_is_made_again_whether_it_got_its_name_or_not() {
    let (folder, _) = done("a.png");
    let item = item(folder.path(), "b.png");
    write(&item.input, "content");
    let begin = || {
        let record = Record::open(folder.path(), &json!("blue"), false).unwrap();
        record.begin(&item, &record.sources(&item).unwrap()).unwrap();
    };
    begin();
    let plan = || Record::open(folder.path(), &json!("blue"), false).unwrap().state(&item, false);
    assert_eq!(plan(), State::Missing);
    write(&item.output, "fused");
    assert_eq!(plan(), State::Replaceable);

    // Begun again over what is ours, and killed again: still ours.
    begin();
    assert_eq!(plan(), State::Replaceable);
}

#[test]
fn what_was_begun_over_somebodys_file_is_theirs_until_it_has_its_name() {
    let (folder, _) = done("a.png");
    let item = item(folder.path(), "b.png");
    write(&item.input, "content");
    write(&item.output, "somebody's");
    let record = Record::open(folder.path(), &json!("blue"), true).unwrap();
    record.begin(&item, &record.sources(&item).unwrap()).unwrap();
    drop(record);
    let plan = || Record::open(folder.path(), &json!("blue"), false).unwrap().state(&item, false);
    assert_eq!(plan(), State::Foreign);
    write(&item.output, "fused over it");
    assert_eq!(plan(), State::Replaceable);
}

#[test]
fn an_image_of_the_same_name_from_another_folder_does_not_take_its_place() {
    let (folder, known) = done("a.png");
    let elsewhere = folder.path().join("elsewhere");
    write(&elsewhere, "another dive");
    let record = Record::open(folder.path(), &json!("blue"), false).unwrap();
    assert_eq!(record.state(&Item { input: elsewhere, ..known }, false), State::Foreign);
}

#[test]
fn depth_come_by_in_another_way_is_another_setting() {
    let (folder, known) = done("a.png");
    let record = Record::open(folder.path(), &json!("blue"), false).unwrap();
    let ratio = DepthSource::Estimated(aquafuse::depth::DepthModel::Ratio.into());
    assert_eq!(record.state(&Item { depth: ratio, ..known }, false), State::Foreign);
}

#[test]
fn what_failed_after_it_was_done_is_still_ours() {
    let (folder, item) = done("a.png");
    write(&item.input, "broken");
    let failed = FileError::Empty { path: item.input.clone() };
    Record::open(folder.path(), &json!("blue"), false).unwrap().failed(&item, &failed).unwrap();
    write(&item.input, "repaired");
    assert_eq!(
        Record::open(folder.path(), &json!("blue"), false).unwrap().state(&item, false),
        State::Replaceable
    );
}

#[test]
fn an_input_that_changes_while_it_is_read_is_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let item = item(folder.path(), "a.png");
    write(&item.input, "first");
    let record = Record::open(folder.path(), &json!("blue"), false).unwrap();
    let sources = record.sources(&item).unwrap();
    write(&item.input, "second one");
    write(&item.output, "fused");
    record.done(&item, sources).unwrap();
    drop(record);
    assert_eq!(
        Record::open(folder.path(), &json!("blue"), false).unwrap().state(&item, false),
        State::Replaceable
    );
}

#[test]
fn another_input_is_made_anew_and_a_changed_output_is_not_ours() {
    let (folder, item) = done("a.png");
    write(&item.input, "another content");
    assert_eq!(
        Record::open(folder.path(), &json!("blue"), false).unwrap().state(&item, false),
        State::Replaceable
    );
    write(&item.output, "touched up by hand");
    let record = Record::open(folder.path(), &json!("blue"), false).unwrap();
    assert_eq!(record.state(&item, false), State::Foreign);
    assert_eq!(record.state(&item, true), State::Replaceable);
    std::fs::remove_file(&item.output).unwrap();
    assert_eq!(record.state(&item, false), State::Missing);
}

#[test]
fn other_settings_are_refused_or_begin_anew() {
    let (folder, item) = done("a.png");
    let refused = Record::open(folder.path(), &json!("green"), false).unwrap_err();
    assert!(matches!(refused, FileError::OtherSettings { .. }));
    assert_eq!(
        Record::open(folder.path(), &json!("green"), true).unwrap().state(&item, true),
        State::Replaceable
    );
}

#[test]
fn a_folder_is_worked_in_by_one_process() {
    let (folder, _) = done("a.png");
    let _first = Record::open(folder.path(), &json!("blue"), false).unwrap();
    assert!(matches!(Record::open(folder.path(), &json!("blue"), false), Err(FileError::Busy { .. })));
}

#[test]
fn a_record_cut_anywhere_is_read_as_far_as_its_lines_are_whole() {
    let (folder, item) = done("a.png");
    let path = folder.path().join(RECORD);
    let whole = std::fs::read(&path).unwrap();
    let mut plans = Vec::new();
    for cut in 0..=whole.len() {
        std::fs::write(&path, &whole[..cut]).unwrap();
        plans.push(Record::open(folder.path(), &json!("blue"), false).unwrap().state(&item, false));
    }
    // First nothing is known, then that it was begun, then that it is done.
    plans.dedup();
    assert_eq!(plans, [State::Foreign, State::Replaceable, State::Made]);
}

#[test]
fn what_is_no_record_is_left_alone() {
    for text in [
        "notes of my own\n",
        "{\"failed\":{\"output\":\"a.png\",\"error\":\"x\"}}\n",
        "{\"job\":{\"schema\":99,\"settings\":\"blue\"}}\n",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(RECORD);
        write(&path, text);
        let refused = Record::open(folder.path(), &json!("blue"), true).unwrap_err();
        assert!(matches!(refused, FileError::DamagedRecord { line: 1, .. }), "{refused}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    }
}

#[test]
fn a_line_is_counted_as_an_editor_counts_it() {
    let text = b"\n{\"job\":{\"schema\":1,\"settings\":\"blue\"}}\n\nnotes of my own\n";
    assert!(matches!(parse(&text[..]), Err(NoRecord::Line(4))));
}

#[test]
fn what_has_no_line_end_is_ours_only_if_it_begins_so() {
    for (text, is_ours) in [
        ("{\"job\":{\"sch", true),
        ("", true),
        ("no line end", false),
        ("line\ntail", false),
        (&"\0".repeat(MOST_LINE + 9), false),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(RECORD);
        write(&path, text);
        assert_eq!(Record::open(folder.path(), &json!("blue"), false).is_ok(), is_ours);
        assert_eq!(std::fs::read_to_string(&path).unwrap() == text, !is_ours);
    }
}

#[cfg(unix)]
#[test]
fn a_link_in_the_place_of_a_record_is_not_followed() {
    let folder = tempfile::tempdir().unwrap();
    for diary in ["diary.txt", "missing.txt"] {
        let (diary, path) = (folder.path().join(diary), folder.path().join(RECORD));
        if diary.ends_with("diary.txt") {
            write(&diary, "");
        }
        let was = diary.exists();
        std::os::unix::fs::symlink(&diary, &path).unwrap();
        let refused = Record::open(folder.path(), &json!("blue"), true).unwrap_err();
        assert!(matches!(refused, FileError::ForeignRecord { .. }), "{refused}");
        assert_eq!((diary.exists(), diary.metadata().map_or(0, |about| about.len())), (was, 0));
        std::fs::remove_file(&path).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn a_name_that_is_no_text_is_known_again() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let name = OsStr::from_bytes(b"\xff\n\".png");
    let item = Item {
        input: folder.path().join("in"),
        output: folder.path().join(name),
        depth: DepthSource::default(),
    };
    write(&item.input, "content");
    let record = Record::open(folder.path(), &json!("blue"), false).unwrap();
    let sources = record.sources(&item).unwrap();
    write(&item.output, "fused");
    record.done(&item, sources).unwrap();
    drop(record);
    assert_eq!(Record::open(folder.path(), &json!("blue"), false).unwrap().state(&item, false), State::Made);
}

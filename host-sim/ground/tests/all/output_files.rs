//! Outputs: whole or not at all, and nothing replaced without being told to.

use std::fs;
use std::io::Write;
use std::path::Path;

use truepath_ground::output::{OutputFile, OutputFolder, write_file};

const OWNED: [&str; 3] = ["corrected.nc", "correction.tpi", "summary.json"];

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).expect("a file")
}

#[test]
fn a_folder_appears_only_when_it_is_complete() {
    let place = tempfile::tempdir().expect("a folder");
    let target = place.path().join("out");
    let folder = OutputFolder::create(&target, false, &OWNED).expect("a new folder");
    folder.write("corrected.nc", b"G1").expect("written");
    assert!(!target.exists());
    folder.commit().expect("committed");
    assert_eq!(names(&target), ["corrected.nc"]);
    assert_eq!(names(place.path()), ["out"]);
}

#[test]
fn an_abandoned_folder_or_file_leaves_nothing_behind() {
    let place = tempfile::tempdir().expect("a folder");
    let folder = OutputFolder::create(&place.path().join("out"), false, &OWNED).expect("a new folder");
    folder.write("corrected.nc", b"G1").expect("written");
    let mut file = OutputFile::create(&place.path().join("out.csv"), false).expect("a new file");
    file.write_all(b"1,2\n").expect("written");
    drop((folder, file));
    assert_eq!(names(place.path()), [""; 0]);
}

#[test]
fn what_exists_is_not_replaced_without_force() {
    let place = tempfile::tempdir().expect("a folder");
    let file = place.path().join("out.csv");
    write_file(&file, false, b"first").expect("a new file");
    let refusal = write_file(&file, false, b"second").expect_err("it exists");
    assert_eq!(refusal.code(), "F003");
    assert!(refusal.to_string().contains("out.csv exists"), "{refusal}");
    assert_eq!(read(&file), "first");
    let folder = OutputFolder::create(place.path(), false, &OWNED).expect_err("it is not empty");
    assert!(folder.to_string().contains("exists and is not empty"), "{folder}");
    write_file(&file, true, b"second").expect("replaced");
    assert_eq!(read(&file), "second");
    assert_eq!(names(place.path()), ["out.csv"]);
}

#[test]
fn a_file_that_appears_meanwhile_is_not_replaced_either() {
    let place = tempfile::tempdir().expect("a folder");
    let target = place.path().join("out.csv");
    let mut file = OutputFile::create(&target, false).expect("a new file");
    file.write_all(b"mine").expect("written");
    fs::write(&target, "theirs").expect("another program's file");
    assert_eq!(file.commit().expect_err("it exists now").code(), "F003");
    assert_eq!(read(&target), "theirs");
}

#[test]
fn force_replaces_its_own_files_removes_its_old_ones_and_leaves_the_rest() {
    let place = tempfile::tempdir().expect("a folder");
    let target = place.path().join("out");
    fs::create_dir(&target).expect("a folder");
    for (name, text) in [("corrected.nc", "old"), ("correction.tpi", "of the other route"), ("notes.txt", "the user's")]
    {
        fs::write(target.join(name), text).expect("a file");
    }
    let folder = OutputFolder::create(&target, true, &OWNED).expect("a folder");
    folder.write("corrected.nc", b"new").expect("written");
    folder.write("summary.json", b"{}").expect("written");
    folder.commit().expect("committed");
    assert_eq!(names(&target), ["corrected.nc", "notes.txt", "summary.json"]);
    assert_eq!(
        (read(&target.join("corrected.nc")), read(&target.join("notes.txt"))),
        ("new".into(), "the user's".into())
    );
    assert_eq!(names(place.path()), ["out"]);
}

#[test]
fn a_numbered_name_holds_for_every_number_and_for_nothing_else() {
    let place = tempfile::tempdir().expect("a folder");
    let target = place.path().join("out");
    let owned = ["pass-#.tpi"];
    let folder = OutputFolder::create(&target, false, &owned).expect("a new folder");
    for name in ["pass-1.tpi", "pass-9.tpi", "pass-120.tpi"] {
        folder.write(name, b"an image").expect(name);
    }
    for name in ["pass-.tpi", "pass-0.tpi", "pass-01.tpi", "pass--1.tpi", "pass-1.tpi.tpi", "pass-#.tpi", "pass-1", "1"]
    {
        assert_eq!(folder.write(name, b"").expect_err(name).code(), "F002");
    }
    folder.commit().expect("committed");
    fs::write(target.join("pass-old.tpi"), "the user's").expect("a file");
    let folder = OutputFolder::create(&target, true, &owned).expect("a folder");
    folder.write("pass-2.tpi", b"an image").expect("written");
    folder.commit().expect("committed");
    assert_eq!(names(&target), ["pass-2.tpi", "pass-old.tpi"]);
}

#[test]
fn a_failed_replacement_puts_everything_back() {
    let place = tempfile::tempdir().expect("a folder");
    let target = place.path().join("out");
    fs::create_dir(&target).expect("a folder");
    fs::write(target.join("corrected.nc"), "old").expect("a file");
    let folder = OutputFolder::create(&target, true, &OWNED).expect("a folder");
    folder.write("corrected.nc", b"new").expect("written");
    folder.write("summary.json", b"{}").expect("written");
    fs::create_dir_all(target.join("summary.json/in use")).expect("a folder in the way");
    let error = folder.commit().expect_err("a folder is never replaced by a file");
    assert!(error.to_string().contains("summary.json is a folder there"), "{error}");
    assert_eq!(read(&target.join("corrected.nc")), "old");
    assert_eq!(names(&target), ["corrected.nc", "summary.json"]);
    assert_eq!(names(&target.join("summary.json")), ["in use"]);
    assert_eq!(names(place.path()), ["out"]);
}

#[test]
fn missing_folders_above_a_target_are_made_and_go_again_when_nothing_is_written() {
    let place = tempfile::tempdir().expect("a folder");
    let lost = place.path().join("new/one/part");
    let folder = OutputFolder::create(&lost, false, &OWNED).expect("a folder");
    folder.write("corrected.nc", b"half").expect("written");
    drop(folder);
    drop(OutputFile::create(&place.path().join("other/out.csv"), false).expect("a file"));
    assert_eq!(names(place.path()), [""; 0]);

    let folder = OutputFolder::create(&lost, false, &OWNED).expect("a folder");
    folder.write("corrected.nc", b"new").expect("written");
    folder.commit().expect("committed");
    write_file(&place.path().join("new/two/out.csv"), false, b"rows").expect("written");
    assert_eq!(names(&lost), ["corrected.nc"]);
    assert_eq!(read(&place.path().join("new/two/out.csv")), "rows");
}

#[test]
fn impossible_targets_are_named() {
    let place = tempfile::tempdir().expect("a folder");
    let file = place.path().join("file");
    fs::write(&file, "").expect("a file");
    assert_eq!(OutputFolder::create(&file, true, &OWNED).expect_err("a file").code(), "F003");
    assert_eq!(OutputFile::create(place.path(), true).expect_err("a folder").code(), "F003");
    let lost = file.join("out.csv");
    assert_eq!(write_file(&lost, false, b"").expect_err("a file is no folder").code(), "F002");
    let folder = OutputFolder::create(&place.path().join("out"), false, &OWNED).expect("a folder");
    assert_eq!(folder.write("other.nc", b"").expect_err("not its name").code(), "F002");
}

#[cfg(unix)]
#[test]
fn outputs_are_readable_like_any_other_file() {
    use std::os::unix::fs::PermissionsExt;
    let place = tempfile::tempdir().expect("a folder");
    let ordinary = place.path().join("ordinary");
    fs::write(&ordinary, "").expect("a file");
    let mode = |path: &Path| fs::metadata(path).expect("a file").permissions().mode() & 0o777;
    let file = place.path().join("out.csv");
    write_file(&file, false, b"").expect("a file");
    assert_eq!(mode(&file), mode(&ordinary));
    let target = place.path().join("out");
    OutputFolder::create(&target, false, &OWNED).expect("a folder").commit().expect("committed");
    fs::create_dir(place.path().join("plain")).expect("a folder");
    assert_eq!(mode(&target), mode(&place.path().join("plain")));
}

/// An administrator may write anywhere and sees nothing of this.
#[cfg(unix)]
#[test]
fn output_into_a_folder_that_the_user_may_not_write_is_refused_and_says_where() {
    use std::os::unix::fs::PermissionsExt;
    let place = tempfile::tempdir().expect("a folder");
    let closed = place.path().join("closed");
    fs::create_dir(&closed).expect("a folder");
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).expect("closed");
    if fs::write(closed.join("tried"), "").is_ok() {
        return;
    }
    let refusals = [
        write_file(&closed.join("out.csv"), false, b"").expect_err("closed"),
        OutputFolder::create(&closed.join("out"), false, &OWNED).expect_err("closed"),
    ];
    for refusal in refusals {
        assert_eq!(refusal.code(), "F002");
        assert!(refusal.to_string().contains("closed") && refusal.to_string().contains("denied"), "{refusal}");
    }
}

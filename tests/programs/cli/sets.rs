//! Files that belong together and a program that was killed while it gave them their names: the next one that writes there
//! completes the set, or removes what was never whole. The states that `kill -9` leaves are built by hand.

use std::fs::{self, File};
use std::os::unix::fs::symlink;

use crate::cli::{project, run_in};
use crate::common::scratch::Scratch;

/// A process number that no process has: Linux counts up to 4,194,304.
const DEAD: &str = "9999999";

/// The name of a part of the dead program.
fn part(number: u32) -> String {
    format!("sandtable-{DEAD}-{number}.part")
}

/// A record of parts with the names that they become.
fn record(pairs: &[(&str, &str)]) -> Vec<u8> {
    let pairs: String = pairs.iter().map(|(part, name)| format!("{part}\0{name}\0")).collect();
    format!("sandtable set 1\0{pairs}end").into_bytes()
}

/// The set that most tests have: a grid and its system, over an older one.
fn two() -> Vec<u8> {
    record(&[(&part(1), "out.asc"), (&part(2), "out.prj")])
}

/// A folder with the old files and those of `files`.
fn folder(files: &[(&str, &[u8])]) -> Scratch {
    let scratch = Scratch::new();
    for (name, content) in [("out.asc", &b"old grid"[..]), ("out.prj", b"old system")].iter().chain(files) {
        scratch.write(name, content);
    }
    scratch
}

/// Writes another file into the folder.
fn write_another(scratch: &Scratch) {
    let dem = project("assets/jacksboro/valley.asc");
    run_in(scratch.folder(), &["dem", "convert", &dem, "-o", "another.tif"]).ok();
    fs::remove_file(scratch.at("another.tif")).expect("written");
}

/// The names in the folder after another file was written there, and what the two files hold.
fn after(scratch: &Scratch) -> (Vec<String>, [String; 2]) {
    write_another(scratch);
    let text = |name: &str| fs::read_to_string(scratch.at(name)).unwrap_or_default();
    (scratch.names(), [text("out.asc"), text("out.prj")])
}

#[test]
fn a_set_without_a_record_was_never_whole_and_is_removed() {
    let scratch = folder(&[(&part(1), b"new grid"), (&part(2), b"new sys")]);
    assert_eq!(
        after(&scratch),
        (vec!["out.asc".into(), "out.prj".into()], ["old grid".into(), "old system".into()])
    );
    // So was one whose record is cut short, at any byte.
    for length in [0, 1, 16, two().len() - 4, two().len() - 1] {
        let name = format!("sandtable-{DEAD}-3.set");
        let scratch = folder(&[(&part(1), b"new grid"), (&part(2), b"new sys"), (&name, &two()[..length])]);
        let (names, texts) = after(&scratch);
        assert_eq!(
            (names.len(), texts),
            (2, ["old grid".into(), "old system".into()]),
            "{length}: {names:?}"
        );
    }
}

#[test]
fn a_set_with_its_record_is_completed_from_any_moment() {
    let name = format!("sandtable-{DEAD}-3.set");
    for given in 0..=2 {
        let scratch = folder(&[(&part(1), b"new grid"), (&part(2), b"new system"), (&name, &two())]);
        // The old files stay under other names until all new ones are in place.
        for (number, file) in [(4, "out.asc"), (5, "out.prj")].into_iter().take(given) {
            fs::hard_link(scratch.at(file), scratch.at(&part(number))).expect("a link");
            fs::rename(scratch.at(&part(number - 3)), scratch.at(file)).expect("renamed");
        }
        let (names, texts) = after(&scratch);
        assert_eq!(names, ["out.asc", "out.prj"], "{given}");
        assert_eq!(texts, ["new grid", "new system"], "{given}");
    }
}

#[test]
fn a_living_program_s_set_is_left_alone() {
    let name = format!("sandtable-{DEAD}-3.set");
    let scratch = folder(&[(&part(1), b"new grid"), (&part(2), b"new system"), (&name, &two())]);
    let record = File::open(scratch.at(&name)).expect("there");
    record.lock().expect("locked");
    let (names, texts) = after(&scratch);
    assert_eq!((names.len(), texts), (5, ["old grid".into(), "old system".into()]), "{names:?}");
    // Nothing is moved where somebody holds a part of it, though the record is free.
    record.unlock().expect("unlocked");
    let held = File::open(scratch.at(&part(2))).expect("there");
    held.lock().expect("locked");
    let (names, texts) = after(&scratch);
    assert_eq!((names.len(), texts), (5, ["old grid".into(), "old system".into()]), "{names:?}");
    held.unlock().expect("unlocked");
    let (names, texts) = after(&scratch);
    assert_eq!((names.len(), texts), (2, ["new grid".into(), "new system".into()]), "{names:?}");
}

#[test]
fn a_hostile_record_moves_nothing_that_it_may_not() {
    let elsewhere = Scratch::new();
    let target = elsewhere.write("target", "theirs");
    let out = target.to_string_lossy();
    let above = format!("../{}/target", elsewhere.folder().file_name().expect("a name").to_string_lossy());
    let (one, two) = (part(1), part(2));
    let foreign = "sandtable-1-1.part";
    let names: [&str; 9] = [&out, &above, "sub/file", "..", ".", "", "a\\b", foreign, "sub"];
    let mut pairs: Vec<(&str, &str)> = names.iter().map(|name| (one.as_str(), *name)).collect();
    // What is no part of that program stays where it is, and so does what is no plain file.
    pairs.extend([("mine.txt", "moved"), ("../mine.txt", "moved"), (foreign, "moved"), (&two, "linked")]);
    let record_name = format!("sandtable-{DEAD}-3.set");
    let scratch = folder(&[(&one, b"evil"), ("mine.txt", b"mine"), (&record_name, &record(&pairs))]);
    fs::create_dir(scratch.at("sub")).expect("a folder");
    symlink(&target, scratch.at(&two)).expect("a link");
    write_another(&scratch);
    assert_eq!(fs::read_to_string(&target).expect("there"), "theirs");
    assert_eq!(fs::read_to_string(scratch.at("mine.txt")).expect("there"), "mine");
    assert_eq!(scratch.names(), ["mine.txt", "out.asc", "out.prj", two.as_str(), "sub"]);
    assert_eq!(fs::read_dir(scratch.at("sub")).expect("a folder").count(), 0);
    assert_eq!(elsewhere.names(), ["target"]);
    // Whatever else a record holds, it is not read far, and removed.
    for content in [vec![0; 5000], vec![b'x'; 3 << 20], record(&[]), b"sandtable set 1\0odd\0end".to_vec()] {
        let scratch = folder(&[(&record_name, &content)]);
        assert_eq!(after(&scratch).0, ["out.asc", "out.prj"]);
    }
}

#[test]
fn a_whole_set_leaves_no_record() {
    let scratch = Scratch::new();
    let dem = project("assets/jacksboro/valley.asc");
    let convert = ["dem", "convert", &dem, "--source-crs", "EPSG:32616", "-o", "out.asc"];
    run_in(scratch.folder(), &convert).ok();
    assert_eq!(scratch.names(), ["out.asc", "out.prj"]);
    // A folder in the way of the second keeps the first as it was.
    fs::remove_file(scratch.at("out.prj")).expect("there");
    scratch.write("out.asc", "old");
    fs::create_dir(scratch.at("out.prj")).expect("a folder");
    run_in(scratch.folder(), &convert).failed(1);
    assert_eq!(scratch.names(), ["out.asc", "out.prj"]);
    assert_eq!(fs::read_to_string(scratch.at("out.asc")).expect("there"), "old");
}

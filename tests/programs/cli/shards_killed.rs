//! Workers that are killed: what they finished stays, what they began leaves nothing.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::cli::{bytes_of, program, run_in};
use crate::common::scratch::Scratch;

/// A plan of observers that each look over all of the demo's ground.
fn planned() -> (Scratch, usize) {
    let scratch = Scratch::new();
    fs::write(scratch.at("dem.tif"), bytes_of("assets/jacksboro/dem.tif")).expect("written");
    let mut observers = String::new();
    for index in 0..40 {
        let _ = writeln!(
            observers,
            "{},{}",
            -84.25 + f64::from(index % 8) * 0.02,
            36.2 + f64::from(index / 8) * 0.03
        );
    }
    scratch.write("towers.csv", &observers);
    let plan =
        ["plan", "viewsheds", "dem.tif", "--points", "towers.csv", "--shards", "40", "--json", "-o", "plan"];
    let out = run_in(scratch.folder(), &plan).out;
    let json: serde_json::Value = serde_json::from_str(&out).expect("an object");
    let count = json["shards"].as_u64().expect("a number") as usize;
    assert!(count >= 20, "{count}");
    (scratch, count)
}

/// Every record with its file's number: another one where it was written again.
fn records(scratch: &Scratch) -> BTreeMap<String, u64> {
    let files = fs::read_dir(scratch.at("plan/shards")).expect("a folder").map(|file| file.expect("a file"));
    let records = files.filter(|file| file.file_name().to_string_lossy().ends_with(".json"));
    let named = |file: fs::DirEntry| {
        (file.file_name().to_string_lossy().into_owned(), file.metadata().expect("there").ino())
    };
    records.map(named).collect()
}

#[test]
fn a_worker_that_is_killed_loses_nothing_and_nothing_is_done_twice() {
    let (scratch, count) = planned();
    let work = ["work", "plan", "--shards", &format!("0..{count}")];
    let mut worker = program(scratch.folder(), &work)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts");
    let deadline = Instant::now() + Duration::from_secs(120);
    while records(&scratch).len() < 3 {
        assert!(Instant::now() < deadline, "it does nothing");
        assert!(worker.try_wait().expect("a child").is_none(), "it ended before it was killed");
        sleep(Duration::from_millis(1));
    }
    let kill = Command::new("kill").args(["-KILL", &worker.id().to_string()]).status();
    assert!(kill.expect("kill is there").success());
    worker.wait().expect("a child");
    let finished = records(&scratch);
    assert!(finished.len() < count, "it finished before it was killed");

    let out = run_in(scratch.folder(), &work).out;
    let skipped = out.lines().filter(|line| line.ends_with("skipped")).count();
    assert_eq!(skipped, finished.len(), "{out}");
    let all = records(&scratch);
    assert!(finished.iter().all(|(name, number)| all[name] == *number), "a shard was done twice");
    let left = fs::read_dir(scratch.at("plan/shards")).expect("a folder").count();
    assert_eq!(left, count * 2, "a result and a record for each shard, and no part of one");
    run_in(scratch.folder(), &["gather", "plan", "-o", "killed.tif"]).ok();

    let (other, _) = planned();
    assert_eq!(run_in(other.folder(), &work).code, 0);
    run_in(other.folder(), &["gather", "plan", "-o", "whole.tif"]).ok();
    let read = |scratch: &Scratch, name: &str| fs::read(scratch.at(name)).expect("written");
    assert!(read(&scratch, "killed.tif") == read(&other, "whole.tif"));
    assert!(read(&scratch, "plan/shards/000004.tif") == read(&other, "plan/shards/000004.tif"));
}

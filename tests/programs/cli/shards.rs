//! `plan`, `work` and `gather`: what shards make together is what one command makes.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use serde_json::Value;

use crate::cli::{bytes_of, run_in};
use crate::common::scratch::Scratch;

/// A copy of the demo's elevation, and points all over it, beyond it and in its corner.
fn surveyed() -> Scratch {
    let scratch = Scratch::new();
    fs::write(scratch.at("dem.tif"), bytes_of("assets/jacksboro/dem.tif")).expect("written");
    let mut points = String::from("\u{feff}name;lat;lon\n# made up\n");
    for index in 0..3000u32 {
        let (lon, lat) = (f64::from(index * 7919 % 3001), f64::from(index * 104_729 % 2999));
        let _ = writeln!(points, "p{index};{:.6};{:.5}", 36.15 + lat * 1.3e-4, -84.48 + lon * 1.6e-4);
    }
    scratch.write("points.csv", &points);
    scratch
}

fn plan_of(scratch: &Scratch) -> Value {
    let text = fs::read_to_string(scratch.at("plan/plan.json")).expect("written");
    serde_json::from_str(&text).expect("an object")
}

fn shard_count(scratch: &Scratch) -> usize {
    plan_of(scratch)["shards"]["count"].as_u64().expect("a number") as usize
}

fn plan(scratch: &Scratch, arguments: &[&str]) -> usize {
    run_in(scratch.folder(), &[&["plan"], arguments, &["-o", "plan"]].concat()).ok();
    shard_count(scratch)
}

const HEIGHTS: [&str; 6] = ["heights", "dem.tif", "--points", "points.csv", "--shards", "6"];

/// The bytes of every result and record.
fn results(scratch: &Scratch) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(scratch.at("plan/shards")).expect("a folder").map(|file| file.expect("a file"));
    let named = |file: fs::DirEntry| {
        let content = fs::read(file.path()).expect("readable");
        (file.file_name().to_string_lossy().into_owned(), content)
    };
    files.map(named).collect()
}

#[test]
fn heights_in_shards_are_the_bytes_that_height_prints() {
    let queries: [&[&str]; 3] = [
        &[],
        &["--surface", "ground", "--interpolation", "planar", "--crs", "EPSG:4326"],
        &["--vertical-datum", "egm96", "--above", "ellipsoid", "--interpolation", "nearest"],
    ];
    for query in queries {
        let scratch = surveyed();
        let count = plan(&scratch, &[&HEIGHTS[..], query].concat());
        assert!((4..=12).contains(&count), "{count}");
        // In any order.
        for id in (0..count).rev() {
            let out = run_in(scratch.folder(), &["work", "plan", "--shard", &id.to_string()]).ok();
            assert_eq!(out, format!("{id} done\n"));
        }
        assert_eq!(run_in(scratch.folder(), &["gather", "plan"]).ok(), "plan/heights.csv\n");
        let whole =
            run_in(scratch.folder(), &[&["height", "dem.tif", "--points", "points.csv"], query].concat());
        let gathered = fs::read_to_string(scratch.at("plan/heights.csv")).expect("written");
        assert!(gathered.contains(",Ok") && gathered.contains(",,Outside"));
        assert!(gathered == whole.out, "{query:?}: {}", whole.err);
    }
}

#[test]
fn heights_of_elevation_on_disk_are_read_by_windows_and_equal() {
    let scratch = surveyed();
    let convert = ["dem", "convert", "dem.tif", "large.tif", "--crs", "EPSG:32616", "--cell", "25"];
    assert_eq!(run_in(scratch.folder(), &convert).code, 0);
    let query = ["large.tif", "--points", "points.csv", "--crs", "EPSG:4326"];
    let count = plan(&scratch, &[&["heights", "--shards", "9"], &query[..]].concat());
    let lines = fs::read_to_string(scratch.at("plan/shards.jsonl")).expect("written");
    let windows: Vec<Value> =
        lines.lines().map(|line| serde_json::from_str(line).expect("a shard")).collect();
    assert_eq!(windows.len(), count);
    let samples =
        |shard: &Value| shard["window"][2].as_u64().expect("w") * shard["window"][3].as_u64().expect("h");
    assert!(windows.iter().all(|shard| samples(shard) < 1_100_000), "{lines}");
    run_in(scratch.folder(), &["work", "plan", "--shards", &format!("0..{count}")]).ok();
    run_in(scratch.folder(), &["gather", "plan", "-o", "heights.csv"]).ok();
    let whole = run_in(scratch.folder(), &[&["height"], &query[..]].concat()).ok();
    assert!(fs::read_to_string(scratch.at("heights.csv")).expect("written") == whole);
}

#[test]
fn a_cumulative_viewshed_is_the_sum_of_all_viewsheds() {
    let observers = ["-84.2,36.3", "-84.21,36.31", "-84.15,36.25", "-84.2,36.3", "-84.1,36.35"];
    for looking in [&["--range", "4000", "--observer-height", "10"][..], &["--target-height", "5", "--flat"]]
    {
        let scratch = surveyed();
        scratch.write("towers.csv", observers.join("\n"));
        let query = [&["viewsheds", "dem.tif", "--points", "towers.csv", "--shards", "3"], looking].concat();
        let count = plan(&scratch, &query);
        assert!((2..=5).contains(&count), "{count}");
        let work = ["work", "plan", "--shards", &format!("0..{count}")];
        assert_eq!(run_in(scratch.folder(), &work).code, 0);
        run_in(scratch.folder(), &["gather", "plan", "-o", "sum.asc"]).ok();
        let sums = summed(&scratch, "dem.tif", &observers, looking);
        let gathered = posts(&scratch.at("sum.asc"), -1);
        assert!(gathered.values().any(|&count| count >= 2) && gathered.len() > 1000);
        assert!(gathered == sums, "{looking:?}: {} and {} posts", gathered.len(), sums.len());
    }
}

#[test]
fn viewsheds_of_elevation_on_disk_are_added_post_by_post() {
    let scratch = surveyed();
    let convert = ["dem", "convert", "dem.tif", "large.tif", "--crs", "EPSG:32616", "--cell", "25"];
    assert_eq!(run_in(scratch.folder(), &convert).code, 0);
    let observers = ["-84.2,36.3", "-84.21,36.3", "-84.15,36.25"];
    scratch.write("towers.csv", observers.join("\n"));
    let looking = ["--crs", "EPSG:4326", "--range", "1500", "--observer-height", "20"];
    let query =
        [&["viewsheds", "large.tif", "--points", "towers.csv", "--shards", "2"], &looking[..]].concat();
    let count = plan(&scratch, &query);
    run_in(scratch.folder(), &["work", "plan", "--shards", &format!("0..{count}")]).ok();
    run_in(scratch.folder(), &["gather", "plan", "-o", "sum.asc"]).ok();
    let sums = summed(&scratch, "large.tif", &observers, &looking);
    let gathered = posts(&scratch.at("sum.asc"), -1);
    assert!(gathered.values().any(|&count| count == 2) && gathered.len() > 10_000, "{}", gathered.len());
    assert!(gathered == sums, "{} and {} posts", gathered.len(), sums.len());
}

/// How many observers see each post, by a viewshed of each.
fn summed(scratch: &Scratch, dem: &str, observers: &[&str], looking: &[&str]) -> BTreeMap<(i64, i64), i64> {
    let mut sums = BTreeMap::new();
    for at in observers {
        let one = [&["viewshed", dem, "--at", at, "-o", "one.asc"], looking].concat();
        assert_eq!(run_in(scratch.folder(), &one).code, 0);
        for (place, seen) in posts(&scratch.at("one.asc"), 255) {
            *sums.entry(place).or_default() += seen;
        }
    }
    sums
}

/// The values of an ESRI ASCII grid that are not `nodata`, by their places to the meter.
fn posts(path: &Path, nodata: i64) -> BTreeMap<(i64, i64), i64> {
    let text = fs::read_to_string(path).expect("written");
    let mut header = BTreeMap::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next_if(|line| line.starts_with(|first: char| first.is_ascii_alphabetic())) {
        let (key, value) = line.split_once(' ').expect("a key and a value");
        header.insert(key.to_ascii_lowercase(), value.trim().parse::<f64>().expect("a number"));
    }
    let rows: Vec<&str> = lines.collect();
    let (left, bottom, cell) = (header["xllcorner"], header["yllcorner"], header["cellsize"]);
    let mut posts = BTreeMap::new();
    for (row, line) in rows.iter().rev().enumerate() {
        for (column, value) in line.split_whitespace().enumerate() {
            let value: i64 = value.parse().expect("a whole number");
            let place = (left + cell * column as f64, bottom + cell * row as f64);
            if value != nodata {
                posts.insert((place.0.round() as i64, place.1.round() as i64), value);
            }
        }
    }
    posts
}

#[test]
fn a_plan_written_again_is_the_same_and_its_shards_stay_done() {
    let scratch = surveyed();
    let count = plan(&scratch, &HEIGHTS);
    let first = fs::read(scratch.at("plan/plan.json")).expect("written");
    run_in(scratch.folder(), &["work", "plan", "--shard", "1"]).ok();
    assert_eq!(plan(&scratch, &HEIGHTS), count);
    assert_eq!(fs::read(scratch.at("plan/plan.json")).expect("written"), first);
    let out = run_in(scratch.folder(), &["work", "plan", "--shards", "0..3"]).ok();
    assert_eq!(out, "0 done\n1 skipped\n2 done\n");
}

#[test]
fn what_is_missing_or_stale_is_named_and_nothing_is_gathered() {
    let scratch = surveyed();
    let count = plan(&scratch, &HEIGHTS);
    run_in(scratch.folder(), &["work", "plan", "--shards", &format!("1..{count}")]).ok();
    fs::write(scratch.at("plan/shards/000002.heights"), "short").expect("written");
    let gathered = run_in(scratch.folder(), &["gather", "plan", "--json"]);
    let json: Value = serde_json::from_str(&gathered.out).expect("an object");
    assert_eq!((&json["missing"], &json["stale"]), (&Value::from(vec![0]), &Value::from(vec![2])));
    assert_eq!(
        (json["done"].as_u64(), &json["output"]),
        (Some(count as u64 - 2), &Value::from(Vec::<u8>::new()))
    );
    assert_eq!(gathered.code, 1);
    let expected =
        format!("of {count} shards 1 missing (0) and 1 stale (2); do them with `sandtable work plan");
    assert!(gathered.err.contains(&expected), "{}", gathered.err);
    assert!(!scratch.at("plan/heights.csv").exists());
    let out = run_in(scratch.folder(), &["work", "plan", "--shards", "0..4"]).ok();
    assert_eq!(out, "0 done\n1 skipped\n2 done\n3 skipped\n");
    // Content that changed under the same size is found when it is gathered.
    let path = scratch.at("plan/shards/000003.heights");
    let mut bytes = fs::read(&path).expect("written");
    bytes[0] ^= 1;
    fs::write(&path, bytes).expect("written");
    let message = run_in(scratch.folder(), &["gather", "plan"]).failed(1);
    assert!(message.contains("1 stale (3)"), "{message}");
}

#[test]
fn an_input_that_changed_is_named_and_nothing_is_done() {
    let scratch = surveyed();
    plan(&scratch, &HEIGHTS);
    run_in(scratch.folder(), &["work", "plan", "--shard", "0"]).ok();
    let points = fs::read_to_string(scratch.at("points.csv")).expect("written");
    scratch.write("points.csv", points.replace("p7;", "p8;"));
    let message = run_in(scratch.folder(), &["work", "plan", "--shard", "1"]).failed(1);
    assert!(message.contains("points.csv: stale: its content is not"), "{message}");
    scratch.write("points.csv", &(points + "1,2,3\n"));
    let work = run_in(scratch.folder(), &["work", "plan", "--shards", "0..2"]);
    assert_eq!((work.code, work.out.as_str()), (1, "0 skipped\n"));
    assert!(
        work.err.contains("bytes when it was planned with") && work.err.contains("plan again"),
        "{}",
        work.err
    );
    fs::remove_file(scratch.at("points.csv")).expect("it is there");
    let message = run_in(scratch.folder(), &["work", "plan", "--shard", "1"]).failed(1);
    assert!(message.contains("this input of the plan is not there"), "{message}");
}

#[test]
fn a_large_input_is_compared_by_its_ends_its_size_and_its_time() {
    let scratch = surveyed();
    // 72 MB without a block on the disk.
    let large = fs::File::create(scratch.at("large.raw")).expect("made");
    large.set_len(6000 * 6000 * 2).expect("a sparse file");
    scratch.write("few.csv", "10,10\n5000,10\n10,5000\n5000,5000\n");
    let query = ["heights", "large.raw", "--raw", "6000x6000:i16le", "--points", "few.csv", "--shards", "4"];
    assert_eq!(plan(&scratch, &query), 4);
    let input = &plan_of(&scratch)["inputs"][0];
    assert_eq!((&input["check"], input["modified"].is_u64()), (&Value::from("ends"), true));
    run_in(scratch.folder(), &["work", "plan", "--shard", "0"]).ok();
    let mut in_place = fs::OpenOptions::new().write(true).open(scratch.at("large.raw")).expect("there");
    in_place.seek(SeekFrom::Start(30_000_000)).expect("inside");
    in_place.write_all(&[1]).expect("written");
    drop(in_place);
    let message = run_in(scratch.folder(), &["work", "plan", "--shard", "1"]).failed(1);
    assert!(message.contains("large.raw: stale: its time of change"), "{message}");
}

#[test]
fn a_plan_and_its_inputs_may_be_moved_together() {
    let scratch = surveyed();
    let count = plan(&scratch, &HEIGHTS);
    fs::create_dir(scratch.at("elsewhere")).expect("made");
    for name in ["plan", "dem.tif", "points.csv"] {
        fs::rename(scratch.at(name), scratch.at("elsewhere").join(name)).expect("moved");
    }
    let work = ["work", "elsewhere/plan", "--shards", &format!("0..{count}")];
    assert_eq!(run_in(scratch.folder(), &work).ok().lines().count(), count);
    run_in(scratch.folder(), &["gather", "elsewhere/plan"]).ok();
}

#[test]
fn a_finished_run_of_a_thousand_shards_does_nothing_again() {
    let scratch = surveyed();
    let mut many = HEIGHTS;
    many[5] = "1500";
    let count = plan(&scratch, &many);
    assert!(count >= 1000, "{count}");
    let work = ["work", "plan", "--shards", &format!("0..{count}")];
    run_in(scratch.folder(), &work).ok();
    let before = results(&scratch);
    let lines = run_in(scratch.folder(), &work).ok();
    assert_eq!(lines, (0..count).map(|id| format!("{id} skipped\n")).collect::<String>());
    assert!(results(&scratch) == before);
}

#[test]
fn plans_that_nobody_wrote_are_refused_without_a_panic() {
    let scratch = surveyed();
    plan(&scratch, &HEIGHTS);
    let read = |name: &str| fs::read_to_string(scratch.at(&format!("plan/{name}"))).expect("written");
    let (head, lines) = (read("plan.json"), read("shards.jsonl"));
    let mut wrong: Vec<(String, &str)> = [
        ("\"sandtable-plan\"", "\"other\"", "format"),
        ("\"version\": 1", "\"version\": 2", "version 2"),
        ("\"heights\"", "\"dreams\"", "not a plan"),
        ("\"bilinear\"", "\"guessed\"", "not a plan"),
        ("\"count\": ", "\"count\": 9", "list of shards"),
        ("\"count\": ", "\"count\": 99999999", "plan-shards"),
        ("\"count\": ", "\"count\": -1", "not a plan"),
        ("\"check\": \"content\"", "\"check\": \"hope\"", "not a plan"),
        ("/dem.tif\"", "/gone.tif\"", "gone.tif"),
    ]
    .map(|(from, to, message)| (head.replacen(from, to, if from.contains("dem") { 9 } else { 1 }), message))
    .into();
    let program = env!("CARGO_PKG_VERSION");
    wrong.push((
        head.replace(&format!("\"program\": \"{program}\""), "\"program\": \"0.0.1\""),
        "made by sandtable 0.0.1",
    ));
    wrong.push(("[".repeat(100_000), "not a plan"));
    wrong.push((String::new(), "not a plan"));
    for (text, expected) in wrong {
        assert_ne!(text, head);
        scratch.write("plan/plan.json", &text);
        let message = run_in(scratch.folder(), &["work", "plan", "--shard", "0"]).failed(1);
        assert!(message.contains(expected), "{expected}: {message}");
    }
    // Lines whose hash is right.
    for (from, to, expected) in [
        ("\"first\":0", "\"first\":18446744073709551615", "no points, or too many"),
        ("\"first\":0", "\"first\":1", "not those that were planned"),
        ("\"id\":0", "\"id\":1", "`id` is 1"),
        ("\"count\":", "\"count\":9999999", "no points, or too many"),
        ("\"count\":", "\"count\":-", "not a shard"),
        ("\"points\":{", "\"dots\":{", "not a shard"),
    ] {
        let changed = lines.replacen(from, to, 1);
        assert_ne!(changed, lines);
        scratch.write("plan/shards.jsonl", &changed);
        scratch.write("plan/plan.json", restated(&head, &changed));
        let message = run_in(scratch.folder(), &["work", "plan", "--shard", "0"]).failed(1);
        assert!(message.contains(expected), "{expected}: {message}");
    }
}

/// A head that states other lines of shards.
fn restated(head: &str, lines: &str) -> String {
    let mut head: Value = serde_json::from_str(head).expect("an object");
    head["shards"]["bytes"] = lines.len().into();
    head["shards"]["sha256"] = sandtable_files::fingerprint::content_hash(lines.as_bytes()).into();
    format!("{head:#}")
}

#[test]
fn wrong_usage_is_explained() {
    let scratch = surveyed();
    let count = plan(&scratch, &HEIGHTS);
    let failed = |arguments: &[&str], code: i32| run_in(scratch.folder(), arguments).failed(code);
    let message = failed(&["work", "plan", "--shard", &count.to_string()], 1);
    assert!(message.contains(&format!("no shard {count}; its shards are 0 to {}", count - 1)), "{message}");
    assert!(failed(&["work", "plan", "--shards", "3..3"], 2).contains("0..100"));
    assert!(failed(&["work", "plan"], 2).contains("--shard"));
    assert!(failed(&["work", "nowhere", "--shard", "0"], 1).contains("no such file"));
    let piped = failed(&["plan", "heights", "dem.tif", "--points", "-", "-o", "other"], 2);
    assert!(piped.contains("name a file"), "{piped}");
    scratch.write("none.csv", "x,y\n");
    let none = failed(&["plan", "heights", "dem.tif", "--points", "none.csv", "-o", "other"], 1);
    assert!(none.contains("none.csv: it holds no points"), "{none}");
    scratch.write("wrong.csv", "1,2\n3,there\n");
    let wrong = failed(&["plan", "heights", "dem.tif", "--points", "wrong.csv", "-o", "other"], 1);
    assert!(wrong.contains("wrong.csv:2"), "{wrong}");
    scratch.write("sea.csv", "-84.2,36.3\n0,0\n");
    let sea =
        run_in(scratch.folder(), &["plan", "viewsheds", "dem.tif", "--points", "sea.csv", "-o", "other"]);
    assert!(sea.code == 1 && sea.err.contains("the observer at 0,0: this lies outside"), "{sea:?}");
    let onto = run_in(scratch.folder(), &["gather", "plan", "-o", "dem.tif"]);
    assert_eq!(onto.code, 1);
}

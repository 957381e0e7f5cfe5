//! How the program behaves among others: help, usage, exit codes, pipes.

use std::process::Stdio;

use crate::cli::{program, project, run, run_in};
use crate::common::scratch::Scratch;

#[test]
fn every_command_has_help_to_read() {
    for (command, wanted) in [
        (&[][..], &["render", "check", "dem", "model", "height", "Exit codes"][..]),
        (
            &["render"],
            &[
                "--output",
                "--size",
                "--camera",
                "--backend",
                "--threads",
                "--allow",
                "1920x1080",
                "cpu",
                "gpu",
            ],
        ),
        (&["check"], &["--allow", "<SCENE>"]),
        (&["dem"], &["info"]),
        (&["dem", "info"], &["--json", "--height-scale", "--height-offset", "<FILE>"]),
        (&["model"], &["info"]),
        (&["model", "info"], &["--json", "<FILE>"]),
        (
            &["height"],
            &[
                "--points",
                "--interpolation",
                "planar",
                "bilinear",
                "nearest",
                "distance-weighted",
                "--height-offset",
            ],
        ),
        (&["plan"], &["heights", "viewsheds", "atlas", "tiles"]),
        (&["plan", "heights"], &["--points", "--above", "--shards", "<FILE>", "--output <PLAN>"]),
        (&["plan", "viewsheds"], &["--points", "--range", "--observer-height", "--flat"]),
        (&["plan", "atlas"], &["--scale", "--paper", "--portrait", "--dpi", "--backend", "<SCENE>"]),
        (&["plan", "tiles"], &["--max-zoom", "--encoding", "terrain-rgb", "terrarium", "ellipsoid"]),
        (&["work"], &["--shard", "--shards <A..B>", "Exit codes"]),
        (&["gather"], &["--output", "--json", "Exit codes"]),
    ] {
        let help = run(&[command, &["--help"]].concat()).ok();
        for word in wanted {
            assert!(help.contains(word), "{word} in the help of {command:?}:\n{help}");
        }
        // Options of two words stand in one column each; no line runs off a wide terminal.
        let longest = help.lines().map(|line| line.chars().count()).max();
        assert!(longest.is_some_and(|longest| longest < 130), "{command:?}: {longest:?}\n{help}");
    }
    assert!(run(&["--version"]).ok().starts_with("sandtable "));
    assert!(!run(&["model", "info", "--help"]).ok().contains("height"), "a model has no gray values");
}

#[test]
fn wrong_usage_ends_with_two() {
    let scene = project("scenes/road.toml");
    for arguments in [
        &["paint"][..],
        &["render"],
        &["render", &scene, "--size", "640"],
        &["render", &scene, "--size", "0x0"],
        &["render", &scene, "--threads", "0"],
        &["render", &scene, "--backend", "abacus"],
        &["render", &scene, "--color"],
        &["height", "a.tif"],
        &["height", "a.tif", "--points", "-", "--interpolation", "spline"],
        &["dem", "info", "a.tif", "--height-scale", "tall"],
        &["dem"],
        &["model", "info"],
    ] {
        let complaint = run(arguments).failed(2);
        assert!(complaint.contains("Usage") || complaint.contains("--help"), "{arguments:?}: {complaint}");
    }
    let meant = run(&["rendr", &scene]).failed(2);
    assert!(meant.contains("render"), "{meant}");
}

#[test]
fn nothing_moves_where_nobody_watches() {
    let scratch = Scratch::new();
    let ran = run_in(scratch.folder(), &["render", &project("scenes/road.toml"), "--size", "64x48"]);
    let out = ran.ok();
    assert!(!out.contains('\u{1b}') && !out.contains('\r'), "{out:?}");
}

#[test]
fn a_quiet_program_prints_answers_and_errors_alone() {
    let scratch = Scratch::new();
    let (scene, dem) = (project("scenes/road.toml"), project("assets/jacksboro/dem.tif"));
    for arguments in [
        &["render", &scene, "--size", "64x48", "-o", "a.png", "--quiet"][..],
        &["--quiet", "dem", "convert", &dem, "-o", "a.bt"],
        &["symbol", "10031000161211020000", "-o", "a.svg", "-q"],
    ] {
        assert_eq!(run_in(scratch.folder(), arguments).ok(), "", "{arguments:?}");
    }
    assert_eq!(scratch.names(), ["a.bt", "a.png", "a.prj", "a.svg"]);
    let answer = run(&["height", &dem, "--at", "-84.2,36.3", "--quiet"]).ok();
    assert!(answer.contains("375,Ok"), "{answer}");
    assert!(run(&["check", "nowhere.toml", "-q"]).failed(1).contains("no such file"));
}

#[test]
fn a_reader_that_leaves_is_no_reason_to_panic() {
    let scratch = Scratch::new();
    scratch.write("points.csv", "-84.2,36.3\n".repeat(200_000));
    let (dem, model, scene) =
        (project("assets/jacksboro/dem.tif"), project("assets/models/tent.glb"), project("scenes/road.toml"));
    for arguments in [
        &["dem", "info", &dem][..],
        &["dem", "info", &dem, "--json"],
        &["model", "info", &model],
        &["check", &scene],
        &["render", &scene, "--size", "64x48"],
        &["height", &dem, "--points", "points.csv"],
        &["--help"],
    ] {
        let mut command = program(scratch.folder(), arguments);
        let mut child =
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("the program ends");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), &*said), (Some(0), ""), "{arguments:?}");
    }
}

#[test]
fn a_complaint_that_nobody_hears_still_has_its_exit_code() {
    let scratch = Scratch::new();
    let mut command = program(scratch.folder(), &["dem", "info", "nowhere.tif"]);
    let mut child =
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    drop((child.stdout.take(), child.stderr.take()));
    assert_eq!(child.wait().expect("the program ends").code(), Some(1));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    for arguments in [&["dem", "info", "assets/jacksboro/dem.tif"][..], &["check", "scenes/road.toml"]] {
        let full = std::fs::File::options().write(true).open("/dev/full").expect("a full disk");
        let mut command = program(std::path::Path::new(env!("SANDTABLE_ROOT")), arguments);
        let output = command.stdout(full).output().expect("the program starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("standard output: "), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn file_names_need_not_be_utf_8() {
    use std::os::unix::ffi::OsStrExt;
    let scratch = Scratch::new();
    let name = std::ffi::OsStr::from_bytes(b"h\xfcgel.asc");
    let path = scratch.folder().join(name);
    if std::fs::copy(project("assets/jacksboro/valley.asc"), &path).is_err() {
        crate::common::skip::skipped("this file system takes only UTF-8 names");
        return;
    }
    let out = run_in(scratch.folder(), &["dem".as_ref(), "info".as_ref(), path.as_os_str()]).ok();
    assert!(out.contains("112 columns"), "{out}");
}

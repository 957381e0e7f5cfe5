//! Faults of disks, of files and of the system: an error that says what to do, and no half-written file.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::cli::{Ran, program, project, ran, run_in};
use crate::common::scratch::Scratch;
use crate::common::skip::skipped;

/// Runs the program after a line of shell, in a folder.
fn run_after(shell: &str, scratch: &Scratch, arguments: &[&str]) -> Ran {
    let line = format!("{shell} exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &line, env!("CARGO_BIN_EXE_sandtable")]).args(arguments);
    ran(command.current_dir(scratch.folder()).stdin(Stdio::null()).output().expect("a shell"))
}

/// Every command that writes files, with those that it writes.
fn writers() -> Vec<(Vec<String>, Vec<&'static str>)> {
    let [scene, cameras] = ["scenes/road.toml", "scenes/areas.toml"].map(project);
    let dem = project("assets/jacksboro/valley.asc");
    let command = |line: &str, files: &[&'static str]| {
        let words = line.split(' ').map(|word| match word {
            "SCENE" => scene.clone(),
            "CAMERAS" => cameras.clone(),
            "DEM" => dem.clone(),
            word => word.to_owned(),
        });
        (words.collect(), files.to_vec())
    };
    vec![
        command("render SCENE --size 640x360 -o out.png --sidecar", &["out.json", "out.png"]),
        command("render SCENE --size 640x360 --sheet -o out.png", &["out.png"]),
        command("render SCENE --size 640x360 -o out.pdf", &["out.pdf"]),
        command(
            "render CAMERAS --size 320x180 --all-cameras -o out.png",
            &["out-south.png", "out-village.png"],
        ),
        command("export SCENE -o out.glb", &["out.glb"]),
        command("export SCENE -o out.obj", &["out.mtl", "out.obj"]),
        command("export SCENE -o out.html", &["out.html"]),
        command("export SCENE -o out.3mf", &["out.3mf"]),
        command("dem convert DEM --source-crs EPSG:32616 -o out.asc", &["out.asc", "out.prj"]),
        command("dem convert DEM -o out.tif", &["out.tif"]),
        command("mesh DEM --max-error 5 -o out.ply", &["out.ply"]),
    ]
}

fn arguments(line: &[String]) -> Vec<&str> {
    line.iter().map(String::as_str).collect()
}

#[test]
#[ignore = "slow: runs every command that writes under a limit of file size"]
fn a_file_that_grows_too_large_leaves_what_was_there() {
    for (line, files) in writers() {
        let scratch = Scratch::new();
        for file in &files {
            scratch.write(file, "old");
        }
        // Blocks of 512 bytes: the small files of a set fit, the large one does not.
        let said = run_after("ulimit -f 16;", &scratch, &arguments(&line)).failed(1);
        assert!(said.contains("out") && said.to_lowercase().contains("too large"), "{line:?}: {said}");
        assert_eq!(scratch.names(), files, "{line:?}");
        for file in &files {
            assert_eq!(fs::read_to_string(scratch.at(file)).expect("there"), "old", "{line:?}: {file}");
        }
    }
}

/// Runs the program where the folder `disk` is a disk of its own, mounted with `options`; `None` where this system lets
/// no one mount.
fn run_on_disk(options: &str, scratch: &Scratch, arguments: &[&str]) -> Option<(Ran, String)> {
    fs::create_dir_all(scratch.at("disk")).expect("a folder");
    let line = format!(
        "mount -t tmpfs -o {options} none disk || exit 99; \"$0\" \"$@\"; code=$?; ls -A disk >left; exit $code"
    );
    let mut command = Command::new("unshare");
    command.args(["-rm", "sh", "-c", &line, env!("CARGO_BIN_EXE_sandtable")]).args(arguments);
    let output = command.current_dir(scratch.folder()).stdin(Stdio::null()).output().ok()?;
    let ran = ran(output);
    let left = fs::read_to_string(scratch.at("left"));
    left.ok().filter(|_| ran.code != 99).map(|left| (ran, left))
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "slow: runs every command that writes on a full disk"]
fn a_full_disk_and_a_read_only_one_are_told_and_hold_nothing_after() {
    for (options, wanted) in [("size=16k", "the disk is full"), ("ro", "the disk is read-only")] {
        for (line, _) in writers() {
            let scratch = Scratch::new();
            let line: Vec<String> = line.iter().map(|word| word.replace("out", "disk/out")).collect();
            let Some((ran, left)) = run_on_disk(options, &scratch, &arguments(&line)) else {
                skipped("no disk can be mounted here (`unshare -rm`)");
                return;
            };
            let said = ran.failed(1);
            assert!(said.contains("disk/out") && said.contains(wanted), "{line:?}: {said}");
            assert_eq!(left, "", "{line:?}");
        }
    }
}

#[test]
fn what_is_no_file_to_write_is_refused_by_every_command() {
    for (line, files) in writers() {
        let scratch = Scratch::new();
        let last = files[files.len() - 1];
        fs::create_dir(scratch.at(last)).expect("a folder");
        let said = run_in(scratch.folder(), &line).failed(1);
        assert!(said.contains(last) && said.contains("this is a folder"), "{line:?}: {said}");
        fs::remove_dir(scratch.at(last)).expect("empty");
        symlink("/dev/full", scratch.at(last)).expect("a link");
        let said = run_in(scratch.folder(), &line).failed(1);
        assert!(said.contains(last) && said.contains("a device or a pipe"), "{line:?}: {said}");
        fs::remove_file(scratch.at(last)).expect("a link");
        let file = scratch.write(last, "old");
        let mut permissions = fs::metadata(&file).expect("there").permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&file, permissions).expect("set");
        let said = run_in(scratch.folder(), &line).failed(1);
        assert!(said.contains(last) && said.contains("may not be written over"), "{line:?}: {said}");
        assert_eq!(scratch.names(), [last], "{line:?}");
        assert_eq!(fs::read_to_string(file).expect("there"), "old", "{line:?}");
    }
}

#[test]
fn a_link_is_followed_to_its_file() {
    let scratch = Scratch::new();
    scratch.write("elsewhere/real.asc", "old");
    symlink("elsewhere/real.asc", scratch.at("out.asc")).expect("a link");
    let dem = project("assets/jacksboro/dem.tif");
    run_in(scratch.folder(), &["dem", "convert", &dem, "-o", "out.asc"]).ok();
    assert!(fs::symlink_metadata(scratch.at("out.asc")).expect("there").is_symlink());
    let real = fs::read_to_string(scratch.at("elsewhere/real.asc")).expect("there");
    assert!(real.starts_with("ncols"), "{}", &real[..20]);
    // A link to an input is that input.
    fs::copy(dem, scratch.at("in.tif")).expect("copied");
    symlink("in.tif", scratch.at("out.tif")).expect("a link");
    let said = run_in(scratch.folder(), &["dem", "convert", "in.tif", "-o", "out.tif"]).failed(1);
    assert!(said.contains("this is an input file"), "{said}");
}

#[test]
fn a_file_that_changes_while_it_is_read_is_read_or_refused() {
    let scratch = Scratch::new();
    let whole = fs::read(project("assets/jacksboro/dem.tif")).expect("a file of the project");
    let path = scratch.write("dem.tif", &whole);
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut length = 0;
            while !is_over.load(Ordering::Relaxed) {
                length = (length + 7919) % whole.len();
                fs::write(&path, &whole[..length]).expect("written");
            }
        });
        for _ in 0..40 {
            let ran = run_in(scratch.folder(), &["dem", "info", "dem.tif"]);
            if ran.code == 0 {
                assert_eq!(ran.err, "");
            } else {
                assert!(ran.failed(1).contains("dem.tif"));
            }
        }
        is_over.store(true, Ordering::Relaxed);
    });
}

#[test]
fn closed_streams_do_not_end_up_in_files() {
    let scratch = Scratch::new();
    let scene = project("scenes/road.toml");
    let render = ["render", &scene, "--size", "64x48", "-o", "out.png"];
    run_in(scratch.folder(), &render).ok();
    let wanted = fs::read(scratch.at("out.png")).expect("written");
    let ran = run_after("exec <&- >&- 2>&-;", &scratch, &render);
    assert_eq!(ran.code, 0);
    assert!(fs::read(scratch.at("out.png")).expect("written") == wanted);
    assert_eq!(run_after("exec <&- >&- 2>&-;", &scratch, &["dem", "info", "none.tif"]).code, 1);
}

#[test]
fn a_user_without_a_home_gets_the_same_picture() {
    let scratch = Scratch::new();
    let scene = project("scenes/labels.toml");
    let render =
        |name: &str| ["render".to_owned(), scene.clone(), "--size=320x180".into(), format!("-o{name}")];
    run_in(scratch.folder(), &render("home.png")).ok();
    let mut command = program(scratch.folder(), &render("none.png"));
    command.env_clear();
    ran(command.output().expect("the program starts")).ok();
    let [home, none] = ["home.png", "none.png"].map(|name| fs::read(scratch.at(name)).expect("written"));
    assert!(home == none);
}

#[test]
fn one_thread_and_64_draw_the_same_picture() {
    let scratch = Scratch::new();
    let scene = project("scenes/labels.toml");
    let drawn = |threads: &str| {
        let name = format!("{threads}.png");
        let render = ["render", &scene, "--size", "320x180", "--threads", threads, "-o", &name];
        run_in(scratch.folder(), &render).ok();
        fs::read(scratch.at(&name)).expect("written")
    };
    let one = drawn("1");
    for threads in ["2", "16", "64"] {
        assert!(drawn(threads) == one, "{threads}");
    }
}

#[test]
fn a_missing_font_and_one_that_is_none_are_named() {
    let scratch = Scratch::new();
    fs::copy(project("assets/jacksboro/valley.asc"), scratch.at("valley.asc")).expect("copied");
    scratch.write("text.ttf", "no font");
    for font in ["missing.ttf", "text.ttf"] {
        let text = format!("font = \"{font}\"\n\n[terrain]\ndem = \"valley.asc\"\n");
        scratch.write("a.toml", text);
        let said = run_in(scratch.folder(), &["render", "a.toml"]).failed(1);
        assert!(said.contains("a.toml") && said.contains(font), "{said}");
        assert!(!scratch.at("a.png").exists());
    }
}

#[test]
fn pictures_and_scenes_may_have_names_that_are_not_utf_8() {
    let scratch = Scratch::new();
    let [scene, picture] = [&b"sc\xe9ne.toml"[..], b"b\xefld.png"].map(OsStr::from_bytes);
    if fs::write(scratch.folder().join(scene), "").is_err() {
        skipped("this file system takes only UTF-8 names");
        return;
    }
    fs::copy(project("assets/jacksboro/valley.asc"), scratch.at("valley.asc")).expect("copied");
    fs::write(scratch.folder().join(scene), "[terrain]\ndem = \"valley.asc\"\n").expect("written");
    let words = ["render".as_ref(), scene, "--size".as_ref(), "64x48".as_ref()];
    run_in(scratch.folder(), &[&words[..], &["-o".as_ref(), picture]].concat()).ok();
    assert!(scratch.folder().join(picture).is_file());
    run_in(scratch.folder(), &words).ok();
    assert!(scratch.folder().join(OsStr::from_bytes(b"sc\xe9ne.png")).is_file());
}

#[test]
fn a_batch_goes_on_past_what_is_bad_and_says_so_at_the_end() {
    let scratch = Scratch::new();
    let (road, lake) = (project("scenes/road.toml"), project("scenes/lake.toml"));
    scratch.write("bad.toml", "[terain]\n");
    let render = ["render", &road, "bad.toml", "none.toml", &lake, "--size", "64x48", "-o", "out"];
    let ran = run_in(scratch.folder(), &render);
    assert_eq!(ran.code, 1, "{ran:?}");
    assert!(ran.out.contains("out/road.png") && ran.out.contains("out/lake.png"), "{ran:?}");
    assert!(ran.err.contains("bad.toml:1:2") && ran.err.contains("none.toml: "), "{ran:?}");
    let last = ran.err.lines().last().expect("a summary");
    assert_eq!(last, "error: not rendered: bad.toml, none.toml; the rest is written");
    let mut names: Vec<_> = fs::read_dir(scratch.at("out"))
        .expect("made")
        .map(|entry| entry.expect("there").file_name())
        .collect();
    names.sort();
    assert_eq!(names, ["lake.png", "road.png"]);
    let said = run_in(scratch.folder(), &["render", &road, &road]).failed(2);
    assert!(said.contains("would both be road.png"), "{said}");
    let said = run_in(scratch.folder(), &["render", &road, &lake, "-o", "bad.toml"]).failed(2);
    assert!(said.contains("bad.toml is a file"), "{said}");
}

#[test]
fn phases_that_cannot_be_built_are_left_out_and_named() {
    let scratch = Scratch::new();
    fs::copy(project("assets/jacksboro/valley.asc"), scratch.at("valley.asc")).expect("copied");
    scratch.write("two.toml", TWO_PHASES);
    let ran = run_in(scratch.folder(), &["render", "two.toml", "--all-phases", "--size", "64x48"]);
    assert_eq!(ran.code, 1, "{ran:?}");
    assert!(ran.err.starts_with("two.toml:11:8: error[missing-file]: there is no file"), "{ran:?}");
    assert!(
        ran.err.ends_with("error: not rendered: phase bad of two.toml; the rest is written\n"),
        "{ran:?}"
    );
    assert_eq!(scratch.names(), ["two-good.png", "two.toml", "valley.asc"]);
    // A sheet is whole or not there.
    let sheet = ["render", "two.toml", "--all-phases", "--sheet", "--size", "640x480"];
    assert!(run_in(scratch.folder(), &sheet).failed(1).starts_with("two.toml:11:8: "));
    assert_eq!(scratch.names(), ["two-good.png", "two.toml", "valley.asc"]);
}

/// A scene with a phase whose road has no file.
const TWO_PHASES: &str = r#"[terrain]
dem = "valley.asc"
crs = "EPSG:32616"
[[phase]]
name = "good"
[[phase]]
name = "bad"
[[road]]
name = "nowhere"
phases = ["bad"]
file = "none.geojson"
"#;

//! The first steps: without arguments, the demonstration, completions and the manual page.

use std::process::{Command, Stdio};

use crate::cli::{project, run, run_in};
use crate::common::scratch::Scratch;

#[test]
fn without_arguments_the_program_says_what_to_try() {
    let scratch = Scratch::new();
    let empty = run_in::<&str>(scratch.folder(), &[]).ok();
    assert!(empty.contains("No scene") && empty.contains("sandtable demo"), "{empty}");
    for name in ["jacksboro/valley.asc", "jacksboro/roads.geojson"] {
        let file = name.split('/').next_back().expect("a name");
        std::fs::copy(project(&format!("assets/{name}")), scratch.at(file)).expect("a copy");
    }
    let found = run_in::<&str>(scratch.folder(), &[]).ok();
    let wanted = "sandtable new my-scene --dem valley.asc --vectors roads.geojson ";
    assert!(found.contains(wanted), "{found}");
    assert!(found.lines().count() <= 24 && found.lines().all(|line| line.chars().count() <= 90), "{found}");
    // What it suggests runs.
    run_in(scratch.folder(), &["new", "my-scene", "--dem", "valley.asc", "--crs", "EPSG:32616"]).ok();
    let above = run_in::<&str>(scratch.folder(), &[]).ok();
    assert!(above.contains("sandtable render my-scene/scene.toml "), "{above}");
    let scene = run_in::<&str>(&scratch.at("my-scene"), &[]).ok();
    assert!(scene.contains("sandtable render scene.toml "), "{scene}");
}

#[test]
fn the_demonstration_needs_no_file_and_overwrites_none() {
    let scratch = Scratch::new();
    let out = run_in(scratch.folder(), &["demo"]).ok();
    assert!(out.starts_with("sandtable-demo/picture.png\n") && out.contains("try next:"), "{out}");
    let drawn = std::fs::read(scratch.at("sandtable-demo/picture.png")).expect("a picture");
    // The picture is that of the repository's scene, byte for byte.
    let same = ["render", &project("scenes/jacksboro.toml"), "-o", "same.png"];
    run_in(scratch.folder(), &same).ok();
    assert!(drawn == std::fs::read(scratch.at("same.png")).expect("a picture"), "another picture");
    run_in(scratch.folder(), &["check", "sandtable-demo/scene.toml"]).ok();
    std::fs::remove_file(scratch.at("sandtable-demo/picture.png")).expect("a file");
    let again = run_in(scratch.folder(), &["demo"]).failed(1);
    assert!(again.contains("exists already") && again.contains("sandtable demo DIR"), "{again}");
    assert!(!scratch.at("sandtable-demo/picture.png").exists(), "nothing is drawn");
}

#[test]
fn an_error_about_the_wrong_file_names_the_next_command() {
    for (file, wanted) in [
        ("assets/jacksboro/dem.tif", "sandtable new my-scene --dem assets/jacksboro/dem.tif\n"),
        ("assets/jacksboro/roads.geojson", "--dem DEM.tif --vectors assets/jacksboro/roads.geojson\n"),
        ("nowhere.toml", "`sandtable demo` writes one\n"),
    ] {
        for command in [&["render", file][..], &["check", file], &["report", file]] {
            let complaint = run(command).failed(1);
            assert!(complaint.ends_with(wanted), "{command:?}: {complaint}");
            assert!(complaint.lines().count() <= 3, "{command:?}: {complaint}");
        }
    }
}

#[test]
fn an_error_about_a_folder_names_the_scene_in_it() {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.at("hill")).expect("a folder");
    for command in ["render", "check", "report"] {
        let complaint = run_in(scratch.folder(), &[command, "hill"]).failed(1);
        assert!(complaint.ends_with("sandtable new hill --dem DEM.tif\n"), "{complaint}");
    }
    scratch.write("hill/scene.toml", "[terrain]\ndem = \"a.tif\"\n");
    let complaint = run_in(scratch.folder(), &["render", "hill"]).failed(1);
    assert!(
        complaint.ends_with("this is a folder, not a scene file\nit has a scene:\n  hill/scene.toml\n"),
        "{complaint}"
    );
}

#[test]
fn completions_are_read_by_their_shells() {
    for (shell, check) in [
        ("bash", &["bash", "-n"][..]),
        ("zsh", &["zsh", "-n"]),
        ("fish", &["fish", "--no-execute"]),
        ("powershell", &[]),
    ] {
        let script = run(&["completions", shell]).ok();
        for word in ["viewshed", "height-offset", "allow-remote"] {
            assert!(script.contains(word), "{word} for {shell}");
        }
        let scratch = Scratch::new();
        scratch.write("script", &script);
        let [program, options @ ..] = check else { continue };
        match Command::new(program).args(options).arg(scratch.at("script")).stdin(Stdio::null()).output() {
            Ok(output) => {
                let said = String::from_utf8_lossy(&output.stderr);
                assert!(output.status.success() && said.is_empty(), "{shell}: {said}");
            }
            Err(_) => crate::common::skip::skipped(&format!("there is no {program} here")),
        }
    }
    assert!(run(&["completions", "abacus"]).failed(2).contains("bash"));
}

#[test]
fn bash_completes_commands_by_the_script() {
    let scratch = Scratch::new();
    scratch.write("script", run(&["completions", "bash"]).ok());
    let ask = "source ./script; COMP_WORDS=(sandtable vie); COMP_CWORD=1; _sandtable sandtable vie sandtable; \
               printf '%s ' \"${COMPREPLY[@]}\"";
    match Command::new("bash").args(["--norc", "-c", ask]).current_dir(scratch.folder()).output() {
        Ok(output) => assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "view viewshed"),
        Err(_) => crate::common::skip::skipped("there is no bash here"),
    }
}

#[test]
fn the_manual_page_has_every_command_and_no_warning() {
    let page = run(&["completions", "man"]).ok();
    assert!(page.contains(".TH sandtable 1"), "{page}");
    for command in ["render", "demo", "viewshed", "completions"] {
        assert!(page.contains(command), "{command}");
    }
    let scratch = Scratch::new();
    scratch.write("sandtable.1", &page);
    let mut man = Command::new("man");
    man.args(["--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z"]).arg(scratch.at("sandtable.1"));
    match man.stdin(Stdio::null()).output() {
        // A system without manual pages may have a `man` that says so.
        Ok(output) if !output.stdout.is_empty() => {
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success() && said.is_empty(), "{said}");
        }
        _ => crate::common::skip::skipped("there is no man here"),
    }
}

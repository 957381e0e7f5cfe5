//! Broken and hostile files: whatever they are named as, they are refused with a sentence, and soon.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use sandtable_model::read;
use sandtable_scene::assets::Assets;

use crate::common::data::{data, files_below};
use crate::common::scratch::Scratch;
use crate::scene;

/// Longer than any of these files may take, in the development profile and beside other work.
const PATIENCE: Duration = Duration::from_secs(10);

/// Runs `work` on every broken file and checks the time it takes; returns how many there were, and of those
/// how many were read without an error.
fn every_broken_file(work: impl Fn(&Path, &Path) -> Result<(), String>) -> Option<(usize, usize)> {
    let folder = data("broken")?;
    let (mut count, mut sound) = (0, 0);
    for path in files_below(&folder) {
        let start = Instant::now();
        match work(&folder, &path) {
            Ok(()) => sound += 1,
            Err(message) => assert!(!message.trim().is_empty(), "{}", path.display()),
        }
        let took = start.elapsed();
        assert!(took < PATIENCE, "{} took {took:?}", path.display());
        count += 1;
    }
    println!("{sound} of {count} are read");
    assert!(count > 300);
    Some((count, sound))
}

#[test]
fn no_broken_file_breaks_a_scene_whose_ground_it_is() {
    let scratch = Scratch::new();
    every_broken_file(|folder, path| {
        let png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
        let scale = if png { "height_scale = 1\n" } else { "" };
        let text = format!("[terrain]\ndem = '{}'\n{scale}", path.display());
        scene(&scratch, &text, &[folder.to_path_buf()]).map(|_| ())
    });
}

#[test]
fn no_broken_file_breaks_a_scene_whose_road_or_lake_it_is() {
    let scratch = Scratch::new();
    let dem = std::fs::read(concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/valley.asc"));
    scratch.write("data/valley.asc", dem.expect("a file of the project"));
    for table in ["road", "lake"] {
        every_broken_file(|folder, path| {
            let text = format!(
                "[terrain]\ndem = '../data/valley.asc'\ncrs = 'EPSG:32616'\n[[{table}]]\nfile = '{}'\n",
                path.display()
            );
            scene(&scratch, &text, &[folder.to_path_buf()]).map(|_| ())
        });
    }
}

#[test]
fn no_broken_file_breaks_the_reading_of_models() {
    every_broken_file(|_, path| {
        let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let assets = Assets::new(path, &[]).map_err(|error| error.to_string())?;
        let companions = assets.beside(&name).map_err(|error| error.to_string())?;
        read::read(&name, &bytes, &companions).map(|_| ()).map_err(|error| error.to_string())
    });
}

#[test]
fn the_program_ends_with_nought_or_one_on_broken_files() {
    let Some(folder) = data("broken") else { return };
    for path in files_below(&folder).iter().step_by(9) {
        for kind in ["dem", "model"] {
            let mut command = Command::new(env!("CARGO_BIN_EXE_sandtable"));
            let output = command.args([kind, "info"]).arg(path).output().expect("the program starts");
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(matches!(output.status.code(), Some(0 | 1)), "{}: {said}", path.display());
            assert_eq!(output.status.success(), said.is_empty(), "{}: {said}", path.display());
            assert_eq!(output.status.success(), !output.stdout.is_empty(), "{}", path.display());
        }
    }
}

//! What to run next: `sandtable` without arguments, and hints after errors.

use std::path::{Path, PathBuf};

use crate::arguments::Command;
use crate::error::CliError;
use crate::new::shell;
use crate::output::print_lines;
use sandtable_base::message::numbers::counted;
use sandtable_new::found_files::{FoundFiles, FoundKind, found_in, kind_of_name};

/// The most names of a kind that are listed.
const SHOWN_NAMES: usize = 4;

/// What a command may be wide to be aligned with the others, so that what they do stays in sight.
const ALIGNED_WIDTH: usize = 40;

/// The most vector files that a suggested command names: as many as stay readable in one line.
const SUGGESTED_VECTORS: usize = 3;

/// Prints what to try with the files of the current folder.
pub fn print_first_steps() -> Result<(), CliError> {
    print_lines(&first_steps(&found_in(Path::new(""))))
}

fn first_steps(found: &FoundFiles) -> Vec<String> {
    let mut lines = vec![
        format!("sandtable {}: terrain from elevation files, and pictures of it", env!("CARGO_PKG_VERSION")),
        String::new(),
        match (found.scenes.is_empty(), found.elevation.is_empty(), found.vectors.is_empty()) {
            (true, true, true) => "No scene, elevation or vector file is in this folder.".to_owned(),
            _ => "In this folder:".to_owned(),
        },
    ];
    lines.extend(listed(&found.scenes, "scene", "scenes"));
    lines.extend(listed(&found.elevation, "elevation file", "elevation files"));
    lines.extend(listed(&found.vectors, "vector file", "vector files"));
    if found.has_more {
        lines.push("  and more names than are looked at".to_owned());
    }
    lines.extend([String::new(), "Try:".to_owned()]);
    let mut commands = commands(found);
    commands.push(("sandtable demo".to_owned(), "write a scene of its own, and draw it"));
    commands.push(("sandtable --help".to_owned(), "list all commands"));
    let widths = commands.iter().map(|(command, _)| command.chars().count());
    let width = widths.filter(|width| *width <= ALIGNED_WIDTH).max().unwrap_or(0);
    lines.extend(commands.iter().map(|(command, what)| format!("  {command:<width$}  {what}")));
    lines
}

/// The number of files of a kind, and the first names.
fn listed(files: &[PathBuf], one: &str, many: &str) -> Option<String> {
    let names: Vec<String> = files.iter().take(SHOWN_NAMES).map(|file| shell(file)).collect();
    let more = if files.len() > SHOWN_NAMES { ", …" } else { "" };
    (!files.is_empty()).then(|| format!("  {}: {}{more}", counted(files.len(), one, many), names.join(", ")))
}

/// Commands for the first file of each kind.
fn commands(found: &FoundFiles) -> Vec<(String, &'static str)> {
    let mut commands = Vec::new();
    if let Some(scene) = found.scenes.first() {
        let scene = shell(scene);
        commands.push((format!("sandtable render {scene}"), "draw the scene"));
        commands.push((format!("sandtable check {scene}"), "find what is wrong with it"));
    }
    if let Some(dem) = found.elevation.first() {
        let dem = shell(dem);
        let vectors: Vec<String> =
            found.vectors.iter().take(SUGGESTED_VECTORS).map(|file| shell(file)).collect();
        let vectors = match vectors.is_empty() {
            true => String::new(),
            false => format!(" --vectors {}", vectors.join(" ")),
        };
        commands.push((format!("sandtable dem info {dem}"), "say what the file holds"));
        // `new` writes over no file.
        let is_taken = found.scenes.iter().any(|scene| scene.starts_with("my-scene"));
        let (folder, what) = match is_taken {
            true => ("other-scene", "make another scene"),
            false => ("my-scene", "make a first scene"),
        };
        commands.push((format!("sandtable new {folder} --dem {dem}{vectors}"), what));
    } else if let Some(vector) = found.vectors.first() {
        commands.push((
            format!("sandtable new my-scene --dem DEM.tif --vectors {}", shell(vector)),
            "make a first scene; it needs elevation, too",
        ));
    }
    commands
}

/// Refuses an elevation file or a vector file where a scene file is wanted, with the command that makes one of it, and a folder
/// with the scene in it.
///
/// # Errors
/// By its name the file is no scene.
pub fn check_scene(command: &Command) -> Result<(), CliError> {
    let Some(path) = command.scene() else { return Ok(()) };
    if path.is_dir() {
        return Err(CliError::Input {
            error: format!("{}: this is a folder, not a scene file", path.display()).into(),
            hint: Some(match found_in(path).scenes.first() {
                Some(scene) => format!("it has a scene:\n  {}", shell(scene)),
                None => format!("there is no scene in it:\n  sandtable new {} --dem DEM.tif", shell(path)),
            }),
        });
    }
    if !path.is_file() {
        return Ok(());
    }
    let (what, option) = match kind_of_name(path) {
        None => return Ok(()),
        Some(FoundKind::Elevation) => ("an elevation file", format!("--dem {}", shell(path))),
        Some(FoundKind::Vector) => ("a vector file", format!("--dem DEM.tif --vectors {}", shell(path))),
    };
    Err(CliError::Input {
        error: format!("{}: this is {what}, not a scene file", path.display()).into(),
        hint: Some(format!("to make a scene of it:\n  sandtable new my-scene {option}")),
    })
}

/// The error of a command, with the next command where its scene is missing.
pub fn with_next_command(error: CliError, command: &Command) -> CliError {
    match (error, command.scene()) {
        (CliError::Input { error, hint: None }, Some(scene)) if scene.symlink_metadata().is_err() => {
            let hint = "`sandtable` alone lists the scenes of this folder, `sandtable demo` writes one";
            CliError::Input { error, hint: Some(hint.to_owned()) }
        }
        (error, _) => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commands_follow_the_files() {
        let files = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        let found = FoundFiles {
            scenes: files(&["a b.toml"]),
            elevation: files(&["dem.tif", "x.asc"]),
            vectors: files(&["1.shp", "2.shp", "3.shp", "4.shp", "5.shp"]),
            has_more: true,
        };
        let text = first_steps(&found).join("\n");
        for wanted in [
            "  1 scene: 'a b.toml'\n",
            "  2 elevation files: dem.tif, x.asc\n",
            "  5 vector files: 1.shp, 2.shp, 3.shp, 4.shp, …\n",
            "sandtable render 'a b.toml' ",
            "sandtable new my-scene --dem dem.tif --vectors 1.shp 2.shp 3.shp ",
            "sandtable demo ",
        ] {
            assert!(text.contains(wanted), "{wanted}\n{text}");
        }
        let made = FoundFiles { scenes: files(&["my-scene/scene.toml"]), ..found };
        assert!(first_steps(&made).join("\n").contains("sandtable new other-scene --dem dem.tif "));
        let nothing = first_steps(&FoundFiles::default()).join("\n");
        assert!(nothing.contains("No scene") && nothing.contains("sandtable demo"), "{nothing}");
        assert!(!nothing.contains("render"), "{nothing}");
    }
}

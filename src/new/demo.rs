//! The demonstration scene with its data, out of the program itself.
//!
//! ```text
//! FOLDER/scene.toml        the Jacksboro fault, as in `scenes/jacksboro.toml`
//!        jacksboro/…       elevation, streams, lakes, roads
//!        models/…          what stands on the ground
//! ```
//!
//! The files are 0.4 MB, a hundredth of the program.

use std::fs;
use std::path::{Path, PathBuf};

use crate::found_files::SCENE_NAME;
use sandtable_files::disk::{self, WriteFileError};
use sandtable_files::output_files::OutputFiles;

const SCENE: &str = include_str!("../../scenes/jacksboro.toml");

/// The files that the scene reads, with the files that those read.
const DATA: &[(&str, &[u8])] = &[
    ("jacksboro/dem.tif", include_bytes!("../../assets/jacksboro/dem.tif")),
    ("jacksboro/lake.geojson", include_bytes!("../../assets/jacksboro/lake.geojson")),
    ("jacksboro/roads.geojson", include_bytes!("../../assets/jacksboro/roads.geojson")),
    ("jacksboro/streams.geojson", include_bytes!("../../assets/jacksboro/streams.geojson")),
    ("models/bridge.glb", include_bytes!("../../assets/models/bridge.glb")),
    ("models/farmhouse.mtl", include_bytes!("../../assets/models/farmhouse.mtl")),
    ("models/farmhouse.obj", include_bytes!("../../assets/models/farmhouse.obj")),
    ("models/farmhouse_walls.png", include_bytes!("../../assets/models/farmhouse_walls.png")),
    ("models/firtree.mtl", include_bytes!("../../assets/models/firtree.mtl")),
    ("models/firtree.obj", include_bytes!("../../assets/models/firtree.obj")),
    ("models/tent.glb", include_bytes!("../../assets/models/tent.glb")),
    ("models/truck.3ds", include_bytes!("../../assets/models/truck.3ds")),
    ("models/watchtower.3ds", include_bytes!("../../assets/models/watchtower.3ds")),
];

/// Where the scene of the repository and the scene of the demonstration differ.
const CHANGES: [(&str, &str); 3] = [
    ("../assets/", ""),
    ("scenes/jacksboro.toml", SCENE_NAME),
    (" (assets/README.md tells how)", " by a program"),
];

/// A demonstration that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum WriteDemoError {
    #[error("{}: something of this name exists already; remove it, or name another folder: sandtable demo DIR", .0.display())]
    Exists(PathBuf),
    #[error(transparent)]
    Write(#[from] WriteFileError),
}

/// Writes the demonstration into `folder`, which is made and must be new or empty. Returns the path of the scene.
///
/// # Errors
/// See [`WriteDemoError`]; no file is written then.
pub fn write_demo(folder: &Path) -> Result<PathBuf, WriteDemoError> {
    let is_empty = || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    if folder.symlink_metadata().is_ok() && !is_empty() {
        return Err(WriteDemoError::Exists(folder.to_owned()));
    }
    let mut outputs = OutputFiles::default();
    for name in ["jacksboro", "models"] {
        disk::make_folder(&folder.join(name))?;
    }
    for (name, bytes) in DATA {
        outputs.write(&folder.join(name), bytes)?;
    }
    let scene = folder.join(SCENE_NAME);
    outputs.write(&scene, scene_text().as_bytes())?;
    outputs.publish()?;
    Ok(scene)
}

/// The text of the scene, with paths from its own folder.
fn scene_text() -> String {
    CHANGES.iter().fold(SCENE.to_owned(), |text, (from, to)| text.replace(from, to))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_names_its_own_files_alone() {
        let text = scene_text();
        assert!(!text.contains("assets") && !text.contains("scenes/") && !text.contains(".."), "{text}");
        for line in text.lines().filter(|line| line.starts_with("file = ") || line.starts_with("dem = ")) {
            let name = line.split('"').nth(1).unwrap_or_default();
            assert!(DATA.iter().any(|(known, _)| *known == name), "{line}");
        }
        assert!(CHANGES.iter().all(|(from, _)| SCENE.contains(from)));
    }
}

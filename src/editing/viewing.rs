//! The content of a window: a scene file, or an elevation file on its own.

use std::path::{Path, PathBuf};

use crate::editor::SceneEditor;
use sandtable_scene::scene_file::{OpenSceneError, is_scene_file};

/// The options of a window.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ViewerOptions {
    /// The scene or elevation file; `None` shows a list of files to open.
    pub file: Option<PathBuf>,
    /// Folders that a scene may read besides the parent of its own.
    pub allowed: Vec<PathBuf>,
    /// The commands that a test gives the window instead of a user.
    pub script: Option<PathBuf>,
    /// The number of frames after which a script ends; `None` for when its commands end.
    pub frames: Option<u32>,
    /// The size in pixels of frames that are drawn without a window, by a script; `None` for a window.
    pub offscreen: Option<(u32, u32)>,
    /// Whether the window says what it did and how long its frames took, as JSON on standard output, when it closes.
    pub reports: bool,
}

/// The editor of the scene file at `path`, or of a new scene of an elevation file there.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_to_view(path: &Path, allowed: &[PathBuf]) -> Result<SceneEditor, OpenSceneError> {
    match is_scene_file(path) {
        true => SceneEditor::open(path, allowed, None),
        false => SceneEditor::of_elevation(path, allowed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_elevation_file_is_a_scene_of_its_ground() {
        let editor =
            open_to_view(Path::new(concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/valley.asc")), &[])
                .expect("readable");
        let scene = editor.source().build(&|_| ()).expect("sound");
        assert!(scene.lattice.columns() > 100 && scene.features.is_empty() && scene.cameras.len() == 1);
        assert!(!editor.is_changed(), "nothing is lost where nothing was edited");
    }

    #[test]
    fn only_toml_files_are_scenes() {
        assert!(is_scene_file(Path::new("a/B.TOML")) && !is_scene_file(Path::new("a/toml.tif")));
    }
}

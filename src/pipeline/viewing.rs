//! What a window shows: a scene file, or an elevation file on its own.
//!
//! An elevation file alone is the scene `[terrain] dem = "…"`, so that it has everything that a scene has.

use std::path::{Path, PathBuf};

use crate::pipeline::files;
use crate::pipeline::scene_file::{OpenSceneError, build_scene_text, open_scene, open_scene_exaggerated};
use crate::scene::SceneModel;

/// What a window is opened for.
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
    /// Whether the window says what it did and how long its frames took, as JSON on standard output, when it closes.
    pub reports: bool,
}

/// Whether the file is a scene by its name; every other file is taken for elevations.
pub fn is_scene_file(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

/// How many times as high as they are heights are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ViewedHeights {
    /// As the scene file states.
    #[default]
    AsStated,
    /// So many times, whatever it states.
    Times(f64),
}

/// The scene in the file at `path`, or the ground of an elevation file. `progress` is called with the name of each step
/// as it begins.
///
/// # Errors
/// See [`OpenSceneError`]; of an elevation file they name the line of a scene file that does not exist.
pub fn open_to_view(
    path: &Path,
    allowed: &[PathBuf],
    heights: ViewedHeights,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    progress(if is_scene_file(path) { "reading the scene file" } else { "reading the elevation file" });
    match heights {
        ViewedHeights::AsStated if is_scene_file(path) => open_scene(path, allowed, progress),
        ViewedHeights::AsStated => build_scene_text(path, &bare_scene(path), allowed, progress),
        ViewedHeights::Times(factor) if is_scene_file(path) => {
            open_scene_exaggerated(path, allowed, factor, progress)
        }
        ViewedHeights::Times(factor) => {
            let text = format!("{}vertical_exaggeration = {factor:?}\n", bare_scene(path));
            build_scene_text(path, &text, allowed, progress)
        }
    }
}

/// A scene of an elevation file and nothing else.
pub fn bare_scene(dem: &Path) -> String {
    let name = toml_edit::Value::from(files::file_name(dem));
    format!("[terrain]\ndem = {name}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_elevation_file_is_a_scene_of_its_ground() {
        let open = |path: &str, heights| open_to_view(Path::new(path), &[], heights, &|_| ()).expect("sound");
        let scene = open("assets/jacksboro/valley.asc", ViewedHeights::AsStated);
        assert!(scene.lattice.columns() > 100 && scene.features.is_empty() && scene.cameras.len() == 1);
        assert_eq!(scene.scale.0, 1.0);
        assert_eq!(open("assets/jacksboro/valley.asc", ViewedHeights::Times(2.5)).scale.0, 2.5);
        assert_eq!(open("scenes/road.toml", ViewedHeights::Times(2.5)).scale.0, 2.5);
    }

    #[test]
    fn only_toml_files_are_scenes() {
        assert!(is_scene_file(Path::new("a/B.TOML")) && !is_scene_file(Path::new("a/toml.tif")));
        assert_eq!(bare_scene(Path::new("x/a\"b.tif")), "[terrain]\ndem = 'a\"b.tif'\n");
    }
}

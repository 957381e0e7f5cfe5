//! Opens scene files with the findings about them.

use std::path::{Path, PathBuf};

use sandtable_description::finding::Finding;
use sandtable_scene::build::build;
use sandtable_scene::scene_file::OpenSceneError;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_origin::SceneOrigin;

use crate::lint;

/// [`open_scene`](sandtable_scene::scene_file::open_scene) with the findings about the scene, in the order of output.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_linted(
    path: &Path,
    allowed: &[PathBuf],
    progress: &dyn Fn(&'static str),
) -> Result<(SceneModel, Vec<Finding>), OpenSceneError> {
    build_linted(&SceneOrigin::file(path, allowed), progress)
}

/// [`open_linted`] of a scene of any origin.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn build_linted(
    origin: &SceneOrigin,
    progress: &dyn Fn(&'static str),
) -> Result<(SceneModel, Vec<Finding>), OpenSceneError> {
    progress("reading the scene file");
    let (document, assets) = origin.document(None)?;
    let scene = build(&document, &assets, progress)?;
    progress("checking");
    let findings = lint(&document, &assets, &scene);
    Ok((scene, findings))
}

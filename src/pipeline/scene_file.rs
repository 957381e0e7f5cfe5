//! Opens scene files.

use std::path::{Path, PathBuf};

use crate::description::diagnostic::{Diagnostic, Diagnostics};
use crate::description::document::Document;
use crate::description::parse::parse_including;
use crate::pipeline::files::{self, ReadFileError};
use crate::scene::assets::{AssetError, Assets};
use crate::scene::build::{build, build_ground};
use crate::scene::{SceneGround, SceneModel};

/// A scene that cannot be opened.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum OpenSceneError {
    #[error(transparent)]
    File(#[from] ReadFileError),
    #[error(transparent)]
    Assets(#[from] AssetError),
    #[error("the scene file is wrong")]
    Parse(#[from] Diagnostics),
    #[error("the scene cannot be built")]
    Build(#[from] Diagnostic),
}

/// Reads, parses and builds the scene file at `path`. The scene reads files under the parent of its own folder and
/// under the folders `allowed`. `progress` is called with the name of each step as it begins.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_scene(
    path: &Path,
    allowed: &[PathBuf],
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    progress("reading the scene file");
    let (document, assets) = open_document(path, allowed)?;
    Ok(build(&document, &assets, progress)?)
}

/// Reads and parses the scene file at `path` and builds its ground: less work than [`open_scene`], and enough for
/// heights. Files of features that leave the ground as it is are not read.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_scene_ground(path: &Path, allowed: &[PathBuf]) -> Result<SceneGround, OpenSceneError> {
    let (document, assets) = open_document(path, allowed)?;
    Ok(build_ground(&document, &assets)?)
}

/// [`open_scene`] with heights true to scale, whatever exaggeration the scene file states.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_scene_true_to_scale(
    path: &Path,
    allowed: &[PathBuf],
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    progress("reading the scene file");
    let (mut document, assets) = open_document(path, allowed)?;
    document.terrain.vertical_exaggeration = 1.0;
    Ok(build(&document, &assets, progress)?)
}

fn open_document(path: &Path, allowed: &[PathBuf]) -> Result<(Document, Assets), OpenSceneError> {
    let bytes = files::read(path)?;
    let assets = Assets::new(path, allowed)?;
    let load = |name: &str| assets.read(name).map_err(Into::into);
    let document = parse_including(&path.to_string_lossy(), &bytes, &load)?;
    Ok((document, assets))
}

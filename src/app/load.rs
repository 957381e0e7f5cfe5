//! From a path to a scene.

use std::path::Path;

use crate::app::arguments::Access;
use crate::app::failure::CliError;
use crate::app::files;
use crate::description::document::Document;
use crate::description::parse::parse_bytes_including;
use crate::scene::assets::Assets;
use crate::scene::build::{build, build_ground};
use crate::scene::{Scene, SceneGround};

/// Reads, parses and builds the scene at `path`. `step` is called with what is done next.
///
/// # Errors
/// Everything wrong with the scene file, or the first thing wrong with what it names.
pub fn scene(path: &Path, access: &Access, step: &dyn Fn(&'static str)) -> Result<Scene, CliError> {
    step("reading the scene file");
    let (document, assets) = document(path, access)?;
    build(&document, &assets, step).map_err(CliError::input)
}

/// Reads and parses the scene at `path`, and builds its ground.
///
/// # Errors
/// As for [`scene`], without what is wrong with features that leave the ground as it is.
pub fn scene_ground(path: &Path, access: &Access) -> Result<SceneGround, CliError> {
    let (document, assets) = document(path, access)?;
    build_ground(&document, &assets).map_err(CliError::input)
}

/// As [`scene`], with heights true to scale whatever exaggeration the scene file asks for.
///
/// # Errors
/// As for [`scene`].
pub fn unstretched(path: &Path, access: &Access, step: &dyn Fn(&'static str)) -> Result<Scene, CliError> {
    step("reading the scene file");
    let (mut document, assets) = document(path, access)?;
    document.terrain.vertical_exaggeration = 1.0;
    build(&document, &assets, step).map_err(CliError::input)
}

fn document(path: &Path, access: &Access) -> Result<(Document, Assets), CliError> {
    let bytes = files::read(path)?;
    let assets = Assets::new(path, &access.allow).map_err(CliError::input)?;
    let load = |name: &str| assets.read(name).map_err(Into::into);
    let document = parse_bytes_including(&path.to_string_lossy(), &bytes, &load).map_err(CliError::input)?;
    Ok((document, assets))
}

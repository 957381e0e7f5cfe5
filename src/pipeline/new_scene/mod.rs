//! A first scene file for an elevation model and vector files, to be edited by hand.
//!
//! ```text
//! elevation ──► ground: range of heights, extent ──┐
//! vectors ────► survey: what each layer holds ─────┴─► text ──► DIR/scene.toml
//! ```
//!
//! The file is meant to be read: a comment on every table, sizes stated even where they are the default. File names are
//! relative to the scene file, so that a folder can be moved together with its data. Nothing is copied: the scene reads
//! data under the parent of DIR as it is; for other data the user must allow the folders of [`WrittenScene::allowed`].

mod folder;
mod survey;
mod text;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use glam::Vec3;

use crate::annotate::nice::NiceNumber;
use crate::description::parse::parse;
use crate::pipeline::files::{self, SystemError, WriteFileError};
use crate::pipeline::new_scene::folder::{FolderError, SceneFolder};
use crate::pipeline::new_scene::survey::SurveyError;
use crate::pipeline::new_scene::text::{CameraDraft, SceneDraft, VectorDraft};
use crate::pipeline::scene_file::OpenSceneError;
use crate::scene::SceneModel;
use crate::scene::assets::Assets;
use crate::scene::build::build;
use crate::terrain::query::{Interpolation, ground_height};

/// The name of the scene file in its folder.
const FILE_NAME: &str = "scene.toml";

/// About as many contour lines as the eye can follow.
const CONTOURS: f64 = 12.0;

/// Options for a new scene file.
#[derive(Clone, Debug, Default)]
pub struct NewSceneOptions {
    /// The folder for the scene file; it is made where it does not exist.
    pub folder: PathBuf,
    /// Elevation files, tiles of one raster; at least one.
    pub dem: Vec<PathBuf>,
    /// Vector files.
    pub vectors: Vec<PathBuf>,
    /// The title; the name of the first elevation file where `None`.
    pub title: Option<String>,
    /// The coordinate system of elevation that names none, as a scene file states it.
    pub crs: Option<String>,
}

/// A scene file that was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenScene {
    /// The file.
    pub path: PathBuf,
    /// The folders that the scene reads besides the parent of its own.
    pub allowed: Vec<PathBuf>,
}

/// A scene file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum NewSceneError {
    #[error("{}: there is such a file already; remove it, or name another folder", .0.display())]
    Exists(PathBuf),
    #[error(transparent)]
    Folder(#[from] FolderError),
    #[error(transparent)]
    Survey(#[from] SurveyError),
    #[error(transparent)]
    Ground(#[from] OpenSceneError),
    #[error(transparent)]
    Write(#[from] WriteFileError),
}

/// Writes a scene file. `progress` is called with the name of each step as it begins.
///
/// # Errors
/// See [`NewSceneError`]; nothing is written then, and no folder stays behind.
pub fn write(
    options: &NewSceneOptions,
    progress: &dyn Fn(&'static str),
) -> Result<WrittenScene, NewSceneError> {
    progress("surveying files");
    let path = options.folder.join(FILE_NAME);
    if path.symlink_metadata().is_ok() {
        return Err(NewSceneError::Exists(path));
    }
    let folder = SceneFolder::new(&options.folder)?;
    let dem = options.dem.iter().map(|file| folder.relative(file)).collect::<Result<Vec<_>, _>>()?;
    let vectors =
        options.vectors.iter().map(|file| survey_file(file, &folder)).collect::<Result<Vec<_>, _>>()?;
    let allowed = folder.folders_to_allow(options.dem.iter().chain(&options.vectors))?;

    progress("reading elevation");
    let title = options.title.clone().unwrap_or_else(|| title_of(&options.dem[0]));
    let draft = SceneDraft { title, dem, crs: options.crs.clone(), ..SceneDraft::default() };
    let is_new = !options.folder.exists();
    let system = |error: io::Error| WriteFileError::new(&path, SystemError::from(error));
    fs::create_dir_all(&options.folder).map_err(system)?;
    let draft = complete(&path, draft, &allowed).inspect_err(|_| {
        if is_new {
            // Does nothing where the folder is no longer empty.
            let _ = fs::remove_dir(&options.folder);
        }
    })?;
    files::write(&path, text::scene(&draft, &vectors).as_bytes())?;
    Ok(WrittenScene { path, allowed })
}

fn survey_file(file: &Path, folder: &SceneFolder) -> Result<VectorDraft, NewSceneError> {
    Ok(VectorDraft { file: folder.relative(file)?, layers: survey::layers(file)? })
}

/// Completes the draft from the elevation: heights, extent, and a camera that sees all of it.
fn complete(path: &Path, mut draft: SceneDraft, allowed: &[PathBuf]) -> Result<SceneDraft, OpenSceneError> {
    let assets = Assets::new(path, allowed)?;
    let built = |draft: &SceneDraft| {
        let document = parse(&path.to_string_lossy(), &text::terrain(draft))?;
        Ok::<_, OpenSceneError>(build(&document, &assets, &|_| ())?)
    };
    let plain = built(&draft)?;
    let (lattice, (low, high)) = (&plain.lattice, plain.height_range_m);
    draft.size_m = lattice.extent().size().max_element();
    draft.relief_m = f64::from(high - low);
    draft.crs_name = plain.crs.name().to_owned();
    draft.exaggeration = exaggeration(draft.relief_m / draft.size_m);
    draft.contours_m = NiceNumber::at_most(draft.relief_m / CONTOURS).map(|nice| nice.value());
    let scene = if draft.exaggeration == 1.0 { plain } else { built(&draft)? };
    draft.camera = camera(&scene);
    Ok(draft)
}

/// The vertical exaggeration for a relief as a share of the extent: flat country shows nothing at true scale.
fn exaggeration(relief: f64) -> f64 {
    match relief {
        _ if relief > 0.05 => 1.0,
        _ if relief > 0.02 => 2.0,
        _ => 3.0,
    }
}

/// The default camera of the scene as a table states it; `None` where there is no ground at the center to look at.
fn camera(scene: &SceneModel) -> Option<CameraDraft> {
    let view = scene.cameras.first()?;
    let (lattice, scale) = (&scene.lattice, scene.scale);
    let map_position = |world: Vec3| lattice.origin() + world.truncate().as_dvec2();
    let look_at = map_position(view.target);
    let ground_m = ground_height(lattice, Interpolation::Planar, look_at).height_m()?;
    Some(CameraDraft {
        name: view.name.clone(),
        eye: map_position(view.eye),
        eye_elevation_m: scale.elevation_m(f64::from(view.eye.z)),
        look_at,
        look_at_height_m: f64::from(view.target.z) - scale.world_z(ground_m),
        field_of_view_deg: f64::from(view.fov_y_rad.to_degrees()),
    })
}

/// A title from a file name.
fn title_of(file: &Path) -> String {
    let words = files::file_stem(file).replace(['_', '-'], " ");
    if words.trim().is_empty() { "A scene".into() } else { words }
}

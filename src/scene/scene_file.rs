//! Opens scene files.

use std::path::{Path, PathBuf};

use crate::assets::{AssetError, Assets};
use crate::build::{SceneGround, build, build_ground, build_with};
use crate::build_errors::BuildErrors;
use crate::planned_pictures::ElevationNeed;
use crate::scene_model::SceneModel;
use crate::scene_origin::SceneOrigin;
use sandtable_base::message::chain::error_text;
use sandtable_base::message::suggest::{quoted, remedy};
use sandtable_description::diagnostic::{Diagnostic, Diagnostics};
use sandtable_description::document::Document;
use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;
use sandtable_files::disk::ReadFileError;

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
    Build(#[from] BuildErrors),
    #[error("{}", no_phase(.name, .names))]
    NoPhase { name: String, names: Vec<String> },
    #[error("{}", no_flight(.name.as_deref(), .names))]
    NoFlight { name: Option<String>, names: Vec<String> },
}

impl From<Diagnostic> for OpenSceneError {
    fn from(error: Diagnostic) -> Self {
        Self::Build(error.into())
    }
}

impl OpenSceneError {
    /// The errors that keep the scene from being built, as findings.
    pub fn findings(&self) -> Vec<Finding> {
        match self {
            Self::Parse(errors) => errors.as_slice().iter().map(Finding::from).collect(),
            Self::Build(errors) => errors.as_slice().iter().map(Finding::from).collect(),
            other => vec![other.finding()],
        }
    }

    /// The file that is wrong; `None` where the error is about no file in particular.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(error) => Some(&error.path),
            Self::Parse(errors) => errors.as_slice().first().map(|error| Path::new(error.place().file())),
            Self::Build(errors) => errors.as_slice().first().map(|error| Path::new(error.place().file())),
            Self::Assets(_) | Self::NoPhase { .. } | Self::NoFlight { .. } => None,
        }
    }

    /// The error as a finding without a place.
    pub fn finding(&self) -> Finding {
        let code = match self {
            Self::NoPhase { .. } | Self::NoFlight { .. } => FindingCode::UnknownName,
            Self::File(_) | Self::Assets(_) | Self::Parse(_) | Self::Build(_) => FindingCode::UnreadableFile,
        };
        Finding::new(code, error_text(self))
    }
}

fn no_phase(name: &str, names: &[String]) -> String {
    match names {
        [] => format!("the scene has no phase '{}'; it has no [[phase]]", quoted(name)),
        names => none_named("phase", name, names),
    }
}

fn no_flight(name: Option<&str>, names: &[String]) -> String {
    match (name, names) {
        (Some(name), [_, ..]) => none_named("flight", name, names),
        _ => "the scene has no [[flight]]; add one with a name and `points`".to_owned(),
    }
}

/// No `noun` is called `name`, but these are there.
fn none_named(noun: &str, name: &str, names: &[String]) -> String {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let remedy = remedy(name, &names, &format!("its {noun}s are")).replace(" or ", " and ");
    format!("the scene has no {noun} '{}'; {remedy}", quoted(name))
}

/// Whether the file is a scene by its name; every other file is taken for elevations.
pub fn is_scene_file(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
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
    build_scene(&SceneOrigin::file(path, allowed), progress)
}

/// Parses and builds a scene that has no file, of the text `text`; it reads files as one at `path` would.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn build_scene_text(
    path: &Path,
    text: &str,
    allowed: &[PathBuf],
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    build_scene(&SceneOrigin::text(path, text, allowed), progress)
}

/// Parses and builds a scene of any origin, as [`open_scene`] does that of a file.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn build_scene(
    origin: &SceneOrigin,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    progress("reading the scene file");
    let (document, assets) = origin.document(None)?;
    Ok(build(&document, &assets, progress)?)
}

/// [`open_scene`] for the phase called `phase`, where one is named, with as many samples of its elevation as are needed.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_scene_for(
    path: &Path,
    allowed: &[PathBuf],
    phase: Option<&str>,
    need: ElevationNeed<'_>,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    progress("reading the scene file");
    let (document, assets) = open_document(path, allowed, phase)?;
    check_phase(&document, phase)?;
    Ok(build_with(&document, &assets, need, progress)?)
}

/// Checks that a phase is one of the document's, where one is named.
///
/// # Errors
/// [`OpenSceneError::NoPhase`].
pub fn check_phase(document: &Document, phase: Option<&str>) -> Result<(), OpenSceneError> {
    let is_declared = |name: &str| document.phases.iter().any(|phase| phase.name.as_str() == name);
    match phase.filter(|name| !is_declared(name)) {
        None => Ok(()),
        Some(name) => {
            let names = document.phases.iter().map(|phase| phase.name.to_string()).collect();
            Err(OpenSceneError::NoPhase { name: name.to_owned(), names })
        }
    }
}

/// The names of the phases of the scene file at `path`, in its order; of other files only those that it includes are read.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn phases(path: &Path, allowed: &[PathBuf]) -> Result<Vec<String>, OpenSceneError> {
    let (document, _) = open_document(path, allowed, None)?;
    Ok(document.phases.iter().map(|phase| phase.name.to_string()).collect())
}

/// Reads and parses the scene file at `path` and builds its ground: less work than [`open_scene`], and enough for
/// heights. Files of features that leave the ground as it is are not read.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_scene_ground(path: &Path, allowed: &[PathBuf]) -> Result<SceneGround, OpenSceneError> {
    let (document, assets) = open_document(path, allowed, None)?;
    Ok(build_ground(&document, &assets)?)
}

/// [`open_scene_ground`] in the phase called `phase`.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_phase_ground(
    path: &Path,
    allowed: &[PathBuf],
    phase: &str,
) -> Result<SceneGround, OpenSceneError> {
    let (document, assets) = open_document(path, allowed, Some(phase))?;
    check_phase(&document, Some(phase))?;
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
    open_scene_exaggerated(path, allowed, 1.0, progress)
}

/// [`open_scene`] with heights drawn `factor` times as high, above 0, whatever exaggeration the scene file states.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_scene_exaggerated(
    path: &Path,
    allowed: &[PathBuf],
    factor: f64,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    progress("reading the scene file");
    let (mut document, assets) = open_document(path, allowed, None)?;
    document.terrain.vertical_exaggeration = factor;
    Ok(build(&document, &assets, progress)?)
}

/// [`open_scene_true_to_scale`] for the land of an analysis: the scene's own analyses are not made.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_scene_land(
    path: &Path,
    allowed: &[PathBuf],
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    build_land(&SceneOrigin::file(path, allowed), progress)
}

/// [`open_scene_land`] of a scene of any origin.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn build_land(
    origin: &SceneOrigin,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    progress("reading the scene file");
    let (mut document, assets) = origin.document(None)?;
    document.terrain.vertical_exaggeration = 1.0;
    document.analyses.clear();
    Ok(build(&document, &assets, progress)?)
}

/// Reads and parses the scene file at `path`; files that it includes are read, those of its features are not.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_document(
    path: &Path,
    allowed: &[PathBuf],
    phase: Option<&str>,
) -> Result<(Document, Assets), OpenSceneError> {
    SceneOrigin::file(path, allowed).document(phase)
}

//! Opens scene files.

use std::path::{Path, PathBuf};

use crate::description::diagnostic::{Diagnostic, Diagnostics};
use crate::description::document::{Document, FlightTable};
use crate::description::finding::Finding;
use crate::description::finding_code::FindingCode;
use crate::description::parse::parse_in_phase;
use crate::message::chain::error_text;
use crate::message::suggest::{quoted, remedy};
use crate::pipeline::files::{self, ReadFileError};
use crate::pipeline::lint::cause_code::coded;
use crate::pipeline::lint::lint;
use crate::scene::SceneModel;
use crate::scene::assets::{AssetError, Assets};
use crate::scene::build::{SceneGround, build, build_ground, build_with};
use crate::scene::flights::{SceneFlight, flight};
use crate::scene::picture::camera;
use crate::scene::planned_pictures::ElevationNeed;

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
    Build(#[source] Diagnostic),
    #[error("{}", no_phase(.name, .names))]
    NoPhase { name: String, names: Vec<String> },
    #[error("{}", no_flight(.name.as_deref(), .names))]
    NoFlight { name: Option<String>, names: Vec<String> },
}

impl From<Diagnostic> for OpenSceneError {
    fn from(error: Diagnostic) -> Self {
        Self::Build(coded(error))
    }
}

impl OpenSceneError {
    /// The errors that keep the scene from being built, as findings.
    pub fn findings(&self) -> Vec<Finding> {
        match self {
            Self::Parse(errors) => errors.as_slice().iter().map(Finding::from).collect(),
            Self::Build(error) => vec![Finding::from(error)],
            other => vec![other.finding()],
        }
    }

    /// The file that is wrong; `None` where the error is about no file in particular.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(error) => Some(&error.path),
            Self::Parse(errors) => errors.as_slice().first().map(|error| Path::new(error.place().file())),
            Self::Build(error) => Some(Path::new(error.place().file())),
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
    open_scene_for(path, allowed, None, ElevationNeed::AllThatFit, progress)
}

/// [`open_scene`] with the findings about the scene, in the order of output.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_linted(
    path: &Path,
    allowed: &[PathBuf],
    progress: &dyn Fn(&'static str),
) -> Result<(SceneModel, Vec<Finding>), OpenSceneError> {
    progress("reading the scene file");
    let (document, assets) = open_document(path, allowed, None)?;
    let scene = build(&document, &assets, progress)?;
    progress("checking");
    let findings = lint(&document, &assets, &scene);
    Ok((scene, findings))
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
    let assets = Assets::new(path, allowed)?;
    let load = |name: &str| assets.read(name).map_err(Into::into);
    let document = parse_in_phase(&path.to_string_lossy(), text.as_bytes(), &load, None)?;
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
    let is_declared = |name: &str| document.phases.iter().any(|phase| phase.name.as_str() == name);
    match phase.filter(|name| !is_declared(name)) {
        None => Ok(build_with(&document, &assets, need, progress)?),
        Some(name) => {
            let names = document.phases.iter().map(|phase| phase.name.to_string()).collect();
            Err(OpenSceneError::NoPhase { name: name.to_owned(), names })
        }
    }
}

/// [`open_scene`] with its flight called `name`, or its first.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn open_scene_with_flight(
    path: &Path,
    allowed: &[PathBuf],
    name: Option<&str>,
    progress: &dyn Fn(&'static str),
) -> Result<(SceneModel, SceneFlight), OpenSceneError> {
    progress("reading the scene file");
    let (document, assets) = open_document(path, allowed, None)?;
    let is_meant = |table: &&FlightTable| name.is_none_or(|name| table.name.as_str() == name);
    let Some(table) = document.flights.iter().find(is_meant) else {
        let names = document.flights.iter().map(|flight| flight.name.to_string()).collect();
        return Err(OpenSceneError::NoFlight { name: name.map(str::to_owned), names });
    };
    let mut scene = build(&document, &assets, progress)?;
    // A scale bar for the distance of each frame's ground would jump from frame to frame.
    scene.furniture.scale_bar = false;
    let flight = flight(&document, table, &assets, &scene)?;
    // A camera that sees nothing is reported when its frame is drawn.
    if let Ok(start) = camera(&scene, &flight.view(0.0), (1280, 720)) {
        SceneFlight::hold_light(&mut scene, &start);
    }
    Ok((scene, flight))
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

fn open_document(
    path: &Path,
    allowed: &[PathBuf],
    phase: Option<&str>,
) -> Result<(Document, Assets), OpenSceneError> {
    let bytes = files::read(path)?;
    let assets = Assets::new(path, allowed)?;
    let load = |name: &str| assets.read(name).map_err(Into::into);
    let document = parse_in_phase(&path.to_string_lossy(), &bytes, &load, phase)?;
    Ok((document, assets))
}

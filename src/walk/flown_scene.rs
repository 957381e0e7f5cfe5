//! Opens scene files with one of their flights.

use std::path::{Path, PathBuf};

use sandtable_description::document::FlightTable;
use sandtable_picture::camera;
use sandtable_scene::build::build;
use sandtable_scene::flights::{SceneFlight, flight};
use sandtable_scene::scene_file::{OpenSceneError, open_document};
use sandtable_scene::scene_model::SceneModel;

/// [`open_scene`](sandtable_scene::scene_file::open_scene) with its flight called `name`, or its first; findings about the flight are among those of
/// the scene.
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
    let mut flight = flight(&document, table, &assets, &scene)?;
    scene.findings.append(&mut flight.findings);
    // A camera that sees nothing is reported when its frame is drawn.
    if let Ok(start) = camera(&scene, &flight.view(0.0), (1280, 720)) {
        SceneFlight::hold_light(&mut scene, &start);
    }
    Ok((scene, flight))
}

//! `sandtable model`: what is in a model file.

use std::path::Path;

use serde_json::json;

use crate::app::arguments::InfoOptions;
use crate::app::failure::CliError;
use crate::app::{files, output};
use crate::geom::aabb::Aabb;
use crate::model::Model;
use crate::model::error::{ModelError, error_chain};
use crate::model::read;
use crate::scene::assets::Assets;

/// `model info`.
///
/// # Errors
/// The file cannot be had or read.
pub fn info(options: &InfoOptions) -> Result<(), CliError> {
    let path: &Path = &options.file;
    let wrong = |error: String| CliError::input(format!("{}: {error}", path.display()));
    let bytes = files::read(path)?;
    let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let assets = Assets::new(path, &[]).map_err(|error| wrong(error.to_string()))?;
    let companions = assets.beside(&name).map_err(|error| wrong(error.to_string()))?;
    let model = read::read(&path.to_string_lossy(), &bytes, &companions).map_err(|error| match error {
        ModelError::Empty { .. } | ModelError::Unknown { .. } => CliError::input(error),
        _ => wrong(error_chain(&error)),
    })?;
    let text = if options.json { format!("{}\n", describe(&model)) } else { table(path, &model) };
    output::print(&text)
}

/// One JSON object.
fn describe(model: &Model) -> serde_json::Value {
    let census = model.census;
    let Aabb { min, max } = model.bounds().unwrap_or_default();
    json!({
        "meshes": census.meshes,
        "vertices": census.vertices,
        "faces": census.faces,
        "materials": census.materials,
        "bounds": { "min": min.to_array(), "max": max.to_array() },
        "notes": model.notes,
    })
}

fn table(path: &Path, model: &Model) -> String {
    let census = model.census;
    let Aabb { min, max } = model.bounds().unwrap_or_default();
    let mut lines = vec![
        format!("{}", path.display()),
        format!("  meshes     {}", census.meshes),
        format!("  vertices   {}", census.vertices),
        format!("  faces      {}", census.faces),
        format!("  materials  {}", census.materials),
        format!("  bounds     ({}, {}, {}) to ({}, {}, {}), Z up", min.x, min.y, min.z, max.x, max.y, max.z),
    ];
    lines.extend(model.notes.iter().map(|note| format!("  note       {note}")));
    output::text_of(&lines)
}

//! `sandtable model`: what is in a model file.

use std::path::Path;

use serde_json::json;

use crate::app::arguments::InfoOptions;
use crate::app::failure::Failure;
use crate::app::files;
use crate::model::read;
use crate::scene::assets::Assets;

/// `model info`.
///
/// # Errors
/// The file cannot be had or read.
pub fn info(options: &InfoOptions) -> Result<(), Failure> {
    let path: &Path = &options.file;
    let wrong = |error: String| Failure::input(format!("{}: {error}", path.display()));
    let bytes = files::read(path)?;
    let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let assets = Assets::new(path, &[]).map_err(|error| wrong(error.to_string()))?;
    let companions = assets.beside(&name).map_err(|error| wrong(error.to_string()))?;
    let model = read::read(&name, &bytes, &companions).map_err(|error| wrong(error.to_string()))?;
    let census = model.census;
    let (min, max) = model.bounds().unwrap_or_default();
    if options.json {
        let bounds = json!({ "min": min.to_array(), "max": max.to_array() });
        println!(
            "{}",
            json!({
                "meshes": census.meshes, "vertices": census.vertices, "faces": census.faces,
                "materials": census.materials, "bounds": bounds, "notes": model.notes,
            })
        );
        return Ok(());
    }
    println!("{}", path.display());
    println!("  meshes     {}", census.meshes);
    println!("  vertices   {}", census.vertices);
    println!("  faces      {}", census.faces);
    println!("  materials  {}", census.materials);
    println!("  bounds     ({}, {}, {}) to ({}, {}, {}), Z up", min.x, min.y, min.z, max.x, max.y, max.z);
    for note in &model.notes {
        println!("  note       {note}");
    }
    Ok(())
}

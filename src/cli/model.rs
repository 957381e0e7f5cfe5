//! `sandtable model info`: counts and bounds of a model file.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use crate::error::CliError;
use crate::output::{print, print_lines, row};
use sandtable_geom::aabb::Aabb;
use sandtable_scene::model_file;

#[derive(Debug, Args)]
pub struct ModelArguments {
    /// The file
    pub file: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

pub fn run(arguments: &ModelArguments) -> Result<(), CliError> {
    let model = model_file::open(&arguments.file)?;
    let census = model.census;
    let Aabb { min, max } = model.bounds().unwrap_or_default();
    if arguments.json {
        let object = json!({
            "meshes": census.meshes,
            "vertices": census.vertices,
            "faces": census.faces,
            "materials": census.materials,
            "bounds": { "min": min.to_array(), "max": max.to_array() },
            "notes": model.notes,
        });
        return print(&format!("{object}\n"));
    }
    let bounds = format!("({}, {}, {}) to ({}, {}, {}), Z up", min.x, min.y, min.z, max.x, max.y, max.z);
    let mut lines = vec![
        arguments.file.display().to_string(),
        row(10, "meshes", census.meshes),
        row(10, "vertices", census.vertices),
        row(10, "faces", census.faces),
        row(10, "materials", census.materials),
        row(10, "bounds", bounds),
    ];
    lines.extend(model.notes.iter().map(|note| row(10, "note", note)));
    print_lines(&lines)
}

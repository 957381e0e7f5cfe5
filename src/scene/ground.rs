//! The first pass: the elevation file to the ground lattice.

use std::sync::Arc;

use crate::dem::raster::Raster;
use crate::dem::read::{self, Hints};
use crate::dem::warp;
use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::geom::crs::Crs;
use crate::scene::assets::Assets;
use crate::scene::place::parse_crs;
use crate::terrain::lattice::Lattice;

/// The raster as read and the lattice made of it.
pub struct LoadedGround {
    /// As the file holds it.
    pub source: Arc<Raster>,
    /// In the scene's system, before earthworks.
    pub lattice: Lattice,
    /// The scene's system.
    pub crs: Crs,
}

/// Reads the document's elevation file and brings it to a metric system.
///
/// # Errors
/// The file cannot be had or read, or cannot be brought to the scene's system.
pub fn load(document: &Document, assets: &Assets) -> Result<LoadedGround, Diagnostic> {
    let terrain = &document.terrain;
    let dem = &terrain.dem;
    let wrong = |reason: String| document.error(dem, reason);
    let bytes = assets.read(dem.get_ref()).map_err(|error| wrong(error.to_string()))?;
    let companions = |name: &str| assets.read(name).ok();
    let value = |stated: &Option<toml::Spanned<f64>>| stated.as_ref().map(|value| *value.get_ref());
    let hints = Hints {
        png_height_scale: value(&terrain.height_scale),
        png_height_offset: value(&terrain.height_offset),
        cell: value(&terrain.cell),
        crs: parse_crs(document, terrain.crs.as_ref())?,
        companions: &companions,
        ..Hints::default()
    };
    let source = read::read(dem.get_ref(), &bytes, &hints).map_err(|error| wrong(error.to_string()))?;
    let target = parse_crs(document, document.crs.as_ref())?;
    let metric = warp::to_metric(&source, target.as_ref()).map_err(|error| wrong(error.to_string()))?;
    let lattice = Lattice::from_raster(&metric).map_err(|error| wrong(error.to_string()))?;
    let crs = metric.crs.or(target).unwrap_or_else(Crs::local);
    Ok(LoadedGround { source: Arc::new(source), lattice, crs })
}

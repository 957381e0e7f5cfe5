//! The first pass: the elevation file, or the tiles of one, to the ground lattice.

use std::sync::Arc;

use crate::dem::formats::height_encoding::HeightEncoding;
use crate::dem::formats::raw::{RawLayout, RawLayoutError};
use crate::dem::mosaic::Tiles;
use crate::dem::raster::Raster;
use crate::dem::read::{self, DemHints};
use crate::dem::voids;
use crate::dem::warp;
use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::words::HeightEncodingWord;
use crate::geom::crs::Crs;
use crate::scene::assets::Assets;
use crate::terrain::lattice::Lattice;

/// The raster as read and the lattice made of it.
pub struct LoadedGround {
    /// The raster as read; tiles joined, voids filled where the scene says so.
    pub source: Arc<Raster>,
    /// The heights in the scene's system, before earthworks.
    pub lattice: Lattice,
    /// The scene's system.
    pub crs: Crs,
    /// Notes for the user.
    pub notes: Vec<String>,
}

/// Reads the document's elevation files and brings them to a metric system.
///
/// # Errors
/// A file cannot be read, several are not tiles of one raster, or they cannot be brought to the scene's
/// system.
pub fn load(document: &Document, assets: &Assets) -> Result<LoadedGround, Diagnostic> {
    let dem = &document.terrain.dem;
    let mut notes = Vec::new();
    let mut source = joined(document, assets, &mut notes)?;
    if document.terrain.fill_voids {
        notes.push(voids::fill(&mut source).note());
    }
    let metric =
        warp::to_metric(&source, document.crs.as_ref()).map_err(|error| document.error(dem, error))?;
    let lattice = Lattice::from_raster(&metric).map_err(|error| document.error(dem, error))?;
    let crs = metric.crs.clone().or(document.crs.clone()).unwrap_or_else(Crs::local);
    Ok(LoadedGround { source: Arc::new(source), lattice, crs, notes })
}

/// The document's elevation files as one raster.
fn joined(document: &Document, assets: &Assets, notes: &mut Vec<String>) -> Result<Raster, Diagnostic> {
    let terrain = &document.terrain;
    let companions = |name: &str| assets.read(name).ok();
    let hints = DemHints {
        height_scale: terrain.height_scale,
        height_offset: Some(terrain.height_offset),
        height_encoding: terrain.height_encoding.map(|encoding| match encoding {
            HeightEncodingWord::TerrainRgb => HeightEncoding::TerrainRgb,
            HeightEncodingWord::Terrarium => HeightEncoding::Terrarium,
        }),
        raw: raw_layout(document)?,
        vertical_datum: terrain.vertical_datum.clone(),
        cell: terrain.cell,
        crs: terrain.crs.clone(),
        companions: &companions,
    };
    let (dem, mut tiles) = (&terrain.dem, Tiles::default());
    for name in dem.iter() {
        let bytes = assets.read(name).map_err(|error| document.error(dem, error))?;
        let tile = read::read(name, &bytes, &hints).map_err(|error| document.error(dem, error))?;
        tiles.push(name, tile).map_err(|error| document.error(dem, error))?;
    }
    let mosaic = tiles.join().map_err(|error| document.error(dem, error))?;
    if dem.len() > 1 {
        notes.push(mosaic.note());
    }
    Ok(mosaic.raster)
}

fn raw_layout(document: &Document) -> Result<Option<RawLayout>, Diagnostic> {
    let Some(stated) = &document.terrain.raw else { return Ok(None) };
    stated.parse().map(Some).map_err(|_: RawLayoutError| {
        let message = "this does not say how a RAW file is laid out";
        document.error(stated, message).with_help(RawLayoutError::REMEDY)
    })
}

//! Samples of the elevation that a scene does not hold, and the documents of the parts that are built of them.

use glam::DVec2;

use sandtable_base::limits::PICTURED_SAMPLES;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::stated::Stated;
use sandtable_geom::position::Position;
use sandtable_geom::rect::Rect;

use crate::assets::Assets;
use crate::world_frame::WorldFrame;

/// The share of the samples that pictures read whole that a ground of a picture has at the least, where it needs as many: with
/// a handful of nested grounds, all together have about as many.
const LEVEL_SHARE: u64 = 8;

/// Samples of a scene's elevation that its lattice does not have.
pub struct FinerElevation {
    /// The scene file.
    pub document: Document,
    /// Its files.
    pub assets: Assets,
    /// The side of the squares of samples that the lattice has means of.
    pub step: u32,
}

impl FinerElevation {
    /// The finer samples of a document of which means of `step` × `step` samples are held.
    pub fn new(document: &Document, assets: &Assets, step: u32) -> Self {
        Self { document: document.clone(), assets: assets.clone(), step }
    }
}

/// The samples that a ground of a picture has at the least, where it needs as many.
pub fn level_samples() -> u64 {
    (PICTURED_SAMPLES.get() / LEVEL_SHARE).max(1)
}

/// The document of the part of a scene in a rectangle of world space, without things that the outer scene draws or that
/// stand elsewhere.
///
/// # Errors
/// The rectangle has no place in the system of inline points.
pub fn part_document(frame: &WorldFrame<'_>, rect: &Rect) -> Result<Document, Diagnostic> {
    let document = frame.document;
    let dem = &document.terrain.dem;
    let Rect { min, max } = *rect;
    let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
    let stated: Result<Vec<Position>, _> = corners
        .iter()
        .map(|&corner| frame.crs.transform(&frame.points_crs, frame.origin + corner).map(Into::into))
        .collect();
    let mut part = document.clone();
    part.terrain.extent = Some(Stated::unstated(stated.map_err(|error| document.error(dem, error))?));
    part.models.retain(|table| {
        let at = table.at.as_ref().map(|at| frame.point(at, table.crs.as_ref()));
        at.is_none_or(|at| at.is_ok_and(|at| rect.contains(at)))
    });
    part.cameras.clear();
    part.flights.clear();
    part.labels.clear();
    part.symbols.clear();
    part.graphics.clear();
    part.viewsheds.clear();
    part.sights.clear();
    part.ranges.clear();
    Ok(part)
}

//! The ground of a document after all features that shape it: the sea, lakes, rivers, roads, pads, earthworks.
//!
//! Parts of a ground are shaped by the same passes as the whole, so that they are the same where they overlap.

use crate::areas;
use crate::assets::Assets;
use crate::bridges;
use crate::build_errors::BuildErrors;
use crate::builder::SceneBuilder;
use crate::buildings::{self, BuildingPlots};
use crate::earthworks;
use crate::fences::{self, FenceLine};
use crate::ground::{self, LoadedGround};
use crate::models;
use crate::planned_pictures::ElevationNeed;
use crate::roads::centerline::{self, Centerline};
use crate::roads::conform;
use crate::sources::Sources;
use crate::water::{coast, lakes, rivers};
use crate::world_frame::WorldFrame;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_earthworks::brush::Change;
use sandtable_earthworks::held_posts::HeldPosts;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::triangle_surface::SurfaceTriangle;

/// The ground of a part of a scene by all samples of its elevation, with what shapes it. `document` is that of the part.
///
/// # Errors
/// The first file that cannot be read or table that does not fit, at its place in the scene file.
pub(super) fn part_ground(document: &Document, assets: &Assets) -> Result<Lattice, Diagnostic> {
    let mut loaded = ground::load(document, assets, ElevationNeed::Nested { step: 1 })?;
    shape_loaded(document, assets, &mut loaded)?;
    Ok(loaded.lattice)
}

/// Shapes the ground as it was loaded, and returns the decks over it. Of the models, only those that have the ground leveled are
/// read.
pub(super) fn shape_loaded(
    document: &Document,
    assets: &Assets,
    loaded: &mut LoadedGround,
) -> Result<Vec<SurfaceTriangle>, Diagnostic> {
    let frame = WorldFrame::new(document, &loaded.crs, &loaded.stated_crs, loaded.lattice.map_extent());
    let sources = Sources::new(&frame, assets);
    let mut collected = SceneBuilder::new(loaded.findings.clone());
    shape(document, &sources, &mut loaded.lattice, &mut collected);
    collected.errors.finish().map_err(BuildErrors::into_first)?;
    models::level_pads(&sources, &mut loaded.lattice)?;
    sources.report_reading(&mut collected.findings);
    loaded.findings = collected.findings;
    Ok(collected.decks)
}

/// Features that shaped the ground and are not built yet.
pub(super) struct ShapedFeatures {
    pub roads: Vec<Centerline>,
    pub plots: BuildingPlots,
    pub lines: Vec<FenceLine>,
    pub held: HeldPosts,
    pub dug: Vec<Change>,
}

/// Shapes the ground for everything but models, and builds the decks over it. What an error keeps from that is left out of it,
/// with all that needs it.
pub(super) fn shape(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> ShapedFeatures {
    let extent = lattice.extent();
    let coasts = coast::lay(document, sources, lattice, collected);
    collected.errors.keep(coasts);
    let lakes = lakes::lay(document, sources, lattice, collected);
    if collected.errors.keep(lakes).is_some() {
        let rivers = rivers::lay(document, sources, lattice, collected);
        collected.errors.keep(rivers);
    }
    let held = HeldPosts::pinned(lattice);
    let areas = areas::lay(document, sources, &extent, collected);
    collected.errors.keep(areas);
    let roads = conforming_roads(document, sources, lattice, collected);
    let mut roads = collected.errors.keep(roads);
    let plots = buildings::lay_out(document, sources, lattice, collected);
    let plots = collected.errors.keep(plots).unwrap_or_default();
    let lines = fences::lay_out(document, sources, lattice, collected);
    let lines = collected.errors.keep(lines).unwrap_or_default();
    if let Some(roads) = &mut roads {
        let bridges = bridges::build(document, sources, lattice, roads, collected);
        collected.errors.keep(bridges);
    }
    let dug = earthworks::build(document, sources, lattice, &held, collected);
    let dug = collected.errors.keep(dug).unwrap_or_default();
    ShapedFeatures { roads: roads.unwrap_or_default(), plots, lines, held, dug }
}

/// The roads of a document, after the ground was made to follow them where they say so.
///
/// # Errors
/// A source cannot be had, or a road has no profile.
fn conforming_roads(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<Vec<Centerline>, Diagnostic> {
    let mut roads = centerline::collect(document, sources, &lattice.extent(), collected)?;
    conform::conform(document, lattice, &mut roads, collected)?;
    Ok(roads)
}

//! From a document and its assets to a scene, pass by pass.

use std::sync::{Arc, OnceLock};

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::geom::crs::Crs;
use crate::roam::layout::{DEFAULT_PATCH, PatchLayout};
use crate::scene::areas;
use crate::scene::assets::Assets;
use crate::scene::attributes;
use crate::scene::bridges;
use crate::scene::builder::SceneBuilder;
use crate::scene::buildings;
use crate::scene::drawn_ground::DrawnGround;
use crate::scene::fences;
use crate::scene::ground;
use crate::scene::models;
use crate::scene::roads::{centerline, conform, network};
use crate::scene::sources::Sources;
use crate::scene::style;
use crate::scene::views;
use crate::scene::water::{lakes, rivers};
use crate::scene::world_frame::WorldFrame;
use crate::scene::{Scene, Terrain};
use crate::terrain::lattice::Lattice;
use crate::terrain::query::deck::Deck;
use crate::terrain::query::service::HeightService;

/// Builds the scene that `document` describes. `step` is called with what is done next, as each pass begins.
///
/// # Errors
/// The first thing that cannot be had or does not fit, pointing at its place in the scene file.
pub fn build(document: &Document, assets: &Assets, step: &dyn Fn(&'static str)) -> Result<Scene, Diagnostic> {
    step("reading elevation");
    let loaded = ground::load(document, assets)?;
    let (crs, mut lattice) = (loaded.crs, loaded.lattice);
    let places = places(document, &crs, &lattice);

    step("laying features");
    let sources = Sources::new(&places, assets);
    let mut collected = SceneBuilder { notes: loaded.notes, ..SceneBuilder::default() };
    let extent = lattice.extent();
    lakes::lay(document, &sources, &mut lattice, &mut collected)?;
    rivers::lay(document, &sources, &mut lattice, &mut collected)?;
    areas::lay(document, &sources, &extent, &mut collected)?;
    let mut roads = centerline::collect(document, &sources, &extent, &mut collected)?;
    conform::conform(document, &mut lattice, &mut roads, &mut collected)?;
    let plots = buildings::lay_out(document, &sources, &mut lattice, &mut collected)?;
    let lines = fences::lay_out(document, &sources, &mut lattice, &mut collected)?;
    bridges::build(document, &sources, &lattice, places.exaggeration, &mut roads, &mut collected)?;
    network::lay(&roads, &extent, &mut collected);
    let finest = DrawnGround { lattice: &lattice, exaggeration: places.exaggeration };
    fences::set(&lines, finest, &mut collected);
    buildings::raise(document, &plots, finest, &mut collected);
    collected.resolve_overlaps();

    step("loading models");
    let (models, placements) =
        models::place(document, (&places, &sources, assets), &mut lattice, &mut collected)?;

    let defaulted: Vec<String> = attributes::notes(&collected.default_counts).collect();
    collected.notes.extend(defaulted);

    step("placing labels and cameras");
    let terrain = terrain(document, lattice)?;
    let labels = views::labels(document, &places, &terrain)?;
    let cameras = views::cameras(document, &places, &terrain)?;
    collected.notes.extend(views::buried(&cameras, &terrain));

    step("lighting terrain");
    let (low, high) = terrain.bounds();
    let lighting = style::lighting(document, (high - low).max_element());
    let ramp = style::ramp(document, &terrain.lattice)?;
    let map = style::ground_map(&terrain, lighting.to_sun, ramp, style::contours(document));

    let heights = HeightService::new(loaded.source, crs.clone(), Arc::clone(&terrain.lattice));
    let decks = Deck::new(&collected.decks).map_err(|error| document.error_at(0..0, error))?;
    let heights = if decks.facets().is_empty() { heights } else { heights.with_decks(Arc::new(decks)) };
    Ok(Scene {
        title: document.title.clone(),
        subtitle: document.subtitle.clone(),
        heights,
        terrain,
        map: Arc::new(map),
        lighting,
        ribbons: collected.ribbons,
        solids: collected.solids,
        uprights: collected.uprights,
        details: models.iter().map(|_| OnceLock::new()).collect(),
        models,
        placements,
        labels,
        cameras,
        furniture: document.furniture,
        features: collected.features,
        notes: collected.notes,
        report: collected.report,
        profiles: collected.profiles,
        crs,
        files: assets.files_read(),
    })
}

fn places<'a>(document: &'a Document, crs: &'a Crs, lattice: &Lattice) -> WorldFrame<'a> {
    WorldFrame {
        document,
        crs,
        points_crs: document.points_crs.as_ref().unwrap_or(crs).clone(),
        origin: lattice.origin(),
        exaggeration: document.terrain.vertical_exaggeration as f32,
    }
}

fn terrain(document: &Document, lattice: Lattice) -> Result<Terrain, Diagnostic> {
    let layout = PatchLayout::new(lattice.columns(), lattice.rows(), DEFAULT_PATCH).ok_or_else(|| {
        let size = format!("{}×{} posts", lattice.columns(), lattice.rows());
        document.error(&document.terrain.dem, format!("an elevation model of {size} is too large"))
    })?;
    let tolerance_px = document.terrain.tolerance_px as f32;
    Ok(Terrain::new(Arc::new(lattice), layout, document.terrain.vertical_exaggeration as f32, tolerance_px))
}

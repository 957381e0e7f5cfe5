//! Builds a scene from a document and its assets, pass by pass, in two stages.
//!
//! ```text
//!  elevation ─► sea, lakes, rivers, roads, pads, trenches, bridges ─► earthworks ─┬─► pads of models ─► SceneGround: heights
//!                                                                            └─► networks, fences, models, views ─► Scene
//! ```
//!
//! Neither stage computes what only a picture needs: see [`SceneModel::map`] and [`SceneModel::ground`].

use std::sync::{Arc, OnceLock};

use glam::DVec2;
use rayon::prelude::*;

use crate::analyses;
use crate::assets::Assets;
use crate::attributes;
use crate::build_errors::BuildErrors;
use crate::builder::SceneBuilder;
use crate::buildings;
use crate::climate::Climate;
use crate::exact_ground::ExactGround;
use crate::feature_labels;
use crate::fences;
use crate::finer_elevation::FinerElevation;
use crate::font;
use crate::graphics;
use crate::ground::{self, LoadedGround};
use crate::imagery;
use crate::labels;
use crate::military;
use crate::models;
use crate::overlays;
use crate::placed_sight;
use crate::planned_pictures::ElevationNeed;
use crate::read_ahead::SourcesAhead;
use crate::relief_strength;
use crate::roads::network;
use crate::scene_model::SceneModel;
use crate::shaped_ground::{ShapedFeatures, shape, shape_loaded};
use crate::sources::Sources;
use crate::spot_heights::spot_heights;
use crate::style::{self, RampSource, Surroundings};
use crate::sunlight::Sunlight;
use crate::views;
use crate::water::coast;
use crate::world_frame::WorldFrame;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::Footing;
use sandtable_geom::crs::Crs;
use sandtable_roam::layout::{DEFAULT_PATCH, PatchLayout};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::prominence::summits;
use sandtable_terrain::query::deck::Deck;
use sandtable_terrain::query::service::HeightService;
use sandtable_terrain::query::source_raster::SourceRaster;
use sandtable_terrain::triangle_surface::SurfaceTriangle;

/// The ground of a scene: all that height queries, profiles and lines of sight need.
pub struct SceneGround {
    /// Answers height queries in map coordinates.
    pub heights: HeightService,
    /// The system that the scene file or its elevation states in meters: that of positions unless another is named.
    pub stated_crs: Crs,
    /// A note where that is not the ground's, because its lengths are not true.
    pub scale_note: Option<String>,
    /// What reading its files left out or guessed, a sentence each.
    pub reading_notes: Vec<String>,
    /// The files it was made of, besides the scene file itself.
    pub files: Vec<std::path::PathBuf>,
}

impl SceneGround {
    /// The ground of a built scene.
    pub fn of(scene: &SceneModel) -> Self {
        let messages = |is_wanted: fn(FindingCode) -> bool| {
            let wanted = scene.findings.iter().filter(move |finding| is_wanted(finding.code));
            wanted.map(|finding| finding.message.clone())
        };
        Self {
            heights: scene.heights.clone(),
            stated_crs: scene.stated_crs.clone(),
            scale_note: messages(|code| code == FindingCode::LengthsNotTrue).next(),
            reading_notes: messages(FindingCode::is_of_reading).collect(),
            files: scene.files.clone(),
        }
    }
}

/// Builds the ground of the scene that `document` describes, with the decks over it. Of the models, only those that have
/// the ground leveled are read.
///
/// # Errors
/// The first file that cannot be read or table that does not fit, at its place in the scene file.
pub fn build_ground(document: &Document, assets: &Assets) -> Result<SceneGround, Diagnostic> {
    let mut loaded = ground::load(document, assets, ElevationNeed::All)?;
    let decks = shape_loaded(document, assets, &mut loaded)?;
    let LoadedGround { source, lattice, crs, stated_crs, scale_note, findings, .. } = loaded;
    let of_reading = findings.into_vec().into_iter().filter(|finding| finding.code.is_of_reading());
    let reading_notes = of_reading.map(|finding| finding.message).collect();
    let heights = height_service(document, source, crs, Arc::new(lattice), &decks)?;
    Ok(SceneGround { heights, stated_crs, scale_note, reading_notes, files: assets.files_read() })
}

/// Builds the scene that `document` describes, with all samples of its elevation that fit into the memory. `progress` is called
/// with the name of each pass as it begins.
///
/// # Errors
/// The files that cannot be read and the tables that do not fit, each at its place in the scene file; of tables that the
/// ground needs, those without which nothing more can be told.
pub fn build(
    document: &Document,
    assets: &Assets,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, BuildErrors> {
    build_with(document, assets, ElevationNeed::AllThatFit, progress)
}

/// [`build`] with as many samples of the elevation as are needed.
///
/// # Errors
/// As [`build`].
pub fn build_with(
    document: &Document,
    assets: &Assets,
    need: ElevationNeed<'_>,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, BuildErrors> {
    progress("reading elevation");
    // What pictures need fewer samples for is analyzed with all.
    let need = match need {
        ElevationNeed::Pictures(_) if !document.analyses.is_empty() => ElevationNeed::AllThatFit,
        need => need,
    };
    let mut ahead = SourcesAhead::default();
    let loaded = rayon::in_place_scope(|scope| {
        scope.spawn(|_| ahead = SourcesAhead::of(document, assets));
        ground::load(document, assets, need)
    })?;
    let (crs, stated_crs, mut lattice) = (loaded.crs, loaded.stated_crs, loaded.lattice);
    let frame = WorldFrame::new(document, &crs, &stated_crs, lattice.map_extent());

    progress("laying features");
    let sources = Sources::with(&frame, assets, ahead);
    let mut collected = SceneBuilder::new(loaded.findings);
    let shaped = shape(document, &sources, &mut lattice, &mut collected);
    // What is wrong so far keeps the scene from being built; what follows is done to tell what else is.
    let mut known_summits = None;
    if collected.errors.is_empty() {
        let build = || {
            network::lay(&shaped.roads, &lattice.extent(), &mut collected);
            fences::set(&shaped.lines, frame.scale.ground(&lattice), &mut collected);
            buildings::raise(document, &shaped.plots, frame.scale.ground(&lattice), &mut collected);
            collected.resolve_overlaps();
        };
        // Pads of models move ground yet.
        let is_final = document.models.iter().all(|model| *model.footing != Footing::Pad);
        let needs_summits = is_final && feature_labels::need_summits(document);
        ((), known_summits) = rayon::join(build, || needs_summits.then(|| summits(&lattice)));
    }

    progress("loading models");
    let placed = models::place(&sources, &mut lattice, &mut collected);
    let models = placed.library.into_models();
    for sentence in attributes::notes(&collected.default_counts) {
        collected.findings.add(FindingCode::DefaultTaken, 0..0, sentence);
    }
    collected.tag_notes.report(&mut collected.findings);

    graphics::lay(document, &sources, &lattice.extent(), &mut collected);
    let of_overlays = overlays::lay(&sources, &lattice, &mut collected);
    let exact = ExactGround::new(&frame, &lattice, assets, loaded.all_samples)?.with_summits(known_summits);
    let sight = placed_sight::lay(&exact, &mut collected);
    let placed_analyses = analyses::place(&exact, &mut collected);
    let vehicles = analyses::vehicles(document, &mut collected.errors);

    progress("placing labels and cameras");
    let layout = layout(document, &lattice)?;
    let mut labels = labels::labels(&sources, &exact, &mut collected);
    let most = document.style.spot_heights as usize;
    let spots = spot_heights(most, &labels, &collected.lakes, &exact);
    labels.extend(collected.errors.keep(spots).into_iter().flatten());
    exact.report(&mut collected.findings);
    drop(exact);
    let (scale, height_range_m, lattice) = (frame.scale, lattice.height_range(), Arc::new(lattice));
    let bounds = scale.ground(&lattice).bounds(height_range_m);
    let mut military = military::symbols(&sources, &lattice, &mut collected);
    military.extend(of_overlays);
    let cameras = views::cameras(&frame, &lattice, &mut collected.errors);
    let ramp = collected.errors.keep(RampSource::new(document));
    let imagery = collected.errors.keep(imagery::load(document, assets, &crs, &lattice));
    let sunlight = Sunlight::new(document, &crs, lattice.map_extent().center());
    let sunlight = collected.errors.keep(sunlight);
    let font = collected.errors.keep(font::load(document, assets));
    let sheet_day = collected.errors.keep(style::sheet_day(document));
    collected.errors.finish()?;
    let (Some(ramp), Some(imagery), Some(sunlight)) = (ramp, imagery, sunlight) else {
        unreachable!("each error was kept")
    };
    sources.report_reading(&mut collected.findings);
    let reaches = sources.reaches();
    reaches
        .iter()
        .filter_map(|reach| reach.error(&frame, &lattice.extent()))
        .for_each(|error| collected.findings.push(error));
    let overlaps = reaches.iter().map(|reach| reach.overlap(&lattice.extent())).collect();
    views::find_buried(document, &cameras, scale.ground(&lattice), &mut collected.findings);
    let ShapedFeatures { roads, plots, lines, held, dug } = shaped;
    let barriers = fences::barriers(&lines);
    let read = (sources.into_read(), plots, lines);
    let (heights, ((), ())) = rayon::join(
        || height_service(document, loaded.source, crs.clone(), Arc::clone(&lattice), &collected.decks),
        || rayon::join(|| drop(read), || roads.into_par_iter().for_each(drop)),
    );
    let heights = heights?;
    let surroundings = Surroundings::new(document);
    let sunlight = match surroundings.land_cover {
        true => sunlight.over(relief_strength::fall(&lattice)),
        false => sunlight,
    };
    if let Some(missing) = style::missing_place_note(document, &crs, lattice.map_extent().center()) {
        let span = document.terrain.dem.span().unwrap_or_default();
        collected.findings.add(FindingCode::NoPlaceOnEarth, span, missing);
    }
    let mut scene = SceneModel {
        title: document.title.clone(),
        subtitle: document.phase_title().map(str::to_owned).or_else(|| document.subtitle.clone()),
        phase: document.phase.clone(),
        heights,
        ramp,
        climate: Climate::at(place_deg(&crs, lattice.map_extent().center())),
        land_cover: surroundings.land_cover,
        // Plain lines and areas of an overlay leave the relief as strong as roads do.
        is_lightly_shaded: surroundings.is_lightly_shaded
            || !military.is_empty()
            || collected.graphics.iter().any(|graphic| graphic.style.is_none()),
        imagery: imagery.map(Arc::new),
        contours: style::contours(document, height_range_m),
        rock: style::rock(document),
        preset: document.style.preset,
        grid: style::grid(document),
        sunlight,
        texture: document.style.light.texture as f32,
        haze_m: surroundings.haze_m,
        table: surroundings.table,
        maps: Default::default(),
        water_rules: coast::water_rules(&document.terrain),
        water: OnceLock::new(),
        has_voids: OnceLock::new(),
        lattice,
        finer: loaded.nests_step.map(|step| FinerElevation::new(document, assets, step)),
        height_range_m,
        scale,
        bounds,
        tolerance_px: *document.terrain.tolerance_px as f32,
        wireframe: document.style.wireframe,
        layout,
        ground: OnceLock::new(),
        held: Arc::new(held),
        dug,
        ribbons: collected.ribbons,
        symbols: collected.symbols,
        graphics: collected.graphics,
        sight,
        barriers,
        culverts: collected.culverts,
        vehicles,
        analyses: Vec::new(),
        solids: collected.solids,
        pictures: collected.pictures,
        uprights: collected.uprights,
        details: models.iter().map(|_| OnceLock::new()).collect(),
        models,
        placements: placed.placements,
        labels,
        military,
        cameras,
        font: font.flatten(),
        furniture: document.furniture.clone(),
        sheet_day: sheet_day.flatten(),
        features: collected.features,
        findings: collected.findings.into_vec(),
        overlaps,
        report: collected.report,
        profiles: collected.profiles,
        bridge_profiles: collected.bridge_profiles,
        crs,
        stated_crs,
        files: Vec::new(),
    };
    if !placed_analyses.is_empty() {
        analyses::analyze(&mut scene, placed_analyses, document, assets, progress)?;
    }
    scene.files = assets.files_read();
    Ok(scene)
}

fn height_service(
    document: &Document,
    source: Arc<SourceRaster>,
    crs: Crs,
    lattice: Arc<Lattice>,
    decks: &[SurfaceTriangle],
) -> Result<HeightService, Diagnostic> {
    let heights = HeightService::new(source, crs, lattice);
    let decks = Deck::new(decks).map_err(|error| document.error_at(0..0, error))?;
    Ok(if decks.facets().is_empty() { heights } else { heights.with_decks(Arc::new(decks)) })
}

/// The longitude and latitude of a place in map coordinates; `None` where the system has no place on Earth.
fn place_deg(crs: &Crs, at: DVec2) -> Option<DVec2> {
    crs.transform(&Crs::wgs84(), at).ok().filter(|place| place.is_finite())
}

fn layout(document: &Document, lattice: &Lattice) -> Result<PatchLayout, Diagnostic> {
    PatchLayout::new(lattice.columns(), lattice.rows(), DEFAULT_PATCH).ok_or_else(|| {
        let size = format!("{}×{} posts", lattice.columns(), lattice.rows());
        document.error(&document.terrain.dem, format!("an elevation model of {size} is too large"))
    })
}

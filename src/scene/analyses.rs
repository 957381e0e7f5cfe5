//! Analyses as layers of the scene: the arguments that the document states, and what the land then gives.
//!
//! Arguments are checked with all else that the document places; the analyses run once the scene stands, on the land that the
//! command `analyze` has, by the same functions.

use std::path::Path;
use std::sync::Arc;

use glam::DVec2;

use crate::analysis_letters::add_letters;
use crate::assets::Assets;
use crate::build::{build, build_ground};
use crate::build_errors::{BuildErrorSink, BuildErrors};
use crate::builder::SceneBuilder;
use crate::exact_ground::ExactGround;
use crate::feature::{FeatureKind, SceneFeature};
use crate::feature_origin::FeatureOrigin;
use crate::land::land_of_drawn;
use crate::scene_file::{OpenSceneError, is_scene_file, open_phase_ground, open_scene_ground};
use crate::scene_findings::SceneFindings;
use crate::scene_model::SceneModel;
use sandtable_analysis::arguments::{AnalysisArguments, ArgumentValue};
use sandtable_analysis::error::AnalysisError;
use sandtable_analysis::extent::{LandExtent, PlacedOutcome, run_within};
use sandtable_analysis::land::Land;
use sandtable_analysis::movement::vehicle::Vehicle;
use sandtable_analysis::outcome::{Outcome, OutcomeFeature, OutcomeRaster};
use sandtable_base::message::choice::Choice as _;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_catalog::parameter::{PHASE_PREFIX, ParameterForm, SOURCE_GROUND};
use sandtable_description::analyses::{AnalysisTable, DescribedValue, VehicleTable};
use sandtable_description::color::Color;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::parse::parse;
use sandtable_description::stated::Stated;
use sandtable_description::words::AnalysisDraw;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_geom::crs::CrsError;
use sandtable_geom::position::Position;
use sandtable_raster::answer::Answer;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::query::service::HeightService;
use sandtable_terrain::query::{Interpolation, Surface};
use sandtable_terrain::stop_flag::StopFlag;

/// An analysis of the scene's land.
pub struct SceneAnalysis {
    /// Its name in the legend.
    pub name: String,
    /// What it is.
    pub kind: &'static AnalysisKind,
    /// Its number among the scene's, from 0.
    pub number: usize,
    /// What pictures show of it.
    pub draw: AnalysisDraw,
    /// The color of its lines, where one is stated.
    pub color: Option<Srgba>,
    /// The feature that it is.
    pub feature: FeatureId,
    /// The ground on whose posts the values of its raster are.
    pub ground: Arc<Lattice>,
    /// What it gives; a raster has classes, see [`Outcome::with_classes`]. Where other analyses of the scene number their marks
    /// alike, a letter stands before the numbers.
    pub outcome: Outcome,
}

impl SceneAnalysis {
    /// The raster whose classes pictures show by hatching; `None` where they show none.
    pub fn hatched_raster(&self) -> Option<&OutcomeRaster> {
        let shows = matches!(self.draw, AnalysisDraw::All | AnalysisDraw::Hatching);
        self.outcome.raster.as_ref().filter(|_| shows)
    }

    /// The raster whose classes pictures show by tints; `None` where they show none.
    pub fn tinted_raster(&self) -> Option<&OutcomeRaster> {
        let shows = matches!(self.draw, AnalysisDraw::All | AnalysisDraw::Tints);
        self.outcome.raster.as_ref().filter(|_| shows)
    }

    /// The features that pictures show.
    pub fn shown_features(&self) -> &[OutcomeFeature] {
        if self.draw == AnalysisDraw::Nothing { &[] } else { &self.outcome.features }
    }
}

/// An analysis whose arguments have their places.
pub(super) struct PlacedAnalysis {
    arguments: AnalysisArguments,
    extent: Option<LandExtent>,
    feature: FeatureId,
    name: String,
    /// Its number among the document's.
    table: usize,
}

impl SceneModel {
    /// Adds an analysis that was made on `ground`, in map coordinates of the scene.
    pub fn add_analysis(
        &mut self,
        (kind, name): (&'static AnalysisKind, String),
        ground: Arc<Lattice>,
        outcome: Outcome,
    ) {
        let origin = FeatureOrigin::default();
        let feature = FeatureId::of_index(self.features.len());
        self.features.push(SceneFeature { kind: FeatureKind::Analysis, name: name.clone(), origin });
        let number = self.analyses.len();
        self.analyses.push(SceneAnalysis {
            name,
            kind,
            number,
            draw: AnalysisDraw::All,
            color: None,
            feature,
            ground,
            outcome: outcome.with_classes(),
        });
    }
}

/// Places the arguments of the document's analyses. `collected` keeps an error for each position without ground.
pub(super) fn place(exact: &ExactGround<'_>, collected: &mut SceneBuilder) -> Vec<PlacedAnalysis> {
    let tables = exact.frame.document.analyses.iter().enumerate();
    tables.filter_map(|(number, table)| placed(number, table, exact, collected)).collect()
}

fn placed(
    number: usize,
    table: &AnalysisTable,
    exact: &ExactGround<'_>,
    collected: &mut SceneBuilder,
) -> Option<PlacedAnalysis> {
    let kind = *table.kind;
    let (mut arguments, mut extent) = (Some(AnalysisArguments::new(kind)), None);
    for argument in &table.arguments.0 {
        let value = match &*argument.value {
            DescribedValue::Number(number) => Some(ArgumentValue::Number(*number)),
            DescribedValue::Numbers(numbers) => Some(ArgumentValue::Numbers(numbers.clone())),
            DescribedValue::Word(word) => Some(ArgumentValue::Word(word.clone())),
            DescribedValue::Places(places) => {
                // A corner of an area may lie where there is no ground.
                let needs_ground =
                    !matches!(argument.parameter.form, ParameterForm::Area | ParameterForm::Extent);
                let placed = places
                    .iter()
                    .map(|at| collected.errors.keep(map_position(exact, table, at, needs_ground)));
                let placed: Vec<Option<DVec2>> = placed.collect();
                placed.into_iter().collect::<Option<Vec<DVec2>>>().map(ArgumentValue::Points)
            }
        };
        if let (ParameterForm::Extent, Some(ArgumentValue::Points(points))) =
            (argument.parameter.form, &value)
        {
            extent = Some(match points.len() {
                2 => LandExtent::rectangle(points.iter().copied()),
                _ => LandExtent::area(points.clone()),
            });
            continue;
        }
        arguments = arguments.zip(value).map(|(all, value)| all.with(argument.parameter.name, value));
    }
    let name = table.name.clone().unwrap_or_else(|| kind.title.to_owned());
    let origin = FeatureOrigin::stated(table.kind.span());
    let feature = collected.add(FeatureKind::Analysis, name.clone(), origin);
    Some(PlacedAnalysis { arguments: arguments?, extent, feature, name, table: number })
}

/// The map coordinates of a stated position.
fn map_position(
    exact: &ExactGround<'_>,
    table: &AnalysisTable,
    at: &Stated<Position>,
    needs_ground: bool,
) -> Result<DVec2, Diagnostic> {
    let frame = exact.frame;
    let world = frame.point(at, table.crs.as_ref())?;
    if needs_ground {
        frame.on_ground(exact.lattice, at, world)?;
    }
    Ok(world + frame.origin)
}

/// The vehicles of the document. `errors` keeps an error for each whose limits are out of order.
pub(super) fn vehicles(document: &Document, errors: &mut BuildErrorSink) -> Vec<Vehicle> {
    let checked = |(name, table): &(Stated<String>, VehicleTable)| {
        let vehicle = vehicle(name, table);
        let fault = |fault| document.error(name, format!("[vehicle.{}]: {fault}", name.as_str()));
        errors.keep(vehicle.check().map_err(fault)).map(|()| vehicle)
    };
    document.vehicles.iter().filter_map(checked).collect()
}

fn vehicle(name: &str, table: &VehicleTable) -> Vehicle {
    let like = table.like.word();
    let built_in = Vehicle::built_in(like).unwrap_or_else(|| panic!("{like} is built in"));
    let mut road_speed_kmh = built_in.road_speed_kmh;
    let stated = table.road_speed_kmh.iter().flat_map(|speeds| speeds.iter());
    road_speed_kmh.iter_mut().zip(stated).for_each(|(speed, stated)| *speed = *stated);
    Vehicle {
        name: name.to_owned(),
        slope_up_percent: table.slope_up_percent.unwrap_or(built_in.slope_up_percent),
        slope_down_percent: table.slope_down_percent.unwrap_or(built_in.slope_down_percent),
        slope_across_percent: table.slope_across_percent.unwrap_or(built_in.slope_across_percent),
        speed_kmh: table.speed_kmh.unwrap_or(built_in.speed_kmh),
        road_speed_kmh,
        built_up_kmh: table.built_up_kmh.unwrap_or(built_in.built_up_kmh),
        ford_m: table.ford_m.unwrap_or(built_in.ford_m),
        gap_m: table.gap_m.unwrap_or(built_in.gap_m),
        step_m: table.step_m.unwrap_or(built_in.step_m),
        width_m: table.width_m.unwrap_or(built_in.width_m),
        stem_m: table.stem_m.unwrap_or(built_in.stem_m),
        mass_t: table.mass_t.unwrap_or(built_in.mass_t),
        ..built_in
    }
}

/// The scene with heights true to scale, without its analyses.
fn true_to_scale(
    document: &Document,
    assets: &Assets,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, BuildErrors> {
    let mut document = document.clone();
    document.terrain.vertical_exaggeration = 1.0;
    document.analyses.clear();
    build(&document, assets, progress)
}

/// Runs analyses on the land of a scene and notes what they do not know among its findings.
///
/// # Errors
/// Those that have no outcome, each at the key that is at fault.
pub(super) fn analyze(
    scene: &mut SceneModel,
    placed: Vec<PlacedAnalysis>,
    document: &Document,
    assets: &Assets,
    progress: &dyn Fn(&'static str),
) -> Result<(), BuildErrors> {
    let (mut errors, mut findings) = (BuildErrorSink::new(&document.source), SceneFindings::new(document));
    let mut land: Option<Land> = None;
    let mut layers: &[_] = &[];
    let mut analyses = Vec::with_capacity(placed.len());
    for PlacedAnalysis { arguments, extent, feature, name, table } in placed {
        let (kind, table) = (arguments.kind(), &document.analyses[table]);
        progress(kind.title);
        let of_kind = match land.take().filter(|_| layers == kind.layers) {
            Some(land) => land,
            None => land_of_drawn(scene, kind.layers, || true_to_scale(document, assets, progress))?,
        };
        let compared =
            |land: &Land| other_ground(table, land, scene, assets, document).map_err(AnalysisFault::Ground);
        let made = run_within(&of_kind, &arguments, extent.as_ref(), compared, &StopFlag::default());
        layers = kind.layers;
        land = Some(of_kind);
        let made = made.map_err(|fault| match fault {
            AnalysisFault::Ground(error) => error,
            AnalysisFault::Analysis(error) => failed(document, table, error),
        });
        let Some(PlacedOutcome { ground, outcome }) = errors.keep(made) else { continue };
        for note in &outcome.notes {
            let span = table.kind.span().unwrap_or_default();
            findings.add(FindingCode::AnalysisLimited, span, format!("{name}: {note}"));
        }
        analyses.push(SceneAnalysis {
            name,
            kind,
            number: analyses.len(),
            draw: table.draw,
            color: table.color.map(|Color(color)| Srgba(color)),
            feature,
            ground,
            outcome: outcome.with_classes(),
        });
    }
    errors.finish()?;
    add_letters(&mut analyses);
    scene.findings.extend(findings.into_vec());
    scene.analyses = analyses;
    Ok(())
}

/// Why an analysis has no outcome.
enum AnalysisFault {
    /// The ground to compare with cannot be had.
    Ground(Diagnostic),
    Analysis(AnalysisError),
}

impl From<AnalysisError> for AnalysisFault {
    fn from(error: AnalysisError) -> Self {
        Self::Analysis(error)
    }
}

/// The error of an analysis at the argument that is at fault, or else at its kind.
fn failed(document: &Document, table: &AnalysisTable, error: AnalysisError) -> Diagnostic {
    match error.key().and_then(|key| table.arguments.get(key)) {
        Some(argument) => document.error(&argument.value, error),
        None => document.error(&table.kind, error),
    }
}

/// The ground that an analysis compares with, at the posts of the land; `None` for one that states none.
fn other_ground(
    table: &AnalysisTable,
    land: &Land,
    scene: &SceneModel,
    assets: &Assets,
    document: &Document,
) -> Result<Option<Arc<Lattice>>, Diagnostic> {
    let stated = table.arguments.0.iter().find(|argument| argument.parameter.form == ParameterForm::Ground);
    let Some(stated) = stated else { return Ok(None) };
    let DescribedValue::Word(file) = &*stated.value else { return Ok(None) };
    let of_file;
    let (heights, surface) = match file.as_str() {
        SOURCE_GROUND => (&scene.heights, Surface::Source),
        _ => {
            let opened = heights_of(file, document, assets);
            of_file = opened.map_err(|error| document.error(&stated.value, error))?;
            (&of_file, Surface::Ground)
        }
    };
    let lattice = sampled(heights, surface, land).ok_or_else(|| {
        let message = format!("{file} has no ground at the posts of the scene");
        document.error(&stated.value, message)
    })?;
    Ok(Some(lattice))
}

/// The heights of an elevation file, of the ground of another scene file, or of the scene's own in another phase.
fn heights_of(file: &str, document: &Document, assets: &Assets) -> Result<HeightService, OpenSceneError> {
    if let Some(phase) = file.strip_prefix(PHASE_PREFIX) {
        let path = Path::new(document.source.name());
        return Ok(open_phase_ground(path, assets.allowed(), phase)?.heights);
    }
    if is_scene_file(Path::new(file)) {
        return Ok(open_scene_ground(&assets.resolve(file)?, &[])?.heights);
    }
    let quoted = serde_json::Value::from(file);
    let other = parse(file, &format!("[terrain]\ndem = {quoted}\n"))?;
    Ok(build_ground(&other, assets)?.heights)
}

/// Another ground at the posts of `ground`, from a function that gives heights of its `surface` at map positions; `None` where
/// it has none there.
///
/// # Errors
/// Those of the function.
pub fn ground_at_posts<E>(
    ground: &Lattice,
    surface: Surface,
    mut heights: impl FnMut(Interpolation, &[DVec2]) -> Result<Vec<Answer>, E>,
) -> Result<Option<Arc<Lattice>>, E> {
    let (columns, rows) = (ground.columns(), ground.rows());
    let interpolation = interpolation_between(surface, ground);
    let mut samples = Vec::with_capacity(columns as usize * rows as usize);
    for row in 0..rows {
        let at: Vec<DVec2> = (0..columns).map(|column| ground.map_position(Post { column, row })).collect();
        let answers = heights(interpolation, &at)?;
        samples
            .extend(answers.iter().map(|answer| answer.height_m().map_or(f32::NAN, |height| height as f32)));
    }
    if samples.iter().all(|sample| sample.is_nan()) {
        return Ok(None);
    }
    let frame = (ground.origin(), ground.cell());
    Ok(Lattice::part(frame, ground.first(), columns, samples).map(Arc::new).ok())
}

/// How heights of a surface are interpolated at the posts of `ground`, so that what earthworks leave as it was is the same. Posts
/// that a scene inserts between measured ones for its features lie on the triangles of these.
fn interpolation_between(surface: Surface, ground: &Lattice) -> Interpolation {
    match surface {
        Surface::Source if ground.doublings() > 0 => Interpolation::Planar,
        _ => Interpolation::default(),
    }
}

/// Heights at the posts of the land; `None` where there are none.
fn sampled(heights: &HeightService, surface: Surface, land: &Land) -> Option<Arc<Lattice>> {
    let snapshot = heights.snapshot();
    let answers = |interpolation, at: &[DVec2]| -> Result<Vec<Answer>, CrsError> {
        let at = at.iter().map(|&at| land.crs.transform(snapshot.crs(), at));
        let at: Vec<DVec2> = at.collect::<Result<_, _>>()?;
        let mut answers = vec![Answer::NoData; at.len()];
        snapshot.heights(surface, interpolation, &at, &mut answers);
        Ok(answers)
    };
    ground_at_posts(&land.ground, surface, answers).ok().flatten()
}

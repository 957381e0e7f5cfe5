//! Models scattered over areas: woods, scrub, boulders.
//!
//! A [`pattern`] covers the whole map. A point of it gets a model where it lies in the area ([`bands`]), on ground of the
//! stated slopes and elevations, and clear of other features ([`taken`]). Each point is decided alone, so that no model
//! depends on another, and rows of squares are filled in parallel.

pub mod bands;
pub mod chance;
pub mod pattern;
pub mod taken;

use std::f64::consts::TAU;

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use crate::attributes::Attributes;
use crate::builder::SceneBuilder;
use crate::crossed_shapes::CrossedShapes;
use crate::feature::{FeatureKind, described};
use crate::feature_origin::FeatureOrigin;
use crate::models::library::Library;
use crate::models::placed_models::{PlacedModels, within};
use crate::placed_model::{GroundFit, Placement};
use crate::placement::outline;
use crate::report::ScatterRow;
use crate::scatter::bands::Bands;
use crate::scatter::chance::{Chance, seed_of};
use crate::scatter::pattern::{PatternPoint, PointPattern};
use crate::scatter::taken::Taken;
use crate::sources::{Sourced, Sources};
use crate::world_frame::WorldFrame;
use sandtable_base::limits::SCATTER_SQUARES;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::ScatterTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::Clamp;
use sandtable_draw::list::FeatureId;
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::VertexId;
use sandtable_model::built_in;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::gradient::{Gradient, GradientSurface, ground_gradient};
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_vector::feature::Polygon;

/// The default spacing, in parts of the side of a model's square: a wood, not an orchard.
const SPACING_PART: f64 = 0.5;
/// The clearance of a model from other features, in parts of its reach: boughs may hang over a road.
const CLEAR_PART: f64 = 0.5;
/// The share of places on obstacles, or off the ground, from which on the areas are most likely wrong: a wood of narrow
/// strips between roads loses half of them.
const MOST_BLOCKED: f64 = 0.75;
/// Of fewer places, the share says little.
const LEAST_PLACES: usize = 20;
/// Rows of squares filled in parallel before the models are counted.
const ROWS_AT_ONCE: usize = 256;

/// Adds the document's scattered models to the placements.
///
/// # Errors
/// A source or a model file cannot be read, or there are more models or areas than can be placed.
pub fn strew(
    sources: &Sources<'_>,
    lattice: &Lattice,
    placed: &mut PlacedModels<'_>,
    collected: &mut SceneBuilder,
) -> Result<(), Diagnostic> {
    let (frame, document) = (sources.frame, sources.frame.document);
    if document.scatters.is_empty() {
        return Ok(());
    }
    let taken = taken_by(placed, collected);
    let mut squares = 0;
    for table in &document.scatters {
        let species = Species::new(table, &mut placed.library, collected)?;
        let feature = collected.add(
            FeatureKind::Scattered,
            table.name.clone().unwrap_or_default(),
            FeatureOrigin::stated(Some(table.source.span())),
        );
        let library = &placed.library;
        let ground =
            ScatterGround { table, frame, lattice, taken: &taken, library, species: &species, feature };
        let (mut stood, mut counts, mut areas) = (Vec::new(), ScatterCounts::default(), 0);
        let mut crossed = CrossedShapes::default();
        for Sourced { attributes, shape, crossings } in sources.polygons(&table.source)? {
            crossed.add_polygon(&shape, crossings, || table.name.clone().unwrap_or_default());
            let pattern = pattern(table, &attributes, species.seed, collected);
            if pattern.is_crowded() {
                counts.crowded += 1;
            }
            let bands = bands(document, table, (&shape, &pattern), (lattice, &mut squares))?;
            for rows in bands.rows().collect::<Vec<_>>().chunks(ROWS_AT_ONCE) {
                let done: Vec<_> = rows.par_iter().map(|&row| ground.row(&bands, &pattern, row)).collect();
                for (standing, missing) in done {
                    stood.extend(standing);
                    counts.add(missing);
                }
                within(document, &table.source, placed.placements.len() + stood.len())?;
            }
            areas += 1;
        }
        let outcome = "models stand in what an odd number of its turns runs around";
        crossed.report(("scatter", outcome), table.source.span(), frame, &mut collected.findings);
        // Areas that overlap give the same points.
        stood.sort_by(|a, b| a.at.y.total_cmp(&b.at.y).then(a.at.x.total_cmp(&b.at.x)));
        stood.dedup_by(|a, b| a.at == b.at);
        tell(table, (stood.len(), areas, counts), collected);
        placed.placements.append(&mut stood);
    }
    Ok(())
}

struct Species {
    /// The forms of each model that the table names; never empty.
    models: Vec<Vec<usize>>,
    seed: u64,
}

impl Species {
    fn new(
        table: &ScatterTable,
        library: &mut Library<'_>,
        collected: &mut SceneBuilder,
    ) -> Result<Self, Diagnostic> {
        let mut models = Vec::new();
        for name in table.models.iter() {
            let forms = built_in::forms(name).into_iter();
            let form = |name| library.get(name, table.models.span(), collected);
            models.push(forms.map(form).collect::<Result<Vec<usize>, Diagnostic>>()?);
        }
        // Tables of different models get different patterns, so that theirs do not coincide.
        let seed = seed_of(table.seed, table.models.iter().map(String::as_str));
        Ok(Self { models, seed })
    }
}

/// The points without a model by reason, and the areas whose spacing lowers their density.
#[derive(Clone, Copy, Debug, Default)]
struct ScatterCounts {
    crowded: usize,
    slope: usize,
    elevation: usize,
    taken: usize,
    off: usize,
}

impl ScatterCounts {
    fn add(&mut self, other: Self) {
        self.crowded += other.crowded;
        self.slope += other.slope;
        self.elevation += other.elevation;
        self.taken += other.taken;
        self.off += other.off;
    }
}

impl ScatterCounts {
    /// The code, the message and the remedy where no model stands, or obstacles take most of the places.
    fn finding(&self, models: usize) -> Option<(FindingCode, String, &'static str)> {
        let Self { slope, elevation, taken, off, .. } = *self;
        let places = models + slope + elevation + taken + off;
        if models == 0 && places == 0 {
            let message =
                "places no model: its areas are too small for one at this `density`, or lie off the model";
            let help = "raise `density`, which counts models a hectare, or name larger areas";
            return Some((FindingCode::ScatterEmpty, message.to_owned(), help));
        }
        if models == 0 {
            let message = format!(
                "places no model: of {places} places {taken} lie on roads, water, buildings or models, {slope} on ground beyond \
                 `slope`, {elevation} beyond `elevation` and {off} off the ground"
            );
            let help = "widen `slope` or `elevation`, or name areas with free ground";
            return Some((FindingCode::ScatterEmpty, message, help));
        }
        let (blocked, off_share) = (taken as f64 / places as f64, off as f64 / places as f64);
        if places < LEAST_PLACES || blocked.max(off_share) < MOST_BLOCKED {
            return None;
        }
        let (share, place) = if blocked >= off_share {
            (blocked, "on roads, water, buildings or models")
        } else {
            (off_share, "off the ground")
        };
        let message = format!("leaves {:.0} % of its {places} places free, which lie {place}", share * 100.0);
        Some((
            FindingCode::ScatterBlocked,
            message,
            "check that its areas, and what lies in them, are where they should be",
        ))
    }
}

fn pattern(
    table: &ScatterTable,
    attributes: &Attributes,
    seed: u64,
    collected: &mut SceneBuilder,
) -> PointPattern {
    let density = attributes.number(&table.density, &mut collected.default_counts) / 1e4;
    let spacing_m = attributes.value(table.spacing.as_ref());
    PointPattern::new(seed, density, spacing_m.unwrap_or(SPACING_PART / density.sqrt()))
}

/// An area in bands, its squares counted.
fn bands(
    document: &Document,
    table: &ScatterTable,
    (area, pattern): (&Polygon, &PointPattern),
    (lattice, squares): (&Lattice, &mut usize),
) -> Result<Bands, Diagnostic> {
    let to_map = |ring: &Vec<DVec2>| ring.iter().map(|at| at + lattice.origin()).collect::<Vec<_>>();
    let rings: Vec<Vec<DVec2>> = area.rings().map(to_map).collect();
    let extent = lattice.extent();
    let extent = Rect { min: extent.min + lattice.origin(), max: extent.max + lattice.origin() };
    let bands =
        Bands::new(rings.iter().map(Vec::as_slice), pattern.side_m(), &extent, SCATTER_SQUARES.count());
    let bands = bands.filter(|bands| {
        let wide = bands.rows().map(|row| {
            let columns = bands.columns(row);
            usize::try_from(columns.end() - columns.start() + 1).unwrap_or(0)
        });
        *squares += wide.sum::<usize>();
        *squares <= SCATTER_SQUARES.count()
    });
    bands.ok_or_else(|| {
        let place = table.density.span().unwrap_or(table.source.span());
        let message = format!("so dense a pattern has more than {SCATTER_SQUARES} places in these areas");
        document.error_at(place, message).with_help(format!(
            "`density` is how many stand on a hectare, 100 m by 100 m; lower it, or {SCATTER_SQUARES:#}"
        ))
    })
}

struct ScatterGround<'a> {
    table: &'a ScatterTable,
    frame: &'a WorldFrame<'a>,
    lattice: &'a Lattice,
    taken: &'a Taken,
    library: &'a Library<'a>,
    species: &'a Species,
    feature: FeatureId,
}

impl ScatterGround<'_> {
    /// The models in a row of squares, and the points without one.
    fn row(&self, bands: &Bands, pattern: &PointPattern, row: i64) -> (Vec<Placement>, ScatterCounts) {
        let (mut standing, mut counts) = (Vec::new(), ScatterCounts::default());
        for column in bands.columns(row) {
            for place in pattern.places((column, row)).filter(|place| bands.contains(row, place.at)) {
                standing.extend(self.stand(&place, &mut counts));
            }
        }
        (standing, counts)
    }

    /// The model at a point, or the reason why there is none.
    fn stand(&self, place: &PatternPoint, counts: &mut ScatterCounts) -> Option<Placement> {
        let Some((height_m, gradient)) = self.ground_at(place.at) else {
            counts.off += 1;
            return None;
        };
        if self.table.elevation.is_some_and(|range| !holds(range, height_m)) {
            counts.elevation += 1;
            return None;
        }
        if !holds(self.table.slope, gradient.slope_deg()) {
            counts.slope += 1;
            return None;
        }
        let placement = self.placement(place, gradient);
        let clear_m = f64::from(self.library.reach(placement.model) * placement.scale) * CLEAR_PART;
        if !self.taken.is_free(place.at - self.lattice.origin(), clear_m) {
            counts.taken += 1;
            return None;
        }
        Some(placement)
    }

    fn ground_at(&self, at: DVec2) -> Option<(f64, Gradient)> {
        let height_m = ground_height(self.lattice, Interpolation::Planar, at).height_m()?;
        Some((height_m, ground_gradient(self.lattice, GradientSurface::Planar, at).ok()?))
    }

    /// A model at a point, its kind, size, heading and form drawn from the point's random number. It sinks into a slope by its
    /// foot's width, so that its downhill side does not float.
    fn placement(&self, place: &PatternPoint, gradient: Gradient) -> Placement {
        let mut chance = Chance::from_number(place.fate);
        let forms = &self.species.models[chance.below(self.species.models.len())];
        let [from, to] = self.table.scale;
        let scale = (from + (to - from) * chance.part()) as f32;
        let heading_rad = (chance.part() * TAU) as f32;
        let model = forms[chance.below(forms.len())];
        let rise = self.frame.scale.world_z(gradient.0.length() as f32);
        let standing = GroundFit {
            sink_m: rise * self.library.footprint(model).radius() * scale,
            ..GroundFit::default()
        };
        let clamp = self.library.clamp(model, Clamp::Ground);
        let at = (place.at - self.lattice.origin()).as_vec2();
        Placement { model, at, clamp, height: 0.0, heading_rad, scale, standing, feature: self.feature }
    }
}

fn holds([from, to]: [f64; 2], value: f64) -> bool {
    (from..=to).contains(&value)
}

/// The ground under roads, water, buildings and the models so far.
fn taken_by(placed: &PlacedModels<'_>, collected: &SceneBuilder) -> Taken {
    let mut taken = Taken::default();
    let kind = |id: FeatureId| collected.feature(id).map(|feature| feature.kind);
    for ribbon in &collected.ribbons {
        if !matches!(kind(ribbon.feature), Some(FeatureKind::Area | FeatureKind::Fence)) {
            ribbon.plan.corners().for_each(|triangle| taken.add(triangle.map(|corner| corner.at)));
        }
    }
    for solid in &collected.solids {
        if matches!(kind(solid.feature), Some(FeatureKind::Building | FeatureKind::Bridge)) {
            let at =
                |id: VertexId| Vec3::from(solid.mesh.vertices[id.index()].position).truncate().as_dvec2();
            // The upper side of a closed solid covers its plan.
            solid.mesh.triangles.iter().for_each(|ids| taken.add(ids.map(at)));
        }
    }
    for placement in &placed.placements {
        taken.add_convex(&outline(placement, placed.library.footprint(placement.model)));
    }
    taken
}

fn tell(
    table: &ScatterTable,
    (count, areas, counts): (usize, usize, ScatterCounts),
    collected: &mut SceneBuilder,
) {
    let name = table.name.clone().unwrap_or_default();
    let models = if count == 1 { "1 model stands".into() } else { format!("{count} models stand") };
    let called = described("scatter", &name);
    let areas_s = if areas == 1 { "1 area".into() } else { format!("{areas} areas") };
    let span = table.source.span();
    collected.findings.add(FindingCode::Scattered, span.clone(), format!("{called}: {models} in {areas_s}"));
    if let Some((code, message, help)) = counts.finding(count) {
        collected.findings.add_with_help(code, span.clone(), format!("{called} {message}"), help);
    }
    if counts.crowded > 0 {
        let message = "fewer than `density` says, since `spacing` leaves no room for more";
        collected.findings.add(FindingCode::Crowded, span, format!("{called}: {message}"));
    }
    collected.report.scattered.push(ScatterRow {
        name,
        models: count,
        areas,
        by_slope: counts.slope,
        by_elevation: counts.elevation,
        by_obstacles: counts.taken,
        off_the_ground: counts.off,
    });
}

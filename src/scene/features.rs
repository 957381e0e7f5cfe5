//! Lakes and rivers, and what all that lies on the ground has in common: lakes level the ground, then everything becomes
//! a ribbon in plan, and what overlaps is taken apart.

use glam::DVec2;
use toml::Spanned;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::{Document, Lake};
use crate::draw::list::FeatureId;
use crate::geom::polygon;
use crate::geom::polyline::Polyline;
use crate::geom::rect::Rect;
use crate::mesh::sink::MeshSink;
use crate::ribbon::area;
use crate::ribbon::partition;
use crate::ribbon::plan::{PlanMesh, PlanVertex};
use crate::ribbon::stroke::{Continuations, StrokeOptions, stroke};
use crate::ribbon::texture::{Surface, texture_length_m};
use crate::scene::kind::{Feature, FeatureKind, Ribbon};
use crate::scene::sources::{Named, Sources};
use crate::terrain::earthwork;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Interpolation, ground_height};
use crate::vector::feature::Polygon;

/// Features with their ids, and what there is to say about them.
#[derive(Default)]
pub struct Collected {
    /// What lies on the ground.
    pub ribbons: Vec<Ribbon>,
    /// Every feature so far; ids count from 2.
    pub features: Vec<Feature>,
    /// For the user.
    pub notes: Vec<String>,
}

impl Collected {
    /// Notes a feature and returns its id.
    pub fn add(&mut self, kind: FeatureKind, name: String) -> FeatureId {
        self.features.push(Feature { kind, name });
        FeatureId(FeatureId::GROUND.0 + self.features.len() as u32)
    }

    /// Lays a plan over what was laid before in its class and below.
    pub fn lay(&mut self, plan: PlanMesh, surface: Surface, feature: FeatureId) {
        self.ribbons.push(Ribbon { plan, surface, layer: layer_of(surface), feature });
    }

    /// Takes apart what lies over one another, so that no two ribbons share any ground: what covers what goes by class,
    /// and within a class the junctions come first and then what was laid last.
    pub fn take_apart(&mut self) {
        let order = |ribbon: &Ribbon| (ribbon.layer, ribbon.surface.is_junction());
        self.ribbons.sort_by_key(order);
        let from_above: Vec<&PlanMesh> = self.ribbons.iter().rev().map(|ribbon| &ribbon.plan).collect();
        let parts = partition::apart(from_above.iter().copied());
        for (ribbon, plan) in self.ribbons.iter_mut().rev().zip(parts) {
            ribbon.plan = plan;
        }
        self.ribbons.retain(|ribbon| !ribbon.plan.triangles.is_empty());
    }
}

/// Vertices nearer to each other than this have no direction worth a joint.
const MERGE_M: f64 = 0.01;

/// Adds the document's lakes to `collected` and levels the ground under them. Lakes off the ground and those
/// without an area are left out, with a note.
///
/// # Errors
/// A source cannot be had, or a level cannot be found.
pub fn lakes(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut Collected,
) -> Result<(), Diagnostic> {
    for lake in &document.lakes {
        for Named { name, shape } in sources.polygons(&lake.source)? {
            let name = named(lake.name.as_deref(), name);
            let shore = Rect::around(shape.exterior.iter().copied());
            if !shore.meets(&lattice.extent()) {
                collected.notes.push(format!("{} lies off the elevation model", called(&name)));
                continue;
            }
            let mut plan = PlanMesh::default();
            area::fill(&shape.exterior, &shape.holes, LAKE_TEXTURE_M, &mut plan);
            if plan.triangles.is_empty() {
                collected.notes.push(format!("lake '{name}' left out: its shore encloses no area"));
                continue;
            }
            let level_m = level_of(document, lake, &shape, lattice)?;
            add_lake(collected, lattice, name, &shape, plan, level_m);
        }
    }
    Ok(())
}

fn add_lake(
    collected: &mut Collected,
    lattice: &mut Lattice,
    name: String,
    shape: &Polygon,
    plan: PlanMesh,
    level_m: f64,
) {
    let rings: Vec<Vec<DVec2>> = std::iter::once(&shape.exterior).chain(&shape.holes).cloned().collect();
    let volumes = earthwork::level(lattice, &rings, level_m as f32);
    collected.notes.push(format!(
        "{} lies level at {level_m:.1} m: {:.0} m³ cut, {:.0} m³ filled",
        called(&name),
        volumes.cut_m3,
        volumes.fill_m3
    ));
    let feature = collected.add(FeatureKind::Lake, name);
    collected.lay(plan, Surface::Lake, feature);
}

/// Metres in one repeat of the water's texture: fine enough not to be seen as a pattern.
const LAKE_TEXTURE_M: f64 = 400.0;

/// The stated level, or the lowest ground along the shore, sampled twice a cell.
fn level_of(document: &Document, lake: &Lake, shape: &Polygon, lattice: &Lattice) -> Result<f64, Diagnostic> {
    if let Some(level) = &lake.level {
        return Ok(*level.get_ref());
    }
    let step = lattice.cell().min_element() / 2.0;
    let extent = lattice.extent();
    let lowest = polygon::edges(&shape.exterior)
        .filter_map(|(from, to)| extent.clip_line(from, to))
        .flat_map(|(from, to)| {
            let count = (from.distance(to) / step).ceil().clamp(1.0, 1e6) as u32;
            (0..count).map(move |index| from.lerp(to, f64::from(index) / f64::from(count)))
        })
        .filter_map(|at| ground_height(lattice, Interpolation::Bilinear, at + lattice.origin()).height_m())
        .fold(f64::INFINITY, f64::min);
    if lowest.is_finite() {
        return Ok(lowest);
    }
    let message = "no ground lies along this lake's shore to take its level from";
    Err(document.error_at(lake.source.span(), message).with_help("state it: level = <metres>"))
}

/// Adds the document's rivers.
///
/// # Errors
/// A source cannot be had.
pub fn rivers(
    document: &Document,
    sources: &Sources<'_>,
    extent: &Rect,
    collected: &mut Collected,
) -> Result<(), Diagnostic> {
    for river in &document.rivers {
        let width_m = value(river.width.as_ref(), 8.0);
        let options = StrokeOptions {
            width_m,
            texture_length_m: texture_length_m(Surface::River, width_m),
            ..StrokeOptions::default()
        };
        let lines = sources.lines(&river.source)?;
        for (name, line) in
            near(lines, extent, &options, (FeatureKind::River, river.name.as_deref()), collected)
        {
            let mut plan = Clipped { plan: PlanMesh::default(), extent };
            stroke(&line, Continuations::default(), &options, &mut plan);
            let feature = collected.add(FeatureKind::River, name);
            collected.lay(plan.plan, Surface::River, feature);
        }
    }
    Ok(())
}

/// The lines that come near the ground's `extent`, with their names; the others are noted.
pub(super) fn near(
    lines: Vec<Named<Vec<DVec2>>>,
    extent: &Rect,
    options: &StrokeOptions,
    (kind, given): (FeatureKind, Option<&str>),
    collected: &mut Collected,
) -> Vec<(String, Polyline)> {
    let count = lines.len();
    let near: Vec<_> = lines
        .into_iter()
        .filter_map(|Named { name, shape }| {
            let reach = Rect::around(shape.iter().copied()).grown(options.width_m * options.mitre_limit);
            let line = Polyline::new(shape, MERGE_M).filter(|_| reach.meets(extent))?;
            Some((named(given, name), line))
        })
        .collect();
    let off = count - near.len();
    if off > 0 {
        let what = given.map(|name| format!(" of '{name}'")).unwrap_or_default();
        collected.notes.push(format!(
            "{off} {}{what} left out: off the elevation model or a single point",
            kind.noun(off)
        ));
    }
    near
}

/// A plan mesh that leaves out triangles that cannot meet the ground.
pub(super) struct Clipped<'a> {
    /// What was not left out.
    pub plan: PlanMesh,
    /// Where the ground is.
    pub extent: &'a Rect,
}

impl MeshSink<PlanVertex> for Clipped<'_> {
    fn vertex(&mut self, vertex: PlanVertex) -> crate::mesh::sink::VertexId {
        self.plan.vertex(vertex)
    }

    fn triangle(&mut self, corners: [crate::mesh::sink::VertexId; 3]) {
        let reach = Rect::around(corners.map(|id| self.plan.vertices[id.index()].at));
        if reach.meets(self.extent) {
            self.plan.triangle(corners);
        }
    }
}

/// What covers what, by class: still water over streams, roads over water, better roads over lesser.
fn layer_of(surface: Surface) -> u8 {
    match surface {
        Surface::River => 0,
        Surface::Lake => 1,
        Surface::Track | Surface::TrackJunction => 2,
        Surface::Gravel | Surface::GravelJunction => 3,
        Surface::Asphalt | Surface::AsphaltJunction => 4,
    }
}

/// A lake in a note; many have no name.
fn called(name: &str) -> String {
    if name.is_empty() { "a lake without a name".into() } else { format!("lake '{name}'") }
}

/// The name given in the scene file, or the one in the vector file.
pub(super) fn named(given: Option<&str>, in_file: String) -> String {
    given.map_or(in_file, str::to_owned)
}

/// What is stated, or the default.
pub(super) fn value(stated: Option<&Spanned<f64>>, default: f64) -> f64 {
    stated.map_or(default, |value| *value.get_ref())
}

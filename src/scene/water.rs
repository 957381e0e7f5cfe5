//! Lakes and rivers: lakes level the ground they lie on.

use glam::DVec2;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::features::Lake;
use crate::geom::polygon;
use crate::geom::rect::Rect;
use crate::ribbon::area;
use crate::ribbon::plan::PlanMesh;
use crate::ribbon::stroke::{Continuations, StrokeOptions, stroke};
use crate::ribbon::texture::{Surface, texture_length_m};
use crate::scene::attributes::Attributes;
use crate::scene::collected::Collected;
use crate::scene::kind::FeatureKind;
use crate::scene::near::{self, Clipped};
use crate::scene::sources::{Sourced, Sources};
use crate::terrain::earthwork;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Interpolation, ground_height};
use crate::vector::feature::Polygon;

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
        for Sourced { attributes, shape } in sources.polygons(&lake.source)? {
            let name = attributes.name(lake.name.as_deref());
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
            let level_m = level_of(document, lake, (&attributes, &shape), lattice)?;
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
fn level_of(
    document: &Document,
    lake: &Lake,
    (attributes, shape): (&Attributes, &Polygon),
    lattice: &Lattice,
) -> Result<f64, Diagnostic> {
    if let Some(level) = attributes.number(lake.level.as_ref()) {
        return Ok(level);
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
        let lines = sources.lines(&river.source)?;
        let given = river.name.as_deref();
        for (attributes, line) in
            near::lines(lines, (extent, REACH_M), (FeatureKind::River, given), collected)
        {
            let stated = ("[[river]] width", river.width.as_ref());
            let width_m = attributes.number_or(stated, 8.0, &mut collected.defaulted);
            let options = StrokeOptions {
                width_m,
                texture_length_m: texture_length_m(Surface::River, width_m),
                ..StrokeOptions::default()
            };
            let mut plan = Clipped { plan: PlanMesh::default(), extent };
            stroke(&line, Continuations::default(), &options, &mut plan);
            let feature = collected.add(FeatureKind::River, attributes.name(given));
            collected.lay(plan.plan, Surface::River, feature);
        }
    }
    Ok(())
}

/// How far from the ground a centreline may run whose water still reaches it, in metres.
const REACH_M: f64 = 1000.0;

/// A lake in a note; many have no name.
fn called(name: &str) -> String {
    if name.is_empty() { "a lake without a name".into() } else { format!("lake '{name}'") }
}

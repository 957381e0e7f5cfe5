//! Roads: lines become ribbons that go on in one another and meet in junctions.

use toml::Spanned;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::words;
use crate::draw::list::FeatureId;
use crate::geom::polyline::Polyline;
use crate::geom::rect::Rect;
use crate::mesh::sink::MeshSink;
use crate::ribbon::junction::{self, Street};
use crate::ribbon::plan::{PlanMesh, PlanVertex};
use crate::ribbon::stroke::{StrokeOptions, stroke};
use crate::ribbon::texture::{Surface, texture_length_m};
use crate::scene::features::{Clipped, Collected, near, value};
use crate::scene::kind::FeatureKind;
use crate::scene::sources::Sources;

/// Metres in one repeat of a junction's surface.
const JUNCTION_TEXTURE_M: f64 = 15.0;

/// The pavements, each joined with its like: where a lesser road meets a better one, the better one goes through.
const PAVEMENTS: [(Surface, Surface); 3] = [
    (Surface::Track, Surface::TrackJunction),
    (Surface::Gravel, Surface::GravelJunction),
    (Surface::Asphalt, Surface::AsphaltJunction),
];

/// A road's centreline, ready to be a ribbon.
struct Centreline {
    line: Polyline,
    options: StrokeOptions,
    surface: Surface,
    feature: FeatureId,
}

/// Adds the document's roads.
///
/// # Errors
/// A source cannot be had.
pub fn roads(
    document: &Document,
    sources: &Sources<'_>,
    extent: &Rect,
    collected: &mut Collected,
) -> Result<(), Diagnostic> {
    let mut all = Vec::new();
    for road in &document.roads {
        let surface = match road.surface.as_ref().map(Spanned::get_ref).copied().unwrap_or_default() {
            words::Surface::Asphalt => Surface::Asphalt,
            words::Surface::Gravel => Surface::Gravel,
            words::Surface::Track => Surface::Track,
        };
        let width_m = value(road.width.as_ref(), 6.0);
        let options = StrokeOptions {
            width_m,
            texture_length_m: texture_length_m(surface, width_m),
            ..StrokeOptions::default()
        };
        let lines = sources.lines(&road.source)?;
        for (name, line) in
            near(lines, extent, &options, (FeatureKind::Road, road.name.as_deref()), collected)
        {
            let feature = collected.add(FeatureKind::Road, name);
            all.push(Centreline { line, options, surface, feature });
        }
    }
    for (surface, joint) in PAVEMENTS {
        let roads: Vec<&Centreline> = all.iter().filter(|road| road.surface == surface).collect();
        join(&roads, joint, extent, collected);
    }
    Ok(())
}

/// Lays the roads of one pavement and their junctions.
fn join(roads: &[&Centreline], joint: Surface, extent: &Rect, collected: &mut Collected) {
    let Some(first) = roads.first() else { return };
    let streets: Vec<Street<'_>> =
        roads.iter().map(|road| Street { line: &road.line, options: road.options }).collect();
    let network = junction::connect(&streets);
    let plans: Vec<PlanMesh> = roads
        .iter()
        .zip(&network.continuations)
        .map(|(road, beyond)| {
            let mut plan = Clipped { plan: PlanMesh::default(), extent };
            stroke(&road.line, *beyond, &road.options, &mut plan);
            plan.plan
        })
        .collect();
    let mut junctions = Clipped { plan: PlanMesh::default(), extent };
    for corners in junction::surface(&plans, &network.nodes).triangles() {
        let ids =
            corners.map(|at| junctions.vertex(PlanVertex { at, uv: (at / JUNCTION_TEXTURE_M).as_vec2() }));
        junctions.triangle(ids);
    }
    for (road, plan) in roads.iter().zip(plans) {
        collected.lay(plan, road.surface, road.feature);
    }
    // A junction belongs to all that meet in it; it is told as a part of the first.
    collected.lay(junctions.plan, joint, first.feature);
}

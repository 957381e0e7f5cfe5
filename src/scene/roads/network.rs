//! Roads on the ground: lines become ribbons that go on in one another and meet in junctions.

use crate::geom::rect::Rect;
use crate::mesh::sink::MeshSink;
use crate::ribbon::junction::{self, Street};
use crate::ribbon::plan::{PlanMesh, PlanVertex};
use crate::ribbon::stroke::stroke;
use crate::ribbon::texture::Surface;
use crate::scene::collected::Collected;
use crate::scene::near::Clipped;
use crate::scene::roads::centreline::Centreline;

/// Metres in one repeat of a junction's surface.
const JUNCTION_TEXTURE_M: f64 = 15.0;

/// The pavements, each joined with its like: where a lesser road meets a better one, the better one goes through.
const PAVEMENTS: [(Surface, Surface); 3] = [
    (Surface::Track, Surface::TrackJunction),
    (Surface::Gravel, Surface::GravelJunction),
    (Surface::Asphalt, Surface::AsphaltJunction),
];

/// Lays roads on the ground, whatever carries them.
pub fn lay(all: &[Centreline], extent: &Rect, collected: &mut Collected) {
    for (surface, joint) in PAVEMENTS {
        let roads: Vec<&Centreline> = all.iter().filter(|road| road.surface == surface).collect();
        join(&roads, joint, extent, collected);
    }
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

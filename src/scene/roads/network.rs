//! Roads on the ground: lines become ribbons that continue one another and meet in junctions.
//!
//! From above: the junctions of the best pavement, its carriageways, those of the lesser ones, and below them all the
//! shoulders, which join as carriageways do. Only roads on the ground are laid; bridges and tunnels take part in
//! junctions, so that a road ends on the edge where its bridge begins.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use crate::builder::SceneBuilder;
use crate::near::Clipped;
use crate::roads::centerline::Centerline;
use crate::symbols::LineSymbol;
use sandtable_earthworks::alignment::chain::ChainLink;
use sandtable_geom::offset::Continuations;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::MeshSink;
use sandtable_ribbon::chain::chained;
use sandtable_ribbon::crossing::crossings;
use sandtable_ribbon::junction::{self, Street, StreetNetwork};
use sandtable_ribbon::plan::{PlanMesh, PlanVertex};
use sandtable_ribbon::stroke::{StrokePath, stroke};
use sandtable_ribbon::texture::RibbonSurface;

/// Meters in one repeat of a junction's surface.
const JUNCTION_TEXTURE_M: f64 = 15.0;

/// Triangles of a junction smaller than this are what clipping left at a corner, in square meters.
const NOTHING_M2: f64 = 1e-6;

/// The streets whose joints a thread makes in one go.
const STREETS: usize = 64;

/// The surfaces of joints by the rank of their pavement, from the least.
const JOINTS: [RibbonSurface; 3] =
    [RibbonSurface::TrackJunction, RibbonSurface::GravelJunction, RibbonSurface::AsphaltJunction];

/// Lays the roads that the ground carries on it.
pub fn lay(all: &[Centerline], extent: &Rect, collected: &mut SceneBuilder) {
    let symbol = |road: &Centerline| LineSymbol::of(&road.street, road.deck.as_ref(), road.feature);
    collected.symbols.par_extend(all.par_iter().filter_map(symbol));
    let with_shoulders =
        |road: &Centerline| road.street.with_more(2.0 * road.shoulder_m, RibbonSurface::Shoulder);
    let shouldered: Vec<&Centerline> = all.iter().filter(|road| road.shoulder_m > 0.0).collect();
    let shoulders: Vec<Street> = shouldered.par_iter().map(|road| with_shoulders(road)).collect();
    lay_strips(&shouldered.into_iter().zip(&shoulders).collect::<Vec<_>>(), extent, collected);
    let carriageways: Vec<_> = all.iter().map(|road| (road, &road.street)).collect();
    lay_strips(&carriageways, extent, collected);
}

/// Lays strips and the surfaces that join them, each for its road.
fn lay_strips(strips: &[(&Centerline, &Street)], extent: &Rect, collected: &mut SceneBuilder) {
    let streets: Vec<&Street> = strips.iter().map(|(_, street)| *street).collect();
    let network = junction::connect(&streets);
    let ribbons = ribbons(&streets, &network, extent);
    for ((road, street), joints) in strips.iter().zip(joints(&streets, &ribbons, &network, extent)) {
        for (rank, plan) in joints {
            let joint = match street.surface {
                RibbonSurface::Shoulder => RibbonSurface::Shoulder,
                _ => JOINTS[usize::from(rank)],
            };
            collected.lay(plan, joint, road.feature);
        }
    }
    // What is laid last covers what was laid before.
    let mut order: Vec<_> = strips.iter().zip(ribbons).collect();
    order.sort_by_key(|((_, street), _)| street.level);
    for ((road, street), plan) in order {
        collected.lay(plan, street.surface, road.feature);
    }
}

/// The ribbons of streets; an empty one where the ground does not carry it.
fn ribbons(streets: &[&Street], network: &StreetNetwork, extent: &Rect) -> Vec<PlanMesh> {
    let lengths_m: Vec<f64> = streets.iter().map(|street| street.alignment.line.length()).collect();
    let ribbon = |((street, &beyond), link): ((&&Street, &Continuations), ChainLink)| {
        let mut ribbon = Clipped { plan: PlanMesh::default(), extent };
        if street.alignment.is_on_ground() {
            let path = StrokePath { alignment: &street.alignment, beyond, link };
            stroke(&path, &street.options, &mut ribbon);
        }
        ribbon.plan
    };
    let links = chained(&lengths_m, &network.links);
    streets.par_iter().zip(&network.continuations).zip(links).map(ribbon).collect()
}

/// The joints of each street by rank: those at shared vertices before those where ribbons overlap otherwise.
fn joints(
    streets: &[&Street],
    ribbons: &[PlanMesh],
    network: &StreetNetwork,
    extent: &Rect,
) -> Vec<BTreeMap<u8, PlanMesh>> {
    // One road goes through a lesser one, or one of another level, that it crosses without a vertex.
    let class = |street: usize| (streets[street].surface.rank(), streets[street].level);
    let crossings = crossings(ribbons, |one, other| class(one) == class(other), &network.nodes);
    let mut outlines: Vec<Vec<(u8, &[DVec2])>> = vec![Vec::new(); streets.len()];
    for node in &network.nodes {
        outlines[node.street].push((node.rank, &node.outline));
    }
    for crossing in &crossings {
        let [one, other] = crossing.ribbons;
        let wider = if streets[other].width_m > streets[one].width_m { other } else { one };
        outlines[wider].push((streets[wider].surface.rank(), &crossing.outline));
    }
    let plans = |outlines: Vec<(u8, &[DVec2])>| {
        let mut joints: BTreeMap<u8, Clipped<'_>> = BTreeMap::new();
        for (rank, outline) in outlines {
            let empty = || Clipped { plan: PlanMesh::default(), extent };
            write_convex(outline, joints.entry(rank).or_insert_with(empty));
        }
        joints.into_iter().map(|(rank, joint)| (rank, joint.plan)).collect()
    };
    outlines.into_par_iter().with_min_len(STREETS).map(plans).collect()
}

fn write_convex(outline: &[DVec2], sink: &mut impl MeshSink<PlanVertex>) {
    let vertex = |at: DVec2| PlanVertex { at, uv: (at / JUNCTION_TEXTURE_M).as_vec2() };
    let corners: Vec<_> = outline.iter().map(|&at| (sink.vertex(vertex(at)), at)).collect();
    for triangle in polygon::fan(&corners) {
        if polygon::doubled_area(&triangle.map(|(_, at)| at)) > 2.0 * NOTHING_M2 {
            sink.triangle(triangle.map(|(id, _)| id));
        }
    }
}

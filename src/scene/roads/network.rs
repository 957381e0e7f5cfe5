//! Roads on the ground: lines become ribbons that continue one another and meet in junctions.
//!
//! From above: the junctions of the best pavement, its carriageways, those of the lesser ones, and below them all the
//! shoulders, which join as carriageways do. Only roads on the ground are laid; bridges and tunnels take part in
//! junctions, so that a road ends on the edge where its bridge begins.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use crate::earthworks::alignment::{Alignment, Support};
use crate::geom::polygon;
use crate::geom::rect::Rect;
use crate::mesh::sink::MeshSink;
use crate::ribbon::chain::stations;
use crate::ribbon::crossing::crossings;
use crate::ribbon::junction::{self, Street, StreetNetwork};
use crate::ribbon::plan::{PlanMesh, PlanVertex};
use crate::ribbon::stroke::{StrokeOptions, StrokePath, stroke_path};
use crate::ribbon::texture::RibbonSurface;
use crate::scene::builder::SceneBuilder;
use crate::scene::near::Clipped;
use crate::scene::roads::centerline::Centerline;

/// Meters in one repeat of a junction's surface.
const JUNCTION_TEXTURE_M: f64 = 15.0;

/// Triangles of a junction smaller than this are what clipping left at a corner, in square meters.
const NOTHING_M2: f64 = 1e-6;

/// The surfaces of joints by the rank of their pavement, from the least.
const JOINTS: [RibbonSurface; 3] =
    [RibbonSurface::TrackJunction, RibbonSurface::GravelJunction, RibbonSurface::AsphaltJunction];

/// Lays the roads that the ground carries on it.
pub fn lay(all: &[Centerline], extent: &Rect, collected: &mut SceneBuilder) {
    let shouldered: Vec<RoadStrip<'_>> =
        all.iter().filter(|road| road.shoulder_m > 0.0).map(RoadStrip::with_shoulders).collect();
    lay_strips(&shouldered, extent, collected);
    let carriageways: Vec<RoadStrip<'_>> = all.iter().map(RoadStrip::carriageway).collect();
    lay_strips(&carriageways, extent, collected);
}

/// The rank of a pavement among roads that meet.
pub fn rank_of(surface: RibbonSurface) -> u8 {
    match surface {
        RibbonSurface::Track => 0,
        RibbonSurface::Gravel => 1,
        _ => 2,
    }
}

/// A strip of one surface along a road.
struct RoadStrip<'a> {
    road: &'a Centerline,
    /// The road's alignment with the strip's width.
    alignment: Alignment,
    options: StrokeOptions,
    surface: RibbonSurface,
    rank: u8,
}

/// Strips of which one goes through the other where they cross without a vertex, if it is not the same.
#[derive(Clone, Copy, PartialEq)]
struct Class {
    rank: u8,
    level: i32,
}

impl<'a> RoadStrip<'a> {
    fn carriageway(road: &'a Centerline) -> Self {
        let rank = rank_of(road.surface);
        Self { road, alignment: road.alignment.clone(), options: road.options, surface: road.surface, rank }
    }

    /// The carriageway and what lies beside it.
    fn with_shoulders(road: &'a Centerline) -> Self {
        let more_m = 2.0 * road.shoulder_m;
        let width = road.alignment.width.grown(more_m);
        Self {
            road,
            alignment: Alignment { width, ..road.alignment.clone() },
            options: StrokeOptions { width_m: road.options.width_m + more_m, ..road.options },
            surface: RibbonSurface::Shoulder,
            rank: 0,
        }
    }

    fn street(&self) -> Street<'_> {
        Street { level: self.road.level, rank: self.rank, ..Street::new(&self.alignment, self.options) }
    }

    fn class(&self) -> Class {
        Class { rank: self.rank, level: self.road.level }
    }
}

/// Lays strips and the surfaces that join them.
fn lay_strips(strips: &[RoadStrip<'_>], extent: &Rect, collected: &mut SceneBuilder) {
    let streets: Vec<Street<'_>> = strips.iter().map(RoadStrip::street).collect();
    let network = junction::connect(&streets);
    let ribbons = ribbons(strips, &network, extent);
    for (strip, joints) in strips.iter().zip(joints(strips, &ribbons, &network, extent)) {
        for (rank, plan) in joints {
            let joint = match strip.surface {
                RibbonSurface::Shoulder => RibbonSurface::Shoulder,
                _ => JOINTS[usize::from(rank)],
            };
            collected.lay(plan, joint, strip.road.feature);
        }
    }
    // What is laid last covers what was laid before.
    let mut order: Vec<_> = strips.iter().zip(ribbons).collect();
    order.sort_by_key(|(strip, _)| strip.road.level);
    for (strip, (plan, _)) in order {
        collected.lay(plan, strip.surface, strip.road.feature);
    }
}

/// The ribbons of strips; an empty one where the ground does not carry it.
fn ribbons(strips: &[RoadStrip<'_>], network: &StreetNetwork, extent: &Rect) -> Vec<(PlanMesh, Class)> {
    let lengths_m: Vec<f64> = strips.iter().map(|strip| strip.alignment.line.length()).collect();
    let stations = stations(&lengths_m, &network.links);
    strips
        .par_iter()
        .enumerate()
        .map(|(index, strip)| {
            let mut ribbon = Clipped { plan: PlanMesh::default(), extent };
            let path = StrokePath {
                line: &strip.alignment.line,
                width: &strip.alignment.width,
                beyond: network.continuations[index],
                stations: stations[index],
            };
            if strip.alignment.support == Support::Ground {
                stroke_path(&path, &strip.options, &mut ribbon);
            }
            (ribbon.plan, strip.class())
        })
        .collect()
}

/// The joints of each strip by rank: those at shared vertices before those where ribbons overlap otherwise.
fn joints(
    strips: &[RoadStrip<'_>],
    ribbons: &[(PlanMesh, Class)],
    network: &StreetNetwork,
    extent: &Rect,
) -> Vec<BTreeMap<u8, PlanMesh>> {
    let mut joints: Vec<BTreeMap<u8, Clipped<'_>>> = Vec::new();
    joints.resize_with(strips.len(), BTreeMap::new);
    let mut add = |strip: usize, rank: u8, outline: &[DVec2]| {
        let empty = || Clipped { plan: PlanMesh::default(), extent };
        write_convex(outline, joints[strip].entry(rank).or_insert_with(empty));
    };
    for node in &network.nodes {
        add(node.street, node.rank, &node.outline);
    }
    for crossing in crossings(ribbons, &network.nodes) {
        let [one, other] = crossing.ribbons;
        let wider = if strips[other].options.width_m > strips[one].options.width_m { other } else { one };
        add(wider, strips[wider].rank, &crossing.outline);
    }
    let plans = |joints: BTreeMap<u8, Clipped<'_>>| {
        joints.into_iter().map(|(rank, joint)| (rank, joint.plan)).collect()
    };
    joints.into_iter().map(plans).collect()
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

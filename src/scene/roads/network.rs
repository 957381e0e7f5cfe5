//! Roads on the ground: lines become ribbons that go on in one another and meet in junctions.
//!
//! What lies over what, from above: the junctions of the best pavement, its carriageways, those of the lesser ones, and
//! below them all the shoulders, which join as carriageways do. Only stretches that the ground carries are laid; those
//! on bridges and in tunnels take part in what meets, so that a road ends on the edge where its bridge begins.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use crate::geom::polygon;
use crate::geom::rect::Rect;
use crate::mesh::sink::MeshSink;
use crate::ribbon::chain::stations;
use crate::ribbon::crossing::crossings;
use crate::ribbon::junction::{self, Street, StreetNetwork, StreetSupport};
use crate::ribbon::plan::{PlanMesh, PlanVertex};
use crate::ribbon::stroke::{StrokeOptions, StrokePath, Widths, stroke_course};
use crate::ribbon::texture::RibbonSurface;
use crate::scene::builder::SceneBuilder;
use crate::scene::near::Clipped;
use crate::scene::roads::centerline::{Centerline, Support};

/// Meters in one repeat of a junction's surface.
const JUNCTION_TEXTURE_M: f64 = 15.0;

/// Triangles of a junction smaller than this are what clipping left at a corner, in square meters.
const NOTHING_M2: f64 = 1e-6;

/// Joints by the rank of their pavement, from the least: where a lesser road meets a better one, the better one goes
/// through.
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

/// What meets among `all`, whatever carries it: for each its continuations, so that a bridge can begin on the edge where
/// its road ends.
pub fn connect(all: &[Centerline]) -> StreetNetwork {
    let strips: Vec<RoadStrip<'_>> = all.iter().map(RoadStrip::carriageway).collect();
    junction::connect(&strips.iter().map(RoadStrip::street).collect::<Vec<_>>())
}

/// How good a pavement is among roads that meet.
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
    /// The width at each vertex, where it changes.
    widths_m: Option<Vec<f64>>,
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
        Self { road, widths_m: widths_m(road, 0.0), options: road.options, surface: road.surface, rank }
    }

    /// The carriageway and what lies beside it.
    fn with_shoulders(road: &'a Centerline) -> Self {
        let more_m = 2.0 * road.shoulder_m;
        Self {
            road,
            widths_m: widths_m(road, more_m),
            options: StrokeOptions { width_m: road.options.width_m + more_m, ..road.options },
            surface: RibbonSurface::Shoulder,
            rank: 0,
        }
    }

    fn widths(&self) -> Widths<'_> {
        match &self.widths_m {
            Some(widths_m) => Widths::PerVertex(widths_m),
            None => Widths::Constant(self.options.width_m),
        }
    }

    fn street(&self) -> Street<'_> {
        Street {
            line: &self.road.line,
            widths: self.widths(),
            options: self.options,
            bed: if self.is_laid() { StreetSupport::Ground } else { StreetSupport::Structure },
            level: self.road.level,
            rank: self.rank,
        }
    }

    fn is_laid(&self) -> bool {
        self.road.carried == Support::Ground
    }

    fn class(&self) -> Class {
        Class { rank: self.rank, level: self.road.level }
    }
}

/// The widths of a road at its vertices where they change, each `more_m` wider.
fn widths_m(road: &Centerline, more_m: f64) -> Option<Vec<f64>> {
    match road.widths() {
        Widths::Constant(_) => None,
        Widths::PerVertex(widths_m) => Some(widths_m.iter().map(|width_m| width_m + more_m).collect()),
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
    let lengths_m: Vec<f64> = strips.iter().map(|strip| strip.road.line.length()).collect();
    let stations = stations(&lengths_m, &network.links);
    strips
        .par_iter()
        .enumerate()
        .map(|(index, strip)| {
            let mut ribbon = Clipped { plan: PlanMesh::default(), extent };
            let course = StrokePath {
                line: &strip.road.line,
                widths: strip.widths(),
                beyond: network.continuations[index],
                stations: stations[index],
            };
            if strip.is_laid() {
                stroke_course(&course, &strip.options, &mut ribbon);
            }
            (ribbon.plan, strip.class())
        })
        .collect()
}

/// The joints that are told as a part of each strip, by their rank: those at shared vertices before those where ribbons
/// share ground for another reason.
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

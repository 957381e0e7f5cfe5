//! Models that stand in one another, in a building, or on a road that they block.
//!
//! A truck on a bridge stands on it, not in it, and a bridge along a road carries it.

use glam::{DVec2, Vec3};

use crate::context::LintContext;
use crate::models::standing::StandingModel;
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_draw::list::{DrawMesh, FeatureId};
use sandtable_geom::convex;
use sandtable_geom::leg_tree::{LegTree, LineLeg};
use sandtable_geom::polygon;
use sandtable_geom::polyline::Polyline;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::feature_meshes::Solid;
use sandtable_scene::symbols::LineSymbol;

/// The share of the smaller foot that has to lie in the other: less is a balcony, or a wall that two houses have in common.
const SHARED: f64 = 0.2;

/// Two models stand on one ground where their feet differ in height by less than this share of the lower model.
const SAME_GROUND: f32 = 0.5;

/// What is so many times as long as it is wide and lies along a road is a bridge, a gate or a train.
const LONG: f64 = 2.0;

/// And turns from the road by no more than 30°: the cosine of that.
const ALONG: f64 = 0.866;

/// The most models near one that it is compared with.
const MOST_NEAR: usize = 64;

/// A roof's triangles face up by more than this; walls have no area in plan.
const FACES_UP: f32 = 0.1;

/// Finds such models among `standing`.
pub fn check(context: &LintContext<'_>, standing: &[StandingModel<'_>], sink: &mut FindingSink) {
    if standing.is_empty() {
        return;
    }
    let mut worst = WorstOfTables::default();
    let outlines: Vec<[DVec2; 4]> = standing.iter().map(StandingModel::outline).collect();
    let rects: Vec<Rect> = outlines.iter().map(|outline| polygon::bounds(outline)).collect();
    let tree = RectTree::new(&rects);
    let (buildings, roads) = (BuildingRoofs::of(context), RoadLegs::of(context));
    for (index, model) in standing.iter().enumerate() {
        let (feature, outline, rect) = (model.placement.feature, &outlines[index], &rects[index]);
        let mut add = |share: f64, with: &dyn Fn() -> String| {
            worst.add(context.origin(feature), share, || {
                format!("{} at {} {}", context.name(feature), model.place(context.scene), with())
            });
        };
        for near in tree.meeting_in_order(rect).into_iter().filter(|&near| near < index).take(MOST_NEAR) {
            let other = &standing[near];
            let share = shared(outline, &outlines[near]);
            if share > SHARED && is_on_one_ground(model, other) {
                let name = || context.name(other.placement.feature);
                add(share, &|| {
                    format!("stands in {}: they share {:.0} % of the smaller foot", name(), share * 100.0)
                });
            }
        }
        if let Some((building, share)) = buildings.around(outline, rect).filter(|(_, share)| *share > SHARED)
        {
            let name = || context.name(building);
            add(share, &|| format!("stands in {}: {:.0} % of its foot", name(), share * 100.0));
        }
        if let Some(road) = roads.under(outline, rect) {
            add(1.0, &|| format!("stands on the middle of {}", context.name(road)));
        }
    }
    let help = "move one of them, or leave one out";
    worst.report(context, FindingCode::ModelsOverlap, help, sink);
}

/// The share of the smaller outline that both have in common.
fn shared(one: &[DVec2; 4], other: &[DVec2; 4]) -> f64 {
    let least_m2 = polygon::doubled_area(one).min(polygon::doubled_area(other)) / 2.0;
    let common = convex::intersection(one, other, 0.0);
    common.map_or(0.0, |common| polygon::doubled_area(&common) / 2.0 / least_m2)
}

fn is_on_one_ground(one: &StandingModel<'_>, other: &StandingModel<'_>) -> bool {
    let lower_m = one.size_m().z.min(other.size_m().z);
    (one.foot_z() - other.foot_z()).abs() < SAME_GROUND * lower_m
}

/// The roofs of the scene's buildings.
struct BuildingRoofs<'a> {
    solids: Vec<&'a Solid>,
    tree: RectTree,
}

impl<'a> BuildingRoofs<'a> {
    fn of(context: &LintContext<'a>) -> Self {
        let is_building = |solid: &&Solid| context.kind(solid.feature) == Some(FeatureKind::Building);
        let solids: Vec<&Solid> = context.scene.solids.iter().filter(is_building).collect();
        let rect = |solid: &&Solid| {
            let plan = solid.mesh.vertices.iter().map(|at| Vec3::from(at.position).truncate().as_dvec2());
            Rect::around(plan)
        };
        let rects: Vec<Rect> = solids.iter().map(rect).collect();
        Self { tree: RectTree::new(&rects), solids }
    }

    /// The building that covers most of an outline, with the share of it.
    fn around(&self, outline: &[DVec2; 4], rect: &Rect) -> Option<(FeatureId, f64)> {
        let all_m2 = polygon::doubled_area(outline) / 2.0;
        let near = self.tree.meeting_in_order(rect).into_iter().take(MOST_NEAR);
        let shares = near.map(|index| {
            let solid = self.solids[index];
            let covered: f64 = roof(&solid.mesh).map(|triangle| common_m2(&triangle, outline)).sum();
            (solid.feature, covered / all_m2)
        });
        shares.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The triangles of a mesh that face up, in plan.
fn roof(mesh: &DrawMesh) -> impl Iterator<Item = [DVec2; 3]> + '_ {
    mesh.triangles.iter().filter_map(|corners| {
        let [a, b, c] = corners.map(|id| Vec3::from(mesh.vertices[id.index()].position));
        let normal = (b - a).cross(c - a);
        (normal.z > FACES_UP * normal.length()).then(|| [a, b, c].map(|at| at.truncate().as_dvec2()))
    })
}

fn common_m2(triangle: &[DVec2; 3], outline: &[DVec2; 4]) -> f64 {
    convex::intersection(outline, triangle, 0.0).map_or(0.0, |common| polygon::doubled_area(&common) / 2.0)
}

/// The scene's roads on the ground.
struct RoadLegs<'a> {
    lines: Vec<&'a LineSymbol>,
    legs: LegTree,
}

impl<'a> RoadLegs<'a> {
    fn of(context: &'a LintContext<'_>) -> Self {
        let lines: Vec<&LineSymbol> = context.roads_on_ground().collect();
        let legs =
            lines.iter().enumerate().flat_map(|(index, line)| LineLeg::all(index, &line.alignment.line));
        Self { legs: LegTree::new(legs.collect()), lines }
    }

    /// A road whose centerline runs through an outline that is wider than it, and does not lie along it.
    fn under(&self, outline: &[DVec2; 4], rect: &Rect) -> Option<FeatureId> {
        let sides = [outline[1] - outline[0], outline[2] - outline[1]];
        let (long, short) =
            if sides[0].length() < sides[1].length() { (sides[1], sides[0]) } else { (sides[0], sides[1]) };
        let line = Polyline::new([rect.min, rect.max], 0.0)?;
        let window = LineLeg::all(0, &line).next()?;
        let blocks = |leg: &LineLeg| {
            let width_m = self.lines[leg.line].alignment.width.at((leg.stations[0] + leg.stations[1]) / 2.0);
            let way = (leg.ends[1] - leg.ends[0]).normalize_or_zero();
            let is_along =
                long.length() >= LONG * short.length() && way.dot(long.normalize_or_zero()).abs() > ALONG;
            let is_through = convex::clip_line(outline, (leg.ends[0], leg.ends[1]), 0.0).is_some();
            short.length() > width_m && !is_along && is_through
        };
        let mut near = self.legs.near(&window).into_iter().map(|near| &self.legs.legs()[near]);
        near.find(|leg| blocks(leg)).map(|leg| self.lines[leg.line].feature)
    }
}

//! Models that stand in one another, in a building, or on a road that they are too large to drive on.

use glam::{DVec2, Vec3};

use crate::description::finding_code::FindingCode;
use crate::draw::list::{DrawMesh, FeatureId};
use crate::geom::convex;
use crate::geom::leg_tree::{LegTree, LineLeg};
use crate::geom::polygon;
use crate::geom::polyline::Polyline;
use crate::geom::rect::Rect;
use crate::geom::rect_tree::RectTree;
use crate::pipeline::lint::context::LintContext;
use crate::pipeline::lint::models::StandingModel;
use crate::pipeline::lint::sink::FindingSink;
use crate::pipeline::lint::worst::WorstOfTables;
use crate::scene::symbols::LineSymbol;
use crate::scene::{FeatureKind, Solid};

/// The share of the smaller foot that has to lie in the other: less is a balcony, or a wall that two houses have in common.
const SHARED: f64 = 0.2;

/// Two models share height where the ranges of their heights have this part of the lower one in common.
const SHARED_HEIGHT: f32 = 0.2;

/// A foot with sides of at least this belongs to no vehicle, meters: battle tanks are 3.7 m wide.
const NO_VEHICLE_M: f64 = 4.0;

/// The most models near one that it is compared with.
const MOST_NEAR: usize = 64;

/// A roof's triangles face up by more than this; walls have no area in plan.
const FACES_UP: f32 = 0.1;

/// Finds these among `standing`.
pub fn check(context: &LintContext<'_>, standing: &[StandingModel<'_>], sink: &mut FindingSink) {
    let mut worst = WorstOfTables::default();
    let outlines: Vec<[DVec2; 4]> = standing.iter().map(StandingModel::outline).collect();
    let rects: Vec<Rect> = outlines.iter().map(|outline| polygon::bounds(outline)).collect();
    let tree = RectTree::new(&rects);
    let (buildings, roads) = (Buildings::of(context), Roads::of(context));
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
            if share > SHARED && share_height(model, other) {
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
    for (span, message) in
        worst.into_messages(|more| format!("{more} more models of this table stand in something"))
    {
        sink.add(context.finding(FindingCode::ModelsOverlap, span, message).with_help(help));
    }
}

/// The share of the smaller outline that both have in common.
fn shared(one: &[DVec2; 4], other: &[DVec2; 4]) -> f64 {
    let least_m2 = polygon::doubled_area(one).min(polygon::doubled_area(other)) / 2.0;
    let common = convex::intersection(one, other, 0.0);
    common.map_or(0.0, |common| polygon::doubled_area(&common) / 2.0 / least_m2)
}

fn share_height(one: &StandingModel<'_>, other: &StandingModel<'_>) -> bool {
    let ([low_a, high_a], [low_b, high_b]) = (one.z_range(), other.z_range());
    let common = high_a.min(high_b) - low_a.max(low_b);
    common > SHARED_HEIGHT * (high_a - low_a).min(high_b - low_b)
}

/// The roofs of the scene's buildings.
struct Buildings<'a> {
    solids: Vec<&'a Solid>,
    tree: RectTree,
}

impl<'a> Buildings<'a> {
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
struct Roads<'a> {
    lines: Vec<&'a LineSymbol>,
    legs: LegTree,
}

impl<'a> Roads<'a> {
    fn of(context: &LintContext<'a>) -> Self {
        let is_road = |line: &&LineSymbol| {
            context.kind(line.feature) == Some(FeatureKind::Road) && line.alignment.is_on_ground()
        };
        let lines: Vec<&LineSymbol> = context.scene.symbols.iter().filter(is_road).collect();
        let legs =
            lines.iter().enumerate().flat_map(|(index, line)| LineLeg::all(index, &line.alignment.line));
        Self { legs: LegTree::new(legs.collect()), lines }
    }

    /// A road whose centerline runs through an outline that is too large for a vehicle.
    fn under(&self, outline: &[DVec2; 4], rect: &Rect) -> Option<FeatureId> {
        let sides = [outline[0].distance(outline[1]), outline[1].distance(outline[2])];
        if sides[0].min(sides[1]) < NO_VEHICLE_M {
            return None;
        }
        let line = Polyline::new([rect.min, rect.max], 0.0)?;
        let window = LineLeg::all(0, &line).next()?;
        let through = |leg: &LineLeg| convex::clip_line(outline, (leg.ends[0], leg.ends[1]), 0.0).is_some();
        let mut near = self.legs.near(&window).into_iter().map(|near| &self.legs.legs()[near]);
        near.find(|leg| through(leg)).map(|leg| self.lines[leg.line].feature)
    }
}

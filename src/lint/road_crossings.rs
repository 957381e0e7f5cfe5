//! Roads that cross water without a bridge.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::context::LintContext;
use crate::ground_line::place;
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_draw::list::FeatureId;
use sandtable_geom::leg_tree::{LegTree, LineLeg};
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;
use sandtable_geom::segment;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::symbols::LineSymbol;

/// Rivers narrower than this run through a pipe under the road, which no map shows, meters.
const CULVERT_M: f64 = 3.0;

/// A road that runs in a lake for less is a matter of how exactly the shore is drawn, meters.
const SHORE_SLACK_M: f64 = 10.0;

/// Water that roads may cross.
struct WaterLines<'a> {
    lines: Vec<&'a LineSymbol>,
    legs: LegTree,
    /// The shores of each lake.
    lakes: BTreeMap<FeatureId, Vec<&'a [DVec2]>>,
    /// The rectangles of the lakes, in the same order.
    rects: RectTree,
}

/// Finds roads on the ground that cross a river, or run through a lake.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let scene = context.scene;
    let water = WaterLines::of(scene);
    if water.lines.is_empty() {
        return;
    }
    let mut worst = WorstOfTables::default();
    for road in context.roads_on_ground() {
        let WaterCrossings { river, lakes } = water.crossed_by(road, scene);
        let name = || context.name(road.feature);
        if let Some((at, width_m, other)) = river {
            worst.add(context.origin(road.feature), width_m, || {
                let (other, place) = (context.name(other), place(scene, at));
                format!("{} crosses {other}, {width_m:.0} m wide, on the ground at {place}", name())
            });
        }
        for (lake, LakeStretch { at, length_m }) in lakes {
            worst.add(context.origin(road.feature), length_m, || {
                let (other, place) = (context.name(lake), place(scene, at));
                format!("{} runs {length_m:.0} m through {other} on the ground from {place} on", name())
            });
        }
    }
    let help = "say which lines are bridges with `bridge = \"...\"`, add a [[bridge]], or leave out water in pipes by `where`";
    worst.report(context, FindingCode::RoadInWater, help, sink);
}

/// What a road crosses.
#[derive(Default)]
struct WaterCrossings {
    /// The widest river: where, its width in meters, and which.
    river: Option<(DVec2, f64, FeatureId)>,
    lakes: Vec<(FeatureId, LakeStretch)>,
}

/// The part of a road that lies in a lake.
struct LakeStretch {
    /// Where it first comes in, world coordinates.
    at: DVec2,
    length_m: f64,
}

impl<'a> WaterLines<'a> {
    fn of(scene: &'a SceneModel) -> Self {
        let is_water = |symbol: &&LineSymbol| symbol.is_river() || symbol.is_shore();
        let lines: Vec<&LineSymbol> = scene.symbols.iter().filter(is_water).collect();
        let legs =
            lines.iter().enumerate().flat_map(|(index, line)| LineLeg::all(index, &line.alignment.line));
        let legs = LegTree::new(legs.collect());
        let mut lakes: BTreeMap<FeatureId, Vec<&[DVec2]>> = BTreeMap::new();
        for shore in lines.iter().filter(|line| line.is_shore()) {
            lakes.entry(shore.feature).or_default().push(shore.alignment.line.points());
        }
        let rect =
            |shores: &Vec<&[DVec2]>| Rect::around(shores.iter().flat_map(|shore| shore.iter().copied()));
        let rects = RectTree::new(&lakes.values().map(rect).collect::<Vec<_>>());
        Self { lines, legs, lakes, rects }
    }

    /// The lakes in whose rectangles a place lies.
    fn lakes_around(&self, at: DVec2) -> Vec<FeatureId> {
        let found = self.rects.meeting_in_order(&Rect::around([at]));
        let lakes: Vec<FeatureId> =
            if found.is_empty() { Vec::new() } else { self.lakes.keys().copied().collect() };
        found.into_iter().map(|index| lakes[index]).collect()
    }

    fn crossed_by(&self, road: &LineSymbol, scene: &SceneModel) -> WaterCrossings {
        let snapshot = scene.heights.snapshot();
        // A bridge of a table of its own carries the road there.
        let is_bridged = |at: DVec2| snapshot.decks().is_some_and(|decks| decks.height_m(at).is_some());
        let line = &road.alignment.line;
        let mut found = WaterCrossings::default();
        let mut shores: BTreeMap<FeatureId, Vec<f64>> = BTreeMap::new();
        for leg in LineLeg::all(0, line) {
            for near in self.legs.near(&leg) {
                let other = &self.legs.legs()[near];
                let ends = |leg: &LineLeg| (leg.ends[0], leg.ends[1]);
                let Some([part, along]) = segment::crossing(ends(&leg), ends(other)) else { continue };
                let (at, water) = (leg.ends[0].lerp(leg.ends[1], part), self.lines[other.line]);
                if water.is_shore() {
                    let station_m = leg.stations[0] + (leg.stations[1] - leg.stations[0]) * part;
                    shores.entry(water.feature).or_default().push(station_m);
                    continue;
                }
                let station_m = other.stations[0] + (other.stations[1] - other.stations[0]) * along;
                let width_m = water.alignment.width.at(station_m);
                let is_widest = found.river.is_none_or(|(_, widest_m, _)| width_m > widest_m);
                if width_m >= CULVERT_M && is_widest && !is_bridged(at) {
                    found.river = Some((at, width_m, water.feature));
                }
            }
        }
        // A road that begins in a lake may never cross its shore.
        for lake in self.lakes_around(line.points()[0]) {
            shores.entry(lake).or_default();
        }
        for (lake, mut stations) in shores {
            stations.extend([0.0, line.length()]);
            stations.sort_by(f64::total_cmp);
            let in_lake = |pair: &&[f64]| {
                let middle = line.at((pair[0] + pair[1]) / 2.0);
                polygon::contains(self.lakes[&lake].iter().copied(), middle) && !is_bridged(middle)
            };
            let mut stretches = stations.windows(2).filter(in_lake).peekable();
            let Some(first) = stretches.peek().map(|pair| line.at(pair[0])) else { continue };
            let length_m: f64 = stretches.map(|pair| pair[1] - pair[0]).sum();
            if length_m > SHORE_SLACK_M {
                found.lakes.push((lake, LakeStretch { at: first, length_m }));
            }
        }
        found
    }
}

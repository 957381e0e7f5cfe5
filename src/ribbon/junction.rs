//! Junctions of roads: which lines continue each other, and the surface that joins those that do not.
//!
//! Lines that share a vertex meet there, if they lie on one level; a line that ends there meets what goes on, whatever
//! the level. Where two ends of one width meet and nothing else does, the ribbons go on in one another and share an edge.
//! Where three or more arms meet, and where two do that cannot go on, the junction is the hull of all arms cut square
//! where the curbs of neighboring arms meet:
//!
//! ```text
//!          │   │
//!          │   │            ─── the arms' curbs
//!   ───────┼───┼───         a junction of three arms: cut where the curbs
//!          │ J │            meet, so that the whole width has no markings
//!   ───────┴───┴───
//! ```
//!
//! A better road that goes through is not broken by lesser ones: their junction lies below it. Ribbons lose what a
//! junction covers by [`crate::partition`], and their markings stop there. Lines that cross without a shared
//! vertex are found by [`crate::crossing`].

use glam::DVec2;
use rayon::prelude::*;

use crate::stroke::StrokeOptions;
use crate::texture::RibbonSurface;
use sandtable_earthworks::alignment::Alignment;
use sandtable_earthworks::alignment::chain::LineEnd;
use sandtable_geom::convex;
use sandtable_geom::offset::{Continuations, LineBend};
use sandtable_geom::polyline::{VertexKey, vertex_key};

/// Widths that differ by less than this are one, in meters: what two file formats make of one number.
const SAME_WIDTH_M: f64 = 1e-6;

/// The greatest reach of a junction along an arm, in widths of its widest arm: curbs at a small angle meet far away.
pub const LONGEST_REACH: f64 = 2.5;

/// A road or river among those that it may meet.
#[derive(Clone, Debug, PartialEq)]
pub struct Street {
    /// Its centerline, width and support. Junctions do not reach onto bridges and into tunnels.
    pub alignment: Alignment,
    /// The mean of its width in meters; of a part of a road that of the whole.
    pub width_m: f64,
    /// How it is stroked.
    pub options: StrokeOptions,
    /// The level, which decides what passes over what.
    pub level: i32,
    /// Its pavement: where it meets [lesser](RibbonSurface::rank) ones it goes through.
    pub surface: RibbonSurface,
}

impl Street {
    fn points(&self) -> &[DVec2] {
        self.alignment.line.points()
    }

    /// Its width and what is more beside it, of another surface.
    pub fn with_more(&self, more_m: f64, surface: RibbonSurface) -> Self {
        Self {
            alignment: self.alignment.widened(more_m),
            width_m: self.width_m + more_m,
            surface,
            ..self.clone()
        }
    }
}

/// Streets with what they meet.
#[derive(Clone, Debug, PartialEq)]
pub struct StreetNetwork {
    /// For each street, the lines that continue it at its ends.
    pub continuations: Vec<Continuations>,
    /// The pairs of ends that continue each other.
    pub links: Vec<[LineEnd; 2]>,
    /// The places where streets meet without simply continuing each other.
    pub nodes: Vec<JunctionNode>,
}

/// A junction at a vertex that streets share.
#[derive(Clone, Debug, PartialEq)]
pub struct JunctionNode {
    /// Convex, counter-clockwise.
    pub outline: Vec<DVec2>,
    /// The widest of its streets on the ground.
    pub street: usize,
    /// The pavement it has.
    pub rank: u8,
}

/// The places of meetings that a thread looks at in one go.
const MEETINGS: usize = 256;

/// What leaves a node along one street.
#[derive(Clone, Copy, Debug)]
struct Arm {
    street: usize,
    /// The street's vertex at the node.
    vertex: usize,
    /// Its next vertex, away from the node.
    next: usize,
}

/// Finds which streets continue each other, and the nodes of those that do not.
pub fn connect(streets: &[&Street]) -> StreetNetwork {
    let streets = Streets(streets);
    let mut arms: Vec<(VertexKey, Arm)> =
        (0..streets.0.len()).into_par_iter().flat_map_iter(|street| streets.arms(street)).collect();
    arms.par_sort_unstable_by_key(|&(place, arm)| (place, arm.street, arm.vertex, arm.next));
    let meetings: Vec<&[(VertexKey, Arm)]> = arms.chunk_by(|(place, _), (other, _)| place == other).collect();
    let joined = |meetings: &[&[(VertexKey, Arm)]]| {
        let mut joined = JoinedArms::default();
        for meeting in meetings {
            let meeting: Vec<Arm> = meeting.iter().map(|&(_, arm)| arm).collect();
            if !matches!(meeting[..], [_] | [_, _]) || !is_bend(&meeting) {
                streets.groups(meeting).iter().for_each(|group| joined.join(streets, group));
            }
        }
        joined
    };
    let joined: Vec<JoinedArms> = meetings.par_chunks(MEETINGS).map(joined).collect();
    let mut network = StreetNetwork {
        continuations: vec![Continuations::default(); streets.0.len()],
        links: Vec::new(),
        nodes: Vec::new(),
    };
    for JoinedArms { links, nodes } in joined {
        links.into_iter().for_each(|link| network.link(streets, link));
        network.nodes.extend(nodes);
    }
    network
}

/// Whether all arms are one street's that passes.
fn is_bend(arms: &[Arm]) -> bool {
    arms.iter().all(|arm| arm.street == arms[0].street && arm.vertex == arms[0].vertex)
}

/// What comes of the arms that meet at some places.
#[derive(Default)]
struct JoinedArms {
    /// The pairs that continue each other.
    links: Vec<[Arm; 2]>,
    nodes: Vec<JunctionNode>,
}

impl JoinedArms {
    /// Joins the arms that meet at one place.
    fn join(&mut self, streets: Streets<'_>, arms: &[Arm]) {
        let best = streets.best(arms);
        let (better, lesser): (Vec<Arm>, Vec<Arm>) = arms.iter().partition(|arm| streets.rank(arm) == best);
        match arms {
            &[a, b] if streets.go_on([a, b]) => self.links.push([a, b]),
            _ if is_bend(arms) => {}
            _ => {
                let (above, below) = match better[..] {
                    _ if is_bend(&better) && better.len() == 2 => (None, Some(arms)),
                    [a, b] if streets.go_on([a, b]) => {
                        self.links.push([a, b]);
                        (None, Some(arms))
                    }
                    // A better road that ends among lesser ones takes them in.
                    [_] => (Some(arms), None),
                    _ => (Some(&better[..]), Some(arms).filter(|_| !lesser.is_empty())),
                };
                above.into_iter().for_each(|arms| self.add_node(streets, arms, best));
                below.into_iter().for_each(|arms| self.add_node(streets, arms, streets.best(&lesser)));
            }
        }
    }

    fn add_node(&mut self, streets: Streets<'_>, arms: &[Arm], rank: u8) {
        let on_ground = arms.iter().filter(|arm| streets.0[arm.street].alignment.is_on_ground());
        let widest = on_ground.max_by(|a, b| {
            let by_width = streets.half_m(a).total_cmp(&streets.half_m(b));
            by_width.then(b.street.cmp(&a.street))
        });
        let Some(widest) = widest else { return };
        let outline = streets.hull(arms);
        if !outline.is_empty() {
            self.nodes.push(JunctionNode { outline, street: widest.street, rank });
        }
    }
}

impl StreetNetwork {
    fn link(&mut self, streets: Streets<'_>, [a, b]: [Arm; 2]) {
        for (arm, other) in [(a, b), (b, a)] {
            let ends = &mut self.continuations[arm.street];
            let beyond = Some(streets.0[other.street].points()[other.next]);
            match arm.end().end {
                0 => ends.before = beyond,
                _ => ends.after = beyond,
            }
        }
        self.links.push([a.end(), b.end()]);
    }
}

impl Arm {
    /// The end it leaves; only for arms that do not pass.
    fn end(&self) -> LineEnd {
        LineEnd { line: self.street, end: usize::from(self.vertex > 0) }
    }
}

/// What the arms' numbers mean.
#[derive(Clone, Copy)]
struct Streets<'a>(&'a [&'a Street]);

impl Streets<'_> {
    /// The arms of a street, with the place each leaves.
    fn arms(&self, street: usize) -> impl Iterator<Item = (VertexKey, Arm)> + '_ {
        let points = self.0[street].points();
        points.iter().enumerate().flat_map(move |(vertex, &at)| {
            let next = [vertex.checked_sub(1), (vertex + 1 < points.len()).then_some(vertex + 1)];
            let arm = move |next| (vertex_key(at), Arm { street, vertex, next });
            next.into_iter().flatten().map(arm)
        })
    }

    /// The arms at one vertex by what meets: streets that pass on one level with those that end there. An end of
    /// another level continues what passes on the ground.
    fn groups(&self, arms: Vec<Arm>) -> Vec<Vec<Arm>> {
        let level = |arm: &Arm| self.0[arm.street].level;
        let first = level(&arms[0]);
        if arms.iter().all(|arm| level(arm) == first) {
            return vec![arms];
        }
        let (mut ends, passing): (Vec<Arm>, Vec<Arm>) = arms.into_iter().partition(|arm| self.is_end(arm));
        let mut levels: Vec<i32> = passing.iter().map(level).collect();
        levels.sort_unstable_by_key(|&level| (level.abs(), level));
        levels.dedup();
        let mut groups: Vec<Vec<Arm>> = levels
            .iter()
            .map(|&passed| {
                let same = |arm: &Arm| level(arm) == passed;
                passing.iter().copied().filter(same).chain(ends.extract_if(.., |arm| same(arm))).collect()
            })
            .collect();
        let carrying =
            |group: &&mut Vec<Arm>| group.iter().any(|arm| self.0[arm.street].alignment.is_on_ground());
        match groups.iter_mut().find(carrying) {
            Some(group) => group.append(&mut ends),
            None => groups.push(ends),
        }
        groups.retain(|group| !group.is_empty());
        groups
    }

    fn is_end(&self, arm: &Arm) -> bool {
        arm.vertex == 0 || arm.vertex + 1 == self.0[arm.street].points().len()
    }

    fn half_m(&self, arm: &Arm) -> f64 {
        let alignment = &self.0[arm.street].alignment;
        alignment.width.at(alignment.line.stations()[arm.vertex]) / 2.0
    }

    fn rank(&self, arm: &Arm) -> u8 {
        self.0[arm.street].surface.rank()
    }

    fn best(&self, arms: &[Arm]) -> u8 {
        arms.iter().map(|arm| self.rank(arm)).max().unwrap_or_default()
    }

    /// Whether two ends make one ribbon.
    fn go_on(&self, [a, b]: [Arm; 2]) -> bool {
        let (one, other) = (self.0[a.street], self.0[b.street]);
        let half_m = self.half_m(&a);
        let limit = one.options.miter_limit.min(other.options.miter_limit);
        let points = [one.points()[a.next], one.points()[a.vertex], other.points()[b.next]];
        self.is_end(&a)
            && self.is_end(&b)
            && (half_m - self.half_m(&b)).abs() < SAME_WIDTH_M
            && LineBend { points, half: half_m }.mitered(limit).is_some()
    }

    fn hull(&self, arms: &[Arm]) -> Vec<DVec2> {
        let points = |arm: &Arm| self.0[arm.street].points();
        let at = points(&arms[0])[arms[0].vertex];
        let way = |arm: &Arm| points(arm)[arm.next] - at;
        let mut around: Vec<HullArm> = arms
            .iter()
            .map(|arm| HullArm {
                along: way(arm).normalize_or_zero(),
                half_m: self.half_m(arm),
                // An arm shorter than the junction lies in it as a whole.
                longest_m: if self.0[arm.street].alignment.is_on_ground() { way(arm).length() } else { 0.0 },
            })
            .collect();
        let turn = |spoke: &HullArm| libm::atan2(spoke.along.y, spoke.along.x);
        around.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
        let widest = around.iter().map(|spoke| spoke.half_m).fold(0.0, f64::max);
        let mut corners = Vec::with_capacity(2 * around.len());
        for (index, spoke) in around.iter().enumerate() {
            let neighbors =
                [&around[(index + 1) % around.len()], &around[(index + around.len() - 1) % around.len()]];
            let wanted = neighbors.into_iter().map(|other| spoke.curbs_meet(other)).fold(0.0, f64::max);
            let reach = wanted.min(2.0 * widest * LONGEST_REACH).min(spoke.longest_m);
            let (end, aside) = (at + spoke.along * reach, spoke.along.perp() * spoke.half_m);
            corners.extend([end + aside, end - aside]);
        }
        convex::hull(&corners)
    }
}

/// An arm as the hull sees it.
struct HullArm {
    along: DVec2,
    half_m: f64,
    longest_m: f64,
}

impl HullArm {
    /// How far along the arm its curb meets that of a neighbor; 0 where they part. For arms that are nearly one line at
    /// most half of the wider one's width.
    fn curbs_meet(&self, other: &Self) -> f64 {
        let (sine, cosine) = (self.along.perp_dot(other.along).abs(), self.along.dot(other.along));
        if sine < 1e-9 {
            return 0.0;
        }
        let meet = (other.half_m + self.half_m * cosine) / sine;
        if cosine < 0.0 { meet.min(self.half_m.max(other.half_m)) } else { meet }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::PlanMesh;
    use crate::stroke::{StrokePath, stroke};
    use sandtable_earthworks::alignment::Support;
    use sandtable_geom::polygon;
    use sandtable_geom::polyline::Polyline;

    fn line(points: &[(f64, f64)]) -> Polyline {
        Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line")
    }

    fn street(line: Polyline, width_m: f64) -> Street {
        let alignment = Alignment::on_ground(line, width_m);
        Street {
            alignment,
            width_m,
            options: StrokeOptions::default(),
            level: 0,
            surface: RibbonSurface::Track,
        }
    }

    fn connected(streets: &[Street]) -> StreetNetwork {
        connect(&streets.iter().collect::<Vec<_>>())
    }

    fn network(lines: &[Polyline], widths: &[f64]) -> StreetNetwork {
        let streets = lines.iter().zip(widths).map(|(line, &width_m)| street(line.clone(), width_m));
        connected(&streets.collect::<Vec<_>>())
    }

    fn area(node: &JunctionNode) -> f64 {
        polygon::doubled_area(&node.outline) / 2.0
    }

    #[test]
    fn two_ends_of_one_width_go_on_in_one_another() {
        let lines = [line(&[(0.0, 0.0), (50.0, 0.0)]), line(&[(100.0, 20.0), (50.0, 0.0)])];
        let joined = network(&lines, &[6.0, 6.0]);
        assert!(joined.nodes.is_empty());
        assert_eq!(
            joined.continuations[0],
            Continuations { before: None, after: Some(DVec2::new(100.0, 20.0)) }
        );
        assert_eq!(joined.continuations[1].after, Some(DVec2::ZERO));
        assert_eq!(joined.links, [[0, 1].map(|line| LineEnd { line, end: 1 })]);
        let mut area = 0.0;
        for (line, beyond) in lines.iter().zip(&joined.continuations) {
            let mut plan = PlanMesh::default();
            let alignment = Alignment::on_ground(line.clone(), 6.0);
            let path = StrokePath { beyond: *beyond, ..StrokePath::alone(&alignment) };
            stroke(&path, &StrokeOptions::default(), &mut plan);
            area += plan.area_m2();
        }
        assert!(
            (area - 6.0 * (lines[0].length() + lines[1].length())).abs() < 1e-9,
            "no gap, no overlap: {area}"
        );
    }

    #[test]
    fn a_t_is_cut_where_the_curbs_meet() {
        for quarter in 0..4 {
            let turned = |points: &[(f64, f64)]| -> Polyline {
                line(&points.iter().map(|&p| (0..quarter).fold(p, |(x, y), _| (-y, x))).collect::<Vec<_>>())
            };
            let lines =
                [turned(&[(-50.0, 0.0), (0.0, 0.0), (50.0, 0.0)]), turned(&[(0.0, 0.0), (0.0, 60.0)])];
            let joined = network(&lines, &[8.0, 6.0]);
            assert_eq!(joined.nodes.len(), 1);
            assert!((area(&joined.nodes[0]) - 48.0).abs() < 1e-9, "6 m by 8 m: {}", area(&joined.nodes[0]));
            assert_eq!(joined.nodes[0].street, 0, "the wider one");
        }
    }

    #[test]
    fn a_small_angle_makes_no_spike() {
        let lines = [
            line(&[(0.0, 0.0), (300.0, 0.0)]),
            line(&[(0.0, 0.0), (300.0, 9.0)]),
            line(&[(0.0, 0.0), (-90.0, 0.0)]),
        ];
        let joined = network(&lines, &[6.0, 6.0, 6.0]);
        let farthest = polygon::bounds(&joined.nodes[0].outline).max.x;
        assert!(farthest <= 6.0 * LONGEST_REACH + 3.0, "{farthest}");
    }

    #[test]
    fn nearly_straight_arms_of_unequal_width_meet_in_a_short_junction() {
        let lines = [line(&[(-300.0, 0.0), (0.0, 0.0)]), line(&[(0.0, 0.0), (300.0, 3.0)])];
        let joined = network(&lines, &[6.0, 14.0]);
        let size = polygon::bounds(&joined.nodes[0].outline).size();
        assert!(size.x <= 14.1, "{size}");
    }

    #[test]
    fn a_better_road_goes_through_and_a_lesser_one_s_junction_lies_below() {
        let lines = [
            line(&[(-50.0, 0.0), (0.0, 0.0)]),
            line(&[(50.0, 0.0), (0.0, 0.0)]),
            line(&[(0.0, 0.0), (0.0, 60.0)]),
        ];
        let mut streets = lines.map(|line| street(line, 6.0));
        streets[0].surface = RibbonSurface::Asphalt;
        streets[1].surface = RibbonSurface::Asphalt;
        let joined = connected(&streets);
        assert_eq!(joined.continuations[0].after, Some(DVec2::X * 50.0));
        assert_eq!(joined.nodes.iter().map(|node| node.rank).collect::<Vec<_>>(), [0]);
        streets[1].surface = RibbonSurface::Track;
        let joined = connected(&streets);
        assert!(joined.links.is_empty());
        assert_eq!(
            joined.nodes.iter().map(|node| node.rank).collect::<Vec<_>>(),
            [2],
            "it ends: all meet on its like"
        );
    }

    #[test]
    fn a_bridge_goes_on_in_the_road_before_it_and_meets_nothing_that_passes_below() {
        let lines = [
            line(&[(-50.0, 0.0), (0.0, 0.0)]),
            line(&[(0.0, 0.0), (40.0, 5.0), (80.0, 0.0)]),
            line(&[(40.0, -60.0), (40.0, 5.0), (40.0, 60.0)]),
        ];
        let mut streets = lines.map(|line| street(line, 6.0));
        streets[1].alignment.support = Support::Bridge;
        streets[1].level = 1;
        let joined = connected(&streets);
        assert_eq!(joined.continuations[0].after, Some(DVec2::new(40.0, 5.0)));
        assert_eq!(joined.continuations[1].before, Some(DVec2::X * -50.0));
        assert!(joined.nodes.is_empty(), "an overpass is no junction: {:?}", joined.nodes);
    }

    #[test]
    fn a_junction_does_not_reach_onto_a_bridge() {
        let lines = [
            line(&[(-50.0, 30.0), (0.0, 0.0)]),
            line(&[(-50.0, -30.0), (0.0, 0.0)]),
            line(&[(0.0, 0.0), (80.0, 0.0)]),
        ];
        let mut streets = lines.map(|line| street(line, 6.0));
        streets[2].alignment.support = Support::Bridge;
        streets[2].level = 1;
        let joined = connected(&streets);
        assert_eq!(joined.nodes.len(), 1);
        let farthest = polygon::bounds(&joined.nodes[0].outline).max.x;
        assert!(farthest < 3.1, "{farthest}");
    }

    #[test]
    fn roads_of_two_levels_that_pass_a_vertex_do_not_meet() {
        let lines =
            [line(&[(-50.0, 0.0), (0.0, 0.0), (50.0, 0.0)]), line(&[(0.0, -50.0), (0.0, 0.0), (0.0, 50.0)])];
        let mut streets = lines.map(|line| street(line, 6.0));
        assert_eq!(connected(&streets).nodes.len(), 1);
        streets[1].level = 1;
        assert_eq!(connected(&streets).nodes, []);
    }
}

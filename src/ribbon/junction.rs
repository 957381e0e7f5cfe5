//! Where roads meet: which lines go on in one another, and the surface that joins those that do not.
//!
//! Lines that share a vertex meet there. Where two ends of one width meet and nothing else does, the ribbons go on in
//! one another and share an edge. Where three or more arms meet, and where two do that cannot go on, the junction is the
//! hull of all arms cut square where the kerbs of neighbouring arms meet:
//!
//! ```text
//!          │   │
//!          │   │            ─── the arms' kerbs
//!   ───────┼───┼───         a junction of three arms: cut where the kerbs
//!          │ J │            meet, so that the whole width has no markings
//!   ───────┴───┴───
//! ```
//!
//! Lines that cross without a shared vertex are joined where they cover the same ground. Ribbons lose what the junction
//! covers by [`crate::ribbon::partition`], and their markings stop there.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::geom::polyline::Polyline;
use crate::geom::region::Region;
use crate::ribbon::joint::Bend;
use crate::ribbon::plan::PlanMesh;
use crate::ribbon::stroke::{Continuations, StrokeOptions};

/// Vertices nearer to each other than this are one, in metres: files that mean one point write the same numbers, up to
/// the rounding of a change of system.
const SAME_M: f64 = 0.01;

/// How far a junction may reach along an arm, in widths of its widest arm: where two arms leave at a small angle their
/// kerbs meet far away, and the ground between them is better left to their ribbons.
const LONGEST_REACH: f64 = 2.5;

/// A road as lines go: a centreline and the width about it.
#[derive(Clone, Copy, Debug)]
pub struct Street<'a> {
    /// The centreline.
    pub line: &'a Polyline,
    /// Metres from kerb to kerb.
    pub options: StrokeOptions,
}

/// Streets with what they meet.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// For each street, what goes on at its ends.
    pub continuations: Vec<Continuations>,
    /// The hulls of the nodes where streets do not simply go on.
    pub nodes: Vec<Region>,
}

/// What leaves a node along one street.
#[derive(Clone, Copy, Debug)]
struct Arm {
    street: usize,
    /// The street's vertex at the node.
    vertex: usize,
    /// Its next vertex, away from the node.
    next: DVec2,
}

/// Finds which streets go on in one another, and the nodes of those that do not.
pub fn connect(streets: &[Street<'_>]) -> Network {
    let mut meetings: BTreeMap<(i64, i64), Vec<Arm>> = BTreeMap::new();
    for (index, street) in streets.iter().enumerate() {
        let points = street.line.points();
        for (vertex, &at) in points.iter().enumerate() {
            let place = (at / SAME_M).round();
            let arms = meetings.entry((place.x as i64, place.y as i64)).or_default();
            let neighbours = [vertex.checked_sub(1), (vertex + 1 < points.len()).then_some(vertex + 1)];
            let arm = |next: usize| Arm { street: index, vertex, next: points[next] };
            arms.extend(neighbours.into_iter().flatten().map(arm));
        }
    }
    let mut network =
        Network { continuations: vec![Continuations::default(); streets.len()], nodes: Vec::new() };
    for arms in meetings.values() {
        network.join(streets, arms);
    }
    network
}

impl Network {
    fn join(&mut self, streets: &[Street<'_>], arms: &[Arm]) {
        let is_bend = |[a, b]: [Arm; 2]| a.street == b.street && a.vertex == b.vertex;
        match *arms {
            [] | [_] => {}
            [a, b] if is_bend([a, b]) => {}
            [a, b] if goes_on(streets, [a, b]) => {
                for (arm, other) in [(a, b), (b, a)] {
                    let ends = &mut self.continuations[arm.street];
                    let end = if arm.vertex == 0 { &mut ends.before } else { &mut ends.after };
                    *end = Some(other.next);
                }
            }
            _ => self.nodes.push(hull(streets, arms)),
        }
    }
}

/// Whether two ends make one ribbon.
fn goes_on(streets: &[Street<'_>], [a, b]: [Arm; 2]) -> bool {
    let (one, other) = (&streets[a.street], &streets[b.street]);
    let at = one.line.points()[a.vertex];
    let bend = Bend { points: [a.next, at, b.next], half_m: one.options.width_m / 2.0 };
    one.options == other.options && bend.mitred(one.options.mitre_limit).is_some()
}

/// The junction of several arms.
fn hull(streets: &[Street<'_>], arms: &[Arm]) -> Region {
    let at = streets[arms[0].street].line.points()[arms[0].vertex];
    let half = |arm: &Arm| streets[arm.street].options.width_m / 2.0;
    let direction = |arm: &Arm| (arm.next - at).normalize_or_zero();
    let mut around: Vec<&Arm> = arms.iter().collect();
    let turn = |arm: &Arm| libm::atan2(direction(arm).y, direction(arm).x);
    around.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
    let widest = arms.iter().map(half).fold(0.0, f64::max);
    let mut corners = Vec::with_capacity(2 * arms.len());
    for (index, arm) in around.iter().enumerate() {
        let neighbours =
            [around[(index + 1) % around.len()], around[(index + around.len() - 1) % around.len()]];
        let meets = |other: &Arm| kerbs_meet((direction(arm), half(arm)), (direction(other), half(other)));
        let wanted = neighbours.into_iter().map(meets).fold(0.0, f64::max);
        // An arm shorter than the junction is the junction's whole.
        let reach = wanted.min(2.0 * widest * LONGEST_REACH).min(arm.next.distance(at));
        let aside = direction(arm).perp() * half(arm);
        corners.extend([at + direction(arm) * reach + aside, at + direction(arm) * reach - aside]);
    }
    Region::hull(&corners)
}

/// How far along the first of two arms their kerbs meet, on the side where the arms are neighbours; 0 where they part.
fn kerbs_meet((along, half): (DVec2, f64), (other, other_half): (DVec2, f64)) -> f64 {
    let sine = along.perp_dot(other).abs();
    if sine < 1e-9 {
        return 0.0;
    }
    (other_half + half * along.dot(other)) / sine
}

/// The surface of all junctions: the nodes, and the ground that more than one of the ribbons covers.
pub fn surface<'a>(ribbons: impl IntoIterator<Item = &'a PlanMesh>, nodes: &[Region]) -> Region {
    let outline = |plan: &PlanMesh| {
        let triangles: Vec<[DVec2; 3]> =
            plan.corners().map(|corners| corners.map(|corner| corner.at)).collect();
        Region::covered(triangles.iter().map(|triangle| &triangle[..]))
    };
    let outlines: Vec<Region> = ribbons.into_iter().map(outline).collect();
    let crossings = Region::covered_twice(&outlines);
    Region::any_of(nodes.iter().chain([&crossings]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ribbon::stroke::stroke;

    fn line(points: &[(f64, f64)]) -> Polyline {
        Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line")
    }

    fn network(lines: &[Polyline], widths: &[f64]) -> Network {
        let street = |(line, &width_m)| Street {
            line,
            options: StrokeOptions { width_m, ..StrokeOptions::default() },
        };
        connect(&lines.iter().zip(widths).map(street).collect::<Vec<_>>())
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
        let mut area = 0.0;
        for (line, beyond) in lines.iter().zip(&joined.continuations) {
            let mut plan = PlanMesh::default();
            stroke(line, *beyond, &StrokeOptions { width_m: 6.0, ..StrokeOptions::default() }, &mut plan);
            area += plan.area_m2();
        }
        assert!(
            (area - 6.0 * (lines[0].length() + lines[1].length())).abs() < 1e-9,
            "no gap, no overlap: {area}"
        );
    }

    #[test]
    fn a_t_is_cut_where_the_kerbs_meet() {
        for quarter in 0..4 {
            let turned = |points: &[(f64, f64)]| -> Polyline {
                line(&points.iter().map(|&p| (0..quarter).fold(p, |(x, y), _| (-y, x))).collect::<Vec<_>>())
            };
            let lines =
                [turned(&[(-50.0, 0.0), (0.0, 0.0), (50.0, 0.0)]), turned(&[(0.0, 0.0), (0.0, 60.0)])];
            let joined = network(&lines, &[8.0, 6.0]);
            assert_eq!(joined.nodes.len(), 1);
            assert!((joined.nodes[0].area() - 48.0).abs() < 1e-9, "6 m by 8 m: {}", joined.nodes[0].area());
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
        assert!(joined.nodes[0].bounds().max.x <= 6.0 * LONGEST_REACH + 3.0);
    }

    #[test]
    fn streets_that_cross_without_a_vertex_are_joined_where_they_cover_the_same() {
        let lines = [line(&[(-50.0, 0.0), (50.0, 0.0)]), line(&[(0.0, -50.0), (0.0, 60.0)])];
        let joined = network(&lines, &[8.0, 6.0]);
        let plans: Vec<PlanMesh> = lines
            .iter()
            .zip([8.0, 6.0])
            .map(|(line, width_m)| {
                let mut plan = PlanMesh::default();
                let options = StrokeOptions { width_m, ..StrokeOptions::default() };
                stroke(line, Continuations::default(), &options, &mut plan);
                plan
            })
            .collect();
        let joint = surface(&plans, &joined.nodes);
        assert!((joint.area() - 48.0).abs() < 1e-6, "{}", joint.area());
    }
}

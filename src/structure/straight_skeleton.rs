//! The straight skeleton of a polygon (Aichholzer and Aurenhammer 1996): the faces of the roof whose eaves are the
//! polygon's sides, each rising at the same pitch.
//!
//! ```text
//!   ●───────────────●     all sides move inward at the same speed; their corners leave the hips and valleys
//!   │ ╲           ╱ │
//!   │   ○───○   ╱   │     edge event    a side has shrunk to a point: its corners become one
//!   │   │     ╲│    │     split event   an inward corner meets a side: the front falls apart
//!   │   │  ●───●────●
//!   │ ╱ │  │              a side's face is what it has swept: closed by construction, since a corner leaves the
//!   ●───●──●              same line to the faces on both its sides
//! ```
//!
//! The next event is looked for among all, which takes the cube of the number of sides: footprints have few. On plans full
//! of right angles many events coincide, and rounding may put them in an order that no front can have. Then the faces do
//! not close or do not cover the polygon, which is checked, and the sides are tried again at speeds that differ by parts
//! of a thousand: faces stay flat, and coincidences are gone.

use glam::{DVec2, DVec3};

use sandtable_geom::polygon;

/// The most sides: see above.
const MOST_SIDES: usize = 64;

/// Nodes nearer to each other than this are one, in meters.
const WELD_M: f64 = 2e-3;

/// Lengths and times below this are rounding, in meters.
const ROUNDING_M: f64 = 1e-7;

/// Sines below this are those of parallel sides.
const PARALLEL: f64 = 1e-9;

/// By which part the speeds of sides differ from try to try.
const UNEVEN: [f64; 4] = [0.0, 1e-3, -2e-3, 5e-3];

/// How much of the polygon's area the faces may leave open or cover twice, relative to it.
const AREA_ERROR: f64 = 1e-4;

/// The faces over the sides of a simple, counter-clockwise ring, each counter-clockwise from the start of its side: X, Y
/// and the distance from the side. `None` for rings of more than 64 sides and where no try succeeds.
pub fn faces(ring: &[DVec2]) -> Option<Vec<Vec<DVec3>>> {
    if ring.len() < 3 || ring.len() > MOST_SIDES {
        return None;
    }
    UNEVEN.into_iter().find_map(|uneven| {
        let faces = Wavefront::new(ring, uneven)?.shrink()?;
        covers(&faces, ring).then_some(faces)
    })
}

/// Whether all faces look up and together cover as much as the ring encloses.
fn covers(faces: &[Vec<DVec3>], ring: &[DVec2]) -> bool {
    let plan = |face: &Vec<DVec3>| -> Vec<DVec2> { face.iter().map(|at| at.truncate()).collect() };
    let areas: Vec<f64> = faces.iter().map(|face| polygon::doubled_area(&plan(face))).collect();
    let (sum, whole) = (areas.iter().sum::<f64>(), polygon::doubled_area(ring));
    areas.iter().all(|&area| area > 0.0) && (sum - whole).abs() <= AREA_ERROR * whole
}

/// A side as it moves inward.
#[derive(Clone, Copy)]
struct MovingSide {
    from: DVec2,
    along: DVec2,
    inward: DVec2,
    /// Near to 1.
    speed: f64,
}

/// A corner of the front between two sides.
#[derive(Clone, Copy)]
struct FrontCorner {
    at: DVec2,
    since: f64,
    velocity: DVec2,
    /// The sides that it ends and begins.
    left: usize,
    right: usize,
    previous: usize,
    next: usize,
    /// Where it began.
    node: usize,
    is_active: bool,
}

#[derive(Clone, Copy)]
enum FrontEvent {
    /// The side after a corner has shrunk to a point.
    Edge(usize),
    /// A corner meets the side after another.
    Split(usize, usize),
}

struct Wavefront {
    sides: Vec<MovingSide>,
    corners: Vec<FrontCorner>,
    nodes: Vec<DVec3>,
    /// The border of each side's face, as pairs of nodes.
    borders: Vec<Vec<[usize; 2]>>,
    now: f64,
}

impl MovingSide {
    /// How far a point is before the side at a time.
    fn distance_m(&self, at: DVec2, time: f64) -> f64 {
        self.inward.dot(at - self.from) - self.speed * time
    }
}

impl FrontCorner {
    fn at(&self, time: f64) -> DVec2 {
        self.at + self.velocity * (time - self.since)
    }
}

impl Wavefront {
    fn new(ring: &[DVec2], uneven: f64) -> Option<Self> {
        let count = ring.len();
        let side = |(index, (from, to)): (usize, (DVec2, DVec2))| {
            let along = (to - from).try_normalize()?;
            // Any numbers that no two sides share.
            let speed = 1.0 + uneven * libm::sin(index as f64 * 2.4 + 1.0);
            Some(MovingSide { from, along, inward: along.perp(), speed })
        };
        let sides = polygon::edges(ring).enumerate().map(side).collect::<Option<Vec<_>>>()?;
        let mut front = Self {
            sides,
            corners: Vec::with_capacity(4 * count),
            nodes: ring.iter().map(|at| at.extend(0.0)).collect(),
            borders: (0..count).map(|side| vec![[side, (side + 1) % count]]).collect(),
            now: 0.0,
        };
        for index in 0..count {
            let before = (index + count - 1) % count;
            front.add_corner(index, [before, index], [before, (index + 1) % count]);
        }
        Some(front)
    }

    /// A new corner from a node on between two sides.
    fn add_corner(&mut self, node: usize, [left, right]: [usize; 2], links: [usize; 2]) -> usize {
        let (a, b) = (self.sides[left], self.sides[right]);
        let sine = a.inward.perp_dot(b.inward);
        let velocity = if sine.abs() > PARALLEL {
            // Both sides keep to it: inward · velocity is the speed.
            (b.inward.perp() * -a.speed + a.inward.perp() * b.speed) / sine
        } else if a.inward.dot(b.inward) > 0.0 {
            a.inward * a.speed
        } else {
            // They have met: the rest of the front between them ends now too.
            DVec2::ZERO
        };
        let [previous, next] = links;
        let at = self.nodes[node].truncate();
        let corner =
            FrontCorner { at, since: self.now, velocity, left, right, previous, next, node, is_active: true };
        self.corners.push(corner);
        self.corners.len() - 1
    }

    /// Moves the front until nothing is left of it; the faces that its sides have swept.
    fn shrink(mut self) -> Option<Vec<Vec<DVec3>>> {
        // Every event ends a corner for good, and a split adds one more.
        for _ in 0..4 * self.sides.len() {
            if !self.corners.iter().any(|corner| corner.is_active) {
                return (0..self.sides.len()).map(|side| self.face(side)).collect();
            }
            let (time, event) = self.next_event()?;
            self.now = self.now.max(time);
            match event {
                FrontEvent::Edge(corner) => self.join(corner),
                FrontEvent::Split(corner, other) => self.split(corner, other),
            }
        }
        None
    }

    fn active(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.corners.len()).filter(|&corner| self.corners[corner].is_active)
    }

    fn next_event(&self) -> Option<(f64, FrontEvent)> {
        let edges =
            self.active().filter_map(|corner| Some((self.edge_time(corner)?, FrontEvent::Edge(corner))));
        let inward = self.active().filter(|&corner| self.is_inward(corner));
        let splits = inward.flat_map(|corner| {
            let time = move |other| Some((self.split_time(corner, other)?, FrontEvent::Split(corner, other)));
            self.active().filter_map(time)
        });
        // Of events at the same time, edge events first: they make the front simpler.
        edges.chain(splits).reduce(|first, next| if next.0 < first.0 - ROUNDING_M { next } else { first })
    }

    /// When the side after a corner has shrunk to a point; `None` where it does not shrink.
    fn edge_time(&self, corner: usize) -> Option<f64> {
        let here = &self.corners[corner];
        let next = &self.corners[here.next];
        let along = self.sides[here.right].along;
        let length_m = along.dot(next.at(self.now) - here.at(self.now));
        let growth = along.dot(next.velocity - here.velocity);
        if length_m <= ROUNDING_M {
            return Some(self.now);
        }
        (growth < -PARALLEL).then(|| self.now - length_m / growth)
    }

    fn is_inward(&self, corner: usize) -> bool {
        let FrontCorner { left, right, .. } = self.corners[corner];
        self.sides[left].along.perp_dot(self.sides[right].along) < -PARALLEL
    }

    /// When a corner meets the side after another between its ends; `None` where it does not.
    fn split_time(&self, corner: usize, other: usize) -> Option<f64> {
        let (here, start) = (&self.corners[corner], &self.corners[other]);
        let side = &self.sides[start.right];
        if [here.left, here.right].contains(&start.right) {
            return None;
        }
        let distance_m = side.distance_m(here.at(self.now), self.now);
        let approach = side.speed - side.inward.dot(here.velocity);
        if distance_m < -ROUNDING_M || approach <= PARALLEL {
            return None;
        }
        let time = self.now + (distance_m / approach).max(0.0);
        let at = here.at(time);
        let end = &self.corners[start.next];
        let is_between = side.along.dot(at - start.at(time)) >= -ROUNDING_M
            && side.along.dot(end.at(time) - at) >= -ROUNDING_M;
        is_between.then_some(time)
    }

    /// The corners of a side that has shrunk to a point become one.
    fn join(&mut self, corner: usize) {
        let first = self.corners[corner];
        let second = self.corners[first.next];
        let middle = (first.at(self.now) + second.at(self.now)) / 2.0;
        let node = self.node(middle);
        self.end(corner, node);
        self.end(first.next, node);
        if second.next == first.previous {
            // A triangle's third corner.
            self.end(second.next, node);
            return;
        }
        let links = [first.previous, second.next];
        self.link(node, [first.left, second.right], links);
    }

    /// A corner meets the side after another: the front falls apart there.
    fn split(&mut self, corner: usize, other: usize) {
        let here = self.corners[corner];
        let start = self.corners[other];
        let node = self.node(here.at(self.now));
        self.end(corner, node);
        self.link(node, [here.left, start.right], [here.previous, start.next]);
        self.link(node, [start.right, here.right], [other, here.next]);
    }

    /// Puts a corner between two others. What is left of a front of two corners is a ridge between them.
    fn link(&mut self, node: usize, sides: [usize; 2], [previous, next]: [usize; 2]) {
        if previous == next {
            let last = self.corners[previous];
            let end = self.node(last.at(self.now));
            self.end(previous, end);
            let [left, right] = sides;
            if end != node {
                self.borders[right].push([end, node]);
                self.borders[left].push([node, end]);
            }
            return;
        }
        let corner = self.add_corner(node, sides, [previous, next]);
        self.corners[previous].next = corner;
        self.corners[next].previous = corner;
    }

    /// Ends a corner at a node: its way borders the faces of both its sides.
    fn end(&mut self, corner: usize, node: usize) {
        let FrontCorner { left, right, node: from, .. } = self.corners[corner];
        self.corners[corner].is_active = false;
        if from != node {
            self.borders[left].push([from, node]);
            self.borders[right].push([node, from]);
        }
    }

    /// The node at a place now: a known one where one is near.
    fn node(&mut self, at: DVec2) -> usize {
        let at = at.extend(self.now);
        let known = self.nodes.iter().position(|node| node.distance_squared(at) < WELD_M * WELD_M);
        known.unwrap_or_else(|| {
            self.nodes.push(at);
            self.nodes.len() - 1
        })
    }

    /// The face of a side, from its start on; `None` where its border is not one ring.
    fn face(&self, side: usize) -> Option<Vec<DVec3>> {
        let border = &self.borders[side];
        let mut face = Vec::with_capacity(border.len());
        let mut at = border[0][0];
        for _ in 0..border.len() {
            face.push(self.nodes[at]);
            let mut after = border.iter().filter(|piece| piece[0] == at);
            let piece = after.next()?;
            if after.next().is_some() {
                return None;
            }
            at = piece[1];
            if at == border[0][0] {
                break;
            }
        }
        (at == border[0][0] && face.len() == border.len() && face.len() > 2).then_some(face)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURNS: [f64; 4] = [0.0, 33.0, 90.0, 217.0];

    fn turned(points: &[(f64, f64)], turn_deg: f64) -> Vec<DVec2> {
        let turn = DVec2::from_angle(turn_deg.to_radians());
        points.iter().map(|&(x, y)| turn.rotate(DVec2::new(x, y))).collect()
    }

    fn highest(faces: &[Vec<DVec3>]) -> f64 {
        faces.iter().flatten().map(|at| at.z).fold(0.0, f64::max)
    }

    #[test]
    fn an_l_has_a_face_a_side_a_valley_and_the_run_of_its_wider_wing() {
        let bent = [(0.0, 0.0), (20.0, 0.0), (20.0, 6.0), (8.0, 6.0), (8.0, 20.0), (0.0, 20.0)];
        for turn in TURNS {
            let ring = turned(&bent, turn);
            let faces = faces(&ring).expect("a skeleton");
            assert_eq!(faces.len(), 6);
            assert!((highest(&faces) - 4.0).abs() < 0.05, "{}", highest(&faces));
            let valley = ring[3].extend(0.0);
            let at_valley = faces.iter().filter(|face| face.contains(&valley)).count();
            assert_eq!(at_valley, 2, "the faces on both sides of the inward corner");
        }
    }

    #[test]
    fn plans_whose_events_coincide_are_roofed_too() {
        let cross = [
            (4.0, 0.0),
            (8.0, 0.0),
            (8.0, 4.0),
            (12.0, 4.0),
            (12.0, 8.0),
            (8.0, 8.0),
            (8.0, 12.0),
            (4.0, 12.0),
            (4.0, 8.0),
            (0.0, 8.0),
            (0.0, 4.0),
            (4.0, 4.0),
        ];
        let t = [
            (0.0, 0.0),
            (18.0, 0.0),
            (18.0, 6.0),
            (12.0, 6.0),
            (12.0, 16.0),
            (6.0, 16.0),
            (6.0, 6.0),
            (0.0, 6.0),
        ];
        let u = [
            (0.0, 0.0),
            (18.0, 0.0),
            (18.0, 14.0),
            (12.0, 14.0),
            (12.0, 6.0),
            (6.0, 6.0),
            (6.0, 14.0),
            (0.0, 14.0),
        ];
        let equal = [(0.0, 0.0), (20.0, 0.0), (20.0, 6.0), (6.0, 6.0), (6.0, 20.0), (0.0, 20.0)];
        for turn in TURNS {
            for plan in [&cross[..], &t, &u, &equal] {
                let ring = turned(plan, turn);
                let faces = faces(&ring).unwrap_or_else(|| panic!("{plan:?} turned by {turn}"));
                assert_eq!(faces.len(), plan.len());
                assert!((2.0..4.5).contains(&highest(&faces)), "{}", highest(&faces));
            }
        }
    }

    #[test]
    fn faces_are_flat_and_rise_from_their_sides() {
        let bay = [
            (0.0, 0.0),
            (14.0, 0.0),
            (14.0, 9.0),
            (10.0, 9.0),
            (9.0, 11.0),
            (6.0, 11.0),
            (5.0, 9.0),
            (0.0, 9.0),
        ];
        let ring = turned(&bay, 12.0);
        let faces = faces(&ring).expect("a skeleton");
        for ((from, to), face) in polygon::edges(&ring).zip(&faces) {
            let inward = (to - from).normalize().perp();
            assert_eq!(face[..2], [from.extend(0.0), to.extend(0.0)]);
            for at in face {
                assert!((inward.dot(at.truncate() - from) - at.z).abs() < 0.01 * at.z + 0.01, "{at}");
            }
        }
    }

    #[test]
    fn too_many_sides_and_too_few_have_none() {
        let vertex = |index: u32| {
            let angle = f64::from(index) * std::f64::consts::TAU / 65.0;
            DVec2::new(libm::cos(angle), libm::sin(angle)) * 30.0
        };
        assert!(faces(&(0..65).map(vertex).collect::<Vec<_>>()).is_none());
        assert!(faces(&[DVec2::ZERO, DVec2::X]).is_none());
    }
}

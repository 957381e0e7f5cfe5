//! Breaklines: as edges of a triangulation, and as points along them.
//!
//! A breakline that crosses no other becomes edges. Where it crosses another away from their vertices, both are split
//! there, at the mean of the two heights. How often and how far the two disagree is reported: a stream that passes under
//! a road is no breakline to cross.

use glam::{DVec2, DVec3};
use spade::Triangulation;
use spade::handles::FixedVertexHandle;

use crate::gridding::sites::Sites;
use crate::gridding::web::{Constrained, TinVertex, vertex_of_site};

/// The most points along one segment of a breakline: a segment across the largest grid has fewer half cells.
const MOST_ALONG: f64 = 1e6;

/// The crossings of breaklines away from their vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossings {
    /// The number of crossings.
    pub count: usize,
    /// The greatest difference in height of two breaklines where they cross, in the points' vertical unit.
    pub largest_gap: f64,
}

/// Makes every segment of `lines`, whose vertices are sites, an edge or a row of edges.
pub(super) fn constrain(web: &mut Constrained, sites: &Sites, lines: &[Vec<DVec3>]) -> Crossings {
    let vertex_of_site = vertex_of_site(web, sites);
    let vertex = |at: &DVec3| sites.find(at.truncate()).map(|site| vertex_of_site[site]);
    let mut crossings = Crossings::default();
    for ends in lines.iter().flat_map(|line| line.windows(2)) {
        let (Some(from), Some(to)) = (vertex(&ends[0]), vertex(&ends[1])) else { continue };
        if from == to {
            continue;
        }
        // Adding an edge that crosses another panics.
        if web.can_add_constraint(from, to) {
            web.add_constraint(from, to);
        } else {
            split(web, from, to, &mut crossings);
        }
    }
    crossings
}

/// A segment with heights, for the point where another crosses it.
#[derive(Clone, Copy)]
struct BreaklineSegment {
    from: DVec3,
    to: DVec3,
}

impl BreaklineSegment {
    fn new(from: &TinVertex, to: &TinVertex) -> Self {
        Self { from: from.at.extend(from.z), to: to.at.extend(to.z) }
    }

    /// Its height at its point nearest to `at`, and the squared distance of that point.
    fn height(&self, at: DVec2) -> (f64, f64) {
        let (from, along) = (self.from.truncate(), self.to.truncate() - self.from.truncate());
        let part = ((at - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (self.from.z + part * (self.to.z - self.from.z), (from + along * part).distance_squared(at))
    }
}

/// Adds a segment that crosses others.
fn split(web: &mut Constrained, from: FixedVertexHandle, to: FixedVertexHandle, crossings: &mut Crossings) {
    let own = BreaklineSegment::new(web.vertex(from).data(), web.vertex(to).data());
    let crossed: Vec<BreaklineSegment> = web
        .get_conflicting_edges_between_vertices(from, to)
        .map(|edge| BreaklineSegment::new(edge.from().data(), edge.to().data()))
        .collect();
    let heights_at = |at: DVec2| {
        let nearest = crossed.iter().map(|other| other.height(at)).min_by(|a, b| a.1.total_cmp(&b.1));
        (own.height(at).0, nearest.map_or(own.height(at).0, |(height, _)| height))
    };
    let before = web.num_vertices();
    web.add_constraint_and_split(from, to, |at| {
        let at = DVec2::new(at.x, at.y);
        let (own, other) = heights_at(at);
        TinVertex { at, z: own + (other - own) * 0.5, site: None }
    });
    for vertex in web.vertices().skip(before) {
        let (own, other) = heights_at(vertex.data().at);
        crossings.count += 1;
        crossings.largest_gap = crossings.largest_gap.max((own - other).abs());
    }
}

/// The vertices of a breakline and points between them, at most `apart` apart.
pub(super) fn points_along(line: &[DVec3], apart: f64) -> Vec<DVec3> {
    let mut points: Vec<DVec3> = line.first().copied().into_iter().collect();
    for ends in line.windows(2) {
        let length = ends[0].truncate().distance(ends[1].truncate());
        let steps = (length / apart).ceil().clamp(1.0, MOST_ALONG) as u32;
        points.extend((1..steps).map(|step| ends[0].lerp(ends[1], f64::from(step) / f64::from(steps))));
        points.push(ends[1]);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_along_a_line_keep_its_vertices_and_its_slope() {
        let line = [DVec3::ZERO, DVec3::new(3.0, 4.0, 10.0), DVec3::new(3.0, 4.0, 10.0)];
        let points = points_along(&line, 2.0);
        assert_eq!(points.len(), 5);
        assert!(
            points.iter().all(|point| (point.z - point.truncate().length() * 2.0).abs() < 1e-12),
            "{points:?}"
        );
    }
}

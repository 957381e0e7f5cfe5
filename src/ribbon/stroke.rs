//! A centreline and a width to a ribbon in plan.
//!
//! Each segment becomes a quad; where two segments meet, both quads end on the mitre — the line that halves the
//! angle between them — so they share an edge. Where the mitre would reach further than its limit, or past a
//! short segment's other end, both end square and the gap on the outer side is filled with a bevel triangle:
//!
//! ```text
//!   mitre:   ────────╲           bevel:  ────────┬╲
//!            ──────╲  ╲                  ────────┘ ╲
//!                   ╲  ╲                      ╲    ╲
//! ```
//!
//! U runs from the left edge (0) to the right edge (1), V along the centreline in texture lengths.

use glam::{DVec2, Vec2};

use crate::geom::polyline::Polyline;
use crate::mesh::sink::{MeshSink, VertexId};
use crate::ribbon::plan::PlanVertex;

/// How a ribbon is stroked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeOptions {
    /// Width in metres, above 0. Default 6.
    pub width_m: f64,
    /// How long a mitre may be, in half widths, at least 1. Default 2: turns of up to 120 degrees keep their
    /// mitre; sharper ones would grow spikes.
    pub mitre_limit: f64,
    /// Metres along the centreline in one repeat of the texture, above 0. Default 12.
    pub texture_length_m: f64,
}

impl Default for StrokeOptions {
    fn default() -> Self {
        Self { width_m: 6.0, mitre_limit: 2.0, texture_length_m: 12.0 }
    }
}

/// The lines that go on where this one ends: the vertex of each beyond the one they share. Two ribbons of one width
/// that know of each other end on one edge, as if they were one ribbon.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Continuations {
    /// Before its first vertex; `None` where nothing goes on there.
    pub before: Option<DVec2>,
    /// After its last.
    pub after: Option<DVec2>,
}

/// Writes the ribbon along `line` to `sink`, triangles counter-clockwise.
///
/// Where a bevelled turn's inner sides overlap, both quads are there; [`crate::ribbon::partition`] takes them apart.
pub fn stroke(
    line: &Polyline,
    beyond: Continuations,
    options: &StrokeOptions,
    sink: &mut impl MeshSink<PlanVertex>,
) {
    let points = line.points();
    let last = points.len() - 1;
    let mut start = match shared_end(beyond.before, points[0], Some(points[1]), options) {
        Some(to_left) => edge_along(line, 0, to_left, options, sink),
        None => end_edge(line, 0, 0, options, sink),
    };
    for segment in 0..last {
        let end = if segment + 1 == last {
            Joint::Shared(match shared_end(Some(points[last - 1]), points[last], beyond.after, options) {
                Some(to_left) => edge_along(line, last, to_left, options, sink),
                None => end_edge(line, last, segment, options, sink),
            })
        } else {
            joint(line, segment + 1, options, sink)
        };
        let (closing, opening) = match end {
            Joint::Shared(edge) => (edge, edge),
            Joint::Split { before, after } => (before, after),
        };
        sink.triangle([start.left, start.right, closing.right]);
        sink.triangle([start.left, closing.right, closing.left]);
        start = opening;
    }
}

/// The two ends of a line across the ribbon.
#[derive(Clone, Copy)]
struct Edge {
    left: VertexId,
    right: VertexId,
}

/// What two segments end on.
enum Joint {
    Shared(Edge),
    Split { before: Edge, after: Edge },
}

/// The edge square to segment `segment` at vertex `index`.
fn end_edge(
    line: &Polyline,
    index: usize,
    segment: usize,
    options: &StrokeOptions,
    sink: &mut impl MeshSink<PlanVertex>,
) -> Edge {
    edge_along(line, index, direction(line, segment).perp() * (options.width_m / 2.0), options, sink)
}

fn edge_along(
    line: &Polyline,
    index: usize,
    to_left: DVec2,
    options: &StrokeOptions,
    sink: &mut impl MeshSink<PlanVertex>,
) -> Edge {
    let (at, v) = (line.points()[index], along(line, index, options));
    Edge {
        left: sink.vertex(PlanVertex { at: at + to_left, uv: Vec2::new(0.0, v) }),
        right: sink.vertex(PlanVertex { at: at - to_left, uv: Vec2::new(1.0, v) }),
    }
}

fn joint(
    line: &Polyline,
    index: usize,
    options: &StrokeOptions,
    sink: &mut impl MeshSink<PlanVertex>,
) -> Joint {
    let points = line.points();
    let (before, after) = (direction(line, index - 1), direction(line, index));
    if let Some(to_left) = mitred([points[index - 1], points[index], points[index + 1]], options) {
        return Joint::Shared(edge_along(line, index, to_left, options, sink));
    }
    let closing = end_edge(line, index, index - 1, options, sink);
    let opening = end_edge(line, index, index, options, sink);
    let center = PlanVertex { at: line.points()[index], uv: Vec2::new(0.5, along(line, index, options)) };
    let center = sink.vertex(center);
    if before.perp_dot(after) > 0.0 {
        sink.triangle([center, closing.right, opening.right]);
    } else {
        sink.triangle([center, opening.left, closing.left]);
    }
    Joint::Split { before: closing, after: opening }
}

/// The vector to the left end of the mitre, in half widths; `None` where the line turns back on itself.
fn mitre(before: DVec2, after: DVec2) -> Option<DVec2> {
    let sum = before.perp() + after.perp();
    let square = sum.length_squared();
    (square > 1e-12).then(|| sum * (2.0 / square))
}

/// The edge at `at` that a ribbon shares with the one that goes on there, as the way from the line to its left side.
fn shared_end(
    before: Option<DVec2>,
    at: DVec2,
    after: Option<DVec2>,
    options: &StrokeOptions,
) -> Option<DVec2> {
    mitred([before?, at, after?], options)
}

/// The way from the middle one of three vertices to the left side of a mitred ribbon; `None` where the mitre would be
/// longer than it may be, or its inner corner would reach beyond the middle of either segment, where the next one's may.
pub(in crate::ribbon) fn mitred([before, at, after]: [DVec2; 3], options: &StrokeOptions) -> Option<DVec2> {
    let half = options.width_m / 2.0;
    let mitre = mitre((at - before).normalize_or_zero(), (after - at).normalize_or_zero())?;
    let reach = (mitre.length_squared() - 1.0).max(0.0).sqrt() * half;
    let shortest = at.distance(before).min(at.distance(after));
    let fits = mitre.length() <= options.mitre_limit && 2.0 * reach <= shortest;
    fits.then(|| mitre * half)
}

fn direction(line: &Polyline, segment: usize) -> DVec2 {
    (line.points()[segment + 1] - line.points()[segment]).normalize_or_zero()
}

fn along(line: &Polyline, index: usize, options: &StrokeOptions) -> f32 {
    (line.stations()[index] / options.texture_length_m) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ribbon::plan::PlanMesh;

    fn stroked(points: &[(f64, f64)], options: &StrokeOptions) -> PlanMesh {
        let line = Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line");
        let mut mesh = PlanMesh::default();
        stroke(&line, Continuations::default(), options, &mut mesh);
        mesh
    }

    fn turned(points: &[(f64, f64)], quarter: u32) -> Vec<(f64, f64)> {
        let turn = |(x, y): (f64, f64)| (0..quarter).fold((x, y), |(x, y), _| (-y, x));
        points.iter().map(|&point| turn(point)).collect()
    }

    #[test]
    fn a_mitred_bend_covers_length_times_width_however_it_is_turned() {
        let options = StrokeOptions { width_m: 4.0, ..StrokeOptions::default() };
        for quarter in 0..4 {
            let mesh = stroked(&turned(&[(0.0, 0.0), (100.0, 0.0), (160.0, 80.0)], quarter), &options);
            assert!((mesh.area_m2() - 800.0).abs() < 1e-9, "{}", mesh.area_m2());
            assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (6, 4));
        }
    }

    #[test]
    fn every_triangle_faces_up_on_gentle_and_sharp_turns() {
        let points = [(0.0, 0.0), (50.0, 0.0), (50.5, 30.0), (20.0, 31.0), (48.0, 33.0), (49.0, 80.0)];
        for quarter in 0..4 {
            let mesh = stroked(&turned(&points, quarter), &StrokeOptions::default());
            for [a, b, c] in mesh.corners() {
                assert!((b.at - a.at).perp_dot(c.at - a.at) > 0.0);
            }
        }
    }

    #[test]
    fn a_turn_past_the_limit_is_bevelled_and_grows_no_spike() {
        let mesh = stroked(&[(0.0, 0.0), (100.0, 0.0), (0.0, 8.0)], &StrokeOptions::default());
        let farthest = mesh.vertices.iter().map(|vertex| vertex.at.x).fold(0.0, f64::max);
        assert!(farthest < 103.1, "{farthest}");
    }

    #[test]
    fn u_runs_across_and_v_along() {
        let options = StrokeOptions { texture_length_m: 25.0, ..StrokeOptions::default() };
        let mesh = stroked(&[(0.0, 0.0), (100.0, 0.0)], &options);
        let uvs: Vec<_> = mesh.vertices.iter().map(|vertex| (vertex.at.y > 0.0, vertex.uv)).collect();
        assert!(uvs.contains(&(true, Vec2::new(0.0, 0.0))) && uvs.contains(&(false, Vec2::new(1.0, 4.0))));
    }
}

//! A centerline and a width to a ribbon in plan.
//!
//! Each segment becomes a quad between the edges that its joints (`joint`) end on; fans fill the outer sides of bends that
//! are not mitered. U runs from the left edge (0) to the right edge (1), V along the centerline in texture lengths, so that
//! a texture's lines keep their share of the width and its dashes their length.

use glam::{DVec2, Vec2};

use crate::joint::{JointFan, RibbonJoint};
use crate::plan::PlanVertex;
use crate::texture::{RibbonSurface, texture_length_m};
use sandtable_description::words::Join;
use sandtable_earthworks::alignment::Alignment;
use sandtable_earthworks::alignment::chain::{ChainLink, LineEnd};
use sandtable_geom::offset::{Continuations, LineBend, square};
use sandtable_mesh::sink::{MeshSink, VertexId};

/// The widest taper between cross-sections, as a ratio: a texture's lines have a kink between a quad's two triangles.
const TAPER_STEP: f64 = 1.1;

/// The most cross-sections in one taper: a ribbon that grows twentyfold from vertex to vertex has kinks anyway.
const MOST_STEPS: f64 = 32.0;

/// Triangles smaller than this have no direction worth a texture, in square meters.
const NOTHING_M2: f64 = 1e-9;

/// The options for stroking a ribbon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeOptions {
    /// How segments meet. Default: mitered.
    pub join: Join,
    /// How long a miter may be, in half widths, at least 1. Default 2: turns of up to 120 degrees keep their
    /// miter; sharper ones would grow spikes.
    pub miter_limit: f64,
    /// Meters along the centerline in one repeat of the texture, above 0. Default 12.
    pub texture_length_m: f64,
}

impl Default for StrokeOptions {
    fn default() -> Self {
        Self { join: Join::Miter, miter_limit: 2.0, texture_length_m: 12.0 }
    }
}

impl StrokeOptions {
    /// The default for a ribbon of this surface and width.
    pub fn of(surface: RibbonSurface, width_m: f64) -> Self {
        Self { texture_length_m: texture_length_m(surface, width_m), ..Self::default() }
    }
}

/// The path of a ribbon.
#[derive(Clone, Copy, Debug)]
pub struct StrokePath<'a> {
    /// The centerline and its width.
    pub alignment: &'a Alignment,
    /// What continues it at its ends.
    pub beyond: Continuations,
    /// The stations of its texture, so that the texture continues from one ribbon to the next.
    pub link: ChainLink,
}

impl<'a> StrokePath<'a> {
    /// A path that nothing continues.
    pub fn alone(alignment: &'a Alignment) -> Self {
        let link = LineEnd { line: 0, end: 0 }.link(0.0, alignment.line.length());
        Self { alignment, beyond: Continuations::default(), link }
    }
}

/// Writes the ribbon along `path` to `sink`, triangles counter-clockwise.
///
/// Where a sharp turn's inner sides overlap, both quads are there; [`crate::partition`] takes them apart.
pub fn stroke(path: &StrokePath<'_>, options: &StrokeOptions, sink: &mut impl MeshSink<PlanVertex>) {
    let last = path.alignment.line.points().len() - 1;
    let mut stroker = Stroker { path, options, sink };
    let mut start = stroker.end(0);
    for index in 1..=last {
        let [closing, opening] = if index == last { [stroker.end(last); 2] } else { stroker.bend(index) };
        stroker.segment(index - 1, [start, closing]);
        start = opening;
    }
}

/// An edge across the ribbon, written: its left and its right end.
#[derive(Clone, Copy)]
struct RibbonEdge {
    corners: [PlanVertex; 2],
    ids: [VertexId; 2],
}

impl RibbonEdge {
    fn write(corners: [PlanVertex; 2], sink: &mut impl MeshSink<PlanVertex>) -> Self {
        Self { corners, ids: corners.map(|corner| sink.vertex(corner)) }
    }
}

struct Stroker<'a, S> {
    path: &'a StrokePath<'a>,
    options: &'a StrokeOptions,
    sink: &'a mut S,
}

impl<S: MeshSink<PlanVertex>> Stroker<'_, S> {
    fn points(&self) -> &[DVec2] {
        self.path.alignment.line.points()
    }

    /// The edge at the line's first or last vertex: shared with what goes on there, else square.
    fn end(&mut self, index: usize) -> RibbonEdge {
        let (points, half) = (self.points(), self.half_m(index));
        let shared = LineBend::at(points, index, self.path.beyond, half)
            .and_then(|bend| bend.mitered(self.options.miter_limit));
        let segment = index.saturating_sub(1);
        let to_left = shared.unwrap_or_else(|| square([points[segment], points[segment + 1]], half));
        self.edge(index, [to_left, -to_left])
    }

    /// What the segments before and after a vertex end on; the fan between them is written too.
    fn bend(&mut self, index: usize) -> [RibbonEdge; 2] {
        let points = self.points();
        let around = [points[index - 1], points[index], points[index + 1]];
        let bend = LineBend { points: around, half: self.half_m(index) };
        match RibbonJoint::new(&bend, self.options.join, self.options.miter_limit) {
            RibbonJoint::Shared(to_left) => [self.edge(index, [to_left, -to_left]); 2],
            RibbonJoint::Split { closing, opening, fan } => {
                self.write_fan(index, &fan);
                [closing, opening].map(|ways| self.edge(index, ways))
            }
        }
    }

    fn edge(&mut self, index: usize, ways: [DVec2; 2]) -> RibbonEdge {
        let (at, v) = (self.points()[index], self.v(index));
        let corner = |side: usize| PlanVertex { at: at + ways[side], uv: Vec2::new(side as f32, v) };
        RibbonEdge::write([corner(0), corner(1)], self.sink)
    }

    fn half_m(&self, index: usize) -> f64 {
        let Alignment { line, width, .. } = self.path.alignment;
        width.at(line.stations()[index]) / 2.0
    }

    fn v(&self, index: usize) -> f32 {
        let station_m = self.path.link.station_m(self.path.alignment.line.stations()[index]);
        (station_m / self.options.texture_length_m) as f32
    }

    fn write_fan(&mut self, index: usize, fan: &JointFan) {
        let (at, v) = (self.points()[index], self.v(index));
        let mut corner = |way: DVec2, u: f32| {
            let corner = PlanVertex { at: at + way, uv: Vec2::new(u, v) };
            (self.sink.vertex(corner), corner)
        };
        let center = corner(fan.center, fan.center_u());
        let rim: Vec<_> = fan.rim.iter().map(|&way| corner(way, fan.rim_u())).collect();
        for pair in rim.windows(2) {
            write_triangle([center, pair[0], pair[1]], self.sink);
        }
    }

    /// Writes the quad of a segment, in as many pieces as its taper needs.
    fn segment(&mut self, segment: usize, [from, to]: [RibbonEdge; 2]) {
        let steps = taper_steps(2.0 * self.half_m(segment), 2.0 * self.half_m(segment + 1));
        let mut start = from;
        for step in 1..=steps {
            let part = f64::from(step) / f64::from(steps);
            let end = if step == steps {
                to
            } else {
                RibbonEdge::write(between([from.corners, to.corners], part), self.sink)
            };
            write_quad([start, end], self.sink);
            start = end;
        }
    }
}

fn taper_steps(from_m: f64, to_m: f64) -> u32 {
    let ratio = from_m.max(to_m) / from_m.min(to_m);
    (libm::log(ratio) / libm::log(TAPER_STEP)).ceil().clamp(1.0, MOST_STEPS) as u32
}

fn between([from, to]: [[PlanVertex; 2]; 2], part: f64) -> [PlanVertex; 2] {
    let corner = |side: usize| PlanVertex {
        at: from[side].at.lerp(to[side].at, part),
        uv: from[side].uv.lerp(to[side].uv, part as f32),
    };
    [corner(0), corner(1)]
}

fn write_quad([from, to]: [RibbonEdge; 2], sink: &mut impl MeshSink<PlanVertex>) {
    let corner = |edge: &RibbonEdge, side: usize| (edge.ids[side], edge.corners[side]);
    let (start_left, end_right) = (corner(&from, 0), corner(&to, 1));
    write_triangle([start_left, corner(&from, 1), end_right], sink);
    write_triangle([start_left, end_right, corner(&to, 0)], sink);
}

fn write_triangle(corners: [(VertexId, PlanVertex); 3], sink: &mut impl MeshSink<PlanVertex>) {
    let [a, b, c] = corners.map(|(_, corner)| corner.at);
    if (b - a).perp_dot(c - a) > 2.0 * NOTHING_M2 {
        sink.triangle(corners.map(|(id, _)| id));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::PlanMesh;
    use sandtable_earthworks::alignment::Width;
    use sandtable_geom::polyline::Polyline;
    use sandtable_geom::profile::Profile;

    fn stroked(points: &[(f64, f64)], width_m: f64, options: &StrokeOptions) -> PlanMesh {
        let line = Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line");
        let mut mesh = PlanMesh::default();
        stroke(&StrokePath::alone(&Alignment::on_ground(line, width_m)), options, &mut mesh);
        mesh
    }

    fn turned(points: &[(f64, f64)], quarter: u32) -> Vec<(f64, f64)> {
        let turn = |(x, y): (f64, f64)| (0..quarter).fold((x, y), |(x, y), _| (-y, x));
        points.iter().map(|&point| turn(point)).collect()
    }

    #[test]
    fn a_mitered_bend_covers_length_times_width_however_it_is_turned() {
        for quarter in 0..4 {
            let mesh = stroked(
                &turned(&[(0.0, 0.0), (100.0, 0.0), (160.0, 80.0)], quarter),
                4.0,
                &StrokeOptions::default(),
            );
            assert!((mesh.area_m2() - 800.0).abs() < 1e-9, "{}", mesh.area_m2());
            assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (6, 4));
        }
    }

    #[test]
    fn every_triangle_faces_up_on_gentle_and_sharp_turns() {
        let points = [(0.0, 0.0), (50.0, 0.0), (50.5, 30.0), (20.0, 31.0), (48.0, 33.0), (49.0, 80.0)];
        for quarter in 0..4 {
            let mesh = stroked(&turned(&points, quarter), 6.0, &StrokeOptions::default());
            for [a, b, c] in mesh.corners() {
                assert!((b.at - a.at).perp_dot(c.at - a.at) > 0.0);
            }
        }
    }

    #[test]
    fn a_turn_past_the_limit_is_beveled_and_grows_no_spike() {
        let mesh = stroked(&[(0.0, 0.0), (100.0, 0.0), (0.0, 8.0)], 6.0, &StrokeOptions::default());
        let farthest = mesh.vertices.iter().map(|vertex| vertex.at.x).fold(0.0, f64::max);
        assert!(farthest < 103.1, "{farthest}");
    }

    #[test]
    fn u_runs_across_and_v_along() {
        let options = StrokeOptions { texture_length_m: 25.0, ..StrokeOptions::default() };
        let mesh = stroked(&[(0.0, 0.0), (100.0, 0.0)], 6.0, &options);
        let uvs: Vec<_> = mesh.vertices.iter().map(|vertex| (vertex.at.y > 0.0, vertex.uv)).collect();
        assert!(uvs.contains(&(true, Vec2::new(0.0, 0.0))) && uvs.contains(&(false, Vec2::new(1.0, 4.0))));
    }
    /// Length times width, and what the joints of 90 and 30 degrees add: an outer side less an inner one.
    fn expected_m2(length_m: f64, half_m: f64, join: Join) -> f64 {
        let turns = [std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_6];
        let outer = |turn: f64| match join {
            Join::Miter => libm::tan(turn / 2.0),
            Join::Bevel => libm::sin(turn) / 2.0,
            Join::Round => turn / 2.0,
        };
        let joints = turns.map(|turn| outer(turn) - libm::tan(turn / 2.0));
        2.0 * half_m * length_m + half_m * half_m * joints.iter().sum::<f64>()
    }

    #[test]
    fn joints_are_as_large_as_they_are_by_trigonometry_however_they_are_turned() {
        let points = [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (50.0, 100.0 + 50.0 * 3f64.sqrt())];
        for quarter in 0..4 {
            for (join, slack) in [(Join::Miter, 1e-9), (Join::Bevel, 1e-9), (Join::Round, 0.02)] {
                let options = StrokeOptions { join, ..StrokeOptions::default() };
                let mesh = stroked(&turned(&points, quarter), 12.0, &options);
                let expected = expected_m2(300.0, 6.0, join);
                let share = (mesh.area_m2() - expected).abs() / (6.0 * 6.0);
                assert!(share < slack, "{join:?}: {} where {expected} was expected", mesh.area_m2());
                assert!(
                    mesh.corners().all(|[a, b, c]| (b.at - a.at).perp_dot(c.at - a.at) > 0.0),
                    "{join:?}"
                );
            }
        }
    }

    #[test]
    fn a_taper_is_a_trapezium_with_its_edges_straight() {
        let line = Polyline::new([DVec2::ZERO, DVec2::X * 100.0], 0.0).expect("a line");
        let width = Width::Varying(Profile::straight(100.0, [4.0, 12.0]));
        let alignment = Alignment { width, ..Alignment::on_ground(line, 1.0) };
        let mut mesh = PlanMesh::default();
        stroke(&StrokePath::alone(&alignment), &StrokeOptions::default(), &mut mesh);
        assert!((mesh.area_m2() - 800.0).abs() < 1e-9, "{}", mesh.area_m2());
        for vertex in &mesh.vertices {
            assert!((vertex.at.y.abs() - (2.0 + 0.04 * vertex.at.x)).abs() < 1e-9, "{vertex:?}");
            assert_eq!(vertex.at.y > 0.0, vertex.uv.x == 0.0);
        }
    }

    #[test]
    fn a_texture_goes_on_where_its_stations_say() {
        let line = Polyline::new([DVec2::ZERO, DVec2::X * 24.0], 0.0).expect("a line");
        let alignment = Alignment::on_ground(line, 6.0);
        let path = StrokePath {
            link: LineEnd { line: 0, end: 1 }.link(12.0, 24.0),
            ..StrokePath::alone(&alignment)
        };
        let mut mesh = PlanMesh::default();
        stroke(&path, &StrokeOptions::default(), &mut mesh);
        let v = |x: f64| mesh.vertices.iter().find(|vertex| vertex.at.x == x).map(|vertex| vertex.uv.y);
        assert_eq!((v(0.0), v(24.0)), (Some(3.0), Some(1.0)));
    }
}

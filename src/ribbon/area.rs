//! A polygon to triangles in plan, textured by the map.

use glam::DVec2;

use crate::plan::PlanVertex;
use sandtable_geom::polygon;
use sandtable_mesh::sink::MeshSink;

/// Writes the polygon with `exterior` and `holes`, in world coordinates, to `sink`; the texture repeats every
/// `texture_m` meters east and north.
pub fn fill(exterior: &[DVec2], holes: &[Vec<DVec2>], texture_m: f64, sink: &mut impl MeshSink<PlanVertex>) {
    for triangle in polygon::triangulate(exterior, holes) {
        let corner = |at: DVec2| PlanVertex { at, uv: (DVec2::new(at.x, -at.y) / texture_m).as_vec2() };
        let corners = triangle.map(|at| sink.vertex(corner(at)));
        sink.triangle(corners);
    }
}

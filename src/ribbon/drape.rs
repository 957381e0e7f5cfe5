//! Laying plan triangles on the displayed ground.
//!
//! Every plan triangle is clipped against every displayed triangle it meets; each piece takes its height from
//! that triangle's plane. So the clearance between a draped feature and the displayed surface is zero by
//! construction, for any camera and level of detail.
//!
//! Cost: a few hundred nanoseconds for each pair of triangles that overlap; it grows with the ribbon's length in
//! displayed triangles.

use std::mem;

use glam::{DVec2, Vec3};

use crate::plan::{PlanMesh, PlanVertex, TextureMap};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, DrawVertex};
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_terrain::triangle_surface::{SurfaceTriangle, TriangleSurface, plane_z};

/// Pieces smaller than this are rounding left over where edges coincide.
const SLIVER_M2: f64 = 1e-7;

/// `plan` cut to the displayed triangles of `ground`; parts off the displayed ground are left out.
pub fn drape(plan: &PlanMesh, ground: &dyn TriangleSurface) -> DrawMesh {
    Draper::default().drape(plan, ground)
}

/// Lays one plan after the other; holds the memory that each needs, for the next.
///
/// Threads that lay many plans each have one: memory that many threads take and free at once makes them wait for each other.
#[derive(Debug, Default)]
pub struct Draper {
    piece: Vec<DVec2>,
    scratch: Vec<DVec2>,
    ids: Vec<VertexId>,
    mesh: DrawMesh,
}

impl Draper {
    /// [`drape`]; the mesh takes no more memory than it needs.
    pub fn drape(&mut self, plan: &PlanMesh, ground: &dyn TriangleSurface) -> DrawMesh {
        let mut mesh = mem::take(&mut self.mesh);
        mesh.vertices.clear();
        mesh.triangles.clear();
        plan.corners().for_each(|corners| self.lay(corners, ground, &mut mesh));
        let draped = mesh.clone();
        self.mesh = mesh;
        draped
    }

    /// Writes one plan triangle cut to the displayed triangles of `ground` to `sink`, with vertices of its own.
    pub fn lay(
        &mut self,
        corners: [PlanVertex; 3],
        ground: &dyn TriangleSurface,
        sink: &mut impl MeshSink<DrawVertex>,
    ) {
        let Self { piece, scratch, ids, .. } = self;
        let texture = TextureMap::of(corners);
        ground.visit_facets(&Rect::around(corners.map(|corner| corner.at)), &mut |facet| {
            piece.clear();
            piece.extend(corners.map(|corner| corner.at));
            let window = facet.map(|corner| corner.truncate().as_dvec2());
            polygon::clip_convex(piece, scratch, &window);
            write_piece(piece, facet, &texture, ids, sink);
        });
    }
}

fn write_piece(
    piece: &[DVec2],
    facet: &SurfaceTriangle,
    texture: &TextureMap,
    ids: &mut Vec<VertexId>,
    sink: &mut impl MeshSink<DrawVertex>,
) {
    if piece.len() < 3 || polygon::doubled_area(piece) < 2.0 * SLIVER_M2 {
        return;
    }
    let mut vertex = |at: DVec2| {
        sink.vertex(DrawVertex {
            position: [at.x as f32, at.y as f32, plane_z(facet, at) as f32],
            normal: [0.0, 0.0, 1.0],
            uv: texture.at(at).to_array(),
            color: Srgba::WHITE,
        })
    };
    ids.clear();
    ids.extend(piece.iter().map(|&at| vertex(at)));
    polygon::fan(ids).for_each(|corners| sink.triangle(corners));
}

/// The largest vertical distance in meters between a draped mesh and the displayed ground, at the middle of
/// every triangle and at every corner above displayed ground: the invariant of this module. Infinite
/// where the middle of a triangle lies off the ground.
pub fn check_clearance(draped: &DrawMesh, ground: &dyn TriangleSurface) -> f64 {
    let clearance = |at: Vec3| {
        let displayed = ground.displayed_z(at.truncate().as_dvec2());
        displayed.map(|z| (f64::from(at.z) - z).abs())
    };
    let corner = |id: VertexId| Vec3::from(draped.vertices[id.index()].position);
    let middles = draped.triangles.iter().map(|&[a, b, c]| (corner(a) + corner(b) + corner(c)) / 3.0);
    let middles = middles.map(|at| clearance(at).unwrap_or(f64::INFINITY));
    let corners = draped.vertices.iter().filter_map(|vertex| clearance(Vec3::from(vertex.position)));
    middles.chain(corners).fold(0.0, f64::max)
}

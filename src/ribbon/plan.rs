//! Triangles in plan, before they meet the ground.

use glam::{DVec2, Vec2};

use sandtable_geom::convex;
use sandtable_mesh::sink::{MeshSink, VertexId};

/// A corner in plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanVertex {
    /// World X and Y in meters.
    pub at: DVec2,
    /// Texture coordinates.
    pub uv: Vec2,
}

/// Counter-clockwise triangles in plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanMesh {
    /// The corners.
    pub vertices: Vec<PlanVertex>,
    /// Triples of indices into `vertices`.
    pub triangles: Vec<[VertexId; 3]>,
}

impl PlanMesh {
    /// The corners of every triangle.
    pub fn corners(&self) -> impl Iterator<Item = [PlanVertex; 3]> + '_ {
        self.triangles.iter().map(|triangle| triangle.map(|id| self.vertices[id.index()]))
    }

    /// Its ground in convex polygons, counter-clockwise: two triangles in a row that make a convex quad are one.
    pub fn convex_parts(&self) -> Vec<Vec<DVec2>> {
        let mut parts = Vec::with_capacity(self.triangles.len() / 2 + 1);
        let mut rest = &self.triangles[..];
        while let [first, after @ ..] = rest {
            let at = |id: VertexId| self.vertices[id.index()].at;
            let quad = after.first().filter(|next| next[0] == first[0] && next[1] == first[2]);
            let quad = quad
                .map(|next| [first[0], first[1], first[2], next[2]].map(at))
                .filter(|quad| convex::is_convex(quad));
            rest = if quad.is_some() { &after[1..] } else { after };
            parts.push(quad.map_or_else(|| first.map(at).to_vec(), |quad| quad.to_vec()));
        }
        parts
    }

    /// Adds the triangles of another.
    pub fn append(&mut self, other: &Self) {
        let first = self.vertices.len();
        let moved = |triangle: &[VertexId; 3]| triangle.map(|id| VertexId::new(first + id.index()));
        self.vertices.extend_from_slice(&other.vertices);
        self.triangles.extend(other.triangles.iter().map(moved));
    }

    /// Adds convex polygons' triangles, counter-clockwise, that lie on a textured one.
    pub(crate) fn write(&mut self, triangles: impl Iterator<Item = [DVec2; 3]>, texture: &TextureMap) {
        for corners in triangles {
            let ids = corners.map(|at| self.vertex(PlanVertex { at, uv: texture.at(at) }));
            self.triangle(ids);
        }
    }

    /// The sum of all triangles' areas in square meters.
    pub fn area_m2(&self) -> f64 {
        self.corners().map(|[a, b, c]| (b.at - a.at).perp_dot(c.at - a.at) / 2.0).sum()
    }
}

impl MeshSink<PlanVertex> for PlanMesh {
    fn vertex(&mut self, vertex: PlanVertex) -> VertexId {
        let id = VertexId::new(self.vertices.len());
        self.vertices.push(vertex);
        id
    }

    fn triangle(&mut self, corners: [VertexId; 3]) {
        self.triangles.push(corners);
    }
}

/// The affine map from world to texture coordinates over one plan triangle.
pub(crate) struct TextureMap {
    origin: PlanVertex,
    per_x: DVec2,
    per_y: DVec2,
}

impl TextureMap {
    pub fn of([a, b, c]: [PlanVertex; 3]) -> Self {
        let (p, q) = (b.at - a.at, c.at - a.at);
        let (s, t) = ((b.uv - a.uv).as_dvec2(), (c.uv - a.uv).as_dvec2());
        let inverse = 1.0 / p.perp_dot(q);
        Self { origin: a, per_x: (s * q.y - t * p.y) * inverse, per_y: (t * p.x - s * q.x) * inverse }
    }

    pub fn at(&self, at: DVec2) -> Vec2 {
        let offset = at - self.origin.at;
        let uv = self.origin.uv.as_dvec2() + self.per_x * offset.x + self.per_y * offset.y;
        uv.as_vec2()
    }
}

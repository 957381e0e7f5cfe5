//! All parts of a model as one surface with seams, the input of simplification.
//!
//! ```text
//! point ── a position; vertices of any part that are equal there in every bit
//!   └─ wedge ── one part's vertex at that point: normal, texture coordinates, color
//!        └─ triangle ── three wedges of one part
//! ```
//!
//! Moving a point moves both sides of every seam through it, so that nothing tears open.

use glam::{DVec3, Vec3};

use crate::{Model, ModelPart};
use sandtable_draw::list::{DrawMesh, DrawVertex};
use sandtable_geom::triangle;
use sandtable_mesh::numbering::{Numbering, weld_key};
use sandtable_mesh::sink::{MeshSink, VertexId};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct PointId(pub u32);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct WedgeId(pub u32);

#[derive(Clone, Copy, Debug)]
pub(super) struct SoupWedge {
    pub point: PointId,
    pub part: u32,
    pub vertex: DrawVertex,
}

/// A surface of triangles over wedges over points. A removed triangle has three equal wedges.
#[derive(Clone, Debug, Default)]
pub(super) struct Soup {
    pub points: Vec<DVec3>,
    wedges: Vec<SoupWedge>,
    pub triangles: Vec<[WedgeId; 3]>,
    /// The triangles around each point. Rising and without removed ones after [`Soup::compact_ring`].
    rings: Vec<Vec<u32>>,
    /// The number of triangles that are not removed.
    pub triangle_count: usize,
}

impl Soup {
    /// The surface of a model. Triangles with fewer than three points are dropped.
    pub(super) fn new(model: &Model) -> Self {
        let mut soup = Self::default();
        let mut numbers = Numbering::default();
        for (part, ModelPart { mesh, material, .. }) in (0..).zip(&model.parts) {
            let first = soup.wedges.len() as u32;
            let has_texture = model.materials[material.0 as usize].texture.is_some();
            for &stored in &mesh.vertices {
                // Without a texture, its coordinates must not prevent a collapse.
                let vertex = DrawVertex { uv: if has_texture { stored.uv } else { [0.0; 2] }, ..stored };
                let position = Vec3::from(vertex.position);
                let number = numbers.number(weld_key(position));
                if number.is_new {
                    soup.points.push((position + Vec3::ZERO).as_dvec3());
                }
                soup.wedges.push(SoupWedge { point: PointId(number.index), part, vertex });
            }
            let wedges = mesh.triangles.iter().map(|corners| corners.map(|id| WedgeId(id.0 + first)));
            soup.triangles.extend(wedges);
        }
        soup.link();
        soup
    }

    fn link(&mut self) {
        let Self { points, wedges, triangles, rings, .. } = self;
        triangles.retain(|corners| {
            let [a, b, c] = corners.map(|id| wedges[id.0 as usize].point);
            a != b && b != c && c != a
        });
        *rings = vec![Vec::new(); points.len()];
        for (index, corners) in triangles.iter().enumerate() {
            for id in corners {
                rings[wedges[id.0 as usize].point.0 as usize].push(index as u32);
            }
        }
        self.triangle_count = self.triangles.len();
    }

    pub(super) fn wedge(&self, id: WedgeId) -> &SoupWedge {
        &self.wedges[id.0 as usize]
    }

    /// The wedge of `part` at `point` that equals `vertex`; a new one where there is none.
    pub(super) fn find_or_add_wedge(&mut self, wedge: SoupWedge) -> WedgeId {
        let ring = self.ring(wedge.point).iter().flat_map(|&triangle| self.triangles[triangle as usize]);
        let key = |wedge: &SoupWedge| (wedge.point, wedge.part, wedge.vertex);
        let known = ring.into_iter().find(|&id| key(self.wedge(id)) == key(&wedge));
        known.unwrap_or_else(|| {
            self.wedges.push(wedge);
            WedgeId(self.wedges.len() as u32 - 1)
        })
    }

    pub(super) fn area(&self) -> f64 {
        let is_present = |triangle: &u32| {
            let [first, second, _] = self.triangles[*triangle as usize];
            first != second
        };
        let present = (0..self.triangles.len() as u32).filter(is_present);
        present.map(|triangle| triangle::normal(self.corner_positions(triangle)).length()).sum::<f64>() * 0.5
    }

    pub(super) fn position(&self, id: PointId) -> DVec3 {
        self.points[id.0 as usize]
    }

    pub(super) fn corners(&self, triangle: u32) -> [PointId; 3] {
        self.triangles[triangle as usize].map(|id| self.wedge(id).point)
    }

    pub(super) fn corner_positions(&self, triangle: u32) -> [DVec3; 3] {
        self.corners(triangle).map(|point| self.position(point))
    }

    /// The triangles around a point, each once; around the hub of a wide fan also some that are removed.
    pub(super) fn ring(&self, point: PointId) -> &[u32] {
        &self.rings[point.0 as usize]
    }

    /// The points that share a triangle with `point`, rising, each once.
    pub(super) fn neighbors(&self, point: PointId) -> Vec<PointId> {
        let corners = self.ring(point).iter().flat_map(|&triangle| self.corners(triangle));
        let mut neighbors: Vec<PointId> = corners.filter(|&other| other != point).collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        neighbors
    }

    /// Moves the triangles around `from` to `to`, where `targets` replace wedges at `from`; removes those that have
    /// both points. Returns the third points of the removed triangles.
    pub(super) fn collapse(
        &mut self,
        from: PointId,
        to: PointId,
        targets: &[(WedgeId, WedgeId)],
    ) -> Vec<PointId> {
        let ring = std::mem::take(&mut self.rings[from.0 as usize]);
        let mut third = Vec::new();
        for &triangle in &ring {
            let corners = self.corners(triangle);
            let wedges = &mut self.triangles[triangle as usize];
            if corners.contains(&to) {
                *wedges = [wedges[0]; 3];
                self.triangle_count -= 1;
                third.extend(corners.into_iter().filter(|&point| point != from && point != to));
            } else {
                for (source, target) in targets {
                    *wedges = wedges.map(|id| if id == *source { *target } else { id });
                }
            }
        }
        self.rings[to.0 as usize].extend(ring);
        third
    }

    /// Drops removed triangles and repetitions from the ring of `point`.
    pub(super) fn compact_ring(&mut self, point: PointId) {
        let mut ring = std::mem::take(&mut self.rings[point.0 as usize]);
        ring.sort_unstable();
        ring.dedup();
        ring.retain(|&triangle| self.triangles[triangle as usize][0] != self.triangles[triangle as usize][1]);
        self.rings[point.0 as usize] = ring;
    }

    /// The surface as meshes, in the order and with the names and materials of the model's parts. Parts without
    /// triangles are dropped.
    pub(super) fn parts(&self, model: &Model) -> Vec<ModelPart> {
        let mut meshes: Vec<DrawMesh> = vec![DrawMesh::default(); model.parts.len()];
        let mut ids: Vec<Option<VertexId>> = vec![None; self.wedges.len()];
        for corners in self.triangles.iter().filter(|corners| corners[0] != corners[1]) {
            let mesh = &mut meshes[self.wedge(corners[0]).part as usize];
            let corners = corners.map(|id| {
                *ids[id.0 as usize].get_or_insert_with(|| mesh.vertex(self.wedges[id.0 as usize].vertex))
            });
            mesh.triangle(corners);
        }
        let parts = model.parts.iter().zip(meshes).filter(|(_, mesh)| !mesh.triangles.is_empty());
        parts
            .map(|(part, mesh)| ModelPart { name: part.name.clone(), mesh, material: part.material })
            .collect()
    }
}

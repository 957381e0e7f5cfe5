//! All parts of a model as one surface that knows its seams: what simplification works on.
//!
//! ```text
//! point ── a place; vertices of any part that are equal there in every bit
//!   └─ wedge ── one part's vertex at that place: normal, texture coordinates, color
//!        └─ triangle ── three wedges of one part
//! ```
//!
//! An edge between two points is *smooth* where two triangles meet in it with the same two wedges; else it is a
//! border of the surface, of a material, of a texture or of a smooth patch. Working on points moves both sides of
//! such a seam at once, so that nothing tears open.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::draw::list::{DrawMesh, DrawVertex};
use crate::mesh::sink::{MeshSink, VertexId};
use crate::model::{Model, ModelPart};

/// The index of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct PointId(pub u32);

/// The index of a wedge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct WedgeId(pub u32);

/// One part's vertex at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct SoupWedge {
    pub point: PointId,
    pub part: u32,
    pub vertex: DrawVertex,
}

/// A surface of triangles over wedges over points. A triangle that has been taken out has three equal wedges.
#[derive(Clone, Debug, Default)]
pub(super) struct Soup {
    pub points: Vec<DVec3>,
    pub wedges: Vec<SoupWedge>,
    pub triangles: Vec<[WedgeId; 3]>,
    /// The triangles left around each point, rising; whoever changes some calls [`Soup::tidy`].
    pub around: Vec<Vec<u32>>,
    /// How many triangles are left.
    pub left: usize,
}

impl Soup {
    /// The surface of a model; triangles with fewer than three points are left out.
    pub(super) fn of(model: &Model) -> Self {
        let mut soup = Self::default();
        let mut known: HashMap<[u32; 3], PointId> = HashMap::new();
        for (part, ModelPart { mesh, material, .. }) in (0..).zip(&model.parts) {
            let first = soup.wedges.len() as u32;
            let has_texture = model.materials[material.0 as usize].texture.is_some();
            for &stored in &mesh.vertices {
                // Where there is no texture, its coordinates must not keep anything from moving.
                let vertex = DrawVertex { uv: if has_texture { stored.uv } else { [0.0; 2] }, ..stored };
                // −0 and 0 are one place.
                let place = Vec3::from(vertex.position) + Vec3::ZERO;
                let next = PointId(soup.points.len() as u32);
                let point = *known.entry(place.to_array().map(f32::to_bits)).or_insert(next);
                if point == next {
                    soup.points.push(place.as_dvec3());
                }
                soup.wedges.push(SoupWedge { point, part, vertex });
            }
            let wedges = mesh.triangles.iter().map(|corners| corners.map(|id| WedgeId(id.0 + first)));
            soup.triangles.extend(wedges);
        }
        soup.link();
        soup
    }

    fn link(&mut self) {
        let Self { points, wedges, triangles, around, .. } = self;
        triangles.retain(|corners| {
            let [a, b, c] = corners.map(|id| wedges[id.0 as usize].point);
            a != b && b != c && c != a
        });
        *around = vec![Vec::new(); points.len()];
        for (index, corners) in triangles.iter().enumerate() {
            for id in corners {
                around[wedges[id.0 as usize].point.0 as usize].push(index as u32);
            }
        }
        self.left = self.triangles.len();
    }

    /// The wedge with this id.
    pub(super) fn wedge(&self, id: WedgeId) -> &SoupWedge {
        &self.wedges[id.0 as usize]
    }

    /// The wedge of `part` at `point` that looks like `vertex`; a new one where there is none.
    pub(super) fn wedge_like(&mut self, vertex: &DrawVertex, point: PointId, part: u32) -> WedgeId {
        let around = self.triangles_at(point).iter().flat_map(|&triangle| self.triangles[triangle as usize]);
        let is_alike = |id: &WedgeId| {
            let wedge = self.wedge(*id);
            (wedge.point, wedge.part, wedge.vertex) == (point, part, *vertex)
        };
        let known = around.into_iter().find(is_alike);
        known.unwrap_or_else(|| {
            self.wedges.push(SoupWedge { point, part, vertex: *vertex });
            WedgeId(self.wedges.len() as u32 - 1)
        })
    }

    /// The area of all triangles left.
    pub(super) fn area(&self) -> f64 {
        let left = (0..self.triangles.len() as u32).filter(|&triangle| {
            let [first, second, _] = self.triangles[triangle as usize];
            first != second
        });
        let doubled = left.map(|triangle| {
            let [a, b, c] = self.corners(triangle).map(|point| self.at(point));
            (b - a).cross(c - a).length()
        });
        doubled.sum::<f64>() * 0.5
    }

    /// Where a point lies.
    pub(super) fn at(&self, id: PointId) -> DVec3 {
        self.points[id.0 as usize]
    }

    /// The points of a triangle.
    pub(super) fn corners(&self, triangle: u32) -> [PointId; 3] {
        self.triangles[triangle as usize].map(|id| self.wedge(id).point)
    }

    /// The triangles left around a point, each once; around the hub of a wide fan also some that are gone.
    pub(super) fn triangles_at(&self, point: PointId) -> &[u32] {
        &self.around[point.0 as usize]
    }

    /// The points that share a triangle with `point`, rising, each once.
    pub(super) fn neighbors(&self, point: PointId) -> Vec<PointId> {
        let all = self.triangles_at(point).iter().flat_map(|&triangle| self.corners(triangle));
        let mut neighbors: Vec<PointId> = all.filter(|&other| other != point).collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        neighbors
    }

    /// Lets go of triangles that are gone and of repetitions around `point`.
    pub(super) fn tidy(&mut self, point: PointId) {
        let mut ring = std::mem::take(&mut self.around[point.0 as usize]);
        ring.sort_unstable();
        ring.dedup();
        ring.retain(|&triangle| self.triangles[triangle as usize][0] != self.triangles[triangle as usize][1]);
        self.around[point.0 as usize] = ring;
    }

    /// The triangles left as meshes, in the order and with the names and materials of the model's parts; parts of
    /// which nothing is left are left out.
    pub(super) fn parts(&self, model: &Model) -> Vec<ModelPart> {
        let mut meshes: Vec<DrawMesh> = vec![DrawMesh::default(); model.parts.len()];
        let mut ids: Vec<Option<VertexId>> = vec![None; self.wedges.len()];
        for corners in self.triangles.iter().filter(|corners| corners[0] != corners[1]) {
            let mesh = &mut meshes[self.wedge(corners[0]).part as usize];
            let mut id_of = |id: WedgeId| {
                *ids[id.0 as usize].get_or_insert_with(|| mesh.vertex(self.wedges[id.0 as usize].vertex))
            };
            let corners = corners.map(&mut id_of);
            mesh.triangle(corners);
        }
        let parts = model.parts.iter().zip(meshes).filter(|(_, mesh)| !mesh.triangles.is_empty());
        parts
            .map(|(part, mesh)| ModelPart { name: part.name.clone(), mesh, material: part.material })
            .collect()
    }
}

//! Trunks: tapered tubes.

use glam::Vec3;

use crate::built_in::vertex::colored_vertex;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawMesh;
use sandtable_mesh::sink::{MeshSink, VertexId};

/// The depth of a trunk below the ground, in meters.
const ROOT_M: f32 = 0.6;
/// Sides of a trunk: round at the distances from which trees are seen.
const SIDES: usize = 6;

/// A trunk; lengths in meters, pairs from the foot to the top.
pub(super) struct Trunk {
    pub height: f32,
    pub radii: [f32; 2],
    pub colors: [Srgba; 2],
}

impl Trunk {
    pub(super) fn add_to(&self, mesh: &mut DrawMesh) {
        let mut ring = |z: f32, end: usize| -> Vec<VertexId> {
            let vertex = |side: usize| {
                let angle = side as f32 * std::f32::consts::TAU / SIDES as f32;
                let outward = Vec3::new(libm::cosf(angle), libm::sinf(angle), 0.0);
                colored_vertex((outward * self.radii[end]).with_z(z), outward, self.colors[end])
            };
            (0..SIDES).map(|side| mesh.vertex(vertex(side))).collect()
        };
        let (low, high) = (ring(-ROOT_M, 0), ring(self.height, 1));
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            mesh.triangle([low[side], low[next], high[next]]);
            mesh.triangle([low[side], high[next], high[side]]);
        }
    }
}

//! Trunks: tapered tubes.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::{DrawMesh, DrawVertex};
use crate::mesh::sink::{MeshSink, VertexId};

/// How deep a trunk reaches below the ground, in meters.
pub(super) const ROOT_M: f32 = 0.6;
/// Sides of a trunk: round at the distance from which trees are looked at.
const SIDES: usize = 6;

/// Adds a trunk from below the ground up to `height`, its radius falling from `radii.0` to `radii.1` meters.
pub(super) fn add(mesh: &mut DrawMesh, height: f32, radii: (f32, f32), (foot, top): (Srgba, Srgba)) {
    let mut ring = |z: f32, radius: f32, color: Srgba| -> Vec<VertexId> {
        let vertex = |side: usize| {
            let angle = side as f32 * std::f32::consts::TAU / SIDES as f32;
            let outward = Vec3::new(libm::cosf(angle), libm::sinf(angle), 0.0);
            DrawVertex {
                position: (outward * radius).with_z(z).to_array(),
                normal: outward.to_array(),
                uv: [0.0; 2],
                color,
            }
        };
        (0..SIDES).map(|side| mesh.vertex(vertex(side))).collect()
    };
    let (low, high) = (ring(-ROOT_M, radii.0, foot), ring(height, radii.1, top));
    for side in 0..SIDES {
        let next = (side + 1) % SIDES;
        mesh.triangle([low[side], low[next], high[next]]);
        mesh.triangle([low[side], high[next], high[side]]);
    }
}

//! A conifer: skirts of boughs around a trunk, each overlapping the next.
//!
//! A skirt is a cone whose rim alternates between boughs and gaps, closed from below by a darker, flatter cone. Its boughs
//! are between those of the skirt above.

use std::f32::consts::PI;

use glam::Vec3;

use crate::built_in::trunk::Trunk;
use crate::built_in::vertex::colored_vertex;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawMesh;
use sandtable_mesh::sink::{MeshSink, VertexId};

const BOUGHS: usize = 5;

/// A skirt: the heights of its rim and its tip, and the reach of its boughs, in meters.
struct Skirt {
    rim_z: f32,
    tip_z: f32,
    reach: f32,
}

/// From the lowest to the top one. Spacing and reach shrink upward, as yearly growth does.
const SKIRTS: [Skirt; 5] = [
    Skirt { rim_z: 2.2, tip_z: 8.2, reach: 3.7 },
    Skirt { rim_z: 5.2, tip_z: 11.2, reach: 3.1 },
    Skirt { rim_z: 8.2, tip_z: 13.8, reach: 2.5 },
    Skirt { rim_z: 11.0, tip_z: 16.0, reach: 1.85 },
    Skirt { rim_z: 13.5, tip_z: 18.0, reach: 1.2 },
];

/// The tips of boughs in the light, the gaps between them, the core of the tree, and its underside.
const BOUGH: Srgba = Srgba::opaque(106, 138, 82);
const GAP: Srgba = Srgba::opaque(58, 90, 58);
const CORE: Srgba = Srgba::opaque(70, 104, 62);
const UNDER: Srgba = Srgba::opaque(34, 54, 38);

const TRUNK: Trunk = Trunk {
    height: SKIRTS[0].tip_z - 3.0,
    radii: [0.34, 0.26],
    colors: [Srgba::opaque(84, 66, 50), Srgba::opaque(58, 46, 38)],
};

/// Eighteen meters of spruce.
pub(super) fn mesh() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    TRUNK.add_to(&mut mesh);
    for (index, skirt) in SKIRTS.iter().enumerate() {
        add_skirt(&mut mesh, skirt, index as f32 * 0.5 + 0.17);
    }
    mesh
}

fn add_skirt(mesh: &mut DrawMesh, skirt: &Skirt, turn: f32) {
    let count = 2 * BOUGHS;
    let rim = |index: usize| {
        let is_bough = index.is_multiple_of(2);
        let angle = (index as f32 + 2.0 * turn) * PI / BOUGHS as f32;
        let outward = Vec3::new(libm::cosf(angle), libm::sinf(angle), 0.0);
        // No two boughs of a skirt are alike.
        let uneven = 1.0 + 0.07 * libm::sinf(angle * 3.0 + turn * 5.0);
        let (reach, z) = if is_bough {
            (skirt.reach * uneven, skirt.rim_z)
        } else {
            (skirt.reach * 0.66, skirt.rim_z + (skirt.tip_z - skirt.rim_z) * 0.16)
        };
        (outward, (outward * reach).with_z(z), if is_bough { BOUGH } else { GAP })
    };
    let vertex =
        |at: Vec3, normal: Vec3, color: Srgba| colored_vertex(at, normal.normalize_or(Vec3::Z), color);
    let tip = Vec3::Z * skirt.tip_z;
    let upper: Vec<VertexId> = (0..count)
        .map(rim)
        .map(|(outward, at, color)| mesh.vertex(vertex(at, outward + Vec3::Z * 0.6, color)))
        .collect();
    let lower: Vec<VertexId> = (0..count)
        .map(rim)
        .map(|(outward, at, _)| mesh.vertex(vertex(at, outward * 0.4 - Vec3::Z, UNDER)))
        .collect();
    let inner = mesh.vertex(vertex(Vec3::Z * (skirt.rim_z + skirt.reach * 0.35), Vec3::NEG_Z, UNDER));
    for index in 0..count {
        let next = (index + 1) % count;
        // The tip has a normal for each side, so that the cone looks round.
        let outward = rim(index).0 + rim(next).0;
        let top = mesh.vertex(vertex(tip, outward + Vec3::Z * 1.2, CORE));
        mesh.triangle([upper[index], upper[next], top]);
        mesh.triangle([lower[next], lower[index], inner]);
    }
}

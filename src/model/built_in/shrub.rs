//! A shrub: a few lumps of leaves on the ground.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::DrawMesh;
use crate::model::built_in::lump::{Lump, UnitSphere, mix, waves};

const LIGHT: Srgba = Srgba::opaque(138, 150, 90);
const SHADE: Srgba = Srgba::opaque(66, 84, 54);

const LUMPS: [Lump; 3] = [
    Lump { center: Vec3::new(0.0, 0.1, 0.85), half: Vec3::new(1.05, 1.0, 1.1) },
    Lump { center: Vec3::new(0.85, -0.35, 0.5), half: Vec3::new(0.75, 0.7, 0.75) },
    Lump { center: Vec3::new(-0.75, -0.45, 0.55), half: Vec3::new(0.8, 0.75, 0.8) },
];

/// Two meters of bush.
pub(super) fn mesh() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    for (index, lump) in LUMPS.iter().enumerate() {
        UnitSphere::coarse().add_smooth(&mut mesh, |direction| {
            let uneven = waves(direction, index as f32 * 1.9);
            let light = 0.4 + 0.45 * direction.z + 0.2 * uneven;
            (lump.surface(direction, 0.12 * uneven), mix(SHADE, LIGHT, light))
        });
    }
    mesh
}

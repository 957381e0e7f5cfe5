//! A shrub: a few lumps of leaves on the ground.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::DrawMesh;
use crate::model::built_in::blob::{UnitSphere, between, waves};

const LIGHT: Srgba = Srgba::opaque(138, 150, 90);
const SHADE: Srgba = Srgba::opaque(66, 84, 54);

/// Middle and half size of each lump, in meters.
const LUMPS: [(Vec3, Vec3); 3] = [
    (Vec3::new(0.0, 0.1, 0.85), Vec3::new(1.05, 1.0, 1.1)),
    (Vec3::new(0.85, -0.35, 0.5), Vec3::new(0.75, 0.7, 0.75)),
    (Vec3::new(-0.75, -0.45, 0.55), Vec3::new(0.8, 0.75, 0.8)),
];

/// Two meters of bush.
pub(super) fn mesh() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    for (index, &(middle, half)) in LUMPS.iter().enumerate() {
        UnitSphere::coarse().add_round(&mut mesh, |direction| {
            let uneven = waves(direction, index as f32 * 1.9);
            let at = middle + half * direction * (1.0 + 0.12 * uneven);
            (at, between(SHADE, LIGHT, 0.4 + 0.45 * direction.z + 0.2 * uneven))
        });
    }
    mesh
}

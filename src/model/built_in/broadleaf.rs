//! A broadleaved tree: a trunk under a crown of lumps, light above and dark beneath.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::DrawMesh;
use crate::model::built_in::lump::{Lump, UnitSphere, mix, waves};
use crate::model::built_in::trunk::Trunk;

/// Leaves in the light, and leaves in the shade of others.
const LIGHT: Srgba = Srgba::opaque(154, 168, 90);
const SHADE: Srgba = Srgba::opaque(72, 96, 56);

const TRUNK: Trunk = Trunk {
    height: 6.5,
    radii: [0.48, 0.30],
    colors: [Srgba::opaque(104, 86, 66), Srgba::opaque(62, 54, 44)],
};

/// The crown's great lump and the lesser ones around it, each of another height.
const CROWN: Lump = Lump { center: Vec3::new(0.0, 0.0, 8.9), half: Vec3::new(3.9, 3.9, 4.6) };
const BOUGHS: [Lump; 4] = [
    Lump { center: Vec3::new(2.5, 1.1, 7.2), half: Vec3::new(2.3, 2.2, 2.1) },
    Lump { center: Vec3::new(-1.1, 2.6, 8.0), half: Vec3::new(2.2, 2.2, 2.2) },
    Lump { center: Vec3::new(-2.4, -1.3, 6.9), half: Vec3::new(2.3, 2.2, 2.0) },
    Lump { center: Vec3::new(1.2, -2.6, 8.3), half: Vec3::new(2.1, 2.1, 2.3) },
];

/// Fourteen meters of oak.
pub(super) fn mesh() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    TRUNK.add_to(&mut mesh);
    UnitSphere::fine().add_smooth(&mut mesh, |direction| leaves(&CROWN, direction, 0.0));
    for (index, lump) in BOUGHS.iter().enumerate() {
        UnitSphere::coarse()
            .add_smooth(&mut mesh, |direction| leaves(lump, direction, index as f32 * 1.3 + 0.8));
    }
    mesh
}

/// The position and color of a lump's surface: its underside and its hollows are in the shade.
fn leaves(lump: &Lump, direction: Vec3, phase: f32) -> (Vec3, Srgba) {
    let uneven = waves(direction, phase);
    let at = lump.surface(direction, 0.11 * uneven);
    let light = 0.42 + 0.42 * direction.z + 0.22 * uneven + 0.03 * (at.z - CROWN.center.z);
    (at, mix(SHADE, LIGHT, light))
}

//! A broadleaved tree: a trunk under a crown of lumps, light above and dark beneath.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::DrawMesh;
use crate::model::built_in::blob::{UnitSphere, between, waves};
use crate::model::built_in::trunk;

/// Leaves in the light, and those in the shade of others.
const LIGHT: Srgba = Srgba::opaque(154, 168, 90);
const SHADE: Srgba = Srgba::opaque(72, 96, 56);

/// A lump of the crown: its middle and half its size, in meters.
struct Lump {
    middle: Vec3,
    half: Vec3,
}

/// The crown's great lump and the lesser ones around it, none as high as another.
const CROWN: Lump = Lump { middle: Vec3::new(0.0, 0.0, 8.9), half: Vec3::new(3.9, 3.9, 4.6) };
const BOUGHS: [Lump; 4] = [
    Lump { middle: Vec3::new(2.5, 1.1, 7.2), half: Vec3::new(2.3, 2.2, 2.1) },
    Lump { middle: Vec3::new(-1.1, 2.6, 8.0), half: Vec3::new(2.2, 2.2, 2.2) },
    Lump { middle: Vec3::new(-2.4, -1.3, 6.9), half: Vec3::new(2.3, 2.2, 2.0) },
    Lump { middle: Vec3::new(1.2, -2.6, 8.3), half: Vec3::new(2.1, 2.1, 2.3) },
];

/// Fourteen meters of oak.
pub(super) fn mesh() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let bark = (Srgba::opaque(104, 86, 66), Srgba::opaque(62, 54, 44));
    trunk::add(&mut mesh, 6.5, (0.48, 0.30), bark);
    UnitSphere::fine().add_round(&mut mesh, |direction| leaves(&CROWN, direction, 0.0));
    for (index, lump) in BOUGHS.iter().enumerate() {
        UnitSphere::coarse()
            .add_round(&mut mesh, |direction| leaves(lump, direction, index as f32 * 1.3 + 0.8));
    }
    mesh
}

/// A place on a lump's outside and its color: what looks down lies in the shade, and so do the hollows.
fn leaves(lump: &Lump, direction: Vec3, phase: f32) -> (Vec3, Srgba) {
    let uneven = waves(direction, phase);
    let at = lump.middle + lump.half * direction * (1.0 + 0.11 * uneven);
    let light = 0.42 + 0.42 * direction.z + 0.22 * uneven + 0.03 * (at.z - CROWN.middle.z);
    (at, between(SHADE, LIGHT, light))
}

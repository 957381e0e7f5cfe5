//! Models made of lumps: a broadleaved tree, a shrub and a rock.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::DrawMesh;
use crate::model::built_in::lump::{Lump, UnitSphere, mix, waves};
use crate::model::built_in::trunk::Trunk;

/// Leaves in the light, and leaves in the shade of others.
const LEAF: Srgba = Srgba::opaque(154, 168, 90);
const LEAF_SHADE: Srgba = Srgba::opaque(72, 96, 56);

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
pub(super) fn broadleaf() -> DrawMesh {
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
    (at, mix(LEAF_SHADE, LEAF, light))
}

const SHRUB: Srgba = Srgba::opaque(138, 150, 90);
const SHRUB_SHADE: Srgba = Srgba::opaque(66, 84, 54);

const SHRUB_LUMPS: [Lump; 3] = [
    Lump { center: Vec3::new(0.0, 0.1, 0.85), half: Vec3::new(1.05, 1.0, 1.1) },
    Lump { center: Vec3::new(0.85, -0.35, 0.5), half: Vec3::new(0.75, 0.7, 0.75) },
    Lump { center: Vec3::new(-0.75, -0.45, 0.55), half: Vec3::new(0.8, 0.75, 0.8) },
];

/// Two meters of bush.
pub(super) fn shrub() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    for (index, lump) in SHRUB_LUMPS.iter().enumerate() {
        UnitSphere::coarse().add_smooth(&mut mesh, |direction| {
            let uneven = waves(direction, index as f32 * 1.9);
            let light = 0.4 + 0.45 * direction.z + 0.2 * uneven;
            (lump.surface(direction, 0.12 * uneven), mix(SHRUB_SHADE, SHRUB, light))
        });
    }
    mesh
}

/// Facets toward the sky, and steep ones.
const ROCK_TOP: Srgba = Srgba::opaque(176, 168, 154);
const ROCK_SIDE: Srgba = Srgba::opaque(116, 108, 100);

/// Half the size of the rock, in meters.
const ROCK_HALF: Vec3 = Vec3::new(1.35, 1.1, 1.0);

/// A meter and a half of boulder with flat facets, its lower part in the ground.
pub(super) fn rock() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let shape = |direction: Vec3| {
        let at = direction * ROCK_HALF * (1.0 + 0.16 * waves(direction, 0.6)) + Vec3::Z * 0.45;
        // The base is flat, below the ground.
        at.with_z(at.z.max(-0.25))
    };
    let color =
        |normal: Vec3| mix(ROCK_SIDE, ROCK_TOP, 0.5 + 0.5 * normal.z + 0.18 * waves(normal * 2.0, 1.0));
    UnitSphere::fine().add_faceted(&mut mesh, shape, color);
    mesh
}

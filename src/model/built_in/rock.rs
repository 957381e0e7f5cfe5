//! A rock: a ball with flat facets, its lower part in the ground.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::DrawMesh;
use crate::model::built_in::lump::{UnitSphere, mix, waves};

/// Facets toward the sky, and steep ones.
const TOP: Srgba = Srgba::opaque(176, 168, 154);
const SIDE: Srgba = Srgba::opaque(116, 108, 100);

/// Half its size, in meters.
const HALF: Vec3 = Vec3::new(1.35, 1.1, 1.0);

/// A meter and a half of boulder.
pub(super) fn mesh() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let shape = |direction: Vec3| {
        let at = direction * HALF * (1.0 + 0.16 * waves(direction, 0.6)) + Vec3::Z * 0.45;
        // The base is flat, below the ground.
        at.with_z(at.z.max(-0.25))
    };
    let color = |normal: Vec3| mix(SIDE, TOP, 0.5 + 0.5 * normal.z + 0.18 * waves(normal * 2.0, 1.0));
    UnitSphere::fine().add_faceted(&mut mesh, shape, color);
    mesh
}

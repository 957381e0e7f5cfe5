//! Models made of lumps: broadleaved trees, a pine, a shrub and a rock.
//!
//! ```text
//!   broadleaf     walnut          beech      poplar     pine
//!     ▟██▙      ▄▟█▙▟█▙▄           ▟▙          ▟▙      ▄▟██▙▄
//!    ▟████▙    ▟████████▙         ▟██▙         ██       ▀┃▀▘
//!    ▀█▜▛█▀    ▀▀█▛▜▛▜█▀▀         ████         ██        ┃
//!      ┃           ┃              ▀┃▀          ▜▛        ┃
//!    round      spreading         oval       columnar   umbrella
//! ```
//!
//! A crown is a heap of lumps: each is light above and dark below and in its hollows, so that boughs show as in the sun.

use glam::Vec3;

use crate::built_in::lump::{Lump, UnitSphere, mix, waves};
use crate::built_in::trunk::Trunk;
use crate::built_in::vertex::colored_vertex;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawMesh;

/// By how much of its size a lump of leaves is uneven.
const UNEVEN: f32 = 0.12;

/// How far a leaf's normal turns from that of its lump to that of the whole crown: more makes a crown one ball, less a
/// bunch of balls.
const CROWN_NORMAL: f32 = 0.3;

/// A tree whose crown is a heap of lumps.
struct LumpyTree {
    trunk: Trunk,
    /// The great lump that the others lie around; `None` where all are alike.
    core: Option<Lump>,
    lumps: &'static [Lump],
    /// Leaves in the shade of others, and leaves in the light.
    leaves: [Srgba; 2],
}

const fn lump(center: [f32; 3], half: [f32; 3]) -> Lump {
    Lump { center: Vec3::from_array(center), half: Vec3::from_array(half) }
}

const BARK: [Srgba; 2] = [Srgba::opaque(108, 90, 70), Srgba::opaque(62, 54, 44)];

/// Fourteen meters of a broadleaved tree with a round crown.
const BROADLEAF: LumpyTree = LumpyTree {
    trunk: Trunk { height: 6.5, radii: [0.48, 0.30], colors: BARK },
    core: Some(lump([0.0, 0.0, 8.9], [3.7, 3.7, 4.5])),
    lumps: &[
        lump([2.6, 1.1, 7.0], [2.3, 2.2, 2.1]),
        lump([-1.1, 2.7, 7.9], [2.2, 2.2, 2.2]),
        lump([-2.5, -1.3, 6.8], [2.3, 2.2, 2.0]),
        lump([1.2, -2.7, 7.6], [2.1, 2.1, 2.2]),
        lump([1.5, 1.2, 11.2], [2.0, 2.0, 1.9]),
        lump([-1.4, -0.9, 11.6], [2.0, 2.0, 1.8]),
    ],
    leaves: [Srgba::opaque(58, 84, 46), Srgba::opaque(150, 174, 88)],
};

/// Thirteen meters of walnut, wider than high.
const WALNUT: LumpyTree = LumpyTree {
    trunk: Trunk { height: 6.5, radii: [0.62, 0.42], colors: BARK },
    core: None,
    lumps: &[
        lump([0.2, -0.1, 8.6], [3.4, 3.4, 3.0]),
        lump([4.3, 0.6, 6.9], [3.0, 2.8, 2.2]),
        lump([1.6, 4.1, 7.4], [2.9, 2.9, 2.3]),
        lump([-3.5, 2.7, 6.8], [3.0, 2.9, 2.2]),
        lump([-3.4, -2.8, 7.5], [2.9, 2.9, 2.3]),
        lump([1.4, -4.2, 6.9], [2.9, 2.8, 2.2]),
        lump([2.3, 1.2, 10.2], [2.6, 2.5, 2.1]),
        lump([-1.6, 1.5, 10.6], [2.5, 2.5, 2.1]),
        lump([-0.2, -2.2, 10.4], [2.5, 2.4, 2.1]),
    ],
    leaves: [Srgba::opaque(60, 82, 44), Srgba::opaque(150, 170, 86)],
};

/// Eighteen meters of beech with an oval crown.
const BEECH: LumpyTree = LumpyTree {
    trunk: Trunk { height: 7.0, radii: [0.44, 0.28], colors: [BARK[1], Srgba::opaque(96, 90, 82)] },
    core: None,
    lumps: &[
        lump([2.0, 0.5, 6.4], [2.4, 2.3, 2.3]),
        lump([-1.5, 1.6, 6.1], [2.3, 2.3, 2.2]),
        lump([-0.5, -2.0, 6.9], [2.4, 2.3, 2.4]),
        lump([-2.0, -0.6, 9.9], [2.5, 2.5, 2.8]),
        lump([1.4, -1.7, 10.3], [2.5, 2.5, 2.7]),
        lump([0.9, 1.9, 10.0], [2.5, 2.5, 2.8]),
        lump([-0.9, 0.7, 13.4], [2.2, 2.2, 2.5]),
        lump([1.0, -0.5, 13.7], [2.1, 2.1, 2.4]),
        lump([0.0, 0.1, 15.9], [1.5, 1.5, 2.1]),
    ],
    leaves: [Srgba::opaque(54, 86, 46), Srgba::opaque(146, 182, 92)],
};

/// Twenty meters of poplar, a column.
const POPLAR: LumpyTree = LumpyTree {
    trunk: Trunk { height: 4.0, radii: [0.36, 0.28], colors: BARK },
    core: None,
    lumps: &[
        lump([0.2, 0.1, 4.2], [1.4, 1.4, 2.4]),
        lump([-0.3, 0.3, 7.0], [1.8, 1.8, 2.7]),
        lump([0.3, -0.3, 9.8], [1.9, 1.9, 2.8]),
        lump([-0.2, -0.2, 12.6], [1.8, 1.8, 2.7]),
        lump([0.2, 0.2, 15.2], [1.5, 1.5, 2.5]),
        lump([-0.1, 0.0, 17.5], [1.0, 1.0, 2.3]),
    ],
    leaves: [Srgba::opaque(56, 82, 52), Srgba::opaque(142, 168, 100)],
};

/// Sixteen meters of pine: an umbrella on a bare trunk.
const PINE: LumpyTree = LumpyTree {
    trunk: Trunk {
        height: 12.5,
        radii: [0.36, 0.22],
        colors: [Srgba::opaque(112, 88, 70), Srgba::opaque(160, 104, 70)],
    },
    core: None,
    lumps: &[
        lump([0.1, 0.0, 13.7], [2.7, 2.6, 2.0]),
        lump([2.4, 0.7, 12.3], [2.1, 1.9, 1.3]),
        lump([-0.6, 2.4, 12.6], [2.0, 2.0, 1.3]),
        lump([-2.4, -0.8, 12.0], [2.1, 1.9, 1.3]),
        lump([0.7, -2.4, 12.5], [2.0, 2.0, 1.3]),
        lump([1.6, -1.3, 10.1], [1.5, 1.4, 0.8]),
        lump([-1.5, 1.1, 9.3], [1.4, 1.3, 0.7]),
    ],
    leaves: [Srgba::opaque(40, 62, 48), Srgba::opaque(112, 142, 92)],
};

pub(super) fn broadleaf() -> DrawMesh {
    BROADLEAF.mesh()
}

pub(super) fn walnut() -> DrawMesh {
    WALNUT.mesh()
}

pub(super) fn beech() -> DrawMesh {
    BEECH.mesh()
}

pub(super) fn poplar() -> DrawMesh {
    POPLAR.mesh()
}

pub(super) fn pine() -> DrawMesh {
    PINE.mesh()
}

impl LumpyTree {
    fn mesh(&self) -> DrawMesh {
        let mut mesh = DrawMesh::default();
        self.trunk.add_to(&mut mesh);
        if let Some(core) = &self.core {
            self.add(&mut mesh, core, &UnitSphere::fine(), 0.0);
        }
        for (index, lump) in self.lumps.iter().enumerate() {
            self.add(&mut mesh, lump, &UnitSphere::coarse(), index as f32 * 1.3 + 0.8);
        }
        mesh
    }

    fn add(&self, mesh: &mut DrawMesh, lump: &Lump, sphere: &UnitSphere, phase: f32) {
        let [low, high] = self.crown_heights();
        let middle = Vec3::Z * (0.65 * low + 0.35 * high);
        sphere.add_smooth(mesh, |direction| {
            let uneven = waves(direction, phase);
            let at = lump.surface(direction, UNEVEN * uneven);
            let own = (direction / lump.half).normalize_or(direction);
            let normal = own.lerp((at - middle).normalize_or(own), CROWN_NORMAL);
            let height = (at.z - low) / (high - low);
            let light = 0.24 + 0.34 * direction.z + 0.24 * uneven + 0.34 * height;
            colored_vertex(at, normal.normalize_or(own), mix(self.leaves[0], self.leaves[1], light))
        });
    }

    /// Where the crown begins and ends, in meters.
    fn crown_heights(&self) -> [f32; 2] {
        let all = self.core.iter().chain(self.lumps);
        all.fold([f32::MAX, f32::MIN], |[low, high], lump| {
            [low.min(lump.center.z - lump.half.z), high.max(lump.center.z + lump.half.z)]
        })
    }
}

const SHRUB: Srgba = Srgba::opaque(138, 150, 90);
const SHRUB_SHADE: Srgba = Srgba::opaque(66, 84, 54);

const SHRUB_LUMPS: [Lump; 3] = [
    lump([0.0, 0.1, 0.85], [1.05, 1.0, 1.1]),
    lump([0.85, -0.35, 0.5], [0.75, 0.7, 0.75]),
    lump([-0.75, -0.45, 0.55], [0.8, 0.75, 0.8]),
];

/// Two meters of bush.
pub(super) fn shrub() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    for (index, lump) in SHRUB_LUMPS.iter().enumerate() {
        UnitSphere::coarse().add_smooth(&mut mesh, |direction| {
            let uneven = waves(direction, index as f32 * 1.9);
            let light = 0.4 + 0.45 * direction.z + 0.2 * uneven;
            colored_vertex(
                lump.surface(direction, UNEVEN * uneven),
                direction,
                mix(SHRUB_SHADE, SHRUB, light),
            )
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

//! Random terrains, the maps that criteria read, and every criterion by name.

use glam::{DVec2, Vec3};
use proptest::prelude::*;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::anisotropic::Anisotropic;
use sandtable_roam::criterion::block::BlockRelief;
use sandtable_roam::criterion::flat::Flat;
use sandtable_roam::criterion::midpoint::Midpoint;
use sandtable_roam::criterion::screen::ScreenError;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::culling::{PatchHeights, patches_in_view};
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::spheres::SphereMap;
use sandtable_terrain::lattice::Lattice;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// A terrain with every map that a criterion asks for.
#[derive(Debug)]
pub struct Terrain {
    pub lattice: Lattice,
    pub layout: PatchLayout,
    pub exact: ErrorMap,
    pub midpoint: ErrorMap,
    pub relief: ErrorMap,
    pub spheres: SphereMap,
    pub heights: PatchHeights,
}

/// Meters between posts.
pub const CELL: DVec2 = DVec2::new(3.0, 4.0);

impl Terrain {
    pub fn new(columns: u32, patch: u32, heights: Vec<f32>) -> Self {
        let lattice = Lattice::new(DVec2::ZERO, CELL, columns, heights).expect("sound").stretched(1.5);
        let layout = PatchLayout::new(columns, lattice.rows(), patch).expect("sound");
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let midpoint = midpoint_errors(&lattice, &layout);
        let radii = midpoint.values().iter().map(|error| error * 30.0).collect();
        Self {
            exact: ErrorMap::exact(&lattice, &layout),
            relief: ErrorMap::relief(&lattice, &layout),
            spheres: SphereMap::nested(ground, radii),
            heights: PatchHeights::new(ground),
            midpoint,
            lattice,
            layout,
        }
    }

    pub fn ground(&self) -> PatchedGround<'_> {
        PatchedGround { lattice: &self.lattice, layout: &self.layout }
    }

    pub fn in_view(&self, camera: &Camera) -> Vec<Vertex> {
        patches_in_view(self.ground(), &self.heights, &Frustum::new(camera))
    }

    pub fn vertices(&self) -> impl Iterator<Item = Vertex> + use<> {
        let (columns, layout) = (self.layout.columns(), self.layout);
        (0..layout.vertex_count())
            .map(move |index| Vertex::new((index % columns) as i32, (index / columns) as i32))
            .filter(move |&vertex| !layout.is_corner(vertex))
    }

    /// Every criterion for a camera, and one that no rule holds.
    pub fn criteria<'a>(&'a self, camera: &Camera, frame: u32) -> Vec<(&'static str, Any<'a>)> {
        let ground = self.ground();
        let screen = ScreenError::new(ground, &self.exact, &self.heights, camera, 4.0);
        vec![
            ("flat", Any(Box::new(Flat::new(&self.layout, &self.exact, 2.0)))),
            ("spheres", Any(Box::new(Spheres::new(ground, &self.spheres, camera.eye())))),
            ("screen", Any(Box::new(screen))),
            ("midpoint", Any(Box::new(Midpoint::new(ground, &self.midpoint, camera, 9.0)))),
            ("variance", Any(Box::new(Midpoint::by_land_width(ground, &self.midpoint, camera, 20.0)))),
            ("anisotropic", Any(Box::new(Anisotropic::new(ground, &self.midpoint, camera, 6.0)))),
            ("block", Any(Box::new(BlockRelief::new(ground, &self.relief, camera, 60.0)))),
            ("whim", Any(Box::new(Whim { frame }))),
        ]
    }
}

/// The criteria whose excess never grows from a vertex to its children.
pub const MONOTONE: [&str; 2] = ["flat", "spheres"];

/// Midpoint errors the slow and obvious way.
pub fn midpoint_errors(lattice: &Lattice, layout: &PatchLayout) -> ErrorMap {
    let columns = layout.columns();
    let own = (0..layout.vertex_count()).map(|index| {
        let vertex = Vertex::new((index % columns) as i32, (index / columns) as i32);
        let z = |vertex| lattice.height(layout.post(vertex));
        if layout.is_corner(vertex) {
            return 0.0;
        }
        let [from, to] = vertex.hypotenuse();
        let off = (z(vertex) - (z(from) + z(to)) / 2.0).abs();
        if off.is_nan() { f32::INFINITY } else { off }
    });
    ErrorMap::raised(own.collect(), layout)
}

/// A criterion behind a pointer.
pub struct Any<'a>(pub Box<dyn Criterion + 'a>);

impl Criterion for Any<'_> {
    fn excess(&self, vertex: Vertex) -> f32 {
        self.0.excess(vertex)
    }

    fn wants(&self, vertex: Vertex) -> bool {
        self.0.wants(vertex)
    }
}

/// Wants what it wants, in each frame something else.
struct Whim {
    frame: u32,
}

impl Criterion for Whim {
    fn excess(&self, vertex: Vertex) -> f32 {
        let mixed = (vertex.x as u32)
            .wrapping_mul(0x9E37_79B1)
            .wrapping_add((vertex.y as u32).wrapping_mul(0x85EB_CA77))
            .wrapping_add((self.frame / 2).wrapping_mul(0xC2B2_AE3D));
        let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x2C1B_3C6D);
        (mixed >> 20) as f32 / 1600.0
    }
}

/// Terrains of any size, patches cut off at their borders, with holes.
pub fn terrains() -> impl Strategy<Value = Terrain> {
    (2u32..56, 2u32..56, 1u32..5, 0.0..6.3f32, proptest::collection::vec((0u32..56, 0u32..56, 1u32..9), 0..3))
        .prop_map(|(columns, rows, patch, phase, holes)| {
            let height = |x: u32, y: u32| {
                let (x, y) = (x as f32, y as f32);
                libm::sinf(x * 0.31 + phase) * 6.0
                    + libm::cosf(y * 0.23 - x * 0.11) * 9.0
                    + libm::sinf(x * 1.7 + y * 2.3) * libm::sinf(phase + y * 0.1) * 2.0
            };
            let is_hole = |x: u32, y: u32| {
                x + y > 0
                    && holes.iter().any(|&(left, low, size)| {
                        (left..left + size).contains(&x) && (low..low + size).contains(&y)
                    })
            };
            let heights = (0..rows)
                .flat_map(|y| (0..columns).map(move |x| (x, y)))
                .map(|(x, y)| if is_hole(x, y) { f32::NAN } else { height(x, y) });
            Terrain::new(columns, 2 << patch, heights.collect())
        })
}

/// Cameras along a way with leaps, turns and rests.
pub fn flights() -> impl Strategy<Value = Vec<Camera>> {
    let step = (0u32..4, -20.0..200.0f32, -20.0..240.0f32, 1.0..60.0f32, 0.0..6.3f32, -1.5..0.3f32);
    proptest::collection::vec(step, 2..7).prop_map(|steps| {
        let (mut eye, mut turn, mut pitch) = (Vec3::new(80.0, 80.0, 30.0), 0.0f32, -0.2f32);
        let cameras = steps.into_iter().map(|(kind, x, y, z, heading, tilt)| {
            match kind {
                0 => {}
                1 => eye += Vec3::new(x, y, z) * 0.02,
                2 => (turn, pitch) = (heading, tilt),
                _ => eye = Vec3::new(x, y, z),
            }
            let (sin, cos) = (libm::sinf(pitch), libm::cosf(pitch));
            let forward = Vec3::new(libm::cosf(turn) * cos, libm::sinf(turn) * cos, sin);
            Camera::new(eye, eye + forward * 10.0, 0.9, (160, 120), (0.5, 400.0)).expect("sound")
        });
        cameras.collect()
    })
}

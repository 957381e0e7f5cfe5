//! Grounds that the claims of papers are held to.

// Each test binary uses its own part of this.
#![allow(dead_code)]

use glam::{DVec2, Vec3};
use sandtable_roam::culling::PatchHeights;
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_terrain::lattice::Lattice;
use sandtable_view::camera::Camera;

/// A ground with what refinement needs of it, posts 10 m apart.
pub struct World {
    pub lattice: Lattice,
    pub layout: PatchLayout,
    pub errors: ErrorMap,
    pub heights: PatchHeights,
}

impl World {
    /// Patches of `patch` cells over columns × rows posts of height `height` of their column and row.
    pub fn new((columns, rows): (u32, u32), patch: u32, height: impl Fn(f32, f32) -> f32) -> Self {
        let heights = (0..columns * rows).map(|at| height((at % columns) as f32, (at / columns) as f32));
        let lattice =
            Lattice::new(DVec2::ZERO, DVec2::splat(10.0), columns, heights.collect()).expect("sound");
        let layout = PatchLayout::new(columns, rows, patch).expect("sound");
        let errors = ErrorMap::exact(&lattice, &layout);
        let heights = PatchHeights::new(PatchedGround { lattice: &lattice, layout: &layout });
        Self { lattice, layout, errors, heights }
    }

    /// Hills of all sizes.
    pub fn hills(columns: u32, rows: u32, patch: u32) -> Self {
        Self::new((columns, rows), patch, |x, y| {
            40.0 * libm::sinf(x * 0.05) * libm::cosf(y * 0.04) + 6.0 * libm::sinf(x * 0.7 + y * 0.45)
        })
    }

    pub fn ground(&self) -> PatchedGround<'_> {
        PatchedGround { lattice: &self.lattice, layout: &self.layout }
    }

    pub fn height(&self, vertex: Vertex) -> f32 {
        self.lattice.height(self.layout.post(vertex))
    }

    /// All vertices but the patch corners.
    pub fn vertices(&self) -> Vec<Vertex> {
        let (columns, rows) = (self.layout.columns() as i32, self.layout.rows() as i32);
        let all = (0..rows).flat_map(|y| (0..columns).map(move |x| Vertex::new(x, y)));
        all.filter(|&vertex| !self.layout.is_corner(vertex)).collect()
    }

    /// `own` of a vertex or of any vertex below it, whichever is largest: asked of each, remembered nowhere.
    pub fn largest_below(&self, vertex: Vertex, own: &impl Fn(Vertex) -> f32) -> f32 {
        let below = vertex.children().filter(|&child| self.layout.contains(child));
        below.map(|child| self.largest_below(child, own)).fold(own(vertex), f32::max)
    }

    /// `|z − mean of the ends|` of the hypotenuse that a vertex splits.
    pub fn midpoint_error(&self, vertex: Vertex) -> f32 {
        let [from, to] = vertex.hypotenuse().map(|end| self.height(end));
        (self.height(vertex) - (from + to) / 2.0).abs()
    }
}

/// Whether two lengths or ratios are the same to rounding.
pub fn same(found: f32, expected: f32) -> bool {
    found == expected || (found - expected).abs() <= expected.abs() * 1e-4 + 1e-5
}

pub fn camera(eye: Vec3, target: Vec3) -> Camera {
    Camera::new(eye, target, 0.8, (1024, 768), (1.0, 50_000.0)).expect("sound")
}

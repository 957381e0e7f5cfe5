//! Shadows of solids: depth maps of the draw list as a light sees it, as fine as the picture and only where solids are.
//!
//! # How
//! A map looks down a direction, that of the sun for shadows or straight down for contact shade. Its levels are grids
//! whose texels double from level to level; the depth of a point from the eye names the level whose texels are about
//! as large as its pixels. A level covers what the camera sees at its depths, and of that only the pages of 32×32
//! texels that a solid touches are stored:
//!
//! ```text
//!   eye ◁─ level 0 ─┬── level 1 ──┬────── level 2 ──────      depths double
//!
//!   level: page table  · · 1 2 · ·      · nothing casts: the point is lit, at the cost of one look-up
//!                      · · 3 4 5 ·      1 2 3 … pages, one after the other, for all levels
//!
//!   texel: [greatest height toward the light of a solid, of the displayed ground]
//! ```
//!
//! [`casters`] turns triangles to the map's space, [`levels`] finds the pages, [`fill`] rasterizes them with integer
//! coverage, row of pages by row of pages in parallel; the greatest height does not depend on the order. [`filter`]
//! reads them. Both renderers read the same map, so that they show the same shadows.
//!
//! The ground receives from solids only, since the ground map holds the shadow of terrain on terrain, softer and finer
//! than triangles could cast it. Solids receive from both.
//!
//! # Why not otherwise
//! One map for the whole scene would have texels of meters where a village stands in a scene of 100 km; cascades of a
//! fixed size spend most of their texels on bare ground. Rays through a tree of triangles would be exact, but costly
//! for soft edges, and a graphics adapter could not do the same.
//!
//! # Cost
//! Nothing where a list has no solids. Else 44 bytes and about 20 ns per triangle, 8 bytes per stored texel, of which
//! there are at most [`MOST_PAGES`] pages, and from 9 to some 100 readings per pixel with a solid toward the light.

mod casters;
mod fill;
mod filter;
mod levels;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::draw::list::DrawList;
use crate::render::shadow::casters::Casters;
pub use crate::render::shadow::filter::ShadowReceiver;
use crate::view::camera::Camera;

/// Texels along the side of a page: smaller pages fit solids closer, larger ones have fewer borders to look across.
pub const PAGE: u32 = 32;

/// The most pages of a map, 64 MiB; a map that needs more has larger texels.
pub const MOST_PAGES: usize = 8192;

/// The most levels: the nearest of eight has texels a 128th of the farthest's. What is nearer still shares its texels.
pub const MOST_LEVELS: usize = 8;

/// The shadow radius that filters read at the most, in texels: larger is softer and slower.
const MOST_RADIUS: f32 = 5.0;

/// Texels of the sky's map per pixel of the picture, by length: contact shade is blurred and needs few.
const SKY_TEXEL_PX: f32 = 4.0;

/// The height of a texel where nothing is: finite, since shaders need not know infinity.
const NOTHING: f32 = -1e30;

/// The greatest heights toward a light of solids and of the displayed ground, in meters from the eye.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ShadowTexel {
    pub solid: f32,
    pub ground: f32,
}

impl ShadowTexel {
    pub const EMPTY: Self = Self { solid: NOTHING, ground: NOTHING };

    fn highest(self, other: Self) -> Self {
        Self { solid: self.solid.max(other.solid), ground: self.ground.max(other.ground) }
    }
}

/// Where a page of a level is stored.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ShadowPage {
    /// Its number from 1; 0 where nothing is stored.
    pub number: u32,
    /// The greatest values of its texels.
    pub highest: ShadowTexel,
}

/// A grid of pages of one texel size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowLevel {
    /// Meters along the map's first two axes from the eye to the corner of the first texel.
    pub origin: [f32; 2],
    pub texel_m: f32,
    pub columns: u32,
    pub rows: u32,
    /// Its first entry in [`ShadowMap::pages`].
    pub first: u32,
}

/// The map's right-handed axes: two across the light and one toward it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightAxes {
    pub across: [Vec3; 2],
    pub toward: Vec3,
}

/// How a depth from the eye names a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelScale {
    /// Meters of a texel per meter of depth, at the most.
    pub texel_per_depth: f32,
    /// The base-2 logarithm of the texel of level 0, in meters.
    pub least: i32,
}

#[derive(Clone, Debug)]
pub struct ShadowMap {
    pub eye: Vec3,
    pub forward: Vec3,
    pub axes: LightAxes,
    pub scale: LevelScale,
    /// The finest first; at least one.
    pub levels: Vec<ShadowLevel>,
    pub pages: Vec<ShadowPage>,
    /// Page by page, row by row.
    pub texels: Vec<ShadowTexel>,
}

/// What a map is read for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ShadowPurpose {
    /// Everything toward the light casts.
    Sun,
    /// Only what reaches down to the ground counts: a bridge high above it does not touch it.
    Contact,
}

/// The maps of the sun and of the sky.
#[derive(Clone, Debug, Default)]
pub struct Shadows {
    /// `None` where no solid casts a shadow, or no sun shines.
    pub sun: Option<ShadowMap>,
    /// `None` where there is no solid.
    pub sky: Option<ShadowMap>,
}

impl Shadows {
    /// The maps of a checked list for what `camera` sees.
    pub fn new(list: &DrawList, camera: &Camera) -> Self {
        let to_sun = list.lighting.to_sun;
        let map = |toward: Vec3, texel_px: f32, purpose: ShadowPurpose| {
            let axes = LightAxes::new(toward, camera);
            let casters = Casters::of_solids(list, camera, axes)?;
            ShadowMap::new(list, camera, &casters, texel_px, purpose)
        };
        let sun = if to_sun.z > 0.0 { map(to_sun, 1.0, ShadowPurpose::Sun) } else { None };
        Self { sun, sky: map(Vec3::Z, SKY_TEXEL_PX, ShadowPurpose::Contact) }
    }
}

impl LightAxes {
    /// Axes toward a light (unit vector), turned with the camera so that little of a level is out of view.
    pub fn new(toward: Vec3, camera: &Camera) -> Self {
        let across = |axis: Vec3| (axis - toward * axis.dot(toward)).try_normalize();
        let ahead = [camera.forward(), camera.up()].into_iter().find_map(across);
        let ahead = ahead.unwrap_or_else(|| toward.any_orthonormal_vector());
        Self { across: [ahead.cross(toward), ahead], toward }
    }

    /// A vector's lengths along the axes.
    pub fn turned(&self, vector: Vec3) -> Vec3 {
        Vec3::new(self.across[0].dot(vector), self.across[1].dot(vector), self.toward.dot(vector))
    }
}

impl LevelScale {
    /// The base-2 logarithm, rounded down, of the texels at a depth; taken from the float's exponent, so that every
    /// renderer finds the same.
    pub fn exponent(&self, depth_m: f32) -> i32 {
        let texel_m = (depth_m * self.texel_per_depth).max(f32::MIN_POSITIVE);
        (texel_m.to_bits() >> (f32::MANTISSA_DIGITS - 1)) as i32 - (f32::MAX_EXP - 1)
    }
}

//! The meshes of features: ribbons that lie on the ground, and solids that stand on it.

use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, FeatureId};
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_structure::draped_solid::DrapedSolid;

/// A feature that lies on the ground.
pub struct Ribbon {
    /// Its triangles in plan.
    pub plan: PlanMesh,
    /// Its surface.
    pub surface: RibbonSurface,
    /// A factor of the surface's color and alpha.
    pub tint: Srgba,
    /// Its drawing order: a higher number covers a lower.
    pub layer: u8,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

/// A solid with fixed heights.
pub struct Solid {
    /// Its triangles in world space, at displayed heights.
    pub mesh: DrawMesh,
    /// The look of its triangles.
    pub coat: Coat,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

/// A solid that each picture sets on its displayed ground.
pub struct FeatureSolid {
    /// The solid.
    pub upright: DrapedSolid,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

/// The look of a solid's triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coat {
    /// The colors of their vertices.
    Painted,
    /// Walls with windows where they have texture coordinates, times the colors of their vertices.
    Facade,
    /// The colors of their vertices, on both sides.
    Sheet,
    /// One of the scene's pictures, by its number, times the colors of their vertices, on both sides.
    Picture(u32),
    /// A surface's texture, times the colors of their vertices.
    Surface(RibbonSurface),
}

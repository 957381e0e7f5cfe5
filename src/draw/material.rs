//! Materials of surfaces.

use crate::color::Srgba;

/// The index of a texture in a [`crate::list::DrawList`] or a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TextureId(pub u32);

/// The meaning of alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// The surface is a hole where alpha is below the cut-off, and opaque elsewhere.
    Mask(f32),
    /// Alpha is the share of light the surface stops.
    Blend,
}

/// The source of the normal that takes the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSource {
    /// The mesh's vertices.
    Vertex,
    /// The ground map beneath: draped surfaces are shaded like the ground they lie on.
    Ground,
}

/// The source of the color that is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Albedo {
    /// Base color × vertex color × texture.
    Surface,
    /// The ground map's ramp and contours; base color and texture are not used.
    GroundMap,
    /// Base color without light, in lines of [`hatching_cover`](crate::hatching::hatching_cover); texture and vertex
    /// colors are not used.
    Hatching,
}

/// A surface's color and how it is shaded.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name in the source file, for messages.
    pub name: String,
    /// Multiplied with vertex color and texture.
    pub base_color: Srgba,
    /// The base color texture, repeated in both directions, filtered bilinearly with mip levels.
    pub texture: Option<TextureId>,
    /// The meaning of alpha.
    pub alpha: AlphaMode,
    /// Whether the back of a triangle is drawn too, with its normal turned round.
    pub two_sided: bool,
    /// The source of the normal.
    pub normals: NormalSource,
    /// The source of the color.
    pub albedo: Albedo,
    /// Whether it is water, which mirrors the sky; on the ground map, posts say so.
    pub is_water: bool,
    /// Whether the shadows of other things fall on it; a texture may hold them already.
    pub receives_shadows: bool,
    /// Whether it is natural cover of the ground, whose grain goes through it.
    pub is_natural: bool,
    /// Whether the edges of its triangles are drawn over it, as [`wireframe`](crate::wireframe) says.
    pub shows_edges: bool,
}

impl Material {
    /// Whether color or normals come from the ground map.
    pub fn reads_ground_map(&self) -> bool {
        self.albedo == Albedo::GroundMap || self.normals == NormalSource::Ground
    }
}

impl Default for Material {
    /// Opaque white, one-sided, lit by vertex normals.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Srgba::WHITE,
            texture: None,
            alpha: AlphaMode::Opaque,
            two_sided: false,
            normals: NormalSource::Vertex,
            albedo: Albedo::Surface,
            is_water: false,
            receives_shadows: true,
            is_natural: false,
            shows_edges: false,
        }
    }
}

//! How a surface takes light.

use crate::draw::color::Srgba;

/// The index of a texture in a [`crate::draw::list::DrawList`] or a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TextureId(pub u32);

/// What happens where a material is not opaque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// Alpha below the cut-off is a hole, above it opaque.
    Mask(f32),
    /// Alpha is the share of light the surface stops.
    Blend,
}

/// Where the normal that takes the light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSource {
    /// From the mesh's vertices.
    Vertex,
    /// From the ground map beneath, so that what is draped is shaded like the ground it lies on.
    Ground,
}

/// Where the color that is lit comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Albedo {
    /// Base color × vertex color × texture.
    Surface,
    /// The ground map's ramp and contours; base color and texture are not used.
    GroundMap,
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
    /// What alpha means.
    pub alpha: AlphaMode,
    /// Whether the back of a triangle is drawn too, with its normal turned round.
    pub two_sided: bool,
    /// Where the normal comes from.
    pub normals: NormalSource,
    /// Where the color comes from.
    pub albedo: Albedo,
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
        }
    }
}

//! Materials of surfaces.

use crate::area_texture::AreaTexture;
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

/// What a texture shows along one axis beyond its borders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TextureWrap {
    /// The texture again and again.
    #[default]
    Repeat,
    /// The same, every other time from the far end to the near one, so that equal colors meet.
    Mirror,
    /// The color of the nearest border.
    Clamp,
}

impl TextureWrap {
    /// The coordinate in 0..=1 at which the texture is read for `coordinate`; 0 where it is not finite.
    pub fn fold(self, coordinate: f32) -> f32 {
        let within = match self {
            Self::Repeat => coordinate - coordinate.floor(),
            Self::Mirror => {
                let along = coordinate - 2.0 * (coordinate * 0.5).floor();
                along.min(2.0 - along)
            }
            Self::Clamp => coordinate,
        };
        if within.is_nan() { 0.0 } else { within.clamp(0.0, 1.0) }
    }

    /// The texel of a row of `side`, at least 1, in which `coordinate` lies.
    pub fn texel(self, coordinate: f32, side: u32) -> u32 {
        ((self.fold(coordinate) * side as f32) as u32).min(side - 1)
    }
}

/// A surface's color and how it is shaded.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name in the source file, for messages.
    pub name: String,
    /// Multiplied with vertex color and texture.
    pub base_color: Srgba,
    /// The base color texture, filtered bilinearly with mip levels.
    pub texture: Option<TextureId>,
    /// In place of the texture, for renderers that can: the cover of an area, at the place in the world. Along U its strip fades
    /// toward 0.5, where it has one.
    pub area: Option<AreaTexture>,
    /// What the texture shows beyond its borders, along U and along V.
    pub texture_wrap: [TextureWrap; 2],
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
            area: None,
            texture_wrap: [TextureWrap::Repeat; 2],
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_beyond_the_border_are_folded_into_the_texture() {
        use TextureWrap::{Clamp, Mirror, Repeat};
        for (wrap, coordinate, expected) in [
            (Repeat, 1.25, 0.25),
            (Repeat, -0.25, 0.75),
            (Mirror, 0.25, 0.25),
            (Mirror, 1.25, 0.75),
            (Mirror, -0.25, 0.25),
            (Mirror, -1.25, 0.75),
            (Mirror, 4.25, 0.25),
            (Clamp, 1.25, 1.0),
            (Clamp, -7.0, 0.0),
        ] {
            assert_eq!(wrap.fold(coordinate), expected, "{wrap:?} of {coordinate}");
        }
        assert_eq!([Repeat, Mirror, Clamp].map(|wrap| wrap.texel(1.1, 4)), [0, 3, 3]);
    }

    #[test]
    fn coordinates_that_are_not_finite_are_within_the_texture() {
        for wrap in [TextureWrap::Repeat, TextureWrap::Mirror, TextureWrap::Clamp] {
            for coordinate in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN] {
                assert!((0.0..=1.0).contains(&wrap.fold(coordinate)), "{wrap:?} of {coordinate}");
                assert!(wrap.texel(coordinate, 3) < 3);
            }
        }
    }
}

//! Materials of 3DS and OBJ files: a color, a color map, an opacity map.

use crate::texture::Textures;
use sandtable_draw::color::Srgba;
use sandtable_draw::material::{AlphaMode, Material, TextureId, TextureWrap};

/// A material whose maps are not loaded yet.
#[derive(Clone, Debug)]
pub(super) struct MappedMaterial {
    pub name: String,
    pub color: Srgba,
    /// Replaces `color` where the map can be loaded.
    pub color_under_map: Srgba,
    /// 255 is opaque.
    pub alpha: u8,
    /// The color map.
    pub map: Option<MapFile>,
    /// The opacity map: dark where the surface has holes.
    pub opacity_map: Option<MapFile>,
    pub two_sided: bool,
}

/// The file of a map, and how its values are read.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MapFile {
    pub name: String,
    /// What the map shows beyond its borders, along U and along V.
    pub wrap: [TextureWrap; 2],
    pub range: ValueRange,
}

/// Values of a map, 0..=1, become `base + gain × value`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ValueRange {
    pub base: f32,
    pub gain: f32,
}

/// The values of a texture that a [`ValueRange`] changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum MapValues {
    /// Red, green and blue.
    Colors,
    /// What a mask is read by: its alpha where it has any, else its colors.
    Opacity,
}

impl ValueRange {
    /// The values as they are.
    pub(super) const IDENTITY: Self = Self { base: 0.0, gain: 1.0 };
    /// The negative of a map.
    pub(super) const NEGATIVE: Self = Self { base: 1.0, gain: -1.0 };

    pub(super) fn apply(self, value: u8) -> u8 {
        ((self.base + self.gain * f32::from(value) / 255.0) * 255.0 + 0.5) as u8
    }
}

impl Default for ValueRange {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl MapFile {
    /// `None`, with a note, where it cannot be loaded.
    fn load(&self, textures: &mut Textures<'_>, values: MapValues) -> Option<TextureId> {
        let texture = textures.load(&self.name)?;
        Some(textures.ranged(texture, self.range, values))
    }
}

impl MappedMaterial {
    pub(super) fn load(&self, textures: &mut Textures<'_>) -> Material {
        let map = self.map.as_ref().and_then(|map| map.load(textures, MapValues::Colors));
        let mask = self.opacity_map.as_ref().and_then(|map| map.load(textures, MapValues::Opacity));
        let mut base_color = if map.is_some() { self.color_under_map } else { self.color };
        base_color.0[3] = self.alpha;
        let texture = mask.map_or(map, |mask| textures.masked(map, mask));
        let alpha = match texture {
            _ if self.alpha < 255 => AlphaMode::Blend,
            Some(id) if textures.has_holes(id) => AlphaMode::Mask(0.5),
            _ => AlphaMode::Opaque,
        };
        let laid_on = self.map.as_ref().or(self.opacity_map.as_ref());
        let texture_wrap = laid_on.map(|map| map.wrap).unwrap_or_default();
        if let (Some(map), Some(mask)) = (&self.map, &self.opacity_map)
            && map.wrap != mask.wrap
        {
            let name = &self.name;
            textures.note(format!(
                "the opacity map of material '{name}' goes on beyond its borders like the color map, not in its own way"
            ));
        }
        let (name, two_sided) = (self.name.clone(), self.two_sided);
        Material { name, base_color, texture, texture_wrap, alpha, two_sided, ..Material::default() }
    }
}

/// The material of faces whose own is not defined: light gray, both sides drawn.
pub(super) fn unnamed_material(name: &str) -> Material {
    Material {
        name: name.into(),
        base_color: Srgba::opaque(190, 190, 190),
        two_sided: true,
        ..Material::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_outside_the_range_are_those_of_its_ends() {
        let bright = ValueRange { base: 0.5, gain: 2.0 };
        assert_eq!([0, 32, 255].map(|value| bright.apply(value)), [128, 192, 255]);
        assert_eq!([0, 55, 255].map(|value| ValueRange::NEGATIVE.apply(value)), [255, 200, 0]);
        assert!((0..=255).all(|value| ValueRange::IDENTITY.apply(value) == value));
        assert_eq!(ValueRange { base: f32::NAN, gain: 1.0 }.apply(9), 0);
    }
}

//! Materials of 3DS and OBJ files: a color, a color map, an opacity map.

use crate::texture::Textures;
use sandtable_draw::color::Srgba;
use sandtable_draw::material::{AlphaMode, Material};

/// A material whose maps are not loaded yet.
#[derive(Clone, Debug)]
pub(super) struct MappedMaterial {
    pub name: String,
    pub color: Srgba,
    /// Replaces `color` where the map can be loaded.
    pub color_under_map: Srgba,
    /// 255 is opaque.
    pub alpha: u8,
    /// The color map's file.
    pub map: Option<String>,
    /// The opacity map's file: dark where the surface has holes.
    pub opacity_map: Option<String>,
    pub two_sided: bool,
}

impl MappedMaterial {
    pub(super) fn load(&self, textures: &mut Textures<'_>) -> Material {
        let [map, mask] = [&self.map, &self.opacity_map].map(|file| textures.load(file.as_deref()?));
        let mut base_color = if map.is_some() { self.color_under_map } else { self.color };
        base_color.0[3] = self.alpha;
        let texture = mask.map_or(map, |mask| textures.masked(map, mask));
        let alpha = match texture {
            _ if self.alpha < 255 => AlphaMode::Blend,
            Some(id) if textures.has_holes(id) => AlphaMode::Mask(0.5),
            _ => AlphaMode::Opaque,
        };
        let (name, two_sided) = (self.name.clone(), self.two_sided);
        Material { name, base_color, texture, alpha, two_sided, ..Material::default() }
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

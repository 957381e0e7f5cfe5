//! Materials: base color and its texture, alpha, sides; how texture coordinates are changed before use.

use ::gltf::json::Root;
use ::gltf::json::material;
use ::gltf::json::texture::Info;
use ::gltf::json::validation::Checked;
use glam::{Mat2, Vec2, Vec3};

use crate::draw::color::Srgba;
use crate::draw::material::{AlphaMode, Material, TextureId};
use crate::model::texture::Textures;

use super::data::{self, GltfBuffers};

/// Which texture coordinates a material reads, and how it changes them (KHR_texture_transform).
#[derive(Clone, Copy, Debug)]
pub(super) struct GltfUvTransform {
    pub set: u32,
    turn_and_scale: Mat2,
    offset: Vec2,
}

impl GltfUvTransform {
    /// Set 0 as stored.
    pub(super) const NONE: Self = Self { set: 0, turn_and_scale: Mat2::IDENTITY, offset: Vec2::ZERO };

    fn of(info: &Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref());
        let Some(transform) = transform else { return Self { set: info.tex_coord, ..Self::NONE } };
        let (sin, cos) = libm::sincosf(transform.rotation.0);
        let scale = Vec2::from(transform.scale.0);
        Self {
            set: transform.tex_coord.unwrap_or(info.tex_coord),
            turn_and_scale: Mat2::from_cols(Vec2::new(cos, -sin) * scale.x, Vec2::new(sin, cos) * scale.y),
            offset: transform.offset.0.into(),
        }
    }

    /// Texture coordinates as the texture is to be read; V runs downward in both.
    pub(super) fn apply(&self, uv: Vec2) -> Vec2 {
        let uv = self.turn_and_scale * uv + self.offset;
        if uv.is_finite() { uv } else { Vec2::ZERO }
    }
}

/// The materials of a document, then one for what names none.
pub(super) fn translate_all(
    root: &Root,
    data: &GltfBuffers,
    textures: &mut Textures<'_>,
) -> Vec<(Material, GltfUvTransform)> {
    let mut images: Vec<Option<Option<TextureId>>> = vec![None; root.images.len()];
    let mut all: Vec<_> = root
        .materials
        .iter()
        .map(|material| {
            let pbr = &material.pbr_metallic_roughness;
            let texture = pbr.base_color_texture.as_ref().and_then(|info| {
                let image = root.textures.get(info.index.value())?.source.value();
                *images.get_mut(image)?.get_or_insert_with(|| picture(root, data, image, textures))
            });
            let change = pbr.base_color_texture.as_ref().map_or(GltfUvTransform::NONE, GltfUvTransform::of);
            (translate(material, texture), change)
        })
        .collect();
    all.push((Material { name: "(no material)".into(), ..Material::default() }, GltfUvTransform::NONE));
    all
}

fn translate(material: &::gltf::json::Material, texture: Option<TextureId>) -> Material {
    let [red, green, blue, opacity] = material.pbr_metallic_roughness.base_color_factor.0;
    let mut base_color = Srgba::from_linear(Vec3::new(red, green, blue));
    base_color.0[3] = (opacity * 255.0 + 0.5) as u8;
    let alpha = match material.alpha_mode {
        Checked::Valid(material::AlphaMode::Mask) => {
            AlphaMode::Mask(material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0))
        }
        Checked::Valid(material::AlphaMode::Blend) => AlphaMode::Blend,
        _ => AlphaMode::Opaque,
    };
    Material {
        name: material.name.clone().unwrap_or_default(),
        base_color,
        texture,
        alpha,
        two_sided: material.double_sided,
        ..Material::default()
    }
}

/// The texture of image `index`; `None`, with a note, where it cannot be had.
fn picture(root: &Root, data: &GltfBuffers, index: usize, textures: &mut Textures<'_>) -> Option<TextureId> {
    let image = root.images.get(index)?;
    let name = image.name.clone().unwrap_or_else(|| format!("image {index}"));
    match (image.buffer_view, &image.uri) {
        (Some(view), _) => match data.view(root, view.value()) {
            Ok(view) => textures.decode(&name, view.bytes),
            Err(error) => textures.miss(&name, &error.to_string()),
        },
        (None, Some(uri)) if uri.starts_with("data:") => match data::bytes_of(uri) {
            Ok(bytes) => textures.decode(&name, &bytes),
            Err(reason) => textures.miss(&name, &reason),
        },
        (None, Some(uri)) => match data::file_name(uri) {
            Ok(file) => textures.by_name(&file),
            Err(reason) => textures.miss(&name, &reason),
        },
        (None, None) => textures.miss(&name, "it has neither a view nor a uri"),
    }
}

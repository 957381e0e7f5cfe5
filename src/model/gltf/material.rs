//! Materials: base color and its texture, how that goes on beyond its borders, alpha, sides, and the transform of texture
//! coordinates.

use ::gltf::material::AlphaMode as GltfAlphaMode;
use ::gltf::texture::{Info, MagFilter, WrappingMode};
use ::gltf::{Document, Image};
use glam::{Mat2, Vec2, Vec3};

use crate::error::{CompanionError, GltfDataError};
use crate::texture::Textures;
use sandtable_draw::color::Srgba;
use sandtable_draw::material::{AlphaMode, Material, TextureId, TextureWrap};

use super::data::{GltfBuffers, decode_data_uri, file_name};

pub(super) struct GltfMaterial {
    pub material: Material,
    pub uv: GltfUvTransform,
}

/// Which texture coordinates a material reads, and how it transforms them (KHR_texture_transform).
#[derive(Clone, Copy, Debug)]
pub(super) struct GltfUvTransform {
    pub set: u32,
    rotation_and_scale: Mat2,
    offset: Vec2,
}

impl GltfUvTransform {
    /// Set 0 as stored.
    pub(super) const IDENTITY: Self = Self { set: 0, rotation_and_scale: Mat2::IDENTITY, offset: Vec2::ZERO };

    fn new(info: &Info<'_>) -> Self {
        let Some(transform) = info.texture_transform() else {
            return Self { set: info.tex_coord(), ..Self::IDENTITY };
        };
        let (sin, cos) = libm::sincosf(transform.rotation());
        let scale = Vec2::from(transform.scale());
        Self {
            set: transform.tex_coord().unwrap_or(info.tex_coord()),
            rotation_and_scale: Mat2::from_cols(
                Vec2::new(cos, -sin) * scale.x,
                Vec2::new(sin, cos) * scale.y,
            ),
            offset: transform.offset().into(),
        }
    }

    /// The coordinates at which the texture is read; V runs downward in both. Zero where one is not finite.
    pub(super) fn apply(&self, uv: Vec2) -> Vec2 {
        let uv = self.rotation_and_scale * uv + self.offset;
        if uv.is_finite() { uv } else { Vec2::ZERO }
    }
}

/// The materials of a document, then one for primitives without a material.
pub(super) fn load_materials(
    document: &Document,
    buffers: &GltfBuffers,
    textures: &mut Textures<'_>,
) -> Vec<GltfMaterial> {
    let mut images: Vec<Option<Option<TextureId>>> = vec![None; document.images().len()];
    let mut materials = Vec::new();
    for material in document.materials() {
        let info = material.pbr_metallic_roughness().base_color_texture();
        let texture = info.as_ref().and_then(|info| {
            let Some(image) = info.texture().source() else {
                let name = format!("of material {}", materials.len());
                return textures.unusable(&name, &GltfDataError::NoSource);
            };
            *images[image.index()].get_or_insert_with(|| load_image(document, &image, buffers, textures))
        });
        let uv = info.as_ref().map_or(GltfUvTransform::IDENTITY, GltfUvTransform::new);
        let mut translated = translate(&material, texture);
        if let (Some(info), Some(_)) = (&info, texture) {
            let sampler = info.texture().sampler();
            translated.texture_wrap = [sampler.wrap_s(), sampler.wrap_t()].map(wrap);
            if sampler.mag_filter() == Some(MagFilter::Nearest) {
                let index = info.texture().index();
                textures
                    .note(format!("texture {index} asks for hard texels (NEAREST); it is drawn filtered"));
            }
        }
        materials.push(GltfMaterial { material: translated, uv });
    }
    let unnamed = Material { name: "(no material)".into(), ..Material::default() };
    materials.push(GltfMaterial { material: unnamed, uv: GltfUvTransform::IDENTITY });
    materials
}

fn wrap(mode: WrappingMode) -> TextureWrap {
    match mode {
        WrappingMode::Repeat => TextureWrap::Repeat,
        WrappingMode::MirroredRepeat => TextureWrap::Mirror,
        WrappingMode::ClampToEdge => TextureWrap::Clamp,
    }
}

fn translate(material: &::gltf::Material<'_>, texture: Option<TextureId>) -> Material {
    let [red, green, blue, opacity] = material.pbr_metallic_roughness().base_color_factor();
    let mut base_color = Srgba::from_linear(Vec3::new(red, green, blue));
    base_color.0[3] = (opacity * 255.0 + 0.5) as u8;
    Material {
        name: material.name().unwrap_or_default().into(),
        base_color,
        texture,
        alpha: match material.alpha_mode() {
            GltfAlphaMode::Opaque => AlphaMode::Opaque,
            GltfAlphaMode::Mask => AlphaMode::Mask(material.alpha_cutoff().unwrap_or(0.5)),
            GltfAlphaMode::Blend => AlphaMode::Blend,
        },
        two_sided: material.double_sided(),
        ..Material::default()
    }
}

/// The texture of an image; `None`, with a note, where it cannot be loaded.
fn load_image(
    document: &Document,
    image: &Image<'_>,
    buffers: &GltfBuffers,
    textures: &mut Textures<'_>,
) -> Option<TextureId> {
    // `Image::source` panics where the document names no source.
    let stored = &document.as_json().images[image.index()];
    let name = image.name().map_or_else(|| format!("image {}", image.index()), Into::into);
    let view = stored.buffer_view.and_then(|view| document.views().nth(view.value()));
    let load = |textures: &mut Textures<'_>| -> Result<Option<TextureId>, CompanionError> {
        Ok(match (view, &stored.uri) {
            (Some(view), _) => textures.decode(&name, buffers.view(&view)?.bytes),
            (None, Some(uri)) if uri.starts_with("data:") => textures.decode(&name, &decode_data_uri(uri)?),
            (None, Some(uri)) => textures.load(&file_name(uri)?),
            (None, None) => return Err(GltfDataError::NoSource.into()),
        })
    };
    load(textures).unwrap_or_else(|error| textures.unusable(&name, &*error))
}

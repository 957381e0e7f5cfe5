//! Materials and their textures on the device.
//!
//! ```text
//!   table        one row of texels a material: color, flags, layer of its texture; row 0 is the bare ground's
//!   array 0      no texture: white
//!   array 1 …    textures of one size that go on alike beyond their borders, layer by layer, each with its smaller levels
//! ```
//!
//! A vertex names its material. So whatever has textures of one size is drawn with one call, in its order, however often
//! materials alternate along it.

use std::collections::BTreeMap;

use bytemuck::cast_slice;
use rayon::prelude::*;

use crate::error::GpuError;
use crate::layouts::Layouts;
use crate::memory::{Loader, bind, texture, view};
use crate::uniforms::SurfaceConstants;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawList, MaterialId};
use sandtable_draw::material::{Albedo, AlphaMode, Material, NormalSource, TextureWrap};
use sandtable_draw::pixels::Pixels;
use sandtable_render::mip_levels::smaller_levels;

/// Materials in a row of the table, and texels of each; the shader's constants of the same names.
const TABLE_MATERIALS: usize = 64;
const MATERIAL_TEXELS: u32 = 12;

/// The textures of one size that are bound together; 0 has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct ArrayId(pub u32);

impl ArrayId {
    /// No texture.
    pub const NONE: Self = Self(0);
}

/// The places of the textures of materials.
#[derive(Debug, Default)]
pub struct TexturePlaces {
    /// By material: the array and the layer.
    by_material: Vec<(ArrayId, u32)>,
    /// From array 1 on.
    arrays: Vec<TextureArray>,
}

/// Textures that one sampler reads, as stored or with colors multiplied by alpha.
#[derive(Debug)]
struct TextureArray {
    kind: ArrayKind,
    layers: Vec<TextureForm>,
}

/// What the textures of an array have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ArrayKind {
    sides: [u32; 2],
    wrap: [TextureWrap; 2],
}

/// A texture as opaque materials show it, or as all others do, with colors multiplied by alpha: filtering must not mix in
/// transparent colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct TextureForm {
    texture: u32,
    multiplied: bool,
}

/// The textures of a list that are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureScope {
    /// Those of its items.
    Items,
    /// Those of all materials: of what will lie on the ground, too.
    All,
    /// Those that cut holes in its items.
    Masks,
}

#[derive(Debug)]
pub struct GpuMaterials {
    /// Group 1 with each array.
    groups: Vec<wgpu::BindGroup>,
}

impl TexturePlaces {
    /// The places for the textures of a checked list on an adapter with these limits.
    pub fn new(list: &DrawList, scope: TextureScope, limits: &wgpu::Limits) -> Self {
        let mut used = vec![scope == TextureScope::All; list.materials.len()];
        list.items.iter().for_each(|item| used[item.material.0 as usize] = true);
        let [largest, most_layers] = [limits.max_texture_dimension_2d, limits.max_texture_array_layers];
        // Filled up by `padded_layers`.
        let most = most_layers.saturating_sub(1).max(1) as usize;
        let mut places = Self { by_material: vec![(ArrayId::NONE, 0); used.len()], ..Self::default() };
        let mut known: BTreeMap<(TextureForm, ArrayKind), (ArrayId, u32)> = BTreeMap::new();
        let mut open: BTreeMap<ArrayKind, usize> = BTreeMap::new();
        for (index, material) in list.materials.iter().enumerate() {
            let is_shown = scope != TextureScope::Masks || matches!(material.alpha, AlphaMode::Mask(_));
            let is_read = used[index] && is_shown && material.area.is_none();
            let Some(id) = material.texture.filter(|_| is_read) else {
                continue;
            };
            let pixels = &list.textures[id.0 as usize];
            let Some(&sides) = level_sides(pixels, largest).first() else { continue };
            let kind = ArrayKind { sides, wrap: material.texture_wrap };
            let form = TextureForm { texture: id.0, multiplied: material.alpha != AlphaMode::Opaque };
            places.by_material[index] = *known.entry((form, kind)).or_insert_with(|| {
                let array = open
                    .get(&kind)
                    .copied()
                    .filter(|&array| places.arrays[array].layers.len() < most)
                    .unwrap_or_else(|| {
                        places.arrays.push(TextureArray { kind, layers: Vec::new() });
                        places.arrays.len() - 1
                    });
                open.insert(kind, array);
                places.arrays[array].layers.push(form);
                (ArrayId(array as u32 + 1), places.arrays[array].layers.len() as u32 - 1)
            });
        }
        places
    }

    /// The array that holds the texture of a material.
    pub fn array_of(&self, material: MaterialId) -> ArrayId {
        self.by_material[material.0 as usize].0
    }
}

impl GpuMaterials {
    /// Sends the materials of a checked list and the textures that items use.
    pub fn upload(
        loader: &Loader<'_>,
        layouts: &Layouts,
        list: &DrawList,
        places: &TexturePlaces,
    ) -> Result<Self, GpuError> {
        let table = view(&table(loader, list, places)?);
        let mut samplers = BTreeMap::new();
        let white_kind = ArrayKind { sides: [1, 1], wrap: [TextureWrap::Repeat; 2] };
        let white = TextureArray { kind: white_kind, layers: Vec::new() };
        let group = |array: &TextureArray| {
            let wrap = array.kind.wrap;
            let sampler = samplers.entry(wrap).or_insert_with(|| base_sampler(loader, wrap));
            let texture = upload_array(loader, array, list)?;
            let layers = texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("textures of one size"),
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            });
            let resources = [
                wgpu::BindingResource::TextureView(&table),
                wgpu::BindingResource::TextureView(&layers),
                wgpu::BindingResource::Sampler(sampler),
            ];
            Ok(bind(loader.gpu, "materials", &layouts.materials, resources))
        };
        let groups = std::iter::once(&white).chain(&places.arrays).map(group);
        Ok(Self { groups: groups.collect::<Result<_, GpuError>>()? })
    }

    /// Group 1 with the textures of an array.
    pub fn group(&self, array: ArrayId) -> &wgpu::BindGroup {
        &self.groups[array.0 as usize]
    }
}

fn table(loader: &Loader<'_>, list: &DrawList, places: &TexturePlaces) -> Result<wgpu::Texture, GpuError> {
    let ground = Material {
        name: "ground".into(),
        normals: NormalSource::Ground,
        albedo: Albedo::GroundMap,
        ..Material::default()
    };
    let own = list.materials.iter().zip(&places.by_material);
    let rows = std::iter::once((&ground, &(ArrayId::NONE, 0))).chain(own);
    let layer_of = |&(array, layer): &(ArrayId, u32)| (array != ArrayId::NONE).then_some(layer);
    let mut constants: Vec<SurfaceConstants> =
        rows.map(|(material, place)| SurfaceConstants::new(material, layer_of(place))).collect();
    let rows = constants.len().div_ceil(TABLE_MATERIALS);
    let none = constants[0];
    constants.resize(rows * TABLE_MATERIALS, none);
    let (width, height) = (TABLE_MATERIALS as u32 * MATERIAL_TEXELS, rows as u32);
    let what = || format!("the {} materials", list.materials.len());
    let descriptor = texture("table of materials", width, height, wgpu::TextureFormat::Rgba32Uint);
    let table = loader.texture(what, &descriptor)?;
    loader.gpu.write(table.as_image_copy(), width, height, cast_slice(&constants));
    Ok(table)
}

/// An array of textures with their levels; one of no textures is white.
fn upload_array(
    loader: &Loader<'_>,
    array: &TextureArray,
    list: &DrawList,
) -> Result<wgpu::Texture, GpuError> {
    let gpu = loader.gpu;
    let [width, height] = array.kind.sides;
    let levels_of = |form: &TextureForm| -> Vec<Pixels> {
        let levels = levels(&list.textures[form.texture as usize], gpu.limits.max_texture_dimension_2d);
        if form.multiplied { levels.par_iter().map(premultiplied).collect() } else { levels }
    };
    let white = [Pixels::filled(1, 1, Srgba::WHITE)];
    let mut descriptor = texture("textures of one size", width, height, wgpu::TextureFormat::Rgba8UnormSrgb);
    descriptor.mip_level_count = width.max(height).ilog2() + 1;
    descriptor.size.depth_or_array_layers = padded_layers(array.layers.len() as u32);
    let what = || format!("{} textures of {width}×{height} texels", array.layers.len());
    let texture = loader.texture(what, &descriptor)?;
    if array.layers.is_empty() {
        write_layer(loader, &texture, 0, &white);
    }
    for (layer, form) in (0..).zip(&array.layers) {
        write_layer(loader, &texture, layer, &levels_of(form));
    }
    Ok(texture)
}

fn write_layer(loader: &Loader<'_>, texture: &wgpu::Texture, layer: u32, levels: &[Pixels]) {
    for (mip_level, level) in (0..).zip(levels) {
        let mut to = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
        to.origin.z = layer;
        loader.gpu.write(to, level.width(), level.height(), level.bytes());
    }
}

/// Layers that are never one nor a multiple of six: OpenGL drivers take the first for a plain texture and the others for
/// cube maps.
fn padded_layers(layers: u32) -> u32 {
    let layers = layers.max(1);
    if layers == 1 || layers.is_multiple_of(6) { layers + 1 } else { layers }
}

/// Goes on beyond the borders as `wrap` says and blends between the two nearest levels.
fn base_sampler(loader: &Loader<'_>, wrap: [TextureWrap; 2]) -> wgpu::Sampler {
    let [across, down] = wrap.map(|wrap| match wrap {
        TextureWrap::Repeat => wgpu::AddressMode::Repeat,
        TextureWrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        TextureWrap::Clamp => wgpu::AddressMode::ClampToEdge,
    });
    loader.gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("base color"),
        address_mode_u: across,
        address_mode_v: down,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        anisotropy_clamp: loader.gpu.anisotropy,
        ..Default::default()
    })
}

/// The sides of `texture` and of its smaller levels down to a single texel that are at most `limit` a side; none where a
/// side is zero.
fn level_sides(texture: &Pixels, limit: u32) -> Vec<[u32; 2]> {
    let first = [texture.width(), texture.height()];
    let smaller =
        |sides: &[u32; 2]| (sides.iter().any(|&side| side > 1)).then(|| sides.map(|side| (side / 2).max(1)));
    let all = std::iter::successors((!first.contains(&0)).then_some(first), smaller);
    all.filter(|sides| sides.iter().all(|&side| side <= limit)).collect()
}

/// `texture` and every smaller level down to a single texel; none where a side is zero. Levels larger than `limit` a
/// side are left out, so that a texture too large for the adapter is drawn coarser.
pub fn levels(texture: &Pixels, limit: u32) -> Vec<Pixels> {
    let fits = |level: &Pixels| (1..=limit).contains(&level.width()) && (1..=limit).contains(&level.height());
    let largest = fits(texture).then(|| texture.clone());
    largest.into_iter().chain(smaller_levels(texture).into_iter().filter(fits)).collect()
}

/// `level` with colors multiplied by alpha, in linear light.
pub fn premultiplied(level: &Pixels) -> Pixels {
    Pixels::from_fn(level.width(), level.height(), |x, y| {
        let texel = level.at(x, y);
        let Srgba([red, green, blue, _]) = Srgba::from_linear(texel.linear() * texel.alpha());
        Srgba([red, green, blue, texel.0[3]])
    })
}

#[cfg(test)]
mod tests {
    use bytemuck::bytes_of;

    use super::*;
    use crate::merged_vertex::MaterialRow;
    use glam::Mat4;
    use sandtable_draw::list::{DepthLayer, DrawItem, DrawMesh, FeatureId};

    /// A list of materials with textures of the given sides, each drawn once as opaque and once as blended.
    fn list(textures: &[[u32; 2]]) -> DrawList {
        let mut list = DrawList::default();
        let mesh = list.add_mesh(DrawMesh::default());
        for &[width, height] in textures {
            let texture = Some(list.add_texture(Pixels::filled(width, height, Srgba::WHITE)));
            for alpha in [AlphaMode::Opaque, AlphaMode::Blend] {
                let material = list.add_material(Material { texture, alpha, ..Material::default() });
                list.items.push(DrawItem {
                    mesh,
                    triangles: 0..0,
                    material,
                    world_from_mesh: Mat4::IDENTITY,
                    layer: DepthLayer::Solid,
                    feature: FeatureId::GROUND,
                });
            }
        }
        list
    }

    fn limits(max_texture_dimension_2d: u32, max_texture_array_layers: u32) -> wgpu::Limits {
        wgpu::Limits { max_texture_dimension_2d, max_texture_array_layers, ..Default::default() }
    }

    #[test]
    fn textures_of_one_size_share_an_array_as_far_as_it_has_layers() {
        let list = list(&[[8, 8], [4, 8], [8, 8], [0, 3], [64, 64]]);
        let places = TexturePlaces::new(&list, TextureScope::Items, &limits(32, 4));
        let found: Vec<(u32, u32)> =
            places.by_material.iter().map(|(array, layer)| (array.0, *layer)).collect();
        let none = (0, 0);
        let expected = [(1, 0), (1, 1), (2, 0), (2, 1), (1, 2), (3, 0), none, none, (4, 0), (4, 1)];
        assert_eq!(found, expected);
        assert_eq!(places.arrays[3].kind.sides, [32, 32]);
        let unused = DrawList { items: Vec::new(), ..list.clone() };
        let arrays = |scope| TexturePlaces::new(&unused, scope, &limits(32, 4)).arrays.len();
        assert_eq!([TextureScope::Items, TextureScope::All].map(arrays), [0, 4]);
        let mut masked = list.clone();
        masked.materials[8].alpha = AlphaMode::Mask(0.5);
        let places = TexturePlaces::new(&masked, TextureScope::Masks, &limits(32, 4));
        assert_eq!(places.arrays.iter().map(|array| array.layers.len()).collect::<Vec<_>>(), [1]);
    }

    #[test]
    fn a_texture_that_goes_on_in_two_ways_lies_in_two_arrays() {
        let mut list = list(&[[8, 8], [8, 8]]);
        list.materials[2].texture_wrap = [TextureWrap::Mirror, TextureWrap::Clamp];
        let places = TexturePlaces::new(&list, TextureScope::Items, &limits(32, 4));
        let found: Vec<(u32, u32)> =
            places.by_material.iter().map(|(array, layer)| (array.0, *layer)).collect();
        assert_eq!(found, [(1, 0), (1, 1), (2, 0), (1, 2)]);
        assert_eq!(places.arrays[1].kind.wrap, [TextureWrap::Mirror, TextureWrap::Clamp]);
    }

    #[test]
    fn layers_are_never_one_nor_a_multiple_of_six() {
        assert_eq!([0, 1, 2, 5, 6, 7, 12].map(padded_layers), [2, 2, 2, 5, 7, 7, 13]);
    }

    #[test]
    fn a_material_is_three_texels_of_the_table() {
        assert_eq!(size_of::<SurfaceConstants>(), MATERIAL_TEXELS as usize * size_of::<[u32; 4]>());
        assert_eq!(bytes_of(&MaterialRow::from(MaterialId(4))), 5u32.to_ne_bytes());
    }

    #[test]
    fn transparent_texels_are_black_when_multiplied() {
        let leaf = Srgba([20, 120, 30, 255]);
        let edge = Pixels::from_fn(2, 1, |x, _| if x == 0 { leaf } else { Srgba([255, 0, 255, 0]) });
        assert_eq!(premultiplied(&edge).data(), [leaf, Srgba([0, 0, 0, 0])]);
    }

    #[test]
    fn a_texture_too_large_for_the_adapter_starts_at_a_smaller_level() {
        let widths = |width, height, limit| -> Vec<u32> {
            let texture = Pixels::filled(width, height, Srgba::WHITE);
            let sides = level_sides(&texture, limit);
            let levels = levels(&texture, limit);
            assert_eq!(sides, levels.iter().map(|level| [level.width(), level.height()]).collect::<Vec<_>>());
            levels.iter().map(Pixels::width).collect()
        };
        assert_eq!(widths(64, 8, 16), [16, 8, 4, 2, 1]);
        assert_eq!(widths(4, 4, 8192), [4, 2, 1]);
        assert!(widths(0, 8, 16).is_empty());
    }
}

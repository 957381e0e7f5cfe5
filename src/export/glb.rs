//! A draw list as binary glTF: a node for each thing, meshes shared by all nodes that show them.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::{Vec2, Vec3};
use serde_json::{Value, json};

use crate::SceneExport;
use sandtable_draw::color::{Srgba, linear_from_srgb};
use sandtable_draw::list::{DrawItem, DrawVertex, MaterialId, MeshId};
use sandtable_draw::material::{AlphaMode, Material, TextureId, TextureWrap};
use sandtable_files::png::encode_png;
use sandtable_mesh::numbering::Numbering;
use sandtable_mesh::write::glb::{GlbNode, GlbPrimitive, GlbScene, GlbTexture, GlbVertices, GlbWrap};

/// Writes the file.
///
/// # Errors
/// `out` cannot be written, or the file would exceed 4 GiB.
pub fn write(export: &SceneExport<'_>, out: &mut impl Write) -> io::Result<()> {
    let mut builder = GlbSceneBuilder::default();
    for items in export.list.items.chunk_by(is_same_object) {
        builder.add_node(export, items);
    }
    builder.scene.write(export.remarks, out)
}

/// Whether two items are parts of one thing in one place, such as the parts of a model.
fn is_same_object(a: &DrawItem, b: &DrawItem) -> bool {
    a.feature == b.feature && a.world_from_mesh == b.world_from_mesh && a.layer == b.layer
}

/// The key of a primitive: a mesh, a range of its triangles and a material.
type PrimitiveKey = (MeshId, [u32; 2], MaterialId);

/// A scene under construction, and the index of each of its elements.
#[derive(Default)]
struct GlbSceneBuilder {
    scene: GlbScene<'static>,
    /// Meshes by their primitives; `None` for those without a triangle.
    meshes: BTreeMap<Vec<PrimitiveKey>, Option<usize>>,
    /// Vertices of a mesh, with or without texture coordinates.
    vertices: Numbering<(MeshId, bool)>,
    materials: Numbering<MaterialId>,
    textures: Numbering<GlbTexture>,
    images: Numbering<TextureId>,
}

impl GlbSceneBuilder {
    /// Adds items that are one thing; nothing where none of their triangles has an area.
    fn add_node(&mut self, export: &SceneExport<'_>, items: &[DrawItem]) {
        let part = |item: &DrawItem| (item.mesh, [item.triangles.start, item.triangles.end], item.material);
        let key: Vec<PrimitiveKey> = items.iter().map(part).collect();
        if !self.meshes.contains_key(&key) {
            let primitives: Vec<_> = items.iter().filter_map(|item| self.primitive(export, item)).collect();
            let mesh = (!primitives.is_empty()).then_some(self.scene.meshes.len());
            self.scene.meshes.extend(mesh.map(|_| primitives));
            self.meshes.insert(key.clone(), mesh);
        }
        if let Some(mesh) = self.meshes[&key] {
            let (name, world_from_mesh) = ((export.name_of)(items[0].feature), items[0].world_from_mesh);
            self.scene.nodes.push(GlbNode { name, mesh, world_from_mesh });
        }
    }

    fn primitive(&mut self, export: &SceneExport<'_>, item: &DrawItem) -> Option<GlbPrimitive<'static>> {
        let triangles: Vec<_> = export.triangles(item).collect();
        (!triangles.is_empty()).then(|| GlbPrimitive {
            vertices: self.add_vertices(export, item),
            triangles: Cow::Owned(triangles),
            material: Some(self.add_material(export, item)),
        })
    }

    fn add_vertices(&mut self, export: &SceneExport<'_>, item: &DrawItem) -> usize {
        let is_textured = export.material(item).texture.is_some();
        let number = self.vertices.number((item.mesh, is_textured));
        if number.is_new {
            let all = &export.mesh(item).vertices;
            let is_colored = all.iter().any(|vertex| vertex.color != Srgba::WHITE);
            let normal = |vertex: &DrawVertex| Vec3::from(vertex.normal).normalize_or(Vec3::Z);
            let uv = |vertex: &DrawVertex| is_textured.then(|| Vec2::from(vertex.uv));
            let color = |vertex: &DrawVertex| is_colored.then(|| linear(vertex.color));
            self.scene.vertices.push(GlbVertices {
                positions: all.iter().map(|vertex| Vec3::from(vertex.position)).collect(),
                normals: all.iter().map(normal).collect(),
                uvs: all.iter().filter_map(uv).collect(),
                colors: all.iter().filter_map(color).collect(),
            });
        }
        number.index as usize
    }

    fn add_material(&mut self, export: &SceneExport<'_>, item: &DrawItem) -> usize {
        let number = self.materials.number(item.material);
        if number.is_new {
            let material = export.material(item);
            let texture = self.add_texture(export, material);
            self.scene.materials.push(object_of(material, texture));
        }
        number.index as usize
    }

    /// The material's texture; `None` where it has none, or one without pixels.
    fn add_texture(&mut self, export: &SceneExport<'_>, material: &Material) -> Option<usize> {
        let image = self.add_image(export, material.texture?)?;
        let wrap = material.texture_wrap.map(|wrap| match wrap {
            TextureWrap::Repeat => GlbWrap::Repeat,
            TextureWrap::Mirror => GlbWrap::MirroredRepeat,
            TextureWrap::Clamp => GlbWrap::ClampToEdge,
        });
        let texture = GlbTexture { image, wrap };
        let number = self.textures.number(texture);
        if number.is_new {
            self.scene.textures.push(texture);
        }
        Some(number.index as usize)
    }

    /// The texture's image; `None` where it has no pixels.
    fn add_image(&mut self, export: &SceneExport<'_>, texture: TextureId) -> Option<usize> {
        let pixels = &export.list.textures[texture.0 as usize];
        if pixels.data().is_empty() {
            return None;
        }
        let number = self.images.number(texture);
        if number.is_new {
            self.scene.images.push(encode_png(pixels));
        }
        Some(number.index as usize)
    }
}

/// Linear light and alpha in 16 bits each: 8 would lose the darks.
fn linear(color: Srgba) -> [u16; 4] {
    let [red, green, blue, alpha] = color.0;
    let light = |channel: u8| (linear_from_srgb(channel) * 65535.0).round() as u16;
    [light(red), light(green), light(blue), u16::from(alpha) * 257]
}

fn object_of(material: &Material, texture: Option<usize>) -> Value {
    let [red, green, blue] = material.base_color.linear().to_array();
    let alpha = if material.alpha == AlphaMode::Opaque { 1.0 } else { material.base_color.alpha() };
    let mut object = json!({"pbrMetallicRoughness": {
        "baseColorFactor": [red, green, blue, alpha], "metallicFactor": 0.0, "roughnessFactor": 1.0,
    }});
    if let Some(texture) = texture {
        object["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": texture});
    }
    if !material.name.is_empty() {
        object["name"] = json!(material.name);
    }
    match material.alpha {
        AlphaMode::Opaque => {}
        AlphaMode::Mask(cutoff) => {
            object["alphaMode"] = json!("MASK");
            object["alphaCutoff"] = json!(cutoff.max(0.0));
        }
        AlphaMode::Blend => object["alphaMode"] = json!("BLEND"),
    }
    if material.two_sided {
        object["doubleSided"] = json!(true);
    }
    object
}

//! A draw list as binary glTF: a node for each thing, meshes shared by all nodes that show them.

use std::borrow::Cow;
use std::io::{self, Write};

use glam::{Vec2, Vec3};
use serde_json::{Value, json};

use crate::draw::color::{Srgba, linear_from_srgb};
use crate::draw::list::{DrawItem, MaterialId, MeshId};
use crate::draw::material::{AlphaMode, Material, TextureId};
use crate::export::{SceneExport, png};
use crate::mesh::numbering::Numbering;
use crate::mesh::sink::VertexId;
use crate::mesh::write::glb::{GlbNode, GlbPrimitive, GlbScene, GlbVertices};

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

/// What makes a primitive: a mesh, a range of its triangles and a material.
type PrimitiveKey = (MeshId, [u32; 2], MaterialId);

/// A scene under construction, and the index of each of its elements.
#[derive(Default)]
struct GlbSceneBuilder {
    scene: GlbScene<'static>,
    /// Meshes by what they are made of; `None` for those without a triangle.
    meshes: std::collections::BTreeMap<Vec<PrimitiveKey>, Option<usize>>,
    /// Vertices of a mesh, with or without texture coordinates.
    vertices: Numbering<(MeshId, bool)>,
    materials: Numbering<MaterialId>,
    images: Numbering<TextureId>,
}

impl GlbSceneBuilder {
    /// Adds items that are one thing; nothing where no triangle of theirs has an area.
    fn add_node(&mut self, export: &SceneExport<'_>, items: &[DrawItem]) {
        let part = |item: &DrawItem| (item.mesh, [item.triangles.start, item.triangles.end], item.material);
        let key: Vec<PrimitiveKey> = items.iter().map(part).collect();
        let mesh = match self.meshes.get(&key) {
            Some(&known) => known,
            None => {
                let mesh = self.add_mesh(export, items);
                self.meshes.insert(key, mesh);
                mesh
            }
        };
        if let Some(mesh) = mesh {
            let (name, world_from_mesh) = ((export.name_of)(items[0].feature), items[0].world_from_mesh);
            self.scene.nodes.push(GlbNode { name, mesh, world_from_mesh });
        }
    }

    fn add_mesh(&mut self, export: &SceneExport<'_>, items: &[DrawItem]) -> Option<usize> {
        let primitives: Vec<_> = items.iter().filter_map(|item| self.primitive(export, item)).collect();
        (!primitives.is_empty()).then(|| {
            self.scene.meshes.push(primitives);
            self.scene.meshes.len() - 1
        })
    }

    fn primitive(&mut self, export: &SceneExport<'_>, item: &DrawItem) -> Option<GlbPrimitive<'static>> {
        let mesh = export.mesh(item);
        let position = |id: VertexId| Vec3::from(mesh.vertices[id.index()].position);
        let has_area = |corners: &[VertexId; 3]| {
            let [a, b, c] = corners.map(position);
            (b - a).cross(c - a) != Vec3::ZERO
        };
        let triangles: Vec<_> = export.triangles(item).iter().copied().filter(has_area).collect();
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
            let vertices = &export.mesh(item).vertices;
            let is_colored = vertices.iter().any(|vertex| vertex.color != Srgba::WHITE);
            let normal = |normal: [f32; 3]| Vec3::from(normal).normalize_or(Vec3::Z);
            let uvs = is_textured.then(|| vertices.iter().map(|vertex| Vec2::from(vertex.uv)).collect());
            let colors = is_colored.then(|| vertices.iter().map(|vertex| linear(vertex.color)).collect());
            self.scene.vertices.push(GlbVertices {
                positions: vertices.iter().map(|vertex| Vec3::from(vertex.position)).collect(),
                normals: vertices.iter().map(|vertex| normal(vertex.normal)).collect(),
                uvs: uvs.unwrap_or_default(),
                colors: colors.unwrap_or_default(),
            });
        }
        number.index as usize
    }

    fn add_material(&mut self, export: &SceneExport<'_>, item: &DrawItem) -> usize {
        let number = self.materials.number(item.material);
        if number.is_new {
            let material = export.material(item);
            let image = material.texture.and_then(|texture| self.add_image(export, texture));
            self.scene.materials.push(object_of(material, image));
        }
        number.index as usize
    }

    /// The texture's image; `None` where it has no pixels.
    fn add_image(&mut self, export: &SceneExport<'_>, texture: TextureId) -> Option<usize> {
        let pixels = &export.list.textures[texture.0 as usize];
        if pixels.data().is_empty() {
            return None;
        }
        let number = self.images.number(texture);
        if number.is_new {
            self.scene.images.push(png::encode(pixels));
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

/// The glTF object of a material.
fn object_of(material: &Material, image: Option<usize>) -> Value {
    let [red, green, blue] = material.base_color.linear().to_array();
    let alpha = if material.alpha == AlphaMode::Opaque { 1.0 } else { material.base_color.alpha() };
    let mut surface = json!({
        "baseColorFactor": [red, green, blue, alpha], "metallicFactor": 0.0, "roughnessFactor": 1.0,
    });
    if let Some(image) = image {
        surface["baseColorTexture"] = json!({"index": image});
    }
    let mut object = json!({"pbrMetallicRoughness": surface});
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

//! Binary glTF 2.0 (Khronos, ISO/IEC 12113:2022): a node for every feature's mesh, meshes shared by all who show them.
//!
//! ```text
//!  scene ─► node "world" (X east, Y north, Z up ─► glTF's Y up) ─► a node an item ─► mesh ─► primitives
//!
//!  one buffer:  │ positions │ normals │ texture coordinates │ colors │ indices │ images │
//! ```
//!
//! One buffer view holds all positions, one all normals and so on, so that a city of ten thousand roads has five views
//! and not fifty thousand. Colors are linear light in glTF, whatever textures are.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::Range;

use glam::{Mat4, Vec3};
use serde_json::{Map, Value, json};

use crate::draw::color::{Srgba, linear_from_srgb};
use crate::draw::list::{DrawItem, DrawList, DrawMesh, FeatureId, MaterialId, MeshId};
use crate::draw::material::{AlphaMode, Material, TextureId};
use crate::export::png;
use crate::mesh::write::count;
use crate::mesh::write::glb::{ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, FLOAT, GLTF_FROM_WORLD, UNSIGNED_INT};

/// The specification's number for an accessor that holds u16.
const UNSIGNED_SHORT: u32 = 5123;

/// Vertex attributes, one buffer view each: name, type, component type, bytes a vertex.
const ATTRIBUTES: [(&str, &str, u32, usize); 4] = [
    ("POSITION", "VEC3", FLOAT, 12),
    ("NORMAL", "VEC3", FLOAT, 12),
    ("TEXCOORD_0", "VEC2", FLOAT, 8),
    ("COLOR_0", "VEC4", UNSIGNED_SHORT, 8),
];
const POSITION: usize = 0;
const NORMAL: usize = 1;
const TEXCOORD: usize = 2;
const COLOR: usize = 3;

/// Writes a prepared list ([`crate::export::prepare`]); `name` names features, remarks go to `asset.extras`.
///
/// # Errors
/// `out` cannot be written, or the file would be larger than the 4 GiB that the format can hold.
pub fn write(
    list: &DrawList,
    name: &dyn Fn(FeatureId) -> String,
    remarks: &[String],
    out: &mut impl Write,
) -> io::Result<()> {
    let mut file = GlbFile::default();
    file.nodes.push(json!({"name": "world", "matrix": GLTF_FROM_WORLD}));
    let mut roots = Vec::new();
    for run in list.items.chunk_by(belong_together) {
        if let Some(mesh) = file.mesh(list, run) {
            roots.push(file.nodes.len());
            file.nodes.push(node(&name(run[0].feature), mesh, run[0].world_from_mesh));
        }
    }
    // A node without children must not have the key.
    if !roots.is_empty() {
        file.nodes[0]["children"] = json!(roots);
    }
    file.finish(remarks, out)
}

/// Whether two items are parts of one thing in one place, such as the parts of a model.
fn belong_together(a: &DrawItem, b: &DrawItem) -> bool {
    a.feature == b.feature && a.world_from_mesh == b.world_from_mesh && a.layer == b.layer
}

fn node(name: &str, mesh: usize, world_from_mesh: Mat4) -> Value {
    let mut node = json!({"mesh": mesh});
    if !name.is_empty() {
        node["name"] = json!(name);
    }
    if world_from_mesh != Mat4::IDENTITY {
        node["matrix"] = json!(world_from_mesh.to_cols_array());
    }
    node
}

/// Which triangles of which mesh in which material: what a primitive is made of.
type PrimitiveKey = (MeshId, (u32, u32), MaterialId);

#[derive(Default)]
struct GlbFile {
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    textures: Vec<Value>,
    images: Vec<(Vec<u8>, usize)>,
    accessors: Vec<Value>,
    attributes: [Vec<u8>; ATTRIBUTES.len()],
    indices: Vec<u8>,
    mesh_of: BTreeMap<Vec<PrimitiveKey>, Option<usize>>,
    vertices_of: BTreeMap<(MeshId, bool), Map<String, Value>>,
    material_of: BTreeMap<MaterialId, usize>,
    texture_of: BTreeMap<TextureId, Option<usize>>,
}

impl GlbFile {
    /// The glTF mesh of items that belong together; `None` where none of them has a triangle with an area.
    fn mesh(&mut self, list: &DrawList, items: &[DrawItem]) -> Option<usize> {
        let part = |item: &DrawItem| (item.mesh, (item.triangles.start, item.triangles.end), item.material);
        let key: Vec<PrimitiveKey> = items.iter().map(part).collect();
        if let Some(&known) = self.mesh_of.get(&key) {
            return known;
        }
        let primitives: Vec<Value> = items.iter().filter_map(|item| self.primitive(list, item)).collect();
        let mesh = (!primitives.is_empty()).then(|| {
            self.meshes.push(json!({"primitives": primitives}));
            self.meshes.len() - 1
        });
        self.mesh_of.insert(key, mesh);
        mesh
    }

    fn primitive(&mut self, list: &DrawList, item: &DrawItem) -> Option<Value> {
        let mesh = &list.meshes[item.mesh.0 as usize];
        let material = &list.materials[item.material.0 as usize];
        let indices = self.indices(mesh, item.triangles.clone())?;
        let attributes = self.vertices((item.mesh, mesh), material.texture.is_some());
        let material = self.material(list, item.material, material);
        Some(json!({"attributes": attributes, "indices": indices, "material": material}))
    }

    /// The accessor of the indices of those triangles that have an area.
    fn indices(&mut self, mesh: &DrawMesh, triangles: Range<u32>) -> Option<usize> {
        let (start, mut count) = (self.indices.len(), 0);
        let at = |index: usize| Vec3::from(mesh.vertices[index].position);
        for corners in &mesh.triangles[triangles.start as usize..triangles.end as usize] {
            let [a, b, c] = corners.map(|id| at(id.index()));
            if (b - a).cross(c - a) != Vec3::ZERO {
                corners.iter().for_each(|id| self.indices.extend(id.0.to_le_bytes()));
                count += 3;
            }
        }
        (count > 0).then(|| {
            let view = ATTRIBUTES.len();
            let accessor = json!({"bufferView": view, "byteOffset": start, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR"});
            self.accessors.push(accessor);
            self.accessors.len() - 1
        })
    }

    /// The accessors of a mesh's vertices by attribute; texture coordinates where something shows them.
    fn vertices(&mut self, (id, mesh): (MeshId, &DrawMesh), textured: bool) -> Map<String, Value> {
        if let Some(known) = self.vertices_of.get(&(id, textured)) {
            return known.clone();
        }
        let mut attributes = Map::new();
        let low =
            mesh.vertices.iter().map(|vertex| Vec3::from(vertex.position)).fold(Vec3::INFINITY, Vec3::min);
        let high = mesh
            .vertices
            .iter()
            .map(|vertex| Vec3::from(vertex.position))
            .fold(Vec3::NEG_INFINITY, Vec3::max);
        let position = self.attribute(POSITION, mesh, |vertex, bytes| put(&vertex.position, bytes));
        self.accessors[position]["min"] = json!(low.to_array());
        self.accessors[position]["max"] = json!(high.to_array());
        attributes.insert(ATTRIBUTES[POSITION].0.into(), json!(position));
        let normal = self.attribute(NORMAL, mesh, |vertex, bytes| {
            put(&Vec3::from(vertex.normal).try_normalize().unwrap_or(Vec3::Z).to_array(), bytes);
        });
        attributes.insert(ATTRIBUTES[NORMAL].0.into(), json!(normal));
        if textured {
            let uv = self.attribute(TEXCOORD, mesh, |vertex, bytes| put(&vertex.uv, bytes));
            attributes.insert(ATTRIBUTES[TEXCOORD].0.into(), json!(uv));
        }
        if mesh.vertices.iter().any(|vertex| vertex.color != Srgba::WHITE) {
            let color = self.attribute(COLOR, mesh, |vertex, bytes| put_color(vertex.color, bytes));
            self.accessors[color]["normalized"] = json!(true);
            attributes.insert(ATTRIBUTES[COLOR].0.into(), json!(color));
        }
        self.vertices_of.insert((id, textured), attributes.clone());
        attributes
    }

    fn attribute(
        &mut self,
        attribute: usize,
        mesh: &DrawMesh,
        put: impl Fn(&crate::draw::list::DrawVertex, &mut Vec<u8>),
    ) -> usize {
        let bytes = &mut self.attributes[attribute];
        let start = bytes.len();
        mesh.vertices.iter().for_each(|vertex| put(vertex, bytes));
        let (_, kind, component, _) = ATTRIBUTES[attribute];
        self.accessors.push(json!({
            "bufferView": attribute, "byteOffset": start, "componentType": component,
            "count": mesh.vertices.len(), "type": kind,
        }));
        self.accessors.len() - 1
    }

    fn material(&mut self, list: &DrawList, id: MaterialId, material: &Material) -> usize {
        if let Some(&known) = self.material_of.get(&id) {
            return known;
        }
        let [red, green, blue] = material.base_color.linear().to_array();
        let alpha = if material.alpha == AlphaMode::Opaque { 1.0 } else { material.base_color.alpha() };
        let mut surface = json!({
            "baseColorFactor": [red, green, blue, alpha], "metallicFactor": 0.0, "roughnessFactor": 1.0,
        });
        if let Some(texture) = material.texture.and_then(|texture| self.texture(list, texture)) {
            surface["baseColorTexture"] = json!({"index": texture});
        }
        let mut written = json!({"pbrMetallicRoughness": surface});
        if !material.name.is_empty() {
            written["name"] = json!(material.name);
        }
        match material.alpha {
            AlphaMode::Opaque => {}
            AlphaMode::Mask(cutoff) => {
                written["alphaMode"] = json!("MASK");
                written["alphaCutoff"] = json!(cutoff.max(0.0));
            }
            AlphaMode::Blend => written["alphaMode"] = json!("BLEND"),
        }
        if material.two_sided {
            written["doubleSided"] = json!(true);
        }
        self.materials.push(written);
        self.material_of.insert(id, self.materials.len() - 1);
        self.materials.len() - 1
    }

    fn texture(&mut self, list: &DrawList, id: TextureId) -> Option<usize> {
        if let Some(&known) = self.texture_of.get(&id) {
            return known;
        }
        let texture = png::encode(&list.textures[id.0 as usize]).map(|png| {
            let length = png.len();
            self.images.push((png, length));
            self.textures.push(json!({"source": self.images.len() - 1, "sampler": 0}));
            self.textures.len() - 1
        });
        self.texture_of.insert(id, texture);
        texture
    }

    /// Writes the header, the JSON chunk and the binary chunk.
    fn finish(self, remarks: &[String], out: &mut impl Write) -> io::Result<()> {
        let chunks: Vec<&[u8]> = self
            .attributes
            .iter()
            .chain([&self.indices])
            .map(Vec::as_slice)
            .chain(self.images.iter().map(|(png, _)| png.as_slice()))
            .collect();
        let length: usize = chunks.iter().map(|chunk| chunk.len().next_multiple_of(4)).sum();
        let mut text = self.document(remarks, &chunks, length).to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        out.write_all(b"glTF")?;
        out.write_all(&2u32.to_le_bytes())?;
        let binary = if length > 0 { 8 + length } else { 0 };
        out.write_all(&count(12 + 8 + text.len() + binary, "bytes")?.to_le_bytes())?;
        out.write_all(&count(text.len(), "bytes")?.to_le_bytes())?;
        out.write_all(b"JSON")?;
        out.write_all(&text)?;
        if length == 0 {
            return Ok(());
        }
        out.write_all(&count(length, "bytes")?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        for chunk in chunks {
            out.write_all(chunk)?;
            out.write_all(&[0; 3][..chunk.len().next_multiple_of(4) - chunk.len()])?;
        }
        Ok(())
    }

    fn document(&self, remarks: &[String], chunks: &[&[u8]], length: usize) -> Value {
        let mut document = json!({
            "asset": {"version": "2.0", "generator": "sandtable", "extras": {"remarks": remarks}},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": self.nodes,
        });
        // Buffer views are numbered by kind; those of kinds that hold nothing are not there, and the rest move up.
        let mut number = vec![None; chunks.len()];
        let (mut views, mut offset) = (Vec::new(), 0);
        for (kind, chunk) in chunks.iter().enumerate().filter(|(_, chunk)| !chunk.is_empty()) {
            number[kind] = Some(views.len());
            views.push(view(kind, offset, chunk.len()));
            offset += chunk.len().next_multiple_of(4);
        }
        let renumbered = |accessor: &Value| {
            let kind = accessor["bufferView"].as_u64().expect("every accessor names its view") as usize;
            let mut accessor = accessor.clone();
            accessor["bufferView"] = json!(number[kind]);
            accessor
        };
        let first_image = ATTRIBUTES.len() + 1;
        let image =
            |index: usize| json!({"bufferView": number[first_image + index], "mimeType": "image/png"});
        let lists = [
            ("meshes", self.meshes.clone()),
            ("materials", self.materials.clone()),
            ("textures", self.textures.clone()),
            ("images", (0..self.images.len()).map(image).collect()),
            (
                "samplers",
                self.textures
                    .first()
                    .map(|_| json!({"magFilter": 9729, "minFilter": 9987}))
                    .into_iter()
                    .collect(),
            ),
            ("accessors", self.accessors.iter().map(renumbered).collect()),
            ("bufferViews", views),
            ("buffers", if length > 0 { vec![json!({"byteLength": length})] } else { Vec::new() }),
        ];
        for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            document[key] = Value::Array(list);
        }
        document
    }
}

/// The buffer view of a kind of data: an attribute, the indices, or an image.
fn view(kind: usize, offset: usize, length: usize) -> Value {
    let mut view = json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
    match ATTRIBUTES.get(kind) {
        Some((_, _, _, stride)) => {
            view["byteStride"] = json!(stride);
            view["target"] = json!(ARRAY_BUFFER);
        }
        None if kind == ATTRIBUTES.len() => view["target"] = json!(ELEMENT_ARRAY_BUFFER),
        None => {}
    }
    view
}

fn put(numbers: &[f32], bytes: &mut Vec<u8>) {
    numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
}

/// Linear light and alpha in 16 bits each: 8 would lose the darks.
fn put_color(color: Srgba, bytes: &mut Vec<u8>) {
    let [red, green, blue, alpha] = color.0;
    let light = |channel: u8| (linear_from_srgb(channel) * 65535.0).round() as u16;
    for channel in [light(red), light(green), light(blue), u16::from(alpha) * 257] {
        bytes.extend(channel.to_le_bytes());
    }
}

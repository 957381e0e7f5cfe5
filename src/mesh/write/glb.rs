//! Binary glTF 2.0 (Khronos, ISO/IEC 12113:2022): meshes, materials, images and the nodes that show them.
//!
//! ```text
//!  scene ─► node "world" (Z up to glTF's Y up) ─► nodes ─► meshes ─► primitives
//!
//!  one buffer:  │ positions │ normals │ texture coordinates │ colors │ indices │ images │
//! ```
//!
//! One buffer view holds all positions, one all normals and so on: a city of ten thousand roads has five views, not
//! fifty thousand. Coordinates are stored Z up; the root node turns `(x, y, z)` to `(x, z, −y)`, so that east stays X,
//! up becomes Y and north is −Z.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::{self, Write};

use bytemuck::Pod;
use glam::{Mat4, Vec2, Vec3};
use serde_json::{Map, Value, json};

use crate::sink::VertexId;
use crate::write::remarks::Remarks;
use crate::write::words::{count_u32, little_endian};
use sandtable_geom::aabb::Aabb;

/// From X east, Y north, Z up to glTF's axes, column by column.
pub(in crate::write) const GLTF_FROM_WORLD: [f32; 16] =
    [1., 0., 0., 0., 0., 0., -1., 0., 0., 1., 0., 0., 0., 0., 0., 1.];

// The specification's numbers for component types and buffer targets.
const UNSIGNED_SHORT: u32 = 5123;
pub(in crate::write) const UNSIGNED_INT: u32 = 5125;
pub(in crate::write) const FLOAT: u32 = 5126;
pub(in crate::write) const ARRAY_BUFFER: u32 = 34962;
pub(in crate::write) const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The content of a GLB file; elements name each other by their index.
#[derive(Clone, Debug, Default)]
pub struct GlbScene<'a> {
    /// Vertices, shared by primitives.
    pub vertices: Vec<GlbVertices<'a>>,
    /// Meshes of one or more primitives.
    pub meshes: Vec<Vec<GlbPrimitive<'a>>>,
    /// Meshes in their places.
    pub nodes: Vec<GlbNode>,
    /// glTF material objects, which name textures by their index.
    pub materials: Vec<Value>,
    /// Textures.
    pub textures: Vec<GlbTexture>,
    /// PNG files.
    pub images: Vec<Vec<u8>>,
}

/// Vertices attribute by attribute. All but the positions may be empty.
#[derive(Clone, Debug, Default)]
pub struct GlbVertices<'a> {
    /// Positions, Z up.
    pub positions: Cow<'a, [Vec3]>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Texture coordinates; V runs downward.
    pub uvs: Vec<Vec2>,
    /// Linear light and alpha; 65535 is 1.
    pub colors: Vec<[u16; 4]>,
}

/// An image as a material shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GlbTexture {
    /// Which of [`GlbScene::images`].
    pub image: usize,
    /// What it shows beyond its borders, along U and along V.
    pub wrap: [GlbWrap; 2],
}

/// What a texture shows beyond its borders; the specification's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u32)]
pub enum GlbWrap {
    /// The color of the nearest border.
    ClampToEdge = 33071,
    /// The image again and again, every other one turned round.
    MirroredRepeat = 33648,
    /// The image again and again.
    Repeat = 10497,
}

/// Triangles in one material.
#[derive(Clone, Debug)]
pub struct GlbPrimitive<'a> {
    /// Which of [`GlbScene::vertices`].
    pub vertices: usize,
    /// At least one triangle.
    pub triangles: Cow<'a, [[VertexId; 3]]>,
    /// Which of [`GlbScene::materials`].
    pub material: Option<usize>,
}

/// Writes the header of a file, its JSON chunk, and the head of the binary chunk, whose `length` bytes follow.
///
/// # Errors
/// `out` cannot be written, or the file would exceed 4 GiB.
pub(in crate::write) fn write_chunks(
    document: String,
    length: usize,
    out: &mut impl Write,
) -> io::Result<()> {
    let mut text = document.into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let data_chunk = if length > 0 { 8 + length } else { 0 };
    out.write_all(b"glTF")?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&count_u32(20 + text.len() + data_chunk, "bytes")?.to_le_bytes())?;
    out.write_all(&count_u32(text.len(), "bytes")?.to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    if length > 0 {
        out.write_all(&count_u32(length, "bytes")?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
    }
    Ok(())
}

/// A mesh in its place.
#[derive(Clone, Debug)]
pub struct GlbNode {
    /// The name; empty for none.
    pub name: String,
    /// Which of [`GlbScene::meshes`].
    pub mesh: usize,
    /// Mesh space to world space.
    pub world_from_mesh: Mat4,
}

impl GlbScene<'_> {
    /// Writes the file; remarks go to `asset.extras`.
    ///
    /// # Errors
    /// `out` cannot be written, or the file would exceed 4 GiB.
    pub fn write(&self, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
        let mut data = GlbData::default();
        let text = self.document(remarks, &mut data).to_string();
        write_chunks(text, data.length, out)?;
        data.chunks.iter().try_for_each(|chunk| out.write_all(chunk))
    }

    /// The JSON chunk; fills `data` with the binary chunk.
    fn document<'s>(&'s self, remarks: &Remarks, data: &mut GlbData<'s>) -> Value {
        let attributes = self.add_vertices(data);
        let meshes = self.add_meshes(&attributes, data);
        let images: Vec<Value> = self.images.iter().map(|png| data.add_image(png)).collect();
        let wraps: BTreeSet<[GlbWrap; 2]> = self.textures.iter().map(|texture| texture.wrap).collect();
        let wraps: Vec<[GlbWrap; 2]> = wraps.into_iter().collect();
        let texture = |texture: &GlbTexture| {
            let sampler = wraps.iter().position(|wrap| *wrap == texture.wrap);
            json!({"source": texture.image, "sampler": sampler})
        };
        let mut document = json!({
            "asset": {"version": "2.0", "generator": "sandtable", "extras": {"remarks": remarks.lines}},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": self.nodes(),
        });
        let lists = [
            ("meshes", meshes),
            ("materials", self.materials.clone()),
            ("textures", self.textures.iter().map(texture).collect()),
            ("samplers", wraps.iter().map(sampler).collect()),
            ("images", images),
            ("buffers", if data.length > 0 { vec![json!({"byteLength": data.length})] } else { Vec::new() }),
            ("accessors", std::mem::take(&mut data.accessors)),
            ("bufferViews", std::mem::take(&mut data.views)),
        ];
        for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            document[key] = Value::Array(list);
        }
        document
    }

    /// The accessors of each element of `vertices`, by attribute.
    fn add_vertices<'s>(&'s self, data: &mut GlbData<'s>) -> Vec<Map<String, Value>> {
        data.next_view = Some(json!({"byteStride": 12, "target": ARRAY_BUFFER}));
        let mut attributes = Vec::new();
        for vertices in &self.vertices {
            let Aabb { min, max } = Aabb::around(vertices.positions.iter().copied()).unwrap_or_default();
            let (min, max) = (min.to_array(), max.to_array());
            let accessor = json!({"componentType": FLOAT, "type": "VEC3", "min": min, "max": max});
            let position = data.add(&vertices.positions, accessor);
            attributes.push(Map::from_iter([("POSITION".to_owned(), json!(position))]));
        }
        let all = self.vertices.iter();
        let normal = json!({"componentType": FLOAT, "type": "VEC3"});
        data.add_attribute("NORMAL", &normal, all.clone().map(|each| &*each.normals), &mut attributes);
        let uv = json!({"componentType": FLOAT, "type": "VEC2"});
        data.add_attribute("TEXCOORD_0", &uv, all.clone().map(|each| &*each.uvs), &mut attributes);
        let color = json!({"componentType": UNSIGNED_SHORT, "type": "VEC4", "normalized": true});
        data.add_attribute("COLOR_0", &color, all.map(|each| &*each.colors), &mut attributes);
        attributes
    }

    fn add_meshes<'s>(&'s self, attributes: &[Map<String, Value>], data: &mut GlbData<'s>) -> Vec<Value> {
        data.next_view = Some(json!({"target": ELEMENT_ARRAY_BUFFER}));
        let mut primitive = |primitive: &'s GlbPrimitive<'_>| {
            let accessor = json!({"componentType": UNSIGNED_INT, "type": "SCALAR"});
            let indices = data.add(primitive.triangles.as_flattened(), accessor);
            let mut object = json!({"attributes": attributes[primitive.vertices], "indices": indices});
            if let Some(material) = primitive.material {
                object["material"] = json!(material);
            }
            object
        };
        let mesh = |primitives: &'s Vec<GlbPrimitive<'_>>| -> Value {
            json!({"primitives": primitives.iter().map(&mut primitive).collect::<Vec<_>>()})
        };
        self.meshes.iter().map(mesh).collect()
    }

    fn nodes(&self) -> Vec<Value> {
        let mut root = json!({"name": "world", "matrix": GLTF_FROM_WORLD});
        // The format forbids an empty list of children.
        if !self.nodes.is_empty() {
            root["children"] = (1..=self.nodes.len()).collect();
        }
        let child = |node: &GlbNode| {
            let mut object = json!({"mesh": node.mesh});
            if !node.name.is_empty() {
                object["name"] = json!(node.name);
            }
            if node.world_from_mesh != Mat4::IDENTITY {
                object["matrix"] = json!(node.world_from_mesh.to_cols_array());
            }
            object
        };
        std::iter::once(root).chain(self.nodes.iter().map(child)).collect()
    }
}

#[derive(Default)]
struct GlbData<'s> {
    chunks: Vec<Cow<'s, [u8]>>,
    /// Bytes of all chunks.
    length: usize,
    views: Vec<Value>,
    accessors: Vec<Value>,
    /// The view that the next bytes open: an attribute that no vertex has gets no view.
    next_view: Option<Value>,
}

impl<'s> GlbData<'s> {
    /// Adds a view of an attribute, and an accessor for each list that is not empty.
    fn add_attribute<T: Pod>(
        &mut self,
        name: &str,
        accessor: &Value,
        lists: impl Iterator<Item = &'s [T]>,
        attributes: &mut [Map<String, Value>],
    ) {
        self.next_view = Some(json!({"byteStride": size_of::<T>(), "target": ARRAY_BUFFER}));
        for (values, attributes) in lists.zip(attributes).filter(|(values, _)| !values.is_empty()) {
            attributes.insert(name.to_owned(), json!(self.add(values, accessor.clone())));
        }
    }

    /// Adds values to the current view; returns the index of `accessor`, which reads them.
    fn add<T: Pod>(&mut self, values: &'s [T], mut accessor: Value) -> usize {
        let offset = self.append(little_endian(values));
        accessor["bufferView"] = json!(self.views.len() - 1);
        accessor["byteOffset"] = json!(offset);
        accessor["count"] = json!(values.len());
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds a view of a PNG file; returns the image object.
    fn add_image(&mut self, png: &'s [u8]) -> Value {
        self.next_view = Some(json!({}));
        self.append(png.into());
        let padding = self.length.next_multiple_of(4) - self.length;
        self.chunks.push(Cow::Borrowed(&[0; 3][..padding]));
        self.length += padding;
        json!({"bufferView": self.views.len() - 1, "mimeType": "image/png"})
    }

    /// Adds bytes to the current view; returns their offset in it.
    fn append(&mut self, bytes: Cow<'s, [u8]>) -> usize {
        if let Some(mut view) = self.next_view.take() {
            view["buffer"] = json!(0);
            view["byteOffset"] = json!(self.length);
            view["byteLength"] = json!(0);
            self.views.push(view);
        }
        let length = &mut self.views.last_mut().expect("next_view was set")["byteLength"];
        let offset = length.as_u64().expect("a length") as usize;
        *length = json!(offset + bytes.len());
        self.length += bytes.len();
        self.chunks.push(bytes);
        offset
    }
}

/// A sampler object: filtered between texels and levels; repeating is the format's default.
fn sampler([across, down]: &[GlbWrap; 2]) -> Value {
    let mut object = json!({"magFilter": 9729, "minFilter": 9987});
    for (key, wrap) in [("wrapS", *across), ("wrapT", *down)] {
        if wrap != GlbWrap::Repeat {
            object[key] = json!(wrap as u32);
        }
    }
    object
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::samples::remarks;

    #[test]
    fn the_root_node_turns_up_to_y_and_north_away() {
        let turn = Mat4::from_cols_array(&GLTF_FROM_WORLD);
        assert_eq!(turn.transform_point3(Vec3::new(1.0, 2.0, 3.0)), Vec3::new(1.0, 3.0, -2.0));
        assert_eq!(turn.determinant(), 1.0);
    }

    #[test]
    fn an_empty_scene_has_neither_children_nor_a_binary_chunk() {
        let mut bytes = Vec::new();
        GlbScene::default().write(&remarks(), &mut bytes).expect("memory");
        let document: Value = serde_json::from_slice(&bytes[20..]).expect("JSON to the end");
        assert!(document["nodes"][0].get("children").is_none() && document.get("buffers").is_none());
    }
}

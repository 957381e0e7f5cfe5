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
use std::io::{self, Write};

use glam::{Mat4, Vec2, Vec3};
use serde_json::{Map, Value, json};

use crate::geom::aabb::Aabb;
use crate::mesh::sink::VertexId;
use crate::mesh::trimesh::TriMesh;
use crate::mesh::write::{Remarks, count_u32, little_endian};

/// From X east, Y north, Z up to glTF's axes, column by column.
const GLTF_FROM_WORLD: [f32; 16] = [1., 0., 0., 0., 0., 0., -1., 0., 0., 1., 0., 0., 0., 0., 0., 1.];

// The specification's numbers for component types and buffer targets.
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The content of a GLB file; elements name each other by their index.
#[derive(Clone, Debug, Default)]
pub struct GlbScene<'a> {
    /// Vertices, shared by primitives.
    pub vertices: Vec<GlbVertices<'a>>,
    /// Meshes of one or more primitives.
    pub meshes: Vec<Vec<GlbPrimitive<'a>>>,
    /// Meshes in their places.
    pub nodes: Vec<GlbNode>,
    /// glTF material objects. Texture `i` shows image `i`.
    pub materials: Vec<Value>,
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

impl<'a> GlbScene<'a> {
    /// A scene of one mesh with at least one triangle.
    pub fn from_mesh(mesh: &'a TriMesh) -> Self {
        let triangles = Cow::Borrowed(mesh.triangles.as_slice());
        Self {
            vertices: vec![GlbVertices {
                positions: Cow::Borrowed(&mesh.positions),
                ..GlbVertices::default()
            }],
            meshes: vec![vec![GlbPrimitive { vertices: 0, triangles, material: None }]],
            nodes: vec![GlbNode { name: "terrain".into(), mesh: 0, world_from_mesh: Mat4::IDENTITY }],
            ..Self::default()
        }
    }

    /// Writes the file; remarks go to `asset.extras`.
    ///
    /// # Errors
    /// `out` cannot be written, or the file would exceed 4 GiB.
    pub fn write(&self, remarks: &Remarks, out: &mut impl Write) -> io::Result<()> {
        let mut data = GlbData::default();
        let document = self.document(remarks, &mut data);
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let binary_chunk = if data.length > 0 { 8 + data.length } else { 0 };
        out.write_all(b"glTF")?;
        out.write_all(&2u32.to_le_bytes())?;
        out.write_all(&count_u32(12 + 8 + text.len() + binary_chunk, "bytes")?.to_le_bytes())?;
        out.write_all(&count_u32(text.len(), "bytes")?.to_le_bytes())?;
        out.write_all(b"JSON")?;
        out.write_all(&text)?;
        if data.length == 0 {
            return Ok(());
        }
        out.write_all(&count_u32(data.length, "bytes")?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        data.chunks.iter().try_for_each(|chunk| out.write_all(chunk))
    }

    /// The JSON chunk; fills `data` with the binary chunk.
    fn document<'s>(&'s self, remarks: &Remarks, data: &mut GlbData<'s>) -> Value {
        let attributes = self.add_attributes(data);
        let meshes = self.add_meshes(&attributes, data);
        let images: Vec<Value> = self.images.iter().map(|png| data.add_image(png)).collect();
        let texture = |image: usize| json!({"source": image, "sampler": 0});
        let sampler = || json!({"magFilter": 9729, "minFilter": 9987});
        let buffer = || json!({"byteLength": data.length});
        let mut document = json!({
            "asset": {"version": "2.0", "generator": "sandtable", "extras": {"remarks": remarks.lines()}},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": self.nodes(),
        });
        let lists = [
            ("meshes", meshes),
            ("materials", self.materials.clone()),
            ("textures", (0..self.images.len()).map(texture).collect()),
            ("samplers", self.images.first().map(|_| sampler()).into_iter().collect()),
            ("images", images),
            ("buffers", (data.length > 0).then(buffer).into_iter().collect()),
            ("accessors", std::mem::take(&mut data.accessors)),
            ("bufferViews", std::mem::take(&mut data.views)),
        ];
        for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            document[key] = Value::Array(list);
        }
        document
    }

    /// The accessors of each element of `vertices`, by attribute.
    fn add_attributes<'s>(&'s self, data: &mut GlbData<'s>) -> Vec<Map<String, Value>> {
        let mut attributes = vec![Map::new(); self.vertices.len()];
        for layout in &ATTRIBUTES {
            data.begin_view(json!({"byteStride": layout.stride, "target": ARRAY_BUFFER}));
            for (vertices, attributes) in self.vertices.iter().zip(&mut attributes) {
                let bytes = (layout.bytes)(vertices);
                if bytes.is_empty() {
                    continue;
                }
                let mut accessor = json!({
                    "componentType": layout.component,
                    "count": bytes.len() / layout.stride,
                    "type": layout.kind,
                });
                if layout.component == UNSIGNED_SHORT {
                    accessor["normalized"] = json!(true);
                }
                if layout.name == "POSITION" {
                    let bounds = Aabb::around(vertices.positions.iter().copied()).unwrap_or_default();
                    accessor["min"] = json!(bounds.min.to_array());
                    accessor["max"] = json!(bounds.max.to_array());
                }
                attributes.insert(layout.name.into(), json!(data.add(bytes, accessor)));
            }
        }
        attributes
    }

    fn add_meshes<'s>(&'s self, attributes: &[Map<String, Value>], data: &mut GlbData<'s>) -> Vec<Value> {
        data.begin_view(json!({"target": ELEMENT_ARRAY_BUFFER}));
        let mut primitive = |primitive: &'s GlbPrimitive<'_>| {
            let bytes = little_endian::<u32, _>(&primitive.triangles);
            let accessor = json!({"componentType": UNSIGNED_INT, "count": bytes.len() / 4, "type": "SCALAR"});
            let indices = data.add(bytes, accessor);
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

    /// The root and its children.
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

/// How a vertex attribute is stored.
struct AttributeLayout {
    name: &'static str,
    kind: &'static str,
    component: u32,
    /// Bytes a vertex.
    stride: usize,
    bytes: for<'s> fn(&'s GlbVertices<'_>) -> Cow<'s, [u8]>,
}

const ATTRIBUTES: [AttributeLayout; 4] = [
    AttributeLayout {
        name: "POSITION",
        kind: "VEC3",
        component: FLOAT,
        stride: 12,
        bytes: |vertices| little_endian::<f32, _>(&vertices.positions),
    },
    AttributeLayout {
        name: "NORMAL",
        kind: "VEC3",
        component: FLOAT,
        stride: 12,
        bytes: |vertices| little_endian::<f32, _>(&vertices.normals),
    },
    AttributeLayout {
        name: "TEXCOORD_0",
        kind: "VEC2",
        component: FLOAT,
        stride: 8,
        bytes: |vertices| little_endian::<f32, _>(&vertices.uvs),
    },
    AttributeLayout {
        name: "COLOR_0",
        kind: "VEC4",
        component: UNSIGNED_SHORT,
        stride: 8,
        bytes: |vertices| little_endian::<u16, _>(&vertices.colors),
    },
];

/// The binary chunk, and the views and accessors into it.
#[derive(Default)]
struct GlbData<'s> {
    chunks: Vec<Cow<'s, [u8]>>,
    /// Bytes of all chunks.
    length: usize,
    views: Vec<Value>,
    accessors: Vec<Value>,
    /// The view to open with the next bytes: a kind of data that no vertex has gets no view.
    next_view: Option<Value>,
}

impl<'s> GlbData<'s> {
    fn begin_view(&mut self, view: Value) {
        self.next_view = Some(view);
    }

    /// Adds bytes to the current view and returns the index of `accessor`, which reads them.
    fn add(&mut self, bytes: Cow<'s, [u8]>, mut accessor: Value) -> usize {
        let offset = self.append(bytes);
        accessor["bufferView"] = json!(self.views.len() - 1);
        accessor["byteOffset"] = json!(offset);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds a view of its own for a PNG file; returns the image object.
    fn add_image(&mut self, png: &'s [u8]) -> Value {
        self.begin_view(json!({}));
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
        let view = self.views.last_mut().expect("a view was begun");
        let offset = view["byteLength"].as_u64().expect("a length") as usize;
        view["byteLength"] = json!(offset + bytes.len());
        self.length += bytes.len();
        self.chunks.push(bytes);
        offset
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::write::samples::{remarks, square};

    #[test]
    fn chunks_are_aligned_and_bounds_are_those_of_the_positions() {
        let mut bytes = Vec::new();
        GlbScene::from_mesh(&square()).write(&remarks(), &mut bytes).expect("memory");
        let number =
            |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
        assert_eq!((&bytes[..4], number(4), number(8)), (&b"glTF"[..], 2, bytes.len()));
        let text = number(12);
        assert_eq!((text % 4, number(20 + text), &bytes[24 + text..28 + text]), (0, 72, &b"BIN\0"[..]));
        let document: Value = serde_json::from_slice(&bytes[20..20 + text]).expect("JSON");
        assert_eq!(document["accessors"][0]["min"], json!([0.0f32, 0.0f32, -1.5f32]));
        assert_eq!(document["accessors"][0]["max"], json!([2.0f32, 3.0f32, 1e7f32]));
        assert_eq!(document["asset"]["extras"]["remarks"][1], "zwölf");
    }

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

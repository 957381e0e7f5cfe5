//! Binary glTF: one mesh an object, one primitive a material, textures within.

use glam::{Vec2, Vec3};
use sandtable_draw::color::linear_from_srgb;
use serde_json::{Value, json};

use super::shape::{Face, Object, Shape, png};

/// The GLB file of `shape`.
pub fn write(shape: &Shape) -> Vec<u8> {
    let mut file = File::default();
    let materials: Vec<Value> = shape.paints.iter().map(|paint| file.material(paint)).collect();
    let meshes: Vec<Value> = shape.objects.iter().map(|object| file.mesh(object, shape)).collect();
    let nodes: Vec<Value> = (0..)
        .zip(&shape.objects)
        .map(|(mesh, object): (usize, _)| json!({"mesh": mesh, "name": object.name}))
        .collect();
    let mut document = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": (0..nodes.len()).collect::<Vec<_>>()}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{"byteLength": file.binary.len()}],
    });
    if !file.images.is_empty() {
        document["textures"] = (0..file.images.len()).map(|source| json!({"source": source})).collect();
        document["images"] = file.images.into();
    }
    container(document.to_string().into_bytes(), file.binary)
}

#[derive(Default)]
struct File {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    images: Vec<Value>,
}

impl File {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.push(json!({"buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len()}));
        self.binary.extend(bytes);
        self.views.len() - 1
    }

    fn vectors(&mut self, kind: &str, vectors: &[&[f32]]) -> usize {
        let bytes: Vec<u8> =
            vectors.iter().flat_map(|vector| vector.iter()).flat_map(|value| value.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let edge = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            let start = vectors[0].to_vec();
            vectors
                .iter()
                .fold(start, |edge, vector| edge.iter().zip(*vector).map(|(&a, &b)| pick(a, b)).collect())
        };
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": vectors.len(), "type": kind,
            "min": edge(f32::min), "max": edge(f32::max),
        }));
        self.accessors.len() - 1
    }

    fn material(&mut self, paint: &super::shape::Paint) -> Value {
        let [red, green, blue] = paint.color.map(linear_from_srgb);
        let mut pbr = json!({"baseColorFactor": [red, green, blue, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9});
        if let Some((name, picture)) = &paint.texture {
            let view = self.view(&png(picture));
            pbr["baseColorTexture"] = json!({"index": self.images.len()});
            self.images.push(json!({"bufferView": view, "mimeType": "image/png", "name": name}));
        }
        json!({"name": paint.name, "pbrMetallicRoughness": pbr, "doubleSided": paint.two_sided})
    }

    fn mesh(&mut self, object: &Object, shape: &Shape) -> Value {
        let mut primitives = Vec::new();
        for paint in 0..shape.paints.len() {
            let faces: Vec<&Face> = object.faces.iter().filter(|face| face.paint == paint).collect();
            if faces.is_empty() {
                continue;
            }
            let textured = shape.paints[paint].texture.is_some();
            primitives.push(self.primitive(&faces, paint, textured));
        }
        json!({"name": object.name, "primitives": primitives})
    }

    fn primitive(&mut self, faces: &[&Face], paint: usize, textured: bool) -> Value {
        let mut corners: Vec<(Vec3, Vec3, Vec2)> = Vec::new();
        let mut indices: Vec<u16> = Vec::new();
        for face in faces {
            let first = corners.len() as u16;
            corners.extend(face.corners.iter().map(|&(at, uv)| (at, normal_at(face, at, faces), uv)));
            for corner in 2..face.corners.len() as u16 {
                indices.extend([first, first + corner - 1, first + corner]);
            }
        }
        // Z up to Y up, V upward to V downward.
        let turn = |at: Vec3| [at.x, at.z, -at.y].map(|value| value + 0.0);
        let positions: Vec<[f32; 3]> = corners.iter().map(|corner| turn(corner.0)).collect();
        let normals: Vec<[f32; 3]> = corners.iter().map(|corner| turn(corner.1)).collect();
        let uvs: Vec<[f32; 2]> = corners.iter().map(|corner| [corner.2.x, 1.0 - corner.2.y]).collect();
        let mut attributes = json!({
            "POSITION": self.vectors("VEC3", &positions.iter().map(|each| &each[..]).collect::<Vec<_>>()),
            "NORMAL": self.vectors("VEC3", &normals.iter().map(|each| &each[..]).collect::<Vec<_>>()),
        });
        if textured {
            attributes["TEXCOORD_0"] =
                json!(self.vectors("VEC2", &uvs.iter().map(|each| &each[..]).collect::<Vec<_>>()));
        }
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessors.push(
            json!({"bufferView": view, "componentType": 5123, "count": indices.len(), "type": "SCALAR"}),
        );
        json!({"attributes": attributes, "indices": self.accessors.len() - 1, "material": paint})
    }
}

/// The mean normal of the faces of one smoothing number that share a corner.
fn normal_at(face: &Face, at: Vec3, faces: &[&Face]) -> Vec3 {
    let normal = |face: &Face| -> Vec3 {
        let corners = &face.corners;
        let sum: Vec3 = (0..corners.len())
            .map(|place| corners[place].0.cross(corners[(place + 1) % corners.len()].0))
            .sum();
        sum.normalize()
    };
    let meets = |other: &&&Face| {
        other.smoothing == face.smoothing && other.corners.iter().any(|corner| corner.0 == at)
    };
    match face.smoothing {
        0 => normal(face),
        _ => faces.iter().filter(meets).map(|other| normal(other)).sum::<Vec3>().normalize(),
    }
}

fn container(mut json: Vec<u8>, mut binary: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let word = |value: usize| (value as u32).to_le_bytes();
    [
        b"glTF",
        &word(2)[..],
        &word(28 + json.len() + binary.len()),
        &word(json.len()),
        b"JSON",
        &json,
        &word(binary.len()),
        b"BIN\0",
        &binary,
    ]
    .concat()
}

//! Whatever a reader of models leaves out reaches the findings: each format with something odd among what is sound, which is
//! drawn.

use sandtable_description::finding_code::FindingCode;
use sandtable_scene::feature::FeatureKind;

use crate::level_ground::Read;

/// Checks that the model in the file `name` stands in the scene, and that a finding of a code holds all of `parts`.
fn reports(name: &str, bytes: impl AsRef<[u8]>, code: FindingCode, parts: &[&str]) {
    let table = format!("[[model]]\nfile = \"{name}\"\nat = [500200, 4500200]\n");
    let read = Read::new(&table, name, bytes);
    assert_eq!(read.built(FeatureKind::Model), 1, "{:?}", read.findings());
    let messages = read.messages(code);
    let holds = |message: &&String| parts.iter().all(|part| message.contains(part));
    assert_eq!(messages.iter().filter(holds).count(), 1, "{parts:?} in {messages:?}");
}

/// A tetrahedron of 4 m.
const SOLID: &str = "v 0 0 0\nv 4 0 0\nv 0 0 4\nv 0 4 0\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n";

#[test]
fn wavefront_with_an_odd_vertex_a_line_and_a_material_that_is_missing() {
    let odd = format!("{SOLID}v nan 1 1\nf 1 2 5\n");
    reports(
        "a.obj",
        &odd,
        FindingCode::ModelRead,
        &["a.obj: 1 face has fewer than three corners or one that is not finite"],
    );
    reports("a.obj", format!("{SOLID}l 1 2\n"), FindingCode::ModelRead, &["1 point or line is not drawn"]);
    let lost = format!("mtllib lost.mtl\n{SOLID}");
    reports("a.obj", lost, FindingCode::ModelRead, &["material library 'lost.mtl' is missing"]);
}

/// A glTF of one solid, with a second primitive and more of the document's keys.
fn gltf(primitive: &str, more: &str, last: f32) -> String {
    let positions = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0], [0.0, 4.0, 0.0], [last, 1.0, 1.0]];
    let indices = [0u32, 1, 3, 1, 2, 3, 2, 0, 3, 0, 2, 1, 0, 1, 4];
    let floats = positions.iter().flatten().flat_map(|value: &f32| value.to_le_bytes());
    let bytes: Vec<u8> = floats.chain(indices.iter().flat_map(|index| index.to_le_bytes())).collect();
    let data: String = bytes.iter().map(|byte| format!("%{byte:02X}")).collect();
    format!(
        r#"{{"asset":{{"version":"2.0"}},{more}"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream,{data}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":60}},{{"buffer":0,"byteOffset":60,"byteLength":60}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3","min":[0,0,0],"max":[4,4,4]}},
            {{"bufferView":1,"componentType":5125,"count":12,"type":"SCALAR"}},
            {{"bufferView":1,"componentType":5125,"count":15,"type":"SCALAR"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}{primitive}]}}]}}"#,
        bytes.len()
    )
}

#[test]
fn gltf_with_points_a_broken_triangle_and_an_extension() {
    let points = r#",{"attributes":{"POSITION":0},"mode":0}"#;
    let told = "meshes[0].primitives[1] has points or lines, which are not drawn";
    reports("a.gltf", gltf(points, "", 1.0), FindingCode::ModelRead, &["a.gltf: ", told]);
    let all = r#",{"attributes":{"POSITION":0},"indices":2}"#;
    let told = "meshes[0].primitives[1] has 1 triangle that is not finite";
    reports("a.gltf", gltf(all, "", f32::NAN), FindingCode::ModelRead, &[told]);
    let more = r#""extensionsUsed":["EXT_mesh_gpu_instancing"],"#;
    reports("a.gltf", gltf("", more, 1.0), FindingCode::ModelRead, &["EXT_mesh_gpu_instancing"]);
    let material = r#""materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
        "textures":[{"source":0}],"images":[{"uri":"lost.png"}],"#;
    reports("a.gltf", gltf("", material, 1.0), FindingCode::TextureMissing, &["lost.png"]);
}

/// A chunk of a 3DS file.
fn chunk(id: u16, content: &[u8]) -> Vec<u8> {
    let mut bytes = id.to_le_bytes().to_vec();
    bytes.extend((content.len() as u32 + 6).to_le_bytes());
    bytes.extend(content);
    bytes
}

#[test]
fn three_ds_with_a_face_whose_vertex_is_missing() {
    let positions = [[0.0f32, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    let faces = [[0u16, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1], [0, 1, 40]];
    let mut vertices = 4u16.to_le_bytes().to_vec();
    vertices.extend(positions.iter().flatten().flat_map(|value| value.to_le_bytes()));
    let mut corners = 5u16.to_le_bytes().to_vec();
    corners.extend(faces.iter().flat_map(|[a, b, c]| [*a, *b, *c, 7]).flat_map(u16::to_le_bytes));
    let mesh = chunk(0x4100, &[chunk(0x4110, &vertices), chunk(0x4120, &corners)].concat());
    let object = chunk(0x4000, &[b"solid\0".to_vec(), mesh].concat());
    let file = chunk(0x4D4D, &chunk(0x3D3D, &object));
    reports(
        "a.3ds",
        file,
        FindingCode::ModelRead,
        &["a.3ds: 1 face has a vertex that is missing or not finite"],
    );
}

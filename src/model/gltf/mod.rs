//! glTF 2.0 (Khronos, ISO/IEC 12113:2022) as JSON with companions, and as GLB.
//!
//! ```text
//! bytes ─ container (GLB chunks, JSON, indices checked) ─ data (buffers, URIs)
//!                                        │                   │
//!                  nodes (transforms) ───┼── accessor (numbers out of buffers)
//!                                        └── primitive, skin, material ─► Model
//! ```
//!
//! The document is that of the `gltf` crate (1.4.1), whose indices are checked before it is used. Models are read in
//! their rest pose, without animation.

mod accessor;
mod container;
mod data;
mod material;
mod nodes;
mod primitive;
mod skin;

use ::gltf::Document;
use glam::{Mat4, Vec4};

use crate::error::ModelError;
use crate::part::PartBuilder;
use crate::texture::Textures;
use crate::{Companions, Model};
use sandtable_base::message::numbers::counted;

use accessor::AccessorReader;
use container::GltfFile;
use data::GltfBuffers;
use material::load_materials;
use nodes::SceneNodes;
use primitive::MeshReader;
use skin::MeshPose;

/// From glTF's axes (Y up, front +Z) to ours (Z up, front −Y): (x, −z, y).
const Z_UP: Mat4 = Mat4::from_cols(Vec4::X, Vec4::Z, Vec4::NEG_Y, Vec4::W);

/// The model in the bytes of a glTF or GLB file.
///
/// # Errors
/// [`ModelError::Gltf`] and its like, and [`ModelError::TooLarge`]. A texture that cannot be loaded is a note.
pub fn read(bytes: &[u8], companions: &dyn Companions) -> Result<Model, ModelError> {
    let GltfFile { document, binary } = GltfFile::open(bytes)?;
    let buffers = GltfBuffers::load(&document, binary, companions);
    let scene = SceneNodes::new(&document)?;
    let mut model = Model::default();
    let mut textures = Textures::new(companions);
    let materials = load_materials(&document, &buffers, &mut textures);
    textures.move_to(&mut model);
    let mut reader = MeshReader::new(AccessorReader::new(&buffers), materials);
    let nodes: Vec<_> = document.nodes().collect();
    let mut is_counted = vec![false; document.meshes().len()];
    for &index in &scene.order {
        let node = &nodes[index];
        let Some(mesh) = node.mesh() else { continue };
        let pose = match node.skin() {
            Some(skin) => MeshPose::new(&skin, &reader.accessors, &scene.world_from_node)?,
            None => MeshPose::Rigid(Z_UP * scene.world_from_node[index]),
        };
        let mut parts = PartBuilder::new(node.name().or(mesh.name()).unwrap_or_default());
        let counts = reader.add_mesh(&mesh, &pose, &mut parts)?;
        model.parts.extend(parts.finish());
        model.census.meshes += counts.meshes;
        if !std::mem::replace(&mut is_counted[mesh.index()], true) {
            model.census.vertices += counts.vertices;
            model.census.faces += counts.faces;
        }
    }
    model.census.materials = document.materials().len();
    model.materials = reader.materials.into_iter().map(|material| material.material).collect();
    model.notes.extend(reader.notes);
    note_omissions(&document, &mut model.notes);
    Ok(model)
}

fn note_omissions(document: &Document, notes: &mut Vec<String>) {
    for name in document.extensions_used().filter(|name| container::is_unsupported(name)) {
        notes.push(format!("extension {name} is not supported; what it adds is not drawn"));
    }
    let animations = document.animations().len();
    if animations > 0 {
        notes.push(format!(
            "{} not played; the rest pose is drawn",
            counted(animations, "animation is", "animations are")
        ));
    }
    let moves = |weights: Option<&[f32]>| weights.into_iter().flatten().any(|&weight| weight != 0.0);
    if document.meshes().any(|mesh| moves(mesh.weights()))
        || document.nodes().any(|node| moves(node.weights()))
    {
        notes.push("morph targets are not drawn".into());
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::error::CompanionError;

    struct NoCompanions;

    impl Companions for NoCompanions {
        fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
            Err(format!("there is no {name}").into())
        }
    }

    /// A triangle with texture coordinates and colors, its material, and the nodes that place it.
    fn triangle(material: &str, nodes: &str, more: &str) -> Result<Model, ModelError> {
        read(triangle_json(material, nodes, more).as_bytes(), &NoCompanions)
    }

    fn triangle_json(material: &str, nodes: &str, more: &str) -> String {
        let floats = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
        let bytes: Vec<String> =
            floats.iter().flat_map(|value| value.to_le_bytes()).map(|byte| format!("%{byte:02X}")).collect();
        format!(
            r#"{{"asset":{{"version":"2.0"}},{more}"nodes":[{nodes}],"materials":[{material}],
            "images":[{{"uri":"data:image/png;base64,AAAA"}}],"textures":[{{"source":0}}],
            "buffers":[{{"byteLength":60,"uri":"data:application/octet-stream,{}"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
                {{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}}],
            "meshes":[{{"primitives":[{{"material":0,
                "attributes":{{"POSITION":0,"TEXCOORD_0":1,"COLOR_0":0}}}}]}}]}}"#,
            bytes.concat()
        )
    }

    #[test]
    fn a_mesh_is_drawn_at_every_node_that_names_it() {
        let nodes = r#"{"mesh":0},{"mesh":0,"translation":[10,0,0],"scale":[2,2,2]}"#;
        let model = triangle("{}", nodes, "").expect("sound");
        assert_eq!((model.parts.len(), model.triangle_count(), model.census.faces), (2, 2, 1));
        let bounds = model.bounds().expect("six vertices");
        assert_eq!((bounds.min, bounds.max), (Vec3::ZERO, Vec3::new(12.0, 0.0, 2.0)));
    }

    #[test]
    fn texture_coordinates_are_transformed_as_the_material_says() {
        let transform = r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":
            {"KHR_texture_transform":{"offset":[0.5,0.25],"rotation":1.5707963,"scale":[2,4]}}}}}"#;
        let model = triangle(transform, r#"{"mesh":0}"#, "").expect("sound");
        let uvs: Vec<[f32; 2]> = model.parts[0].mesh.vertices.iter().map(|vertex| vertex.uv).collect();
        // The specification's matrix: translation × rotation × scale.
        for (uv, expected) in uvs.iter().zip([[0.5, 0.25], [0.5, -1.75], [4.5, 0.25]]) {
            assert!((uv[0] - expected[0]).abs() < 1e-5 && (uv[1] - expected[1]).abs() < 1e-5, "{uvs:?}");
        }
        assert!(model.notes.iter().any(|note| note.contains("image 0")), "{:?}", model.notes);
    }

    /// A picture of one white pixel.
    const PIXEL: &str = "data:image/png;base64,\
        iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAsTj2FAAAAABJRU5ErkJggg==";

    /// A triangle whose texture is read through a sampler and at a set of coordinates.
    fn sampled(sampler: &str, set: u32) -> Model {
        let json = triangle_json(
            &format!(r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0,"texCoord":{set}}}}}}}"#),
            r#"{"mesh":0}"#,
            &format!(r#""samplers":[{sampler}],"#),
        );
        let json = json
            .replace("data:image/png;base64,AAAA", PIXEL)
            .replace(r#""textures":[{"source":0}]"#, r#""textures":[{"source":0,"sampler":0}]"#);
        read(json.as_bytes(), &NoCompanions).expect("sound")
    }

    #[test]
    fn a_texture_goes_on_beyond_its_borders_as_its_sampler_says() {
        use sandtable_draw::material::TextureWrap::{Clamp, Mirror, Repeat};
        for (sampler, wrap) in [
            ("{}", [Repeat, Repeat]),
            (r#"{"wrapS":33648}"#, [Mirror, Repeat]),
            (r#"{"wrapS":10497,"wrapT":33071}"#, [Repeat, Clamp]),
        ] {
            let model = sampled(sampler, 0);
            assert_eq!(model.materials[0].texture_wrap, wrap, "{sampler}");
            assert_eq!(model.notes, Vec::<String>::new());
        }
    }

    #[test]
    fn coordinates_that_are_missing_and_hard_texels_are_noted() {
        let notes = sampled(r#"{"magFilter":9728}"#, 1).notes;
        assert!(notes.iter().any(|note| note.contains("TEXCOORD_1")), "{notes:?}");
        assert!(notes.iter().any(|note| note.contains("NEAREST")), "{notes:?}");
    }

    #[test]
    fn vertices_have_colors_and_materials_their_alpha() {
        use sandtable_draw::material::AlphaMode;
        let cut = r#"{"alphaMode":"MASK","alphaCutoff":0.3,"doubleSided":true}"#;
        let model = triangle(cut, r#"{"mesh":0}"#, "").expect("sound");
        let colors: Vec<[u8; 4]> = model.parts[0].mesh.vertices.iter().map(|vertex| vertex.color.0).collect();
        assert_eq!(colors, [[0, 0, 0, 255], [255, 0, 0, 255], [0, 255, 0, 255]]);
        assert_eq!((model.materials[0].alpha, model.materials[0].two_sided), (AlphaMode::Mask(0.3), true));
        let glass = triangle(r#"{"alphaMode":"BLEND"}"#, r#"{"mesh":0}"#, "").expect("sound");
        assert_eq!(glass.materials[0].alpha, AlphaMode::Blend);
    }

    #[test]
    fn an_unsupported_extension_is_noted_or_refused_where_it_is_required() {
        let name = "EXT_mesh_gpu_instancing";
        let used = format!(r#""extensionsUsed":["{name}","KHR_materials_unlit"],"#);
        let model = triangle("{}", r#"{"mesh":0}"#, &used).expect("sound");
        assert!(model.notes.iter().any(|note| note.contains(name)), "{:?}", model.notes);
        assert!(!model.notes.iter().any(|note| note.contains("unlit")));
        let needed = format!(r#""extensionsRequired":["{name}"],"#);
        let error = triangle("{}", r#"{"mesh":0}"#, &needed).expect_err("needed").to_string();
        assert!(error.contains(name), "{error}");
    }
}

//! glTF 2.0 (Khronos, ISO/IEC 12113) as JSON with companions, and as GLB.
//!
//! ```text
//! bytes ─ container (GLB chunks, JSON, indices checked) ─ data (buffers, URIs)
//!                                        │                   │
//!         nodes (where things stand) ────┼── accessor (numbers out of buffers)
//!                                        └── shape (primitives, skins, materials) ─► Model
//! ```
//!
//! The document is that of the `gltf` crate (1.4.1). Its own accessors and buffer readers panic on forged
//! indices and lengths, so everything past the JSON is looked up and sliced here, and refused where it does
//! not hold. What animations would move stands in its rest pose.

mod accessor;
mod container;
mod data;
mod material;
mod nodes;
mod shape;
mod skin;

use ::gltf::json::Root;
use glam::{Mat4, Vec3};

use crate::model::error::ModelError;
use crate::model::part::PartBuilder;
use crate::model::{Census, Companions, Model};

use data::GltfBuffers;
use shape::Painter;

/// From glTF's axes (Y up, front +Z) to ours (Z up, front −Y): (x, −z, y).
const Z_UP: Mat4 =
    Mat4 { x_axis: glam::Vec4::X, y_axis: glam::Vec4::Z, z_axis: glam::Vec4::NEG_Y, w_axis: glam::Vec4::W };

/// The model in the bytes of a glTF or GLB file.
///
/// # Errors
/// [`ModelError::Gltf`] and [`ModelError::TooLarge`]. A picture that cannot be had is a note.
pub fn read(bytes: &[u8], companions: &dyn Companions) -> Result<Model, ModelError> {
    let (root, binary) = container::open(bytes)?;
    let data = GltfBuffers::load(&root, binary, companions);
    let standing = nodes::standing(&root)?;
    let mut model = Model::default();
    let mut painter = Painter::new(&root, &data, companions);
    let mut meshes = 0;
    let mut seen = vec![false; root.meshes.len()];
    for index in standing.order.iter().copied() {
        let node = &root.nodes[index];
        let Some(mesh) = node.mesh else { continue };
        let pose = match node.skin {
            Some(skin) => skin::pose(&root, painter.accessors(), skin.value(), &standing.world_from_node)?,
            None => skin::Pose::Rigid(Z_UP * standing.world_from_node[index]),
        };
        let name =
            node.name.as_ref().or(root.meshes[mesh.value()].name.as_ref()).cloned().unwrap_or_default();
        let mut parts = PartBuilder::new(name);
        meshes += painter.mesh(
            mesh.value(),
            &pose,
            !std::mem::replace(&mut seen[mesh.value()], true),
            &mut parts,
        )?;
        model.parts.extend(parts.finish());
    }
    note_what_is_left_out(&root, &mut model.notes);
    let (counted, materials, textures, notes) = painter.finish();
    model.census = Census { meshes, materials: root.materials.len(), ..counted };
    model.materials = materials;
    model.textures = textures;
    model.notes.extend(notes);
    Ok(model)
}

fn note_what_is_left_out(root: &Root, notes: &mut Vec<String>) {
    for name in container::unread_extensions(root) {
        notes.push(format!("extension {name} is not read; what it adds is not drawn"));
    }
    if !root.animations.is_empty() {
        notes.push(format!("{} animations are not played; the rest pose is drawn", root.animations.len()));
    }
    let moves = |weights: &Option<Vec<f32>>| weights.iter().flatten().any(|&weight| weight != 0.0);
    if root.meshes.iter().any(|mesh| moves(&mesh.weights))
        || root.nodes.iter().any(|node| moves(&node.weights))
    {
        notes.push("morph targets are not drawn".into());
    }
}

/// A vector turned by `matrix`, of unit length; `fallback` where nothing is left of it.
fn turned(matrix: &glam::Mat3, vector: Vec3, fallback: Vec3) -> Vec3 {
    (*matrix * vector).try_normalize().unwrap_or(fallback)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Nothing;

    impl Companions for Nothing {
        fn load(&self, name: &str) -> Result<Vec<u8>, String> {
            Err(format!("there is no {name}"))
        }
    }

    /// A triangle with texture coordinates and colors, its material, and the nodes that place it.
    fn triangle(material: &str, nodes: &str, more: &str) -> Result<Model, ModelError> {
        let floats = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
        let bytes: Vec<String> =
            floats.iter().flat_map(|value| value.to_le_bytes()).map(|byte| format!("%{byte:02X}")).collect();
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},{more}"nodes":[{nodes}],"materials":[{material}],
            "images":[{{"uri":"data:image/png;base64,AAAA"}}],"textures":[{{"source":0}}],
            "buffers":[{{"byteLength":60,"uri":"data:application/octet-stream,{}"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
                {{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}}],
            "meshes":[{{"primitives":[{{"material":0,
                "attributes":{{"POSITION":0,"TEXCOORD_0":1,"COLOR_0":0}}}}]}}]}}"#,
            bytes.concat()
        );
        read(json.as_bytes(), &Nothing)
    }

    #[test]
    fn a_mesh_stands_wherever_a_node_names_it() {
        let nodes = r#"{"mesh":0},{"mesh":0,"translation":[10,0,0],"scale":[2,2,2]}"#;
        let model = triangle("{}", nodes, "").expect("sound");
        assert_eq!((model.parts.len(), model.triangle_count(), model.census.faces), (2, 2, 1));
        assert_eq!(model.bounds(), Some((Vec3::ZERO, Vec3::new(12.0, 0.0, 2.0))));
    }

    #[test]
    fn texture_coordinates_are_scaled_turned_and_moved_as_the_material_says() {
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

    #[test]
    fn vertices_have_colors_and_materials_their_alpha() {
        use crate::draw::material::AlphaMode;
        let cut = r#"{"alphaMode":"MASK","alphaCutoff":0.3,"doubleSided":true}"#;
        let model = triangle(cut, r#"{"mesh":0}"#, "").expect("sound");
        let colors: Vec<[u8; 4]> = model.parts[0].mesh.vertices.iter().map(|vertex| vertex.color.0).collect();
        assert_eq!(colors, [[0, 0, 0, 255], [255, 0, 0, 255], [0, 255, 0, 255]]);
        assert_eq!((model.materials[0].alpha, model.materials[0].two_sided), (AlphaMode::Mask(0.3), true));
        let glass = triangle(r#"{"alphaMode":"BLEND"}"#, r#"{"mesh":0}"#, "").expect("sound");
        assert_eq!(glass.materials[0].alpha, AlphaMode::Blend);
    }

    #[test]
    fn an_extension_that_is_not_read_is_named_or_refused_where_it_is_needed() {
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

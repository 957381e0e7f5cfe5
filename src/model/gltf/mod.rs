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
use crate::model::kind::{Census, Companions, Model};
use crate::model::part::PartBuilder;

use data::Data;
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
    let data = Data::load(&root, binary, companions);
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

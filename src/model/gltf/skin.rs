//! Skins in their rest pose.

use ::gltf::json::Root;
use glam::{Mat4, Vec4};

use crate::model::error::ModelError;

use super::Z_UP;
use super::accessor::Accessors;

/// How a mesh is brought to the world, Z up.
pub(super) enum Pose {
    /// All of it alike.
    Rigid(Mat4),
    /// Every vertex by the joints it hangs on.
    Skinned(Vec<Mat4>),
}

impl Pose {
    /// The transform of a vertex with these joints and weights; a skinned vertex that hangs on nothing stays
    /// where it is stored.
    pub(super) fn of_vertex(&self, joints: Option<[f32; 4]>, weights: Option<[f32; 4]>) -> Mat4 {
        match self {
            Self::Rigid(matrix) => *matrix,
            Self::Skinned(matrices) => {
                let weights = Vec4::from(weights.unwrap_or_default());
                let total = weights.element_sum();
                if !(total > 0.0 && total.is_finite()) {
                    return Z_UP;
                }
                let joints = joints.unwrap_or_default().into_iter().zip((weights / total).to_array());
                joints.fold(Mat4::ZERO, |sum, (joint, weight)| {
                    sum + matrices.get(joint as usize).copied().unwrap_or(Z_UP) * weight
                })
            }
        }
    }
}

/// The rest pose of skin `index`.
///
/// # Errors
/// [`ModelError::Gltf`] where its matrices do not hold what they state; [`ModelError::TooLarge`].
pub(super) fn pose(
    root: &Root,
    accessors: &Accessors<'_>,
    index: usize,
    world_from_node: &[Mat4],
) -> Result<Pose, ModelError> {
    let skin = &root.skins[index];
    accessors.charge(skin.joints.len())?;
    let inverse_binds = match skin.inverse_bind_matrices {
        Some(accessor) => accessors.vectors::<16>(accessor.value())?,
        None => Vec::new(),
    };
    let joints = skin.joints.iter().enumerate().map(|(place, joint)| {
        let inverse_bind = inverse_binds.get(place).map_or(Mat4::IDENTITY, Mat4::from_cols_array);
        Z_UP * world_from_node[joint.value()] * inverse_bind
    });
    Ok(Pose::Skinned(joints.collect()))
}

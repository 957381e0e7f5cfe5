//! Skins in their rest pose.

use ::gltf::Skin;
use glam::{Mat4, Vec4};

use crate::error::ModelError;

use super::Z_UP;
use super::accessor::AccessorReader;

/// From a mesh to the world, Z up.
pub(super) enum MeshPose {
    Rigid(Mat4),
    /// A transform for each joint.
    Skinned(Vec<Mat4>),
}

impl MeshPose {
    pub(super) fn new(
        skin: &Skin<'_>,
        accessors: &AccessorReader<'_>,
        world_from_node: &[Mat4],
    ) -> Result<Self, ModelError> {
        accessors.charge(skin.joints().count())?;
        let inverse_binds = match skin.inverse_bind_matrices() {
            Some(accessor) => accessors.vectors::<16>(&accessor)?,
            None => Vec::new(),
        };
        let joints = skin.joints().enumerate().map(|(place, joint)| {
            let inverse_bind = inverse_binds.get(place).map_or(Mat4::IDENTITY, Mat4::from_cols_array);
            Z_UP * world_from_node[joint.index()] * inverse_bind
        });
        Ok(Self::Skinned(joints.collect()))
    }

    /// The transform of a vertex with these joints and weights; a skinned vertex without weights stays where it is
    /// stored.
    pub(super) fn world_from_vertex(&self, joints: Option<[f32; 4]>, weights: Option<[f32; 4]>) -> Mat4 {
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

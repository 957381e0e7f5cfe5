//! The corners that merged buffers hold, and whose each is.

use bytemuck::{Pod, Zeroable};

use sandtable_draw::list::{DrawVertex, FeatureId, MaterialId};

/// A corner in world space: `Corner` and `Owner` in the shader.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MergedVertex {
    pub corner: DrawVertex,
    pub owner: SurfaceOwner,
}

/// Whose a corner is: `Owner` in the shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct SurfaceOwner {
    pub feature: FeatureId,
    pub material: MaterialRow,
}

/// The row of a material in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct MaterialRow(pub u32);

impl From<MaterialId> for MaterialRow {
    fn from(id: MaterialId) -> Self {
        Self(id.0 + 1)
    }
}

//! The ground and the features draped on it by patches, for renderers that show frame after frame: only changes are handed
//! over.
//!
//! A patch's vertices are handed over once and anew only where its heights change; what changes from frame to frame is the
//! list of its triangles, 16 bits an index. What lies on the ground is cut to these triangles, so that it is handed over
//! anew with them.

use std::sync::Arc;

use crate::ground::GroundPost;
use crate::list::{DepthLayer, DrawMesh, FeatureId, MaterialId};

/// The number of a patch, row by row from the south-west.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PatchId(pub u32);

/// The vertices of a patch, row by row from the south-west; all patches of a ground have as many.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchVertices {
    /// Which patch.
    pub patch: PatchId,
    /// Positions in world space, meters; those beyond the ground's border lie on the border.
    pub positions: Vec<[f32; 3]>,
}

/// The triangles that a patch shows, counter-clockwise seen from above.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchTriangles {
    /// Which patch.
    pub patch: PatchId,
    /// Indices into its vertices.
    pub triangles: Arc<Vec<[u16; 3]>>,
}

/// A part of a draped feature within a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct DrapedPiece {
    /// Vertices in world space, and triangles; the same memory as long as it is not cut again, so that a renderer sends it
    /// once.
    pub mesh: Arc<DrawMesh>,
    /// A material of the draw list that was loaded last.
    pub material: MaterialId,
    /// The order among the features draped on the ground.
    pub layer: DepthLayer,
    /// The feature that it belongs to.
    pub feature: FeatureId,
}

/// The draped features on a patch, in drawing order.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchDrapes {
    /// Which patch.
    pub patch: PatchId,
    /// The draped parts; empty where none are left.
    pub pieces: Vec<DrapedPiece>,
}

/// A rectangle of the posts of the ground map that was loaded last, which an edit changed.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundMapPatch {
    /// The column of its south-west post, and the row.
    pub first: [u32; 2],
    /// Posts per row.
    pub columns: u32,
    /// The posts, row by row from the south-west.
    pub posts: Vec<GroundPost>,
}

/// The changes of the ground since the last frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroundChanges {
    /// Vertices of patches that are shown for the first time, or whose heights changed.
    pub vertices: Vec<PatchVertices>,
    /// Triangles of patches that changed or came into view.
    pub triangles: Vec<PatchTriangles>,
    /// Patches that are not shown any more; their vertices may be needed again.
    pub hidden: Vec<PatchId>,
    /// Patches whose vertices are dropped from memory, too.
    pub dropped: Vec<PatchId>,
    /// Draped features of patches, cut again.
    pub drapes: Vec<PatchDrapes>,
    /// Changes of the ground map; a later one lies over those before it.
    pub map: Vec<GroundMapPatch>,
}

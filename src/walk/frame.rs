//! The options of a walk, and what an update of it returns.

use glam::Vec3;
use sandtable_draw::patches::GroundChanges;
use sandtable_roam::block::{BlockError, BlockSource};
use sandtable_roam::refine::deferred::Deferred;

/// The parameters of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkOptions {
    /// The greatest error of the displayed ground in pixels, above 0; `None` for the scene's own.
    pub tolerance_px: Option<f32>,
    /// Unit vector toward the sun; `None` for the scene's own light on a map with north above.
    pub to_sun: Option<Vec3>,
    /// How many patches are kept by the renderer after they have gone out of view, those in view included: 50 KB each in
    /// patches of 64. More than are in view are kept while they are few. Default 2048.
    pub kept_patches: usize,
    /// The rule for rebuilding the spheres for another picture or tolerance. Default [`ReachRenewal::InUpdate`].
    pub renewal: ReachRenewal,
}

/// The rule for rebuilding the spheres of a walk for another picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReachRenewal {
    /// In the update that needs them, which is so exact, and late on large ground.
    #[default]
    InUpdate,
    /// By [`Walk::reach_task`](crate::Walk::reach_task); updates show what the spheres before allow.
    ByTask,
}

impl Default for WalkOptions {
    fn default() -> Self {
        Self { tolerance_px: None, to_sun: None, kept_patches: 2048, renewal: ReachRenewal::InUpdate }
    }
}

/// Why the ground cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum WalkError {
    /// A patch cannot be read.
    #[error(transparent)]
    Block(#[from] BlockError),
}

/// One frame of a walk.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WalkFrame {
    /// What changed since the frame before.
    pub changes: GroundChanges,
    /// What it cost.
    pub statistics: WalkStatistics,
}

/// The statistics of an update of a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WalkStatistics {
    /// Patches in view.
    pub patches: usize,
    /// Triangles of the ground in view.
    pub triangles: usize,
    /// Vertices that became active.
    pub splits: usize,
    /// Vertices that became inactive.
    pub merges: usize,
    /// Vertices that were examined.
    pub examined: usize,
    /// Patches that are refined from frame to frame, in view or not.
    pub meshes: usize,
    /// Patches whose triangles are handed over.
    pub changed_patches: usize,
    /// Patches whose draped features are handed over.
    pub cut_patches: usize,
    /// Patches that later updates will hand over although nothing moves: those whose draped features must be cut again,
    /// and those that must be read from disk.
    pub waiting_patches: usize,
    /// Bytes of vertices of patches that are handed over.
    pub vertex_bytes: usize,
    /// Bytes of triangles of patches that are handed over.
    pub triangle_bytes: usize,
    /// Bytes of draped features that are handed over.
    pub drape_bytes: usize,
    /// Bytes of changes of the ground map that are handed over.
    pub map_bytes: usize,
}

impl WalkStatistics {
    /// Counts what a mesh shows and what is handed over.
    pub(super) fn count(&mut self, mesh: &Deferred<impl BlockSource>, changes: &GroundChanges) {
        self.patches = mesh.visible().len();
        self.triangles = mesh.triangle_count();
        self.meshes = mesh.meshes();
        self.changed_patches = changes.triangles.len();
        self.cut_patches = changes.drapes.len();
        self.vertex_bytes =
            changes.vertices.iter().map(|patch| size_of_val(patch.positions.as_slice())).sum();
        self.triangle_bytes =
            changes.triangles.iter().map(|patch| size_of_val(patch.triangles.as_slice())).sum();
        self.map_bytes = changes.map.iter().map(|patch| size_of_val(patch.posts.as_slice())).sum();
        let pieces = changes.drapes.iter().flat_map(|patch| &patch.pieces);
        self.drape_bytes = pieces
            .map(|piece| {
                size_of_val(piece.mesh.vertices.as_slice()) + size_of_val(piece.mesh.triangles.as_slice())
            })
            .sum();
    }

    /// Bytes that are handed over, in all.
    pub fn bytes(&self) -> usize {
        self.vertex_bytes + self.triangle_bytes + self.drape_bytes + self.map_bytes
    }
}

//! The state of each patch at the renderer, so that only changes are handed over.

use std::sync::Arc;

use sandtable_draw::patches::{GroundChanges, PatchId, PatchTriangles, PatchVertices};
use sandtable_roam::block::BlockSource;
use sandtable_roam::graph::Vertex;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::deferred::Deferred;

/// The share of the kept patches that is left when they have become too many, so that they are looked through seldom.
const KEPT_SHARE: f64 = 0.875;

/// A patch as the renderer has it.
#[derive(Clone, Copy, Debug, Default)]
struct ShownPatch {
    /// The frame in which it was last in view, counted from 1.
    seen: u64,
    /// Whether the renderer has its vertices.
    is_held: bool,
    /// Whether the vertices that the renderer has are of old.
    has_moved: bool,
    /// Whether its triangles changed since they were handed over.
    is_stale: bool,
}

/// The patches that are in view or kept.
#[derive(Clone, Debug)]
pub(super) struct ShownPatches {
    frame: u64,
    patches: Vec<ShownPatch>,
    /// The patches in view, in the order of the refiner.
    visible: Vec<usize>,
    /// Those of them whose triangles were handed over last, or that came into view.
    changed: Vec<usize>,
    held: usize,
    kept: usize,
}

impl ShownPatches {
    /// No patches shown yet, of so many; `kept` of them are kept where no more are in view.
    pub fn new(count: usize, kept: usize) -> Self {
        let patches = vec![ShownPatch::default(); count];
        Self { frame: 0, patches, visible: Vec::new(), changed: Vec::new(), held: 0, kept }
    }

    /// The patches in view.
    pub fn visible(&self) -> &[usize] {
        &self.visible
    }

    /// Those of the patches in view whose triangles were handed over in the last update.
    pub fn changed(&self) -> &[usize] {
        &self.changed
    }

    /// Marks the triangles of all patches as changed.
    pub fn relist_all(&mut self) {
        self.patches.iter_mut().for_each(|patch| patch.is_stale = true);
    }

    /// Marks the vertices of a patch as moved.
    pub fn moved(&mut self, patch: usize) {
        (self.patches[patch].has_moved, self.patches[patch].is_stale) = (true, true);
    }

    /// Forgets what the renderer has.
    pub fn forget(&mut self) {
        self.patches.fill(ShownPatch::default());
        self.visible.clear();
        self.held = 0;
    }

    /// The changes with which the renderer shows the ground of `mesh`, without draped features. `positions` are the
    /// vertices of a patch with that south-west corner, row by row from there.
    pub fn update<S: BlockSource>(
        &mut self,
        mesh: &Deferred<S>,
        positions: impl Fn(Vertex) -> Vec<[f32; 3]>,
    ) -> GroundChanges {
        let (layout, mut changes) = (*mesh.source().layout(), GroundChanges::default());
        mesh.changes().dirty.iter().for_each(|&patch| self.patches[patch].is_stale = true);
        let last = self.frame;
        self.frame += 1;
        self.changed.clear();
        let mut visible = Vec::with_capacity(mesh.visible().len());
        for &corner in mesh.visible() {
            let index = layout.patch_index(corner);
            let (patch, id) = (&mut self.patches[index], PatchId(index as u32));
            visible.push(index);
            if !patch.is_held || patch.has_moved {
                changes.vertices.push(PatchVertices { patch: id, positions: positions(corner) });
                self.held += usize::from(!patch.is_held);
                (patch.is_held, patch.has_moved) = (true, false);
            }
            if patch.is_stale || patch.seen != last || last == 0 {
                let triangles = Arc::new(mesh.local_triangles(corner));
                changes.triangles.push(PatchTriangles { patch: id, triangles });
                patch.is_stale = false;
                self.changed.push(index);
            }
            patch.seen = self.frame;
        }
        let before = std::mem::replace(&mut self.visible, visible);
        let has_gone = |index: &usize| self.patches[*index].seen != self.frame;
        changes.hidden = before.into_iter().filter(has_gone).map(|index| PatchId(index as u32)).collect();
        changes.dropped = self.drop_oldest();
        changes
    }

    /// Drops the patches that have been out of view for the longest time where too many are held.
    fn drop_oldest(&mut self) -> Vec<PatchId> {
        if self.held <= self.kept.max(self.visible.len()) {
            return Vec::new();
        }
        let left = ((self.kept as f64 * KEPT_SHARE) as usize).max(self.visible.len());
        let hidden = |(_, patch): &(usize, &ShownPatch)| patch.is_held && patch.seen != self.frame;
        let mut oldest: Vec<(u64, usize)> = (self.patches.iter().enumerate())
            .filter(hidden)
            .map(|(index, patch)| (patch.seen, index))
            .collect();
        oldest.sort_unstable();
        oldest.truncate(self.held - left);
        self.held -= oldest.len();
        let dropped = oldest.into_iter().map(|(_, index)| {
            self.patches[index].is_held = false;
            PatchId(index as u32)
        });
        dropped.collect()
    }
}

/// The vertices of a patch, row by row from the south-west; without data at height 0.
pub(super) fn positions(ground: PatchedGround<'_>, corner: Vertex) -> Vec<[f32; 3]> {
    let side = ground.layout.patch();
    let row = |y: i32| (0..=side).map(move |x| ground.position(corner.moved(x, y)).to_array());
    (0..=side).flat_map(row).collect()
}

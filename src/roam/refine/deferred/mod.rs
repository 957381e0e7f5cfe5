//! Deferred examination: a frame costs the vertices that change or fall due, not those that are shown.
//!
//! A vertex s meters from the surface of its sphere cannot change before the eye has traveled s meters: the delay factor of
//! the constrained nested error criterion, made exact by counting distance instead of frames. Every vertex that could change
//! next waits in a wheel keyed by distance traveled, and is examined when it falls due.
//!
//! Nothing is examined in patches out of view; vertices that fall due there are examined when the patch is in view again. A
//! patch whose middle sphere has never held the eye shows its two root triangles and has no mesh.
//!
//! The mesh is exactly that of `rebuild` with the spheres as criterion, over the patches shown. The criterion must be nested
//! spheres: others have no distance within which they cannot change.
//!
//! Costs, on one core, 3 µs a frame, 125 ns a vertex that changes and 21 ns one that is only examined (a fit over frames with
//! 9,000 triangles at five speeds). The number of vertices examined grows with the speed and with the logarithm of the
//! distance to those that may change. The longest frames, up to 0.15 ms, are those in which patches without a mesh come into
//! view.

mod check;
mod mend;
pub mod patch;
pub mod surface;
pub mod topology;
pub mod wheel;

use std::sync::Arc;

use glam::Vec3;

use crate::active::ActiveSet;
use crate::block::{BlockError, BlockSource, PatchBlock};
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::refine::changes::RefinementChanges;
use crate::refine::deferred::patch::{Decider, EyeStation, PatchMesh, UpdateCounts};
use crate::refine::deferred::topology::Topology;
use crate::refine::deferred::wheel::{FARTHEST, Wheel};
use sandtable_geom::rect::Rect;

/// Ticks in the distance between posts. Coarser ticks make more vertices due every frame, finer ones more slots to turn;
/// arbitrary within a few times of this.
const TICKS_PER_POST: f64 = 8.0;

/// Patches of more cells a side have no u16 for each vertex.
pub const LARGEST_PATCH: i32 = 128;

/// Bits of the vertex in an entry of the wheel; the others are the mesh.
const VERTEX_BITS: u32 = 15;

/// The tick in which edited patches without a mesh may need one: at once.
const EDITED: u64 = 0;

/// One patch of the walk.
#[derive(Clone, Copy, Debug, Default)]
struct WalkedPatch {
    /// The index of its mesh.
    mesh: Option<u32>,
    /// The first tick in which it may need a mesh.
    due: u64,
    /// The listing in which it was last without a mesh.
    bare: u64,
}

/// The list of patches that updates have been about. While it stays the same, an update goes through it only where a patch
/// without a mesh may need one.
#[derive(Clone, Debug, Default)]
struct Listing {
    /// Counts the times that the list was gone through.
    number: u64,
    /// The eye of the last time.
    eye: Vec3,
    /// Whether all of it was, so that no listed mesh has vertices to examine but the edited ones.
    is_whole: bool,
    /// The first tick in which a listed patch without a mesh may need one; [`EDITED`] where one was edited.
    due: u64,
    /// Meshes that an edit gave vertices to examine.
    edited: Vec<u32>,
}

/// Scratch lists of an update, kept for their memory.
#[derive(Debug, Default)]
struct UpdateScratch {
    due: Vec<u32>,
    inside_m: Vec<f64>,
    todo: Vec<u16>,
    behind: Vec<u32>,
}

/// A mesh that follows the eye through patches of a source.
#[derive(Debug)]
pub struct Deferred<S> {
    source: S,
    layout: PatchLayout,
    topologies: [Topology; 2],
    patches: Vec<WalkedPatch>,
    meshes: Vec<PatchMesh>,
    /// The listing in which each mesh was last.
    seen: Vec<u64>,
    /// Whether each mesh has vertices to examine when it is listed.
    behind: Vec<bool>,
    /// Meshes without a patch.
    spare: Vec<u32>,
    wheel: Wheel,
    visible: Vec<Vertex>,
    listing: Listing,
    station: EyeStation,
    /// Whether the listed patches are up to date with the eye.
    settled: bool,
    frame: u64,
    changes: RefinementChanges,
    counts: UpdateCounts,
    scratch: UpdateScratch,
}

impl<S: BlockSource> Deferred<S> {
    /// A mesh that starts at any eye. `cell_m` is the smaller distance between posts, meters, above 0.
    ///
    /// `None` where patches have more than [`LARGEST_PATCH`] cells a side.
    pub fn new(source: S, cell_m: f64) -> Option<Self> {
        let layout = *source.layout();
        if layout.patch() > LARGEST_PATCH {
            return None;
        }
        let topology = |parity: i32| Topology::new(layout.patch(), Vertex::new(parity * layout.patch(), 0));
        Some(Self {
            source,
            layout,
            topologies: [topology(0), topology(1)],
            patches: vec![WalkedPatch::default(); layout.patch_count()],
            meshes: Vec::new(),
            seen: Vec::new(),
            behind: Vec::new(),
            spare: Vec::new(),
            wheel: Wheel::new(0),
            visible: Vec::new(),
            listing: Listing::default(),
            station: EyeStation { eye: Vec3::NAN, traveled: 0.0, ticks_per_m: TICKS_PER_POST / cell_m },
            settled: false,
            frame: 0,
            changes: RefinementChanges::default(),
            counts: UpdateCounts::default(),
            scratch: UpdateScratch::default(),
        })
    }

    /// Updates the listed patches to the eye; `visible` are south-west corners, each once.
    ///
    /// # Errors
    /// A patch cannot be read; the update can be repeated.
    pub fn update(&mut self, eye: Vec3, visible: &[Vertex]) -> Result<&RefinementChanges, BlockError> {
        self.changes = RefinementChanges {
            dirty: std::mem::take(&mut self.changes.dirty),
            ..RefinementChanges::default()
        };
        self.changes.dirty.clear();
        self.counts = UpdateCounts::default();
        if self.settled && eye == self.station.eye && visible == self.visible {
            return Ok(&self.changes);
        }
        self.settled = false;
        self.scratch.behind.clear();
        self.travel_to(eye);
        self.frame += 1;
        self.list_patches(visible)?;
        self.examine_due();
        self.catch_up();
        self.changes.splits = self.counts.splits;
        self.changes.merges = self.counts.merges;
        self.changes.dirty.sort_unstable();
        self.settled = true;
        Ok(&self.changes)
    }

    /// The patches listed last.
    pub fn visible(&self) -> &[Vertex] {
        &self.visible
    }

    /// The eye of the last update, world space.
    pub fn eye(&self) -> Vec3 {
        self.station.eye
    }

    /// The changes of the last update. A patch that has come into view is not dirty for that alone.
    pub fn changes(&self) -> &RefinementChanges {
        &self.changes
    }

    /// Boxes, in world space, around the triangles of a patch that the last update changed: one for each vertex that became
    /// active or inactive. Heights that were edited are no such change.
    pub fn changed_areas(&self, patch: usize) -> impl ExactSizeIterator<Item = Rect> {
        let has_changed = self.changes.dirty.binary_search(&patch).is_ok();
        let mesh = self.patches[patch].mesh.filter(|_| has_changed).map(|mesh| &self.meshes[mesh as usize]);
        mesh.map_or(&[][..], PatchMesh::flipped).iter().map(move |&vertex| {
            let mesh = mesh.expect("only meshes change");
            mesh.around(&self.topologies[mesh.parity], vertex)
        })
    }

    /// The number of vertices that the last update examined.
    pub fn examined(&self) -> usize {
        self.counts.examined
    }

    /// The triangles shown of a patch: corners by number, counter-clockwise. [`Topology`] numbers the vertices, the same for
    /// all patches of one orientation; [`Deferred::vertex`] resolves a number.
    pub fn indices(&self, corner: Vertex) -> &[[u16; 3]] {
        self.mesh(corner).map_or(self.topology(corner).roots().as_slice(), PatchMesh::indices)
    }

    /// [`Deferred::indices`] by the places of vertices in a patch stored row by row from the south-west. A patch without a
    /// mesh that lacks data at a corner shows the other half.
    pub fn local_triangles(&self, corner: Vertex) -> Vec<[u16; 3]> {
        let topology = self.topology(corner);
        let place = |number: u16| topology.row_major(number) as u16;
        let local = |&[a, b, c]: &[u16; 3]| [place(a), place(b), place(c)];
        if let Some(mesh) = self.mesh(corner) {
            return mesh.indices().iter().map(local).collect();
        }
        let has_data = |corners: &&[u16; 3]| {
            corners.iter().all(|&number| !self.corner_position(corner, number).z.is_nan())
        };
        topology.roots().iter().filter(has_data).map(local).collect()
    }

    /// The position of one of the four corners of the patch with south-west corner `corner`, by its number; Z NaN without
    /// data.
    fn corner_position(&self, corner: Vertex, number: u16) -> Vec3 {
        let [x, y] = self.topology(corner).places()[number as usize];
        self.source.corners(corner)[usize::from(x > 0) + 2 * usize::from(y > 0)]
    }

    /// The vertex with a number in the patch with south-west corner `corner`.
    pub fn vertex(&self, corner: Vertex, number: u16) -> Vertex {
        let [column, row] = self.topology(corner).places()[number as usize].map(i32::from);
        corner.moved(column, row)
    }

    /// The number of triangles that the listed patches show.
    pub fn triangle_count(&self) -> usize {
        self.visible.iter().map(|&corner| self.indices(corner).len()).sum()
    }

    /// The active vertices of the patches listed last, and those that they need around them.
    pub fn active_set(&self) -> ActiveSet {
        let mut active = ActiveSet::new(self.layout);
        let side = self.layout.patch() + 1;
        for &corner in &self.visible {
            let Some(mesh) = self.mesh(corner) else { continue };
            for number in (0..(side * side) as u16).filter(|&number| mesh.is_active(number)) {
                active.activate(self.vertex(corner, number));
            }
        }
        active
    }

    /// Marks the patches whose south-west corners are listed as edited: their heights or spheres have changed in the source.
    /// The next update applies the changes.
    ///
    /// # Errors
    /// A patch cannot be read.
    pub fn edit(&mut self, dirty: &[Vertex]) -> Result<(), BlockError> {
        self.settled = false;
        for &corner in dirty {
            if let Some(mesh) = self.edited_mesh(corner) {
                let block = self.source.block(corner)?;
                self.edit_mesh(mesh, &block);
            }
        }
        Ok(())
    }

    /// The mesh of an edited patch; one without a mesh may need it at once.
    fn edited_mesh(&mut self, corner: Vertex) -> Option<u32> {
        let patch = &mut self.patches[self.layout.patch_index(corner)];
        patch.due = EDITED;
        if patch.mesh.is_none() && patch.bare == self.listing.number {
            self.listing.due = EDITED;
        }
        patch.mesh
    }

    fn edit_mesh(&mut self, mesh: u32, block: &Arc<PatchBlock>) {
        let (entries, slot) = (mesh << VERTEX_BITS, mesh as usize);
        let topology = &self.topologies[self.meshes[slot].parity];
        if self.meshes[slot].edit(topology, block) {
            self.miss_renewed(mesh);
        } else {
            self.wheel.retain(|entry| entry >> VERTEX_BITS != mesh);
            self.meshes[slot].reset(topology, block, entries);
            self.fall_behind(mesh);
        }
    }

    /// Notes that an edit gave a mesh vertices to examine.
    fn fall_behind(&mut self, mesh: u32) {
        if !std::mem::replace(&mut self.behind[mesh as usize], true) {
            self.listing.edited.push(mesh);
        }
    }

    /// Marks the renewed vertices of a mesh that may have changed sides, or may do so before they are due.
    fn miss_renewed(&mut self, mesh: u32) {
        let (entries, slot) = (mesh << VERTEX_BITS, mesh as usize);
        let patch = &mut self.meshes[slot];
        let topology = &self.topologies[patch.parity];
        let renewed = patch.take_renewed();
        let mut is_behind = false;
        for &vertex in renewed.iter().filter(|&&vertex| !Topology::is_corner(vertex)) {
            let waits = patch.is_waiting(vertex);
            if !waits && !patch.may_change(vertex) {
                // A change of its neighbors examines it.
                continue;
            }
            if waits {
                let inside = self.station.inside_m(patch.sphere(topology, vertex));
                let is_soon_enough = (inside > 0.0) == patch.is_active(vertex)
                    && self.station.due(inside.abs()) >= self.wheel.begin(patch.list(vertex));
                if is_soon_enough {
                    continue;
                }
                patch.leave(vertex);
                self.wheel.remove(entries + u32::from(vertex), patch.list(vertex));
            }
            patch.miss(vertex);
            is_behind = true;
        }
        patch.keep(renewed);
        if is_behind {
            self.fall_behind(mesh);
        }
    }

    /// The vertices of the patch with south-west corner `corner`; `None` while it has no mesh.
    pub fn block(&self, corner: Vertex) -> Option<&Arc<PatchBlock>> {
        self.mesh(corner).map(PatchMesh::block)
    }

    /// The source of patches.
    pub fn source(&self) -> &S {
        &self.source
    }

    /// The source of patches; a change of it must be followed by [`Deferred::edit`].
    pub fn source_mut(&mut self) -> &mut S {
        &mut self.source
    }

    /// Exchanges the meshes with those of `other`, whose source has the same patches: each source must have, from now on, the
    /// spheres that the other had.
    pub fn exchange<T>(&mut self, other: &mut Deferred<T>) {
        use std::mem::swap;
        swap(&mut self.patches, &mut other.patches);
        swap(&mut self.meshes, &mut other.meshes);
        swap(&mut self.seen, &mut other.seen);
        swap(&mut self.behind, &mut other.behind);
        swap(&mut self.spare, &mut other.spare);
        swap(&mut self.wheel, &mut other.wheel);
        swap(&mut self.visible, &mut other.visible);
        swap(&mut self.listing, &mut other.listing);
        swap(&mut self.station, &mut other.station);
        swap(&mut self.settled, &mut other.settled);
        swap(&mut self.frame, &mut other.frame);
        swap(&mut self.changes, &mut other.changes);
        swap(&mut self.counts, &mut other.counts);
    }

    /// The number of patches with a mesh.
    pub fn meshes(&self) -> usize {
        self.meshes.len() - self.spare.len()
    }

    /// Drops the meshes of the patches that have not been listed for the longest time, until at most `most` are left or only
    /// listed ones.
    pub fn forget(&mut self, most: usize) {
        let mut held: Vec<(u64, usize, u32)> = (self.patches.iter().enumerate())
            .filter_map(|(index, patch)| Some((index, patch.mesh?)))
            .map(|(index, mesh)| (self.seen[mesh as usize], index, mesh))
            .filter(|&(seen, ..)| seen < self.listing.number)
            .collect();
        held.sort_unstable();
        held.truncate(self.meshes().saturating_sub(most));
        let mut given_up = vec![false; self.meshes.len()];
        for &(_, index, mesh) in &held {
            given_up[mesh as usize] = true;
            self.patches[index] = WalkedPatch::default();
            self.spare.push(mesh);
        }
        self.wheel.retain(|entry| !given_up[(entry >> VERTEX_BITS) as usize]);
    }

    /// Checks that every listed patch is sound, and right for the current eye.
    ///
    /// # Panics
    /// Where one is not.
    pub fn check(&self) {
        for &corner in &self.visible {
            if let Some(mesh) = self.mesh(corner) {
                mesh.check(self.topology(corner), &self.station);
            }
        }
    }

    /// Adds the distance traveled. Nothing waits for longer than [`FARTHEST`] ticks, so no leap counts for more; neither does
    /// one to or from an eye that is NaN.
    fn travel_to(&mut self, eye: Vec3) {
        let moved_m = (eye.as_dvec3() - self.station.eye.as_dvec3()).length();
        let ticks = moved_m * self.station.ticks_per_m;
        let farthest = FARTHEST as f64;
        self.station.traveled += if ticks < farthest { ticks } else { farthest };
        self.station.eye = eye;
    }

    fn topology(&self, corner: Vertex) -> &Topology {
        &self.topologies[parity(&self.layout, corner)]
    }

    fn mesh(&self, corner: Vertex) -> Option<&PatchMesh> {
        self.patches[self.layout.patch_index(corner)].mesh.map(|mesh| &self.meshes[mesh as usize])
    }

    /// Gives a mesh to the listed patches that need it now, and collects the listed meshes that have vertices to examine.
    fn list_patches(&mut self, visible: &[Vertex]) -> Result<(), BlockError> {
        let Listing { eye, is_whole, due, .. } = self.listing;
        let is_any_due = due == EDITED || (due <= self.station.tick() && eye != self.station.eye);
        if is_whole && !is_any_due && visible == self.visible {
            let (seen, number) = (&self.seen, self.listing.number);
            let listed = self.listing.edited.drain(..).filter(|&mesh| seen[mesh as usize] == number);
            self.scratch.behind.extend(listed);
            return Ok(());
        }
        self.visible.clear();
        self.visible.extend_from_slice(visible);
        self.listing.edited.clear();
        self.listing = Listing {
            number: self.listing.number + 1,
            eye: self.station.eye,
            is_whole: false,
            due: u64::MAX,
            edited: std::mem::take(&mut self.listing.edited),
        };
        for at in 0..self.visible.len() {
            let corner = self.visible[at];
            let index = self.layout.patch_index(corner);
            let shown = &mut self.patches[index];
            if let Some(mesh) = shown.mesh {
                self.seen[mesh as usize] = self.listing.number;
                if self.behind[mesh as usize] {
                    self.scratch.behind.push(mesh);
                }
                continue;
            }
            shown.bare = self.listing.number;
            if shown.due <= self.station.tick() {
                self.add_mesh_if_needed(corner, index)?;
            }
            let shown = self.patches[index];
            if shown.mesh.is_none() {
                self.listing.due = self.listing.due.min(shown.due);
            }
        }
        self.listing.is_whole = true;
        Ok(())
    }

    fn add_mesh_if_needed(&mut self, corner: Vertex, index: usize) -> Result<(), BlockError> {
        let root = self.source.root(corner);
        let inside = self.station.inside_m([root.center.x, root.center.y, root.center.z, root.radius]);
        if inside <= 0.0 {
            self.patches[index].due = self.station.due(-inside);
            return Ok(());
        }
        let block = self.source.block(corner)?;
        let mesh = self.spare.pop().unwrap_or_else(|| {
            self.meshes.push(PatchMesh::default());
            self.seen.push(0);
            self.behind.push(false);
            self.meshes.len() as u32 - 1
        });
        let patch = &mut self.meshes[mesh as usize];
        patch.parity = parity(&self.layout, corner);
        patch.patch = index;
        patch.reset(&self.topologies[patch.parity], &block, mesh << VERTEX_BITS);
        self.patches[index].mesh = Some(mesh);
        self.seen[mesh as usize] = self.listing.number;
        self.behind[mesh as usize] = true;
        self.scratch.behind.push(mesh);
        Ok(())
    }

    /// Examines the vertices that fell due: first measures all, then decides. Most reads miss the cache, and reads that do not
    /// wait for decisions overlap.
    fn examine_due(&mut self) {
        let mut due = std::mem::take(&mut self.scratch.due);
        let mut inside_m = std::mem::take(&mut self.scratch.inside_m);
        due.clear();
        inside_m.clear();
        self.wheel.take_due(self.station.tick(), &mut due);
        inside_m.extend(due.iter().map(|&entry| {
            let patch = &mut self.meshes[(entry >> VERTEX_BITS) as usize];
            patch.leave(vertex_of(entry));
            self.station.inside_m(patch.sphere(&self.topologies[patch.parity], vertex_of(entry)))
        }));
        for (&entry, &inside) in due.iter().zip(&inside_m) {
            let mesh = (entry >> VERTEX_BITS) as usize;
            if self.seen[mesh] == self.listing.number {
                self.with_patch(mesh, |patch, with| patch.decide(with, vertex_of(entry), inside));
            } else {
                self.meshes[mesh].miss(vertex_of(entry));
                self.behind[mesh] = true;
            }
        }
        self.scratch.due = due;
        self.scratch.inside_m = inside_m;
    }

    /// Examines the vertices that the listed patches missed.
    fn catch_up(&mut self) {
        while let Some(mesh) = self.scratch.behind.pop() {
            self.behind[mesh as usize] = false;
            self.with_patch(mesh as usize, PatchMesh::catch_up);
        }
    }

    /// Calls `decide` for a mesh.
    #[inline]
    fn with_patch(&mut self, mesh: usize, decide: impl FnOnce(&mut PatchMesh, &mut Decider<'_>)) {
        let patch = &mut self.meshes[mesh];
        let mut with = Decider {
            topology: &self.topologies[patch.parity],
            station: &self.station,
            wheel: &mut self.wheel,
            todo: &mut self.scratch.todo,
            counts: &mut self.counts,
            frame: self.frame,
            dirty: &mut self.changes.dirty,
        };
        decide(patch, &mut with);
    }
}

/// The vertex of an entry of the wheel.
#[inline]
fn vertex_of(entry: u32) -> u16 {
    (entry & ((1 << VERTEX_BITS) - 1)) as u16
}

/// Which of the two orientations a patch has.
fn parity(layout: &PatchLayout, corner: Vertex) -> usize {
    ((corner.x / layout.patch() + corner.y / layout.patch()) % 2) as usize
}

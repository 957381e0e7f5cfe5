//! Deferred re-examination: a frame costs what changed and what fell due, not what is shown.
//!
//! A vertex that is s metres from the surface of its sphere cannot change before the eye has travelled s metres:
//! the delay factor of the constrained nested error criterion, made exact by counting distance instead of frames.
//! So every vertex that could change next waits in a wheel keyed by distance travelled, one wheel a patch, and is
//! looked at when it falls due.
//!
//! Patches out of view wait: nothing is looked at in them, and what fell due meanwhile is made up for when they come
//! into view again. A patch whose middle sphere does not hold the eye shows its two root triangles and has no memory
//! of its own.
//!
//! The mesh is exactly that of `rebuild` with the spheres as criterion, over the patches shown. Any nested spheres
//! will do, and nothing else: other criteria have no distance within which they keep their mind.
//!
//! Cost, on one core: 60 to 100 ns a vertex that changes, 10 to 20 ns one looked at, 5 ns a patch in view. What is
//! looked at each frame grows with the speed and with the logarithm of the distance to what may change.

mod check;
pub mod patch;
pub mod topology;
pub mod wheel;

use glam::Vec3;

use crate::roam::active::ActiveSet;
use crate::roam::block::{BlockError, BlockSource};
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;
use crate::roam::refine::Changes;
use crate::roam::refine::deferred::patch::{PatchMesh, Station};
use crate::roam::refine::deferred::topology::Topology;

/// Ticks that a post's distance is cut into. Finer ticks look at fewer vertices every frame, coarser ones turn fewer
/// slots: between 4 and 32 the cost of a frame changes by a tenth.
const TICKS_PER_POST: f64 = 8.0;

/// Patches of more cells a side have no u16 for each vertex.
pub const LARGEST_PATCH: i32 = 128;

/// One patch of the walk.
#[derive(Debug, Default)]
struct Shown {
    mesh: Option<Box<PatchMesh>>,
    /// The tick before which nothing can change in the patch.
    due: u64,
    /// The update in which it was last listed.
    seen: u64,
}

/// A mesh that follows the eye through patches of a source.
#[derive(Debug)]
pub struct Deferred<S> {
    source: S,
    layout: Layout,
    topologies: [Topology; 2],
    patches: Vec<Shown>,
    #[expect(clippy::vec_box, reason = "boxes are handed over, a kilobyte and a half each")]
    spare: Vec<Box<PatchMesh>>,
    visible: Vec<Vertex>,
    station: Station,
    /// Whether the listed patches are right for where the eye is.
    settled: bool,
    frame: u64,
    changes: Changes,
    examined: usize,
}

impl<S: BlockSource> Deferred<S> {
    /// A walk that starts anywhere. `cell_m` is the smaller distance between posts, metres, and more than 0.
    ///
    /// `None` where patches have more than [`LARGEST_PATCH`] cells a side.
    pub fn new(source: S, cell_m: f64) -> Option<Self> {
        let layout = *source.layout();
        if layout.patch() > LARGEST_PATCH {
            return None;
        }
        let topology = |parity: i32| Topology::new(layout.patch(), Vertex::new(parity * layout.patch(), 0));
        let mut patches = Vec::new();
        patches.resize_with(layout.patch_count(), Shown::default);
        Some(Self {
            source,
            layout,
            topologies: [topology(0), topology(1)],
            patches,
            spare: Vec::new(),
            visible: Vec::new(),
            // The first tick is past 0, so that a patch never looked at is due.
            station: Station { eye: Vec3::NAN, travelled: 1.0, ticks_per_m: TICKS_PER_POST / cell_m },
            settled: false,
            frame: 0,
            changes: Changes::default(),
            examined: 0,
        })
    }

    /// Brings the listed patches to where the eye is; `visible` are south-west corners, each once.
    ///
    /// # Errors
    /// Where a patch cannot be had; the patches before it are up to date, and the update can be asked for again.
    pub fn update(&mut self, eye: Vec3, visible: &[Vertex]) -> Result<&Changes, BlockError> {
        self.changes.splits = 0;
        self.changes.merges = 0;
        self.changes.dirty.clear();
        self.examined = 0;
        if self.settled && eye == self.station.eye && visible == self.visible {
            return Ok(&self.changes);
        }
        self.settled = false;
        self.travel_to(eye);
        self.frame += 1;
        self.visible.clear();
        self.visible.extend_from_slice(visible);
        for &corner in visible {
            self.update_patch(corner)?;
        }
        self.settled = true;
        Ok(&self.changes)
    }

    /// The patches listed last.
    pub fn visible(&self) -> &[Vertex] {
        &self.visible
    }

    /// What the last update changed. A patch that has come into view is not dirty for that alone.
    pub fn changes(&self) -> &Changes {
        &self.changes
    }

    /// How many vertices the last update looked at.
    pub fn examined(&self) -> usize {
        self.examined
    }

    /// The triangles shown of a patch: corners by number, counter-clockwise. Vertices are numbered as [`Topology`]
    /// numbers them, the same for all patches of one orientation; [`Deferred::vertex`] tells which is which.
    pub fn indices(&self, corner: Vertex) -> &[[u16; 3]] {
        match &self.patches[self.layout.patch_index(corner)].mesh {
            Some(mesh) => mesh.indices(),
            None => self.topology(corner).flat(),
        }
    }

    /// The vertex with a number in the patch with south-west corner `corner`.
    pub fn vertex(&self, corner: Vertex, number: u16) -> Vertex {
        let [column, row] = self.topology(corner).places()[number as usize].map(i32::from);
        corner.moved(column, row)
    }

    /// How many triangles the listed patches show.
    pub fn triangle_count(&self) -> usize {
        self.visible.iter().map(|&corner| self.indices(corner).len()).sum()
    }

    /// The bits of the patches listed last, and of what they need around them.
    pub fn active_set(&self) -> ActiveSet {
        let mut active = ActiveSet::new(self.layout);
        let side = self.layout.patch() + 1;
        for &corner in &self.visible {
            let Some(mesh) = &self.patches[self.layout.patch_index(corner)].mesh else { continue };
            for number in (0..(side * side) as u16).filter(|&number| mesh.is_active(number)) {
                active.activate(self.vertex(corner, number));
            }
        }
        active
    }

    /// Tells of an edit: the heights or spheres of the patches whose south-west corners are listed have changed in
    /// the source. They are mended in the next update.
    ///
    /// # Errors
    /// Where a patch cannot be had.
    pub fn edit(&mut self, dirty: &[Vertex]) -> Result<(), BlockError> {
        self.settled = false;
        for &corner in dirty {
            let index = self.layout.patch_index(corner);
            self.patches[index].due = 0;
            if self.patches[index].mesh.is_some() {
                let block = self.source.block(corner)?;
                let topology = &self.topologies[parity(&self.layout, corner)];
                if let Some(mesh) = &mut self.patches[index].mesh {
                    mesh.edit(topology, &block);
                }
            }
        }
        Ok(())
    }

    /// Where patches come from; whoever changes it tells so by [`Deferred::edit`].
    pub fn source_mut(&mut self) -> &mut S {
        &mut self.source
    }

    /// How many patches have a mesh of their own.
    pub fn meshes(&self) -> usize {
        self.patches.iter().filter(|patch| patch.mesh.is_some()).count()
    }

    /// Gives up the meshes of patches that have not been listed for the longest time, until at most `most` are left
    /// or only listed ones; they are made anew when they are listed again.
    pub fn forget(&mut self, most: usize) {
        let mut held: Vec<(u64, usize)> = (self.patches.iter().enumerate())
            .filter(|(_, patch)| patch.mesh.is_some() && patch.seen < self.frame)
            .map(|(index, patch)| (patch.seen, index))
            .collect();
        held.sort_unstable();
        let surplus = self.meshes().saturating_sub(most);
        for (_, index) in held.into_iter().take(surplus) {
            self.patches[index].mesh = None;
            self.patches[index].due = 0;
        }
        self.spare.clear();
    }

    /// Whether every listed patch is sound, and right for where the eye is now.
    ///
    /// # Errors
    /// A sentence naming the first patch that is not.
    pub fn check(&self) -> Result<(), String> {
        for &corner in &self.visible {
            if let Some(mesh) = &self.patches[self.layout.patch_index(corner)].mesh {
                mesh.check(self.topology(corner), &self.station)
                    .map_err(|flaw| format!("patch at {corner:?}: {flaw}"))?;
            }
        }
        Ok(())
    }

    fn travel_to(&mut self, eye: Vec3) {
        let moved_m = (eye.as_dvec3() - self.station.eye.as_dvec3()).length();
        if moved_m.is_finite() {
            self.station.travelled += moved_m * self.station.ticks_per_m;
        }
        self.station.eye = eye;
    }

    fn topology(&self, corner: Vertex) -> &Topology {
        &self.topologies[parity(&self.layout, corner)]
    }

    fn update_patch(&mut self, corner: Vertex) -> Result<(), BlockError> {
        let index = self.layout.patch_index(corner);
        let shown = &mut self.patches[index];
        shown.seen = self.frame;
        if shown.due > self.station.tick() {
            return Ok(());
        }
        if shown.mesh.is_none() {
            let root = self.source.root(corner);
            let inside = self.station.inside_m([root.center.x, root.center.y, root.center.z, root.radius]);
            if inside <= 0.0 {
                shown.due = self.station.due(-inside);
                return Ok(());
            }
            self.found_mesh(corner, index)?;
        }
        self.update_mesh(corner, index);
        Ok(())
    }

    /// Gives a patch a mesh of its own.
    fn found_mesh(&mut self, corner: Vertex, index: usize) -> Result<(), BlockError> {
        let block = self.source.block(corner)?;
        let topology = &self.topologies[parity(&self.layout, corner)];
        let mut mesh = self.spare.pop().unwrap_or_else(|| Box::new(PatchMesh::new(topology, &block)));
        mesh.reset(topology, &block, self.station.tick());
        self.patches[index].mesh = Some(mesh);
        Ok(())
    }

    fn update_mesh(&mut self, corner: Vertex, index: usize) {
        let topology = &self.topologies[parity(&self.layout, corner)];
        let shown = &mut self.patches[index];
        let Some(mesh) = &mut shown.mesh else { return };
        let counts = mesh.update(topology, &self.station);
        shown.due = mesh.next_tick();
        self.examined += counts.examined;
        if counts.splits + counts.merges > 0 {
            self.changes.splits += counts.splits;
            self.changes.merges += counts.merges;
            self.changes.dirty.push(index);
            if mesh.is_flat() {
                self.spare.extend(shown.mesh.take());
                shown.due = 0;
            }
        }
    }
}

/// Which of the two orientations a patch has.
fn parity(layout: &Layout, corner: Vertex) -> usize {
    ((corner.x / layout.patch() + corner.y / layout.patch()) % 2) as usize
}

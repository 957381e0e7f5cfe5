//! One patch that follows the eye on its own.
//!
//! A vertex is active exactly while the eye is inside its sphere, spheres are nested, and vertices on a border have the same
//! sphere in both patches: each patch is a function of the eye alone, and patches that are up to date agree along their
//! borders.
//!
//! Only inactive vertices with active parents and active vertices without active children can change next. They wait in the
//! wheel until the eye may have reached their sphere's surface; those that fall due while the patch is out of view are kept
//! for its return. Each change rewrites four entries of the patch's index list, which is always dense.

use std::sync::Arc;

use glam::{DVec2, Vec3};

use crate::block::PatchBlock;
use crate::refine::deferred::topology::{CENTER, NONE, Topology, TopologyNode, triangle};
use crate::refine::deferred::wheel::{FARTHEST, Wheel, WheelList};
use sandtable_geom::rect::Rect;

/// Slack is shortened by this share before it is turned into ticks: more than all rounding on the way.
const SAFETY: f64 = 1.0 - 1e-9;

/// How many vertices are compared at once where most are the same.
const ROW: usize = 64;

const ACTIVE: u8 = 1;
/// In a list of the wheel.
const WAITING: u8 = 2;
/// No triangle is shown that has this corner: it has no data.
const HOLE: u8 = 4;
/// Counts parents that are active, two of them; one outside the patch counts, since the vertex's own sphere says
/// whether it is.
const ONE_PARENT: u8 = 8;
const BOTH_PARENTS: u8 = 2 * ONE_PARENT;
const PARENTS: u8 = 3 * ONE_PARENT;
/// Counts active children, of which there are at most four.
const ONE_CHILD: u8 = 32;

/// The eye and the distance that it has traveled.
#[derive(Clone, Copy, Debug)]
pub struct EyeStation {
    /// The eye, world space.
    pub eye: Vec3,
    /// Ticks traveled, with their fraction.
    pub traveled: f64,
    /// Ticks in a meter.
    pub ticks_per_m: f64,
}

impl EyeStation {
    /// The last full tick.
    #[inline]
    pub fn tick(&self) -> u64 {
        self.traveled as u64
    }

    /// The first tick in which a vertex `slack_m` meters from its sphere's surface can change; at most [`FARTHEST`] ahead.
    #[inline]
    pub fn due(&self, slack_m: f64) -> u64 {
        let ahead = (slack_m * self.ticks_per_m * SAFETY).min(FARTHEST as f64);
        (self.traveled + ahead) as u64
    }

    /// The depth of the eye inside the sphere about (`x`, `y`, `z`), meters; negative outside, −∞ for a radius of 0. In f64,
    /// so that neighbors agree to the last bit and nested spheres stay nested.
    #[inline]
    pub fn inside_m(&self, [x, y, z, radius]: [f32; 4]) -> f64 {
        let (dx, dy, dz) = (
            f64::from(x) - f64::from(self.eye.x),
            f64::from(y) - f64::from(self.eye.y),
            f64::from(z) - f64::from(self.eye.z),
        );
        let inside = f64::from(radius) - (dx * dx + dy * dy + dz * dz).sqrt();
        // An eye that is NaN is outside everything, and everything still waits for its return.
        if radius > 0.0 { inside.max(f64::MIN) } else { f64::NEG_INFINITY }
    }
}

/// The sphere of a vertex and its list in the wheel: twelve bytes, five to a cache line. The flags, which change with the
/// neighbors, are stored apart, sixty-four to a line, and so are the places of triangles: one record of 32 bytes for all
/// three takes half as much memory again, and whole frames were no faster for it.
#[derive(Clone, Copy, Debug)]
struct VertexCell {
    z: f32,
    radius: f32,
    list: WheelList,
}

/// The mesh of one patch.
#[derive(Clone, Debug, Default)]
pub struct PatchMesh {
    /// Its place in the layout.
    pub patch: usize,
    /// The update in which it last changed.
    pub changed: u64,
    /// Added to a vertex's number to make the wheel's entry.
    entries: u32,
    /// Whether some triangle of the patch must not be shown: over no data, or beyond the terrain's border.
    partial: bool,
    /// Which of the two orientations it has.
    pub parity: usize,
    cells: Vec<VertexCell>,
    flags: Vec<u8>,
    /// The places of each vertex's four triangles in the index list.
    slots: Vec<[u16; 4]>,
    /// The source of the vertices, for comparison with an edited one.
    block: Arc<PatchBlock>,
    indices: Vec<[u16; 3]>,
    /// Vertices to examine when the patch is listed again.
    missed: Vec<u16>,
    /// The vertices that became active or inactive in update [`PatchMesh::changed`].
    flipped: Vec<u16>,
    /// Vertices with a new sphere.
    renewed: Vec<u16>,
}

/// A vertex after an edit.
#[derive(Clone, Copy, Debug)]
pub struct RenewedVertex {
    /// Its number in the patch.
    pub number: u16,
    /// Its place in the patch's block.
    pub at: usize,
    /// Its height, meters; NaN without data.
    pub z: f32,
    /// The radius of its sphere, meters.
    pub radius: f32,
}

impl RenewedVertex {
    /// Writes its sphere into its cell and lists it where the sphere is new; false where it gained or lost data.
    #[inline]
    fn renew(self, cells: &mut [VertexCell], flags: &[u8], renewed: &mut Vec<u16>) -> bool {
        if self.z.is_nan() != (flags[self.number as usize] & HOLE != 0) {
            return false;
        }
        let z = if self.z.is_nan() { 0.0 } else { self.z };
        let cell = &mut cells[self.number as usize];
        if cell.z.to_bits() != z.to_bits() || cell.radius.to_bits() != self.radius.to_bits() {
            (cell.z, cell.radius) = (z, self.radius);
            renewed.push(self.number);
        }
        true
    }
}

/// The vertices of a mesh and of its block.
pub struct MeshVertices<'a> {
    block: &'a mut PatchBlock,
    cells: &'a mut [VertexCell],
    flags: &'a [u8],
    renewed: &'a mut Vec<u16>,
}

impl MeshVertices<'_> {
    /// Gives a vertex its height and its radius after an edit; false where it gained or lost data, so that the patch must be
    /// reset.
    #[inline]
    pub fn renew(&mut self, vertex: RenewedVertex) -> bool {
        let has_kept_data = vertex.renew(self.cells, self.flags, self.renewed);
        if has_kept_data {
            // Where it has not, the old block still tells that the patch must be reset.
            (self.block.z[vertex.at], self.block.radii[vertex.at]) = (vertex.z, vertex.radius);
        }
        has_kept_data
    }
}

/// The context of a decision.
pub struct Decider<'a> {
    /// The vertices of the patch.
    pub topology: &'a Topology,
    /// The eye.
    pub station: &'a EyeStation,
    /// Where vertices wait for their next examination.
    pub wheel: &'a mut Wheel,
    /// Vertices of the same patch still to be decided.
    pub todo: &'a mut Vec<u16>,
    /// The work done.
    pub counts: &'a mut UpdateCounts,
    /// The number of the update.
    pub frame: u64,
    /// The places in the layout of the patches that changed, each once.
    pub dirty: &'a mut Vec<usize>,
}

/// The work of an update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UpdateCounts {
    /// Vertices activated.
    pub splits: usize,
    /// Vertices deactivated.
    pub merges: usize,
    /// Vertices examined.
    pub examined: usize,
}

impl PatchMesh {
    /// Resets this to the patch of a block, with nothing active and its root triangles shown. None of its vertices may be in
    /// the wheel; they get the entries from `entries` on.
    pub fn reset(&mut self, topology: &Topology, block: &Arc<PatchBlock>, entries: u32) {
        self.entries = entries;
        self.block = Arc::clone(block);
        self.cells.clear();
        self.flags.clear();
        for (vertex, node) in topology.nodes().iter().enumerate() {
            let at = topology.row_major(vertex as u16);
            let z = block.z[at];
            let absent = u8::from(node.ring[1] == NONE) + u8::from(node.ring[3] == NONE);
            let hole = if z.is_nan() { HOLE } else { 0 };
            self.flags.push(hole | (absent * ONE_PARENT));
            let z = if z.is_nan() { 0.0 } else { z };
            self.cells.push(VertexCell { z, radius: block.radii[at], list: WheelList::NONE });
        }
        self.flags[CENTER as usize] |= BOTH_PARENTS;
        self.slots.clear();
        self.slots.resize(self.cells.len(), [NONE; 4]);
        let clipped = block.plan.iter().any(|along| along.windows(2).any(|pair| pair[0] == pair[1]));
        self.partial = clipped || block.z.iter().any(|z| z.is_nan());
        self.indices.clear();
        for corner in topology.roots().iter().flatten() {
            self.flags[*corner as usize] |= ACTIVE;
        }
        for &root in topology.roots() {
            self.show(topology, root, triangle(root[0], 0));
        }
        self.renewed.clear();
        self.missed.clear();
        self.missed.push(CENTER);
    }

    /// The triangles shown: corners by number in the patch (see [`Topology`]), counter-clockwise.
    pub fn indices(&self) -> &[[u16; 3]] {
        &self.indices
    }

    /// Its vertices.
    pub fn block(&self) -> &Arc<PatchBlock> {
        &self.block
    }

    /// Whether the vertex is active; patch corners are.
    #[inline]
    pub fn is_active(&self, vertex: u16) -> bool {
        self.flags[vertex as usize] & ACTIVE != 0
    }

    /// Adds a vertex to examine when the patch is listed next.
    #[inline]
    pub fn miss(&mut self, vertex: u16) {
        self.missed.push(vertex);
    }

    /// Decides all vertices that were missed or edited.
    pub fn catch_up(&mut self, with: &mut Decider<'_>) {
        std::mem::swap(&mut self.missed, with.todo);
        self.decide_all(with);
    }

    /// Applies an edited block; false where data was added or removed, so that the patch must be reset.
    pub fn edit(&mut self, topology: &Topology, block: &Arc<PatchBlock>) -> bool {
        let old = std::mem::replace(&mut self.block, Arc::clone(block));
        for (row, (z, radii)) in block.z.chunks(ROW).zip(block.radii.chunks(ROW)).enumerate() {
            let row = row * ROW..row * ROW + z.len();
            if same_bits(&old.z[row.clone()], z) && same_bits(&old.radii[row.clone()], radii) {
                continue;
            }
            let numbers = topology.numbers();
            let in_block = |at: usize| RenewedVertex {
                number: numbers[at],
                at,
                z: block.z[at],
                radius: block.radii[at],
            };
            let Self { cells, flags, renewed, .. } = self;
            if !row.map(in_block).all(|vertex| vertex.renew(cells, flags, renewed)) {
                return false;
            }
        }
        true
    }

    /// The vertices, in the block too, for an edit.
    pub fn vertices(&mut self) -> MeshVertices<'_> {
        let block = Arc::make_mut(&mut self.block);
        MeshVertices { block, cells: &mut self.cells, flags: &self.flags, renewed: &mut self.renewed }
    }

    /// The vertices that were renewed since this was called last; the list is to be given back with [`PatchMesh::keep`].
    pub fn take_renewed(&mut self) -> Vec<u16> {
        std::mem::take(&mut self.renewed)
    }

    /// Takes a list back, to reuse its memory.
    pub fn keep(&mut self, mut list: Vec<u16>) {
        list.clear();
        self.renewed = list;
    }

    /// Marks a vertex as in no list of the wheel.
    #[inline]
    pub fn leave(&mut self, vertex: u16) {
        self.flags[vertex as usize] &= !WAITING;
    }

    /// The list of a vertex; valid while the vertex waits.
    #[inline]
    pub fn list(&self, vertex: u16) -> WheelList {
        self.cells[vertex as usize].list
    }

    /// The active children that a vertex counts.
    pub(super) fn active_children(&self, vertex: u16) -> usize {
        usize::from(self.flags[vertex as usize] / ONE_CHILD)
    }

    /// Whether a vertex waits in the wheel.
    #[inline]
    pub(super) fn is_waiting(&self, vertex: u16) -> bool {
        self.flags[vertex as usize] & WAITING != 0
    }

    /// The place of a triangle in the index list.
    pub(super) fn slot(&self, triangle: u32) -> Option<usize> {
        let slot = self.slots[(triangle / 4) as usize][(triangle % 4) as usize];
        (slot != NONE).then_some(slot as usize)
    }

    #[inline]
    pub(super) fn sphere(&self, topology: &Topology, vertex: u16) -> [f32; 4] {
        let cell = &self.cells[vertex as usize];
        let [column, row] = topology.places()[vertex as usize];
        [self.block.plan[0][column as usize], self.block.plan[1][row as usize], cell.z, cell.radius]
    }

    /// The vertices that became active or inactive in update [`PatchMesh::changed`].
    pub fn flipped(&self) -> &[u16] {
        &self.flipped
    }

    /// The box in world space around the triangles that a vertex's activation replaces.
    pub fn around(&self, topology: &Topology, vertex: u16) -> Rect {
        let ring = topology.nodes()[vertex as usize].ring;
        let at = |number: u16| {
            let [column, row] = topology.places()[number as usize].map(usize::from);
            DVec2::new(f64::from(self.block.plan[0][column]), f64::from(self.block.plan[1][row]))
        };
        Rect::around(ring.into_iter().filter(|&number| number != NONE).map(at))
    }

    /// Decides a vertex whose sphere the eye is inside by `inside` meters, and those that follow from it.
    #[inline]
    pub fn decide(&mut self, with: &mut Decider<'_>, vertex: u16, inside: f64) {
        self.decide_one(with, vertex, inside);
        self.decide_all(with);
    }

    fn decide_all(&mut self, with: &mut Decider<'_>) {
        while let Some(vertex) = with.todo.pop() {
            let inside = with.station.inside_m(self.sphere(with.topology, vertex));
            self.decide_one(with, vertex, inside);
        }
    }

    /// Decides a vertex, unless it waits or cannot change, and puts it into the wheel.
    #[inline]
    fn decide_one(&mut self, with: &mut Decider<'_>, vertex: u16, inside: f64) {
        let flags = self.flags[vertex as usize];
        if flags & WAITING != 0 || !self.may_change(vertex) {
            return;
        }
        let active = flags & ACTIVE != 0;
        with.counts.examined += 1;
        match (active, inside > 0.0) {
            (false, true) => self.activate(with, vertex),
            (true, false) => self.deactivate(with, vertex),
            _ => {}
        }
        if inside != f64::NEG_INFINITY {
            let due = with.station.due(inside.abs());
            self.flags[vertex as usize] |= WAITING;
            self.cells[vertex as usize].list = with.wheel.put(self.entries + u32::from(vertex), due);
        }
    }

    /// Whether a vertex can change before its neighbors do: it is active without active children, or its parents are active.
    #[inline]
    pub(super) fn may_change(&self, vertex: u16) -> bool {
        let flags = self.flags[vertex as usize];
        if flags & ACTIVE != 0 { flags < ONE_CHILD } else { flags & PARENTS == BOTH_PARENTS }
    }

    /// Whether the parents of a vertex are active.
    #[inline]
    pub(super) fn may_split(&self, vertex: u16) -> bool {
        self.flags[vertex as usize] & PARENTS == BOTH_PARENTS
    }

    /// Notes that a vertex becomes active or inactive.
    #[inline]
    fn flip(&mut self, with: &mut Decider<'_>, vertex: u16) {
        if self.changed < with.frame {
            self.changed = with.frame;
            self.flipped.clear();
            with.dirty.push(self.patch);
        }
        self.flipped.push(vertex);
        self.flags[vertex as usize] ^= ACTIVE;
    }

    #[inline]
    fn activate(&mut self, with: &mut Decider<'_>, vertex: u16) {
        let topology = with.topology;
        let node = &topology.nodes()[vertex as usize];
        with.counts.splits += 1;
        self.flip(with, vertex);
        for side in 0..2 {
            let parent = node.ring[2 * side + 1];
            if parent == NONE {
                continue;
            }
            self.flags[parent as usize] += ONE_CHILD;
            let [first, second] = halves(node, vertex, side);
            self.replace(topology, node.splits[side], triangle(vertex, 2 * side), first);
            self.show(topology, second, triangle(vertex, 2 * side + 1));
        }
        let mut ready = ReadyVertices::default();
        for child in node.children.into_iter().filter(|&child| child != NONE) {
            let below = &mut self.flags[child as usize];
            *below += ONE_PARENT;
            ready.add_if(*below & (PARENTS | WAITING) == BOTH_PARENTS, child);
        }
        ready.append_to(with.todo);
    }

    #[inline]
    fn deactivate(&mut self, with: &mut Decider<'_>, vertex: u16) {
        let topology = with.topology;
        let node = &topology.nodes()[vertex as usize];
        with.counts.merges += 1;
        self.flip(with, vertex);
        for child in node.children.into_iter().filter(|&child| child != NONE) {
            self.flags[child as usize] -= ONE_PARENT;
        }
        let mut ready = ReadyVertices::default();
        for side in 0..2 {
            let parent = node.ring[2 * side + 1];
            if parent == NONE {
                continue;
            }
            self.hide(topology, triangle(vertex, 2 * side + 1));
            let whole = [parent, node.ring[(2 * side + 2) % 4], node.ring[2 * side]];
            self.replace(topology, triangle(vertex, 2 * side), node.splits[side], whole);
            let above = &mut self.flags[parent as usize];
            *above -= ONE_CHILD;
            ready.add_if(*above < ONE_CHILD && *above & WAITING == 0 && !Topology::is_corner(parent), parent);
        }
        ready.append_to(with.todo);
    }

    /// Shows a triangle in the place of another.
    #[inline]
    fn replace(&mut self, topology: &Topology, old: u32, new: u32, corners: [u16; 3]) {
        let slot = self.slots[(old / 4) as usize][(old % 4) as usize];
        if slot == NONE || self.partial {
            self.hide(topology, old);
            self.show(topology, corners, new);
            return;
        }
        self.slots[(old / 4) as usize][(old % 4) as usize] = NONE;
        self.slots[(new / 4) as usize][(new % 4) as usize] = slot;
        self.indices[slot as usize] = corners;
    }

    /// Adds a triangle to the index list, unless it lies over no data or has no area.
    #[inline]
    fn show(&mut self, topology: &Topology, corners: [u16; 3], triangle: u32) {
        if self.partial && self.is_missing(topology, corners) {
            return;
        }
        self.slots[(triangle / 4) as usize][(triangle % 4) as usize] = self.indices.len() as u16;
        self.indices.push(corners);
    }

    /// Takes a triangle out of the index list; the last one takes its place.
    #[inline]
    fn hide(&mut self, topology: &Topology, triangle: u32) {
        let own = &mut self.slots[(triangle / 4) as usize][(triangle % 4) as usize];
        let slot = std::mem::replace(own, NONE);
        if slot == NONE {
            return;
        }
        self.indices.swap_remove(slot as usize);
        if let Some(&corners) = self.indices.get(slot as usize) {
            let moved = topology.triangle_of(corners);
            self.slots[(moved / 4) as usize][(moved % 4) as usize] = slot;
        }
    }

    /// Whether a leaf of the bintree is displayed.
    pub(super) fn is_displayed(&self, topology: &Topology, corners: [u16; 3]) -> bool {
        !(self.partial && self.is_missing(topology, corners))
    }

    /// Whether a triangle lies over no data, or has no area, as beyond the border of the terrain.
    pub(super) fn is_missing(&self, topology: &Topology, corners: [u16; 3]) -> bool {
        if corners.iter().any(|&corner| self.flags[corner as usize] & HOLE != 0) {
            return true;
        }
        let [a, b, c] = corners.map(|corner| self.sphere(topology, corner));
        (b[0] - a[0]) * (c[1] - a[1]) == (b[1] - a[1]) * (c[0] - a[0])
    }
}

/// Up to four vertices to examine. Whether a vertex is added is written without a branch, which would be foreseen wrongly as
/// often as not.
#[derive(Default)]
struct ReadyVertices {
    vertices: [u16; 4],
    count: usize,
}

impl ReadyVertices {
    #[inline]
    fn add_if(&mut self, is_ready: bool, vertex: u16) {
        self.vertices[self.count & 3] = vertex;
        self.count += usize::from(is_ready);
    }

    #[inline]
    fn append_to(self, todo: &mut Vec<u16>) {
        let end = todo.len() + self.count;
        todo.extend_from_slice(&self.vertices);
        todo.truncate(end);
    }
}

/// The two triangles that activating a vertex makes of the one on its parent's side.
fn halves(node: &TopologyNode, vertex: u16, side: usize) -> [[u16; 3]; 2] {
    let [first, parent, second] = [2 * side, 2 * side + 1, (2 * side + 2) % 4].map(|at| node.ring[at]);
    [[vertex, first, parent], [vertex, parent, second]]
}

/// Whether two rows hold the same bits; no data equals no data.
fn same_bits(a: &[f32], b: &[f32]) -> bool {
    a.iter().zip(b).fold(0, |differs, (a, b)| differs | (a.to_bits() ^ b.to_bits())) == 0
}

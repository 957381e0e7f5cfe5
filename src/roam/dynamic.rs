//! A terrain whose heights change while it is shown (dynamic terrain of Yu and Zhang: craters, tire tracks).
//!
//! All that is computed from the heights is updated by each edit and equals, bit for bit, a computation from the new
//! heights. An edit reports its dirty patches; features on the ground and copies of it need an update there alone.
//!
//! A terrain is a source of patches that a [`Deferred`](crate::refine::deferred::Deferred) mesh can own: edit the
//! mesh's source, and pass the edit to the mesh.
//!
//! The heights are shared: an edit changes a copy where a snapshot of them is held elsewhere, and copies nothing otherwise.

use std::sync::Arc;

use glam::Vec3;

use crate::active::ActiveSet;
use crate::block::{BlockError, BlockSource, PatchBlock, RootSphere, WholeGround};
use crate::criterion::Criterion;
use crate::criterion::spheres::Spheres;
use crate::culling::{NO_DATA, PatchHeights, drawn_range, joined};
use crate::edit::{Mended, mend_exact, mend_midpoint, mend_spheres};
use crate::errors::ErrorMap;
use crate::errors::exact::own_errors;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::levels::VertexRect;
use crate::patched_ground::PatchedGround;
use crate::roughness::Roughness;
use crate::sphere_task::{SphereTask, TaskGround};
use crate::spheres::{OwnRadius, SphereMap};
use sandtable_earthworks::brush::{BrushChanges, Change};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::volumes::Volumes;

/// The measure of a vertex's error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorMeasure {
    /// The midpoint error of the papers.
    Midpoint,
    /// The exact error: a bound.
    Exact,
}

/// A vertex's own radius; see [`OwnRadius`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Radius {
    /// [`OwnRadius::Plain`].
    Plain,
    /// [`OwnRadius::Constrained`] by the roughness of windows that reach this many posts east and north.
    Constrained((u32, u32)),
    /// [`OwnRadius::Bounding`], a bound where the errors are exact.
    Bounding,
}

/// The measures of a dynamic terrain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicOptions {
    /// Cells along a patch's side, a power of two from 2 to 4096.
    pub patch: u32,
    /// The errors.
    pub measure: ErrorMeasure,
    /// The spheres.
    pub radius: Radius,
    /// Meters of distance per meter of error; see [`OwnRadius`].
    pub reach: f32,
}

/// A terrain that can be edited.
#[derive(Clone, Debug)]
pub struct DynamicTerrain {
    options: DynamicOptions,
    lattice: Arc<Lattice>,
    layout: PatchLayout,
    errors: Arc<ErrorMap>,
    /// The exact errors of the vertices alone; empty for midpoint errors.
    own: Vec<f32>,
    roughness: Option<Arc<Roughness>>,
    spheres: SphereMap,
    heights: PatchHeights,
    edits: u64,
    /// One a patch, false between edits.
    dirty: Vec<bool>,
}

/// The effects of an edit.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// The number of the edit, counted from 1.
    pub number: u64,
    /// The south-west corners of the dirty patches, in the layout's order. A patch is dirty where one of its vertices,
    /// borders included, has a new height, error or radius.
    pub patches: Vec<Vertex>,
    /// The vertices with a new height, error or radius, some twice: first those with a new height or radius.
    pub vertices: Vec<Vertex>,
    /// How many of the vertices have a new height or radius; the others have a new error alone.
    pub placed: usize,
    /// The earth moved.
    pub volumes: Volumes,
}

impl BlockSource for DynamicTerrain {
    fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    fn root(&self, corner: Vertex) -> RootSphere {
        self.source().root(corner)
    }

    fn corners(&self, corner: Vertex) -> [Vec3; 4] {
        self.source().corners(corner)
    }

    fn block(&mut self, corner: Vertex) -> Result<Arc<PatchBlock>, BlockError> {
        self.source().block(corner)
    }
}

impl DynamicTerrain {
    /// The terrain over `lattice`; `None` where patches cannot be laid over it (see [`PatchLayout::new`]).
    pub fn new(lattice: impl Into<Arc<Lattice>>, options: DynamicOptions) -> Option<Self> {
        let lattice: Arc<Lattice> = lattice.into();
        let layout = PatchLayout::new(lattice.columns(), lattice.rows(), options.patch)?;
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let (own, errors) = match options.measure {
            ErrorMeasure::Midpoint => (Vec::new(), ErrorMap::midpoint(&lattice, &layout)),
            ErrorMeasure::Exact => {
                let own = own_errors(&lattice, &layout);
                (own.clone(), ErrorMap::raised(own, &layout))
            }
        };
        let roughness = match options.radius {
            Radius::Constrained(half_window) => Some(Arc::new(Roughness::new(&lattice, half_window))),
            _ => None,
        };
        let spheres = SphereMap::new(ground, &own_radius(&options, &errors, roughness.as_deref()));
        let (heights, errors) = (PatchHeights::new(ground), Arc::new(errors));
        let dirty = vec![false; layout.patch_count()];
        Some(Self { options, lattice, layout, errors, own, roughness, spheres, heights, edits: 0, dirty })
    }

    /// The current heights; a snapshot while it is held.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    fn source(&self) -> WholeGround<'_> {
        WholeGround { ground: self.ground(), spheres: &self.spheres }
    }

    /// The current ground.
    pub fn ground(&self) -> PatchedGround<'_> {
        PatchedGround { lattice: &self.lattice, layout: &self.layout }
    }

    /// The errors.
    pub fn errors(&self) -> &ErrorMap {
        &self.errors
    }

    /// The spheres.
    pub fn spheres(&self) -> &SphereMap {
        &self.spheres
    }

    /// The lowest and highest Z of each patch.
    pub fn heights(&self) -> &PatchHeights {
        &self.heights
    }

    /// Meters of distance per meter of error.
    pub fn reach(&self) -> f32 {
        self.options.reach
    }

    /// The task of recomputing the spheres for another reach.
    pub fn sphere_task(&self, reach: f32) -> SphereTask {
        SphereTask {
            options: DynamicOptions { reach, ..self.options },
            lattice: Arc::clone(&self.lattice),
            layout: self.layout,
            errors: Arc::clone(&self.errors),
            roughness: self.roughness.clone(),
            edits: self.edits,
        }
    }

    /// Exchanges the spheres with those that a task has made, unless the terrain was edited since; returns whether it did. A
    /// mesh of the terrain must then be that of the task's ground, or begin anew.
    pub fn exchange_spheres(&mut self, made: &mut TaskGround) -> bool {
        let is_current = made.task.edits == self.edits;
        if is_current {
            std::mem::swap(&mut self.options.reach, &mut made.task.options.reach);
            std::mem::swap(&mut self.spheres, &mut made.spheres);
        }
        is_current
    }

    /// The number of edits that changed something.
    pub fn edits(&self) -> u64 {
        self.edits
    }

    /// Lets `brush` change the heights, and updates what is computed from them. `brush` must return all its changes in the
    /// order in which it made them, and may not pin posts. `None` where it changed nothing.
    pub fn edit(&mut self, brush: impl FnOnce(&mut Lattice) -> BrushChanges) -> Option<Edit> {
        let changes = brush(Arc::make_mut(&mut self.lattice));
        if changes.pieces.is_empty() {
            return None;
        }
        self.edits += 1;
        let posts = changes.pieces.iter().map(|change| change.before.len()).sum::<usize>();
        let (mut vertices, mut erring) = (Vec::with_capacity(2 * posts), Vec::new());
        for change in &changes.pieces {
            self.renew_heights(change);
            let moved = self.add_moved(change, &mut vertices);
            let [errors, spheres] = self.mend(change);
            vertices.extend(spheres.vertices.into_iter().filter(|&vertex| !moved.holds(vertex)));
            erring.extend(errors.vertices.into_iter().filter(|&vertex| !moved.holds(vertex)));
        }
        let placed = vertices.len();
        vertices.append(&mut erring);
        let patches = self.patches_of(&vertices);
        Some(Edit { number: self.edits, patches, vertices, placed, volumes: changes.volumes })
    }

    /// Updates errors and spheres for one piece; returns the vertices whose error and those whose radius changed.
    fn mend(&mut self, change: &Change) -> [Mended; 2] {
        let (lattice, layout) = (&*self.lattice, &self.layout);
        let errors = match self.options.measure {
            ErrorMeasure::Midpoint => mend_midpoint(Arc::make_mut(&mut self.errors), lattice, layout, change),
            ErrorMeasure::Exact => {
                mend_exact(&mut self.own, Arc::make_mut(&mut self.errors), lattice, layout, change)
            }
        };
        if let Some(roughness) = &mut self.roughness {
            Arc::make_mut(roughness).renew(lattice, &change.posts);
        }
        let ground = PatchedGround { lattice, layout };
        let own = own_radius(&self.options, &self.errors, self.roughness.as_deref());
        let spheres = mend_spheres(&mut self.spheres, ground, &own, change, &errors);
        [errors, spheres]
    }

    /// Adds the vertices whose height changed to `vertices`, and returns them.
    fn add_moved(&self, change: &Change, vertices: &mut Vec<Vertex>) -> MovedVertices {
        let rect = VertexRect::from_posts(&self.layout, &change.posts);
        let (first, last) = (change.posts.first, change.posts.last);
        let width = (rect.max.x - rect.min.x + 1) as usize;
        let mut are_moved = Vec::with_capacity(width * (rect.max.y - rect.min.y + 1) as usize);
        for y in rect.min.y..=rect.max.y {
            let row = self.layout.post(Vertex::new(rect.min.x, y)).row;
            let [before, now] = change.row(&self.lattice, row, (first.column, last.column));
            let start = are_moved.len();
            are_moved.extend(before.iter().zip(now).map(|(before, now)| before.to_bits() != now.to_bits()));
            // Vertices beyond the east border have the last post's height.
            are_moved.resize(start + width, are_moved[are_moved.len() - 1]);
            let columns = (rect.min.x..).zip(&are_moved[start..]);
            vertices.extend(columns.filter(|&(_, &moved)| moved).map(|(x, _)| Vertex::new(x, y)));
        }
        MovedVertices { corner: rect.min, width, are_moved }
    }

    /// Updates the ranges of the patches that `change` touches: widened by the new heights, or measured again where the
    /// lowest or the highest may have been removed.
    fn renew_heights(&mut self, change: &Change) {
        let rect = VertexRect::from_posts(&self.layout, &change.posts);
        let (first, last) = (change.posts.first, change.posts.last);
        for corner in self.layout.patches_meeting(rect.min, rect.max) {
            let far = corner.moved(self.layout.patch(), self.layout.patch());
            let (low, high) = (self.layout.post(corner), self.layout.post(far));
            let columns = (low.column.max(first.column), high.column.min(last.column));
            let rows = low.row.max(first.row)..=high.row.min(last.row);
            let joint = rows.map(|row| change.row(&self.lattice, row, columns).map(drawn_range));
            let [old, new] = joint.fold([NO_DATA; 2], |[a, b], [c, d]| [joined(a, c), joined(b, d)]);
            let range = self.heights.range(corner);
            if old.0 > range.0 && old.1 < range.1 {
                self.heights.widen(corner, new);
            } else {
                let ground = PatchedGround { lattice: &self.lattice, layout: &self.layout };
                self.heights.renew(ground, corner);
            }
        }
    }

    /// The corners of the patches that the vertices belong to, in the layout's order.
    fn patches_of(&mut self, vertices: &[Vertex]) -> Vec<Vertex> {
        let (layout, mut dirty) = (self.layout, Vec::new());
        for (span, _) in layout.runs(vertices) {
            for corner in layout.patches_within(span.first, span.last) {
                if !std::mem::replace(&mut self.dirty[layout.patch_index(corner)], true) {
                    dirty.push(corner);
                }
            }
        }
        dirty.sort_unstable_by_key(|&corner| layout.patch_index(corner));
        dirty.iter().for_each(|&corner| self.dirty[layout.patch_index(corner)] = false);
        dirty
    }
}

/// Which vertices of a rectangle an edit has moved.
struct MovedVertices {
    /// The south-west corner of the rectangle.
    corner: Vertex,
    /// Vertices in a row.
    width: usize,
    /// Row by row.
    are_moved: Vec<bool>,
}

impl MovedVertices {
    #[inline]
    fn holds(&self, vertex: Vertex) -> bool {
        // A vertex west or south of the corner is far east or north of it.
        let [x, y] = [vertex.x - self.corner.x, vertex.y - self.corner.y].map(|off| off as u32 as usize);
        x < self.width && self.are_moved.get(y * self.width + x).is_some_and(|&moved| moved)
    }
}

pub(super) fn own_radius<'a>(
    options: &DynamicOptions,
    errors: &'a ErrorMap,
    roughness: Option<&'a Roughness>,
) -> OwnRadius<'a> {
    let reach = options.reach;
    match (options.radius, roughness) {
        (Radius::Constrained(_), Some(roughness)) => OwnRadius::Constrained { reach, roughness },
        (Radius::Bounding, _) => OwnRadius::Bounding { errors, reach },
        _ => OwnRadius::Plain { errors, reach },
    }
}

/// Updates the bits of a mesh of all patches by `criterion` after `edit`, for the same eye: only vertices with a new height
/// or radius can have changed sides. The criterion must read the updated spheres, whose nesting keeps the bits closed under
/// parents.
pub fn mend_active(active: &mut ActiveSet, criterion: &Spheres<'_>, edit: &Edit) {
    let layout = *active.layout();
    for &vertex in edit.vertices[..edit.placed].iter().filter(|&&vertex| !layout.is_corner(vertex)) {
        if criterion.wants(vertex) {
            active.activate(vertex);
        } else {
            active.deactivate(vertex);
        }
    }
}

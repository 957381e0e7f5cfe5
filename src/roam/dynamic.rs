//! A terrain whose heights change while it is shown (003's dynamic terrain: craters, tire tracks).
//!
//! Whatever is computed from the heights is mended after each edit by what the edit changed, and equals, bit for
//! bit, what would be made from the new heights from scratch. An edit tells which patches are dirty, so that
//! whatever lies on the ground or was sent from it is renewed there and nowhere else.
//!
//! A terrain is a source of patches, so that a walk can own it: edit the walk's source, and tell the walk which
//! patches are dirty.
//!
//! The heights are shared: who holds an epoch of them keeps it whole, since an edit then changes a copy. Where nobody
//! does, an edit copies nothing.

use std::sync::Arc;

use crate::earthworks::brush::{BrushChanges, Change};
use crate::roam::active::ActiveSet;
use crate::roam::block::{BlockError, BlockSource, PatchBlock, RootSphere, WholeGround};
use crate::roam::criterion::Criterion;
use crate::roam::criterion::spheres::Spheres;
use crate::roam::culling::{NO_DATA, PatchHeights, drawn_range, joined};
use crate::roam::edit::{Mended, mend_exact, mend_midpoint, mend_spheres};
use crate::roam::errors::ErrorMap;
use crate::roam::errors::exact::own_errors;
use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;
use crate::roam::levels::VertexRect;
use crate::roam::patched_ground::PatchedGround;
use crate::roam::roughness::Roughness;
use crate::roam::spheres::{OwnRadius, SphereMap};
use crate::terrain::lattice::Lattice;
use crate::terrain::volumes::Volumes;

/// What the error of a vertex measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorMeasure {
    /// The midpoint error of the papers.
    Midpoint,
    /// The exact error: a bound.
    Exact,
}

/// What a vertex's own radius is; see [`OwnRadius`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Radius {
    /// [`OwnRadius::Plain`].
    Plain,
    /// [`OwnRadius::Constrained`] by the roughness of windows that reach so many posts east and north.
    Constrained((u32, u32)),
    /// [`OwnRadius::Bounding`], a bound where the errors are exact.
    Bounding,
}

/// How a dynamic terrain is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicOptions {
    /// Cells along a patch's side, a power of two from 2 to 4096.
    pub patch: u32,
    /// The errors.
    pub measure: ErrorMeasure,
    /// The spheres.
    pub radius: Radius,
    /// Meters of distance per meter of drawn error; see [`OwnRadius`].
    pub reach: f32,
}

/// A terrain that can be edited.
#[derive(Clone, Debug)]
pub struct DynamicTerrain {
    options: DynamicOptions,
    lattice: Arc<Lattice>,
    layout: PatchLayout,
    errors: ErrorMap,
    /// The exact errors of the vertices alone; empty for midpoint errors, which are measured in passing.
    own: Vec<f32>,
    roughness: Option<Roughness>,
    spheres: SphereMap,
    heights: PatchHeights,
    epoch: u64,
    /// One a patch, false between edits.
    dirty: Vec<bool>,
}

/// What an edit did.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// The number of the epoch it began, counted from 1.
    pub epoch: u64,
    /// The south-west corners of the dirty patches, in the layout's order. A patch is dirty where one of its vertices,
    /// its borders included, stands for a post whose height changed, or changed its error or its radius.
    pub patches: Vec<Vertex>,
    /// The vertices whose place, error or radius changed; one may be named for each of the three.
    pub vertices: Vec<Vertex>,
    /// The earth moved.
    pub volumes: Volumes,
}

impl BlockSource for DynamicTerrain {
    fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    fn root(&self, corner: Vertex) -> RootSphere {
        self.whole().root(corner)
    }

    fn block(&mut self, corner: Vertex) -> Result<Arc<PatchBlock>, BlockError> {
        self.whole().block(corner)
    }
}

impl DynamicTerrain {
    /// The terrain over `lattice`; `None` where patches cannot be laid over it (see [`PatchLayout::new`]).
    pub fn new(lattice: Lattice, options: DynamicOptions) -> Option<Self> {
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
            Radius::Constrained(half_window) => Some(Roughness::new(&lattice, half_window)),
            _ => None,
        };
        let spheres = SphereMap::of(ground, &own_radius(&options, &errors, roughness.as_ref()));
        let heights = PatchHeights::new(ground);
        let lattice = Arc::new(lattice);
        let dirty = vec![false; layout.patch_count()];
        Some(Self { options, lattice, layout, errors, own, roughness, spheres, heights, epoch: 0, dirty })
    }

    /// The heights as they are now; whoever keeps this keeps the epoch.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    fn whole(&self) -> WholeGround<'_> {
        WholeGround { ground: self.ground(), spheres: &self.spheres }
    }

    /// The ground of this epoch.
    pub fn ground(&self) -> PatchedGround<'_> {
        PatchedGround { lattice: &self.lattice, layout: &self.layout }
    }

    /// The patches.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// The errors.
    pub fn errors(&self) -> &ErrorMap {
        &self.errors
    }

    /// The spheres.
    pub fn spheres(&self) -> &SphereMap {
        &self.spheres
    }

    /// How low and high each patch is drawn.
    pub fn heights(&self) -> &PatchHeights {
        &self.heights
    }

    /// How many edits have changed something.
    pub fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Lets `brush` change the heights and mends what is computed from them. What it returns must hold everything that
    /// it changed, in the order it was done, and it may not pin posts. `None` where it changed nothing.
    pub fn edit(&mut self, brush: impl FnOnce(&mut Lattice) -> BrushChanges) -> Option<Edit> {
        let changes = brush(Arc::make_mut(&mut self.lattice));
        if changes.pieces.is_empty() {
            return None;
        }
        self.epoch += 1;
        let mut vertices =
            Vec::with_capacity(4 * changes.pieces.iter().map(|change| change.before.len()).sum::<usize>());
        for change in &changes.pieces {
            self.renew_heights(change);
            self.add_moved(change, &mut vertices);
            self.mend(change, &mut vertices);
        }
        let patches = self.patches_of(&vertices);
        Some(Edit { epoch: self.epoch, patches, vertices, volumes: changes.volumes })
    }

    /// Mends everything for one piece and adds the vertices whose error or radius changed to `vertices`.
    fn mend(&mut self, change: &Change, vertices: &mut Vec<Vertex>) {
        let (lattice, layout) = (&*self.lattice, &self.layout);
        let errors = match self.options.measure {
            ErrorMeasure::Midpoint => mend_midpoint(&mut self.errors, lattice, layout, change),
            ErrorMeasure::Exact => mend_exact(&mut self.own, &mut self.errors, lattice, layout, change),
        };
        if let Some(roughness) = &mut self.roughness {
            roughness.renew(lattice, &change.posts);
        }
        let ground = PatchedGround { lattice, layout };
        let own = own_radius(&self.options, &self.errors, self.roughness.as_ref());
        let spheres: Mended = mend_spheres(&mut self.spheres, ground, &own, change, &errors);
        vertices.extend_from_slice(&errors.vertices);
        vertices.extend_from_slice(&spheres.vertices);
    }

    /// Adds the vertices that stand for posts whose height changed to `vertices`.
    fn add_moved(&self, change: &Change, vertices: &mut Vec<Vertex>) {
        let rect = VertexRect::of_posts(&self.layout, &change.posts);
        let (first, last) = (change.posts.first, change.posts.last);
        for y in rect.min.y..=rect.max.y {
            let row = self.layout.post(Vertex::new(rect.min.x, y)).row;
            let [before, now] = change.row(&self.lattice, row, (first.column, last.column));
            let is_moved = |at: usize| before[at].to_bits() != now[at].to_bits();
            let inside =
                (0..now.len()).filter(|&at| is_moved(at)).map(|at| Vertex::new(rect.min.x + at as i32, y));
            vertices.extend(inside);
            if is_moved(now.len() - 1) {
                vertices.extend((last.column as i32 + 1..=rect.max.x).map(|x| Vertex::new(x, y)));
            }
        }
    }

    /// Mends the ranges of the patches that `change` touches: widened by what is new, measured again where the
    /// lowest or the highest may have gone away.
    fn renew_heights(&mut self, change: &Change) {
        let rect = VertexRect::of_posts(&self.layout, &change.posts);
        let (first, last) = (change.posts.first, change.posts.last);
        for corner in patches_meeting(&self.layout, rect) {
            let index = self.layout.patch_index(corner);
            let far = corner.moved(self.layout.patch(), self.layout.patch());
            let (low, high) = (self.layout.post(corner), self.layout.post(far));
            let columns = (low.column.max(first.column), high.column.min(last.column));
            let rows = low.row.max(first.row)..=high.row.min(last.row);
            let joint = rows.map(|row| change.row(&self.lattice, row, columns).map(drawn_range));
            let [old, new] = joint.fold([NO_DATA; 2], |[a, b], [c, d]| [joined(a, c), joined(b, d)]);
            let range = self.heights.range(index);
            if old.0 > range.0 && old.1 < range.1 {
                self.heights.widen(index, new);
            } else {
                let ground = PatchedGround { lattice: &self.lattice, layout: &self.layout };
                self.heights.renew(ground, corner);
            }
        }
    }

    /// The corners of the patches that the vertices belong to, in the layout's order.
    fn patches_of(&mut self, vertices: &[Vertex]) -> Vec<Vertex> {
        let (shift, inner) = (self.layout.patch().trailing_zeros(), self.layout.patch() - 1);
        let (mut dirty, mut last) = (Vec::new(), (-1, -1));
        for &vertex in vertices {
            let own = (vertex.x >> shift, vertex.y >> shift);
            if own == last && vertex.x & inner != 0 && vertex.y & inner != 0 {
                continue;
            }
            last = own;
            let (before, after) = (vertex.moved(-1, -1), vertex);
            for y in before.y.max(0) >> shift..=after.y >> shift {
                for x in before.x.max(0) >> shift..=after.x >> shift {
                    dirty.extend(self.layout.patches_within((x, y), (x, y)).filter(|&corner| {
                        !std::mem::replace(&mut self.dirty[self.layout.patch_index(corner)], true)
                    }));
                }
            }
        }
        dirty.sort_unstable_by_key(|&corner| self.layout.patch_index(corner));
        dirty.iter().for_each(|&corner| self.dirty[self.layout.patch_index(corner)] = false);
        dirty
    }
}

/// The patches that share a vertex with the rectangle, which is not empty.
fn patches_meeting(layout: &PatchLayout, rect: VertexRect) -> impl Iterator<Item = Vertex> + use<> {
    let patch = layout.patch();
    let before = |at: i32| (at - 1).max(0) / patch;
    layout.patches_within((before(rect.min.x), before(rect.min.y)), (rect.max.x / patch, rect.max.y / patch))
}

fn own_radius<'a>(
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

/// Brings the bits of a mesh made by `criterion` over all patches up to date after `edit`, for the same eye: only
/// vertices whose place or sphere changed can have changed sides. The criterion must read the mended spheres; their
/// nesting keeps the bits closed under parents.
pub fn mend_active(active: &mut ActiveSet, criterion: &Spheres<'_>, edit: &Edit) {
    let layout = *active.layout();
    for &vertex in edit.vertices.iter().filter(|&&vertex| !layout.is_corner(vertex)) {
        if criterion.wants(vertex) {
            active.activate(vertex);
        } else {
            active.deactivate(vertex);
        }
    }
}

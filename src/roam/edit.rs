//! Updates of errors and spheres after heights changed inside a rectangle of posts (dynamic terrain, Yu and Zhang).
//!
//! Only what can have changed is computed again: pass by pass from the finest vertices up, the vertices whose own measure
//! reads a changed post and the parents of vertices that changed; where a value stays the same, the update ends. The changes
//! of a pass are kept as a rectangle, whose parents the next pass sweeps: the vertices near an edit are dense, so a list or
//! a set would cost more than the few vertices swept in vain.
//!
//! The result equals, bit for bit, one computed from the new heights. Where an edit has several rectangles, all heights are
//! changed first and the updates follow one by one.

use crate::errors::ErrorMap;
use crate::errors::exact::{own_error, triangles_split_at};
use crate::errors::midpoint::torn_off;
use crate::errors::plane::PostPlane;
use crate::field::HeightField;
use crate::graph::{Vertex, VertexKind};
use crate::layout::PatchLayout;
use crate::levels::{LevelPass, PassRow, VertexRect, passes};
use crate::patched_ground::PatchedGround;
use crate::spheres::{OwnRadius, SphereMap};
use sandtable_earthworks::brush::Change;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// The vertices whose value changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mended {
    /// Each once, the finest first.
    pub vertices: Vec<Vertex>,
    /// The rectangle around those of each pass, in the order of [`passes`]; the other passes have none.
    rects: Vec<VertexRect>,
}

/// The most passes of a layout: three a step, of 4096 cells.
const PASSES: usize = 3 * 12;

impl Mended {
    /// No vertex yet, with capacity for those of a change.
    fn with_capacity_for(change: &Change) -> Self {
        Self { vertices: Vec::with_capacity(change.before.len() * 3 / 2), rects: Vec::with_capacity(PASSES) }
    }

    /// The rectangle around the changed vertices of a pass by its place in [`passes`].
    fn rect(&self, pass: usize) -> VertexRect {
        self.rects.get(pass).copied().unwrap_or(VertexRect::EMPTY)
    }

    /// Calls `renew` for the rows of the pass inside `rect`; `renew` adds the vertices that changed, from the west.
    fn sweep(
        &mut self,
        layout: &PatchLayout,
        pass: LevelPass,
        rect: VertexRect,
        mut renew: impl FnMut(PassRow, &mut Vec<Vertex>),
    ) {
        let mut around = VertexRect::EMPTY;
        if !rect.is_empty() {
            for row in pass.rows_within(layout, &rect) {
                let before = self.vertices.len();
                renew(row, &mut self.vertices);
                if let (Some(&west), Some(&east)) = (self.vertices.get(before), self.vertices.last()) {
                    around = around.with(west).with(east);
                }
            }
        }
        self.rects.push(around);
    }

    /// The rectangle around the parents, in `pass`, of the changed vertices; `pass` is the next to be swept.
    fn above(&self, pass: LevelPass) -> VertexRect {
        let (done, step) = (self.rects.len(), pass.step);
        match pass.kind {
            _ if pass.child_reach() == 0 => VertexRect::EMPTY,
            VertexKind::Center => {
                self.rect(done - 2).grown(0, step).union(self.rect(done - 1).grown(step, 0))
            }
            // The centers of half the step are the last pass before the edges of this one.
            VertexKind::EastEdge => self.rect(done - 1).grown(step / 2, step / 2),
            VertexKind::NorthEdge => self.rect(done - 2).grown(step / 2, step / 2),
        }
    }

    /// Whether nothing that a later pass can read has changed.
    fn has_ended(&self, pass: LevelPass) -> bool {
        pass.kind == VertexKind::EastEdge && self.rects.last().is_none_or(VertexRect::is_empty)
    }
}

/// Reads a value of every cache line of a rectangle. The rows of a large terrain lie far apart, and working on them one by
/// one waits for each; these reads do not depend on each other, so the memory serves them together.
fn prefetch(values: &[f32], layout: &PatchLayout, rect: VertexRect) {
    /// Posts in a cache line.
    const LINE: usize = 16;
    let inside =
        |low: i32, high: i32, count: usize| (low.max(0) as usize, (high.max(0) as usize).min(count - 1));
    let (west, east) = inside(rect.min.x, rect.max.x, layout.columns());
    let (south, north) = inside(rect.min.y, rect.max.y, layout.rows());
    let row = |y: usize| values.get(y * layout.columns() + west..=y * layout.columns() + east).unwrap_or(&[]);
    let bits =
        |row: &[f32]| row.iter().step_by(LINE).chain(row.last()).fold(0, |all, one| all ^ one.to_bits());
    std::hint::black_box((south..=north).fold(0, |all, y| all ^ bits(row(y))));
}

/// Updates midpoint errors after `change`; `lattice` holds the new heights.
pub fn mend_midpoint(
    errors: &mut ErrorMap,
    lattice: &Lattice,
    layout: &PatchLayout,
    change: &Change,
) -> Mended {
    let changed = VertexRect::from_posts(layout, &change.posts);
    let field = HeightField::new(PatchedGround { lattice, layout });
    prefetch(errors.values(), layout, changed.grown(1, 1));
    let mut mended = Mended::with_capacity_for(change);
    for pass in passes(layout) {
        let posts = changed.snapped(pass.step);
        if posts.is_empty() && mended.has_ended(pass) {
            break;
        }
        let rect = pass.reading(posts).union(mended.above(pass));
        mended
            .sweep(layout, pass, rect, |row, changed| renew_midpoints(errors, layout, &field, row, changed));
    }
    mended
}

/// Renews a row of midpoint errors; adds the vertices whose error changed to `changed`.
fn renew_midpoints(
    errors: &mut ErrorMap,
    layout: &PatchLayout,
    field: &HeightField<'_>,
    row: PassRow,
    changed: &mut Vec<Vertex>,
) {
    let (step, here) = (row.pass.step as usize, field.row(row.y));
    if row.pass.kind == VertexKind::EastEdge {
        let own = |x: usize| torn_off(here.height(x - step), here.height(x + step), here.height(x));
        errors.renew_row(layout, row, own, changed);
        return;
    }
    let (south, north) = (field.row(row.y - step), field.row(row.y + step));
    if row.pass.kind == VertexKind::NorthEdge {
        let own = |x: usize| torn_off(south.height(x), north.height(x), here.height(x));
        errors.renew_row(layout, row, own, changed);
    } else {
        let own = |x: usize| {
            let (from, to) =
                if row.pass.rises(x, row.y) { (x - step, x + step) } else { (x + step, x - step) };
            torn_off(south.height(from), north.height(to), here.height(x))
        };
        errors.renew_row(layout, row, own, changed);
    }
}

/// Updates exact errors after `change`, and `own`, the errors of the vertices alone that they were raised from, in the order
/// of [`PatchLayout::index`]; `lattice` holds the new heights.
///
/// The error of a large triangle reads every post it covers. It is not scanned again where its corners are unchanged and no
/// changed post was or is as far off its plane as the worst.
///
/// # Panics
/// Unless there is one own error a vertex.
pub fn mend_exact(
    own: &mut [f32],
    errors: &mut ErrorMap,
    lattice: &Lattice,
    layout: &PatchLayout,
    change: &Change,
) -> Mended {
    assert_eq!(own.len(), layout.vertex_count(), "one own error a vertex");
    let changed = VertexRect::from_posts(layout, &change.posts);
    let mut mended = Mended::with_capacity_for(change);
    for pass in passes(layout) {
        let rect = changed.grown(pass.step, pass.step).union(mended.above(pass));
        mended.sweep(layout, pass, rect, |row, changed| {
            let measure = |x: usize| {
                let vertex = Vertex::new(x as i32, row.y as i32);
                let slot = &mut own[layout.index(vertex)];
                if pass.step <= SCANNED || !is_unchanged(lattice, layout, vertex, *slot, change) {
                    *slot = own_error(lattice, layout, vertex);
                }
                *slot
            };
            errors.renew_row(layout, row, measure, changed);
        });
    }
    mended
}

/// Triangles at vertices up to this step are always scanned again: they hold no more posts than a comparison of the changed
/// ones would read.
const SCANNED: i32 = 4;

/// Errors of large triangles are measured in f32: each is off by at most this share of the relief. Several times the actual
/// rounding, and still too little to save a scan.
const ROUNDING: f64 = 4e-6;

/// Whether the error of `vertex` alone, `own` before, is certainly unchanged: its triangles' corners are, none of the
/// changed posts they cover is pinned, and all were and are clearly less far off than the worst.
fn is_unchanged(lattice: &Lattice, layout: &PatchLayout, vertex: Vertex, own: f32, change: &Change) -> bool {
    own.is_finite()
        && triangles_split_at(layout, vertex).into_iter().flatten().all(|triangle| {
            let corners = triangle.corners().map(|corner| layout.post(corner));
            if corners.iter().any(|&corner| has_moved(lattice, change, corner)) {
                return false;
            }
            let Some(plane) = PostPlane::new(lattice, corners) else { return true };
            let clearly_less = f64::from(own) - ROUNDING * (f64::from(own) + relief(lattice, corners));
            covered(corners, change).all(|post| {
                let (before, after) = (change.height_before(post), lattice.height(post));
                let off = |height: f32| (f64::from(height) - plane.height(post)).abs();
                let is_less = off(before).max(off(after)) < clearly_less;
                after.to_bits() == before.to_bits() || (is_less && !lattice.is_pinned(post))
            })
        })
}

/// The difference of the highest and the lowest of three posts, meters.
fn relief(lattice: &Lattice, posts: [Post; 3]) -> f64 {
    let [a, b, c] = posts.map(|post| f64::from(lattice.height(post)));
    a.max(b).max(c) - a.min(b).min(c)
}

fn has_moved(lattice: &Lattice, change: &Change, post: Post) -> bool {
    change.posts.contains(post) && change.height_before(post).to_bits() != lattice.height(post).to_bits()
}

/// The changed posts in the bounding box of a triangle of posts: at least those it covers.
fn covered([a, b, c]: [Post; 3], change: &Change) -> impl Iterator<Item = Post> {
    let bounds = PostRect { first: a, last: a }.with(b).with(c);
    let (first, last) = (change.posts.first, change.posts.last);
    let columns = first.column.max(bounds.first.column)..=last.column.min(bounds.last.column);
    let rows = first.row.max(bounds.first.row)..=last.row.min(bounds.last.row);
    rows.flat_map(move |row| columns.clone().map(move |column| Post { column, row }))
}

/// Updates nested spheres after `change`, once the errors are updated, with `errors` the result. `own` reads the new values.
pub fn mend_spheres(
    spheres: &mut SphereMap,
    ground: PatchedGround<'_>,
    own: &OwnRadius<'_>,
    change: &Change,
    errors: &Mended,
) -> Mended {
    let changed = VertexRect::from_posts(ground.layout, &change.posts);
    let window = change.posts.grown(own.half_window(), ground.lattice);
    let rough = VertexRect::from_posts(ground.layout, &window);
    let field = HeightField::new(ground);
    prefetch(spheres.values(), ground.layout, changed.grown(1, 1));
    let last_error = errors.rects.iter().rposition(|rect| !rect.is_empty());
    let (mut mended, mut held) = (Mended::with_capacity_for(change), Vec::new());
    for (index, pass) in passes(ground.layout).enumerate() {
        let half = (pass.step / 2).max(1);
        let (moved, near) = (changed.snapped(half), rough.snapped(pass.step));
        let errors_ended = last_error.is_none_or(|last| index > last);
        if moved.is_empty() && near.is_empty() && errors_ended && mended.has_ended(pass) {
            break;
        }
        let has_children = pass.kind != VertexKind::Center && pass.step > 1;
        let children = if has_children { moved.grown(half, half) } else { VertexRect::EMPTY };
        let corners = changed.snapped(pass.step).grown(pass.step, pass.step);
        let rect = corners.union(children).union(near).union(errors.rect(index)).union(mended.above(pass));
        mended.sweep(ground.layout, pass, rect, |row, changed| {
            spheres.renew_row(ground, &field, row, own, &mut held, changed);
        });
    }
    mended
}

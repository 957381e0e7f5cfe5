//! Mending errors and spheres after heights changed inside a rectangle of posts (003's dynamic terrain).
//!
//! Only what can have changed is computed again: pass by pass from the finest vertices up, the vertices whose own
//! measure reads a changed post and the parents of vertices that changed; where a value stays the same, the walk
//! ends. What was changed in a pass is kept as a rectangle, whose parents the next pass sweeps: the vertices near an
//! edit are dense, so that a list or a set of them costs more than the few that are looked at in vain.
//!
//! The result equals, bit for bit, one made anew from the heights as they are now. Where an edit comes in several
//! rectangles, all heights are changed first and each rectangle is then mended in turn.

use crate::earthworks::brush::Change;
use crate::roam::errors::ErrorMap;
use crate::roam::errors::exact::{own_error, triangles_split_at};
use crate::roam::errors::midpoint::torn_off;
use crate::roam::errors::plane::PostPlane;
use crate::roam::field::HeightField;
use crate::roam::graph::{Vertex, VertexKind};
use crate::roam::layout::PatchLayout;
use crate::roam::levels::{LevelPass, PassRow, VertexRect, passes};
use crate::roam::patched_ground::PatchedGround;
use crate::roam::spheres::{OwnRadius, SphereMap};
use crate::terrain::lattice::{Lattice, Post};

/// The vertices whose value changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mended {
    /// Each once, the finest first.
    pub vertices: Vec<Vertex>,
    /// The rectangle around those of each pass, in the order of [`passes`]; the rest is empty.
    rects: Vec<VertexRect>,
}

/// The most passes of a layout: three a step, of 4096 cells.
const PASSES: usize = 3 * 12;

impl Mended {
    /// Nothing yet, with room for what a change brings about.
    fn around(change: &Change) -> Self {
        Self { vertices: Vec::with_capacity(change.before.len() * 3 / 2), rects: Vec::with_capacity(PASSES) }
    }

    /// The rectangle around the changed vertices of a pass by its place in [`passes`].
    fn rect(&self, pass: usize) -> VertexRect {
        self.rects.get(pass).copied().unwrap_or(VertexRect::EMPTY)
    }

    /// Sweeps the pass: the rows of the vertices of `rect`, of which `renew` adds those that changed.
    fn sweep(
        &mut self,
        layout: &PatchLayout,
        pass: LevelPass,
        rect: VertexRect,
        mut renew: impl FnMut(PassRow, &mut Vec<Vertex>),
    ) {
        let before = self.vertices.len();
        if !rect.is_empty() {
            pass.rows_within(layout, &rect).for_each(|row| renew(row, &mut self.vertices));
        }
        let changed = self.vertices[before..].iter();
        self.rects.push(changed.fold(VertexRect::EMPTY, |rect, &vertex| rect.with(vertex)));
    }

    /// The rectangle around the parents, in `pass`, of what changed so far; `pass` is the next to be swept.
    fn above(&self, pass: LevelPass) -> VertexRect {
        let (done, step) = (self.rects.len(), pass.step);
        match pass.kind {
            _ if step == 1 && pass.kind != VertexKind::Center => VertexRect::EMPTY,
            VertexKind::Center => {
                self.rect(done - 2).grown(0, step).union(self.rect(done - 1).grown(step, 0))
            }
            // The centers of half the step are the last pass before the edges of this one.
            VertexKind::EastEdge => self.rect(done - 1).grown(step / 2, step / 2),
            VertexKind::NorthEdge => self.rect(done - 2).grown(step / 2, step / 2),
        }
    }

    /// Whether nothing that a pass still to come can read has changed.
    fn has_ended(&self, pass: LevelPass) -> bool {
        pass.kind == VertexKind::EastEdge && self.rects.last().is_none_or(VertexRect::is_empty)
    }
}

/// Posts between two that are fetched: what one line of a cache holds.
const LINE: usize = 16;

/// Reads a value of every cache line of a rectangle. Rows of a big terrain lie far apart, and whoever works on them one
/// after the other waits for each; these reads wait for nothing, so the memory answers them together.
fn fetch(values: &[f32], layout: &PatchLayout, rect: VertexRect) {
    let inside =
        |low: i32, high: i32, count: usize| (low.max(0) as usize, (high.max(0) as usize).min(count - 1));
    let (west, east) = inside(rect.min.x, rect.max.x, layout.columns());
    let (south, north) = inside(rect.min.y, rect.max.y, layout.rows());
    let row = |y: usize| values.get(y * layout.columns() + west..=y * layout.columns() + east).unwrap_or(&[]);
    let of_row =
        |row: &[f32]| row.iter().step_by(LINE).chain(row.last()).fold(0, |all, one| all ^ one.to_bits());
    std::hint::black_box((south..=north).fold(0, |all, y| all ^ of_row(row(y))));
}

/// Mends a map of midpoint errors after `change`; `lattice` holds the new heights.
pub fn mend_midpoint(
    errors: &mut ErrorMap,
    lattice: &Lattice,
    layout: &PatchLayout,
    change: &Change,
) -> Mended {
    let changed = VertexRect::of_posts(layout, &change.posts);
    let field = HeightField::of(PatchedGround { lattice, layout });
    fetch(errors.values(), layout, changed.grown(1, 1));
    let mut mended = Mended::around(change);
    for pass in passes(layout) {
        let posts = changed.snapped(pass.step);
        if posts.is_empty() && mended.has_ended(pass) {
            break;
        }
        let measured = match pass.kind {
            VertexKind::EastEdge => posts.grown(pass.step, 0),
            VertexKind::NorthEdge => posts.grown(0, pass.step),
            VertexKind::Center => posts.grown(pass.step, pass.step),
        };
        let rect = measured.union(mended.above(pass));
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

/// Mends a map of exact errors after `change`, and `own`, the errors of the vertices alone that it was raised from, in
/// the order of [`PatchLayout::index`]; `lattice` holds the new heights.
///
/// A big triangle's error reads every post it covers. It is not scanned again where its corners stand and no changed
/// post was or is as far off its plane as the worst.
///
/// # Panics
/// Where there is not one own error a vertex.
pub fn mend_exact(
    own: &mut [f32],
    errors: &mut ErrorMap,
    lattice: &Lattice,
    layout: &PatchLayout,
    change: &Change,
) -> Mended {
    assert_eq!(own.len(), layout.vertex_count(), "one own error a vertex");
    let changed = VertexRect::of_posts(layout, &change.posts);
    let mut mended = Mended::around(change);
    for pass in passes(layout) {
        let rect = changed.grown(pass.step, pass.step).union(mended.above(pass));
        mended.sweep(layout, pass, rect, |row, changed| {
            let measure = |x: usize| {
                let vertex = Vertex::new(x as i32, row.y as i32);
                let slot = &mut own[layout.index(vertex)];
                if pass.step <= SCANNED || !stands(lattice, layout, vertex, *slot, change) {
                    *slot = own_error(lattice, layout, vertex);
                }
                *slot
            };
            errors.renew_row(layout, row, measure, changed);
        });
    }
    mended
}

/// Triangles at vertices up to this step are scanned again anyway: they hold no more posts than a look at the changed
/// ones would cost.
const SCANNED: i32 = 4;

/// Errors of big triangles are measured in f32: each is off by at most this share of the relief that was measured.
/// Several times what can come about, and still so little that no scan is saved by less.
const ROUNDING: f64 = 4e-6;

/// Whether it is certain that the error of `vertex` alone, `own` before, is what it was: its triangles' corners stand,
/// none of the changed posts they cover is pinned, and all were and are clearly less far off than the worst.
fn stands(lattice: &Lattice, layout: &PatchLayout, vertex: Vertex, own: f32, change: &Change) -> bool {
    own.is_finite()
        && triangles_split_at(layout, vertex).into_iter().flatten().all(|triangle| {
            let corners = triangle.corners().map(|corner| layout.post(corner));
            if corners.iter().any(|&corner| moved(lattice, change, corner)) {
                return false;
            }
            let Some(plane) = PostPlane::through(lattice, corners) else { return true };
            let clearly_less = f64::from(own) - ROUNDING * (f64::from(own) + relief(lattice, corners));
            covered(corners, change).all(|(post, before)| {
                let (after, shown) = (lattice.height(post), plane.height(post));
                let off = |height: f32| (f64::from(height) - shown).abs();
                let is_less = off(before).max(off(after)) < clearly_less;
                after.to_bits() == before.to_bits() || (is_less && !lattice.is_pinned(post))
            })
        })
}

/// From the lowest to the highest of three posts, meters.
fn relief(lattice: &Lattice, posts: [Post; 3]) -> f64 {
    let [a, b, c] = posts.map(|post| f64::from(lattice.height(post)));
    a.max(b).max(c) - a.min(b).min(c)
}

/// Whether a post has another height than before.
fn moved(lattice: &Lattice, change: &Change, post: Post) -> bool {
    change.posts.contains(post) && change.height_before(post).to_bits() != lattice.height(post).to_bits()
}

/// The changed posts in the bounding box of a triangle of posts, with their heights before: at least those it covers.
fn covered<'a>(corners: [Post; 3], change: &'a Change) -> impl Iterator<Item = (Post, f32)> + use<'a> {
    let range = |along: fn(Post) -> u32| {
        let [a, b, c] = corners.map(along);
        (a.min(b).min(c), a.max(b).max(c))
    };
    let (columns, rows) = (range(|post| post.column), range(|post| post.row));
    let (first, last) = (change.posts.first, change.posts.last);
    (first.row.max(rows.0)..=last.row.min(rows.1)).flat_map(move |row| {
        (first.column.max(columns.0)..=last.column.min(columns.1)).map(move |column| {
            let post = Post { column, row };
            (post, change.height_before(post))
        })
    })
}

/// Mends nested spheres after `change`, once the errors are mended: `errors` says where those changed. `own` reads
/// what is new.
pub fn mend_spheres(
    spheres: &mut SphereMap,
    ground: PatchedGround<'_>,
    own: &OwnRadius<'_>,
    change: &Change,
    errors: &Mended,
) -> Mended {
    let changed = VertexRect::of_posts(ground.layout, &change.posts);
    let window = change.posts.grown(own.half_window(), ground.lattice);
    let rough = VertexRect::of_posts(ground.layout, &window);
    let field = HeightField::of(ground);
    fetch(spheres.values(), ground.layout, changed.grown(1, 1));
    let last_error = errors.rects.iter().rposition(|rect| !rect.is_empty());
    let mut mended = Mended::around(change);
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
            spheres.renew_row(ground, &field, row, own, changed);
        });
    }
    mended
}

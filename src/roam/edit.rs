//! Mending errors and spheres after heights changed inside a rectangle of posts (003's dynamic terrain).
//!
//! Only what can have changed is computed again: pass by pass from the finest vertices up, the vertices whose own
//! measure reads a changed post and the parents of vertices that changed; where a value stays the same, the walk
//! ends. What was changed in a pass is kept as a rectangle, whose parents the next pass sweeps: the vertices near an
//! edit are dense, so that a list or a set of them costs more than the few that are looked at in vain.
//!
//! The result equals, bit for bit, one made anew from the heights as they are now. Where an edit comes in several
//! rectangles, all heights are changed first and each rectangle is then mended in turn.

use crate::roam::errors::ErrorMap;
use crate::roam::errors::exact::{own_error, triangles_split_at};
use crate::roam::errors::midpoint::torn_off;
use crate::roam::field::Field;
use crate::roam::graph::{Kind, Vertex};
use crate::roam::ground::Ground;
use crate::roam::layout::Layout;
use crate::roam::spheres::{OwnRadius, SphereMap};
use crate::roam::sweep::{Pass, VertexRect, passes};
use crate::terrain::brush::Change;
use crate::terrain::lattice::{Lattice, Post};

/// The vertices whose value changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mended {
    /// Each once, the finest first.
    pub vertices: Vec<Vertex>,
    /// The rectangle around those of each pass, in the order of [`passes`]; the rest is empty.
    rects: Vec<VertexRect>,
}

impl Mended {
    /// The rectangle around the changed vertices of a pass by its place in [`passes`].
    fn rect(&self, pass: usize) -> VertexRect {
        self.rects.get(pass).copied().unwrap_or(VertexRect::EMPTY)
    }

    /// Sweeps the pass: the vertices of `rect` for which `renew` tells that they changed.
    fn sweep(
        &mut self,
        layout: &Layout,
        pass: Pass,
        rect: VertexRect,
        mut renew: impl FnMut(Vertex) -> bool,
    ) {
        let mut changed = VertexRect::EMPTY;
        if !rect.is_empty() {
            pass.visit(layout, &rect, |vertex| {
                if renew(vertex) {
                    changed = changed.with(vertex);
                    self.vertices.push(vertex);
                }
            });
        }
        self.rects.push(changed);
    }

    /// The rectangle around the parents, in `pass`, of what changed so far; `pass` is the next to be swept.
    fn above(&self, pass: Pass) -> VertexRect {
        let (done, step) = (self.rects.len(), pass.step);
        match pass.kind {
            _ if step == 1 && pass.kind != Kind::Center => VertexRect::EMPTY,
            Kind::Center => self.rect(done - 2).grown(0, step).union(self.rect(done - 1).grown(step, 0)),
            // The centres of half the step are the last pass before the edges of this one.
            Kind::EastEdge => self.rect(done - 1).grown(step / 2, step / 2),
            Kind::NorthEdge => self.rect(done - 2).grown(step / 2, step / 2),
        }
    }

    /// Whether nothing that a pass still to come can read has changed.
    fn has_ended(&self, pass: Pass) -> bool {
        pass.kind == Kind::EastEdge && self.rects.last().is_none_or(VertexRect::is_empty)
    }
}

/// Mends a map of midpoint errors after `change`; `lattice` holds the new heights.
pub fn mend_midpoint(errors: &mut ErrorMap, lattice: &Lattice, layout: &Layout, change: &Change) -> Mended {
    let changed = VertexRect::of_posts(layout, &change.posts);
    let field = Field::of(Ground { lattice, layout, exaggeration: 1.0 });
    let mut mended = Mended::default();
    for pass in passes(layout) {
        let posts = changed.snapped(pass.step);
        if posts.is_empty() && mended.has_ended(pass) {
            break;
        }
        let measured = match pass.kind {
            Kind::EastEdge => posts.grown(pass.step, 0),
            Kind::NorthEdge => posts.grown(0, pass.step),
            Kind::Center => posts.grown(pass.step, pass.step),
        };
        let rect = measured.union(mended.above(pass));
        mended.sweep(layout, pass, rect, |vertex| {
            let [from, to] = pass.hypotenuse(vertex).map(|end| field.height(end));
            errors.renew(layout, pass, vertex, torn_off(from, to, field.height(vertex)))
        });
    }
    mended
}

/// Mends a map of exact errors after `change`, and `own`, the errors of the vertices alone that it was raised from, in
/// the order of [`Layout::index`]; `lattice` holds the new heights.
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
    layout: &Layout,
    change: &Change,
) -> Mended {
    assert_eq!(own.len(), layout.vertex_count(), "one own error a vertex");
    let changed = VertexRect::of_posts(layout, &change.posts);
    let mut mended = Mended::default();
    for pass in passes(layout) {
        let rect = changed.grown(pass.step, pass.step).union(mended.above(pass));
        mended.sweep(layout, pass, rect, |vertex| {
            let slot = &mut own[layout.index(vertex)];
            if pass.step <= SCANNED || !stands(lattice, layout, vertex, *slot, change) {
                *slot = own_error(lattice, layout, vertex);
            }
            errors.renew(layout, pass, vertex, *slot)
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
fn stands(lattice: &Lattice, layout: &Layout, vertex: Vertex, own: f32, change: &Change) -> bool {
    own.is_finite()
        && triangles_split_at(layout, vertex).into_iter().flatten().all(|triangle| {
            let corners = triangle.corners().map(|corner| layout.post(corner));
            if corners.iter().any(|&corner| moved(lattice, change, corner)) {
                return false;
            }
            let Some(plane) = Plane::through(lattice, corners) else { return true };
            let clearly_less = f64::from(own) - ROUNDING * (f64::from(own) + plane.relief);
            plane.covered(change).all(|(post, before)| {
                let after = lattice.height(post);
                let off = plane.off(post, before).max(plane.off(post, after));
                after.to_bits() == before.to_bits() || (off < clearly_less && !lattice.is_pinned(post))
            })
        })
}

/// Whether a post has another height than before.
fn moved(lattice: &Lattice, change: &Change, post: Post) -> bool {
    let (first, last) = (change.posts.first, change.posts.last);
    change.posts.contains(post) && {
        let width = (last.column - first.column + 1) as usize;
        let at = (post.row - first.row) as usize * width + (post.column - first.column) as usize;
        change.before[at].to_bits() != lattice.height(post).to_bits()
    }
}

/// A triangle of posts and its plane, in posts and metres.
struct Plane {
    corners: [Post; 3],
    at: (f64, f64, f64),
    slope: (f64, f64),
    /// From the lowest corner to the highest, metres.
    relief: f64,
}

impl Plane {
    /// `None` where the posts lie on a line; NaN slopes where a corner has no data.
    fn through(lattice: &Lattice, corners: [Post; 3]) -> Option<Self> {
        let at = |post: Post| (f64::from(post.column), f64::from(post.row), f64::from(lattice.height(post)));
        let [a, b, c] = corners.map(at);
        let ((bx, by, bz), (cx, cy, cz)) =
            ((b.0 - a.0, b.1 - a.1, b.2 - a.2), (c.0 - a.0, c.1 - a.1, c.2 - a.2));
        let area = bx * cy - by * cx;
        let slope = ((bz * cy - cz * by) / area, (cz * bx - bz * cx) / area);
        let relief = a.2.max(b.2).max(c.2) - a.2.min(b.2).min(c.2);
        (area != 0.0).then_some(Self { corners, at: a, slope, relief })
    }

    /// The changed posts in the triangle's bounding box, with their heights before: at least those it covers.
    fn covered<'a>(&self, change: &'a Change) -> impl Iterator<Item = (Post, f32)> + use<'a> {
        let range = |along: fn(Post) -> u32, corners: [Post; 3]| {
            let [a, b, c] = corners.map(along);
            (a.min(b).min(c), a.max(b).max(c))
        };
        let (columns, rows) = (range(|post| post.column, self.corners), range(|post| post.row, self.corners));
        let (first, last) = (change.posts.first, change.posts.last);
        let width = (last.column - first.column + 1) as usize;
        (first.row.max(rows.0)..=last.row.min(rows.1)).flat_map(move |row| {
            (first.column.max(columns.0)..=last.column.min(columns.1)).map(move |column| {
                let at = (row - first.row) as usize * width + (column - first.column) as usize;
                (Post { column, row }, change.before[at])
            })
        })
    }

    /// How far a height at a post is off the plane, metres.
    fn off(&self, post: Post, height: f32) -> f64 {
        let (east, north) = (f64::from(post.column) - self.at.0, f64::from(post.row) - self.at.1);
        (f64::from(height) - (self.at.2 + self.slope.0 * east + self.slope.1 * north)).abs()
    }
}

/// Mends nested spheres after `change`, once the errors are mended: `errors` says where those changed. `own` reads
/// what is new.
pub fn mend_spheres(
    spheres: &mut SphereMap,
    ground: Ground<'_>,
    own: &OwnRadius<'_>,
    change: &Change,
    errors: &Mended,
) -> Mended {
    let changed = VertexRect::of_posts(ground.layout, &change.posts);
    let window = change.posts.grown(own.half_window(), ground.lattice);
    let rough = VertexRect::of_posts(ground.layout, &window);
    let field = Field::of(ground);
    let last_error = errors.rects.iter().rposition(|rect| !rect.is_empty());
    let mut mended = Mended::default();
    for (index, pass) in passes(ground.layout).enumerate() {
        let half = (pass.step / 2).max(1);
        let (moved, near) = (changed.snapped(half), rough.snapped(pass.step));
        let errors_ended = last_error.is_none_or(|last| index > last);
        if moved.is_empty() && near.is_empty() && errors_ended && mended.has_ended(pass) {
            break;
        }
        let has_children = pass.kind != Kind::Center && pass.step > 1;
        let children = if has_children { moved.grown(half, half) } else { VertexRect::EMPTY };
        let corners = changed.snapped(pass.step).grown(pass.step, pass.step);
        let rect = corners.union(children).union(near).union(errors.rect(index)).union(mended.above(pass));
        mended.sweep(ground.layout, pass, rect, |vertex| {
            spheres.renew(&field, pass, vertex, own.of(ground, vertex))
        });
    }
    mended
}

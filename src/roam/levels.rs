//! The vertices of a layout level by level, the finest first: all of them, or those inside a rectangle.
//!
//! Whatever is nested up the vertex graph (errors, spheres) is made in passes: at each step the edge middles, whose
//! children are the centres of half the step, then the centres, whose children are those edge middles. Vertices of
//! one pass do not depend on each other, so a pass may run in parallel, and a change of a few vertices is followed
//! upwards by sweeping, pass by pass, the rectangle that can have changed.

use rayon::prelude::*;

use crate::roam::graph::{Kind, Vertex};
use crate::roam::layout::Layout;
use crate::terrain::brush::PostRect;

/// All vertices of one kind and one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// What they are the middles of.
    pub kind: Kind,
    /// See [`Vertex::step`].
    pub step: i32,
}

/// The passes of a layout, the finest first, patch corners left out: a vertex comes after all its children.
pub fn passes(layout: &Layout) -> impl Iterator<Item = Pass> + use<> {
    let steps = std::iter::successors(Some(1), |step| Some(2 * step));
    let patch = layout.patch();
    steps.take_while(move |&step| step < patch).flat_map(|step| {
        [Kind::EastEdge, Kind::NorthEdge, Kind::Center].into_iter().map(move |kind| Pass { kind, step })
    })
}

impl Pass {
    /// The pass's vertices inside the rectangle and the layout, row by row.
    pub fn within(self, layout: &Layout, rect: &VertexRect) -> impl Iterator<Item = Vertex> + use<> {
        let stride = 2 * self.step;
        let first = match self.kind {
            Kind::EastEdge => (self.step, 0),
            Kind::NorthEdge => (0, self.step),
            Kind::Center => (self.step, self.step),
        };
        let from = |first: i32, low: i32| first + ((low - first).max(0) + stride - 1) / stride * stride;
        let last = (rect.max.x.min(layout.columns() as i32 - 1), rect.max.y.min(layout.rows() as i32 - 1));
        let (x, y) = (from(first.0, rect.min.x), from(first.1, rect.min.y));
        let along = move |from: i32, last: i32| (from..last.saturating_add(1)).step_by(stride as usize);
        along(y, last.1).flat_map(move |y| along(x, last.0).map(move |x| Vertex::new(x, y)))
    }

    /// Calls `visit` with each of the vertices of [`Pass::within`], in the same order.
    pub fn visit(self, layout: &Layout, rect: &VertexRect, mut visit: impl FnMut(Vertex)) {
        let Some(first) = self.within(layout, rect).next() else { return };
        let last = (rect.max.x.min(layout.columns() as i32 - 1), rect.max.y.min(layout.rows() as i32 - 1));
        let mut y = first.y;
        while y <= last.1 {
            let mut x = first.x;
            while x <= last.0 {
                visit(Vertex::new(x, y));
                x += 2 * self.step;
            }
            y += 2 * self.step;
        }
    }

    /// [`Vertex::hypotenuse`] of one of the pass's vertices.
    pub fn hypotenuse(self, vertex: Vertex) -> [Vertex; 2] {
        let step = self.step;
        let (dx, dy) = match self.kind {
            Kind::EastEdge => (step, 0),
            Kind::NorthEdge => (0, step),
            Kind::Center => {
                let side = step.trailing_zeros() + 1;
                let rises = ((vertex.x >> side) + (vertex.y >> side)) & 1 == 0;
                (step, if rises { step } else { -step })
            }
        };
        [vertex.moved(-dx, -dy), vertex.moved(dx, dy)]
    }

    /// Where the children of the pass's vertices lie, as offsets; none for edge middles of the finest step.
    pub fn child_offsets(self) -> &'static [(i32, i32)] {
        match (self.kind, self.step) {
            (Kind::Center, _) => &[(-1, 0), (1, 0), (0, -1), (0, 1)],
            (_, 1) => &[],
            _ => &[(-1, -1), (1, -1), (-1, 1), (1, 1)],
        }
    }

    /// What the offsets of the children are multiplied by.
    pub fn child_reach(self) -> i32 {
        if self.kind == Kind::Center { self.step } else { self.step / 2 }
    }
}

/// A rectangle of vertices, ends included; empty where `min` exceeds `max` on either axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexRect {
    /// South-west corner.
    pub min: Vertex,
    /// North-east corner.
    pub max: Vertex,
}

impl VertexRect {
    /// No vertex.
    pub const EMPTY: Self =
        Self { min: Vertex::new(i32::MAX, i32::MAX), max: Vertex::new(i32::MIN, i32::MIN) };

    /// The vertices that stand for posts of `posts`, those beyond the lattice's border included.
    pub fn of_posts(layout: &Layout, posts: &PostRect) -> Self {
        let beyond = |at: u32, last: u32, end: usize| if at >= last { end as i32 - 1 } else { at as i32 };
        let last = layout.post(Vertex::new(i32::MAX, i32::MAX));
        Self {
            min: Vertex::new(posts.first.column as i32, posts.first.row as i32),
            max: Vertex::new(
                beyond(posts.last.column, last.column, layout.columns()),
                beyond(posts.last.row, last.row, layout.rows()),
            ),
        }
    }

    /// Whether it holds no vertex.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x || self.min.y > self.max.y
    }

    /// Grown by `dx` east and west, by `dy` north and south; what is empty stays so.
    pub fn grown(self, dx: i32, dy: i32) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self { min: self.min.moved(-dx, -dy), max: self.max.moved(dx, dy) }
    }

    /// The smallest rectangle around both.
    pub fn union(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return if self.is_empty() { other } else { self };
        }
        Self {
            min: Vertex::new(self.min.x.min(other.min.x), self.min.y.min(other.min.y)),
            max: Vertex::new(self.max.x.max(other.max.x), self.max.y.max(other.max.y)),
        }
    }

    /// Grown to hold `vertex`.
    pub fn with(self, vertex: Vertex) -> Self {
        Self {
            min: Vertex::new(self.min.x.min(vertex.x), self.min.y.min(vertex.y)),
            max: Vertex::new(self.max.x.max(vertex.x), self.max.y.max(vertex.y)),
        }
    }

    /// The rectangle of the vertices inside whose coordinates are both multiples of `step`, a power of two.
    pub fn snapped(self, step: i32) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let mask = !(step - 1);
        let up = |at: i32| (at + step - 1) & mask;
        let snapped = Self {
            min: Vertex::new(up(self.min.x), up(self.min.y)),
            max: Vertex::new(self.max.x & mask, self.max.y & mask),
        };
        if snapped.is_empty() { Self::EMPTY } else { snapped }
    }
}

/// Which rows a row sweep writes, of those whose number is a multiple of `half`; it reads the others of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rows {
    /// Those at even multiples.
    Even,
    /// Those at odd multiples.
    Odd,
}

/// Calls `write` with every written row of `values`, `columns` long each: its number, the row itself, the read rows
/// `half` south and north of it (empty beyond the border). In parallel; rows do not depend on each other.
pub fn for_rows(
    values: &mut [f32],
    columns: usize,
    half: usize,
    rows: Rows,
    write: impl Fn(usize, &mut [f32], [&[f32]; 2]) + Sync,
) {
    let (mut even, mut odd) = (Vec::new(), Vec::new());
    for chunk in values.chunks_mut(2 * half * columns) {
        let (low, high) = chunk.split_at_mut(chunk.len().min(half * columns));
        even.push(&mut low[..columns]);
        odd.extend(high.get_mut(..columns));
    }
    let (written, read, first) = match rows {
        Rows::Even => (even, odd, 0),
        Rows::Odd => (odd, even, half),
    };
    let read: Vec<&[f32]> = read.into_iter().map(|row| &*row).collect();
    let at = |index: Option<usize>| index.and_then(|index| read.get(index)).copied().unwrap_or(&[]);
    // Fewer rows than this cost less than handing them to another thread.
    let least = (4096 / columns.div_ceil(half)).max(1);
    written.into_par_iter().with_min_len(least).enumerate().for_each(|(index, row)| {
        let neighbours = match rows {
            Rows::Even => [at(index.checked_sub(1)), at(Some(index))],
            Rows::Odd => [at(Some(index)), at(Some(index + 1))],
        };
        write(first + 2 * half * index, row, neighbours);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_passes_hold_every_vertex_but_the_corners_once_and_children_first() {
        let layout = Layout::new(40, 21, 16).expect("sound");
        let all = VertexRect { min: Vertex::new(0, 0), max: Vertex::new(i32::MAX - 1, i32::MAX - 1) };
        let mut seen = vec![false; layout.vertex_count()];
        for pass in passes(&layout) {
            for vertex in pass.within(&layout, &all) {
                assert_eq!((vertex.kind(), vertex.step()), (pass.kind, pass.step));
                assert!(!std::mem::replace(&mut seen[layout.index(vertex)], true));
                assert_eq!(pass.hypotenuse(vertex), vertex.hypotenuse());
                let mut children: Vec<Vertex> = vertex.children().collect();
                let reach = pass.child_reach();
                let offsets = pass.child_offsets().iter();
                let found: Vec<Vertex> = offsets.map(|&(x, y)| vertex.moved(x * reach, y * reach)).collect();
                assert_eq!(found, children);
                children.retain(|&child| layout.contains(child));
                assert!(children.into_iter().all(|child| seen[layout.index(child)]));
            }
        }
        let corners = (3 + 1) * (2 + 1);
        assert_eq!(seen.iter().filter(|seen| !**seen).count(), corners);
    }

    #[test]
    fn a_rectangle_holds_just_the_vertices_inside() {
        let layout = Layout::new(65, 65, 32).expect("sound");
        let rect = VertexRect { min: Vertex::new(-3, 7), max: Vertex::new(90, 40) };
        let inside: usize = passes(&layout).map(|pass| pass.within(&layout, &rect).count()).sum();
        for pass in passes(&layout) {
            let mut visited = Vec::new();
            pass.visit(&layout, &rect, |vertex| visited.push(vertex));
            assert_eq!(visited, pass.within(&layout, &rect).collect::<Vec<Vertex>>());
        }
        let corners = 3;
        assert_eq!(inside, 65 * 34 - corners);
        let snapped = VertexRect { min: Vertex::new(5, 7), max: Vertex::new(17, 9) }.snapped(8);
        assert_eq!(snapped, VertexRect { min: Vertex::new(8, 8), max: Vertex::new(16, 8) });
        assert!(VertexRect { min: Vertex::new(5, 9), max: Vertex::new(17, 15) }.snapped(8).is_empty());
    }
}

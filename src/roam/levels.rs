//! The vertices of a layout level by level, the finest first: all of them, or those inside a rectangle.
//!
//! Values nested up the vertex graph (errors, spheres) are computed in passes: at each step the edge middles, whose
//! children are the centers of half the step, then the centers, whose children are those edge middles. Vertices of one pass
//! do not depend on each other, so a pass may run in parallel, and an edit is followed upward by sweeping, pass by pass, the
//! rectangle that can have changed.

use rayon::prelude::*;

use crate::graph::{Vertex, VertexKind};
use crate::layout::PatchLayout;
use sandtable_terrain::post_rect::PostRect;

/// All vertices of one kind and one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LevelPass {
    /// What they are the middles of.
    pub kind: VertexKind,
    /// See [`Vertex::step`].
    pub step: i32,
}

/// The passes of a layout, the finest first, without patch corners: a vertex comes after all its children.
pub fn passes(layout: &PatchLayout) -> impl Iterator<Item = LevelPass> + use<> {
    let steps = std::iter::successors(Some(1), |step| Some(2 * step));
    let patch = layout.patch();
    steps.take_while(move |&step| step < patch).flat_map(|step| {
        [VertexKind::EastEdge, VertexKind::NorthEdge, VertexKind::Center].map(|kind| LevelPass { kind, step })
    })
}

impl LevelPass {
    /// How far the hypotenuses of its vertices reach east and north; also the first vertex of the pass.
    fn offsets(self) -> (i32, i32) {
        match self.kind {
            VertexKind::EastEdge => (self.step, 0),
            VertexKind::NorthEdge => (0, self.step),
            VertexKind::Center => (self.step, self.step),
        }
    }

    /// The vertices whose hypotenuses have an end or their middle in `posts`, and a few more.
    pub(crate) fn reading(self, posts: VertexRect) -> VertexRect {
        let (dx, dy) = self.offsets();
        posts.grown(dx, dy)
    }

    /// The places of the children of its vertices; `None` where they have none.
    pub fn children(self) -> Option<ChildPlaces> {
        match (self.child_reach(), self.kind) {
            (0, _) => None,
            (reach, VertexKind::Center) => Some(ChildPlaces::Along(reach)),
            (reach, _) => Some(ChildPlaces::Aslant(reach)),
        }
    }

    /// The rows of the pass's vertices inside the rectangle and the layout, from the south.
    pub fn rows_within(
        self,
        layout: &PatchLayout,
        rect: &VertexRect,
    ) -> impl Iterator<Item = PassRow> + use<> {
        let (stride, limit) = (2 * self.step, (layout.columns() as i32, layout.rows() as i32));
        let (dx, dy) = self.offsets();
        let from = |first: i32, low: i32| first + ((low - first).max(0) + stride - 1) / stride * stride;
        let (x, y) = (from(dx, rect.min.x), from(dy, rect.min.y));
        let end = (rect.max.x.min(limit.0 - 1) + 1, rect.max.y.min(limit.1 - 1) + 1);
        let count = |first: i32, end: i32| (end - first + stride - 1).max(0) as usize >> (self.shift());
        let (columns, rows) = (count(x, end.0), count(y, end.1));
        let rows = if columns == 0 { 0 } else { rows };
        (0..rows).map(move |row| PassRow {
            pass: self,
            y: y as usize + (row << self.shift()),
            columns: StridedColumns { first: x as usize, shift: self.shift(), count: columns },
        })
    }

    /// The binary logarithm of the distance between its vertices along a row or a column.
    fn shift(self) -> u32 {
        self.step.trailing_zeros() + 1
    }

    /// Whether the hypotenuse of the center in column `x` and row `y` runs from south-west to north-east.
    #[inline]
    pub fn rises(self, x: usize, y: usize) -> bool {
        ((x >> self.shift()) + (y >> self.shift())) & 1 == 0
    }

    /// The distance of its vertices' children, along both axes or along one of them; 0 where they have none.
    pub fn child_reach(self) -> usize {
        (if self.kind == VertexKind::Center { self.step } else { self.step / 2 }) as usize
    }
}

/// The places of the children of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChildPlaces {
    /// This far along both axes at once: those of an edge middle.
    Aslant(usize),
    /// This far along one axis: those of a center.
    Along(usize),
}

/// Columns at equal distances, a power of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StridedColumns {
    /// The first.
    pub first: usize,
    /// The binary logarithm of the distance.
    pub shift: u32,
    /// How many there are.
    pub count: usize,
}

impl StridedColumns {
    /// The columns from `first` on that are less than `end`.
    pub fn until(first: usize, end: usize, shift: u32) -> Self {
        Self { first, shift, count: (end + (1 << shift) - 1).saturating_sub(first) >> shift }
    }

    /// A column by its place among them.
    #[inline]
    pub fn at(self, index: usize) -> usize {
        self.first + (index << self.shift)
    }

    /// All of them.
    #[inline]
    pub fn iter(self) -> impl ExactSizeIterator<Item = usize> {
        (0..self.count).map(move |index| self.at(index))
    }
}

/// Vertices of a pass in one row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassRow {
    /// The pass.
    pub pass: LevelPass,
    /// The row.
    pub y: usize,
    /// The columns of the vertices.
    pub columns: StridedColumns,
}

/// A row of values, one a vertex, and the rows of its vertices' children.
pub struct ChildRows<'a> {
    /// The row itself.
    pub here: &'a mut [f32],
    /// The row of the children south of it; where there is none, that of those north of it.
    pub south: &'a [f32],
    /// The row of the children north of it; where there is none, that of those south of it.
    pub north: &'a [f32],
}

impl PassRow {
    /// The rows of the children south and north, of the layout's `rows`: twice the same where the border leaves one out.
    #[inline]
    pub fn child_rows(self, rows: usize) -> [usize; 2] {
        both_sides(self.y, self.pass.child_reach(), rows)
    }

    /// Its values among those of all vertices of the layout.
    #[inline]
    pub fn values<'a>(self, values: &'a mut [f32], layout: &PatchLayout) -> ChildRows<'a> {
        let columns = layout.columns();
        let [south, north] = self.child_rows(layout.rows());
        let (before, rest) = values.split_at_mut(self.y * columns);
        let (here, after) = rest.split_at_mut(columns);
        let row = |y: usize| match y.checked_sub(self.y + 1) {
            Some(ahead) => &after[ahead * columns..][..columns],
            None => before.get(y * columns..).and_then(|rest| rest.get(..columns)).unwrap_or(&[]),
        };
        ChildRows { south: row(south), north: row(north), here }
    }

    /// Sets the value of each of its vertices again, by its place among them and its column, and adds the vertices whose
    /// value changed to `changed`.
    #[inline]
    pub(crate) fn renew(
        self,
        rows: &mut ChildRows<'_>,
        mut value: impl FnMut(&ChildRows<'_>, usize, usize) -> f32,
        changed: &mut Vec<Vertex>,
    ) {
        for index in 0..self.columns.count {
            let x = self.columns.at(index);
            let value = value(rows, index, x);
            if std::mem::replace(&mut rows.here[x], value) != value {
                changed.push(Vertex::new(x as i32, self.y as i32));
            }
        }
    }
}

/// The places `reach` below and above `at` of `count`; where one is missing, the other twice.
#[inline]
pub fn both_sides(at: usize, reach: usize, count: usize) -> [usize; 2] {
    let (below, above) = (at.checked_sub(reach), at + reach);
    [below.unwrap_or(above), if above < count { above } else { below.unwrap_or(at) }]
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

    /// The vertices of the posts of `posts`, including those beyond the lattice's border.
    pub fn from_posts(layout: &PatchLayout, posts: &PostRect) -> Self {
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

    /// Grown by `dx` east and west, by `dy` north and south; an empty one stays empty.
    pub fn grown(self, dx: i32, dy: i32) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self { min: self.min.moved(-dx, -dy), max: self.max.moved(dx, dy) }
    }

    /// The smallest rectangle around both.
    pub fn union(self, other: Self) -> Self {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => other,
            (_, true) => self,
            _ => self.with(other.min).with(other.max),
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

/// The rows that a row sweep writes, of those whose number is a multiple of `half`; it reads the others of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepRows {
    /// Those at even multiples.
    Even,
    /// Those at odd multiples.
    Odd,
}

/// Calls `write` with every written row of `values`, `columns` long each: its number, the row itself, and the read rows
/// `half` south and north of it (twice the same where one lies beyond the border). In parallel; rows do not depend on each
/// other.
pub fn for_rows(
    values: &mut [f32],
    columns: usize,
    half: usize,
    rows: SweepRows,
    write: impl Fn(usize, &mut [f32], [&[f32]; 2]) + Sync,
) {
    let (mut even, mut odd) = (Vec::new(), Vec::new());
    for chunk in values.chunks_mut(2 * half * columns) {
        let (low, high) = chunk.split_at_mut(chunk.len().min(half * columns));
        even.push(&mut low[..columns]);
        odd.extend(high.get_mut(..columns));
    }
    let (written, read, first) = match rows {
        SweepRows::Even => (even, odd, 0),
        SweepRows::Odd => (odd, even, half),
    };
    let read: Vec<&[f32]> = read.into_iter().map(|row| &*row).collect();
    // Fewer rows than this cost less than handing them to another thread.
    let least = (4096 / columns.div_ceil(half)).max(1);
    written.into_par_iter().with_min_len(least).enumerate().for_each(|(index, row)| {
        // South of an odd row is the read row of its own number, south of an even one that before.
        let (south, north) = match rows {
            SweepRows::Even => (index.wrapping_sub(1), index),
            SweepRows::Odd => (index, index + 1),
        };
        let at = |index: usize| read.get(index).copied();
        let neighbors = [at(south).or(at(north)), at(north).or(at(south))].map(Option::unwrap_or_default);
        write(first + 2 * half * index, row, neighbors);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn within(pass: LevelPass, layout: &PatchLayout, rect: &VertexRect) -> impl Iterator<Item = Vertex> {
        let vertices = |row: PassRow| row.columns.iter().map(move |x| Vertex::new(x as i32, row.y as i32));
        pass.rows_within(layout, rect).flat_map(vertices)
    }

    #[test]
    fn the_passes_hold_every_vertex_but_the_corners_once_and_children_first() {
        let layout = PatchLayout::new(40, 21, 16).expect("sound");
        let all = VertexRect { min: Vertex::new(0, 0), max: Vertex::new(i32::MAX - 1, i32::MAX - 1) };
        let mut seen = vec![false; layout.vertex_count()];
        for pass in passes(&layout) {
            for vertex in within(pass, &layout, &all) {
                assert_eq!((vertex.kind(), vertex.step()), (pass.kind, pass.step));
                assert!(!std::mem::replace(&mut seen[layout.index(vertex)], true));
                if pass.kind == VertexKind::Center {
                    let [from, to] = vertex.hypotenuse();
                    let rises = pass.rises(vertex.x as usize, vertex.y as usize);
                    assert_eq!(rises, (to.x > from.x) == (to.y > from.y));
                }
                let mut children: Vec<Vertex> = vertex.children().collect();
                assert_eq!(pass.child_reach() == 0, children.is_empty());
                let reach = pass.child_reach() as i32;
                let is_near =
                    |child: &Vertex| (child.x - vertex.x).abs().max((child.y - vertex.y).abs()) == reach;
                assert!(children.iter().all(is_near));
                children.retain(|&child| layout.contains(child));
                assert!(children.into_iter().all(|child| seen[layout.index(child)]));
            }
        }
        let corners = (3 + 1) * (2 + 1);
        assert_eq!(seen.iter().filter(|seen| !**seen).count(), corners);
    }

    #[test]
    fn a_row_lies_between_its_children_and_a_border_repeats_the_inner_one() {
        let layout = PatchLayout::new(9, 9, 8).expect("sound");
        let mut values: Vec<f32> = (0..81).map(|at| (at / 9) as f32).collect();
        let all = VertexRect { min: Vertex::new(0, 0), max: Vertex::new(8, 8) };
        let mut rows_of = |kind, step| {
            let rows = LevelPass { kind, step }.rows_within(&layout, &all);
            let of = |row: PassRow| {
                let beside = row.values(&mut values, &layout);
                [beside.south[0], beside.here[0], beside.north[8]]
            };
            rows.map(of).collect::<Vec<[f32; 3]>>()
        };
        assert_eq!(rows_of(VertexKind::EastEdge, 4), [[2.0, 0.0, 2.0], [6.0, 8.0, 6.0]]);
        assert_eq!(rows_of(VertexKind::NorthEdge, 4), [[2.0, 4.0, 6.0]]);
        assert_eq!(rows_of(VertexKind::Center, 2), [[0.0, 2.0, 4.0], [4.0, 6.0, 8.0]]);
        assert_eq!([both_sides(0, 2, 9), both_sides(8, 2, 9), both_sides(4, 2, 9)], [[2, 2], [6, 6], [2, 6]]);
    }

    #[test]
    fn a_rectangle_holds_just_the_vertices_inside() {
        let layout = PatchLayout::new(65, 65, 32).expect("sound");
        let rect = VertexRect { min: Vertex::new(-3, 7), max: Vertex::new(90, 40) };
        let inside: usize = passes(&layout).map(|pass| within(pass, &layout, &rect).count()).sum();
        let corners = 3;
        assert_eq!(inside, 65 * 34 - corners);
        let snapped = VertexRect { min: Vertex::new(5, 7), max: Vertex::new(17, 9) }.snapped(8);
        assert_eq!(snapped, VertexRect { min: Vertex::new(8, 8), max: Vertex::new(16, 8) });
        assert!(VertexRect { min: Vertex::new(5, 9), max: Vertex::new(17, 15) }.snapped(8).is_empty());
    }
}

//! Rectangles of posts.

use glam::DVec2;

use crate::lattice::{Lattice, Post};
use sandtable_geom::rect::Rect;

/// A rectangle of posts, ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PostRect {
    /// South-west.
    pub first: Post,
    /// North-east.
    pub last: Post,
}

impl PostRect {
    /// All posts of a lattice.
    pub fn all(lattice: &Lattice) -> Self {
        let last = Post { column: lattice.columns() - 1, row: lattice.rows() - 1 };
        Self { first: Post { column: 0, row: 0 }, last }
    }

    /// The posts of a lattice between two grid positions, ends included; `None` for none.
    pub fn between(lattice: &Lattice, low: DVec2, high: DVec2) -> Option<Self> {
        let (low, high) = (low.ceil().max(DVec2::ZERO), high.floor().min(lattice.last_grid()));
        let rect = || Self { first: Post::at_grid(low), last: Post::at_grid(high) };
        low.cmple(high).all().then(rect)
    }

    /// The posts around the grid positions from `low` to `high`, at least two a side, in a lattice of `columns` and `rows`;
    /// those nearest to positions beyond its border.
    pub fn around((columns, rows): (u32, u32), low: DVec2, high: DVec2) -> Self {
        let far = DVec2::new(f64::from(columns - 1), f64::from(rows - 1));
        let first = Post::at_grid(low.floor().clamp(DVec2::ZERO, far - 1.0));
        let last = Post::at_grid(high.ceil().clamp(DVec2::ONE, far));
        let last = Post { column: last.column.max(first.column + 1), row: last.row.max(first.row + 1) };
        Self { first, last }
    }

    /// The posts within a rectangle in world space; `None` for none.
    pub fn within(lattice: &Lattice, rect: &Rect) -> Option<Self> {
        Self::between(lattice, lattice.grid_at(rect.min), lattice.grid_at(rect.max))
    }

    /// Extended by posts east and west, north and south, as far as the lattice reaches.
    pub fn grown(self, by: (u32, u32), lattice: &Lattice) -> Self {
        let (column, row) = (self.first.column.saturating_sub(by.0), self.first.row.saturating_sub(by.1));
        Self {
            first: Post { column, row },
            last: Post {
                column: self.last.column.saturating_add(by.0).min(lattice.columns() - 1),
                row: self.last.row.saturating_add(by.1).min(lattice.rows() - 1),
            },
        }
    }

    /// All posts, row by row from the south-west.
    pub fn posts(self) -> impl Iterator<Item = Post> {
        (self.first.row..=self.last.row).flat_map(move |row| {
            (self.first.column..=self.last.column).map(move |column| Post { column, row })
        })
    }

    /// Posts along a row.
    pub fn width(&self) -> usize {
        (self.last.column - self.first.column + 1) as usize
    }

    /// Rows of posts.
    pub fn height(&self) -> usize {
        (self.last.row - self.first.row + 1) as usize
    }

    /// The index of a post of the rectangle, counted from the south-west, row by row.
    #[inline]
    pub fn index(&self, post: Post) -> usize {
        (post.row - self.first.row) as usize * self.width() + (post.column - self.first.column) as usize
    }

    /// Whether the post lies inside.
    #[inline]
    pub fn contains(&self, post: Post) -> bool {
        (self.first.column..=self.last.column).contains(&post.column)
            && (self.first.row..=self.last.row).contains(&post.row)
    }

    /// The smallest rectangle that holds this one and the post.
    pub fn with(self, post: Post) -> Self {
        let (first, last) = (self.first, self.last);
        Self {
            first: Post { column: first.column.min(post.column), row: first.row.min(post.row) },
            last: Post { column: last.column.max(post.column), row: last.row.max(post.row) },
        }
    }

    /// The posts of both; `None` where there are none.
    pub fn intersection(self, other: Self) -> Option<Self> {
        let first = Post {
            column: self.first.column.max(other.first.column),
            row: self.first.row.max(other.first.row),
        };
        let last =
            Post { column: self.last.column.min(other.last.column), row: self.last.row.min(other.last.row) };
        (first.column <= last.column && first.row <= last.row).then_some(Self { first, last })
    }

    /// These posts of a whole, counted in a part of it that holds them.
    pub fn counted_in(self, part: Self) -> Self {
        let from =
            |post: Post| Post { column: post.column - part.first.column, row: post.row - part.first.row };
        Self { first: from(self.first), last: from(self.last) }
    }

    /// The part on the lattice; `None` where nothing is left.
    pub fn clipped(self, lattice: &Lattice) -> Option<Self> {
        Self::between(lattice, self.first.grid(), self.last.grid())
    }
}

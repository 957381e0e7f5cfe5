//! The posts that any triangle of posts covers, row by row: integers only, so that a post on an edge is never missed.

use sandtable_terrain::lattice::Post;

/// The posts of one row that a triangle covers, ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowSpan {
    /// Counted northward.
    pub row: u32,
    /// Its westernmost post.
    pub first: u32,
    /// Its easternmost post.
    pub last: u32,
}

/// The rows of a triangle of posts, from the south.
pub struct RowSpans {
    corners: [(i64, i64); 3],
    row: i64,
    last_row: i64,
}

impl RowSpans {
    /// The rows of the triangle with these corners, in either orientation.
    pub fn new(posts: [Post; 3]) -> Self {
        let corners = posts.map(|post| (i64::from(post.column), i64::from(post.row)));
        let rows = corners.map(|corner| corner.1);
        Self { corners, row: rows[0].min(rows[1]).min(rows[2]), last_row: rows[0].max(rows[1]).max(rows[2]) }
    }

    /// Those rows of the triangle from `first` to `last`.
    pub fn within(self, first: u32, last: u32) -> Self {
        Self { row: self.row.max(first.into()), last_row: self.last_row.min(last.into()), ..self }
    }
}

impl Iterator for RowSpans {
    type Item = RowSpan;

    fn next(&mut self) -> Option<RowSpan> {
        while self.row <= self.last_row {
            let row = self.row;
            self.row += 1;
            let (mut first, mut last) = (i64::MAX, i64::MIN);
            for side in 0..3 {
                let (from, to) = (self.corners[side], self.corners[(side + 1) % 3]);
                let (low, high) = if from.1 <= to.1 { (from, to) } else { (to, from) };
                if row < low.1 || row > high.1 {
                    continue;
                }
                if low.1 == high.1 {
                    first = first.min(low.0.min(high.0));
                    last = last.max(low.0.max(high.0));
                    continue;
                }
                let (rise, run) = (high.1 - low.1, (high.0 - low.0) * (row - low.1));
                first = first.min(low.0 + run.div_euclid(rise) + i64::from(run.rem_euclid(rise) != 0));
                last = last.max(low.0 + run.div_euclid(rise));
            }
            if first <= last {
                return Some(RowSpan { row: row as u32, first: first as u32, last: last as u32 });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(posts: [(u32, u32); 3]) -> Vec<(u32, u32, u32)> {
        let posts = posts.map(|(column, row)| Post { column, row });
        RowSpans::new(posts).map(|span| (span.row, span.first, span.last)).collect()
    }

    #[test]
    fn posts_on_the_edges_are_covered_and_those_beside_them_are_not() {
        assert_eq!(rows([(0, 0), (4, 0), (4, 4)]), [(0, 0, 4), (1, 1, 4), (2, 2, 4), (3, 3, 4), (4, 4, 4)]);
        assert_eq!(rows([(0, 0), (3, 0), (0, 2)]), [(0, 0, 3), (1, 0, 1), (2, 0, 0)]);
        assert_eq!(rows([(5, 1), (7, 2), (6, 2)]), [(1, 5, 5), (2, 6, 7)]);
    }
}

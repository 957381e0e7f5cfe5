//! The coarser levels of a ground map, from which far ground is read.
//!
//! A far pixel spans many posts, and a single reading would make hillshade sparkle. Each level holds every second post
//! of the one before, smoothed (Williams 1983). `n` posts become `n / 2 + 1`, where texels would halve rounding down:
//! posts stay in place, so that the first post of every level is the map's first. The last post of a level may lie
//! past the map's border.

use std::iter::successors;

use rayon::prelude::*;

use crate::draw::ground::{GroundMap, GroundPost};

/// Weights of a post and its two neighbors.
const KERNEL: [(usize, f32); 3] = [(0, 0.25), (1, 0.5), (2, 0.25)];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PostCount {
    pub columns: u32,
    pub rows: u32,
}

/// Posts at twice the distance of the level before.
#[derive(Debug)]
pub struct GroundLevel {
    pub size: PostCount,
    /// The posts, row by row from the south-west.
    pub posts: Vec<GroundPost>,
}

impl PostCount {
    pub fn from_map(map: &GroundMap) -> Self {
        Self { columns: map.columns, rows: map.rows }
    }

    /// The next coarser level; `None` after two posts a side.
    pub fn halved(self) -> Option<Self> {
        let Self { columns, rows } = self;
        (columns.max(rows) > 2).then_some(Self { columns: columns / 2 + 1, rows: rows / 2 + 1 })
    }
}

/// The coarser levels of a checked `map`, the finest first, down to two posts a side. Each level is made when it is
/// taken; earlier ones are not kept.
pub fn coarser_levels(map: &GroundMap) -> impl Iterator<Item = GroundLevel> {
    let first = next_level(PostCount::from_map(map), &map.posts);
    successors(first, |level| next_level(level.size, &level.posts))
}

pub fn add_weighted(sum: &mut GroundPost, post: &GroundPost, weight: f32) {
    *sum = sum.zip_with(post, |sum, value| sum + value * weight);
}

fn next_level(from: PostCount, posts: &[GroundPost]) -> Option<GroundLevel> {
    let size = from.halved()?;
    let [columns, rows, stride] = [from.columns, from.rows, size.columns].map(|count| count as usize);
    // Past the border the border's posts are repeated.
    let neighbor =
        |index: usize, step: usize, count: usize| (2 * index + step).saturating_sub(1).min(count - 1);
    let post = |index: usize| {
        let (row, column) = (index / stride, index % stride);
        let mut sum = GroundPost::default();
        for (down, height) in KERNEL {
            let line = neighbor(row, down, rows) * columns;
            for (across, width) in KERNEL {
                add_weighted(&mut sum, &posts[line + neighbor(column, across, columns)], height * width);
            }
        }
        sum
    };
    let count = stride * size.rows as usize;
    let posts = (0..count).into_par_iter().with_min_len(1024).map(post).collect();
    Some(GroundLevel { size, posts })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn posts(size: PostCount, height: impl Fn(u32, u32) -> f32) -> Vec<GroundPost> {
        let post = |index: u32| GroundPost {
            height_m: height(index % size.columns, index / size.columns),
            ..GroundPost::default()
        };
        (0..size.columns * size.rows).map(post).collect()
    }

    #[test]
    fn levels_shrink_to_two_posts_a_side() {
        let sizes = |columns, rows| -> Vec<_> {
            let all = successors(Some(PostCount { columns, rows }), |size| size.halved());
            all.map(|size| (size.columns, size.rows)).collect()
        };
        assert_eq!(sizes(9, 4), [(9, 4), (5, 3), (3, 2), (2, 2)]);
        assert_eq!(sizes(1, 5), [(1, 5), (1, 3), (1, 2)]);
        assert_eq!(sizes(1, 1).len(), 1);
        assert!(sizes(u32::MAX, 2).len() <= 33);
    }

    #[test]
    fn a_plane_stays_a_plane_away_from_the_border() {
        let height = |column: u32, row: u32| column as f32 * 3.0 - row as f32;
        let from = PostCount { columns: 33, rows: 17 };
        let level = next_level(from, &posts(from, height)).expect("more than two posts a side");
        let plane = posts(level.size, |column, row| height(2 * column, 2 * row));
        for (index, (post, plane)) in (0..).zip(level.posts.iter().zip(&plane)) {
            let (column, row) = (index % level.size.columns, index / level.size.columns);
            if (1..level.size.columns - 1).contains(&column) && (1..level.size.rows - 1).contains(&row) {
                assert_eq!(post.height_m, plane.height_m, "{column}, {row}");
            }
        }
    }
}

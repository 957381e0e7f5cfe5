//! The coarser levels of a ground map, from which far ground is read.
//!
//! A picture of large ground reads no post of the finest levels: it is made with a map that begins at the level it shows
//! ([`level`]), and the finer ones pass by row by row.
//!
//! A far pixel spans many posts, and a single reading would make hillshade sparkle. Each level holds every second post
//! of the one before, smoothed (Williams 1983). `n` posts become `n / 2 + 1`, where texels would halve rounding down:
//! posts stay in place, so that the first post of every level is the map's first. The last post of a level may lie
//! past the map's border.

use std::iter::successors;
use std::ops::Range;

use rayon::prelude::*;

use crate::ground::{GroundMap, GroundPost};

/// The number of posts of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PostCount {
    /// Posts per row.
    pub columns: u32,
    /// Rows of posts.
    pub rows: u32,
}

/// Posts at twice the distance of the level before.
#[derive(Debug)]
pub struct GroundLevel {
    /// The number of posts.
    pub size: PostCount,
    /// The posts, row by row from the south-west.
    pub posts: Vec<GroundPost>,
}

impl PostCount {
    /// The posts of a map itself.
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
    let next = |size: PostCount, posts: &[GroundPost]| {
        size.halved()?;
        Some(level(size, 1, |row| posts[row * size.columns as usize..][..size.columns as usize].to_vec()))
    };
    successors(next(PostCount::from_map(map), &map.posts), move |level| next(level.size, &level.posts))
}

/// Level `number` over posts that `row` makes one row at a time, as [`coarser_levels`] would make it of all of them; 0 is
/// the posts themselves. Levels end at two posts a side.
///
/// Finer levels are never held: each thread keeps two rows a level.
pub fn level(size: PostCount, number: u32, row: impl Fn(usize) -> Vec<GroundPost> + Sync) -> GroundLevel {
    level_of_portions(size, number, |_| &row)
}

/// The same with rows that are prepared together: `portion` takes the numbers of those that one thread makes next, and returns what
/// makes each of them.
pub fn level_of_portions<R: Fn(usize) -> Vec<GroundPost>>(
    size: PostCount,
    number: u32,
    portion: impl Fn(Range<usize>) -> R + Sync,
) -> GroundLevel {
    /// Rows made together; those that two portions share are made twice.
    const PORTION: usize = 32;
    let sizes: Vec<PostCount> =
        successors(Some(size), |size| size.halved()).take(number as usize + 1).collect();
    let size = sizes[sizes.len() - 1];
    let (columns, rows) = (size.columns as usize, size.rows as usize);
    let mut posts: Vec<GroundPost> = bytemuck::zeroed_vec(columns * rows);
    // A thread that is done takes the next portion, one at a time.
    posts.par_chunks_mut(PORTION * columns).with_max_len(1).enumerate().for_each(|(at, posts)| {
        let wanted = at * PORTION..((at + 1) * PORTION).min(rows);
        let finer = sizes.iter().rev().skip(1);
        let row = portion(finer.fold(wanted.clone(), |rows, finer| finer_rows(&rows, *finer)));
        let made = rows_of(&sizes, wanted, &row);
        posts.chunks_exact_mut(columns).zip(made).for_each(|(posts, row)| posts.copy_from_slice(&row));
    });
    GroundLevel { size, posts }
}

/// The rows of a level of size `finer` that rows of the next coarser one are made of.
fn finer_rows(rows: &Range<usize>, finer: PostCount) -> Range<usize> {
    let last = finer.rows as usize - 1;
    (2 * rows.start).saturating_sub(1).min(last)..(2 * rows.end).min(last + 1)
}

/// The post `[column, row]` of the next coarser level, as [`coarser_levels`] makes it, from a level of `size` that `post`
/// returns.
pub fn coarser_post(
    size: PostCount,
    post: impl Fn([u32; 2]) -> GroundPost,
    [column, row]: [u32; 2],
) -> GroundPost {
    // Past the border the border's posts are repeated.
    let around = |at: u32, count: u32| {
        [(2 * at).saturating_sub(1), 2 * at, 2 * at + 1].map(|index| index.min(count - 1))
    };
    let columns = around(column, size.columns);
    let rows =
        around(row, size.rows).map(|row| smoothed(columns.map(|column| post([column, row])).each_ref()));
    smoothed(rows.each_ref())
}

/// Adds `weight` times `post`.
#[inline]
pub fn add_weighted(sum: &mut GroundPost, post: &GroundPost, weight: f32) {
    *sum = sum.zip_with(post, |sum, value| sum + value * weight);
}

/// Rows of the last of the levels of these sizes.
fn rows_of<'a>(
    sizes: &'a [PostCount],
    rows: Range<usize>,
    finest: &'a dyn Fn(usize) -> Vec<GroundPost>,
) -> Box<dyn Iterator<Item = Vec<GroundPost>> + 'a> {
    let (size, finer) = match sizes {
        [.., finer, size] => (size, finer),
        _ => return Box::new(rows.map(finest)),
    };
    // Post `i` is made of posts `2 i − 1`, `2 i` and `2 i + 1`; past the border the border's posts are repeated.
    let columns = size.columns as usize;
    let mut source = rows_of(&sizes[..sizes.len() - 1], finer_rows(&rows, *finer), finest)
        .map(move |row| halved_row(&row, columns));
    let mut before = None;
    Box::new(rows.map(move |row| {
        let south = before.take().or_else(|| if row > 0 { source.next() } else { None });
        let own = source.next();
        let north = source.next();
        let own = own.or_else(|| south.clone()).unwrap_or_default();
        let south = south.unwrap_or_else(|| own.clone());
        let north = north.unwrap_or_else(|| own.clone());
        let blend = |((south, own), north)| smoothed([south, own, north]);
        let row = south.iter().zip(&own).zip(&north).map(blend).collect();
        before = Some(north);
        row
    }))
}

/// Every second post of a row, smoothed along it.
fn halved_row(row: &[GroundPost], count: usize) -> Vec<GroundPost> {
    let at = |index: usize| &row[index.min(row.len() - 1)];
    (0..count)
        .map(|index| smoothed([at((2 * index).saturating_sub(1)), at(2 * index), at(2 * index + 1)]))
        .collect()
}

/// A post smoothed with its neighbors.
fn smoothed([before, own, after]: [&GroundPost; 3]) -> GroundPost {
    before
        .zip_with(after, |before, after| 0.25 * (before + after))
        .zip_with(own, |around, own| around + 0.5 * own)
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
    fn a_single_post_is_that_of_its_level() {
        for (columns, rows) in [(33, 17), (8, 5), (2, 9), (1, 6)] {
            let from = PostCount { columns, rows };
            let fine = posts(from, |column, row| ((column * 31 + row * 57) % 83) as f32);
            let row = |row: usize| fine[row * columns as usize..][..columns as usize].to_vec();
            let level = level(from, 1, row);
            for (index, post) in (0..).zip(&level.posts) {
                let at = [index % level.size.columns, index / level.size.columns];
                let fine = |[column, row]: [u32; 2]| fine[(row * columns + column) as usize];
                assert_eq!(coarser_post(from, fine, at), *post, "{at:?} of {:?}", level.size);
            }
        }
    }

    #[test]
    fn a_plane_stays_a_plane_away_from_the_border() {
        let height = |column: u32, row: u32| column as f32 * 3.0 - row as f32;
        let from = PostCount { columns: 33, rows: 17 };
        let fine = posts(from, height);
        let level = level(from, 1, |row| fine[row * 33..][..33].to_vec());
        let plane = posts(level.size, |column, row| height(2 * column, 2 * row));
        for (index, (post, plane)) in (0..).zip(level.posts.iter().zip(&plane)) {
            let (column, row) = (index % level.size.columns, index / level.size.columns);
            if (1..level.size.columns - 1).contains(&column) && (1..level.size.rows - 1).contains(&row) {
                assert_eq!(post.height_m, plane.height_m, "{column}, {row}");
            }
        }
    }
    #[test]
    fn a_level_made_at_once_is_that_made_of_the_level_before() {
        let height = |column: u32, row: u32| ((column * 7 + row * row * 3) % 31) as f32;
        for size in [(300, 77), (64, 129), (5, 1), (1, 9), (2, 2)] {
            let size = PostCount { columns: size.0, rows: size.1 };
            let columns = size.columns as usize;
            let map = GroundMap {
                columns: size.columns,
                rows: size.rows,
                posts: posts(size, height),
                ..GroundMap::level()
            };
            for (number, step_by_step) in (1..).zip(coarser_levels(&map)) {
                let at_once = level(size, number, |row| map.posts[row * columns..][..columns].to_vec());
                let asked = |rows: Range<usize>| {
                    let posts = &map.posts;
                    move |row: usize| {
                        assert!(rows.contains(&row), "{row} of {rows:?}");
                        posts[row * columns..][..columns].to_vec()
                    }
                };
                assert!(level_of_portions(size, number, asked).posts == at_once.posts);
                assert_eq!(at_once.size, step_by_step.size);
                assert!(at_once.posts == step_by_step.posts, "level {number} of {size:?}");
            }
        }
    }
}

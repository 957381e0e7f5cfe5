//! Depressions filled to their lowest rim, by the graph of their basins.
//!
//! Each post belongs to the pit that a walk to ever lower neighbors ends in, or to the outside, where the walk leaves the land
//! at its border or at a hole. Two basins meet at the lowest post of their common boundary. Joined from the lowest meeting
//! upwards (Kruskal 1956), a basin is filled to the height at which it joins the outside, and a post to that height or its
//! own: the surface of Priority-Flood (Barnes, Lehman and Mulla 2014), which is unique, without its queue of posts; basins
//! joined in this way are those of Cordonnier, Bovy and Braun (2019).
//!
//! Rows of the land that end where other land goes on are filled alike: each post of such an open row is the end of walks and a
//! way out of its own, so that a post is filled to the way out that it comes to lowest. What these are filled to is found from
//! the passes between them, as tiles are by Barnes (2016); see [`band_fill`](super::band_fill).

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::error::AnalysisError;
use sandtable_base::disjoint_sets::root;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::neighbors::neighbors;
use sandtable_terrain::stop_flag::StopFlag;

/// A value of a post is the number of its basin, not the post to which the walk goes on.
pub(super) const BASIN: u32 = 1 << 31;

/// The basin of all posts without data.
const NOTHING: u32 = u32::MAX;

/// The outside, as a basin.
pub(super) const OUTSIDE: u32 = BASIN;

/// No way out, as long as none is known.
const NO_WAY: u32 = u32::MAX;

/// Rows that one thread searches for meetings at a time.
const BAND_ROWS: usize = 64;

/// Entries of the memory of meetings that a band has told lately; a power of 2.
const LATELY: usize = 1 << 12;

/// A place where two basins meet: its height as a number that sorts alike, and the basins.
pub(super) type BasinMeeting = (u32, u32, u32);

/// Rows of land, and the basin of each of their posts.
pub(super) struct Basins<'a> {
    heights: &'a [f32],
    columns: usize,
    /// The basin of each post.
    of_post: Vec<u32>,
    /// The post in which each basin ends, from basin 1 on, row by row: a pit, or a post of an open row.
    pub ends: Vec<u32>,
}

/// To what basins are filled, and by which ways out.
pub(super) struct BasinFlood {
    /// The height to which each basin is filled before the water comes to its way out; of a way out none.
    pub levels: Vec<f32>,
    /// The way out of each basin, a basin.
    pub ways: Vec<u32>,
    /// Where ways out meet: of all meetings as many of the lowest as join them.
    pub passes: Vec<BasinMeeting>,
}

/// A height as a number that sorts alike.
pub(super) fn sortable(height_m: f32) -> u32 {
    let bits = (height_m + 0.0).to_bits();
    if bits >> 31 == 0 { bits | 0x8000_0000 } else { !bits }
}

/// The height of a number that sorts alike.
fn height_of(sortable: u32) -> f32 {
    f32::from_bits(if sortable >> 31 == 1 { sortable & 0x7fff_ffff } else { !sortable })
}

/// Refuses more posts than numbers of posts have room for, or than there is memory for.
///
/// # Errors
/// [`AnalysisError::Memory`].
pub(super) fn check_posts(posts: usize, bytes_each: u64) -> Result<(), AnalysisError> {
    let bytes = if posts < BASIN as usize { posts as u64 * bytes_each } else { u64::MAX };
    Ok(check_memory(bytes, "flow over the land", "take a smaller extent or wider posts")?)
}

/// The heights with depressions filled, meters; NaN without data. Posts at the border and beside holes are outlets.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn filled(heights: &[f32], columns: usize, stop: &StopFlag) -> Result<Vec<f32>, AnalysisError> {
    check_posts(heights.len(), 12)?;
    let basins = Basins::of(heights, columns, [false, false], stop)?;
    let mut is_way_out = vec![false; basins.ends.len() + 1];
    is_way_out[0] = true;
    let flood = basins.flood(&is_way_out);
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    Ok(basins.filled(&flood))
}

impl<'a> Basins<'a> {
    /// The basins of rows of land, of which the first and the last may be open: other land goes on beyond.
    ///
    /// # Errors
    /// [`AnalysisError::Stopped`].
    pub fn of(
        heights: &'a [f32],
        columns: usize,
        is_open: [bool; 2],
        stop: &StopFlag,
    ) -> Result<Self, AnalysisError> {
        let go_on = || if stop.is_stopped() { Err(AnalysisError::Stopped) } else { Ok(()) };
        let (basins, ends) = walks(heights, columns, is_open);
        go_on()?;
        basins.par_chunks(columns).enumerate().for_each(|(row, posts)| {
            (row * columns..row * columns + posts.len()).for_each(|index| end_walk(&basins, index));
        });
        go_on()?;
        let of_post = basins.into_iter().map(AtomicU32::into_inner).collect();
        Ok(Self { heights, columns, of_post, ends })
    }

    /// To what they are filled, where some basins are ways out.
    pub fn flood(&self, is_way_out: &[bool]) -> BasinFlood {
        flooded(meetings(self.heights, &self.of_post, self.columns), is_way_out)
    }

    /// The heights, filled on the way to the ways out.
    pub fn filled(&self, flood: &BasinFlood) -> Vec<f32> {
        let fill = |(&height, &basin): (&f32, &u32)| match basin {
            NOTHING => f32::NAN,
            _ => raised(height, flood.levels[(basin & !BASIN) as usize]),
        };
        self.heights.par_iter().zip(&self.of_post).with_min_len(1 << 14).map(fill).collect()
    }

    /// Whether the walk from a post ends outside.
    pub fn ends_outside(&self, index: usize) -> bool {
        self.of_post[index] == OUTSIDE
    }

    /// Something known of each basin, for each post; `nothing` without data.
    pub fn spread<T: Copy + Send + Sync>(&self, of_basin: &[T], nothing: T) -> Vec<T> {
        let of_post = |&basin: &u32| match basin {
            NOTHING => nothing,
            _ => of_basin[(basin & !BASIN) as usize],
        };
        self.of_post.par_iter().with_min_len(1 << 14).map(of_post).collect()
    }
}

/// A height that is filled to a level, if that is above it.
#[inline]
pub(super) fn raised(height: f32, level: f32) -> f32 {
    if level > height { level } else { height }
}

/// Where the walk from each post goes next, or the basin in which it ends, and the post of each basin.
fn walks(heights: &[f32], columns: usize, is_open: [bool; 2]) -> (Vec<AtomicU32>, Vec<u32>) {
    let rows = heights.len() / columns;
    let next: Vec<AtomicU32> = (0..heights.len()).into_par_iter().map(|_| AtomicU32::new(OUTSIDE)).collect();
    let ends: Vec<Vec<u32>> = (0..rows)
        .into_par_iter()
        .map(|row| {
            let first = row * columns;
            let own = &heights[first..first + columns];
            let next = &next[first..first + columns];
            for column in [0, columns - 1] {
                if own[column].is_nan() {
                    next[column].store(NOTHING, Ordering::Relaxed);
                }
            }
            let mut ends = Vec::new();
            if row == 0 || row == rows - 1 {
                for (next, _) in next.iter().zip(own).filter(|(_, height)| height.is_nan()) {
                    next.store(NOTHING, Ordering::Relaxed);
                }
                if is_open[usize::from(row != 0)] {
                    let is_inner = |&index: &usize| {
                        neighbors(index, columns, rows).all(|(_, other)| !heights[other].is_nan())
                    };
                    let inner = first + 1..first + columns - 1;
                    ends.extend(
                        inner
                            .filter(|&index| !heights[index].is_nan())
                            .filter(is_inner)
                            .map(|index| index as u32),
                    );
                }
                return ends;
            }
            let (south, north) = (&heights[first - columns..first], &heights[first + columns..][..columns]);
            for column in 1..columns - 1 {
                let height = own[column];
                if height.is_nan() {
                    next[column].store(NOTHING, Ordering::Relaxed);
                    continue;
                }
                // In the order of their numbers, so that the first of equals has the least.
                let around = [
                    south[column - 1],
                    south[column],
                    south[column + 1],
                    own[column - 1],
                    own[column + 1],
                    north[column - 1],
                    north[column],
                    north[column + 1],
                ];
                // Heights are finite, so that their sum is NaN where one of them is.
                if around.iter().sum::<f32>().is_nan() {
                    continue;
                }
                let (mut lowest, mut at) = (around[0], 0);
                for (other, &beside) in around.iter().enumerate().skip(1) {
                    if beside < lowest {
                        (lowest, at) = (beside, other);
                    }
                }
                let index = first + column;
                let is_walk = lowest < height || (lowest == height && at < 4);
                if is_walk {
                    let to = match at {
                        0..=2 => index - columns + at - 1,
                        3 => index - 1,
                        4 => index + 1,
                        _ => index + columns + at - 6,
                    };
                    next[column].store(to as u32, Ordering::Relaxed);
                } else {
                    ends.push(index as u32);
                }
            }
            ends
        })
        .collect();
    let ends = ends.concat();
    for (end, basin) in ends.iter().zip(1..) {
        next[*end as usize].store(BASIN | basin, Ordering::Relaxed);
    }
    (next, ends)
}

/// Finds the basin of a post, and of all on its walk. Threads that meet write the same.
pub(super) fn end_walk(basins: &[AtomicU32], start: usize) {
    let get = |at: usize| basins[at].load(Ordering::Relaxed);
    let first = get(start);
    if first & BASIN != 0 {
        return;
    }
    let mut basin = first;
    while basin & BASIN == 0 {
        basin = get(basin as usize);
    }
    let mut at = start;
    loop {
        let to = get(at);
        if to & BASIN != 0 {
            return;
        }
        basins[at].store(basin, Ordering::Relaxed);
        at = to as usize;
    }
}

/// Where basins meet; some pairs more than once, their lowest meeting among them.
fn meetings(heights: &[f32], basins: &[u32], columns: usize) -> Vec<BasinMeeting> {
    let rows = heights.len() / columns;
    let bands: Vec<usize> = (0..rows).step_by(BAND_ROWS).collect();
    let of_band = |&first: &usize| {
        let mut lately = vec![(u32::MAX, 0, 0); LATELY];
        let mut told: Vec<BasinMeeting> = Vec::new();
        let mut meet = |one: usize, other: usize| {
            let (a, b) = (basins[one], basins[other]);
            if a == b || a == NOTHING || b == NOTHING {
                return;
            }
            let (a, b) = (a.min(b), a.max(b));
            let height = sortable(heights[one].max(heights[other]));
            let slot = (a.wrapping_mul(0x9e37_79b1) ^ b.wrapping_mul(0x85eb_ca77)) >> 20;
            let known = &mut lately[slot as usize % LATELY];
            if (known.1, known.2) == (a, b) && known.0 <= height {
                return;
            }
            *known = (height, a, b);
            told.push((height, a, b));
        };
        for row in first..(first + BAND_ROWS).min(rows) {
            let has_north = row + 1 < rows;
            for column in 0..columns {
                let index = row * columns + column;
                let has_east = column + 1 < columns;
                if has_east {
                    meet(index, index + 1);
                }
                if has_north {
                    meet(index, index + columns);
                    if has_east {
                        meet(index, index + columns + 1);
                        meet(index + 1, index + columns);
                    }
                }
            }
        }
        told
    };
    bands.par_iter().map(of_band).collect::<Vec<_>>().concat()
}

/// To what basins are filled that meet so, where some are ways out, the outside among them: each to the lowest height at which
/// it is joined to one.
pub(super) fn flooded(mut meetings: Vec<BasinMeeting>, is_way_out: &[bool]) -> BasinFlood {
    meetings.par_sort_unstable();
    let count = is_way_out.len() as u32;
    let mut levels = vec![f32::NEG_INFINITY; is_way_out.len()];
    let way = |basin: u32| if is_way_out[basin as usize] { basin } else { NO_WAY };
    let mut ways: Vec<u32> = (0..count).map(way).collect();
    // Basins without a way out that were joined; and ways out that meet.
    let mut parents: Vec<u32> = (0..count).collect();
    let mut joined = parents.clone();
    let mut passes = Vec::new();
    for (height, a, b) in meetings {
        let (a, b) = (root(&mut parents, a & !BASIN), root(&mut parents, b & !BASIN));
        match (ways[a as usize], ways[b as usize]) {
            (NO_WAY, NO_WAY) => parents[a as usize] = b,
            // Basins with a way out are not joined to each other: each joined basin below one has its level.
            (NO_WAY, way) => (ways[a as usize], levels[a as usize]) = (way, height_of(height)),
            (way, NO_WAY) => (ways[b as usize], levels[b as usize]) = (way, height_of(height)),
            (one, other) if one == other => {}
            (one, other) => {
                let (first, second) = (root(&mut joined, one), root(&mut joined, other));
                if first != second {
                    joined[first as usize] = second;
                    passes.push((height, one, other));
                }
            }
        }
    }
    let roots: Vec<u32> = (0..count).map(|basin| root(&mut parents, basin)).collect();
    BasinFlood {
        levels: roots.iter().map(|&basin| levels[basin as usize]).collect(),
        ways: roots.iter().map(|&basin| ways[basin as usize]).collect(),
        passes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cmp::Reverse;
    use std::collections::BinaryHeap;

    use crate::test_land::{noise, on_pool};
    use sandtable_terrain::neighbors::neighbors;

    /// Priority-Flood as it is published, with one queue.
    fn flooded(heights: &[f32], columns: usize) -> Vec<f32> {
        let rows = heights.len() / columns;
        let mut filled = vec![f32::NAN; heights.len()];
        let mut queue = BinaryHeap::new();
        for index in (0..heights.len()).filter(|&index| !heights[index].is_nan()) {
            let around: Vec<usize> = neighbors(index, columns, rows).map(|(_, other)| other).collect();
            if around.len() < 8 || around.iter().any(|&other| heights[other].is_nan()) {
                filled[index] = heights[index];
                queue.push(Reverse((sortable(heights[index]), index)));
            }
        }
        while let Some(Reverse((_, index))) = queue.pop() {
            for (_, other) in neighbors(index, columns, rows) {
                if filled[other].is_nan() && !heights[other].is_nan() {
                    filled[other] = heights[other].max(filled[index]);
                    queue.push(Reverse((sortable(filled[other]), other)));
                }
            }
        }
        filled
    }

    #[test]
    fn basins_fill_to_the_surface_of_a_priority_flood() {
        for (columns, rows) in [(2, 2), (2, 9), (3, 3), (9, 3), (40, 33), (150, 130)] {
            for (seed, steps, holes) in [(1, 3, false), (2, 12, true), (3, 100_000, false), (4, 5, true)] {
                let heights = noise(columns * rows, seed, steps, holes);
                let found = filled(&heights, columns, &StopFlag::default()).expect("filled");
                let wanted = flooded(&heights, columns);
                let bits =
                    |heights: &[f32]| heights.iter().map(|height| height.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&found), bits(&wanted), "{columns} x {rows}, seed {seed}");
            }
        }
    }

    #[test]
    fn nothing_but_holes_is_filled_with_nothing() {
        let found = filled(&[f32::NAN; 12], 4, &StopFlag::default()).expect("filled");
        assert!(found.iter().all(|height| height.is_nan()));
    }

    #[test]
    fn one_thread_fills_like_three() {
        let heights = noise(300 * 200, 9, 40, true);
        let fill = || filled(&heights, 300, &StopFlag::default()).expect("filled");
        let bits = |heights: Vec<f32>| heights.iter().map(|height| height.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(on_pool(1, fill)), bits(on_pool(3, fill)));
    }
}

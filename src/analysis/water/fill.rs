//! Depressions filled to their lowest rim, by the graph of their basins.
//!
//! Each post belongs to the pit that a walk to ever lower neighbors ends in, or to the outside, where the walk leaves the land
//! at its border or at a hole. Two basins meet at the lowest post of their common boundary. Joined from the lowest meeting
//! upwards (Kruskal 1956), a basin is filled to the height at which it joins the outside, and a post to that height or its
//! own: the surface of Priority-Flood (Barnes, Lehman and Mulla 2014), which is unique, without its queue of posts; basins
//! joined in this way are those of Cordonnier, Bovy and Braun (2019).

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::error::AnalysisError;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::stop_flag::StopFlag;

/// A value of a post is the number of its basin, not the post to which the walk goes on.
const BASIN: u32 = 1 << 31;

/// The basin of all posts without data.
const NOTHING: u32 = u32::MAX;

/// The outside, as a basin.
const OUTSIDE: u32 = BASIN;

/// Rows that one thread searches for meetings at a time.
const BAND_ROWS: usize = 64;

/// Entries of the memory of meetings that a band has told lately; a power of 2.
const LATELY: usize = 1 << 12;

/// A place where two basins meet: its height as a number that sorts alike, and the basins.
type BasinMeeting = (u32, u32, u32);

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
    let go_on = || if stop.is_stopped() { Err(AnalysisError::Stopped) } else { Ok(()) };
    let (basins, pits) = walks(heights, columns);
    go_on()?;
    basins.par_chunks(columns).enumerate().for_each(|(row, posts)| {
        (row * columns..row * columns + posts.len()).for_each(|index| end_walk(&basins, index));
    });
    go_on()?;
    let basins: Vec<u32> = basins.into_iter().map(AtomicU32::into_inner).collect();
    let levels = levels(meetings(heights, &basins, columns), pits);
    go_on()?;
    let fill = |(&height, &basin): (&f32, &u32)| match basin {
        NOTHING => f32::NAN,
        _ => {
            let level = levels[(basin & !BASIN) as usize];
            if level > height { level } else { height }
        }
    };
    Ok(heights.par_iter().zip(&basins).with_min_len(1 << 14).map(fill).collect())
}

/// Where the walk from each post goes next, or the basin in which it ends, and the number of pits.
fn walks(heights: &[f32], columns: usize) -> (Vec<AtomicU32>, u32) {
    let rows = heights.len() / columns;
    let next: Vec<AtomicU32> = (0..heights.len()).into_par_iter().map(|_| AtomicU32::new(OUTSIDE)).collect();
    let pits: Vec<Vec<u32>> = (0..rows)
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
            let mut pits = Vec::new();
            if row == 0 || row == rows - 1 {
                for (next, _) in next.iter().zip(own).filter(|(_, height)| height.is_nan()) {
                    next.store(NOTHING, Ordering::Relaxed);
                }
                return pits;
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
                    pits.push(index as u32);
                }
            }
            pits
        })
        .collect();
    let mut count = 0;
    for pit in pits.into_iter().flatten() {
        count += 1;
        next[pit as usize].store(BASIN | count, Ordering::Relaxed);
    }
    (next, count)
}

/// Finds the basin of a post, and of all on its walk. Threads that meet write the same.
fn end_walk(basins: &[AtomicU32], start: usize) {
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

/// The height to which each basin is filled, the outside first, which is filled to none.
fn levels(mut meetings: Vec<BasinMeeting>, pits: u32) -> Vec<f32> {
    meetings.par_sort_unstable();
    let mut levels = vec![f32::NEG_INFINITY; pits as usize + 1];
    let mut parents: Vec<u32> = (0..=pits).collect();
    let mut is_outside = vec![false; pits as usize + 1];
    is_outside[0] = true;
    let mut root = |mut at: u32, joined: Option<u32>| {
        while parents[at as usize] != at {
            parents[at as usize] = parents[parents[at as usize] as usize];
            at = parents[at as usize];
        }
        if let Some(to) = joined {
            parents[at as usize] = to;
        }
        at
    };
    for (height, a, b) in meetings {
        let (a, b) = (root(a & !BASIN, None), root(b & !BASIN, None));
        match (is_outside[a as usize], is_outside[b as usize]) {
            (true, true) => {}
            // Basins that are outside are not joined to each other: each joined basin below one has its level.
            (true, false) => (is_outside[b as usize], levels[b as usize]) = (true, height_of(height)),
            (false, true) => (is_outside[a as usize], levels[a as usize]) = (true, height_of(height)),
            (false, false) => {
                root(a, Some(b));
            }
        }
    }
    (0..=pits).map(|basin| levels[root(basin, None) as usize]).collect()
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

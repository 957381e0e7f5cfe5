//! Where each post of filled ground drains to, in eight directions, and across flats.
//!
//! A post drains to the neighbor to which the ground falls most steeply (O'Callaghan and Mark 1984), the first from the east
//! counter-clockwise where several are alike. A post without a lower neighbor lies in a flat, where it drains away from
//! higher ground and toward lower ground (Barnes, Lehman and Mulla 2014b): with `a` posts to the flat's nearest higher
//! ground and `d` to its nearest outlet, water goes where 2d − a is least, to a side neighbor before a diagonal one. Their
//! mask is 2d + (A − a) with the flat's greatest `a` as A, which all posts of a flat share, so that it needs no labels.

use glam::DVec2;
use rayon::prelude::*;

use super::fill::check_posts;
use crate::error::AnalysisError;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::{STEPS, neighbors};
use sandtable_terrain::stop_flag::StopFlag;

/// The direction of a post that drains off the land.
pub(crate) const OFF: u8 = 0;

/// The direction of a post without data. Directions from 1 to 8 are those of [`STEPS`], from the east counter-clockwise.
pub(crate) const NO_DIRECTION: u8 = 255;

/// A post in a flat, until its direction is found.
pub(super) const FLAT: u8 = 254;

/// Added to masks, so that none is below 0; a mask without it is no farther from 0 than twice the posts of the land.
const MASK_ZERO: i64 = 1 << 32;

/// Posts that a thread takes at a time.
pub(super) const SHARE: usize = 1 << 12;

/// The distances from one post to its neighbors in meters, in the order of [`STEPS`].
pub(super) fn runs_m(cell: DVec2) -> [f64; 8] {
    STEPS.map(|(east, north)| (cell * DVec2::new(east as f64, north as f64)).length())
}

/// The direction in which each post of filled ground drains.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn directions(
    ground: &Lattice,
    filled_m: &[f32],
    stop: &StopFlag,
) -> Result<Vec<u8>, AnalysisError> {
    check_posts(filled_m.len(), 9)?;
    stop.did(1);
    let columns = ground.columns() as usize;
    let mut codes = vec![NO_DIRECTION; filled_m.len()];
    let flats = fall_lines(ground.cell(), filled_m, columns, &mut codes);
    stop.did(1);
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    if !flats.is_empty() {
        let rows = ground.rows() as usize;
        across_flats(filled_m, (columns, rows), &flats, &mut codes, stop)?;
    }
    Ok(codes)
}

/// The directions of posts with a lower neighbor, and of those that drain off the land; the others are told.
pub(super) fn fall_lines(cell: DVec2, heights: &[f32], columns: usize, codes: &mut [u8]) -> Vec<u32> {
    let rows = heights.len() / columns;
    let per_m = runs_m(cell).map(|run_m| 1.0 / run_m);
    let of_row = |(row, codes): (usize, &mut [u8])| {
        let first = row * columns;
        let own = &heights[first..first + columns];
        let mut flats = Vec::new();
        let is_border = row == 0 || row == rows - 1;
        let at_border = |column: usize, code: &mut u8| {
            let index = first + column;
            if heights[index].is_nan() {
                return;
            }
            let mut steepest = (0.0, OFF);
            for (step, other) in neighbors(index, columns, rows) {
                let fall = (f64::from(heights[index]) - f64::from(heights[other])) * per_m[step];
                if fall > steepest.0 {
                    steepest = (fall, step as u8 + 1);
                }
            }
            *code = steepest.1;
        };
        if is_border {
            codes.iter_mut().enumerate().for_each(|(column, code)| at_border(column, code));
            return flats;
        }
        at_border(0, &mut codes[0]);
        at_border(columns - 1, &mut codes[columns - 1]);
        let (south, north) = (&heights[first - columns..first], &heights[first + columns..][..columns]);
        for column in 1..columns - 1 {
            let height = own[column];
            if height.is_nan() {
                continue;
            }
            let around = [
                own[column + 1],
                north[column + 1],
                north[column],
                north[column - 1],
                own[column - 1],
                south[column - 1],
                south[column],
                south[column + 1],
            ];
            // The lowest of each pair of equal distance, the first of equals; the steepest of the lowest.
            let lower = |one: usize, other: usize| if around[other] < around[one] { other } else { one };
            let fall = |step: usize| (f64::from(height) - f64::from(around[step])) * per_m[step];
            let is_hole_beside = around.iter().sum::<f32>().is_nan();
            let (mut steepest, mut code) = (0.0, 0);
            let mut take = |step: usize| {
                let fall = fall(step);
                if fall > steepest || (fall == steepest && fall > 0.0 && step < code as usize) {
                    (steepest, code) = (fall, step as u8 + 1);
                }
            };
            if is_hole_beside {
                (0..8).for_each(&mut take);
            } else {
                take(lower(0, 4));
                take(lower(2, 6));
                let (first, second) = (lower(1, 3), lower(5, 7));
                take(lower(first, second));
            }
            codes[column] = match (code, is_hole_beside) {
                (0, true) => OFF,
                (0, false) => {
                    flats.push((first + column) as u32);
                    FLAT
                }
                _ => code,
            };
        }
        flats
    };
    codes.par_chunks_mut(columns).enumerate().map(of_row).collect::<Vec<_>>().concat()
}

/// Gives the posts of flats their directions.
fn across_flats(
    heights: &[f32],
    (columns, rows): (usize, usize),
    flats: &[u32],
    codes: &mut [u8],
    stop: &StopFlag,
) -> Result<(), AnalysisError> {
    let around = |index: u32| neighbors(index as usize, columns, rows);
    let picked = |is_one: &(dyn Fn(u32) -> bool + Sync)| -> Vec<u32> {
        let of_share = |share: &[u32]| share.iter().copied().filter(|&index| is_one(index)).collect();
        flats.par_chunks(SHARE).map(of_share).collect::<Vec<Vec<u32>>>().concat()
    };
    // Numbers of posts to higher ground, from 1 on; 0 where a flat has none.
    let mut away = vec![0_u32; heights.len()];
    let edge = picked(&|index| around(index).any(|(_, other)| heights[other] > heights[index as usize]));
    spread(edge, stop, |index, distance, next| {
        if away[index as usize] != 0 {
            return;
        }
        away[index as usize] = distance;
        next.extend(
            around(index)
                .filter(|&(_, other)| codes[other] == FLAT && away[other] == 0)
                .map(|(_, other)| other as u32),
        );
    })?;
    // Masks, in place of the distances where they are known.
    let mut is_masked = vec![false; heights.len()];
    let is_outlet = |index: u32, other: usize| codes[other] <= 8 && heights[other] == heights[index as usize];
    let edge = picked(&|index| around(index).any(|(_, other)| is_outlet(index, other)));
    let mut masks = away;
    spread(edge, stop, |index, distance, next| {
        if is_masked[index as usize] {
            return;
        }
        is_masked[index as usize] = true;
        let mask = &mut masks[index as usize];
        *mask = flat_mask(distance, *mask);
        next.extend(
            around(index)
                .filter(|&(_, other)| codes[other] == FLAT && !is_masked[other])
                .map(|(_, other)| other as u32),
        );
    })?;
    let direction = |&index: &u32| {
        let rated = |other: usize| match codes[other] {
            FLAT => Some(FlatRank::Flat(masks[other])),
            _ => is_outlet(index, other).then_some(FlatRank::Outlet),
        };
        direction_on_flat(around(index), rated)
    };
    let found: Vec<u8> = flats.par_iter().with_min_len(SHARE).map(direction).collect();
    for (&index, code) in flats.iter().zip(found) {
        codes[index as usize] = code;
    }
    Ok(())
}

/// What a neighbor of a post in a flat is.
pub(super) enum FlatRank {
    /// An outlet of the flat.
    Outlet,
    /// A post of the flat, with its mask.
    Flat(u32),
}

/// The mask of a post of a flat: where it is least, water goes. `toward` is the number of posts to the nearest outlet, `away`
/// that to the nearest higher ground, 0 where there is none.
pub(super) fn flat_mask(toward: u32, away: u32) -> u32 {
    toward.wrapping_mul(2).wrapping_sub(away)
}

/// The direction of a post of a flat, by the ranks of its neighbors; those without one are no way.
pub(super) fn direction_on_flat(
    around: impl Iterator<Item = (usize, usize)>,
    rank: impl Fn(usize) -> Option<FlatRank>,
) -> u8 {
    let value = |rank| match rank {
        FlatRank::Outlet => 0,
        FlatRank::Flat(mask) => MASK_ZERO + i64::from(mask.cast_signed()),
    };
    let rated = around.filter_map(|(step, other)| Some((value(rank(other)?), step % 2, step)));
    rated.min().map_or(OFF, |(_, _, step)| step as u8 + 1)
}

/// Spreads from the posts of an edge, at distance 1, one step after another; `reach` tells a post's neighbors.
fn spread(
    edge: Vec<u32>,
    stop: &StopFlag,
    mut reach: impl FnMut(u32, u32, &mut Vec<u32>),
) -> Result<(), AnalysisError> {
    let (mut now, mut next) = (edge, Vec::new());
    let mut distance = 1;
    while !now.is_empty() {
        if stop.is_stopped() {
            return Err(AnalysisError::Stopped);
        }
        now.drain(..).for_each(|index| reach(index, distance, &mut next));
        std::mem::swap(&mut now, &mut next);
        distance += 1;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::{bare, noise, on_pool};
    use crate::water::fill::filled;
    use std::collections::BTreeMap;

    fn drained(columns: u32, heights: &[f32]) -> Vec<u8> {
        let land = bare((DVec2::ZERO, DVec2::splat(10.0)), columns, heights.to_vec());
        let filled_m = filled(heights, columns as usize, &StopFlag::default()).expect("filled");
        directions(&land.ground, &filled_m, &StopFlag::default()).expect("drained")
    }

    #[test]
    fn a_flat_drains_away_from_higher_and_toward_lower_ground() {
        // A flat of 5 × 5 posts in a bowl with one outlet in the south, the first row.
        #[rustfmt::skip]
        let heights = [
            9., 9., 9., 9., 1., 9., 9.,
            9., 5., 5., 5., 5., 5., 9.,
            9., 5., 5., 5., 5., 5., 9.,
            9., 5., 5., 5., 5., 5., 9.,
            9., 5., 5., 5., 5., 5., 9.,
            9., 5., 5., 5., 5., 5., 9.,
            9., 9., 9., 9., 9., 9., 9.,
        ];
        let codes = drained(7, &heights);
        let row = |row: usize| &codes[row * 7 + 1..row * 7 + 6];
        // By hand, 2d − a from row 1 on: 3 1 · · ·, 3 0 0 0 1, 3 2 1 2 3, 5 4 4 4 5, 7 7 7 7 7; those marked · fall to the outlet.
        assert_eq!(row(1), [2, 1, 8, 7, 6]);
        assert_eq!(row(2), [1, 8, 7, 7, 7]);
        assert_eq!(row(3), [8, 7, 7, 7, 6]);
        assert_eq!(row(4), [8, 8, 7, 6, 6]);
        assert_eq!(row(5), [8, 7, 7, 7, 6]);
    }

    /// The published algorithm, with labels and each flat's greatest distance from higher ground.
    fn published(heights: &[f32], columns: usize, first: &[u8]) -> BTreeMap<usize, i64> {
        let rows = heights.len() / columns;
        let around = |index: usize| neighbors(index, columns, rows).map(|(_, other)| other);
        let is_flat = |index: usize| first[index] == FLAT;
        let grow = |edge: Vec<usize>| {
            let mut distances = BTreeMap::new();
            let (mut now, mut distance) = (edge, 1_i64);
            while !now.is_empty() {
                let mut next = Vec::new();
                for index in now {
                    if let std::collections::btree_map::Entry::Vacant(entry) = distances.entry(index) {
                        entry.insert(distance);
                        next.extend(around(index).filter(|&other| is_flat(other)));
                    }
                }
                (now, distance) = (next, distance + 1);
            }
            distances
        };
        let flats: Vec<usize> = (0..heights.len()).filter(|&index| is_flat(index)).collect();
        let high = flats.iter().copied().filter(|&at| around(at).any(|other| heights[other] > heights[at]));
        let low = flats
            .iter()
            .copied()
            .filter(|&at| around(at).any(|other| first[other] <= 8 && heights[other] == heights[at]));
        let (away, toward) = (grow(high.collect()), grow(low.collect()));
        // The greatest distance of a connected flat.
        let mut greatest: BTreeMap<usize, i64> = BTreeMap::new();
        for &start in &flats {
            if greatest.contains_key(&start) {
                continue;
            }
            let (mut members, mut at) = (vec![start], 0);
            while at < members.len() {
                for other in around(members[at]).filter(|&other| is_flat(other)).collect::<Vec<_>>() {
                    if !members.contains(&other) {
                        members.push(other);
                    }
                }
                at += 1;
            }
            let most = members.iter().filter_map(|index| away.get(index)).max().copied().unwrap_or(0);
            members.into_iter().for_each(|index| {
                greatest.insert(index, most);
            });
        }
        flats
            .into_iter()
            .map(|index| {
                let from_high = away.get(&index).map_or(0, |distance| greatest[&index] - distance);
                (index, from_high + 2 * (toward[&index] + 1))
            })
            .collect()
    }

    #[test]
    fn flats_drain_down_the_mask_that_was_published() {
        for (seed, steps) in [(3, 2), (4, 3), (5, 6)] {
            let (columns, rows) = (31, 27);
            let raw = noise(columns * rows, seed, steps, true);
            let heights = filled(&raw, columns, &StopFlag::default()).expect("filled");
            let mut first = vec![NO_DIRECTION; heights.len()];
            let flats = fall_lines(DVec2::splat(10.0), &heights, columns, &mut first);
            assert!(flats.len() > 50, "{} posts in flats", flats.len());
            let masks = published(&heights, columns, &first);
            let codes = drained(columns as u32, &raw);
            for &index in &flats {
                let index = index as usize;
                let mask = |other: usize| match masks.get(&other) {
                    Some(&mask) => mask,
                    None => 2,
                };
                let level = |&(_, other): &(usize, usize)| {
                    heights[other] == heights[index] && first[other] != NO_DIRECTION
                };
                let least = neighbors(index, columns, rows).filter(level).map(|(_, other)| mask(other)).min();
                let to = neighbors(index, columns, rows).find(|(step, _)| *step + 1 == codes[index] as usize);
                let (_, to) = to.expect("a direction");
                assert_eq!(Some(mask(to)), least, "post {index}, seed {seed}");
                assert!(mask(to) < mask(index));
            }
        }
    }

    #[test]
    fn one_thread_finds_the_directions_of_three() {
        let heights = noise(200 * 150, 8, 4, true);
        assert_eq!(on_pool(1, || drained(200, &heights)), on_pool(3, || drained(200, &heights)));
    }
}

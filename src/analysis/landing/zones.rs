//! Helicopter landing points: a flat, clear touchdown disk with a clear way in and out (FM 3-21.38, chapter 4).
//! `zone_sites` says of the best of them what a pilot needs.

use std::sync::atomic::{AtomicU8, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use super::disk::DiskRows;
use super::suitability::{
    LOW_M, SuitedSlopes, code_raster, cover_at, hindrances, is_low_and_dry, is_suited, suited_ground,
};
use super::zone_sites::{ApproachGround, SiteSearch};
use crate::apart::first_apart;
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::{Land, LandCover};
use crate::outcome::{Outcome, PostValues};
use sandtable_terrain::stop_flag::StopFlag;

/// Steps by column and row to the neighbors, clockwise from the north; the opposite of `n` is `n + 4`.
pub(super) const HEADINGS: [(i64, i64); 8] =
    [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)];

/// The diameter in meters of a touchdown disk of size 1 to 7.
fn diameter_m(size: &str) -> f64 {
    match size {
        "1" => 25.0,
        "2" => 35.0,
        "3" => 50.0,
        "4" => 80.0,
        "5" => 100.0,
        "6" => 125.0,
        _ => 150.0,
    }
}

/// Codes of each post as the center of a touchdown disk, and the best separated sites.
///
/// # Errors
/// An argument where the slope without limit is above the slope with caution; [`AnalysisError::Stopped`].
pub(crate) fn landing_zones(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let limits = SuitedSlopes::of(arguments)?;
    let ground = &*land.ground;
    let (columns, rows, cell) = (ground.columns() as usize, ground.rows() as usize, ground.cell());
    let diameter = diameter_m(&arguments.word("size"));
    // Where posts lie farther apart than the disk is wide, the ground beside a post is judged by the posts beside it.
    let radius_m = (diameter / 2.0).max(cell.max_element());
    let disk = DiskRows::new(radius_m, cell, columns.max(rows));
    let slopes = hindrances(ground, limits.free, |index| fitness(land, index));
    let greatest = disk.maxima(&slopes, columns, f32::INFINITY);
    drop(slopes);
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    let tops = tops(land, &disk);
    let length_m = arguments.number("approach_m");
    let headings = clear_headings(land, &tops, arguments.number("obstacle_ratio"), length_m);
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    let code = |index: usize| {
        if ground.heights()[index].is_nan() {
            PostValues::NO_CODE
        } else if greatest[index] > limits.greatest || axes(headings[index]).next().is_none() {
            0
        } else if greatest[index] > limits.free {
            1
        } else {
            2
        }
    };
    let codes: Vec<u8> = (0..greatest.len()).into_par_iter().map(code).collect();
    let mut order: Vec<u32> =
        (0..codes.len() as u32).filter(|&index| is_suited(codes[index as usize])).collect();
    let suited = order.len();
    order
        .par_sort_unstable_by(|&a, &b| greatest[a as usize].total_cmp(&greatest[b as usize]).then(a.cmp(&b)));
    let (count, apart) = (arguments.number("count") as usize, diameter + arguments.number("separation_m"));
    let at =
        |index: u32| DVec2::new(f64::from(index % columns as u32), f64::from(index / columns as u32)) * cell;
    let sites = first_apart(&order, count, apart, at);
    let search = SiteSearch {
        land,
        codes: &codes,
        headings: &headings,
        approach: ApproachGround { tops: &tops, length_m },
        disk: &disk,
        size: arguments.word("size"),
        diameter_m: diameter,
    };
    let (features, table) = search.zones(&sites);
    Ok(Outcome {
        raster: Some(code_raster("landing", codes)),
        features,
        tables: vec![table],
        figures: vec![suited_ground(ground, suited)],
        ..Outcome::default()
    })
}

/// How what covers a post suits a touchdown disk: 2 well, 1 with caution, 0 not.
fn fitness(land: &Land, index: usize) -> u8 {
    if !is_low_and_dry(land, index) {
        return 0;
    }
    match cover_at(land, index) {
        LandCover::Unknown | LandCover::Open | LandCover::Paved => 2,
        LandCover::Crops | LandCover::Scrub | LandCover::Sand | LandCover::Rock => 1,
        LandCover::Orchard
        | LandCover::Wood
        | LandCover::Wetland
        | LandCover::BuiltUp
        | LandCover::Building => 0,
    }
}

/// The highest top of ground and what stands on it in the disk around each post; minus infinity without data.
fn tops(land: &Land, disk: &DiskRows) -> Vec<f32> {
    let heights = land.ground.heights();
    let top = |index: usize| match heights[index] {
        height if height.is_nan() => f32::NEG_INFINITY,
        height => height + land.obstacles_m.as_ref().map_or(0.0, |obstacles| obstacles[index].max(0.0)),
    };
    let tops: Vec<f32> = (0..heights.len()).into_par_iter().map(top).collect();
    disk.maxima(&tops, land.ground.columns() as usize, f32::NEG_INFINITY)
}

/// For each post, a bit for each heading in which a lane as wide as the disk is clear: at `t` meters from the disk,
/// nothing in the lane is higher above the center than `t` over `ratio` and what may stand in the disk. `tops` are the
/// highest in the disk around each post.
fn clear_headings(land: &Land, tops: &[f32], ratio: f64, length_m: f64) -> Vec<u8> {
    let ground = &*land.ground;
    let (columns, rows, cell) = (ground.columns() as usize, ground.rows() as usize, ground.cell());
    let heights = ground.heights();
    let bits: Vec<AtomicU8> = (0..heights.len()).map(|_| AtomicU8::new(0)).collect();
    for (bit, (east, north)) in HEADINGS.into_iter().enumerate() {
        let step = DVec2::new(east as f64 * cell.x, north as f64 * cell.y).length();
        let reach = (length_m / step) as usize;
        let rise = (step / ratio) as f32;
        let inside = |(column, row): (i64, i64)| {
            (0..columns as i64).contains(&column) && (0..rows as i64).contains(&row)
        };
        // A lane's line begins at the far end, where one step further leaves the land.
        let (edge_column, edge_row) =
            (if east > 0 { columns as i64 - 1 } else { 0 }, if north > 0 { rows as i64 - 1 } else { 0 });
        let mut ends: Vec<(i64, i64)> = Vec::new();
        if north != 0 {
            ends.extend((0..columns as i64).map(|column| (column, edge_row)));
        }
        if east != 0 {
            let is_corner = |row: i64| north != 0 && row == edge_row;
            ends.extend((0..rows as i64).filter(|&row| !is_corner(row)).map(|row| (edge_column, row)));
        }
        ends.into_par_iter().for_each_init(Vec::new, |queue: &mut Vec<(usize, f32)>, end| {
            queue.clear();
            let (mut head, mut at, mut index) = (0, end, 0_usize);
            while inside(at) {
                let post = at.1 as usize * columns + at.0 as usize;
                while queue.get(head).is_some_and(|&(far, _)| far + reach < index) {
                    head += 1;
                }
                let travelled = |(far, top): (usize, f32)| top - (index - far) as f32 * rise;
                let highest = queue.get(head).map_or(f32::NEG_INFINITY, |&entry| travelled(entry));
                if highest <= heights[post] + LOW_M {
                    bits[post].fetch_or(1 << bit, Ordering::Relaxed);
                }
                while queue.len() > head && queue.last().is_some_and(|&last| travelled(last) <= tops[post]) {
                    queue.pop();
                }
                queue.push((index, tops[post]));
                at = (at.0 - east, at.1 - north);
                index += 1;
            }
        });
    }
    bits.into_iter().map(AtomicU8::into_inner).collect()
}

/// The headings from 0 to 3 that are clear with their opposites: a way in and a way out.
pub(super) fn axes(headings: u8) -> impl Iterator<Item = usize> {
    (0..4).filter(move |&heading| headings >> heading & 0b1_0001 == 0b1_0001)
}

#[cfg(test)]
#[path = "zones_tests.rs"]
mod tests;

//! Helicopter landing points: a flat, clear touchdown disk with a clear way in and out (FM 3-21.38, chapter 4).

use std::sync::atomic::{AtomicU8, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use super::disk::{DiskRows, circle};
use super::suitability::{
    LOW_M, SuitedSlopes, code_raster, cover_at, first_apart, hindrances, is_low_and_dry, is_suited,
    suited_ground,
};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::{Land, LandCover};
use crate::outcome::{FeatureRole, Outcome, OutcomeFeature, OutcomeShape, PostValues, PropertyValue};
use sandtable_terrain::stop_flag::StopFlag;

/// Steps by column and row to the neighbors, clockwise from the north; the opposite of `n` is `n + 4`.
const HEADINGS: [(i64, i64); 8] = [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)];

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
    let headings =
        clear_headings(land, &disk, arguments.number("obstacle_ratio"), arguments.number("approach_m"));
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    let code = |index: usize| {
        if ground.heights()[index].is_nan() {
            PostValues::NO_CODE
        } else if greatest[index] > limits.greatest || axis(headings[index]).is_none() {
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
    let features = sites.iter().enumerate().map(|(rank, &index)| {
        let center = ground.map_position(ground.post_at(index as usize));
        let mut properties = vec![
            ("code", PropertyValue::Whole(i64::from(codes[index as usize]))),
            ("diameter_m", PropertyValue::Number(diameter)),
        ];
        if let Some(from) = axis(headings[index as usize]) {
            let (east, north) = HEADINGS[from];
            let azimuth = libm::atan2(east as f64 * cell.x, north as f64 * cell.y).to_degrees();
            properties.push(("approach_from_deg", PropertyValue::Number((azimuth + 360.0) % 360.0)));
        }
        OutcomeFeature {
            shape: OutcomeShape::Area(vec![circle(center, diameter / 2.0)]),
            name: format!("LZ {}", rank + 1),
            role: FeatureRole::Site,
            properties,
        }
    });
    let features = features.collect();
    Ok(Outcome {
        raster: Some(code_raster("landing", codes)),
        features,
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

/// For each post, a bit for each heading in which a lane as wide as the disk is clear: at `t` meters from the disk,
/// nothing in the lane is higher above the center than `t` over `ratio` and what may stand in the disk.
fn clear_headings(land: &Land, disk: &DiskRows, ratio: f64, length_m: f64) -> Vec<u8> {
    let ground = &*land.ground;
    let (columns, rows, cell) = (ground.columns() as usize, ground.rows() as usize, ground.cell());
    let heights = ground.heights();
    let top = |index: usize| match heights[index] {
        height if height.is_nan() => f32::NEG_INFINITY,
        height => height + land.obstacles_m.as_ref().map_or(0.0, |obstacles| obstacles[index].max(0.0)),
    };
    let tops: Vec<f32> = (0..heights.len()).into_par_iter().map(top).collect();
    let tops = disk.maxima(&tops, columns, f32::NEG_INFINITY);
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

/// The first heading that is clear with its opposite: the way in and the way out.
fn axis(headings: u8) -> Option<usize> {
    (0..4).find(|&heading| headings >> heading & 0b1_0001 == 0b1_0001)
}

#[cfg(test)]
#[path = "zones_tests.rs"]
mod tests;

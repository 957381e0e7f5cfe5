//! Helicopter landing points: a flat, clear touchdown disk with a clear way in and out (FM 3-21.38, chapter 4).

use std::sync::atomic::{AtomicU8, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use super::disk::{DiskRows, circle};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::{Land, LandCover, WaterKind};
use crate::outcome::{
    FeatureRole, Figure, Hatching, Outcome, OutcomeFeature, OutcomeRaster, OutcomeShape, PostValues,
    PropertyValue, ValueClass,
};
use sandtable_terrain::stop_flag::StopFlag;

/// The greatest height in meters of what may stand in a touchdown disk: 18 inches.
const LOW_M: f32 = 0.45;

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
    let (free, caution) = (arguments.number("free_slope"), arguments.number("greatest_slope"));
    if free > caution {
        return Err(AnalysisError::argument("free_slope", "is above `greatest_slope`; state a lower one"));
    }
    let tangent = |degrees: f64| libm::tan(degrees.to_radians()) as f32;
    let limits = [tangent(free), tangent(caution)];
    let ground = &*land.ground;
    let (columns, rows, cell) = (ground.columns() as usize, ground.rows() as usize, ground.cell());
    let diameter = diameter_m(&arguments.word("size"));
    // Where posts lie farther apart than the disk is wide, the ground beside a post is judged by the posts beside it.
    let radius_m = (diameter / 2.0).max(cell.max_element());
    let disk = DiskRows::new(radius_m, cell, columns.max(rows));
    let slopes = hindrances(land, limits);
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
        } else if greatest[index] > limits[1] || axis(headings[index]).is_none() {
            0
        } else if greatest[index] > limits[0] {
            1
        } else {
            2
        }
    };
    let codes: Vec<u8> = (0..greatest.len()).into_par_iter().map(code).collect();
    let is_suited = |code: u8| code == 1 || code == 2;
    let mut order: Vec<u32> =
        (0..codes.len() as u32).filter(|&index| is_suited(codes[index as usize])).collect();
    let suited = order.len();
    order
        .par_sort_unstable_by(|&a, &b| greatest[a as usize].total_cmp(&greatest[b as usize]).then(a.cmp(&b)));
    let (count, apart) = (arguments.number("count") as usize, diameter + arguments.number("separation_m"));
    let at =
        |index: u32| DVec2::new(f64::from(index % columns as u32), f64::from(index / columns as u32)) * cell;
    let mut sites: Vec<u32> = Vec::new();
    for &index in &order {
        if sites.len() >= count {
            break;
        }
        if sites.iter().all(|&site| at(site).distance(at(index)) >= apart) {
            sites.push(index);
        }
    }
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
    let figure = Figure::new("suited ground", suited as f64 * ground.cell_m2() / 1e4, "ha");
    let raster =
        OutcomeRaster { name: "landing", unit: "", values: PostValues::Codes(codes), classes: classes() };
    Ok(Outcome { raster: Some(raster), features, figures: vec![figure], ..Outcome::default() })
}

/// The tangent of the slope at each post; raised just above the limit without caution by a surface that wants caution,
/// infinite where nothing can land or the ground has no data.
fn hindrances(land: &Land, [free, _]: [f32; 2]) -> Vec<f32> {
    let ground = &*land.ground;
    let columns = ground.columns() as usize;
    let mut values = vec![f32::INFINITY; ground.heights().len()];
    values.par_chunks_mut(columns).enumerate().for_each(|(row, values)| {
        for (column, (value, slopes)) in values.iter_mut().zip(ground.slopes_of_row(row as u32)).enumerate() {
            let index = row * columns + column;
            let slope = slopes.length();
            let is_low = land.obstacles_m.as_ref().is_none_or(|heights| heights[index] <= LOW_M);
            let is_dry = land.water.as_ref().is_none_or(|water| water[index].kind == WaterKind::None);
            if ground.heights()[index].is_nan() || !is_low || !is_dry {
                continue;
            }
            *value = match land.cover.as_ref().map_or(LandCover::Unknown, |cover| cover[index]) {
                LandCover::Unknown | LandCover::Open | LandCover::Paved => slope,
                LandCover::Crops | LandCover::Scrub | LandCover::Sand | LandCover::Rock => {
                    slope.max(free.next_up())
                }
                LandCover::Orchard
                | LandCover::Wood
                | LandCover::Wetland
                | LandCover::BuiltUp
                | LandCover::Building => continue,
            };
        }
    });
    values
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

fn classes() -> Vec<ValueClass> {
    let rows = [
        (0.0, "unsuited", [0, 0, 0, 0], Hatching::None),
        (1.0, "with caution", [254, 217, 118, 110], Hatching::Dots),
        (2.0, "suited", [90, 180, 90, 120], Hatching::Single),
    ];
    ValueClass::of_rows(rows)
}

#[cfg(test)]
#[path = "zones_tests.rs"]
mod tests;

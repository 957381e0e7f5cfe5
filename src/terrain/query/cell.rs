//! Heights within one cell: the formulas of the height contract.
//!
//! Corners are in the order south-west, south-east, north-west, north-east; NaN means no data.

use glam::DVec2;

use crate::cell_triangle::{CellTriangle, Diagonal};
use crate::query::Interpolation;
use sandtable_raster::answer::Answer;

/// The height at `part` of a cell, 0..=1 east and north from its south-west corner, or [`Answer::NoData`].
///
/// `cell` is the cell's size in meters, `diagonal` its own.
pub fn interpolate(
    interpolation: Interpolation,
    corners: [f64; 4],
    part: DVec2,
    diagonal: Diagonal,
    cell: DVec2,
) -> Answer {
    match interpolation {
        Interpolation::Planar => weighted_sum(planar_weights(part, diagonal), corners),
        Interpolation::Nearest => weighted_sum(bilinear_weights((part + 0.5).floor()), corners),
        // The cubic is bilinear where its other posts are missing.
        Interpolation::Bilinear | Interpolation::Cubic => {
            let height = bilinear(corners, part);
            if height.is_nan() {
                weighted_mean(bilinear_weights(part), corners)
            } else {
                Answer::Height(height)
            }
        }
        Interpolation::DistanceWeighted4 => weighted_mean(inverse_distance_weights(part, cell), corners),
    }
}

/// The bilinear height, NaN where a corner has none.
///
/// This form answers the level of a level cell exactly.
#[inline]
pub fn bilinear([sw, se, nw, ne]: [f64; 4], part: DVec2) -> f64 {
    let (south, north) = (sw + (se - sw) * part.x, nw + (ne - nw) * part.x);
    south + (north - south) * part.y
}

/// The weighted sum of the corners; no answer where a corner with a weight has no data.
fn weighted_sum(weights: [f64; 4], corners: [f64; 4]) -> Answer {
    let mut sum = 0.0;
    for (weight, height) in weights.into_iter().zip(corners) {
        if weight > 0.0 {
            sum += weight * height;
        }
    }
    if sum.is_nan() { Answer::NoData } else { Answer::Height(sum) }
}

/// The weighted mean of the corners that have data; no answer where none of those has a weight.
fn weighted_mean(weights: [f64; 4], corners: [f64; 4]) -> Answer {
    let (mut sum, mut total) = (0.0, 0.0);
    for (weight, height) in weights.into_iter().zip(corners) {
        if weight > 0.0 && !height.is_nan() {
            sum += weight * height;
            total += weight;
        }
    }
    if total == 0.0 { Answer::NoData } else { Answer::Height(sum / total) }
}

fn bilinear_weights(part: DVec2) -> [f64; 4] {
    let DVec2 { x, y } = part;
    [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
}

fn planar_weights(part: DVec2, diagonal: Diagonal) -> [f64; 4] {
    let DVec2 { x, y } = part;
    match CellTriangle::holding(diagonal, part) {
        CellTriangle::SouthEast => [1.0 - x, x - y, 0.0, y],
        CellTriangle::NorthWest => [1.0 - y, 0.0, y - x, x],
        CellTriangle::SouthWest => [1.0 - x - y, x, y, 0.0],
        CellTriangle::NorthEast => [0.0, 1.0 - y, 1.0 - x, x + y - 1.0],
    }
}

fn inverse_distance_weights(part: DVec2, cell: DVec2) -> [f64; 4] {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
    let distances = corners.map(|corner| ((part - corner) * cell).length());
    match distances.iter().position(|&distance| distance == 0.0) {
        Some(on_post) => std::array::from_fn(|corner| f64::from(u8::from(corner == on_post))),
        None => distances.map(f64::recip),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_cell_answers_its_level_to_the_last_bit() {
        for step in 0..1000 {
            let part = DVec2::new(f64::from(step) / 999.0, f64::from(step * 7 % 1000) / 999.0);
            assert_eq!(bilinear([371.25; 4], part), 371.25);
        }
    }

    #[test]
    fn a_position_where_only_corners_without_data_have_a_weight_has_no_answer() {
        let corners = [f64::NAN, 1.0, 2.0, 3.0];
        for interpolation in [Interpolation::Bilinear, Interpolation::DistanceWeighted4] {
            let answer = interpolate(interpolation, corners, DVec2::ZERO, Diagonal::Rising, DVec2::ONE);
            assert_eq!(answer, Answer::NoData, "{interpolation:?} at the post without data");
        }
    }
}

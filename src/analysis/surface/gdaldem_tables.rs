//! Values of `gdaldem` 3.6.2 on a small hill, to which slopes, aspects, light and ruggedness are equal.

#![allow(clippy::excessive_precision, reason = "the digits that gdaldem prints")]

use glam::DVec2;

use super::window::tests::{land, values};
use crate::land::Land;

/// The hill: 7 × 6 posts 10 m apart, row by row from the south-west; one has no data.
fn hill() -> Land {
    #[rustfmt::skip]
    let heights = vec![
        8.0, 9.0, 11.0, 14.0, 17.0, 18.0, 16.0,
        9.0, 12.0, 15.0, 21.0, 24.0, 22.0, f32::NAN,
        11.0, 16.0, 22.0, 30.0, 33.0, 26.0, 18.0,
        13.0, 19.0, 28.0, 40.0, 36.5, 24.0, 16.0,
        14.0, 18.0, 25.0, 31.25, 29.0, 20.0, 15.0,
        12.0, 15.0, 19.5, 22.0, 21.0, 17.0, 13.0,
    ];
    land(DVec2::splat(10.0), 7, heights)
}

/// Compares a kind's raster with a table of the inner 5 × 4 posts.
fn agrees(kind: &str, words: &[(&str, &str)], numbers: &[(&str, f64)], table: [f64; 20], slack: f64) {
    let values = values(&hill(), kind, words, numbers);
    for (index, value) in values.into_iter().map(f64::from).enumerate() {
        let (column, row) = (index % 7, index / 7);
        let is_inside = (1..6).contains(&column) && (1..5).contains(&row);
        let wanted = if is_inside { table[(row - 1) * 5 + column - 1] } else { f64::NAN };
        let is_equal =
            wanted.is_nan() && value.is_nan() || (value - wanted).abs() <= slack.max(1e-5 * wanted.abs());
        assert!(is_equal, "{kind} {words:?} at {column}, {row}: {value}, not {wanted}");
    }
}

#[test]
fn slopes_are_those_of_gdaldem_by_both_methods() {
    agrees("slope", &[], &[], tables::SLOPE_HORN, 0.0);
    agrees("slope", &[("method", "zevenbergen-thorne")], &[], tables::SLOPE_ZT, 0.0);
    agrees("slope", &[("unit", "degrees")], &[], tables::DEGREES_HORN, 0.0);
}

#[test]
fn aspects_are_those_of_gdaldem_by_both_methods() {
    agrees("aspect", &[], &[], tables::ASPECT_HORN, 0.0);
    agrees("aspect", &[("method", "zevenbergen-thorne")], &[], tables::ASPECT_ZT, 0.0);
}

#[test]
fn light_is_that_of_gdaldem_to_its_rounding() {
    let sun = [("azimuth", 300.0), ("altitude", 30.0), ("exaggeration", 2.0)];
    agrees("hillshade", &[], &sun, tables::HILLSHADE_HORN, 0.51);
    agrees("hillshade", &[("method", "zevenbergen-thorne")], &sun, tables::HILLSHADE_ZT, 0.51);
}

#[test]
fn multidirectional_light_is_that_of_gdaldem_to_its_rounding() {
    let low = [("altitude", 30.0), ("exaggeration", 2.0)];
    let words = [("light", "multidirectional"), ("method", "zevenbergen-thorne")];
    agrees("hillshade", &words[..1], &[], tables::MULTI_HORN, 0.51);
    agrees("hillshade", &words[..1], &low, tables::MULTI_LOW_HORN, 0.51);
    agrees("hillshade", &words, &[], tables::MULTI_ZT, 0.51);
    agrees("hillshade", &words, &low, tables::MULTI_LOW_ZT, 0.51);
}

#[test]
fn ruggedness_in_windows_of_three_posts_is_that_of_gdaldem() {
    agrees("ruggedness", &[("measure", "tri")], &[], tables::RILEY, 0.0);
    agrees("ruggedness", &[("measure", "tpi")], &[], tables::TPI, 1e-5);
    agrees("ruggedness", &[("measure", "roughness")], &[], tables::ROUGHNESS, 0.0);
}

/// The inner posts, row by row from the south-west.
#[rustfmt::skip]
mod tables {
    /// `gdaldem slope -p`.
    pub(super) const SLOPE_HORN: [f64; 20] = [
        47.762432, 72.822556, 85.750366, 70.044632, f64::NAN,
        66.261795, 97.371712, 93.478775, 64.286957, f64::NAN,
        66.19101, 87.331314, 40.043922, 61.175018, 90.665939,
        59.771702, 83.770988, 78.302299, 88.637695, 81.475647,
    ];
    /// `gdaldem slope -p -alg ZevenbergenThorne`.
    pub(super) const SLOPE_ZT: [f64; 20] = [
        46.097721, 71.063354, 91.787796, 80.156097, f64::NAN,
        65.192024, 95.524864, 109.772491, 65.622025, f64::NAN,
        75.663727, 106.066017, 42.9571, 82.462112, 106.800049,
        58.523499, 78.710304, 92.195442, 95.761749, 78.262383,
    ];
    /// `gdaldem slope`.
    pub(super) const DEGREES_HORN: [f64; 20] = [
        25.530275, 36.063065, 40.613209, 35.009178, f64::NAN,
        33.529167, 44.237068, 43.069569, 32.735729, f64::NAN,
        33.500977, 41.131138, 21.823101, 31.456217, 42.197319,
        30.867479, 39.953239, 38.06176, 41.55304, 39.17165,
    ];
    /// `gdaldem aspect`.
    pub(super) const ASPECT_HORN: [f64; 20] = [
        222.878906, 219.427795, 210.677277, 182.04541, f64::NAN,
        234.211029, 228.122131, 211.88356, 153.434952, f64::NAN,
        259.114471, 262.391815, 267.316223, 74.898903, 74.814163,
        291.467651, 305.587372, 343.300751, 37.83955, 60.091572,
    ];
    /// `gdaldem aspect -alg ZevenbergenThorne`.
    pub(super) const ASPECT_ZT: [f64; 20] = [
        220.601288, 219.289413, 209.357758, 183.576324, f64::NAN,
        237.528809, 227.121094, 210.068573, 162.255325, f64::NAN,
        262.405334, 261.869904, 261.634094, 75.96376, 73.68615,
        289.983093, 302.680542, 347.471191, 35.972385, 63.434948,
    ];
    /// `gdaldem hillshade -az 300 -alt 30 -z 2`.
    pub(super) const HILLSHADE_HORN: [f64; 20] = [
        127.0, 103.0, 67.0, 1.0, f64::NAN,
        150.0, 120.0, 67.0, 1.0, f64::NAN,
        210.0, 215.0, 216.0, 1.0, 1.0,
        249.0, 254.0, 204.0, 37.0, 1.0,
    ];
    /// `gdaldem hillshade -az 300 -alt 30 -z 2 -alg ZevenbergenThorne`.
    pub(super) const HILLSHADE_ZT: [f64; 20] = [
        122.0, 103.0, 60.0, 1.0, f64::NAN,
        159.0, 117.0, 54.0, 1.0, f64::NAN,
        216.0, 212.0, 210.0, 1.0, 1.0,
        248.0, 255.0, 192.0, 39.0, 1.0,
    ];
    /// `gdaldem hillshade -multidirectional`.
    pub(super) const MULTI_HORN: [f64; 20] = [
        199.0, 187.0, 160.0, 101.0, f64::NAN,
        215.0, 199.0, 160.0, 73.0, f64::NAN,
        234.0, 237.0, 225.0, 77.0, 34.0,
        233.0, 237.0, 224.0, 93.0, 58.0,
    ];
    /// `gdaldem hillshade -multidirectional -alt 30 -z 2`.
    pub(super) const MULTI_LOW_HORN: [f64; 20] = [
        168.0, 164.0, 139.0, 56.0, f64::NAN,
        196.0, 184.0, 142.0, 8.0, f64::NAN,
        225.0, 226.0, 217.0, 5.0, 5.0,
        225.0, 227.0, 209.0, 68.0, 21.0,
    ];
    /// `gdaldem hillshade -multidirectional -alg ZevenbergenThorne`.
    pub(super) const MULTI_ZT: [f64; 20] = [
        195.0, 188.0, 153.0, 93.0, f64::NAN,
        219.0, 198.0, 146.0, 77.0, f64::NAN,
        236.0, 235.0, 226.0, 44.0, 17.0,
        233.0, 236.0, 217.0, 91.0, 59.0,
    ];
    /// `gdaldem hillshade -multidirectional -alt 30 -z 2 -alg ZevenbergenThorne`.
    pub(super) const MULTI_LOW_ZT: [f64; 20] = [
        162.0, 164.0, 134.0, 59.0, f64::NAN,
        202.0, 182.0, 135.0, 19.0, f64::NAN,
        227.0, 224.0, 219.0, 4.0, 5.0,
        225.0, 227.0, 202.0, 73.0, 17.0,
    ];
    /// `gdaldem TRI -alg Riley`.
    pub(super) const RILEY: [f64; 20] = [
        12.688578, 19.313208, 20.880613, 17.860571, f64::NAN,
        17.0, 24.879711, 23.690716, 23.371992, f64::NAN,
        16.155495, 22.990488, 32.43166, 26.254761, 21.523243,
        15.435349, 22.300505, 22.079403, 23.351927, 21.66218,
    ];
    /// `gdaldem TPI`.
    pub(super) const TPI: [f64; 20] = [
        -0.625, -1.875, 0.25, 1.375, f64::NAN,
        -0.125, -0.625, 2.5625, 5.0625, f64::NAN,
        0.625, 2.84375, 10.65625, 7.34375, -0.1875,
        -0.1875, 0.90625, 3.625, 2.53125, -1.4375,
    ];
    /// `gdaldem roughness`.
    pub(super) const ROUGHNESS: [f64; 20] = [
        14.0, 21.0, 22.0, 19.0, f64::NAN,
        19.0, 28.0, 25.0, 19.0, f64::NAN,
        17.0, 24.0, 18.0, 20.0, 21.5,
        16.0, 25.0, 20.5, 23.0, 23.5,
    ];
}

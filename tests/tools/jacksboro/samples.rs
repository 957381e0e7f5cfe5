//! Two small elevation models for the scenes that show one thing each.
//!
//! `valley.asc` is the country round Caryville, resampled to whole meters of UTM zone 16 north. `hills.png`
//! is made by formula: round hills and a hollow on a gentle slope, an elevation model without any georeference.

use glam::DVec2;
use sandtable_geom::crs::Crs;

use super::ground::Ground;

/// Posts per side of `valley.asc`.
const VALLEY_POSTS: u32 = 112;
/// Distance between its posts in meters, near that of the source.
const VALLEY_CELL_M: f64 = 80.0;
/// Its south-west corner in EPSG:32616.
const VALLEY_CORNER: DVec2 = DVec2::new(746_000.0, 4_015_000.0);
/// Samples per side of `hills.png`: a power of two and one.
pub const HILLS_SIDE: u32 = 129;

/// `valley.asc`: an ESRI ASCII grid in meters, one decimal, bilinear between the source's posts.
pub fn valley(ground: &Ground) -> String {
    let (utm, geographic) = (Crs::from_epsg(32616), Crs::wgs84());
    let utm = utm.expect("EPSG:32616 is in the table");
    let mut text = format!(
        "ncols {VALLEY_POSTS}\nnrows {VALLEY_POSTS}\nxllcorner {}\nyllcorner {}\ncellsize {VALLEY_CELL_M}\nNODATA_value -9999\n",
        VALLEY_CORNER.x, VALLEY_CORNER.y
    );
    for row in (0..VALLEY_POSTS).rev() {
        let heights = (0..VALLEY_POSTS).map(|column| {
            let post = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) * VALLEY_CELL_M;
            let place = utm.transform(&geographic, VALLEY_CORNER + post).expect("the valley is in the zone");
            format!("{:.1}", ground.at(ground.locate(place.x, place.y)))
        });
        text.push_str(&heights.collect::<Vec<_>>().join(" "));
        text.push('\n');
    }
    text
}

/// `hills.png`, sample values row by row from the north: decimeters above the lowest ground.
pub fn hills() -> Vec<u16> {
    /// Each hill: center east and south, as parts of the side, radius likewise, height in decimeters. The
    /// last is a hollow, for a pond.
    const HILLS: [(f64, f64, f64, f64); 7] = [
        (0.30, 0.32, 0.16, 1_900.0),
        (0.68, 0.26, 0.12, 1_300.0),
        (0.55, 0.58, 0.20, 2_300.0),
        (0.20, 0.72, 0.12, 900.0),
        (0.82, 0.74, 0.14, 1_500.0),
        (0.44, 0.86, 0.09, 700.0),
        (0.65, 0.87, 0.08, -330.0),
    ];
    let side = f64::from(HILLS_SIDE - 1);
    let height = |east: f64, south: f64| -> f64 {
        let round = HILLS.iter().map(|&(x, y, radius, high)| {
            let square = ((east - x) * (east - x) + (south - y) * (south - y)) / (radius * radius);
            high * libm::exp(-square)
        });
        let slope = 400.0 * (1.0 - south);
        let waves = 25.0 * libm::sin(37.0 * east) * libm::sin(31.0 * south);
        100.0 + slope + waves + round.sum::<f64>()
    };
    let samples = (0..HILLS_SIDE).flat_map(|row| (0..HILLS_SIDE).map(move |column| (row, column)));
    samples
        .map(|(row, column)| height(f64::from(column) / side, f64::from(row) / side).round() as u16)
        .collect()
}

//! The climate of a place on Earth, as far as its colors need it: how dry it is, and how warm.
//!
//! Dryness is read from a table of 10° of latitude and longitude, drawn after the map of Köppen–Geiger climates (Peel,
//! Finlayson and McMahon 2007), straight between the middles of its cells. That is coarse: it tells Utah from Tennessee, not
//! one side of a mountain from the other. The side of a mountain, its height and its slopes are the ground's own, and
//! [`GroundCover`] adds them. A scene without a place on Earth has the climate of middle latitudes.

use glam::DVec2;

use crate::land_cover::CoverLines;
use sandtable_draw::color::Srgba;
use sandtable_draw::ground_cover::{CoverColor, GroundCover};

/// Dryness by latitude from 60–70° N to 50–60° S and by longitude from 180° W: 0 where it rains all year to 9 in deserts. Over
/// the sea it is that of the nearest land.
const DRYNESS: [&[u8; 36]; 13] = [
    b"333344444443333211122222333344444333",
    b"111101454322111110222334544344322111",
    b"111112663211111112223458867876321111",
    b"222224873112222235655678868753211111",
    b"333333975222233389999999873010012222",
    b"333333333223234577777769543121111111",
    b"111111111100012221211376212000000011",
    b"111111111340025333221333211000100001",
    b"111122222294233345674422222223664211",
    b"222222222295312345687332233447886222",
    b"222222222246222223355322222225764111",
    b"111111111117311111111111111111111111",
    b"111111111114311111111111111111111111",
];
/// The latitude of the middle of the first row.
const FIRST_DEG: f64 = 65.0;
/// The width of a cell.
const CELL_DEG: f64 = 10.0;

/// The dryness of a place that is not known: 1 of 9.
const MODERATE: f64 = 1.0 / 9.0;
/// The moisture of the air at sea level where it rains all year, and what the driest place lacks of it.
const MOISTURE: [f64; 2] = [0.95, 0.85];

/// From and to which dryness mountains lie far from the sea, and by how many meters trees and snow lie higher there: 3400 m
/// and 2200 m are the tree lines of the Front Range and of the Alps, 6° apart (Körner 1998: that of a continent's middle is
/// some hundred meters above that of its coasts).
const INLAND: [f64; 2] = [0.25, 0.75];
const INLAND_M: f64 = 550.0;

/// The latitudes from and to which the tropics give way to middle latitudes, and these to the polar regions.
const TROPICS_DEG: [f64; 2] = [12.0, 28.0];
const POLAR_DEG: [f64; 2] = [54.0, 68.0];

/// The climate of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Climate {
    /// Latitude in degrees; `None` where the place is not known.
    latitude_deg: Option<f64>,
    /// 0 where it rains all year to 1 in the driest deserts.
    pub dryness: f64,
    /// The share of the tropics, 0..=1.
    pub tropical: f64,
    /// The share of the polar regions, 0..=1.
    pub polar: f64,
}

impl Climate {
    /// The climate at a longitude and latitude in degrees; `None` for a scene without a place on Earth.
    pub fn at(place: Option<DVec2>) -> Self {
        let Some(place) = place.filter(|place| place.is_finite()) else {
            return Self { latitude_deg: None, dryness: MODERATE, tropical: 0.0, polar: 0.0 };
        };
        let from_equator = place.y.abs();
        Self {
            latitude_deg: Some(place.y),
            dryness: dryness(place),
            tropical: 1.0 - part(from_equator, TROPICS_DEG),
            polar: part(from_equator, POLAR_DEG),
        }
    }

    /// Whether the place is known.
    pub fn is_known(&self) -> bool {
        self.latitude_deg.is_some()
    }

    /// The elevations at which land cover changes.
    pub fn lines(&self) -> CoverLines {
        let higher_m = INLAND_M * part(self.dryness, INLAND);
        let CoverLines { tree_m, snow_m } = CoverLines::at(self.latitude_deg);
        CoverLines { tree_m: tree_m + higher_m, snow_m: snow_m + higher_m }
    }

    /// The covers of ground whose drawn slopes are `true_rise` times as steep in truth.
    pub fn cover(&self, true_rise: f32) -> GroundCover {
        let lines = self.lines();
        let [wet, lacking] = MOISTURE;
        GroundCover {
            tree_m: lines.tree_m as f32,
            snow_m: lines.snow_m as f32,
            true_rise,
            shady_north: if self.latitude_deg.is_some_and(|degrees| degrees < 0.0) { -1.0 } else { 1.0 },
            moisture: (wet - lacking * self.dryness) as f32,
            has_forms: true,
            colors: self.colors(),
        }
    }

    /// The colors of [`GroundCover::colors`].
    fn colors(&self) -> [CoverColor; 7] {
        let dry = part(self.dryness, [0.2, 0.8]) as f32;
        // Red rock: of hot deserts alone.
        let warmth = part(self.latitude_deg.unwrap_or(FIRST_DEG).abs(), [44.0, 35.0]);
        let hot = (part(self.dryness, [0.6, 0.85]) * warmth) as f32;
        let color =
            |[red, green, blue]: [u8; 3], light: f32| CoverColor::new(Srgba::opaque(red, green, blue), light);
        let woods = color([86, 114, 70], 0.63)
            .lerp(&color([72, 118, 64], 0.60), self.tropical as f32)
            .lerp(&color([92, 114, 86], 0.70), self.polar as f32)
            .lerp(&color([88, 114, 76], 0.66), dry);
        let meadow = color([168, 178, 118], 1.02)
            .lerp(&color([166, 166, 134], 0.95), self.polar as f32)
            .lerp(&color([188, 178, 126], 1.02), dry);
        let scree = color([184, 173, 150], 0.97).lerp(&color([208, 166, 130], 0.98), hot);
        let rock = color([156, 149, 128], 0.80).lerp(&color([188, 122, 90], 0.80), hot);
        let crops = color([224, 204, 136], 1.16);
        let soil = color([186, 150, 112], 0.92).lerp(&color([190, 140, 104], 0.94), dry);
        [woods, meadow, scree, rock, color([238, 243, 250], 1.2), crops, soil]
    }
}

/// Dryness between the cells of the table, 0..=1.
fn dryness(place: DVec2) -> f64 {
    let last = (DRYNESS.len() - 1) as f64;
    let row = ((FIRST_DEG - place.y) / CELL_DEG).clamp(0.0, last);
    let column = (place.x / CELL_DEG + 17.5).rem_euclid(36.0);
    let value = |row: f64, column: f64| {
        let digit = DRYNESS[row as usize][column as usize % 36];
        f64::from(digit - b'0') / 9.0
    };
    let (west, north) = (column.floor(), row.floor());
    let south = (north + 1.0).min(last);
    let along = |row: f64| {
        let (from, to) = (value(row, west), value(row, west + 1.0));
        from + (to - from) * (column - west)
    };
    along(north) + (along(south) - along(north)) * (row - north)
}

/// Where a value is between two, smoothly, 0..=1.
fn part(value: f64, [from, to]: [f64; 2]) -> f64 {
    let part = ((value - from) / (to - from)).clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(longitude: f64, latitude: f64) -> Climate {
        Climate::at(Some(DVec2::new(longitude, latitude)))
    }

    #[test]
    fn deserts_are_dry_and_rain_forests_and_coasts_of_the_west_wind_are_not() {
        for (place, dry) in [
            ("Sahara", at(10.0, 24.0)),
            ("Mojave", at(-115.5, 35.0)),
            ("Atacama", at(-71.0, -22.0)),
            ("Rub al Khali", at(50.0, 20.0)),
            ("Simpson Desert", at(135.0, -25.0)),
        ] {
            assert!(dry.dryness > 0.7, "{place}: {}", dry.dryness);
        }
        for (place, wet) in [
            ("Amazon", at(-65.0, -3.0)),
            ("Tennessee", at(-84.2, 36.3)),
            ("Wales", at(-4.0, 52.0)),
            ("Japan", at(138.7, 35.4)),
            ("Borneo", at(115.0, 1.0)),
            ("Fiordland", at(167.5, -45.0)),
        ] {
            assert!(wet.dryness < 0.3, "{place}: {}", wet.dryness);
        }
        let between = [at(20.4, -34.0), at(-118.0, 34.3), at(-3.7, 40.4), at(33.0, 39.0)];
        assert!(between.iter().all(|place| (0.3..0.85).contains(&place.dryness)), "{between:?}");
    }

    #[test]
    fn dryness_has_no_step_and_goes_on_across_180_degrees() {
        assert!((at(179.999, 15.0).dryness - at(-179.999, 15.0).dryness).abs() < 1e-3);
        for latitude in -90..=90 {
            for longitude in (-180..180).step_by(3) {
                let [here, beside] = [0.0, 0.1]
                    .map(|step| at(f64::from(longitude) + step, f64::from(latitude) + step).dryness);
                assert!(
                    (0.0..=1.0).contains(&here) && (here - beside).abs() < 0.03,
                    "{longitude} {latitude}"
                );
            }
        }
    }

    #[test]
    fn a_scene_without_a_place_has_the_climate_of_middle_latitudes() {
        let nowhere = Climate::at(None);
        assert_eq!(nowhere, Climate::at(Some(DVec2::NAN)));
        assert!(nowhere.cover(1.0).moisture > 0.8 && nowhere.lines() == CoverLines::at(Some(45.0)));
        assert_eq!(at(20.0, -34.0).cover(1.0).shady_north, -1.0);
    }

    #[test]
    fn trees_grow_higher_far_from_the_sea() {
        for (place, climate, seen_m) in [
            ("Front Range", at(-105.5, 40.2), 3400.0),
            ("Wasatch Range", at(-111.7, 40.7), 3200.0),
            ("Tien Shan", at(78.0, 42.0), 2900.0),
            ("Alps", at(8.0, 46.5), 2200.0),
            ("Cascade Range", at(-121.7, 45.4), 2000.0),
            ("Pyrenees", at(0.7, 42.6), 2400.0),
        ] {
            let tree_m = climate.lines().tree_m;
            assert!((tree_m - seen_m).abs() < 300.0, "{place}: {tree_m} m");
        }
    }
}

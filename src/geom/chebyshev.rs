//! A smooth map of the plane as a small table: its values at Chebyshev points, and polynomials through them.
//!
//! In each direction the points are `cos(π·i / n)` on the rectangle's side; between them stands the barycentric formula of
//! Berrut and Trefethen (2004), whose weights are ±1, and half of that at both ends. A projection of some hundred
//! kilometers is met to a billionth of a degree with a dozen points a side, where a table of even steps would need
//! thousands.

use std::f64::consts::PI;

use glam::DVec2;

use crate::rect::Rect;

/// Points a side that are tried, one after the other. The last is enough for a rectangle as wide as a country.
const POINTS: [usize; 5] = [4, 7, 11, 17, 27];

/// Places a side, off the points, at which a table is compared with the map.
const CHECKS: usize = 41;

/// Values of a map at the Chebyshev points of a rectangle.
#[derive(Clone, Debug, PartialEq)]
pub struct ChebyshevTable {
    /// The rectangle.
    pub rect: Rect,
    /// Points a side.
    pub points: usize,
    /// The values, row by row from the rectangle's high Y, each row from its high X: in the order of the cosines.
    pub values: Vec<DVec2>,
    /// The greatest difference from the map, in either coordinate, at 41 × 41 places off the points.
    pub error: f64,
}

impl ChebyshevTable {
    /// The smallest table of `map` over `rect` whose error is at most `tolerance`, else the largest; `None` where the map
    /// has no value at one of the sampled places.
    pub fn fit(rect: Rect, tolerance: f64, map: impl Fn(DVec2) -> Option<DVec2>) -> Option<Self> {
        let mut last = None;
        for points in POINTS {
            let place = |x: usize, y: usize| {
                let share = |index: usize| 0.5 + 0.5 * cosine(index, points);
                rect.min + rect.size() * DVec2::new(share(x), share(y))
            };
            let places = (0..points * points).map(|index| place(index % points, index / points));
            let values: Option<Vec<DVec2>> = places.map(&map).collect();
            let mut table = Self { rect, points, values: values?, error: 0.0 };
            table.error = table.greatest_error(&map)?;
            if table.error <= tolerance {
                return Some(table);
            }
            last = Some(table);
        }
        last
    }

    fn greatest_error(&self, map: impl Fn(DVec2) -> Option<DVec2>) -> Option<f64> {
        let share = |index: usize| (index as f64 + 0.5) / CHECKS as f64;
        let mut most = 0.0f64;
        for index in 0..CHECKS * CHECKS {
            let part = DVec2::new(share(index % CHECKS), share(index / CHECKS));
            let at = self.rect.min + self.rect.size() * part;
            most = most.max((self.at(at) - map(at)?).abs().max_element());
        }
        Some(most)
    }

    /// The value at a place within the rectangle.
    pub fn at(&self, at: DVec2) -> DVec2 {
        let place = (at - self.rect.min) / self.rect.size() * 2.0 - 1.0;
        let [across, up] = [place.x, place.y].map(|place| shares(place, self.points));
        let row =
            |row: &[DVec2]| row.iter().zip(&across).map(|(&value, share)| value * *share).sum::<DVec2>();
        self.values.chunks(self.points).zip(&up).map(|(values, share)| row(values) * *share).sum()
    }
}

fn cosine(index: usize, points: usize) -> f64 {
    libm::cos(PI * index as f64 / (points - 1) as f64)
}

/// The share of each point's value at `place`, −1..=1.
fn shares(place: f64, points: usize) -> Vec<f64> {
    let away = |index: usize| place - cosine(index, points);
    if let Some(exact) = (0..points).find(|&index| away(index) == 0.0) {
        return (0..points).map(|index| f64::from(u8::from(index == exact))).collect();
    }
    let weight = |index: usize| {
        let sign = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
        let half = if index == 0 || index + 1 == points { 0.5 } else { 1.0 };
        sign * half / away(index)
    };
    let weights: Vec<f64> = (0..points).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Crs;

    #[test]
    fn longitude_and_latitude_of_a_county_and_of_a_country_are_met() {
        let utm = Crs::from_epsg(32633).expect("known");
        for (side_m, points) in [(30e3, 7), (400e3, 11)] {
            let min = DVec2::new(300_000.0, 6_600_000.0);
            let rect = Rect { min, max: min + side_m };
            let map = |at: DVec2| utm.transform(&Crs::wgs84(), at).ok();
            let table = ChebyshevTable::fit(rect, 1e-9, map).expect("all of it is known");
            assert!(table.error <= 1e-9 && table.points <= points, "{} {}", table.points, table.error);
            let corner = map(rect.max).expect("known");
            assert!((table.at(rect.max) - corner).abs().max_element() < 1e-12);
        }
    }

    #[test]
    fn a_map_with_a_gap_has_no_table() {
        let rect = Rect { min: DVec2::ZERO, max: DVec2::ONE };
        assert_eq!(ChebyshevTable::fit(rect, 1.0, |at| (at.x < 0.9).then_some(at)), None);
    }
}

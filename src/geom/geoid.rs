//! The EGM96 geoid above the WGS 84 ellipsoid; the one user of `egm96`.
//!
//! The model is a sum of 65,341 spherical harmonics (Lemoine et al., NASA/TP-1998-206861, to degree and order 360), a
//! millisecond a place. It is computed at nodes every 7.5 minutes of arc, and interpolated between them by the cubic through
//! four nodes each way: within 4 mm of the sum, where the model itself is good to half a meter. A place has the same
//! undulation, bit for bit, whatever else is asked.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};

use glam::DVec2;
use rayon::prelude::*;

/// Nodes a degree of latitude and of longitude.
const NODES_A_DEGREE: i32 = 8;

/// Columns of nodes around the Earth.
const COLUMNS: i32 = 360 * NODES_A_DEGREE;

/// The row of the north pole; that of the south pole is its negative.
const POLE: i32 = 90 * NODES_A_DEGREE;

/// The most nodes that are kept: some hundred megabytes, and a quarter of the Earth's.
const MOST_KEPT: usize = 1 << 20;

/// A node by its row from the equator and its column from Greenwich.
type Node = (i32, i32);

/// The EGM96 geoid, which keeps the nodes that it has computed.
#[derive(Debug, Default)]
pub struct Geoid {
    nodes: Mutex<BTreeMap<Node, f64>>,
}

/// Places over so much of the Earth that their undulations take too long.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "these places need the geoid at {nodes} nodes, a millisecond each, and at most {most} are computed at a time: ask for \
     fewer places, or for places closer together"
)]
pub struct GeoidWorkError {
    nodes: usize,
    most: usize,
}

impl Geoid {
    /// The height of the geoid above the ellipsoid, in meters, at longitudes and latitudes on WGS 84 in degrees; NaN at
    /// places that are not finite or have no latitude.
    ///
    /// # Errors
    /// The places need more than `most` nodes that are not kept yet.
    pub fn undulations(&self, places: &[DVec2], most: usize) -> Result<Vec<f64>, GeoidWorkError> {
        let cells = places.iter().copied().filter(|&place| is_on_earth(place)).map(cell);
        let mut cells: Vec<Node> = cells.collect();
        cells.sort_unstable();
        cells.dedup();
        let nodes = self.nodes(cells.iter().copied().flat_map(around).collect(), most)?;
        let of_cell = |&cell: &Node| (cell, std::array::from_fn(|index| nodes[&around(cell)[index]]));
        let values: BTreeMap<Node, [f64; 16]> = cells.iter().map(of_cell).collect();
        let undulation = |&place: &DVec2| match is_on_earth(place) {
            true => between(place, &values[&cell(place)]),
            false => f64::NAN,
        };
        Ok(places.iter().map(undulation).collect())
    }

    /// The undulations at nodes.
    fn nodes(&self, needed: BTreeSet<Node>, most: usize) -> Result<BTreeMap<Node, f64>, GeoidWorkError> {
        let kept = || self.nodes.lock().unwrap_or_else(PoisonError::into_inner);
        let mut values: BTreeMap<Node, f64> = {
            let kept = kept();
            needed.iter().filter_map(|node| Some((*node, *kept.get(node)?))).collect()
        };
        let missing: Vec<Node> = needed.into_iter().filter(|node| !values.contains_key(node)).collect();
        if missing.len() > most {
            return Err(GeoidWorkError { nodes: missing.len(), most });
        }
        let computed: Vec<(Node, f64)> = missing.into_par_iter().map(|node| (node, at_node(node))).collect();
        let mut kept = kept();
        if kept.len() + computed.len() > MOST_KEPT {
            kept.clear();
        }
        kept.extend(computed.iter().copied());
        values.extend(computed);
        Ok(values)
    }
}

fn is_on_earth(place: DVec2) -> bool {
    place.is_finite() && place.y.abs() <= 90.0
}

/// The place in nodes from the equator and from Greenwich.
fn in_nodes(place: DVec2) -> DVec2 {
    // A turn more or less is the same meridian; without it, columns of far numbers would overflow.
    DVec2::new(place.x.rem_euclid(360.0), place.y) * f64::from(NODES_A_DEGREE)
}

/// The node at or south-west of a place.
fn cell(place: DVec2) -> Node {
    let at = in_nodes(place).floor();
    (at.y as i32, at.x as i32)
}

/// The sixteen nodes around a cell, row by row; beyond a pole those of the meridian opposite.
fn around((row, column): Node) -> [Node; 16] {
    std::array::from_fn(|index| {
        let (row, column) = (row + index as i32 / 4 - 1, column + index as i32 % 4 - 1);
        let (row, column) = match row {
            row if row > POLE => (2 * POLE - row, column + COLUMNS / 2),
            row if row < -POLE => (-2 * POLE - row, column + COLUMNS / 2),
            row => (row, column),
        };
        (row, column.rem_euclid(COLUMNS))
    })
}

/// The undulation at a node, in meters.
fn at_node((row, column): Node) -> f64 {
    let degrees = |index: i32| f64::from(index) / f64::from(NODES_A_DEGREE);
    egm96::egm96_compute_altitude_offset(degrees(row), degrees(column))
}

/// The value at a place of the cubics through the sixteen values around its cell.
fn between(place: DVec2, values: &[f64; 16]) -> f64 {
    let part = in_nodes(place).fract_gl();
    let (rows, columns) = (weights(part.y), weights(part.x));
    let rows = rows.iter().zip(values.chunks_exact(4));
    rows.map(|(weight, row)| {
        weight * row.iter().zip(columns).map(|(value, weight)| value * weight).sum::<f64>()
    })
    .sum()
}

/// The weights of values at −1, 0, 1 and 2 in the cubic through them, at `t` from 0 to 1 (Lagrange).
fn weights(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOST: usize = 10_000;

    fn undulation(longitude: f64, latitude: f64) -> f64 {
        Geoid::default().undulations(&[DVec2::new(longitude, latitude)], MOST).expect("few nodes")[0]
    }

    #[test]
    fn the_test_values_of_the_model_s_authors_are_met() {
        // F477, the program of the model's authors: its six places and what it prints for them.
        for (latitude, longitude, expected_m) in [
            (38.628_155, 269.779_155, -31.628),
            (-14.621_217, 305.021_114, -2.969),
            (46.874_319, 102.448_729, -43.575),
            (-23.617_446, 133.874_712, 15.871),
            (38.625_473, 359.999_5, 50.066),
            (-0.466_744, 0.002_3, 17.329),
        ] {
            let found_m = undulation(longitude, latitude);
            assert!((found_m - expected_m).abs() < 0.01, "{latitude}, {longitude}: {found_m}");
        }
    }

    #[test]
    fn between_nodes_it_is_within_millimeters_of_the_sum() {
        for (longitude, latitude) in
            [(86.925_278, 27.988_056), (-75.31, -9.04), (179.97, -16.49), (12.3, 89.97)]
        {
            let exact = egm96::egm96_compute_altitude_offset(latitude, longitude);
            let found = undulation(longitude, latitude);
            assert!((found - exact).abs() < 0.005, "{longitude}, {latitude}: {found} and {exact}");
        }
    }

    #[test]
    fn a_turn_and_the_poles_change_nothing() {
        assert_eq!(undulation(-170.3, 40.0), undulation(189.7, 40.0));
        for latitude in [90.0, -90.0] {
            let pole = undulation(0.0, latitude);
            assert!((undulation(123.4, latitude) - pole).abs() < 1e-6, "{latitude}");
        }
        assert!(undulation(0.0, 90.1).is_nan() && undulation(f64::NAN, 0.0).is_nan());
    }

    #[test]
    fn a_place_has_the_same_bits_alone_and_among_others() {
        let geoid = Geoid::default();
        let places: Vec<DVec2> = (0..30)
            .map(|index| DVec2::new(7.0 + f64::from(index) * 0.07, 43.0 + f64::from(index) * 0.03))
            .collect();
        let together = geoid.undulations(&places, MOST).expect("few nodes");
        for (place, expected) in places.iter().zip(&together) {
            assert_eq!(undulation(place.x, place.y).to_bits(), expected.to_bits());
        }
    }

    #[test]
    fn work_out_of_proportion_is_refused() {
        let places: Vec<DVec2> = (0..100).map(|index| DVec2::new(f64::from(index), 0.0)).collect();
        let refused = Geoid::default().undulations(&places, 1000).expect_err("1,600 nodes");
        assert_eq!((refused.nodes, refused.most), (1600, 1000));
    }
}

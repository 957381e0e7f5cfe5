//! A roof with a rise of one, whatever its shape, and what must hold for it.

use glam::{DVec2, DVec3};

use crate::building_footprint::BuildingFootprint;
use sandtable_description::words;
use sandtable_geom::polygon;

/// No vertex of a footprint may lie nearer to a ridge or a bend of its roof, meters.
pub(crate) const LEAST_ASIDE_M: f64 = 0.02;

/// A roof with a rise of one.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitRoof {
    /// Its shape; not always the stated one.
    pub shape: words::RoofShape,
    /// The footprint's rings with the rise at each vertex, 0..=1; all 0 but at gables.
    pub edge: Vec<Vec<DVec3>>,
    /// Flat polygons, counter-clockwise seen from above, X, Y and rise.
    pub faces: Vec<Vec<DVec3>>,
    /// How far it is in plan from the eaves to the ridge, meters; 0 for a flat one. Rise over run is its pitch.
    pub run_m: f64,
}

/// The footprint's rings at the eaves.
pub(crate) fn level_edge(footprint: &BuildingFootprint) -> Vec<Vec<DVec3>> {
    footprint.rings().iter().map(|ring| ring.iter().map(|at| at.extend(0.0)).collect()).collect()
}

/// The center of a ring's area.
pub fn centroid(ring: &[DVec2]) -> DVec2 {
    let first = ring.first().copied().unwrap_or_default();
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for (from, to) in polygon::edges(ring) {
        let (a, b) = (from - first, to - first);
        sum += (a + b) * a.perp_dot(b);
        area += a.perp_dot(b);
    }
    if area == 0.0 { first } else { first + sum / (3.0 * area) }
}

/// A face of a roof that does not face up.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("face {face} of a {shape:?} roof covers {area_m2} m²")]
pub struct UnitRoofError {
    /// Its place among the roof's faces.
    pub face: usize,
    /// The roof's shape.
    pub shape: words::RoofShape,
    /// What it covers in plan, not above 0.
    pub area_m2: f64,
}

/// The area in plan that a roof's faces cover, in square meters; each must face up.
///
/// # Errors
/// The first face that does not.
pub fn check(roof: &UnitRoof) -> Result<f64, UnitRoofError> {
    let mut sum = 0.0;
    for (face, corners) in roof.faces.iter().enumerate() {
        let ring: Vec<DVec2> = corners.iter().map(|at| at.truncate()).collect();
        let area_m2 = polygon::doubled_area(&ring) / 2.0;
        if area_m2 <= 0.0 {
            return Err(UnitRoofError { face, shape: roof.shape, area_m2 });
        }
        sum += area_m2;
    }
    Ok(sum)
}

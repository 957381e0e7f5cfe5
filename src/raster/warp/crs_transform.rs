//! Transforms between a raster's coordinate system and another, with longitudes that continue across ±180°.

use glam::DVec2;

use crate::raster::Raster;
use crate::warp::error::WarpError;
use sandtable_geom::crs::{Crs, CrsError};

/// The transform from a raster's system to another; the identity where either is unknown or both are the same.
pub(super) struct CrsTransform<'a> {
    from: Option<&'a Crs>,
    /// The system of the output.
    pub to: Option<&'a Crs>,
    /// The longitude of the raster's center in either system, where that is in degrees: results lie within 180° of it.
    from_center: Option<f64>,
    to_center: Option<f64>,
    /// Whether the raster's system is in degrees, and the height of its cells.
    degrees: Option<f64>,
}

impl<'a> CrsTransform<'a> {
    pub fn new(raster: &Raster, from: Option<&'a Crs>, to: Option<&'a Crs>) -> Self {
        let is_in_degrees = |crs: &&Crs| crs.is_geographic();
        let from_center = from.filter(is_in_degrees).map(|_| raster.center().x);
        let degrees = from.filter(is_in_degrees).map(|_| raster.spacing().y);
        let transform = Self { from, to, from_center, to_center: None, degrees };
        let center = to.filter(is_in_degrees).and_then(|_| transform.forward(raster.center()).ok());
        Self { to_center: center.map(|center| center.x), ..transform }
    }

    /// Transforms from the raster's system.
    pub fn forward(&self, at: DVec2) -> Result<DVec2, CrsError> {
        match (self.from, self.to) {
            (Some(from), Some(to)) => {
                let at = self.degrees.map_or(at, |cell| up_to_pole(at, cell));
                from.transform(to, at).map(|at| nearest_turn(at, self.to_center))
            }
            _ => Ok(at),
        }
    }

    /// Transforms to the raster's system.
    pub fn back(&self, at: DVec2) -> Option<DVec2> {
        match (self.from, self.to) {
            (Some(from), Some(to)) => {
                to.transform(from, at).ok().map(|at| nearest_turn(at, self.from_center))
            }
            _ => Some(at),
        }
    }

    /// Refuses a raster over a pole: it has no border in degrees.
    pub fn check_poles(&self, raster: &Raster) -> Result<(), WarpError> {
        let (Some(from), Some(to)) = (self.from, self.to) else { return Ok(()) };
        if from.is_geographic() || !to.is_geographic() {
            return Ok(());
        }
        let contains = |latitude: f64| {
            let pole = to.transform(from, DVec2::new(0.0, latitude)).map(|at| raster.grid_from_map(at));
            // A projection may return anything for a pole that it does not cover: the result must transform back to it.
            let leads_back = |at: DVec2| {
                let back = from.transform(to, raster.map_from_grid.transform_point2(at));
                back.is_ok_and(|back| (back.y - latitude).abs() < 1e-6)
            };
            let is_within = |at: DVec2| at.cmpge(DVec2::ZERO).all() && at.cmple(raster.grid_size()).all();
            pole.is_ok_and(|at| is_within(at) && leads_back(at))
        };
        if contains(90.0) || contains(-90.0) { Err(WarpError::Pole(to.name().into())) } else { Ok(()) }
    }
}

/// A position in the raster's system `own`; one in degrees that lies less than a cell beyond a pole, as the border of samples
/// on the pole does, is on the pole.
pub(super) fn on_earth(raster: &Raster, own: &Crs, at: DVec2) -> DVec2 {
    if own.is_geographic() { up_to_pole(at, raster.spacing().y) } else { at }
}

/// A position in degrees that lies less than `cell` beyond a pole, on the pole; others as they are.
fn up_to_pole(at: DVec2, cell: f64) -> DVec2 {
    if at.y.abs() - 90.0 < cell { DVec2::new(at.x, at.y.clamp(-90.0, 90.0)) } else { at }
}

/// The position by whole turns of 360° whose longitude is nearest to `center`.
fn nearest_turn(at: DVec2, center: Option<f64>) -> DVec2 {
    let turns = center.map_or(0.0, |center| ((center - at.x) / 360.0).round());
    if turns == 0.0 { at } else { DVec2::new(at.x + 360.0 * turns, at.y) }
}

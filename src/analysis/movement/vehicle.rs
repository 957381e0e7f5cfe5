//! Vehicles, and people on foot: what ground they can cross, and how fast.

use crate::land::RoadSurface;

/// A vehicle, or people on foot.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// The name by which analyses refer to it.
    pub name: String,
    /// How it moves.
    pub drive: Drive,
    /// Slopes uphill in percent: up to the first it goes freely, up to the second slowly, above that not.
    pub slope_up_percent: [f64; 2],
    /// The same downhill.
    pub slope_down_percent: [f64; 2],
    /// The same across its way.
    pub slope_across_percent: [f64; 2],
    /// Its speed on level open ground, km/h.
    pub speed_kmh: f64,
    /// Its greatest speed on each surface of road, km/h, from [`RoadSurface::Path`] to [`RoadSurface::Motorway`].
    pub road_speed_kmh: [f64; 5],
    /// The depth of water that it wades, meters.
    pub ford_m: f64,
    /// The width of a gap that it crosses, meters.
    pub gap_m: f64,
    /// The height of a step that it climbs, meters.
    pub step_m: f64,
    /// Its width, meters.
    pub width_m: f64,
    /// The diameter of stems that it pushes over, meters.
    pub stem_m: f64,
    /// Its mass, tonnes.
    pub mass_t: f64,
}

/// How a vehicle moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// On foot.
    Foot,
    /// On wheels.
    Wheels,
    /// On tracks.
    Tracks,
}

impl Vehicle {
    /// Its greatest speed on a surface of road, km/h; that of open ground where there is no road.
    pub fn speed_on_kmh(&self, surface: RoadSurface) -> f64 {
        match (surface as usize).checked_sub(1) {
            Some(index) => self.road_speed_kmh[index],
            None => self.speed_kmh,
        }
    }
}

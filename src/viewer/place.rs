//! A place on the ground in words: coordinates of the scene, longitude and latitude, grid reference, height, slope.

use glam::DVec2;

use crate::geom::crs::Crs;
use crate::geom::mgrs;
use crate::pipeline::positions::format_position;
use crate::scene::SceneModel;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::gradient::{Gradient, GradientSurface, ground_gradient};
use crate::terrain::query::{Interpolation, ground_height};

/// The digits of each half of a grid reference: one meter.
const MGRS_DIGITS: u8 = 5;

/// What is known about a place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaceText {
    /// Map coordinates, with the name of their system.
    pub map: String,
    /// Longitude and latitude on WGS 84, degrees; empty where the system has no place on Earth.
    pub geographic: String,
    /// The reference in the military grid; empty where there is none.
    pub grid: String,
    /// The ground's height, with its surface; or why there is none.
    pub height: String,
    /// The ground's slope, with the direction that it faces.
    pub slope: String,
}

impl PlaceText {
    /// The place `at`, in map coordinates of `scene`, on the ground `lattice`, at the heights that are drawn.
    pub fn of(scene: &SceneModel, lattice: &Lattice, at: DVec2) -> Self {
        let place = scene.crs.transform(&Crs::wgs84(), at).ok();
        let gradient = ground_gradient(lattice, GradientSurface::Planar, at);
        let gradient = gradient.map(|Gradient(drawn)| Gradient(drawn / f64::from(scene.scale.0)));
        Self {
            map: format!("{} ({})", format_position(&scene.crs, at), scene.crs.name()),
            geographic: place.map(|place| format!("{:.5}°, {:.5}°", place.x, place.y)).unwrap_or_default(),
            grid: place.and_then(|place| mgrs::reference(place, MGRS_DIGITS)).unwrap_or_default(),
            height: match ground_height(lattice, Interpolation::Planar, at).height_m() {
                Some(drawn_m) => format!("{:.1} m (ground)", scene.scale.elevation_m(drawn_m)),
                None => "no height".to_owned(),
            },
            slope: gradient.map_or_else(
                |_| String::new(),
                |gradient| {
                    let toward = gradient.aspect_deg().map(|degrees| format!(" toward {}", compass(degrees)));
                    format!("{:.0}°{}", gradient.slope_deg(), toward.unwrap_or_default())
                },
            ),
        }
    }

    /// All of it in one line.
    pub fn line(&self) -> String {
        let parts = [&self.map, &self.geographic, &self.grid, &self.height];
        let parts = parts.into_iter().filter(|part| !part.is_empty()).cloned();
        let slope = (!self.slope.is_empty()).then(|| format!("slope {}", self.slope));
        parts.chain(slope).collect::<Vec<_>>().join("   ")
    }
}

/// The point of the compass nearest to a direction in degrees clockwise from north.
pub fn compass(degrees: f64) -> &'static str {
    const POINTS: [&str; 8] = ["N", "NE", "E", "SE", "S", "SW", "W", "NW"];
    POINTS[((degrees / 45.0).round().rem_euclid(8.0)) as usize % 8]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::viewing::{ViewedHeights, open_to_view};
    use crate::terrain::query::Surface;
    use std::path::Path;

    #[test]
    fn a_place_is_told_in_every_system_with_height_and_slope() {
        let scene = open_to_view(Path::new("scenes/road.toml"), &[], ViewedHeights::AsStated, &|_| ())
            .expect("sound");
        let at = DVec2::new(750_000.0, 4_018_000.0);
        let drawn = scene.scale.drawn(&scene.lattice);
        let place = PlaceText::of(&scene, &drawn, at);
        let height = scene.heights.height(Surface::Ground, Interpolation::Planar, at).height_m();
        assert_eq!(place.height, format!("{:.1} m (ground)", height.expect("ground")));
        assert_eq!(place.map, "750000, 4018000 (EPSG:32616)");
        assert_eq!(place.geographic, "-84.23142°, 36.27477°");
        assert_eq!(place.grid, "16SGF5000018000");
        assert!(place.slope.contains("° toward "), "{place:?}");
        let outside = PlaceText::of(&scene, &drawn, at + 1e6);
        assert_eq!((outside.height.as_str(), outside.slope.as_str()), ("no height", ""));
        assert!(!outside.line().contains("slope"));
    }

    #[test]
    fn directions_have_the_nearest_point_of_the_compass() {
        assert_eq!(
            [0.0, 22.0, 23.0, 180.0, 337.0, 338.0, 359.9].map(compass),
            ["N", "N", "NE", "S", "NW", "N", "N"]
        );
    }
}

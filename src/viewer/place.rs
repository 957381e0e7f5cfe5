//! A place in words: coordinates of the scene, longitude and latitude, grid reference, height, slope.

use sandtable_base::message::numbers::fixed;
use sandtable_draw::list::FeatureId;
use sandtable_query::positions::format_position;
use sandtable_scene::scene_model::SceneModel;
use sandtable_walk::pick::WalkPick;

/// The texts about a place; a text is empty where nothing is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaceText {
    /// Map coordinates, with the name of their system.
    pub map: String,
    /// Longitude and latitude on WGS 84, degrees.
    pub geographic: String,
    /// The reference in the military grid.
    pub grid: String,
    /// The ground's height, with its surface.
    pub height: String,
    /// The height of the object there, where it differs from the ground.
    pub top: String,
    /// The ground's slope, with the direction that it faces.
    pub slope: String,
    /// How far away it is.
    pub distance: String,
}

/// What stands less than this over ground, in meters, lies on it.
const LYING_M: f64 = 0.05;

impl PlaceText {
    /// The texts of a picked place in `scene`.
    pub fn of(scene: &SceneModel, pick: &WalkPick) -> Self {
        let ground = pick.ground_m.map(|ground_m| format!("{} m (ground)", fixed(ground_m, 1)));
        // Ground of which no height is known is not in memory.
        let is_above = pick.ground_m.map_or(pick.place.feature != FeatureId::GROUND, |ground_m| {
            (pick.place.elevation_m - ground_m).abs() > LYING_M
        });
        let top = is_above.then(|| format!("{} m", fixed(pick.place.elevation_m, 1)));
        let slope = pick.slope_deg.map(|degrees| {
            let toward = pick.aspect_deg.map(|aspect| format!(" toward {}", compass(aspect)));
            format!("{degrees:.0}°{}", toward.unwrap_or_default())
        });
        Self {
            map: format!("{} ({})", format_position(&scene.crs, pick.place.at), scene.crs.name()),
            geographic: pick
                .lonlat
                .map(|place| format!("{}°, {}°", fixed(place.x, 5), fixed(place.y, 5)))
                .unwrap_or_default(),
            grid: pick.mgrs.clone().unwrap_or_default(),
            height: ground.unwrap_or_default(),
            top: top.unwrap_or_default(),
            slope: slope.unwrap_or_default(),
            distance: format!("{:.0} m", pick.place.distance_m),
        }
    }

    /// All of it in one line, but for the distance.
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
    use glam::{DVec2, DVec3};
    use sandtable_editing::viewing::open_to_view;
    use sandtable_terrain::query::{Interpolation, Surface};
    use sandtable_terrain::sight::ray::Ray;
    use sandtable_walk::Walk;
    use sandtable_walk::frame::WalkOptions;
    use std::path::Path;
    use std::sync::Arc;

    #[test]
    fn a_place_is_told_in_every_system_with_height_and_slope() {
        let editor = open_to_view(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml")), &[])
            .expect("readable");
        let scene = editor.source().build(&|_| ()).expect("sound");
        let walk = Walk::new(Arc::new(scene), WalkOptions::default());
        let scene = walk.scene();
        let at = DVec2::new(750_000.3, 4_018_000.3);
        let origin = (at - scene.lattice.origin()).extend(9_000.0);
        let pick = walk.pick(Ray { origin, direction: -DVec3::Z }, None).expect("ground");
        let place = PlaceText::of(scene, &pick);
        let height_m = scene.heights.height(Surface::Ground, Interpolation::Planar, at).height_m();
        assert_eq!(place.height, format!("{:.1} m (ground)", height_m.expect("ground")));
        assert_eq!(place.map, "750000, 4018000 (EPSG:32616)");
        assert_eq!(place.grid, "16SGF5000018000");
        assert!(place.geographic.starts_with("-84.2") && place.geographic.contains("°, 36.27"), "{place:?}");
        assert!(place.slope.contains("° toward ") && place.line().contains("slope"), "{place:?}");
    }

    #[test]
    fn directions_have_the_nearest_point_of_the_compass() {
        let named = [0.0, 22.0, 23.0, 180.0, 337.0, 338.0, 359.9].map(compass);
        assert_eq!(named, ["N", "N", "NE", "S", "NW", "N", "N"]);
    }
}

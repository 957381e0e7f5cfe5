//! What coordinates a scene has in the system of a grid.

use glam::DVec2;

use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_scene::scene_model::SceneModel;

/// Points along each side of the scene that tell what coordinates it has.
const SIDE_POINTS: u32 = 33;
/// A scene whose longitudes leave a gap that is narrower than this, in degrees, goes round the Earth: its points are that
/// far apart at the most.
const NARROWEST_GAP_DEG: f64 = 30.0;

/// Map coordinates spread over the scene: along its border, and inside.
pub fn places(scene: &SceneModel) -> impl Iterator<Item = DVec2> + use<> {
    let extent = scene.lattice.map_extent();
    (0..SIDE_POINTS * SIDE_POINTS).map(move |index| {
        let share = DVec2::new(f64::from(index % SIDE_POINTS), f64::from(index / SIDE_POINTS));
        extent.min + extent.size() * share / f64::from(SIDE_POINTS - 1)
    })
}

/// The longitudes and latitudes of [`places`] on WGS 84, degrees.
pub fn places_on_earth(scene: &SceneModel) -> impl Iterator<Item = DVec2> {
    places(scene).filter_map(|at| scene.crs.transform(&Crs::wgs84(), at).ok())
}

/// The box around `places`, wider by what lies between two of them; empty for none.
pub fn box_around(places: impl Iterator<Item = DVec2>) -> Rect {
    let around = Rect::around(places);
    if around.is_empty() { around } else { around.grown(between(&around)) }
}

/// The box of the scene's longitudes and latitudes on WGS 84, degrees; empty where it has no place on Earth.
///
/// Longitudes grow eastward from the western border, which lies in −180..180: a scene that crosses 180° has longitudes
/// above 180, and one that goes round a pole has all of them.
pub fn geographic_box(scene: &SceneModel) -> Rect {
    let places: Vec<DVec2> = places_on_earth(scene).collect();
    let poles = [-90.0, 90.0].map(|latitude| holds_pole(scene, latitude));
    geographic_box_around(&places, poles)
}

/// The box around longitudes and latitudes, with the south pole and the north pole or without them.
fn geographic_box_around(places: &[DVec2], [south, north]: [bool; 2]) -> Rect {
    let around = Rect::around(places.iter().copied());
    if around.is_empty() {
        return around;
    }
    let (west, east) = if south || north { (-180.0, 180.0) } else { longitudes(places) };
    let mut whole = Rect { min: DVec2::new(west, around.min.y), max: DVec2::new(east, around.max.y) };
    let more = between(&whole);
    let turn = (east - west + 2.0 * more).min(360.0);
    whole.min.x = if turn < 360.0 { wrapped_deg(west - more) } else { -180.0 };
    whole.max.x = whole.min.x + turn;
    whole.min.y = if south { -90.0 } else { (whole.min.y - more).max(-90.0) };
    whole.max.y = if north { 90.0 } else { (whole.max.y + more).min(90.0) };
    whole
}

/// What may lie between two places of a box.
fn between(around: &Rect) -> f64 {
    around.size().max_element() / f64::from(SIDE_POINTS - 1)
}

/// A longitude as −180..180 degrees.
pub fn wrapped_deg(longitude: f64) -> f64 {
    (longitude + 180.0).rem_euclid(360.0) - 180.0
}

/// The shortest way eastward past all longitudes, from its western end in −180..180.
fn longitudes(places: &[DVec2]) -> (f64, f64) {
    let mut all: Vec<f64> = places.iter().map(|place| wrapped_deg(place.x)).collect();
    all.sort_by(f64::total_cmp);
    let (first, last) = (all[0], all[all.len() - 1]);
    let inner = all.windows(2).map(|pair| (pair[1] - pair[0], pair[1], pair[0] + 360.0));
    let gaps = inner.chain([(first + 360.0 - last, first, last)]);
    let widest = gaps.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(gap, ..)| *gap > NARROWEST_GAP_DEG);
    widest.map_or((-180.0, 180.0), |(_, west, east)| (west, east))
}

/// Whether the scene lies round a pole.
fn holds_pole(scene: &SceneModel, latitude: f64) -> bool {
    let at = Crs::wgs84().transform(&scene.crs, DVec2::new(0.0, latitude)).ok();
    // Some projections give a pole a place that is none.
    let is_place = |at: &DVec2| {
        scene.crs.transform(&Crs::wgs84(), *at).is_ok_and(|back| (back.y - latitude).abs() < 1e-6)
    };
    at.filter(|at| scene.lattice.map_extent().contains(*at)).is_some_and(|at| is_place(&at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(longitudes: &[f64], poles: [bool; 2]) -> Rect {
        let places: Vec<DVec2> =
            longitudes.iter().flat_map(|&x| [50.0, 52.0].map(|y| DVec2::new(x, y))).collect();
        geographic_box_around(&places, poles)
    }

    #[test]
    fn a_scene_across_180_degrees_is_as_wide_as_it_is() {
        let across = around(&[179.0, 179.5, -180.0, -179.5, -179.0], [false; 2]);
        let more = 2.0 / 32.0;
        assert_eq!((across.min.x, across.max.x), (179.0 - more, 181.0 + more));
        let beside = around(&[7.0, 8.0, 9.0], [false; 2]);
        assert_eq!((beside.min.x, beside.max.x), (7.0 - more, 9.0 + more));
        assert_eq!((beside.min.y, beside.max.y), (50.0 - more, 52.0 + more));
        let east = around(&[-179.99, -179.0], [false; 2]);
        assert!(east.min.x > 179.9 && east.max.x < 181.1, "{east:?}");
    }

    #[test]
    fn a_scene_round_a_pole_or_the_earth_has_all_longitudes() {
        let pole = around(&[10.0, 130.0, -110.0], [false, true]);
        assert_eq!((pole.min.x, pole.max.x, pole.max.y), (-180.0, 180.0, 90.0));
        let all: Vec<f64> = (0..33).map(|step| f64::from(step) * 11.25 - 180.0).collect();
        let world = around(&all, [false; 2]);
        assert_eq!((world.min.x, world.max.x), (-180.0, 180.0));
        assert!(geographic_box_around(&[], [false; 2]).is_empty());
    }
}

//! Finds out why points lie off the ground: exchanged coordinates, another zone, or another system with which it would hold
//! them.

use glam::DVec2;

use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;

/// A correction with which points off the ground would lie on it.
#[derive(Clone, Debug, PartialEq)]
pub enum Misplacement {
    /// Their coordinates exchanged.
    AxesSwapped,
    /// Another zone of the same kind of system.
    Zone(Crs),
    /// Another system.
    System(Crs),
}

/// EPSG's first codes of systems with 60 zones: UTM on WGS 84, north and south, on ETRS89 and on NAD83.
const ZONED: [u32; 4] = [32600, 32700, 25800, 26900];
/// Systems that data are most often in: longitude and latitude, and Web Mercator.
const USUAL: [u32; 2] = [4326, 3857];

/// The correction that puts most of `points`, written in `from`, into `ground`, a box in `scene`; `None` where none that is
/// tried does.
pub fn misplacement(points: &[DVec2], from: &Crs, scene: &Crs, ground: &Rect) -> Option<Misplacement> {
    let holds = |crs: &Crs, point: &dyn Fn(DVec2) -> DVec2| {
        let is_on = |at: &&DVec2| crs.transform(scene, point(**at)).is_ok_and(|at| ground.contains(at));
        2 * points.iter().filter(is_on).count() > points.len()
    };
    let as_written = |at: DVec2| at;
    if holds(from, &|at| DVec2::new(at.y, at.x)) {
        return Some(Misplacement::AxesSwapped);
    }
    let other = |code: &u32| Crs::from_epsg(*code).ok().filter(|crs| crs != from);
    if let Some(crs) = zones(from).iter().filter_map(other).find(|crs| holds(crs, &as_written)) {
        return Some(Misplacement::Zone(crs));
    }
    let usual = USUAL.iter().filter_map(other).chain((scene != from).then(|| scene.clone()));
    usual.into_iter().find(|crs| holds(crs, &as_written)).map(Misplacement::System)
}

/// The codes of the zones of the kind of `crs`; none of a system without zones.
fn zones(crs: &Crs) -> Vec<u32> {
    let code = crs.epsg().unwrap_or_default();
    let is_of = |first: &&u32| (**first + 1..=**first + 60).contains(&code);
    match ZONED.iter().find(is_of) {
        // The other hemisphere has the same coordinates 10,000 km off.
        Some(32600 | 32700) => (32601..=32660).chain(32701..=32760).collect(),
        Some(first) => (first + 1..=first + 60).collect(),
        None => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten kilometers of ground near Jacksboro, Tennessee, in zone 16.
    fn ground() -> (Crs, Rect) {
        let crs = Crs::from_epsg(32616).expect("a zone");
        (crs, Rect { min: DVec2::new(745_000.0, 4_015_000.0), max: DVec2::new(755_000.0, 4_025_000.0) })
    }

    fn found(points: &[[f64; 2]], from: u32) -> Option<Misplacement> {
        let (scene, rect) = ground();
        let points: Vec<DVec2> = points.iter().map(|&at| DVec2::from(at)).collect();
        misplacement(&points, &Crs::from_epsg(from).expect("a system"), &scene, &rect)
    }

    #[test]
    fn exchanged_coordinates_are_found_in_meters_and_in_degrees() {
        let swapped = Some(Misplacement::AxesSwapped);
        assert_eq!(found(&[[4_018_000.0, 750_000.0], [4_019_000.0, 751_000.0]], 32616), swapped);
        assert_eq!(found(&[[36.29, -84.22]], 4326), swapped);
    }

    #[test]
    fn the_zone_that_fits_is_found() {
        let (zone_16, _) = ground();
        let zone_17 = Crs::from_epsg(32617).expect("a zone");
        let at = DVec2::new(750_000.0, 4_018_000.0);
        let there = zone_16.transform(&zone_17, at).expect("near the zones' border");
        assert_eq!(found(&[there.into()], 32615), Some(Misplacement::Zone(zone_17)));
        assert_eq!(found(&[at.into()], 32617), Some(Misplacement::Zone(zone_16.clone())));
        assert_eq!(found(&[at.into()], 32716), Some(Misplacement::Zone(zone_16)));
    }

    #[test]
    fn degrees_and_web_mercator_are_found_where_they_are_taken_for_meters() {
        let system = |code| Crs::from_epsg(code).ok().map(Misplacement::System);
        assert_eq!(found(&[[-84.22, 36.29]], 32616), system(4326));
        let (zone_16, _) = ground();
        let mercator = Crs::from_epsg(3857).expect("a system");
        let there = zone_16.transform(&mercator, DVec2::new(750_000.0, 4_018_000.0)).expect("on Earth");
        assert_eq!(found(&[there.into()], 32616), system(3857));
    }

    #[test]
    fn points_that_are_elsewhere_are_explained_by_nothing() {
        assert_eq!(found(&[[10.0, 10.0]], 32616), None);
        assert_eq!(found(&[[700_000.0, 4_100_000.0]], 32616), None);
    }
}

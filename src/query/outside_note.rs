//! Suggests corrections for positions that all lie outside an elevation model.

use glam::DVec2;

use sandtable_base::message::numbers::fixed;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_raster::answer::Answer;
use sandtable_raster::raster::Raster;
use sandtable_scene::misplacement::{Misplacement, misplacement};

/// As many positions are looked at: a mistake in the system is one of all of them.
const MOST_TRIED: usize = 1000;

/// The extent of the elevation, and a correction with which the positions, written in `crs`, would lie on it; `None` where
/// one of them does, and without positions. `header` is the raster, whose samples may be left out.
pub fn outside_note(answers: &[Answer], at: &[DVec2], crs: &Crs, header: &Raster) -> Option<String> {
    if answers.is_empty() || !answers.iter().all(|answer| matches!(answer, Answer::Outside)) {
        return None;
    }
    let local = Crs::local();
    let own = header.crs.as_ref().unwrap_or(&local);
    let covered = header.extent();
    let which = if at.len() == 1 { "the position lies" } else { "all positions lie" };
    let tried = &at[..at.len().min(MOST_TRIED)];
    if tried.iter().any(|at| crs.transform(own, *at).is_ok_and(|at| covered.contains(at))) {
        // The ground of a scene is smaller than its elevation.
        return None;
    }
    let found = misplacement(tried, crs, own, &covered).or_else(|| {
        let zone = zone_of(&covered, own)?;
        let is_there = |at: &&DVec2| zone.transform(own, **at).is_ok_and(|at| covered.contains(at));
        (2 * tried.iter().filter(is_there).count() > tried.len()).then_some(Misplacement::System(zone))
    });
    let advice = match found {
        Some(Misplacement::AxesSwapped) => "; with the two coordinates exchanged it is on it".to_owned(),
        Some(Misplacement::Zone(system) | Misplacement::System(system)) => {
            format!("; in {0} it is on it: say --crs {0}", system.name())
        }
        None => String::new(),
    };
    let Rect { min, max } = covered;
    let written = |value: f64| fixed(value, if own.is_geographic() { 4 } else { 0 });
    Some(format!(
        "{which} outside the elevation, which covers {} to {} and {} to {} in {}{advice}",
        written(min.x),
        written(max.x),
        written(min.y),
        written(max.y),
        own.name(),
    ))
}

/// The UTM zone, or UPS, at the middle of elevation in degrees.
fn zone_of(covered: &Rect, own: &Crs) -> Option<Crs> {
    let middle = Some(covered.center()).filter(|_| own.is_geographic())?;
    Some(Crs::utm_or_ups_at(middle.x, middle.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_raster::raster::{Samples, north_up_nodes};

    /// A degree of ground in Tennessee.
    fn header() -> Raster {
        let raster = Raster::new(11, Samples::F32(vec![1.0; 121]));
        let mut raster = raster.placed(north_up_nodes(DVec2::new(-85.0, 37.0), DVec2::splat(0.1)));
        raster.crs = Some(Crs::wgs84());
        raster
    }

    fn note(at: [f64; 2], epsg: u32) -> Option<String> {
        let crs = Crs::from_epsg(epsg).expect("a system");
        outside_note(&[Answer::Outside], &[DVec2::from(at)], &crs, &header())
    }

    #[test]
    fn positions_in_another_system_are_told_which() {
        let told = note([750_000.0, 4_018_000.0], 4326).expect("outside");
        assert!(told.ends_with("in EPSG:32616 it is on it: say --crs EPSG:32616"), "{told}");
        let told = note([-84.2, 36.3], 32616).expect("outside");
        assert!(told.contains("say --crs EPSG:4326"), "{told}");
        let told = note([36.3, -84.2], 4326).expect("outside");
        assert!(told.ends_with("with the two coordinates exchanged it is on it"), "{told}");
    }

    #[test]
    fn positions_elsewhere_are_told_what_the_elevation_covers() {
        let told = note([7.4, 43.7], 4326).expect("outside");
        assert_eq!(
            told,
            "the position lies outside the elevation, which covers -85.0500 to -83.9500 and 35.9500 to 37.0500 in EPSG:4326"
        );
        assert_eq!(outside_note(&[Answer::NoData], &[DVec2::ZERO], &Crs::wgs84(), &header()), None);
        assert_eq!(outside_note(&[], &[], &Crs::wgs84(), &header()), None);
    }
}

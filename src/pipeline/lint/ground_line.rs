//! The scene's ground along the line of a feature, and places in messages.

use glam::DVec2;

use crate::geom::polyline::Polyline;
use crate::geom::profile::Profile;
use crate::scene::SceneModel;
use crate::terrain::profile::profile;

/// The ground along `line`, world coordinates, in meters by meters from its start; NaN where there is none. Costs three
/// stations a cell.
pub fn ground_along(scene: &SceneModel, line: &Polyline) -> Option<Profile> {
    let origin = scene.lattice.origin();
    let map: Vec<DVec2> = line.points().iter().map(|&at| at + origin).collect();
    let stations = profile(&scene.lattice, &map);
    let heights = stations.iter().map(|at| at.ground.height_m().unwrap_or(f64::NAN)).collect();
    Profile::new(stations.iter().map(|at| at.station_m).collect(), heights)
}

/// A place in world coordinates as a message states it: in the scene's system, to the meter.
pub fn place(scene: &SceneModel, world: DVec2) -> String {
    let at = world + scene.lattice.origin();
    format!("({:.0}, {:.0})", at.x, at.y)
}

/// The steepest rise or fall of a profile over stretches `base` long, as meters a meter, with the station where that
/// stretch begins. `None` where no stretch of that length has ground all along.
pub fn steepest_over(ground: &Profile, base: f64) -> Option<(f64, f64)> {
    let [first, last] = ground.span();
    // A straight profile is steepest over a stretch that begins or ends at one of its stations.
    let starts = ground.stations().iter().flat_map(|&at| [at, at - base]);
    let starts = starts.filter(|&from| from >= first && from + base <= last);
    let grade = |from: f64| (((ground.at(from + base) - ground.at(from)) / base).abs(), from);
    // A NaN is less than any number.
    starts
        .map(grade)
        .filter(|(grade, _)| grade.is_finite())
        .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steepest_stretch_is_found_wherever_its_ends_are() {
        let stations = vec![0.0, 40.0, 50.0, 65.0, 200.0];
        let ground = Profile::new(stations, vec![0.0, 0.0, 5.0, 5.5, 5.5]).expect("stations rise");
        let (grade, from) = steepest_over(&ground, 20.0).expect("there is ground");
        assert!((grade - (5.0 + 10.0 / 30.0) / 20.0).abs() < 1e-12 && from == 40.0, "{grade} {from}");
        assert_eq!(steepest_over(&ground, 201.0), None);
        let hole = Profile::new(vec![0.0, 10.0, 20.0], vec![1.0, f64::NAN, 2.0]).expect("stations rise");
        assert_eq!(steepest_over(&hole, 5.0), None);
    }
}

//! The scene's ground along the line of a feature, and places in messages.

use glam::DVec2;

use sandtable_base::message::numbers::fixed;
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::profile::profile;

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
    format!("({}, {})", fixed(at.x, 0), fixed(at.y, 0))
}

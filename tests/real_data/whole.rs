//! Five places whole: every road, bridge, building, stream, tree and patch of land that their files hold.

use sandtable_earthworks::alignment::Support;
use sandtable_ribbon::partition::overlap_m2;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;

use crate::common::places::text_of;
use crate::common::scratch::Scratch;
use crate::{clearance_of_draped, picture};

/// Builds the place and holds its scene and its pictures to what every scene must be.
fn built(place: &str) -> Option<SceneModel> {
    let (text, allowed) = text_of(place)?;
    let scratch = Scratch::new();
    let scene = crate::scene(&scratch, &text, &allowed).unwrap_or_else(|error| panic!("{error}"));
    scene.ground().exact().check(scene.ground().layout());
    let plans: Vec<_> = scene.ribbons.iter().map(|ribbon| &ribbon.plan).collect();
    let area: f64 = plans.iter().map(|plan| plan.area_m2()).sum();
    let overlap = overlap_m2(plans.iter().copied());
    assert!(overlap <= 1e-4 * area, "{overlap} m² of {area} m² lie twice");
    for plan in plans {
        assert!(plan.corners().all(|[a, b, c]| (b.at - a.at).perp_dot(c.at - a.at) > 0.0), "all face up");
    }
    for view in scene.cameras.clone() {
        let pictured = picture(&scene, &view.name, &format!("whole_{place}_{}", view.name), (960, 540));
        let (clearance, corners) = clearance_of_draped(&pictured.shot);
        println!("{place} {}: {clearance} m at {corners} draped corners; {:?}", view.name, pictured.pixels);
        assert!(pictured.ground_pixels > 1000);
    }
    println!("{place}: {:?}", scene.census());
    scene.notes().iter().for_each(|note| println!("  {note}"));
    Some(scene)
}

fn count(scene: &SceneModel, wanted: FeatureKind) -> usize {
    scene.census().into_iter().find(|(kind, _)| *kind == wanted).map_or(0, |(_, count)| count)
}

#[test]
#[ignore = "slow: a whole place of real data"]
fn swellendam_has_all_its_roads_and_buildings() {
    let Some(scene) = built("swellendam") else { return };
    assert_eq!((count(&scene, FeatureKind::Road), count(&scene, FeatureKind::Building)), (717, 4708));
    assert_eq!(count(&scene, FeatureKind::Lake), 37);
    let conformed = scene.report.conformed_roads.len();
    assert!(conformed >= 100 && scene.profiles.len() == conformed, "{conformed}");
    let steepest = scene.profiles.iter().flat_map(|profile| {
        let on_ground = profile
            .design
            .stations()
            .windows(2)
            .zip(profile.design.values().windows(2))
            .zip(&profile.supports);
        on_ground
            .filter(|((stations, _), carried)| **carried == Support::Ground && stations[1] > stations[0])
            .map(|((stations, design), _)| (design[1] - design[0]).abs() / (stations[1] - stations[0]))
    });
    let steepest = steepest.fold(0.0, f64::max);
    assert!(steepest <= 0.08 + 1e-6, "{steepest}");
}

#[test]
#[ignore = "slow: a whole place of real data"]
fn porto_alegre_is_a_whole_city() {
    let Some(scene) = built("porto_alegre") else { return };
    // 15,852 lines with a highway; what begins or ends off the elevation model still counts.
    let (roads, bridges) = (count(&scene, FeatureKind::Road), count(&scene, FeatureKind::Bridge));
    assert!(roads > 15_800 && (180..=209).contains(&bridges), "{roads} roads, {bridges} bridges");
}

#[test]
#[ignore = "slow: a whole place of real data"]
fn monaco_has_bridges_and_tunnels_on_its_cliff() {
    let Some(scene) = built("monaco") else { return };
    assert_eq!((count(&scene, FeatureKind::Bridge), count(&scene, FeatureKind::Building)), (20, 964));
    assert!(count(&scene, FeatureKind::Tunnel) >= 40);
}

#[test]
fn taunton_s_trees_and_buildings_stand_on_its_ground() {
    let Some(scene) = built("taunton") else { return };
    assert_eq!((count(&scene, FeatureKind::Building), scene.placements.len()), (394, 52));
}

#[test]
#[ignore = "slow: a whole place of real data"]
fn wake_county_s_streams_never_rise() {
    let Some(scene) = built("wake") else { return };
    assert_eq!((count(&scene, FeatureKind::River), count(&scene, FeatureKind::Lake)), (2450, 6));
    assert_eq!(scene.report.rivers.len(), 2450);
}

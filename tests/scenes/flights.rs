//! Flights: the eye keeps its height, moves evenly and turns gradually.

use std::path::Path;

use glam::Vec3;
use sandtable_scene::scene_view::ViewAim;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_walk::flown_scene::open_scene_with_flight;

#[test]
fn the_eye_stays_above_the_ground_and_neither_jumps_nor_jerks() {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/river.toml");
    let (scene, flight) = open_scene_with_flight(&path, &[], None, &|_| ()).expect("sound");
    let ground = FullResolution { lattice: scene.ground().lattice() };
    let poses: Vec<(Vec3, Vec3)> = (0..=500)
        .map(|step| match flight.view(f64::from(step) / 500.0).aim {
            ViewAim::At { eye, target } => (eye, (target - eye).normalize()),
            _ => panic!("a flight has an eye"),
        })
        .collect();
    let step_m = flight.length_m() as f32 / 500.0;
    for (eye, forward) in &poses {
        let under = ground.displayed_z(eye.truncate().as_dvec2()).expect("over the model") as f32;
        let above = eye.z - under;
        assert!((90.0..700.0).contains(&above), "{above} m above the ground at {eye}");
        assert!((forward.z + libm::sinf(14f32.to_radians())).abs() < 1e-3, "{forward}");
    }
    for pair in poses.windows(2) {
        let [(from, before), (to, after)] = [pair[0], pair[1]];
        let moved = from.truncate().distance(to.truncate());
        assert!((moved - step_m).abs() < 0.02 * step_m, "{moved} of {step_m}");
        assert!((to.z - from.z).abs() < step_m, "climbs {} m", to.z - from.z);
        assert!(before.dot(after) > libm::cosf(4f32.to_radians()), "turns {}", before.dot(after));
    }
}

//! What each paper's criterion says of a vertex.

use glam::Vec3;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::anisotropic::Anisotropic;
use sandtable_roam::criterion::block::BlockRelief;
use sandtable_roam::criterion::midpoint::Midpoint;
use sandtable_roam::graph::Vertex;
use sandtable_view::camera::Camera;

use crate::refiners::terrain::Terrain;

/// Flat ground of 17 × 17 posts with a bump of 2 m in its middle, drawn 3 m high.
fn bump() -> Terrain {
    let mut heights = vec![0f32; 17 * 17];
    heights[8 * 17 + 8] = 2.0;
    Terrain::new(17, 16, heights)
}

const MIDDLE: Vertex = Vertex::new(8, 8);

/// From `offset` meters off the drawn bump, looking at it.
fn looking_from(offset: Vec3) -> Camera {
    let at = Vec3::new(24.0, 32.0, 3.0);
    Camera::new(at + offset, at, 0.8, (640, 480), (0.1, 9000.0)).expect("sound")
}

fn close(found: f32, meant: f32) {
    assert!((found - meant).abs() <= 1e-5 * meant.abs(), "{found} is not {meant}");
}

#[test]
fn variance_is_k_times_variance_times_land_width_over_distance() {
    let terrain = bump();
    let camera = looking_from(Vec3::new(0.0, 30.0, 40.0));
    let published = Midpoint::with_k(terrain.ground(), &terrain.midpoint, camera.eye(), 0.7);
    // The terrain is 16 cells of 3 × 4 m: 64 m wide; 50 m away; exaggerated 1.5 times.
    close(published.excess(MIDDLE), 0.7 * (2.0 * 1.5) * 64.0 / 50.0);
    let in_pixels = Midpoint::by_land_width(terrain.ground(), &terrain.midpoint, &camera, 2.0);
    close(in_pixels.excess(MIDDLE), 3.0 * camera.pixels_per_meter(50.0) / 2.0);
}

#[test]
fn roughness_is_projected_from_the_hypotenuse_s_midpoint() {
    let terrain = bump();
    let camera = looking_from(Vec3::new(0.0, 30.0, 40.0));
    let criterion = Midpoint::new(terrain.ground(), &terrain.midpoint, &camera, 2.0);
    close(criterion.excess(MIDDLE), 3.0 * camera.pixels_per_meter(50.0) / 2.0);
    let far = Midpoint::new(terrain.ground(), &terrain.midpoint, &looking_from(Vec3::Y * 100.0), 2.0);
    close(far.excess(MIDDLE), criterion.excess(MIDDLE) / 2.0);
}

#[test]
fn looking_straight_down_at_a_bump_shrinks_it_to_nothing() {
    let terrain = bump();
    let seen = |offset: Vec3| {
        let camera = looking_from(offset);
        let excess = Anisotropic::new(terrain.ground(), &terrain.midpoint, &camera, 2.0).excess(MIDDLE);
        (excess, Midpoint::new(terrain.ground(), &terrain.midpoint, &camera, 2.0).excess(MIDDLE))
    };
    assert_eq!(seen(Vec3::Z * 50.0).0, 0.0);
    let (aslant, as_roughness) = seen(Vec3::new(0.0, 30.0, 40.0));
    close(aslant, as_roughness * 30.0 / 50.0);
    let (level, as_roughness) = seen(Vec3::X * 50.0);
    close(level, as_roughness);
}

#[test]
fn a_block_is_refined_while_relief_times_half_its_side_over_distance_is_above_k() {
    let terrain = bump();
    let eye = looking_from(Vec3::new(0.0, 30.0, 40.0)).eye();
    let measure = 3.0 * (8.0 * 4.0) / 50.0;
    let wants = |k_m: f32| BlockRelief::with_k(terrain.ground(), &terrain.relief, eye, k_m).wants(MIDDLE);
    assert!(wants(measure * 0.999) && !wants(measure * 1.001));
}

#[test]
fn flat_ground_has_no_excess_and_an_eye_on_a_vertex_an_infinite_one() {
    let terrain = bump();
    let beside = Vertex::new(2, 3);
    for offset in [Vec3::new(0.0, 30.0, 40.0), Vec3::Z * 9.0] {
        let camera = looking_from(offset);
        for (name, criterion) in terrain.criteria(&camera, 0).into_iter().filter(|(name, _)| *name != "whim")
        {
            assert_eq!(criterion.excess(beside), 0.0, "{name}");
        }
    }
    let at = terrain.ground().position(MIDDLE);
    let inside = Camera::new(at, at + Vec3::Y, 0.8, (640, 480), (0.1, 9000.0)).expect("sound");
    let meant = ["midpoint", "variance", "anisotropic", "block"];
    for (name, criterion) in terrain.criteria(&inside, 0) {
        assert!(!meant.contains(&name) || criterion.excess(MIDDLE) == f32::INFINITY, "{name}");
        assert!(!criterion.excess(MIDDLE).is_nan(), "{name}");
    }
}

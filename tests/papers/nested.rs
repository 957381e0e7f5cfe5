//! 003: the nested error criterion.

use glam::Vec3;
use sandtable::roam::active::ActiveSet;
use sandtable::roam::criterion::Criterion;
use sandtable::roam::criterion::spheres::Spheres;
use sandtable::roam::graph::Vertex;
use sandtable::roam::refine::rebuild::rebuild;
use sandtable::roam::spheres::SphereMap;

use crate::{World, camera};

const TOLERANCE_PX: f32 = 3.0;

/// r = λ · d · δ / τ.
fn own_radii(world: &World) -> Vec<f32> {
    let reach = camera(Vec3::ZERO, Vec3::Y).pixels_per_metre(1.0) / TOLERANCE_PX;
    world.errors.values().iter().map(|error_m| error_m * reach).collect()
}

#[test]
fn paper_003_on_the_error_sphere_s_surface_an_error_spans_the_tolerance() {
    let world = World::hills(65, 65, 64);
    let own = own_radii(&world);
    let camera = camera(Vec3::ZERO, Vec3::Y * 10.0);
    for vertex in world.vertices() {
        let (index, error_m) = (world.layout.index(vertex), world.errors.at(&world.layout, vertex));
        if own[index] <= camera.planes().0 {
            continue;
        }
        let across = |off: f32| camera.project(Vec3::new(0.0, own[index], off)).map(|seen| seen.pixel.y);
        let (Some(low), Some(high)) = (across(-error_m * 0.5), across(error_m * 0.5)) else {
            panic!("{vertex:?} before the eye at {} m", own[index]);
        };
        assert!((low - high - TOLERANCE_PX).abs() < 1e-2, "{vertex:?}: {} px", low - high);
    }
}

#[test]
fn paper_003_a_sphere_is_its_own_or_holds_those_of_its_children() {
    let world = World::hills(97, 65, 32);
    let (own, ground) = (own_radii(&world), world.ground());
    let map = SphereMap::nested(ground, own.clone());
    for vertex in world.vertices() {
        let center = ground.position(vertex);
        let below = vertex
            .children()
            .filter(|&child| world.layout.contains(child) && map.at(&world.layout, child) > 0.0)
            .map(|child| center.distance(ground.position(child)) + map.at(&world.layout, child))
            .fold(0f32, f32::max);
        let expected = own[world.layout.index(vertex)].max(below);
        let found = map.at(&world.layout, vertex);
        assert!((found - expected).abs() <= expected * 2e-6, "{vertex:?}: {found} against {expected}");
    }
}

#[test]
fn paper_003_an_eye_inside_spheres_leaves_no_t_junction_without_any_forced_split() {
    let world = World::hills(97, 130, 32);
    let map = SphereMap::nested(world.ground(), own_radii(&world));
    for eye in [Vec3::new(300.0, 500.0, 60.0), Vec3::new(-400.0, 90.0, 300.0), Vec3::new(960.0, 1290.0, 5.0)]
    {
        let criterion = Spheres::new(world.ground(), &map, eye);
        let wanted: Vec<Vertex> =
            world.vertices().into_iter().filter(|&vertex| criterion.wants(vertex)).collect();
        for vertex in &wanted {
            for parent in vertex.parents().into_iter().filter(|&parent| world.layout.contains(parent)) {
                let there = world.layout.is_corner(parent) || criterion.wants(parent);
                assert!(there, "{vertex:?} without its parent {parent:?}");
            }
        }
        let mut directly = ActiveSet::new(world.layout);
        wanted.iter().for_each(|&vertex| directly.activate(vertex));
        assert_eq!(directly.count(), wanted.len(), "nothing was forced");
        assert!(directly == rebuild(&world.layout, &criterion, world.layout.patches()), "as by splits");
    }
}

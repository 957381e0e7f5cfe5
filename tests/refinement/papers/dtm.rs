//! Zhang, Wang and Wu: the digital terrain model.

use std::collections::BTreeSet;

use glam::{DVec2, Vec2, Vec3};
use sandtable_roam::active::ActiveSet;
use sandtable_roam::block::{BlockSource, WholeGround};
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::midpoint::Midpoint;
use sandtable_roam::culling::patches_in_view;
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::graph::Vertex;
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::spheres::{SphereMap, reach};
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_view::flight::{CircularFlight, GroundClearance};
use sandtable_view::frustum::Frustum;

use crate::papers::{World, camera, same};

#[test]
fn a_cell_is_read_as_a_constant_or_by_the_distances_to_the_four_around() {
    let world = World::new((3, 3), 2, |x, y| x * 10.0 + y * y * 7.0);
    let ask = |interpolation, x: f64, y: f64| {
        ground_height(&world.lattice, interpolation, DVec2::new(x, y)).height_m().expect("on the ground")
    };
    assert_eq!(ask(Interpolation::Nearest, 4.9, 0.0), 0.0);
    assert_eq!(ask(Interpolation::Nearest, 5.1, 0.0), 10.0, "the surface jumps between cells");
    let at = DVec2::new(3.0, 4.0);
    let corners = [(0.0, 0.0, 0.0), (10.0, 0.0, 10.0), (0.0, 10.0, 7.0), (10.0, 10.0, 17.0)];
    let weighted = corners.map(|(x, y, z)| (1.0 / at.distance(DVec2::new(x, y)), z));
    let (weights, sum) = weighted.iter().fold((0.0, 0.0), |(w, s), (weight, z)| (w + weight, s + weight * z));
    let found = ask(Interpolation::DistanceWeighted4, at.x, at.y);
    assert!((found - sum / weights).abs() < 1e-9, "{found} against {}", sum / weights);
    assert_eq!(ask(Interpolation::DistanceWeighted4, 10.0, 10.0), 17.0, "a post is itself");
}

#[test]
fn roughness_is_the_midpoint_less_the_mean_of_the_ends_a_node_s_the_largest() {
    let world = World::hills(33, 49, 16);
    let errors = ErrorMap::midpoint(&world.lattice, &world.layout);
    for vertex in world.vertices() {
        let expected = world.largest_below(vertex, &|vertex| world.midpoint_error(vertex));
        let found = errors.at(&world.layout, vertex);
        assert!(same(found, expected), "{vertex:?}: {found} against {expected}");
    }
    errors.check(&world.layout);
}

#[test]
fn the_distance_is_that_from_the_eye_to_the_hypotenuse_s_midpoint() {
    let world = World::hills(33, 49, 16);
    let errors = ErrorMap::midpoint(&world.lattice, &world.layout);
    let (camera, tolerance_px) = (camera(Vec3::new(-50.0, 70.0, 80.0), Vec3::new(200.0, 300.0, 0.0)), 2.0);
    let criterion = Midpoint::new(world.ground(), &errors, &camera, tolerance_px);
    for vertex in world.vertices() {
        let [from, to] = vertex.hypotenuse().map(|end| world.ground().plan(end));
        let midpoint = ((from + to) / 2.0).extend(world.height(vertex));
        let pixels =
            errors.at(&world.layout, vertex) * camera.pixels_per_meter(midpoint.distance(camera.eye()));
        assert!(same(criterion.excess(vertex), pixels / tolerance_px), "{vertex:?}: {pixels} px");
    }
}

#[test]
fn forced_splits_go_on_recursively_from_block_to_block() {
    let world = World::hills(129, 129, 32);
    let (mut active, mut order) = (ActiveSet::new(world.layout), Vec::new());
    active.activate_each(Vertex::new(33, 33), &mut |vertex| order.push(vertex));
    for (at, vertex) in order.iter().enumerate() {
        for parent in vertex.parents() {
            let before = world.layout.is_corner(parent) || order[..at].contains(&parent);
            assert!(before, "{parent:?} is split before {vertex:?}");
        }
    }
    let blocks = |vertex: &Vertex| (vertex.x / 32, vertex.y / 32);
    let touched: BTreeSet<_> = order.iter().map(blocks).collect();
    assert!(touched.len() >= 3, "a corner's split goes over to the blocks beside: {touched:?}");
}

#[test]
fn only_blocks_that_need_detail_get_trees() {
    // A hill in one block of a plain.
    let hill = |x: f32, y: f32| 20.0 * (1.0 - Vec2::new(x - 80.0, y - 112.0).length() / 12.0).max(0.0);
    let world = World::new((257, 257), 32, hill);
    let spheres = SphereMap::plain(world.ground(), &world.errors, 100.0);
    let source = WholeGround { ground: world.ground(), spheres: &spheres };
    let patches: Vec<Vertex> = world.layout.patches().collect();
    for (eye, needs_none) in [(Vec3::new(900.0, 1100.0, 50.0), false), (Vec3::new(0.0, 0.0, 90_000.0), true)]
    {
        let mut mesh = Deferred::new(source, 10.0).expect("small patches");
        mesh.update(eye, &patches).expect("in memory");
        let inside = |&&corner: &&Vertex| {
            let root = source.root(corner);
            root.radius > 0.0 && root.center.distance(eye) < root.radius
        };
        let needed = patches.iter().filter(inside).count();
        assert_eq!(mesh.meshes(), needed, "from {eye}");
        assert_eq!(needed == 0, needs_none);
        assert!(needed < 10, "{needed} of {} blocks", patches.len());
        let split = patches.iter().filter(|&&corner| mesh.indices(corner).len() > 2).count();
        assert!(split <= needed, "blocks without trees are two triangles each");
    }
}

#[test]
fn a_frame_of_a_terrain_with_sixty_three_times_the_samples_costs_hardly_more() {
    let frame_cost = |posts: u32| {
        let world = World::new((posts, posts), 64, |x, y| {
            30.0 * libm::sinf(x * 0.05) * libm::cosf(y * 0.04) + 3.0 * libm::sinf(x * 0.7 + y * 0.45)
        });
        let middle = world.lattice.extent().max.as_vec2() / 2.0;
        let circle = CircularFlight {
            center: middle,
            radius_m: 400.0,
            step_m: 4.0,
            clearance: GroundClearance { height_m: 60.0, smoothing_m: 10.0 },
        };
        let stations = circle.stations(120, &|_| 0.0);
        let first = stations[0].camera(1.0, 50_000.0).expect("sound");
        let spheres = SphereMap::plain(world.ground(), &world.errors, reach(&first, 4.0));
        let source = WholeGround { ground: world.ground(), spheres: &spheres };
        let mut mesh = Deferred::new(source, 10.0).expect("small patches");
        let (mut examined, mut triangles) = (0, 0);
        for (frame, station) in stations.iter().enumerate() {
            let camera = station.camera(1.0, 50_000.0).expect("sound");
            let seen = patches_in_view(world.ground(), &world.heights, &Frustum::new(&camera));
            mesh.update(camera.eye(), &seen).expect("in memory");
            if frame > 0 {
                examined += mesh.examined();
                triangles += mesh.triangle_count();
            }
        }
        (examined as f64, triangles as f64)
    };
    let (small, large) = (frame_cost(129), frame_cost(1025));
    assert!(large.0 < small.0 * 2.5, "{large:?} against {small:?}: vertices looked at, triangles shown");
    assert!(large.1 < small.1 * 2.5, "{large:?} against {small:?}: vertices looked at, triangles shown");
}

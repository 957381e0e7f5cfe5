//! Nested spheres: closed under parents without forcing, and what they promise on the picture (Yu and Zhang).

use std::sync::Arc;

use glam::{DVec2, Vec3};
use proptest::prelude::*;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::errors::midpoint::midpoint_error_at;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_roam::roughness::Roughness;
use sandtable_roam::spheres::{SphereMap, reach};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// Rough ground with hills, the same for the same seed; one post in `hole_every` has no data, 0 for none.
fn terrain(columns: u32, rows: u32, seed: u64, hole_every: u64) -> Lattice {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state >> 11
    };
    let heights = (0..columns * rows).map(|index| {
        let (x, y) = (f64::from(index % columns), f64::from(index / columns));
        let hills = 60.0 * libm::sin(x * 0.13 + seed as f64) + 45.0 * libm::sin(y * 0.17 - x * 0.05);
        let rough = (random() % 1000) as f64 * 0.01 * (1.0 + libm::sin(x * 0.05 + y * 0.08));
        if hole_every > 0 && random() % hole_every == 0 { f32::NAN } else { (400.0 + hills + rough) as f32 }
    });
    Lattice::new(DVec2::ZERO, DVec2::new(30.0, 25.0), columns, heights.collect()).expect("sound")
}

/// All three kinds of spheres.
fn kinds(ground: PatchedGround<'_>, reach: f32) -> [SphereMap; 3] {
    let midpoint = ErrorMap::midpoint(ground.lattice, ground.layout);
    let exact = ErrorMap::exact(ground.lattice, ground.layout);
    [
        SphereMap::plain(ground, &midpoint, reach),
        SphereMap::constrained(ground, reach, &Roughness::new(ground.lattice, (1, 1))),
        SphereMap::bounding(ground, &exact, reach),
    ]
}

/// The midpoint error of every vertex alone.
fn midpoint_errors(lattice: &Lattice, layout: &PatchLayout) -> Vec<f32> {
    let columns = layout.columns();
    let vertices = (0..layout.vertex_count())
        .map(|index| Vertex::new((index % columns) as i32, (index / columns) as i32));
    vertices.map(|vertex| midpoint_error_at(lattice, layout, vertex)).collect()
}

/// Radii nested one vertex at a time, the slow and obvious way.
fn nested_plainly(ground: PatchedGround<'_>, own: &[f32]) -> Vec<f32> {
    let layout = ground.layout;
    let mut radii = own.to_vec();
    let mut vertices: Vec<Vertex> = (0..layout.vertex_count())
        .map(|index| Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32))
        .filter(|&vertex| !layout.is_corner(vertex))
        .collect();
    let is_center = |vertex: Vertex| vertex.x & vertex.step() != 0 && vertex.y & vertex.step() != 0;
    vertices.sort_by_key(|&vertex| (vertex.step(), is_center(vertex)));
    for vertex in vertices {
        let center = ground.position(vertex).as_dvec3();
        for child in vertex.children().filter(|&child| layout.contains(child)) {
            let below = f64::from(radii[layout.index(child)]);
            if below > 0.0 {
                let needed = (ground.position(child).as_dvec3().distance(center) + below) * (1.0 + 1e-6);
                let slot = &mut radii[layout.index(vertex)];
                *slot = slot.max(needed as f32);
            }
        }
    }
    radii
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn whoever_is_inside_a_sphere_is_inside_its_parents_and_the_rebuild_finds_them_all(
        (columns, rows) in (2u32..90, 2u32..90), seed in 0u64..1000, hole_every in prop_oneof![Just(0u64), Just(40)],
        eye in (-500f32..3000.0, -500f32..2500.0, 300f32..2500.0), reach in 0.5f32..300.0,
    ) {
        let lattice = terrain(columns, rows, seed, hole_every);
        let layout = PatchLayout::new(columns, rows, 16).expect("sound");
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let eye = Vec3::from(eye);
        for map in kinds(ground, reach) {
            map.check(ground);
            let criterion = Spheres::new(ground, &map, eye);
            let active = rebuild(&layout, &criterion, layout.patches());
            for index in 0..layout.vertex_count() {
                let vertex = Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32);
                if layout.is_corner(vertex) {
                    continue;
                }
                let wanted = criterion.wants(vertex);
                prop_assert_eq!(active.is_active(vertex), wanted, "{:?}", vertex);
                for parent in vertex.parents() {
                    let holds = !layout.contains(parent) || layout.is_corner(parent) || criterion.wants(parent);
                    prop_assert!(!wanted || holds, "{:?} without {:?}", vertex, parent);
                }
            }
        }
    }

    #[test]
    fn row_sweeps_nest_as_one_vertex_at_a_time_does(
        (columns, rows) in (2u32..90, 2u32..90), seed in 0u64..1000, threads in 1usize..4,
    ) {
        let lattice = terrain(columns, rows, seed, 30);
        let layout = PatchLayout::new(columns, rows, 32).expect("sound");
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let own: Vec<f32> = midpoint_errors(&lattice, &layout).into_iter().map(|error| error * 7.0).collect();
        let expected = nested_plainly(ground, &own);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
        let found = pool.install(|| SphereMap::nested(ground, own));
        prop_assert!(found.values() == expected);
    }

    #[test]
    fn errors_of_a_vertex_alone_or_raised_give_the_same_plain_spheres(seed in 0u64..1000) {
        let lattice = terrain(65, 65, seed, 0);
        let layout = PatchLayout::new(65, 65, 64).expect("sound");
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let own = midpoint_errors(&lattice, &layout);
        let raised = SphereMap::plain(ground, &ErrorMap::raised(own.clone(), &layout), 20.0);
        let alone = own.into_iter().map(|error| (20.0 * f64::from(error)) as f32);
        let alone = SphereMap::nested(ground, alone.collect());
        prop_assert!(raised == alone);
    }
}

const SIDE: u32 = 97;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn bounding_spheres_keep_the_tolerance_at_every_post_of_the_picture(
        eye in (-500f32..3400.0, -500f32..3000.0, 760f32..3000.0),
        target in (0f32..2880.0, 0f32..2400.0),
        tolerance_px in 0.5f32..30.0,
    ) {
        static WORLD: std::sync::LazyLock<(Arc<Lattice>, PatchLayout, ErrorMap)> = std::sync::LazyLock::new(|| {
            let lattice = terrain(SIDE, SIDE, 5, 0);
            let layout = PatchLayout::new(SIDE, SIDE, 32).expect("sound");
            let errors = ErrorMap::exact(&lattice, &layout);
            (Arc::new(lattice), layout, errors)
        });
        let (lattice, layout, errors) = &*WORLD;
        let target = Vec3::new(target.0, target.1, 600.0);
        let camera = Camera::new(Vec3::from(eye), target, 0.8, (800, 600), (0.5, 20_000.0));
        prop_assume!(camera.is_ok());
        let camera = camera.expect("checked");
        let ground = PatchedGround { lattice, layout };
        let map = SphereMap::bounding(ground, errors, reach(&camera, tolerance_px));
        let active = rebuild(layout, &Spheres::new(ground, &map, camera.eye()), layout.patches());
        let shown = DisplayedTerrain::new(Arc::clone(lattice), active, layout.patches().collect());
        for post in lattice.posts().step_by(5) {
            let plan = lattice.position(post);
            let Some(z) = shown.displayed_z(plan.as_dvec2()) else { continue };
            let truth = plan.extend(lattice.height(post));
            let (Some(true_px), Some(shown_px)) = (camera.project(truth), camera.project(plan.extend(z as f32)))
            else { continue };
            let (width, height) = camera.size();
            let in_picture = (0.0..width as f32).contains(&true_px.pixel.x)
                && (0.0..height as f32).contains(&true_px.pixel.y);
            let off = true_px.pixel.distance(shown_px.pixel);
            prop_assert!(!in_picture || off <= tolerance_px * 1.01, "{} px at {:?}", off, post);
        }
    }
}

#[test]
fn level_ground_never_shows_and_a_hole_always_does() {
    let mut heights = vec![7.0; 17 * 17];
    let layout = PatchLayout::new(17, 17, 16).expect("sound");
    let make = |heights: &[f32]| Lattice::new(DVec2::ZERO, DVec2::ONE, 17, heights.to_vec()).expect("sound");
    let level = make(&heights);
    let ground = PatchedGround { lattice: &level, layout: &layout };
    for map in kinds(ground, 50.0) {
        assert!(map.values().iter().all(|&radius| radius == 0.0));
    }
    heights[8 * 17 + 8] = f32::NAN;
    let holed = make(&heights);
    let ground = PatchedGround { lattice: &holed, layout: &layout };
    for map in kinds(ground, 0.0) {
        assert_eq!(map.at(&layout, Vertex::new(8, 8)), f32::INFINITY);
        map.check(ground);
    }
}

#[test]
#[should_panic = "its child"]
fn the_check_of_a_map_in_which_a_child_reaches_out_of_its_parent_fails() {
    let lattice = terrain(17, 17, 1, 0);
    let layout = PatchLayout::new(17, 17, 16).expect("sound");
    let ground = PatchedGround { lattice: &lattice, layout: &layout };
    let steep = lattice.stretched(3.0);
    let [map, ..] = kinds(ground, 5.0);
    let steep = PatchedGround { lattice: &steep, ..ground };
    map.check(steep);
}

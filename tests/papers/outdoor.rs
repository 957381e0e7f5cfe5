//! 002: outdoor terrain rendering, its chapter on levels of detail.

use std::sync::Arc;

use glam::{DVec2, Vec3};
use sandtable::mesh::check::check_with_area;
use sandtable::mesh::trimesh::TriMesh;
use sandtable::roam::bintree::Triangle;
use sandtable::roam::criterion::flat::Flat;
use sandtable::roam::criterion::screen::ScreenError;
use sandtable::roam::displayed::DisplayedTerrain;
use sandtable::roam::ground::Ground;
use sandtable::roam::refine::rebuild::rebuild;
use sandtable::terrain::lattice::{Lattice, Post};

use crate::{World, camera, leaves};

#[test]
fn paper_002_a_height_map_has_a_horizontal_and_a_vertical_scale_and_a_slope_at_every_vertex() {
    let heights = (0..25).map(|at| (at % 5) as f32 * 3.0 + (at / 5) as f32 * 4.0).collect();
    let lattice = Lattice::new(DVec2::ZERO, DVec2::new(6.0, 2.0), 5, heights).expect("sound");
    for post in lattice.posts() {
        assert!((lattice.slopes(post) - glam::Vec2::new(0.5, 2.0)).length() < 1e-6, "{post:?}");
    }
    let layout = sandtable::roam::layout::Layout::new(5, 5, 4).expect("sound");
    let ground = Ground { lattice: &lattice, layout: &layout, exaggeration: 10.0 };
    let post = Post { column: 3, row: 2 };
    assert_eq!(
        (lattice.height(post), ground.position(sandtable::roam::graph::Vertex::new(3, 2)).z),
        (17.0, 170.0)
    );
}

#[test]
fn paper_002_no_t_junction_is_left_at_any_side_of_any_block() {
    let world = World::hills(97, 65, 32);
    let area = world.lattice.extent().size();
    let lattice = Arc::new(world.lattice.clone());
    for tolerance_m in [0.5, 2.0, 8.0, 50.0] {
        let criterion = Flat::new(&world.layout, &world.errors, tolerance_m);
        let active = rebuild(&world.layout, &criterion, world.layout.patches());
        let patches = world.layout.patches().collect();
        let mut mesh = TriMesh::default();
        DisplayedTerrain::new(Arc::clone(&lattice), active, 1.0, patches).emit(&mut mesh);
        check_with_area(&mesh, area.x * area.y).expect("conforming");
    }
}

#[test]
fn paper_002_detail_is_finer_near_the_eye_and_on_rough_ground() {
    let rough =
        |x: f32, y: f32| if y > 128.0 { 4.0 * libm::sinf(x * 1.3) * libm::cosf(y * 1.1) } else { 0.0 };
    let world = World::new((257, 257), 32, rough);
    let camera = camera(Vec3::new(10.0, 1290.0, 60.0), Vec3::new(2000.0, 1290.0, 0.0));
    let criterion = ScreenError::new(world.ground(), &world.errors, &world.heights, &camera, 8.0);
    let active = rebuild(&world.layout, &criterion, world.layout.patches());
    let leaves = leaves(&active);
    let count = |within: &dyn Fn(&Triangle) -> bool| leaves.iter().filter(|leaf| within(leaf)).count();
    let north = count(&|leaf| leaf.apex.y > 160);
    let south = count(&|leaf| leaf.apex.y < 96);
    assert!(north > 4 * south, "{north} triangles on rough ground, {south} on flat");
    let near = count(&|leaf| (130..140).contains(&leaf.apex.y) && (40..72).contains(&leaf.apex.x));
    let far = count(&|leaf| (130..140).contains(&leaf.apex.y) && (216..248).contains(&leaf.apex.x));
    assert!(near > 2 * far, "{near} triangles near the eye, {far} far away");
}

#[test]
fn paper_002_the_detail_of_every_triangle_is_under_control_by_one_tolerance() {
    let world = World::hills(129, 129, 64);
    let count = |tolerance_m: f32| {
        let criterion = Flat::new(&world.layout, &world.errors, tolerance_m);
        leaves(&rebuild(&world.layout, &criterion, world.layout.patches())).len()
    };
    let counts = [0.0, 1.0, 3.0, 10.0, 1000.0].map(count);
    assert_eq!((counts[0], counts[4]), (2 * 128 * 128, 8), "from every post to two triangles a patch");
    assert!(counts.windows(2).all(|pair| pair[0] > pair[1]), "{counts:?}");
}

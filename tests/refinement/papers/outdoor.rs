//! Outdoor terrain rendering, its chapter on levels of detail.

use std::io::Cursor;
use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3};
use image::{DynamicImage, ImageBuffer, ImageFormat};
use sandtable_dem::hints::DemOptions;
use sandtable_dem::read::read;
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::ColorRamp;
use sandtable_mesh::check::check_with_area;
use sandtable_mesh::trimesh::TriMesh;
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bintree::Triangle;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::block::BlockRelief;
use sandtable_roam::criterion::flat::Flat;
use sandtable_roam::criterion::midpoint::Midpoint;
use sandtable_roam::criterion::screen::ScreenError;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_roam::emit::geomipmap::{self, PatchLevels, Pyramids};
use sandtable_roam::emit::strips::{Strips, unstrip};
use sandtable_roam::emit::{bintree, quadtree, world};
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::errors::exact::triangles_split_at;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::queues::{Goal, Queues};
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::light::TerrainLight;

use crate::papers::{World, camera, leaves, same};

#[test]
fn a_height_map_has_two_scales_and_a_slope_at_every_vertex() {
    let heights = (0..25).map(|at| (at % 5) as f32 * 3.0 + (at / 5) as f32 * 4.0).collect();
    let lattice = Lattice::new(DVec2::ZERO, DVec2::new(6.0, 2.0), 5, heights).expect("sound");
    for post in lattice.posts() {
        assert!((lattice.slopes(post) - Vec2::new(0.5, 2.0)).length() < 1e-6, "{post:?}");
    }
    let layout = PatchLayout::new(5, 5, 4).expect("sound");
    let displayed = lattice.stretched(10.0);
    let ground = PatchedGround { lattice: &displayed, layout: &layout };
    let post = Post { column: 3, row: 2 };
    assert_eq!((lattice.height(post), ground.position(Vertex::new(3, 2)).z), (17.0, 170.0));
}

#[test]
fn no_t_junction_is_left_at_any_side_of_any_block() {
    let world = World::hills(97, 65, 32);
    let area = world.lattice.extent().size();
    let lattice = Arc::new(world.lattice.clone());
    for tolerance_m in [0.5, 2.0, 8.0, 50.0] {
        let criterion = Flat::new(&world.layout, &world.errors, tolerance_m);
        let active = rebuild(&world.layout, &criterion, world.layout.patches());
        let patches = world.layout.patches().collect();
        let mut mesh = TriMesh::default();
        DisplayedTerrain::new(Arc::clone(&lattice), active, patches).emit(&mut mesh);
        check_with_area(&mesh, area.x * area.y).expect("conforming");
    }
}

#[test]
fn detail_is_finer_near_the_eye_and_on_rough_ground() {
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
fn the_detail_of_every_triangle_is_under_control_by_one_tolerance() {
    let world = World::hills(129, 129, 64);
    let count = |tolerance_m: f32| {
        let criterion = Flat::new(&world.layout, &world.errors, tolerance_m);
        leaves(&rebuild(&world.layout, &criterion, world.layout.patches())).len()
    };
    let counts = [0.0, 1.0, 3.0, 10.0, 1000.0].map(count);
    assert_eq!((counts[0], counts[4]), (2 * 128 * 128, 8), "from every post to two triangles a patch");
    assert!(counts.windows(2).all(|pair| pair[0] > pair[1]), "{counts:?}");
}

/// The posts of a gray picture taken for a height map, from the south.
fn read_gray(picture: DynamicImage, meters_per_value: f64) -> Vec<f32> {
    let mut file = Cursor::new(Vec::new());
    picture.write_to(&mut file, ImageFormat::Png).expect("it can be written");
    let hints =
        DemOptions { height_scale: Some(meters_per_value), cell: Some(30.0), ..DemOptions::default() }.into();
    let raster = read("map.png", file.get_ref(), &hints).expect("a height map");
    let lattice = Lattice::from_raster(&raster).expect("it holds ground");
    assert_eq!(lattice.cell(), DVec2::splat(30.0), "the horizontal scale");
    lattice.heights().to_vec()
}

#[test]
fn a_height_map_has_8_bits_a_value_or_more() {
    let coarse = ImageBuffer::from_fn(3, 2, |x, y| image::Luma([(100 * x + 50 * y) as u8]));
    let from_south = read_gray(DynamicImage::ImageLuma8(coarse), 2.0);
    assert_eq!(from_south, [100.0, 300.0, 500.0, 0.0, 200.0, 400.0]);
    let fine = ImageBuffer::from_fn(3, 2, |x, y| image::Luma([(30_000 * x + 1000 * y + 7) as u16]));
    let from_south = read_gray(DynamicImage::ImageLuma16(fine), 0.1);
    let expected = [100.7f32, 3100.7, 6100.7, 0.7, 3000.7, 6000.7];
    assert!(
        from_south.iter().zip(expected).all(|(&found, expected)| same(found, expected)),
        "{from_south:?}"
    );
}

#[test]
fn the_normal_of_a_vertex_is_the_mean_of_the_faces_around_it() {
    let world = World::hills(17, 17, 16);
    for post in world.lattice.posts() {
        let (column, row) = (i64::from(post.column), i64::from(post.row));
        if column == 0 || row == 0 || column == 16 || row == 16 {
            continue;
        }
        let at = |east: i64, north: i64| {
            world.lattice.height(Post { column: (column + east) as u32, row: (row + north) as u32 })
        };
        // The four cells around, the two faces of each: a face's slopes are those of its level and upright edge.
        let faces = [(-1, -1), (0, -1), (-1, 0), (0, 0)].into_iter().flat_map(|(x, y)| {
            let [sw, se, nw, ne] = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
            [Vec2::new(se - sw, ne - se), Vec2::new(ne - nw, nw - sw)]
        });
        let mean = faces.sum::<Vec2>() / (8.0 * 10.0);
        assert!((world.lattice.slopes(post) - mean).length() < 1e-5, "{post:?}");
    }
}

/// What a camera sees of hills.
fn seen(world: &World) -> ActiveSet {
    let camera = camera(Vec3::new(-100.0, 200.0, 90.0), Vec3::new(600.0, 600.0, 0.0));
    let criterion = ScreenError::new(world.ground(), &world.errors, &world.heights, &camera, 3.0);
    rebuild(&world.layout, &criterion, world.layout.patches())
}

/// Triangles in order, each from its lowest corner on.
fn sorted(triangles: Vec<[Vertex; 3]>) -> Vec<[Vertex; 3]> {
    let from_lowest = |[a, b, c]: [Vertex; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    let mut sorted: Vec<_> = triangles.into_iter().filter_map(from_lowest).collect();
    sorted.sort_unstable();
    sorted
}

#[test]
fn strips_and_fans_send_the_same_triangles_in_fewer_vertices() {
    let world = World::hills(129, 129, 32);
    let active = seen(&world);
    let (mut list, mut by_strips, mut by_fans) = (Vec::new(), Vec::new(), Vec::new());
    bintree::triangles(&active, world.layout.patches(), |corners| list.push(corners));
    let mut strips = Strips::default();
    strips.add_patches(&active, world.layout.patches(), |_| true);
    strips.iter().for_each(|strip| unstrip(strip, |corners| by_strips.push(corners)));
    let mut in_fans = 0;
    quadtree::fans(&active, world.layout.patches(), |fan| {
        in_fans += fan.len();
        by_fans.extend(fan[1..].windows(2).map(|rim| [fan[0], rim[0], rim[1]]));
    });
    let (in_list, in_strips) = (3 * list.len(), strips.stats().vertices);
    assert!(in_list > 3 * 1000, "{in_list} vertices in the list");
    let list = sorted(list);
    assert!(sorted(by_strips) == list && sorted(by_fans) == list);
    assert!(in_strips * 3 < in_list * 2, "{in_strips} in strips, {in_list} in the list");
    assert!(in_fans < in_list, "{in_fans} in fans, {in_list} in the list");
}

fn emitted(world: &World, levels: &PatchLevels) -> TriMesh {
    let mut mesh = TriMesh::default();
    geomipmap::triangles(
        &world.layout,
        levels,
        world.layout.patches(),
        world::placing(world.ground(), &mut mesh),
    );
    mesh
}

#[test]
fn a_block_s_level_is_chosen_by_its_distance_and_error_from_a_pyramid() {
    // Hills in the south, ten times lower ones in the north.
    let world = World::new((257, 257), 32, |x, y| {
        let height_m = if y < 128.0 { 8.0 } else { 0.8 };
        height_m * libm::sinf(x * 0.4) * libm::cosf(y * 0.3)
    });
    let pyramids = Pyramids::new(&world.lattice, &world.layout);
    for corner in world.layout.patches() {
        let errors: Vec<f32> =
            (0..pyramids.level_count()).map(|level| pyramids.error_m(corner, level)).collect();
        assert_eq!((errors.len(), errors[0]), (6, 0.0), "from every post to one square");
        assert!(errors.windows(2).all(|pair| pair[0] <= pair[1]), "{errors:?}");
    }
    let camera = camera(Vec3::new(-100.0, 1280.0, 40.0), Vec3::new(2000.0, 1280.0, 0.0));
    let levels = pyramids.for_view(world.ground(), &world.heights, &camera, 2.0);
    let at = |east: i32, north: i32| levels.at(&world.layout, Vertex::new(east * 32, north * 32));
    assert!(at(0, 2) < at(7, 2), "by distance: {} near, {} far", at(0, 2), at(7, 2));
    assert!(at(4, 2) < at(4, 5), "by error: {} on hills, {} on low ones", at(4, 2), at(4, 5));
}

#[test]
fn the_borders_of_blocks_of_any_two_levels_are_stitched() {
    let world = World::hills(97, 65, 16);
    let area = world.lattice.extent().size();
    for seed in 0..12u32 {
        let of_patch = |at: u32| (at + seed).wrapping_mul(2_654_435_761) >> 16;
        let levels = (0..world.layout.patch_count() as u32).map(|at| of_patch(at) % 5).collect();
        let levels = PatchLevels::new(&world.layout, levels).expect("levels of 16 cells");
        let mesh = emitted(&world, &levels);
        check_with_area(&mesh, area.x * area.y).unwrap_or_else(|flaw| panic!("{seed}: {flaw}"));
    }
}

/// The height difference under the triangles that a vertex splits, post by post.
fn relief(world: &World, vertex: Vertex) -> f32 {
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for triangle in triangles_split_at(&world.layout, vertex).into_iter().flatten() {
        let corners = triangle.corners();
        for at in world.vertices().into_iter().chain(corners) {
            let inside = (0..3).all(|side| {
                let (from, to) = (corners[side], corners[(side + 1) % 3]);
                (to.x - from.x) * (at.y - from.y) - (to.y - from.y) * (at.x - from.x) >= 0
            });
            if inside {
                (low, high) = (low.min(world.height(at)), high.max(world.height(at)));
            }
        }
    }
    high - low
}

#[test]
fn a_block_is_refined_while_err_times_r_over_d_is_above_k() {
    let world = World::hills(17, 17, 8);
    let own: Vec<f32> = (0..world.layout.vertex_count() as i32)
        .map(|at| Vertex::new(at % 17, at / 17))
        .map(|vertex| if world.layout.is_corner(vertex) { 0.0 } else { relief(&world, vertex) })
        .collect();
    let map = ErrorMap::relief(&world.lattice, &world.layout);
    let (eye, mut refined) = (Vec3::new(30.0, -20.0, 70.0), 0);
    for k in [0.5, 3.0] {
        let criterion = BlockRelief::with_k(world.ground(), &map, eye, k);
        for vertex in world.vertices() {
            let err = world.largest_below(vertex, &|vertex| own[world.layout.index(vertex)]);
            let (r, d) = (vertex.step() as f32 * 10.0, world.ground().position(vertex).distance(eye));
            let rest = err * r / d - k;
            assert!(rest.abs() < k * 1e-4 || criterion.wants(vertex) == (rest > 0.0), "{vertex:?}: {rest}");
            refined += usize::from(rest > 0.0);
        }
    }
    assert!(refined > 50 && refined < 500, "{refined}");
}

#[test]
fn slopes_have_more_detail_than_level_ground() {
    let world = World::new((129, 129), 64, |x, _| (x - 64.0).max(0.0) * 9.0);
    let relief = ErrorMap::relief(&world.lattice, &world.layout);
    let eye = Vec3::new(640.0, 640.0, 900.0);
    let criterion = BlockRelief::with_k(world.ground(), &relief, eye, 10.0);
    let leaves = leaves(&rebuild(&world.layout, &criterion, world.layout.patches()));
    let on = |east: bool| {
        leaves.iter().filter(|leaf| leaf.corners().iter().all(|at| (at.x >= 64) == east)).count()
    };
    assert!(on(true) > 8 * on(false), "{} on the slope, {} on the level", on(true), on(false));
}

#[test]
fn the_number_of_triangles_has_a_cap_that_is_reached_and_never_exceeded() {
    let world = World::hills(257, 257, 64);
    let errors = ErrorMap::midpoint(&world.lattice, &world.layout);
    let patches: Vec<Vertex> = world.layout.patches().collect();
    for most in [100, 1000, 5001] {
        let mut queues = Queues::new(world.ground(), Goal::Budget(most));
        for step in 0..12u8 {
            let eye = Vec3::new(200.0 * f32::from(step), 400.0 + 100.0 * f32::from(step), 60.0);
            let camera = camera(eye, Vec3::new(1280.0, 1280.0, 0.0));
            queues.update(&Midpoint::new(world.ground(), &errors, &camera, 1.0), &patches);
            let triangles = leaves(queues.active()).len();
            assert_eq!(triangles, queues.triangles());
            assert!(triangles <= most && triangles + 2 >= most, "{triangles} of {most} in step {step}");
        }
    }
}

#[test]
fn the_ground_has_light_maps() {
    // A wall that runs north, the sun low in the west.
    let world = World::new((65, 33), 32, |x, _| if x == 20.0 { 100.0 } else { 0.0 });
    let light = TerrainLight::new(&world.lattice, Vec3::new(-1.0, 0.0, 0.5).normalize(), 0);
    let (sun, sky) = (light.sun(16), light.sky(16));
    let at = |column: usize| (sun[column], sky[column]);
    assert_eq!((at(10).0, at(25).0, at(60).0), (1.0, 0.0, 1.0), "before, in and beyond the wall's shadow");
    assert!(at(21).1 < at(25).1 && at(25).1 < at(60).1, "the wall hides less and less of the sky");
}

#[test]
fn the_surfaces_of_the_ground_are_blended_by_height() {
    let [grass, rock] = [Srgba::opaque(40, 120, 30), Srgba::opaque(120, 110, 100)];
    let ramp = ColorRamp::new(vec![(100.0, grass), (300.0, rock)]).expect("rising");
    for (height_m, share) in
        [(0.0, 0.0), (100.0, 0.0), (150.0, 0.25), (200.0, 0.5), (300.0, 1.0), (900.0, 1.0)]
    {
        let blended = grass.linear().lerp(rock.linear(), share);
        assert!((ramp.linear_at(height_m) - blended).length() < 1e-6, "{height_m} m");
    }
}

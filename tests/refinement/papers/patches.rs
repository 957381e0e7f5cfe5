//! Lin, Wan, Zhou and Tan: equal square patches, forced splits and forced merges.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine2, DMat2, DVec2, Vec3};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bintree::Triangle;
use sandtable_roam::block::BlockSource;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::flat::Flat;
use sandtable_roam::criterion::midpoint::Midpoint;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::culling::{Culling, cull, patches_in_view};
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::paging::ground::{PagedGround, PagingOptions, exact_spheres};
use sandtable_roam::paging::walk::walk;
use sandtable_roam::refine::changes::RefinementChanges;
use sandtable_roam::refine::coherent::{Coherent, Hidden};
use sandtable_roam::refine::queues::{Goal, Queues};
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

use crate::papers::{World, camera, leaves, same};

/// Doubled area in cells: it halves from level to level.
fn size(triangle: &Triangle) -> i32 {
    let [a, b, c] = triangle.corners();
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

#[test]
fn patches_share_their_border_samples_and_hold_two_bintree_roots() {
    let layout = PatchLayout::new(1025, 1025, 64).expect("sound");
    assert_eq!(layout.patch_count(), 16 * 16);
    let patches: BTreeSet<Vertex> = layout.patches().collect();
    for &corner in &patches {
        let roots = Triangle::roots(corner, 64);
        assert_eq!(roots.iter().map(size).sum::<i32>(), 2 * 64 * 64);
        let east = corner.moved(64, 0);
        if patches.contains(&east) {
            let corners = |corner| -> BTreeSet<Vertex> {
                Triangle::roots(corner, 64).iter().flat_map(Triangle::corners).collect()
            };
            let shared: Vec<Vertex> = corners(corner).intersection(&corners(east)).copied().collect();
            assert_eq!(shared, [east, east.moved(0, 64)], "the border between {corner:?} and {east:?}");
        }
    }
}

#[test]
fn neighbors_are_as_fine_or_one_level_apart() {
    let world = World::hills(130, 97, 32);
    let mut active = ActiveSet::new(world.layout);
    for (x, y) in [(33, 41), (64, 31), (97, 5), (1, 90), (120, 90)] {
        active.activate(Vertex::new(x, y));
    }
    let leaves = leaves(&active);
    let mut beside: BTreeMap<[Vertex; 2], Vec<usize>> = BTreeMap::new();
    for (at, leaf) in leaves.iter().enumerate() {
        for (from, to) in [(leaf.apex, leaf.left), (leaf.left, leaf.right), (leaf.right, leaf.apex)] {
            beside.entry([from.min(to), from.max(to)]).or_default().push(at);
        }
    }
    for (edge, sharing) in beside.iter().filter(|(_, sharing)| sharing.len() == 2) {
        let [one, other] = [&leaves[sharing[0]], &leaves[sharing[1]]];
        for (leaf, neighbor) in [(one, other), (other, one)] {
            let base = BTreeSet::from([leaf.left, leaf.right]) == BTreeSet::from(*edge);
            let ratio = size(neighbor) as f32 / size(leaf) as f32;
            let allowed: &[f32] = if base { &[1.0, 2.0] } else { &[1.0, 0.5] };
            assert!(allowed.contains(&ratio), "{leaf:?} beside {neighbor:?}");
        }
    }
}

#[test]
fn a_split_forces_coarser_base_neighbors_first_and_splits_alone_at_the_border() {
    let layout = PatchLayout::new(65, 65, 64).expect("sound");
    let mut active = ActiveSet::new(layout);
    let border = Vertex::new(32, 0);
    active.activate(border);
    let parents = border.parents().map(|parent| layout.contains(parent));
    assert_eq!(parents.iter().filter(|&&inside| inside).count(), 1, "there is no neighbor beyond the border");
    assert_eq!(active.count(), 2, "the border vertex and the center that is its parent");
    active.activate(Vertex::new(1, 1));
    active.check();
    assert!(active.count() > 6, "a deep split forces many: {}", active.count());
}

#[test]
fn culled_patches_are_not_refined() {
    let world = World::hills(257, 257, 32);
    let (ground, camera) =
        (world.ground(), camera(Vec3::new(1280.0, 1280.0, 90.0), Vec3::new(2500.0, 1280.0, 0.0)));
    let seen = patches_in_view(ground, &world.heights, &Frustum::new(&camera));
    assert!(!seen.is_empty() && seen.len() < world.layout.patch_count() / 2, "{} patches", seen.len());
    assert!(seen.iter().all(|corner| corner.x >= 96), "what lies behind the eye is culled");
    let finest = Flat::new(&world.layout, &world.errors, 0.0);
    let active = rebuild(&world.layout, &finest, seen.iter().copied());
    let inner = |corner: &Vertex| {
        let middle = corner.moved(15, 17);
        layout_neighbors(*corner).iter().all(|near| !seen.contains(near)) && active.is_active(middle)
    };
    let away: Vec<Vertex> = world.layout.patches().filter(|corner| !seen.contains(corner)).collect();
    assert!(!away.iter().any(inner), "patches away from what is seen stay coarse");
    assert!(seen.iter().all(|corner| active.is_active(corner.moved(15, 17))), "those in view are fine");
}

fn layout_neighbors(corner: Vertex) -> [Vertex; 8] {
    let steps = [(-32, -32), (0, -32), (32, -32), (-32, 0), (32, 0), (-32, 32), (0, 32), (32, 32)];
    steps.map(|(dx, dy)| corner.moved(dx, dy))
}

#[test]
fn a_forced_merge_takes_everything_below_and_the_dependants_beside_it() {
    let world = World::hills(130, 97, 32);
    let finest = Flat::new(&world.layout, &world.errors, 0.5);
    let before = rebuild(&world.layout, &finest, world.layout.patches());
    let mut beside = 0;
    for vertex in [Vertex::new(48, 48), Vertex::new(32, 48), Vertex::new(72, 40), Vertex::new(0, 16)] {
        let mut active = before.clone();
        let mut gone = BTreeSet::new();
        active.deactivate_each(vertex, &mut |vertex| assert!(gone.insert(vertex), "{vertex:?} twice"));
        assert_eq!(gone, below(&before, vertex), "what goes with {vertex:?}");
        active.check();
        assert_eq!(active.count() + gone.len(), before.count(), "nothing else goes");
        let (min, max) = world.ground().diamond(vertex);
        let outside = |gone: &&Vertex| {
            let at = world.ground().plan(**gone);
            at.cmplt(min).any() || at.cmpgt(max).any()
        };
        beside += gone.iter().filter(outside).count();
    }
    assert!(beside > 0, "neighbors are merged too");
}

/// A vertex and the active ones that depend on it, by way of others too.
fn below(active: &ActiveSet, vertex: Vertex) -> BTreeSet<Vertex> {
    let (mut found, mut stack) = (BTreeSet::new(), vec![vertex]);
    while let Some(vertex) = stack.pop() {
        if active.layout().contains(vertex) && active.is_active(vertex) && found.insert(vertex) {
            stack.extend(vertex.children());
        }
    }
    found
}

#[test]
fn a_forced_merge_of_what_a_forced_split_made_is_the_mesh_before() {
    let world = World::hills(130, 97, 32);
    let coarse = Flat::new(&world.layout, &world.errors, 20.0);
    let before = rebuild(&world.layout, &coarse, world.layout.patches());
    let mut forced = 0;
    for vertex in world.vertices().into_iter().filter(|vertex| !before.is_active(*vertex)).step_by(7) {
        let (mut active, mut split) = (before.clone(), Vec::new());
        active.activate_each(vertex, &mut |vertex| split.push(vertex));
        assert_eq!(split.last(), Some(&vertex), "its parents first");
        forced = forced.max(split.len());
        split.iter().rev().for_each(|&vertex| active.deactivate(vertex));
        assert!(active == before, "{vertex:?}");
    }
    assert!(forced > 8, "a deep split forces many: {forced}");
}

#[test]
fn the_error_is_k_times_variance_times_land_width_over_distance() {
    let world = World::hills(33, 17, 8);
    let variances = ErrorMap::midpoint(&world.lattice, &world.layout);
    let (eye, k, land_width_m) = (Vec3::new(70.0, -40.0, 55.0), 0.2, 320.0);
    let criterion = Midpoint::with_k(world.ground(), &variances, eye, k);
    let mut wanted = 0;
    for vertex in world.vertices() {
        let variance = world.largest_below(vertex, &|vertex| world.midpoint_error(vertex));
        let error = k * variance * land_width_m / eye.distance(world.ground().position(vertex));
        let found = criterion.excess(vertex);
        assert!(same(found, error), "{vertex:?}: {found} against {error}");
        assert!(
            (error - 1.0).abs() < 1e-3 || criterion.wants(vertex) == (error > 1.0),
            "{vertex:?}: {error}"
        );
        wanted += usize::from(criterion.wants(vertex));
    }
    assert!(wanted > 20 && wanted < world.vertices().len(), "{wanted} wanted");
}

/// Cameras of a walk that turns round and comes back: patches come into view, go and return.
fn path() -> impl Iterator<Item = Camera> {
    (0..90u16).map(|frame| {
        let (along, turn) = (f32::from(frame) * 0.02, f32::from(frame) * 0.11);
        let eye = Vec3::new(
            1280.0 + 900.0 * libm::cosf(along),
            1280.0 + 700.0 * libm::sinf(along * 1.7),
            70.0 + 50.0 * libm::sinf(along * 3.0),
        );
        let ahead = Vec3::new(libm::cosf(turn), libm::sinf(turn), -0.25 + 0.2 * libm::sinf(turn * 0.7));
        camera(eye, eye + ahead)
    })
}

#[test]
fn the_wedge_on_the_ground_plane_never_culls_what_the_frustum_sees() {
    let world = World::hills(257, 257, 16);
    let (mut by_wedge, mut seen, mut culled) = (Vec::new(), 0, 0);
    for camera in path() {
        cull(world.ground(), &world.heights, &Culling::wedge(&camera), &mut by_wedge);
        let listed: BTreeSet<Vertex> = by_wedge.iter().copied().collect();
        for corner in world.layout.patches().filter(|corner| !listed.contains(corner)) {
            let vertices = (0..=16).flat_map(|x| (0..=16).map(move |y| corner.moved(x, y)));
            let shown =
                vertices.into_iter().find(|&vertex| is_seen(&camera, world.ground().position(vertex)));
            assert_eq!(shown, None, "{corner:?} is culled before {:?}", camera.eye());
        }
        let in_picture = |&vertex: &Vertex| is_seen(&camera, world.ground().position(vertex));
        seen += world.vertices().iter().filter(|vertex| in_picture(vertex)).count();
        culled += world.layout.patch_count() - listed.len();
    }
    assert!(seen > 90 * 1000, "{seen} posts are in view");
    assert!(culled > 90 * world.layout.patch_count() / 2, "most patches are out of view: {culled}");
}

/// Whether a point is in the picture.
fn is_seen(camera: &Camera, at: Vec3) -> bool {
    let (width, height) = camera.size();
    let depth_m = (at - camera.eye()).dot(camera.forward());
    let (near_m, far_m) = camera.planes();
    let inside = |pixel: glam::Vec2| {
        (0.0..=width as f32).contains(&pixel.x) && (0.0..=height as f32).contains(&pixel.y)
    };
    (near_m..=far_m).contains(&depth_m) && camera.project(at).is_some_and(|seen| inside(seen.pixel))
}

#[test]
fn adjusting_last_frame_s_mesh_gives_the_rebuilt_mesh_with_far_fewer_splits() {
    let world = World::hills(257, 257, 32);
    let errors = ErrorMap::midpoint(&world.lattice, &world.layout);
    let mut adjusted = Coherent::new(world.layout);
    let (mut seen, mut entered, mut left) = (Vec::new(), 0, 0);
    let (mut adjusting, mut anew) = (0, 0);
    for camera in path() {
        let before: BTreeSet<Vertex> = seen.iter().copied().collect();
        cull(world.ground(), &world.heights, &Culling::wedge(&camera), &mut seen);
        entered += seen.iter().filter(|corner| !before.contains(corner)).count();
        left += before.iter().filter(|corner| !seen.contains(corner)).count();
        let criterion = Midpoint::new(world.ground(), &errors, &camera, 3.0);
        let RefinementChanges { splits, merges, .. } = adjusted.update(&criterion, &seen);
        let built = rebuild(&world.layout, &criterion, seen.iter().copied());
        assert!(*adjusted.active() == built, "before {:?}", camera.eye());
        adjusted.check();
        (adjusting, anew) = (adjusting + splits + merges, anew + built.count());
    }
    assert!(entered > 80 && left > 80, "{entered} patches came into view, {left} left it");
    assert!(adjusting * 2 < anew, "{adjusting} operations adjust, {anew} build");
}

#[test]
fn the_mesh_needs_no_priority_queues() {
    let world = World::hills(257, 257, 32);
    let spheres = exact_spheres(150.0)(world.ground());
    let (mut adjusted, mut queued) =
        (Coherent::new(world.layout), Queues::new(world.ground(), Goal::Tolerance));
    for camera in path().step_by(9) {
        let seen = patches_in_view(world.ground(), &world.heights, &Frustum::new(&camera));
        let criterion = Spheres::new(world.ground(), &spheres, camera.eye());
        adjusted.update(&criterion, &seen);
        queued.update(&criterion, &seen);
        assert!(adjusted.active().count() > 500, "{} vertices", adjusted.active().count());
        assert!(adjusted.active() == queued.active(), "as many triangles, and the same");
    }
}

#[test]
fn a_patch_never_refined_is_built_by_splits_and_one_that_was_is_adjusted() {
    let world = World::hills(257, 257, 32);
    let criterion = Flat::new(&world.layout, &world.errors, 2.0);
    let (here, there) = (Vertex::new(32, 32), Vertex::new(160, 160));
    let mut mesh = Coherent::with_hidden(world.layout, Hidden::Keep);
    for new in [here, there] {
        let changes = mesh.update(&criterion, &[new]);
        assert!(changes.splits > 50, "{new:?} is built: {changes:?}");
        assert_eq!(changes.merges, 0, "by splits alone");
        assert!(changes.dirty.contains(&world.layout.patch_index(new)));
    }
    assert_eq!(
        mesh.update(&criterion, &[here]),
        RefinementChanges::default(),
        "it stayed as it was last seen"
    );
    let coarser = Flat::new(&world.layout, &world.errors, 4.0);
    let changes = mesh.update(&coarser, &[here]);
    assert!(changes.merges > 0 && changes.splits == 0, "from last time's mesh: {changes:?}");
}

#[test]
fn terrain_larger_than_the_memory_shows_what_it_shows_in_memory() {
    let world = World::hills(161, 129, 16);
    let options = PagingOptions { patch: 16, capacity: 6 };
    let mut paged = PagedGround::open(raster(&world), exact_spheres(8.0), &options).expect("sound");
    let spheres = exact_spheres(8.0)(world.ground());
    for step in 0..9u8 {
        let eye = Vec3::new(200.0 * f32::from(step), 900.0 - 60.0 * f32::from(step), 80.0);
        let (mut found, patches) = (Vec::new(), paged.layout().patches());
        walk(&mut paged, eye, patches, &mut |leaf| found.push(leaf)).expect("readable");
        let criterion = Spheres::new(world.ground(), &spheres, eye);
        let expected = leaves(&rebuild(&world.layout, &criterion, world.layout.patches()));
        let sorted = |leaves: &[Triangle]| leaves.iter().map(Triangle::corners).collect::<BTreeSet<_>>();
        assert_eq!(found.len(), expected.len(), "step {step}");
        assert!(sorted(&found) == sorted(&expected), "step {step}");
        assert!(paged.kept() <= 6 && paged.counts().peak <= 6, "{:?}", paged.counts());
    }
    paged.check();
    assert!(paged.counts().evictions > 0, "more was read than is kept: {:?}", paged.counts());
}

/// The world's heights as a file holds them, from the north.
fn raster(world: &World) -> Raster {
    let (columns, rows) = (world.lattice.columns(), world.lattice.rows());
    let from_north = world.lattice.heights().chunks(columns as usize).rev().flatten().copied();
    let axes = DMat2::from_diagonal(DVec2::new(10.0, -10.0));
    Raster {
        driver: "test",
        data_type: "Float32",
        width: columns,
        height: rows,
        samples: Samples::F32(from_north.collect()),
        meters_per_z: 1.0,
        states_z_unit: false,
        map_from_grid: DAffine2 {
            matrix2: axes,
            translation: DVec2::new(-5.0, f64::from(rows) * 10.0 - 5.0),
        },
        georeferenced: true,
        crs: None,
        ..Raster::without_place(1, 1)
    }
}

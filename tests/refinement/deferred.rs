//! The deferred refiner shows, after any path and any edits, the mesh that is built from the roots for the same eye.

use glam::{DAffine2, DMat2, DVec2, Vec3};
use proptest::prelude::*;
use sandtable_earthworks::brush::{Crater, set_heights};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_roam::bintree::Triangle;
use sandtable_roam::block::{BlockSource, PatchBlock, WholeGround};
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::dynamic::{DynamicOptions, DynamicTerrain, ErrorMeasure, Radius};
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::paging::ground::{PagedGround, PagingOptions, exact_spheres};
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::changes::RefinementChanges;
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_roam::spheres::SphereMap;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

fn hills(columns: u32, rows: u32, holes: &[usize]) -> Lattice {
    let mut heights: Vec<f32> = (0..columns * rows)
        .map(|index| {
            let (x, y) = ((index % columns) as f32, (index / columns) as f32);
            libm::sinf(x * 0.21) * 9.0
                + libm::cosf(y * 0.17 + x * 0.05) * 14.0
                + libm::sinf(x * y * 0.9) * 0.8
        })
        .collect();
    for &hole in holes {
        let count = heights.len();
        heights[hole % count] = f32::NAN;
    }
    Lattice::new(DVec2::ZERO, DVec2::new(10.0, 8.0), columns, heights).expect("sound")
}

fn spheres(ground: PatchedGround<'_>, reach: f32) -> SphereMap {
    let errors = ErrorMap::exact(ground.lattice, ground.layout);
    SphereMap::nested(ground, errors.values().iter().map(|error| error * reach).collect())
}

/// The triangles of the listed patches as sorted vertex triples: by the bits of a rebuild.
fn rebuilt(ground: PatchedGround<'_>, map: &SphereMap, eye: Vec3, patches: &[Vertex]) -> Vec<[Vertex; 3]> {
    let active = rebuild(ground.layout, &Spheres::new(ground, map, eye), patches.iter().copied());
    let mut found = Vec::new();
    let mut stack: Vec<Triangle> =
        patches.iter().flat_map(|&corner| Triangle::roots(corner, ground.layout.patch())).collect();
    while let Some(triangle) = stack.pop() {
        if !triangle.is_finest() && active.is_active(triangle.split_vertex()) {
            stack.extend(triangle.split());
            continue;
        }
        let posts = triangle.corners().map(|corner| ground.layout.post(corner));
        let [a, b, c] = posts.map(|post| (i64::from(post.column), i64::from(post.row)));
        let area = (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0);
        if area != 0 && posts.iter().all(|&post| !ground.lattice.height(post).is_nan()) {
            let mut corners = triangle.corners();
            corners.sort_unstable();
            found.push(corners);
        }
    }
    found.sort_unstable();
    found
}

fn shown(walk: &Deferred<impl BlockSource>) -> Vec<[Vertex; 3]> {
    let mut found = Vec::new();
    for &corner in walk.visible() {
        for triangle in walk.indices(corner) {
            let mut corners = triangle.map(|number| walk.vertex(corner, number));
            corners.sort_unstable();
            found.push(corners);
        }
    }
    found.sort_unstable();
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn after_any_path_the_mesh_is_that_of_a_rebuild(
        columns in 10u32..110, rows in 10u32..110,
        holes in proptest::collection::vec(0usize..12_000, 0..3),
        reach in 3f32..60.0,
        path in proptest::collection::vec((0f32..1100.0, 0f32..900.0, 0f32..300.0, 1usize..30, any::<u64>()), 2..6),
    ) {
        let lattice = hills(columns, rows, &holes);
        let layout = PatchLayout::new(columns, rows, 16).expect("sound");
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let map = spheres(ground, reach);
        let mut walk = Deferred::new(WholeGround { ground, spheres: &map }, 8.0).expect("small patches");
        let all: Vec<Vertex> = layout.patches().collect();
        let mut eye = Vec3::new(300.0, 300.0, 80.0);
        for (x, y, z, steps, mask) in path {
            let to = Vec3::new(x, y, z);
            // Steps shorten by half each, so that long strides, crawling and standing still all occur.
            for _ in 0..steps {
                eye += (to - eye) * 0.5;
                let patches: Vec<Vertex> = (all.iter().enumerate())
                    .filter(|(index, _)| mask >> (index % 64) & 1 == 1)
                    .map(|(_, &corner)| corner)
                    .collect();
                walk.update(eye, &patches).expect("in memory");
                walk.check();
            }
            prop_assert_eq!(shown(&walk), rebuilt(ground, &map, eye, walk.visible()));
        }
    }
}

/// The ground before any edit and after each: a mound or a pit of `height` about a post.
fn edited(columns: u32, rows: u32, edits: &[(u32, u32, f32)]) -> Vec<Lattice> {
    let mut states = vec![hills(columns, rows, &[])];
    for &(column, row, height) in edits {
        let last = &states[states.len() - 1];
        let mut heights = last.heights().to_vec();
        for (index, z) in heights.iter_mut().enumerate() {
            let (x, y) = (index as u32 % columns, index as u32 / columns);
            let away = x.abs_diff(column % columns).max(y.abs_diff(row % rows));
            *z += height * (1.0 - away as f32 / 6.0).max(0.0);
        }
        states.push(Lattice::new(DVec2::ZERO, last.cell(), columns, heights).expect("sound"));
    }
    states
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn after_any_edits_the_mesh_is_that_of_a_rebuild(
        columns in 20u32..90, rows in 20u32..90,
        reach in 3f32..60.0,
        edits in proptest::collection::vec((0u32..90, 0u32..90, -60f32..60.0), 1..5),
        stride in prop_oneof![Just(0f32), 0f32..40.0],
    ) {
        let lattices = edited(columns, rows, &edits);
        let layout = PatchLayout::new(columns, rows, 16).expect("sound");
        let grounds: Vec<PatchedGround<'_>> =
            lattices.iter().map(|lattice| PatchedGround { lattice, layout: &layout }).collect();
        let maps: Vec<SphereMap> = grounds.iter().map(|&ground| spheres(ground, reach)).collect();
        let all: Vec<Vertex> = layout.patches().collect();
        let mut walk = Deferred::new(WholeGround { ground: grounds[0], spheres: &maps[0] }, 8.0).expect("small");
        let mut eye = Vec3::new(250.0, 200.0, 60.0);
        walk.update(eye, &all).expect("in memory");
        for state in 1..grounds.len() {
            let cut = |state: usize, corner| PatchBlock::new(grounds[state], &maps[state], corner);
            let dirty: Vec<Vertex> =
                all.iter().copied().filter(|&corner| cut(state - 1, corner) != cut(state, corner)).collect();
            *walk.source_mut() = WholeGround { ground: grounds[state], spheres: &maps[state] };
            walk.edit(&dirty).expect("in memory");
            eye.x += stride;
            walk.update(eye, &all).expect("in memory");
            walk.check();
            prop_assert_eq!(shown(&walk), rebuilt(grounds[state], &maps[state], eye, &all));
        }
    }
}

#[test]
fn a_crater_in_view_is_walked_round_as_if_it_had_always_been_there() {
    let options =
        DynamicOptions { patch: 16, measure: ErrorMeasure::Midpoint, radius: Radius::Plain, reach: 40.0 };
    let terrain = DynamicTerrain::new(hills(100, 90, &[]), options).expect("sound");
    let all: Vec<Vertex> = terrain.layout().patches().collect();
    let mut walk = Deferred::new(terrain, 8.0).expect("small patches");
    for step in 0..12 {
        let eye = Vec3::new(200.0 + 30.0 * step as f32, 300.0, 60.0);
        let before = walk.update(eye, &all).expect("in memory").clone();
        assert!(before.splits > 0, "the eye moves");
        let center = DVec2::new(250.0 + 40.0 * f64::from(step), 310.0 + 9.0 * f64::from(step));
        let crater = Crater { center, radius_m: 60.0, depth_m: 25.0, rim_m: 6.0 };
        let edit = walk.source_mut().edit(|lattice| crater.apply(lattice)).expect("ground to dig in");
        walk.edit(&edit.patches).expect("in memory");
        let dirty = walk.update(eye, &all).expect("in memory").dirty.clone();
        assert!(!dirty.is_empty() && dirty.len() < all.len() / 2, "{dirty:?} of {}", all.len());
        walk.check();
        let bare = DynamicTerrain::new(walk.source().lattice().as_ref().clone(), options).expect("sound");
        let anew = rebuilt(bare.ground(), bare.spheres(), eye, &all);
        assert_eq!(shown(&walk), anew, "after crater {step}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn an_edit_followed_by_vertices_shows_what_one_read_by_patches_does(
        columns in 20u32..90, rows in 20u32..90,
        holes in proptest::collection::vec(0usize..400, 0..4),
        bumps in proptest::collection::vec((0u32..90, 0u32..90, 1u32..20, -40f32..40.0), 1..6),
        stride in prop_oneof![Just(0f32), 0f32..40.0],
    ) {
        let options =
            DynamicOptions { patch: 16, measure: ErrorMeasure::Midpoint, radius: Radius::Plain, reach: 40.0 };
        let terrain = || DynamicTerrain::new(hills(columns, rows, &holes), options).expect("sound");
        let all: Vec<Vertex> = terrain().layout().patches().collect();
        let mut walks = [terrain(), terrain()].map(|terrain| Deferred::new(terrain, 8.0).expect("small patches"));
        let mut eye = Vec3::new(250.0, 200.0, 60.0);
        for walk in &mut walks {
            walk.update(eye, &all).expect("in memory");
        }
        for (column, row, side, height_m) in bumps {
            eye.x += stride;
            for (number, walk) in walks.iter_mut().enumerate() {
                let edit = walk.source_mut().edit(|lattice| {
                    let first = Post { column: column % columns, row: row % rows };
                    let last = Post {
                        column: (first.column + side).min(columns - 1),
                        row: (first.row + side / 2).min(rows - 1),
                    };
                    let posts = PostRect { first, last };
                    // Every fifth post stays as it is.
                    let raised = |(at, post): (usize, Post)| {
                        lattice.height(post) + if at % 5 == 0 { 0.0 } else { height_m }
                    };
                    let heights: Vec<f32> = posts.posts().enumerate().map(raised).collect();
                    set_heights(lattice, posts, &heights)
                });
                if let Some(edit) = edit {
                    if number == 0 { walk.mend(&edit) } else { walk.edit(&edit.patches) }.expect("in memory");
                }
                walk.update(eye, &all).expect("in memory");
                walk.check();
            }
            let [mended, edited] = &walks;
            prop_assert_eq!(shown(mended), shown(edited));
            let source = mended.source();
            prop_assert_eq!(shown(mended), rebuilt(source.ground(), source.spheres(), eye, &all));
            for &corner in &all {
                let held = [mended, edited].map(|walk| walk.block(corner).map(|block| bits(block)));
                prop_assert!(held[0] == held[1], "the patch at {:?}", corner);
            }
        }
    }
}

/// The heights and radii of a patch, bit by bit.
fn bits(block: &PatchBlock) -> [Vec<u32>; 2] {
    [&block.z, &block.radii].map(|values| values.iter().map(|value| value.to_bits()).collect())
}

#[test]
fn terrain_that_is_read_as_it_is_walked_shows_what_it_would_from_memory() {
    let lattice = hills(150, 110, &[]);
    let raster = raster_of(&lattice);
    let options = PagingOptions { patch: 16, capacity: 4 };
    let paged = PagedGround::open(raster, exact_spheres(25.0), &options).expect("sound");
    let layout = PatchLayout::new(150, 110, 16).expect("sound");
    let ground = PatchedGround { lattice: &lattice, layout: &layout };
    let map = exact_spheres(25.0)(ground);
    let all: Vec<Vertex> = layout.patches().collect();
    let mut from_file = Deferred::new(paged, 8.0).expect("small patches");
    let mut from_memory = Deferred::new(WholeGround { ground, spheres: &map }, 8.0).expect("small patches");
    let mut most = 0;
    for step in 0..40 {
        let eye = Vec3::new(100.0 + 30.0 * step as f32, 300.0 + 8.0 * step as f32, 40.0);
        let near: Vec<Vertex> =
            (all.iter().copied()).filter(|corner| (corner.x * 10 - eye.x as i32).abs() < 400).collect();
        from_memory.update(eye, &near).expect("in memory");
        from_file.update(eye, &near).expect("readable");
        from_file.forget(12);
        most = most.max(from_file.meshes());
        from_file.source().check();
        assert_eq!(shown(&from_file), shown(&from_memory), "step {step}");
    }
    let counts = from_file.source().counts();
    assert!(counts.peak <= 4 && counts.loads > 10 && most < all.len() / 2, "{counts:?}, {most} meshes");
}

/// The raster whose lattice is `lattice`.
fn raster_of(lattice: &Lattice) -> Raster {
    let (columns, rows) = (lattice.columns(), lattice.rows());
    let samples =
        (0..rows).rev().flat_map(|row| (0..columns).map(move |column| lattice.height(Post { column, row })));
    let axes = DMat2::from_diagonal(lattice.cell() * DVec2::new(1.0, -1.0));
    Raster {
        driver: "test",
        data_type: "Float32",
        width: columns,
        height: rows,
        samples: Samples::F32(samples.collect()),
        meters_per_z: 1.0,
        states_z_unit: false,
        map_from_grid: DAffine2 { matrix2: axes, translation: DVec2::new(-5.0, f64::from(rows) * 8.0 - 4.0) },
        georeferenced: true,
        crs: None,
        ..Raster::without_place(1, 1)
    }
}

#[test]
fn an_eye_that_leaps_to_nowhere_and_back_sees_what_is_there() {
    let lattice = hills(90, 90, &[]);
    let layout = PatchLayout::new(90, 90, 16).expect("sound");
    let ground = PatchedGround { lattice: &lattice, layout: &layout };
    let map = spheres(ground, 20.0);
    let all: Vec<Vertex> = layout.patches().collect();
    let mut walk = Deferred::new(WholeGround { ground, spheres: &map }, 8.0).expect("small patches");
    let nowhere = [f32::NAN, f32::INFINITY, f32::MAX, 1e20, -1e9];
    for (step, x) in nowhere.into_iter().cycle().take(40).enumerate() {
        walk.update(Vec3::new(x, 0.0, 10.0), &all).expect("in memory");
        for eye in [Vec3::new(100.0 + 15.0 * step as f32, 300.0, 40.0), Vec3::new(430.0, 330.0, 30.0)] {
            walk.update(eye, &all).expect("in memory");
            assert!(shown(&walk) == rebuilt(ground, &map, eye, &all), "another mesh after {x}");
        }
    }
}

#[test]
fn an_eye_at_rest_changes_nothing_and_looks_at_nothing() {
    let lattice = hills(80, 80, &[]);
    let layout = PatchLayout::new(80, 80, 16).expect("sound");
    let ground = PatchedGround { lattice: &lattice, layout: &layout };
    let map = spheres(ground, 30.0);
    let mut walk = Deferred::new(WholeGround { ground, spheres: &map }, 8.0).expect("small patches");
    let all: Vec<Vertex> = layout.patches().collect();
    let eye = Vec3::new(300.0, 300.0, 50.0);
    assert!(walk.update(eye, &all).expect("in memory").splits > 100);
    assert_eq!(walk.update(eye, &all).expect("in memory"), &RefinementChanges::default());
    assert_eq!(walk.examined(), 0);
}

#[test]
fn patches_out_of_view_can_be_forgotten_and_come_back_the_same() {
    let lattice = hills(120, 120, &[]);
    let layout = PatchLayout::new(120, 120, 16).expect("sound");
    let ground = PatchedGround { lattice: &lattice, layout: &layout };
    let map = spheres(ground, 60.0);
    let mut walk = Deferred::new(WholeGround { ground, spheres: &map }, 8.0).expect("small patches");
    let all: Vec<Vertex> = layout.patches().collect();
    let eye = Vec3::new(500.0, 500.0, 50.0);
    walk.update(eye, &all).expect("in memory");
    let (meshes, before) = (walk.meshes(), shown(&walk));
    walk.update(eye, &all[..20]).expect("in memory");
    walk.forget(25);
    assert!(meshes > 25 && walk.meshes() == 25, "{meshes} meshes, then {}", walk.meshes());
    walk.update(eye, &all).expect("in memory");
    assert_eq!(shown(&walk), before);
}

#[test]
fn patches_with_more_vertices_than_a_u16_counts_are_refused() {
    let lattice = hills(300, 300, &[]);
    let layout = PatchLayout::new(300, 300, 256).expect("sound");
    let ground = PatchedGround { lattice: &lattice, layout: &layout };
    let map = SphereMap::nested(ground, vec![0.0; layout.vertex_count()]);
    assert!(Deferred::new(WholeGround { ground, spheres: &map }, 8.0).is_none());
}

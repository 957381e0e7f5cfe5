//! Dynamic terrain (Yu and Zhang): after any sequence of edits everything equals what is made from scratch.

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec3};
use proptest::prelude::*;
use sandtable_earthworks::brush::{BrushChanges, Crater, Embankment, TireTrack, Trench, set_heights};
use sandtable_roam::active::ActiveSet;
use sandtable_roam::block::BlockSource;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::dynamic::{DynamicOptions, DynamicTerrain, Edit, ErrorMeasure, Radius, mend_active};
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

const CELL_M: f64 = 10.0;

fn ground(columns: u32, rows: u32, seed: u64, holes: bool) -> Lattice {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let heights = (0..columns * rows).map(|index| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let (x, y) = (f64::from(index % columns), f64::from(index / columns));
        let hills = 30.0 * libm::sin(x * 0.2 + y * 0.1) + (state % 1000) as f64 * 0.004;
        let hole = holes && (x - 20.0).abs() + (y - 12.0).abs() < 5.0;
        if hole { f32::NAN } else { (100.0 + hills) as f32 }
    });
    Lattice::new(DVec2::ZERO, DVec2::splat(CELL_M), columns, heights.collect()).expect("sound")
}

/// A brush with its place as parts of the terrain's width and height.
#[derive(Clone, Debug)]
enum Brush {
    Rectangle { at: (f64, f64), size: (u32, u32), level_m: f32 },
    Crater { at: (f64, f64), radius_m: f64, depth_m: f64, rim_m: f64 },
    Trench { line: Vec<(f64, f64)>, depth_m: f64 },
    Track { line: Vec<(f64, f64)>, depth_m: f64 },
    Bank { line: Vec<(f64, f64)>, level_m: f64 },
    Both(Box<(Brush, Brush)>),
}

impl Brush {
    fn apply(&self, lattice: &mut Lattice) -> BrushChanges {
        let far = lattice.extent().max;
        let place = |&(x, y): &(f64, f64)| DVec2::new(x, y) * far;
        let line = |line: &[(f64, f64)]| line.iter().map(place).collect::<Vec<DVec2>>();
        match self {
            Self::Rectangle { at, size, level_m } => {
                let first = (place(at) / CELL_M).max(DVec2::ZERO).as_uvec2();
                let posts = PostRect {
                    first: Post { column: first.x, row: first.y },
                    last: Post { column: first.x + size.0, row: first.y + size.1 },
                };
                let count = ((size.0 + 1) * (size.1 + 1)) as usize;
                set_heights(lattice, posts, &vec![*level_m; count])
            }
            Self::Crater { at, radius_m, depth_m, rim_m } => {
                Crater { center: place(at), radius_m: *radius_m, depth_m: *depth_m, rim_m: *rim_m }
                    .apply(lattice)
            }
            Self::Trench { line: at, depth_m } => {
                Trench { line: line(at), bottom_m: 15.0, top_m: 60.0, depth_m: *depth_m }.apply(lattice)
            }
            Self::Track { line: at, depth_m } => {
                TireTrack { line: line(at), gauge_m: 40.0, rut_m: 25.0, depth_m: *depth_m }.apply(lattice)
            }
            Self::Bank { line: at, level_m } => {
                let line: Vec<DVec3> = line(at).iter().map(|at| at.extend(*level_m)).collect();
                Embankment { line, crown_m: 30.0, run: 1.5, reach_m: 120.0 }.apply(lattice)
            }
            Self::Both(both) => both.0.apply(lattice).and(both.1.apply(lattice)),
        }
    }
}

fn brushes() -> impl Strategy<Value = Brush> {
    let place = || (-0.1f64..1.1, -0.1f64..1.1);
    let line = || proptest::collection::vec(place(), 1..4);
    let one = prop_oneof![
        (place(), (0u32..9, 0u32..9), 60f32..160.0).prop_map(|(at, size, level_m)| Brush::Rectangle {
            at,
            size,
            level_m
        }),
        (place(), 5f64..90.0, 0f64..30.0, 0f64..9.0)
            .prop_map(|(at, radius_m, depth_m, rim_m)| Brush::Crater { at, radius_m, depth_m, rim_m }),
        (line(), 0f64..12.0).prop_map(|(line, depth_m)| Brush::Trench { line, depth_m }),
        (line(), 0f64..2.0).prop_map(|(line, depth_m)| Brush::Track { line, depth_m }),
        (line(), 60f64..160.0).prop_map(|(line, level_m)| Brush::Bank { line, level_m }),
    ];
    let one = one.boxed();
    prop_oneof![
        4 => one.clone(),
        1 => (one.clone(), one).prop_map(|both| Brush::Both(Box::new(both))),
    ]
}

fn all(terrain: &DynamicTerrain, eye: Vec3) -> ActiveSet {
    let criterion = Spheres::new(terrain.ground(), terrain.spheres(), eye);
    rebuild(terrain.layout(), &criterion, terrain.layout().patches())
}

/// The dirty patches by looking at every vertex of each.
fn dirty_plainly(before: &DynamicTerrain, after: &DynamicTerrain) -> Vec<sandtable_roam::graph::Vertex> {
    let layout = after.layout();
    let same = |vertex| {
        let post = layout.post(vertex);
        before.lattice().height(post).to_bits() == after.lattice().height(post).to_bits()
            && before.errors().at(layout, vertex) == after.errors().at(layout, vertex)
            && before.spheres().at(layout, vertex) == after.spheres().at(layout, vertex)
    };
    let patch = layout.patch();
    let is_dirty = |corner: &sandtable_roam::graph::Vertex| {
        (0..=patch).any(|y| (0..=patch).any(|x| !same(corner.moved(x, y))))
    };
    layout.patches().filter(is_dirty).collect()
}

fn compare(terrain: &DynamicTerrain, options: DynamicOptions) -> Result<(), TestCaseError> {
    let fresh = DynamicTerrain::new((**terrain.lattice()).clone(), options).expect("sound");
    prop_assert!(terrain.errors() == fresh.errors(), "errors");
    prop_assert!(terrain.spheres() == fresh.spheres(), "spheres");
    prop_assert!(terrain.heights() == fresh.heights(), "patch heights");
    terrain.errors().check(terrain.layout());
    terrain.spheres().check(terrain.ground());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn after_any_edits_everything_equals_what_is_made_from_scratch(
        (columns, rows) in prop_oneof![(30u32..90, 20u32..80), Just((65, 33)), Just((65, 65))],
        (seed, holes) in (0u64..500, any::<bool>()),
        patch in prop_oneof![Just(8u32), Just(16), Just(64)],
        steepness in prop_oneof![Just(1f32), Just(1.7)],
        measure in prop_oneof![Just(ErrorMeasure::Midpoint), Just(ErrorMeasure::Exact)],
        radius in prop_oneof![
            Just(Radius::Plain), Just(Radius::Constrained((1, 1))), Just(Radius::Constrained((2, 1))), Just(Radius::Bounding)
        ],
        eye in (-100f32..900.0, -100f32..900.0, 60f32..400.0),
        brushes in proptest::collection::vec(brushes(), 1..5),
    ) {
        let options = DynamicOptions { patch, measure, radius, reach: 25.0 };
        let mut terrain = DynamicTerrain::new(ground(columns, rows, seed, holes).stretched(steepness), options).expect("sound");
        let mut active = all(&terrain, Vec3::from(eye));
        for brush in &brushes {
            let before = terrain.clone();
            let edit = terrain.edit(|lattice| brush.apply(lattice));
            let patches: Vec<_> = edit.iter().flat_map(|edit: &Edit| edit.patches.clone()).collect();
            prop_assert!(patches == dirty_plainly(&before, &terrain), "dirty patches");
            compare(&terrain, options)?;
            if let Some(edit) = edit {
                let criterion = Spheres::new(terrain.ground(), terrain.spheres(), Vec3::from(eye));
                mend_active(&mut active, &criterion, &edit);
            }
            active.check();
            prop_assert!(active == all(&terrain, Vec3::from(eye)), "active set");
        }
    }
}

#[test]
fn a_held_snapshot_stays_as_it_is_and_without_one_nothing_is_copied() {
    let options =
        DynamicOptions { patch: 16, measure: ErrorMeasure::Midpoint, radius: Radius::Plain, reach: 10.0 };
    let mut terrain = DynamicTerrain::new(ground(40, 40, 3, false), options).expect("sound");
    let crater = Crater { center: DVec2::splat(200.0), radius_m: 50.0, depth_m: 9.0, rim_m: 2.0 };
    let at = terrain.lattice().heights().as_ptr();
    let edit = terrain.edit(|lattice| crater.apply(lattice)).expect("something changed");
    assert_eq!((edit.number, terrain.edits(), terrain.lattice().heights().as_ptr()), (1, 1, at));
    assert!(edit.volumes.cut_m3 > 0.0 && edit.volumes.fill_m3 > 0.0);
    let held = Arc::clone(terrain.lattice());
    let bottom = Post { column: 20, row: 20 };
    let depth = held.height(bottom);
    terrain.edit(|lattice| crater.apply(lattice)).expect("something changed");
    assert_eq!((held.height(bottom), terrain.lattice().height(bottom)), (depth, depth - 9.0));
}

#[test]
fn a_brush_beside_the_terrain_counts_as_no_edit() {
    let options =
        DynamicOptions { patch: 16, measure: ErrorMeasure::Exact, radius: Radius::Bounding, reach: 10.0 };
    let mut terrain = DynamicTerrain::new(ground(40, 40, 3, true), options).expect("sound");
    let crater = Crater { center: DVec2::splat(-900.0), radius_m: 50.0, depth_m: 9.0, rim_m: 2.0 };
    assert_eq!(terrain.edit(|lattice| crater.apply(lattice)), None);
    assert_eq!(terrain.edits(), 0);
}

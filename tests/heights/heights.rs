//! The height contract: batches are single questions, readers see whole snapshots, and what is drawn changes nothing but
//! what is displayed.

use std::sync::Arc;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DAffine2, DMat2, DVec2, Vec3};
use proptest::prelude::*;
use sandtable_earthworks::brush::Crater;
use sandtable_geom::crs::Crs;
use sandtable_mesh::trimesh::TriMesh;
use sandtable_raster::answer::{Answer, Status};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_roam::dynamic::{DynamicOptions, DynamicTerrain, ErrorMeasure, Radius};
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::query::batch::HeightSlices;
use sandtable_terrain::query::batch::bilinear_ground;
use sandtable_terrain::query::service::{HeightService, Snapshot};
use sandtable_terrain::query::source::{raster_height, source_heights};
use sandtable_terrain::query::tiles::HeightTiles;
use sandtable_terrain::query::{Interpolation, Surface, ground_height};
use sandtable_terrain::triangle_surface::{TriangleSurface, facet_contains, plane_z};
use sandtable_view::camera::Camera;

pub const ALL: [Interpolation; 5] = [
    Interpolation::Planar,
    Interpolation::Bilinear,
    Interpolation::Cubic,
    Interpolation::Nearest,
    Interpolation::DistanceWeighted4,
];

/// Numbers from 0 up to 1, the same for the same seed.
pub fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Answers that can be compared to the last bit.
pub fn bits(answer: Answer) -> (u64, Status) {
    let (height_m, status) = answer.parts();
    (if status == Status::Ok { height_m.to_bits() } else { 0 }, status)
}

/// A raster north up over the posts of a lattice.
fn raster_of(lattice: &Lattice) -> Raster {
    let rows = lattice.heights().chunks(lattice.columns() as usize).rev();
    let cell = lattice.cell();
    let corner = lattice.origin() + DVec2::new(-0.5, f64::from(lattice.rows()) - 0.5) * cell;
    Raster {
        driver: "test",
        data_type: "Float32",
        width: lattice.columns(),
        height: lattice.rows(),
        samples: Samples::F32(rows.flatten().copied().collect()),
        meters_per_z: 1.0,
        states_z_unit: false,
        map_from_grid: DAffine2 {
            matrix2: DMat2::from_diagonal(DVec2::new(cell.x, -cell.y)),
            translation: corner,
        },
        georeferenced: true,
        crs: None,
        ..Raster::without_place(1, 1)
    }
}

fn service_on(lattice: &Arc<Lattice>) -> HeightService {
    HeightService::new(
        Arc::new(sandtable_terrain::query::source_raster::SourceRaster::from(Arc::new(raster_of(lattice)))),
        Crs::local(),
        Arc::clone(lattice),
    )
}

/// Rough ground, one post in `holes` without data (none for 0).
fn rough(origin: DVec2, cell: DVec2, (columns, rows): (u32, u32), seed: u64, holes: u32) -> Lattice {
    let mut number = numbers(seed);
    let mut height = || {
        let height = (number() * 4000.0 - 500.0) as f32;
        if holes > 0 && number() * f64::from(holes) < 1.0 { f32::NAN } else { height }
    };
    let heights = (0..columns * rows).map(|_| height()).collect();
    Lattice::part((origin, cell), Post { column: 3, row: 5 }, columns, heights).expect("sound")
}

/// Positions on and off a lattice: anywhere, on posts, on lines of posts, on the outermost, and nowhere.
fn positions(lattice: &Lattice, count: u32, seed: u64) -> Vec<DVec2> {
    let mut number = numbers(seed);
    let extent = lattice.extent();
    let anywhere = |u: f64, v: f64| lattice.origin() + extent.min + DVec2::new(u, v) * extent.size();
    let last = (f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1));
    (0..count)
        .map(|index| {
            let (u, v) = (number(), number());
            let post = lattice
                .map_position(Post { column: (u * last.0).round() as u32, row: (v * last.1).round() as u32 });
            match index % 16 {
                0 => post,
                1 => DVec2::new(post.x, anywhere(u, v).y),
                2 => anywhere(u * 1.4 - 0.2, v * 1.4 - 0.2),
                3 => anywhere(if u < 0.5 { 0.0 } else { 1.0 }, v),
                4 if u < 0.1 => DVec2::new(f64::NAN, v),
                4 if u < 0.2 => DVec2::new(f64::INFINITY, -1e300),
                _ => anywhere(u, v),
            }
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_batch_answers_what_single_questions_answer_to_the_last_bit(
        size in (2u32..90, 2u32..90),
        origin in (-1e6f64..1e6, -1e7f64..1e7),
        cell in (0.1f64..40.0, 0.1f64..40.0),
        holes in 0u32..40,
        seed in any::<u64>(),
    ) {
        let lattice = Arc::new(rough(origin.into(), cell.into(), size, seed, holes));
        let at = positions(&lattice, 3000, seed ^ 77);
        let epoch = service_on(&lattice).snapshot();
        for interpolation in ALL {
            for surface in [Surface::Ground, Surface::Source, Surface::Scene, Surface::Displayed] {
                let single: Vec<_> =
                    at.iter().map(|&at| bits(epoch.height(surface, interpolation, at))).collect();
                prop_assert!(together(&epoch, surface, interpolation, &at) == single, "{surface:?} {interpolation:?}");
            }
        }
        let single: Vec<_> =
            at.iter().map(|&at| bits(ground_height(&lattice, Interpolation::Bilinear, at))).collect();
        let (mut heights, mut statuses) = (vec![0.0; at.len()], vec![Status::Ok; at.len()]);
        let tiles = HeightTiles::new(&lattice);
        bilinear_ground(&lattice, Some(&tiles), &at, HeightSlices { heights_m: &mut heights, statuses: &mut statuses });
        let tiled: Vec<_> =
            heights.iter().zip(&statuses).map(|(&height, &status)| bits(status.with_height(height))).collect();
        prop_assert!(tiled == single, "read from tiles");
    }

    #[test]
    fn a_batch_of_the_source_is_single_questions_in_any_raster(
        size in (1u32..40, 1u32..40),
        turned in 0.0f64..6.3,
        cell in (0.1f64..40.0, 0.1f64..40.0),
        meters_per_z in prop_oneof![Just(1.0), Just(0.3048)],
        is_wide in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let mut number = numbers(seed);
        let values: Vec<f64> = (0..size.0 * size.1)
            .map(|_| if number() < 0.1 { f64::NAN } else { number() * 1e3 })
            .collect();
        let samples = match is_wide {
            true => Samples::F64(values),
            false => Samples::F32(values.iter().map(|&value| value as f32).collect()),
        };
        let map_from_grid =
            DAffine2::from_scale_angle_translation(DVec2::new(cell.0, -cell.1), turned, DVec2::new(5e5, 4e6));
        let plain = rough(DVec2::ZERO, DVec2::ONE, (2, 2), 1, 0);
        let raster = Raster {
            width: size.0, height: size.1, samples, meters_per_z, map_from_grid, ..raster_of(&plain)
        };
        let at: Vec<DVec2> = (0..2000)
            .map(|index| {
                let mut grid = DVec2::new(number() * 1.2 - 0.1, number() * 1.2 - 0.1);
                grid *= DVec2::new(f64::from(size.0), f64::from(size.1));
                if index % 8 == 0 {
                    grid = grid.floor() + 0.5;
                }
                map_from_grid.transform_point2(grid)
            })
            .collect();
        for interpolation in ALL {
            let mut answers = vec![Answer::Outside; at.len()];
            source_heights(&raster, &Crs::local(), interpolation, &at, &mut answers);
            for (&at, &answer) in at.iter().zip(&answers) {
                prop_assert_eq!(bits(answer), bits(raster_height(&raster, interpolation, at)));
            }
        }
    }
}

/// A batch asked in both forms, which must agree.
fn together(
    epoch: &Snapshot,
    surface: Surface,
    interpolation: Interpolation,
    at: &[DVec2],
) -> Vec<(u64, Status)> {
    let mut answers = vec![Answer::NoData; at.len()];
    epoch.heights(surface, interpolation, at, &mut answers);
    let (mut heights, mut statuses) = (vec![0.0; at.len()], vec![Status::NoData; at.len()]);
    epoch.heights_apart(
        surface,
        interpolation,
        at,
        HeightSlices { heights_m: &mut heights, statuses: &mut statuses },
    );
    for ((&height, &status), answer) in heights.iter().zip(&statuses).zip(&answers) {
        assert_eq!(bits(status.with_height(height)), bits(*answer));
        assert_eq!(height.is_nan(), status != Status::Ok, "no number without a status");
    }
    answers.into_iter().map(bits).collect()
}

#[test]
fn a_large_batch_that_makes_tiles_on_its_way_answers_as_before() {
    let lattice = Arc::new(rough(DVec2::ZERO, DVec2::ONE, (1030, 1025), 5, 500));
    let at = positions(&lattice, 2_200_000, 9);
    let epoch = service_on(&lattice).snapshot();
    let first = together(&epoch, Surface::Ground, Interpolation::Bilinear, &at);
    let again = together(&epoch, Surface::Ground, Interpolation::Bilinear, &at);
    assert!(first == again, "with tiles and without");
    for (&at, &answer) in at.iter().zip(&again).step_by(97) {
        assert_eq!(bits(ground_height(&lattice, Interpolation::Bilinear, at)), answer);
    }
}

/// Every batch of a reader must be all of one epoch, while craters are dug.
#[test]
fn readers_see_whole_epochs_while_the_ground_is_edited() {
    let flat = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 257, vec![0.0; 257 * 257]).expect("sound");
    let options =
        DynamicOptions { patch: 32, measure: ErrorMeasure::Midpoint, radius: Radius::Plain, reach: 100.0 };
    let mut terrain = DynamicTerrain::new(flat, options).expect("large enough");
    let service = service_on(terrain.lattice());
    let at: Vec<DVec2> = (0..20_000)
        .map(|index| DVec2::new(f64::from(index % 200) * 12.8, f64::from(index / 200) * 25.6))
        .collect();
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let read = || {
            let (service, mut seen) = (service.clone(), Vec::new());
            while !is_over.load(Ordering::Relaxed) {
                let epoch = service.snapshot();
                let (mut heights, mut statuses) = (vec![0.0; at.len()], vec![Status::Ok; at.len()]);
                epoch.heights_apart(
                    Surface::Ground,
                    Interpolation::Bilinear,
                    &at,
                    HeightSlices { heights_m: &mut heights, statuses: &mut statuses },
                );
                // What the batch should have been, post by post, of the epoch that was held.
                let whole = at.iter().zip(&heights).all(|(&at, height)| {
                    ground_height(epoch.lattice(), Interpolation::Bilinear, at).height_m() == Some(*height)
                });
                assert!(whole, "epoch {} is mixed with another", epoch.number());
                // Every edit sinks the whole ground's lowest post by a meter.
                let low = epoch.lattice().height_range().0;
                assert_eq!(
                    f64::from(low),
                    -(epoch.number() as f64),
                    "half an edit in epoch {}",
                    epoch.number()
                );
                seen.push(epoch.number());
            }
            assert!(seen.is_sorted(), "an older epoch came back");
        };
        let readers = [scope.spawn(read), scope.spawn(read)];
        for edit in 1..=40u32 {
            let center = DVec2::new(1280.0, 1280.0);
            let crater = Crater { center, radius_m: 600.0, depth_m: 1.0, rim_m: 0.0 };
            terrain.edit(|lattice| crater.apply(lattice)).expect("it changes something");
            assert_eq!(service.publish(Arc::clone(terrain.lattice())).number(), u64::from(edit));
        }
        is_over.store(true, Ordering::Relaxed);
        readers.into_iter().for_each(|reader| reader.join().expect("no batch was mixed"));
    });
}

/// A small world that can be seen at any level of detail.
struct World {
    lattice: Arc<Lattice>,
    measured: MeasuredGround,
    service: HeightService,
    at: Vec<DVec2>,
    ground: Vec<(u64, Status)>,
    source: Vec<(u64, Status)>,
}

const EXAGGERATION: f32 = 1.5;

impl World {
    fn new() -> Self {
        let (columns, rows) = (60u32, 45u32);
        let height = |index: u32| {
            let (x, y) = (f64::from(index % columns), f64::from(index / columns));
            let wave = |fx: f64, fy: f64| libm::sin(x * fx + y * fy);
            (400.0 + 90.0 * wave(0.1, 0.06) + 40.0 * wave(-0.2, 0.3) + 9.0 * wave(0.7, 0.9)) as f32
        };
        let heights = (0..columns * rows).map(height).collect();
        let lattice = Lattice::new(DVec2::new(5e5, 4e6), DVec2::splat(30.0), columns, heights);
        let lattice = Arc::new(lattice.expect("sound"));
        let measured = MeasuredGround::new(lattice.stretched(EXAGGERATION), 16).expect("sound");
        let service = service_on(&lattice);
        let at = positions(&lattice, 160, 3);
        let epoch = service.snapshot();
        let ground = together(&epoch, Surface::Ground, Interpolation::Planar, &at);
        let source = together(&epoch, Surface::Source, Interpolation::Bilinear, &at);
        Self { lattice, measured, service, at, ground, source }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn for_any_camera_ground_and_source_stay_and_displayed_is_the_drawn_triangle(
        eye in (-300f32..2100.0, -300f32..1700.0, 620f32..2500.0),
        target in (0f32..1770.0, 0f32..1320.0),
        tolerance_px in 0.3f32..40.0,
    ) {
        static WORLD: LazyLock<World> = LazyLock::new(World::new);
        let target = Vec3::new(target.0, target.1, 550.0);
        let camera = Camera::new(Vec3::from(eye), target, 0.8, (800, 600), (0.5, 20_000.0)).ok();
        prop_assume!(camera.is_some());
        let terrain = Arc::new(WORLD.measured.displayed_to(&camera.expect("checked"), tolerance_px));
        let showing = WORLD.service.displaying(Arc::clone(&terrain) as Arc<dyn TriangleSurface>, f64::from(EXAGGERATION));
        let epoch = showing.snapshot();
        prop_assert!(together(&epoch, Surface::Ground, Interpolation::Planar, &WORLD.at) == WORLD.ground);
        prop_assert!(together(&epoch, Surface::Source, Interpolation::Bilinear, &WORLD.at) == WORLD.source);
        let mut drawn = TriMesh::default();
        terrain.emit(&mut drawn);
        for &at in WORLD.at.iter().step_by(5) {
            let world = at - WORLD.lattice.origin();
            let over = (0..drawn.triangles.len())
                .map(|index| drawn.corners(index))
                .find(|facet| facet_contains(facet, world));
            let answer = epoch.height(Surface::Displayed, Interpolation::Nearest, at);
            match over {
                Some(facet) => {
                    let exact = plane_z(&facet, world) / f64::from(EXAGGERATION);
                    let found = answer.height_m();
                    prop_assert!(found.is_some_and(|found| (found - exact).abs() < 1e-3), "{found:?} for {exact}");
                }
                None => prop_assert_eq!(answer, Answer::Outside),
            }
        }
    }
}

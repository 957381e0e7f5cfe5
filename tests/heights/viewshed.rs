//! The viewshed is, on every post, what a line of sight to that post says.

use std::fs;

use glam::DVec2;
use proptest::prelude::*;
use sandtable_dem::hints::DemHints;
use sandtable_dem::read;
use sandtable_raster::answer::Answer;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::{Sight, SightEnd, line_of_sight};
use sandtable_terrain::sight::viewshed::rises::{
    RISE_ERROR_M, RISE_ERROR_SHARE, required_rises, required_rises_by_lines,
};
use sandtable_terrain::sight::viewshed::{
    PostVisibility, Sector, Viewshed, ViewshedOptions, viewshed, viewshed_by_lines,
};
use sandtable_terrain::stop_flag::StopFlag;

use crate::common::data::data;

/// A generator of numbers that are the same on every machine.
struct Seeded(u64);

impl Seeded {
    /// From 0 up to 1.
    fn part(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: u32) -> u32 {
        (self.part() * f64::from(count)) as u32
    }
}

const ORIGIN: DVec2 = DVec2::new(5e5, 4e6);

/// Ground of a kind: 0 rough, 1 hills, 2 gentle waves, 3 terraces, 4 a level, 5 a slope that is one plane, 6 a bowl, most
/// of which faces whoever stands in it.
fn ground(kind: u32, (columns, rows): (u32, u32), cell: DVec2, holes: f64, seed: u64) -> Lattice {
    let mut seeded = Seeded(seed | 1);
    let (a, b) = (seeded.part() * 0.3, seeded.part() * 0.3);
    let mut height = |column: u32, row: u32| {
        let (x, y) = (f64::from(column), f64::from(row));
        let rough = seeded.part();
        let hills = libm::sin(x * (0.2 + a)) * 30.0 + libm::cos(y * (0.17 + b) + x * 0.05) * 25.0;
        let height = match kind {
            0 => rough * 40.0,
            1 => hills + rough * 3.0,
            2 => hills * 0.2,
            3 => (hills / 10.0).floor() * 8.0,
            4 => 17.0,
            5 => x * 3.0 - y * 2.0,
            _ => {
                let middle = DVec2::new(f64::from(columns), f64::from(rows)) / 2.0;
                0.01 * DVec2::new(x, y).distance_squared(middle) + rough * 4.0
            }
        };
        if seeded.part() < holes { f32::NAN } else { height as f32 }
    };
    let mut heights: Vec<f32> =
        (0..columns * rows).map(|index| height(index % columns, index / columns)).collect();
    if heights.iter().all(|height| height.is_nan()) {
        // A lattice without any data is none.
        heights[0] = 17.0;
    }
    Lattice::new(ORIGIN, cell, columns, heights).expect("sound")
}

/// All options but where the observer stands.
fn options(at: DVec2) -> ViewshedOptions {
    ViewshedOptions {
        observer: SightEnd { at, above_m: 2.0 },
        target_above_m: 0.0,
        range_m: f64::INFINITY,
        sector: Sector::ALL,
        curvature: Curvature::default(),
    }
}

/// Checks that the rises of targets are those of lines within their error, and above 0 exactly where the viewshed hides; the
/// greatest difference in meters, and the number of lines.
fn check_rises(lattice: &Lattice, options: &ViewshedOptions, swept: &Viewshed) -> (f64, usize) {
    let rises = required_rises(lattice, options, &StopFlag::default()).expect("ground").expect("not stopped");
    let by_lines = required_rises_by_lines(lattice, options).expect("ground");
    let mut most_m = 0.0_f64;
    for (post, &seen) in lattice.posts().zip(&swept.posts) {
        let index = lattice.index(post);
        let (rise_m, wanted_m) = (rises.rises_m[index], by_lines.rises_m[index]);
        let is_known = matches!(seen, PostVisibility::Visible | PostVisibility::Hidden);
        assert_eq!((!rise_m.is_nan(), rise_m > 0.0), (is_known, seen == PostVisibility::Hidden), "{post:?}");
        if is_known {
            let off_m = f64::from((rise_m - wanted_m).abs());
            let most = RISE_ERROR_M.max(RISE_ERROR_SHARE * f64::from(wanted_m));
            assert!(off_m <= most, "{post:?}: {rise_m} for {wanted_m}");
            most_m = most_m.max(off_m);
        }
    }
    (most_m, rises.lines)
}

/// Where the viewshed and the lines differ; checks the rises too.
fn differences(lattice: &Lattice, options: &ViewshedOptions) -> Vec<(Post, PostVisibility, PostVisibility)> {
    let (swept, lines) = (viewshed(lattice, options), viewshed_by_lines(lattice, options));
    let (swept, lines) = match (swept, lines) {
        (Ok(swept), Ok(lines)) => (swept, lines),
        (swept, lines) => {
            assert_eq!(swept.err(), lines.err());
            return Vec::new();
        }
    };
    check_rises(lattice, options, &swept);
    let pairs = lattice.posts().zip(swept.posts.iter().zip(&lines.posts));
    pairs
        .filter(|(_, (swept, line))| swept != line)
        .map(|(post, (&swept, &line))| (post, swept, line))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_sweep_says_of_every_post_what_its_line_says(
        kind in 0..7u32,
        size in (2..70u32, 2..70u32),
        cell in prop_oneof![Just(DVec2::splat(10.0)), Just(DVec2::new(10.3, 27.1)), Just(DVec2::new(400.0, 90.0))],
        holes in prop_oneof![Just(0.0), Just(0.02), Just(0.3)],
        seed in any::<u64>(),
        stands in (0.0..=1.0f64, 0.0..=1.0f64),
        on in 0..5u32,
        above in prop_oneof![Just(0.0), Just(2.0), Just(50.0)],
        target in prop_oneof![Just(0.0), Just(1.6), Just(30.0)],
        curvature in prop_oneof![
            Just(Curvature::default()),
            Just(Curvature::FLAT),
            // A moon on which a cell bends by meters, and air that bends light more than that.
            Just(Curvature { radius_m: 3000.0, refraction: 0.0 }),
            Just(Curvature { radius_m: 50_000.0, refraction: 3.0 }),
        ],
        range in prop_oneof![Just(f64::INFINITY), Just(333.0), Just(5000.0)],
        sector in prop_oneof![Just(Sector::ALL), (0.0..360.0f64, 1.0..300.0f64).prop_map(|(from, width)| {
            Sector { from_deg: from, width_deg: width }
        })],
    ) {
        let lattice = ground(kind, size, cell, holes, seed);
        let last = DVec2::new(f64::from(size.0 - 1), f64::from(size.1 - 1));
        let grid = DVec2::new(stands.0, stands.1) * last;
        let grid = match on {
            0 => grid,
            1 => grid.round(),
            2 => (grid * 2.0).round() / 2.0,
            3 => (grid.round() + DVec2::splat(1e-9)).min(last),
            _ => DVec2::new(grid.x.round(), grid.y),
        };
        let options = ViewshedOptions {
            observer: SightEnd { at: ORIGIN + grid * cell, above_m: above },
            target_above_m: target,
            range_m: range,
            sector,
            curvature,
        };
        let differences = differences(&lattice, &options);
        prop_assert!(differences.is_empty(), "{grid}: {} of them, {:?}", differences.len(), &differences[..differences.len().min(4)]);
    }
}

#[test]
fn on_posts_with_whole_coordinates_a_line_of_sight_says_the_same_to_the_last_bit() {
    let lattice = ground(1, (61, 47), DVec2::new(10.0, 30.0), 0.01, 5);
    for (column, row, above_m) in [(30.0, 20.0, 2.0), (0.0, 46.0, 0.0), (12.5, 7.25, 10.0)] {
        let options = ViewshedOptions {
            observer: SightEnd { at: ORIGIN + DVec2::new(column, row) * lattice.cell(), above_m },
            ..options(ORIGIN)
        };
        let swept = viewshed(&lattice, &options).expect("there is ground");
        for (post, &seen) in lattice.posts().zip(&swept.posts) {
            let target = SightEnd { at: lattice.map_position(post), above_m: 0.0 };
            let line = match line_of_sight(&lattice, options.observer, target, options.curvature) {
                Sight::Clear => PostVisibility::Visible,
                Sight::Blocked(_) => PostVisibility::Hidden,
                Sight::NoGround(_) => PostVisibility::NoData,
            };
            assert_eq!(seen, line, "{post:?} from {column}, {row}");
        }
    }
}

/// A corner of real ground, `size` posts wide at most.
fn real(name: &str, bytes: &[u8], first: Post, size: u32) -> Lattice {
    let raster = read::read(name, bytes, &DemHints::default()).expect("sound");
    let whole = Lattice::from_raster(&raster).expect("sound");
    let (columns, rows) = (size.min(whole.columns() - first.column), size.min(whole.rows() - first.row));
    let posts = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let height = |(column, row)| whole.height(Post { column: first.column + column, row: first.row + row });
    Lattice::new(whole.origin(), whole.cell(), columns, posts.map(height).collect()).expect("sound")
}

fn holds_on(name: &str, lattice: &Lattice) {
    let last = DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1));
    let mut seeded = Seeded(7);
    for turn in 0..6 {
        let grid = DVec2::new(seeded.part(), seeded.part()) * last;
        let grid = if turn % 2 == 0 { grid.round() } else { grid };
        let options = ViewshedOptions {
            observer: SightEnd {
                at: lattice.origin() + grid * lattice.cell(),
                above_m: [0.0, 2.0, 50.0][seeded.below(3) as usize],
            },
            target_above_m: [0.0, 2.0][seeded.below(2) as usize],
            ..options(ORIGIN)
        };
        let differences = differences(lattice, &options);
        if let Ok(swept) = viewshed(lattice, &options) {
            let (most_m, rise_lines) = check_rises(lattice, &options, &swept);
            let (lines, posts) = (swept.lines, lattice.heights().len());
            println!("{name} from {grid}: {lines} of {posts} posts by line");
            println!("  rises: {rise_lines} by line, off by {most_m} m at most");
        }
        assert!(differences.is_empty(), "{name} {grid}: {} of them", differences.len());
    }
}

#[test]
fn on_the_jacksboro_ground_it_is_exact() {
    let path = concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/dem.tif");
    let bytes = fs::read(path).expect("the demo's ground");
    holds_on("jacksboro", &real("dem.tif", &bytes, Post { column: 0, row: 0 }, 400));
}

#[test]
fn on_crater_lake_with_its_level_water_it_is_exact() {
    let Some(path) = data("scenes/crater_lake_bt/crater.bt") else { return };
    let bytes = fs::read(path).expect("readable");
    holds_on("crater", &real("crater.bt", &bytes, Post { column: 250, row: 250 }, 513));
}

#[test]
fn what_lies_beyond_the_range_or_out_of_the_sector_is_told_from_what_is_hidden() {
    let lattice = ground(4, (21, 21), DVec2::splat(10.0), 0.0, 1);
    let options = ViewshedOptions {
        range_m: 50.0,
        sector: Sector::between(0.0, 90.0),
        ..options(ORIGIN + DVec2::splat(100.0))
    };
    let swept = viewshed(&lattice, &options).expect("there is ground");
    let at = |column: u32, row: u32| swept.posts[lattice.index(Post { column, row })];
    assert_eq!(
        [at(10, 15), at(15, 10), at(13, 14)],
        [PostVisibility::Visible; 3],
        "the borders belong to it"
    );
    assert_eq!([at(10, 16), at(9, 12), at(10, 5), at(14, 14)], [PostVisibility::Beyond; 4]);
    let counts = swept.counts();
    assert_eq!((counts.visible, counts.visible + counts.beyond), (26, 441));
}

#[test]
fn an_observer_without_ground_sees_nothing_and_says_why() {
    let mut heights = vec![1.0; 25];
    heights[12] = f32::NAN;
    let lattice = Lattice::new(ORIGIN, DVec2::ONE, 5, heights).expect("sound");
    let from = |x: f64, y: f64| viewshed(&lattice, &options(ORIGIN + DVec2::new(x, y))).err();
    assert_eq!(from(2.0, 2.0), Some(Answer::NoData));
    assert_eq!(from(-1.0, 2.0), Some(Answer::Outside));
}

#[test]
fn the_answer_is_the_same_for_any_number_of_threads() {
    let lattice = ground(1, (200, 150), DVec2::splat(10.0), 0.001, 3);
    let options = options(ORIGIN + DVec2::new(803.0, 611.0));
    let with = |threads: usize| -> Viewshed {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| viewshed(&lattice, &options).expect("there is ground"))
    };
    assert_eq!(with(1), with(2));
    assert_eq!(with(1), with(5));
}

#[test]
fn a_line_along_a_diagonal_is_swept_as_it_is_walked() {
    let lattice = ground(3, (18, 56), DVec2::splat(10.0), 0.0, 7_439_385_862_337_633_148);
    let options = ViewshedOptions {
        observer: SightEnd { at: ORIGIN + DVec2::new(160.0, 350.0), above_m: 0.0 },
        target_above_m: 1.6,
        range_m: f64::INFINITY,
        sector: Sector::ALL,
        curvature: Curvature::FLAT,
    };
    assert_eq!(differences(&lattice, &options), []);
}

/// Straight up a column of posts, with holes on both sides of it.
#[test]
fn a_line_along_a_column_between_holes_is_swept_as_it_is_walked() {
    let lattice = ground(0, (30, 33), DVec2::new(10.3, 27.1), 0.3, 15_841_423_109_550_663_990);
    let options = ViewshedOptions {
        observer: SightEnd { at: ORIGIN + DVec2::new(1.0, 21.0) * lattice.cell(), above_m: 50.0 },
        ..options(ORIGIN)
    };
    assert_eq!(differences(&lattice, &options), []);
}

/// Positions on posts are map coordinates, and rounding moves some of them off: then the eye's own post may be a crossing.
#[test]
fn an_eye_that_rounding_moves_off_its_post_between_holes_sees_as_its_lines_do() {
    let cell = DVec2::new(10.3, 27.1);
    // Near the origin of the map, where coordinates are finest.
    let heights = ground(2, (40, 40), cell, 0.3, 7).heights().to_vec();
    let lattice = Lattice::new(DVec2::ZERO, cell, 40, heights).expect("sound");
    for post in lattice.posts().filter(|&post| post.row < 6 && !lattice.height(post).is_nan()) {
        let options = ViewshedOptions {
            observer: SightEnd { at: post.grid() * cell, above_m: 0.0 },
            target_above_m: 1.6,
            curvature: Curvature::FLAT,
            ..options(ORIGIN)
        };
        assert_eq!(differences(&lattice, &options), [], "{post:?}");
    }
}

#[test]
fn an_eye_just_above_a_steep_summit_leaves_next_to_nothing_to_lines() {
    const SIZE: u32 = 201;
    let mut seeded = Seeded(3);
    let mut height = |index: u32| {
        let from_summit = DVec2::new(f64::from(index % SIZE), f64::from(index / SIZE)) - 100.0;
        (2000.0 - 2.0 * from_summit.length() + 0.01 * seeded.part()) as f32
    };
    let heights = (0..SIZE * SIZE).map(&mut height).collect();
    let lattice = Lattice::new(ORIGIN, DVec2::splat(10.0), SIZE, heights).expect("sound");
    for (beside, above_m) in [(0.0, 0.1), (0.003, 0.1), (0.03, 0.1), (0.5, 0.5), (0.03, 0.0)] {
        let options = ViewshedOptions {
            observer: SightEnd { at: ORIGIN + DVec2::splat(1000.0 + 10.0 * beside), above_m },
            ..options(ORIGIN)
        };
        let swept = viewshed(&lattice, &options).expect("there is ground");
        assert!(swept.lines < 200, "{beside}: {} of {} posts", swept.lines, swept.posts.len());
        assert_eq!(differences(&lattice, &options), [], "{beside}");
    }
}

/// Large enough that rings hide the ones before over many buckets of the horizon, here and there not.
#[test]
fn rough_ground_that_faces_the_eye_is_swept_as_its_lines_are_walked() {
    for (holes, seed) in [(0.0, 1), (0.001, 2)] {
        let lattice = ground(6, (181, 163), DVec2::new(10.0, 12.0), holes, seed);
        for (grid, above_m) in [(DVec2::new(90.0, 80.0), 2.0), (DVec2::new(95.3, 70.8), 0.1)] {
            let options = ViewshedOptions {
                observer: SightEnd { at: ORIGIN + grid * lattice.cell(), above_m },
                ..options(ORIGIN)
            };
            let swept = viewshed(&lattice, &options).expect("there is ground");
            let counts = swept.counts();
            assert!(counts.visible > 2000 && counts.hidden > 2000, "{counts:?}");
            assert!(swept.lines < 500, "{} lines", swept.lines);
            assert_eq!(differences(&lattice, &options), [], "{grid}");
        }
    }
}

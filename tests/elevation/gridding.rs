//! Grids of scattered points: against `spade`, against full searches, on real surveys and on broken files.

use crate::common::data;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use sandtable_dem::gridding::error::GridError;
use sandtable_dem::gridding::method::GriddingMethod;
use sandtable_dem::gridding::{BeyondHull, Gridded, grid};
use sandtable_dem::points::cloud::{PointCloud, PointHints};
use sandtable_dem::points::error::PointsError;
use sandtable_dem::points::read;
use sandtable_geom::rect::Rect;
use sandtable_raster::cell_grid::CellGrid;
use sandtable_raster::error::DemErrorKind;
use spade::{DelaunayTriangulation, FloatTriangulation, HasPosition, Point2, Triangulation};

use crate::common::data::data;

const ALL: [GriddingMethod; 5] = [
    GriddingMethod::Tin,
    GriddingMethod::Natural,
    GriddingMethod::InverseDistance { k: 7, power: 2.0 },
    GriddingMethod::Quadrant { power: 1.0 },
    GriddingMethod::Nearest,
];

fn cloud(points: Vec<DVec3>) -> PointCloud {
    let notes = Vec::new();
    PointCloud { points, breaklines: Vec::new(), crs: None, meters_per_z: 1.0, vertical_datum: None, notes }
}

/// Points at random on a square of a side, the same for the same seed.
fn random(count: usize, side: f64, seed: u64, height: impl Fn(DVec2) -> f64) -> Vec<DVec3> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * side
    };
    let mut place = || DVec2::new(next(), next());
    (0..count).map(|_| place()).map(|at| at.extend(height(at))).collect()
}

fn hilly(at: DVec2) -> f64 {
    40.0 * (at.x * 0.11).sin() + 25.0 * (at.y * 0.07).cos() + at.x * 0.3
}

fn square(side: f64, cell: f64) -> CellGrid {
    CellGrid::around(Rect { min: DVec2::ZERO, max: DVec2::splat(side) }, cell).expect("a lattice")
}

fn heights(gridded: &Gridded) -> Vec<f64> {
    gridded.raster.samples.iter().collect()
}

fn made(cloud: &PointCloud, frame: &CellGrid, method: GriddingMethod) -> Vec<f64> {
    heights(&grid(cloud, frame, method, BeyondHull::NoData).expect("a grid"))
}

/// The centers of a frame's cells, in the order of a raster.
fn centers(frame: &CellGrid) -> Vec<DVec2> {
    (0..frame.height())
        .flat_map(|row| (0..frame.width()).map(move |column| (column, row)))
        .map(|(column, row)| frame.center(column, row))
        .collect()
}

struct Vertex(DVec3);

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(self.0.x, self.0.y)
    }
}

fn web(points: &[DVec3]) -> DelaunayTriangulation<Vertex> {
    DelaunayTriangulation::bulk_load(points.iter().map(|&point| Vertex(point)).collect())
        .expect("sound points")
}

#[test]
fn triangles_and_natural_neighbors_agree_with_spade() {
    let points = random(2000, 100.0, 5, hilly);
    let frame = square(100.0, 0.7);
    let web = web(&points);
    let (linear, natural) = (web.barycentric(), web.natural_neighbor());
    let (ours_linear, ours_natural) = (
        made(&cloud(points.clone()), &frame, GriddingMethod::Tin),
        made(&cloud(points), &frame, GriddingMethod::Natural),
    );
    let mut compared = 0;
    for ((at, ours), ours_natural) in centers(&frame).iter().zip(ours_linear).zip(ours_natural) {
        let at = Point2::new(at.x, at.y);
        let theirs = linear.interpolate(|vertex| vertex.data().0.z, at);
        assert_eq!(theirs.is_none(), ours.is_nan(), "{at:?}");
        assert_eq!(ours.is_nan(), ours_natural.is_nan(), "{at:?}");
        if let Some(theirs) = theirs {
            assert!((theirs - ours).abs() < 1e-9, "{at:?}: {theirs} and {ours}");
            let theirs = natural.interpolate(|vertex| vertex.data().0.z, at).expect("inside");
            assert!((theirs - ours_natural).abs() < 1e-6, "{at:?}: {theirs} and {ours_natural}");
            compared += 1;
        }
    }
    assert!(compared > 19_000, "{compared}");
}

#[test]
fn inverse_distance_is_that_of_a_full_search_bit_for_bit() {
    let mut points = random(900, 50.0, 11, hilly);
    // On a lattice as well, where many are equally far.
    points.extend(
        (0..400u32)
            .map(|index| DVec2::new(f64::from(index % 20), f64::from(index / 20)))
            .map(|at| at.extend(hilly(at))),
    );
    let frame = square(50.0, 0.5);
    for (k, power) in [(1, 2.0), (5, 1.0), (12, 2.0), (40, 3.5), (5000, 2.0)] {
        let ours = made(&cloud(points.clone()), &frame, GriddingMethod::InverseDistance { k, power });
        let mut sorted = points.clone();
        sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        for (at, ours) in centers(&frame).into_iter().zip(ours).filter(|(_, ours)| !ours.is_nan()).step_by(37)
        {
            let mut near: Vec<(f64, f64)> =
                sorted.iter().map(|point| ((point.truncate() - at).length_squared(), point.z)).collect();
            // Stable: of equally far ones the first by x and y stays first.
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            near.truncate(k as usize);
            assert_eq!(ours.to_bits(), weighted(&near, power).to_bits(), "{at}, {k} nearest");
        }
    }
}

/// The formula of the documentation, nearest first.
fn weighted(near: &[(f64, f64)], power: f64) -> f64 {
    let (first2, first) = near[0];
    if first2 == 0.0 {
        return first;
    }
    let (mut sum, mut total) = (0.0, 1.0);
    for &(distance2, z) in &near[1..] {
        let ratio2 = first2 / distance2;
        let weight = match power {
            2.0 => ratio2,
            1.0 => ratio2.sqrt(),
            _ => libm::pow(ratio2, power * 0.5),
        };
        sum += weight * (z - first);
        total += weight;
    }
    first + sum / total
}

#[test]
fn quadrants_take_one_point_from_each_side() {
    // Three points crowd the east; inverse distance follows them, quadrants hear the west as well.
    let points = [
        (1.0, 0.5, 10.0),
        (1.1, 0.6, 10.0),
        (1.2, 0.4, 10.0),
        (-1.0, 0.5, 0.0),
        (-1.0, -0.5, 0.0),
        (1.0, -0.5, 10.0),
    ];
    let points = points.map(|(x, y, z)| DVec3::new(x, y, z)).to_vec();
    let frame =
        CellGrid::within(Rect { min: DVec2::splat(-0.5), max: DVec2::splat(0.5) }, 1.0).expect("one cell");
    let quadrants = made(&cloud(points.clone()), &frame, GriddingMethod::Quadrant { power: 1.0 });
    assert!((quadrants[0] - 5.0).abs() < 1e-12, "{quadrants:?}");
    let nearest = made(&cloud(points), &frame, GriddingMethod::InverseDistance { k: 4, power: 1.0 });
    assert!((nearest[0] - 5.0).abs() < 1e-12, "{nearest:?}");
}

#[test]
fn breaklines_hold_where_points_alone_would_cut_the_corner() {
    // A ridge of 10 between two valleys; its points lie far apart, and Delaunay joins the valleys across it.
    let valley = [(-5.0, 0.0), (5.0, 0.0), (-5.0, 10.0), (5.0, 10.0), (-0.5, 5.0), (0.5, 5.0)];
    let mut cloud = cloud(valley.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec());
    let frame =
        CellGrid::within(Rect { min: DVec2::new(-0.1, 0.9), max: DVec2::new(0.1, 9.1) }, 0.2).expect("cells");
    let low = made(&cloud, &frame, GriddingMethod::Tin);
    assert!(low.iter().all(|&height| height == 0.0), "{low:?}");
    cloud.breaklines = vec![vec![DVec3::new(0.0, 0.0, 10.0), DVec3::new(0.0, 10.0, 10.0)]];
    for method in ALL {
        let ridge = made(&cloud, &frame, method);
        let sound =
            |height: &f64| (height - 10.0).abs() < if method == GriddingMethod::Tin { 1e-12 } else { 2.0 };
        assert!(ridge.iter().all(sound), "{method:?}: {ridge:?}");
    }
}

#[test]
fn breaklines_that_cross_meet_at_the_mean_and_are_told() {
    let corners = [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0), (10.0, 10.0)];
    let mut cloud = cloud(corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec());
    let line = |from: (f64, f64), to: (f64, f64), z: f64| {
        vec![DVec3::new(from.0, from.1, z), DVec3::new(to.0, to.1, z)]
    };
    cloud.breaklines = vec![line((1.0, 5.0), (9.0, 5.0), 4.0), line((5.0, 1.0), (5.0, 9.0), 8.0)];
    let frame =
        CellGrid::within(Rect { min: DVec2::splat(4.5), max: DVec2::splat(5.5) }, 1.0).expect("one cell");
    let gridded = grid(&cloud, &frame, GriddingMethod::Tin, BeyondHull::NoData).expect("a grid");
    assert_eq!(heights(&gridded), [6.0]);
    assert_eq!((gridded.report.crossings.count, gridded.report.crossings.largest_gap), (1, 4.0));
    assert_eq!((gridded.report.points, gridded.report.breaklines), (4, 2));
}

#[test]
fn any_order_and_any_number_of_threads_give_the_same_bits() {
    let mut points = random(3000, 90.0, 21, hilly);
    points.extend_from_within(..500);
    points.extend(
        (0..900u32)
            .map(|index| DVec3::new(f64::from(index % 30), f64::from(index / 30), f64::from(index % 7))),
    );
    let frame = square(90.0, 1.0);
    let mut turned = points.clone();
    turned.reverse();
    turned.rotate_left(1234);
    for method in ALL {
        let bits = |points: &[DVec3]| -> Vec<u64> {
            made(&cloud(points.to_vec()), &frame, method).into_iter().map(f64::to_bits).collect()
        };
        let here = bits(&points);
        assert!(here == bits(&turned), "{method:?}: another order");
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        let three = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        assert!(here == one.install(|| bits(&points)), "{method:?}: one thread");
        assert!(here == three.install(|| bits(&points)), "{method:?}: three threads");
    }
}

#[test]
fn a_regular_grid_comes_back_where_its_posts_are() {
    // All neighbors on common circles, all border posts on the hull: what exact predicates are for.
    let posts =
        (0..40u32).flat_map(|y| (0..30u32).map(move |x| DVec2::new(f64::from(x) * 0.1, f64::from(y) * 0.1)));
    let points: Vec<DVec3> = posts.map(|at| at.extend(hilly(at * 20.0))).collect();
    let extent = Rect { min: DVec2::splat(-0.05), max: DVec2::new(2.95, 3.95) };
    let frame = CellGrid::within(extent, 0.1).expect("a lattice");
    for method in ALL {
        let gridded = grid(&cloud(points.clone()), &frame, method, BeyondHull::Nearest).expect("a grid");
        for (row, heights) in heights(&gridded).chunks(30).rev().enumerate() {
            for (column, height) in heights.iter().enumerate() {
                let wanted = points[row * 30 + column].z;
                assert!(
                    (height - wanted).abs() < 1e-6,
                    "{method:?} at {column}, {row}: {height} for {wanted}"
                );
            }
        }
    }
}

#[test]
fn beyond_the_hull_is_no_data_or_the_nearest_point() {
    let points = vec![DVec3::new(1.0, 1.0, 1.0), DVec3::new(9.0, 1.0, 2.0), DVec3::new(5.0, 9.0, 3.0)];
    let frame = square(10.0, 1.0);
    for method in ALL {
        let holes = made(&cloud(points.clone()), &frame, method);
        let filled = grid(&cloud(points.clone()), &frame, method, BeyondHull::Nearest).expect("a grid");
        assert_eq!((filled.report.filled, holes[0].is_nan(), heights(&filled)[0]), (100, true, 3.0));
        let kept = holes.iter().zip(heights(&filled)).filter(|(height, _)| !height.is_nan());
        assert!(
            kept.clone().count() > 20 && kept.clone().all(|(height, filled)| *height == filled),
            "{method:?}"
        );
    }
}

#[test]
fn points_on_a_line_are_refused_or_taken_by_the_nearest() {
    let points: Vec<DVec3> =
        (0..9).map(|at| DVec3::new(f64::from(at), f64::from(at) * 2.0, f64::from(at))).collect();
    let frame = square(10.0, 1.0);
    for method in ALL {
        let refused = grid(&cloud(points.clone()), &frame, method, BeyondHull::NoData);
        assert!(matches!(refused, Err(GridError::Collinear(9))), "{method:?}");
    }
    assert!(grid(&cloud(points), &frame, GriddingMethod::Nearest, BeyondHull::Nearest).is_ok());
    let wrong = GriddingMethod::InverseDistance { k: 3, power: f64::NAN };
    assert!(matches!(
        grid(&cloud(Vec::new()), &frame, wrong, BeyondHull::NoData),
        Err(GridError::Parameter { .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn triangles_and_natural_neighbors_reproduce_planes(
        seed in 0u64..1000, count in 10usize..400, slope in (-3.0f64..3.0, -3.0f64..3.0), far in 0.0f64..1e6,
    ) {
        let plane = |at: DVec2| slope.0 * at.x + slope.1 * at.y + 500.0;
        let mut points = random(count, 60.0, seed, plane);
        points.iter_mut().for_each(|point| *point += DVec3::new(far, far, 0.0));
        let extent = Rect { min: DVec2::splat(far), max: DVec2::splat(far + 60.0) };
        let frame = CellGrid::within(extent, 1.5).expect("a lattice");
        for method in [GriddingMethod::Tin, GriddingMethod::Natural] {
            for (at, height) in centers(&frame).into_iter().zip(made(&cloud(points.clone()), &frame, method)) {
                prop_assert!(height.is_nan() || (height - plane(at - far)).abs() < 1e-6, "{:?} at {}: {}", method, at, height);
            }
        }
    }

    #[test]
    fn heights_stay_in_the_range_of_the_points(seed in 0u64..1000, count in 3usize..300, cell in 0.3f64..9.0) {
        let points = random(count, 40.0, seed, hilly);
        let low = points.iter().map(|point| point.z).fold(f64::INFINITY, f64::min) - 1e-9;
        let high = points.iter().map(|point| point.z).fold(f64::NEG_INFINITY, f64::max) + 1e-9;
        for method in ALL {
            let gridded = grid(&cloud(points.clone()), &square(40.0, cell), method, BeyondHull::Nearest).expect("a grid");
            prop_assert!(heights(&gridded).iter().all(|height| (low..=high).contains(height)), "{:?}", method);
        }
    }
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).expect("a file of the test data")
}

fn oracle(path: &Path) -> (serde_json::Value, Vec<(usize, DVec3, u8)>) {
    let name = path.file_name().expect("named").to_string_lossy().into_owned();
    let beside = |suffix: &str| path.with_file_name("oracle").join(format!("{name}{suffix}"));
    let json = serde_json::from_slice(&bytes(&beside(".json"))).expect("JSON");
    let text = String::from_utf8(bytes(&beside(".samples.csv"))).expect("text");
    let samples = text.lines().skip(1).map(|line| {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
        (fields[0] as usize, DVec3::new(fields[1], fields[2], fields[3]), fields[4] as u8)
    });
    (json, samples.collect())
}

#[test]
fn surveys_are_read_as_laspy_reads_them() {
    let Some(folder) = data("pointcloud") else { return };
    for name in ["simple.las", "simple.laz", "1.2-with-color.las", "autzen_trim.laz"] {
        let path = folder.join(name);
        let (oracle, samples) = oracle(&path);
        let classes: Vec<u8> = (0..=255).collect();
        let all = read(&bytes(&path), &PointHints { crs: None, classes: &classes })
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(all.points.len() as u64, oracle["points"].as_u64().expect("a count"), "{name}");
        for (index, place, _) in &samples {
            let found = all.points[*index];
            assert!((found - *place).abs().max_element() < 1e-6, "{name} {index}: {found} for {place}");
        }
        let ground = read(&bytes(&path), &PointHints::default()).expect("ground");
        assert_eq!(ground.points.len() as u64, oracle["classes"]["2"].as_u64().expect("a count"), "{name}");
        assert!(ground.notes.iter().any(|note| note.contains("of class 2")), "{:?}", ground.notes);
        let refused = read(&bytes(&path), &PointHints { crs: None, classes: &[77] });
        assert!(refused.is_err_and(|error| error.to_string().contains("of class 1")), "{name}");
    }
}

#[test]
fn a_packed_survey_is_its_plain_twin() {
    let Some(folder) = data("pointcloud") else { return };
    let points = |name: &str| read(&bytes(&folder.join(name)), &PointHints::default()).expect("read").points;
    assert_eq!(points("simple.las"), points("simple.laz"));
}

#[test]
fn heights_of_a_survey_in_feet_are_taken_in_feet() {
    let Some(path) = data("pointcloud/autzen_trim.laz") else { return };
    let cloud = read(&bytes(&path), &PointHints::default()).expect("read");
    let crs = cloud.crs.expect("it states a system");
    assert!(!crs.is_geographic() && (crs.meters_per_unit() - 0.3048).abs() < 1e-5, "{}", crs.name());
    assert!((cloud.meters_per_z - 0.3048).abs() < 1e-5, "{}", cloud.meters_per_z);
}

#[test]
fn text_of_a_grid_gives_the_grid_back() {
    let Some(path) = data("dem/3dem_data.xyz") else { return };
    let cloud = read(&bytes(&path), &PointHints::default()).expect("read");
    let frame =
        CellGrid::within(Rect::around(cloud.points.iter().map(|point| point.truncate())).grown(30.0), 60.0)
            .expect("cells");
    for method in ALL {
        let heights = made(&cloud, &frame, method);
        for point in &cloud.points {
            let column = ((point.x - frame.corner().x) / 60.0) as usize;
            let row = ((frame.corner().y - point.y) / 60.0) as usize;
            let height = heights[row * frame.width() as usize + column];
            assert!((height - point.z).abs() < 1e-9, "{method:?} at {point}: {height}");
        }
    }
}

/// Points of a format as the crate that unpacks them packs them, the first of every three of the ground.
fn packed(format: u8, count: u32) -> Vec<u8> {
    let mut builder = las::Builder::from((1, 4));
    builder.point_format = las::point::Format::new(format).expect("a format");
    builder.point_format.is_compressed = true;
    let header = builder.into_header().expect("a header");
    let mut writer = las::Writer::new(std::io::Cursor::new(Vec::new()), header).expect("a writer");
    for index in 0..count {
        let class = if index % 3 == 0 { 2 } else { 1 };
        let point = las::Point {
            x: f64::from(index % 100),
            y: f64::from(index / 100),
            z: f64::from(index % 17),
            classification: las::point::Classification::new(class).expect("a class"),
            gps_time: (format > 0).then_some(f64::from(index)),
            color: (format == 3 || format == 7).then_some(las::Color::new(1, 2, index as u16)),
            ..las::Point::default()
        };
        writer.write_point(point).expect("a point of its format");
    }
    writer.close().expect("written");
    writer.into_inner().expect("the bytes").into_inner()
}

#[test]
fn chunks_and_layers_of_all_packings_are_unpacked() {
    for format in [0, 1, 3, 6, 7] {
        let count = 120_000;
        let cloud = read(&packed(format, count), &PointHints::default())
            .unwrap_or_else(|error| panic!("{format}: {error}"));
        assert_eq!(cloud.points.len(), 40_000, "format {format}");
        for (index, point) in cloud.points.iter().enumerate().step_by(777) {
            let index = 3 * index as u32;
            let wanted = DVec3::new(f64::from(index % 100), f64::from(index / 100), f64::from(index % 17));
            assert!((*point - wanted).abs().max_element() < 1e-9, "format {format}, point {index}: {point}");
        }
    }
}

#[test]
fn a_forged_length_of_a_layer_is_refused_before_it_is_allocated() {
    let mut bytes = packed(6, 1000);
    let points_at = u32::from_le_bytes([bytes[96], bytes[97], bytes[98], bytes[99]]) as usize;
    // The offset of the table, the first point, how many points, then the layers' lengths.
    let lengths = points_at + 8 + 30 + 4;
    bytes[lengths..lengths + 4].fill(0xff);
    let refused = read(&bytes, &PointHints::default());
    assert!(
        matches!(&refused, Err(PointsError::File(DemErrorKind::Broken { reason, .. })) if reason.contains("layers")),
        "{refused:?}"
    );
}

fn hostile() -> Vec<PathBuf> {
    data("broken/las_pdal").map(|folder| data::files_below(&folder)).unwrap_or_default()
}

#[test]
fn hostile_files_are_read_or_refused_with_a_reason() {
    for path in hostile() {
        match read(&bytes(&path), &PointHints::default()) {
            Ok(cloud) => assert!(!cloud.points.is_empty(), "{}", path.display()),
            Err(error) => assert!(error.to_string().len() > 20, "{}: {error}", path.display()),
        }
    }
}

#[test]
#[ignore = "slow: thousands of forged files"]
fn forged_and_cut_files_end_in_an_error_or_in_points() {
    let Some(folder) = data("pointcloud") else { return };
    for name in ["simple.las", "simple.laz"] {
        let sound = bytes(&folder.join(name));
        for cut in (0..sound.len()).step_by(sound.len() / 60) {
            let error = read(&sound[..cut], &PointHints::default()).expect_err("cut");
            assert!(!error.to_string().is_empty());
        }
        // Bytes of the header, of LASzip's record, of points and of the table of chunks, made large and made zero.
        let ends = [sound.len() - 24..sound.len(), 0..1200.min(sound.len())];
        for at in ends.into_iter().flatten().step_by(3) {
            for value in [0, 0xff] {
                let mut forged = sound.clone();
                forged[at] = value;
                let _ = read(&forged, &PointHints::default());
            }
        }
    }
}

#[test]
fn forged_counts_are_refused_before_anything_is_allocated() {
    let Some(path) = data("pointcloud/simple.laz") else { return };
    let sound = bytes(&path);
    let points_at = u32::from_le_bytes([sound[96], sound[97], sound[98], sound[99]]) as usize;
    let table = i64::from_le_bytes(sound[points_at..points_at + 8].try_into().expect("eight bytes")) as usize;
    let mut chunks = sound.clone();
    chunks[table + 4..table + 8].fill(0xff);
    let mut count = sound.clone();
    count[107..111].copy_from_slice(&60_000_000u32.to_le_bytes());
    let mut outside = sound.clone();
    outside[points_at..points_at + 8].copy_from_slice(&i64::MAX.to_le_bytes());
    for (what, forged) in [("chunks", chunks), ("points", count), ("a table outside", outside)] {
        let refused = read(&forged, &PointHints::default());
        assert!(
            matches!(refused, Err(PointsError::File(DemErrorKind::Broken { .. }))),
            "{what}: {refused:?}"
        );
    }
}

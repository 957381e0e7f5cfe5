//! Panoramas of `scenes/panorama.toml`: the skyline where the elevation model has it, names of the peaks that a line of sight
//! reaches and of no others, and strips that do not show.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::LazyLock;

use glam::{DVec2, Vec3};

use sandtable_draw::list::{DepthLayer, FeatureId};
use sandtable_picture::panorama::HorizonDrop;
use sandtable_render::RenderBackend;
use sandtable_ribbon::drape::check_clearance;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::peaks_in_sight::{ABOVE_M, Peak, peaks};
use sandtable_sheet::picture::{DrawnView, PictureSize, draw_view, render_view};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::{Sight, SightEnd, line_of_sight};
use sandtable_view::panorama::Panorama;

use crate::overlaps::overlaps;

const SIZE: PictureSize = PictureSize { width: 1440, height: 240 };

/// Radius of the Earth over the share of its curvature that refraction leaves, both from the books.
const EFFECTIVE_RADIUS_M: f64 = 6_371_008.8 * 7.0 / 6.0;

fn scene() -> &'static SceneModel {
    static SCENE: LazyLock<SceneModel> = LazyLock::new(|| {
        let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/panorama.toml");
        open_scene(&path, &[], &|_| {}).unwrap_or_else(|failure| panic!("{failure:?}"))
    });
    &SCENE
}

fn drawn(camera: &str) -> (Panorama, DrawnView) {
    let view = scene().view(Some(camera)).expect("a camera of the scene");
    let drawn = draw_view(scene(), view, SIZE, RenderBackend::Cpu, &|_| ()).expect("a picture");
    (drawn.panorama.expect("a panorama"), drawn)
}

/// The ground in steps of 4 m, without any walk along triangles: the greatest rise over distance.
fn stepped_skyline(lattice: &Lattice, eye: DVec2, eye_m: f64, azimuth: f64) -> f64 {
    let toward = DVec2::new(azimuth.sin(), azimuth.cos());
    let rise = |step: u32| {
        let distance_m = f64::from(step) * 4.0;
        let height_m = ground_height(lattice, Interpolation::Planar, eye + toward * distance_m).height_m()?;
        Some((height_m - distance_m * distance_m / (2.0 * EFFECTIVE_RADIUS_M) - eye_m) / distance_m)
    };
    (3..12_000).filter_map(rise).fold(f64::NEG_INFINITY, f64::max)
}

fn eye(panorama: &Panorama) -> (DVec2, f64) {
    (scene().lattice.map_point(panorama.eye), f64::from(scene().scale.elevation_m(panorama.eye.z)))
}

#[test]
fn the_skyline_is_where_the_elevation_model_has_it() {
    for camera in ["circle", "front"] {
        let (panorama, drawn) = drawn(camera);
        let (at, eye_m) = eye(&panorama);
        let (mut worst, mut sum, mut count) = (0.0f64, 0.0, 0.0);
        for column in (0..SIZE.width).step_by(9) {
            let index = |row: u32| (row * SIZE.width + column) as usize;
            let is_ground = |row: &u32| drawn.picture.features[index(*row)] != FeatureId::NONE;
            let row = (0..SIZE.height).find(is_ground).expect("ground in every column");
            let azimuth = f64::from(panorama.azimuth_rad(column as f32 + 0.5));
            let rise = stepped_skyline(&scene().lattice, at, eye_m, azimuth);
            let expected = f64::from(panorama.horizon_row) - rise * f64::from(panorama.pixels_per_radian());
            let off = (f64::from(row) - expected).abs();
            (worst, sum, count) = (worst.max(off), sum + off, count + 1.0);
        }
        // A pixel whose middle is sky is sky, and the ground is drawn within its tolerance of a pixel or so.
        println!("{camera}: mean {} worst {worst} px", sum / count);
        assert!(worst < 2.5 && sum / count < 1.0, "{camera}: mean {} worst {worst}", sum / count);
    }
}

#[test]
fn named_peaks_are_those_that_a_line_of_sight_reaches() {
    let (panorama, _) = drawn("front");
    let (at, eye_m) = eye(&panorama);
    let lattice = &*scene().lattice;
    let ground_m = ground_height(lattice, Interpolation::Planar, at).height_m().expect("ground");
    let observer = SightEnd { at, above_m: eye_m - ground_m };
    let all = peaks(scene(), panorama.eye);
    for Peak { name, world, distance_m, is_in_sight, .. } in &all {
        let target = SightEnd { at: lattice.map_point(*world), above_m: ABOVE_M };
        let sight = line_of_sight(lattice, observer, target, Curvature::default());
        assert_eq!(*is_in_sight, sight == Sight::Clear, "{name:?} {distance_m}");
    }
    let seen = all.iter().filter(|peak| peak.is_in_sight).count();
    assert!(seen > 5 && seen < all.len() - 5, "{seen} of {} prove little", all.len());
}

#[test]
fn a_peak_in_sight_stands_above_all_ground_before_it_and_a_hidden_one_does_not() {
    let (panorama, _) = drawn("front");
    let (at, eye_m) = eye(&panorama);
    let lattice = &*scene().lattice;
    for peak in peaks(scene(), panorama.eye) {
        let target = lattice.map_point(peak.world);
        let (toward, length_m) = ((target - at).normalize(), (target - at).length());
        let rise = |distance_m: f64| {
            let height =
                ground_height(lattice, Interpolation::Planar, at + toward * distance_m).height_m()?;
            Some((height - distance_m * distance_m / (2.0 * EFFECTIVE_RADIUS_M) - eye_m) / distance_m)
        };
        let own = rise(length_m).expect("ground at a peak") + ABOVE_M / length_m;
        let steps =
            (3..).map(|step| f64::from(step) * 2.0).take_while(|distance_m| *distance_m < length_m - 1.0);
        let before = steps.filter_map(rise).fold(f64::NEG_INFINITY, f64::max);
        // Steps miss the sharpest edges by centimeters.
        let margin = 0.1 / length_m;
        if peak.is_in_sight {
            assert!(own > before - margin, "{peak:?}: {own} behind {before}");
        } else {
            assert!(before > own - margin, "{peak:?}: {own} over {before}");
        }
    }
}

#[test]
fn every_pixel_shows_the_ground_of_its_direction() {
    let (panorama, drawn) = drawn("circle");
    let drop = HorizonDrop::new(scene(), &panorama);
    let (mut worst_px, mut count) = (0.0f32, 0);
    for (index, (feature, depth_m)) in drawn.picture.features.iter().zip(&drawn.picture.depth_m).enumerate() {
        if *feature != FeatureId::GROUND || index % 37 != 0 {
            continue;
        }
        let (x, y) = ((index as u32 % SIZE.width) as f32 + 0.5, (index as u32 / SIZE.width) as f32 + 0.5);
        let azimuth = panorama.azimuth_rad(x);
        let rise = (panorama.horizon_row as f32 - y) / panorama.pixels_per_radian();
        let seen = panorama.eye + Vec3::new(azimuth.sin(), azimuth.cos(), rise) * *depth_m;
        let Some(ground) =
            ground_height(&scene().lattice, Interpolation::Planar, scene().lattice.map_point(seen))
                .height_m()
        else {
            continue;
        };
        let drawn_z = drop.lowered(seen.with_z(scene().scale.world_z(ground as f32))).z;
        let off_px = (seen.z - drawn_z).abs() / depth_m * panorama.pixels_per_radian();
        (worst_px, count) = (worst_px.max(off_px), count + 1);
    }
    println!("{count} pixels, worst {worst_px} px");
    assert!(count > 1000 && worst_px < 2.0, "{count} pixels, worst {worst_px} px");
}

#[test]
fn the_borders_of_strips_do_not_show() {
    let (panorama, drawn) = drawn("circle");
    let borders: Vec<u32> =
        panorama.strips().expect("sound").iter().map(|strip| strip.columns.start).collect();
    assert!(borders.len() > 20, "{} strips", borders.len());
    let change = |column: u32| {
        let at = |column: u32, row: u32| drawn.picture.pixels.at(column, row).0.map(i32::from);
        let changes = (0..SIZE.height).map(|row| {
            let (left, right) = (at(column - 1, row), at(column, row));
            (0..3).map(|channel| (left[channel] - right[channel]).abs()).sum::<i32>()
        });
        f64::from(changes.sum::<i32>())
    };
    let mean =
        |columns: &[u32]| columns.iter().map(|&column| change(column)).sum::<f64>() / columns.len() as f64;
    let at_borders = mean(&borders[1..]);
    let others: Vec<u32> = (1..SIZE.width).filter(|column| !borders.contains(column)).collect();
    println!("{at_borders} against {}", mean(&others));
    assert!(at_borders < mean(&others) * 1.1, "{at_borders} against {}", mean(&others));
}

#[test]
fn the_circle_closes() {
    let (panorama, drawn) = drawn("circle");
    assert!((f64::from(panorama.span_rad) - TAU).abs() < 1e-6);
    let skyline = |column: u32| {
        let is_ground =
            |row: &u32| drawn.picture.features[(row * SIZE.width + column) as usize] != FeatureId::NONE;
        i64::from((0..SIZE.height).find(is_ground).expect("ground"))
    };
    assert!((skyline(0) - skyline(SIZE.width - 1)).abs() <= 2);
}

#[test]
fn what_lies_on_the_ground_lies_on_it_in_a_panorama_too() {
    let (panorama, drawn) = drawn("circle");
    let drop = HorizonDrop::new(scene(), &panorama);
    let list = &drawn.drawn.list;
    let draped = list.items.iter().filter(|item| matches!(item.layer, DepthLayer::Draped(_)));
    let mut count = 0;
    for item in draped {
        let mut mesh = list.meshes[item.mesh.0 as usize].clone();
        for vertex in &mut mesh.vertices {
            let at = Vec3::from_array(vertex.position);
            vertex.position[2] += at.z - drop.lowered(at).z;
        }
        let off_m = check_clearance(&mesh, &*drawn.drawn.displayed);
        assert!(off_m < 0.02, "{off_m} m off");
        count += 1;
    }
    assert!(count > 0, "the lakes are drawn");
}

#[test]
fn names_are_placed_and_none_covers_another() {
    for camera in ["circle", "front"] {
        let view = scene().view(Some(camera)).expect("a camera of the scene");
        let size = PictureSize { width: 2400, height: 480 };
        let picture = render_view(scene(), view, size, RenderBackend::Cpu, &|_| {}).expect("a picture");
        let report = &picture.annotations;
        assert_eq!(overlaps(report), []);
        let is_placed = |name: &str| report.placed.iter().any(|text| text.starts_with(name));
        assert!(is_placed("Cumberland Mountain") && report.placed.len() > 8, "{camera}: {:?}", report.placed);
        // Nobody sees the peak under the own feet.
        assert_eq!(is_placed("Cross Mountain"), camera == "front", "{camera}: {:?}", report.placed);
    }
}

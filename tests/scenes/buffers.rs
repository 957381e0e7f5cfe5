//! What a pixel shows: the same place as the height service, the same buffers with and without colors.

use std::path::Path;

use glam::DVec2;
use sandtable_dem::hints::DemOptions;
use sandtable_draw::list::FeatureId;
use sandtable_files::output_files::OutputFiles;
use sandtable_picture::{build_shapes, camera};
use sandtable_query::dem;
use sandtable_raster::answer::Answer;
use sandtable_render::RenderBackend;
use sandtable_render::cpu::render_buffers;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{ParallelView, SceneView, ViewAim};
use sandtable_sheet::picture::{PictureSize, draw_view};
use sandtable_sheet::picture_buffers::{PictureBuffers, pick};
use sandtable_terrain::query::{Interpolation, Surface};

use crate::common::scratch::Scratch;

const SIZE: PictureSize = PictureSize { width: 320, height: 180 };

fn open(name: &str) -> SceneModel {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes").join(name);
    open_scene(&path, &[], &|_| ()).unwrap_or_else(|error| panic!("{name}: {error:?}"))
}

/// All of the ground from straight above.
fn plan(azimuth_rad: f32) -> SceneView {
    let pitch_rad = std::f32::consts::FRAC_PI_2;
    let aim = ParallelView {
        azimuth_rad,
        pitch_rad,
        stretch: 1.0,
        scale: None,
        dpi: 96.0,
        shown: None,
        middle: None,
    };
    SceneView { name: "plan".into(), aim: ViewAim::Parallel(aim), fov_y_rad: 0.5, paper: None }
}

#[test]
fn depths_and_features_are_those_of_the_picture_to_the_bit() {
    for name in ["jacksboro.toml", "forest.toml", "areas.toml", "bridge.toml"] {
        let scene = open(name);
        let view = &scene.cameras[0];
        let drawn = draw_view(&scene, view, SIZE, RenderBackend::Cpu, &|_| ()).expect("drawn");
        let camera = camera(&scene, view, (SIZE.width, SIZE.height)).expect("sound");
        let shapes = render_buffers(&build_shapes(&scene, &camera, &|_| ()).list, &camera).expect("drawn");
        assert!(shapes.features == drawn.picture.features, "{name}");
        assert!(shapes.depth_m == drawn.picture.depth_m, "{name}");
    }
}

#[test]
fn ground_is_picked_where_the_height_service_has_it() {
    let scene = open("jacksboro.toml");
    for view in [&scene.cameras[0], &plan(0.0), &plan(0.7)] {
        let pixels: Vec<[u32; 2]> = (0..SIZE.height)
            .step_by(7)
            .flat_map(|y| (0..SIZE.width).step_by(5).map(move |x| [x, y]))
            .collect();
        let picked = pick(&scene, view, SIZE, &pixels, &|_| ()).expect("drawn");
        let ground = picked.iter().flatten().filter(|place| place.feature == FeatureId::GROUND);
        let camera = camera(&scene, view, (SIZE.width, SIZE.height)).expect("sound");
        let off: Vec<f64> = ground
            .filter_map(|place| {
                let answer = scene.heights.height(Surface::Ground, Interpolation::Planar, place.at);
                let Answer::Height(height_m) = answer else { return None };
                let px_per_m = f64::from(camera.pixels_per_meter(place.distance_m as f32));
                Some((height_m - place.elevation_m).abs() * px_per_m)
            })
            .collect();
        assert!(off.len() > 300, "{}: {} places", view.name, off.len());
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        // The ground is drawn with a tolerance of a pixel.
        assert!(mean < 0.15, "{}: {mean} pixels off in the mean", view.name);
    }
}

#[test]
fn sky_and_places_beside_the_picture_show_nothing() {
    let scene = open("jacksboro.toml");
    let beside = [[SIZE.width, 0], [0, SIZE.height], [u32::MAX, u32::MAX]];
    let picked = pick(&scene, &scene.cameras[0], SIZE, &beside, &|_| ()).expect("drawn");
    assert_eq!(picked, [None, None, None]);
}

#[test]
fn rasters_of_a_plan_lie_on_the_map() {
    let scene = open("lake.toml");
    let scratch = Scratch::new();
    let view = plan(0.4);
    let drawn = draw_view(&scene, &view, SIZE, RenderBackend::Cpu, &|_| ()).expect("drawn");
    let buffers = PictureBuffers { scene: &scene, camera: &drawn.camera, rendering: &drawn.picture };
    let mut files = OutputFiles::default();
    buffers.write(&mut files, scratch.folder()).expect("written");
    files.publish().expect("put in place");
    assert_eq!(scratch.names(), ["depth.tif", "elevation.tif", "feature.tif", "features.csv", "normal.png"]);
    let raster = |name: &str| dem::open(&scratch.at(name), &DemOptions::default()).expect("GeoTIFF").raster;
    let [elevations, features] = ["elevation.tif", "feature.tif"].map(raster);
    assert!(elevations.georeferenced && elevations.crs.as_ref() == Some(&scene.crs));
    let mut seen = 0;
    for y in (0..SIZE.height).step_by(11) {
        for x in (0..SIZE.width).step_by(13) {
            let Some(place) = buffers.place(x, y) else {
                assert!(elevations.at(x, y).is_nan());
                continue;
            };
            seen += 1;
            let center = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let at = elevations.map_from_grid.transform_point2(center);
            assert!(at.distance(place.at) < 0.01, "{x},{y}: {at} and {}", place.at);
            assert!((elevations.at(x, y) - place.elevation_m).abs() < 1e-3);
            assert_eq!(features.at(x, y), f64::from(place.feature.0));
        }
    }
    assert!(seen > 100);
    let table = std::fs::read_to_string(scratch.at("features.csv")).expect("written");
    assert!(table.starts_with("feature,name,pixels,left,top,right,bottom\n1,\"ground\","), "{table}");
    assert!(table.contains("lake "), "{table}");
    // Water is level, and its normals point up.
    let normals = image::open(scratch.at("normal.png")).expect("a picture").into_rgba8();
    let lake = scene.features.iter().position(|feature| feature.kind.noun(1) == "lake").expect("a lake");
    let is_lake = |&index: &usize| drawn.picture.features[index].index() == Some(lake);
    let inner =
        (0..drawn.picture.features.len()).filter(is_lake).map(|index| normals.as_raw()[4 * index + 2]);
    let blue: Vec<u8> = inner.collect();
    assert!(blue.len() > 50);
    let level = blue.iter().filter(|&&blue| blue >= 254).count();
    assert!(level * 10 > blue.len() * 8, "{level} of {}", blue.len());
}

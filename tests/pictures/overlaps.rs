//! No label covers another, or furniture: in every scene of `scenes/` and from 200 random cameras.

use std::fs;
use std::path::PathBuf;

use glam::Vec3;
use sandtable_annotate::report::{AnnotationReport, SheetBox};
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_sheet::picture::{PictureSize, render_view};

/// The pairs of boxes that overlap and are not of one name, by their texts.
pub fn overlaps(report: &AnnotationReport) -> Vec<(String, String)> {
    let name = |one: &SheetBox| one.text.clone().unwrap_or_else(|| "furniture".to_owned());
    let mut found = Vec::new();
    for (index, one) in report.boxes.iter().enumerate() {
        for other in &report.boxes[index + 1..] {
            // Furniture is held apart elsewhere, and the letters of a name may touch.
            let is_same = one.text == other.text;
            if !is_same && one.min.cmplt(other.max).all() && other.min.cmplt(one.max).all() {
                found.push((name(one), name(other)));
            }
        }
    }
    found
}

/// Names along streams and roads, spot heights and contour numbers round Caryville.
fn crowded_scene() -> PathBuf {
    let assets = PathBuf::from(env!("SANDTABLE_ROOT")).join("assets/jacksboro");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("overlaps");
    fs::create_dir_all(&folder).expect("a folder");
    for file in ["valley.asc", "streams.geojson", "roads.geojson", "lake.geojson"] {
        fs::copy(assets.join(file), folder.join(file)).expect("a copy");
    }
    let text = r#"
title = "Crowded"
[terrain]
dem = "valley.asc"
crs = "EPSG:32616"
vertical_exaggeration = 1.5
[style]
spot_heights = 40
[style.contours]
interval = 20
[[label]]
file = "streams.geojson"
text = "name ?? 'Brook'"
kind = "water"
[[label]]
file = "roads.geojson"
text = "name"
kind = "road"
[[label]]
file = "lake.geojson"
text = "name"
kind = "water"
"#;
    let path = folder.join("crowded.toml");
    fs::write(&path, text).expect("a scene");
    path
}

/// Numbers from 0 to 1 that look random and are the same in every run.
fn numbers() -> impl FnMut() -> f32 {
    let mut state = 1u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    }
}

#[test]
#[ignore = "slow: two hundred cameras"]
fn no_label_covers_another_from_two_hundred_cameras() {
    let scene = open_scene(&crowded_scene(), &[], &|_| {}).expect("a sound scene");
    let (low, high) = scene.bounds;
    let mut number = numbers();
    let (mut boxes, mut placed) = (0, 0);
    for camera in 0..200 {
        let mut inside = || low + (high - low) * Vec3::new(number(), number(), 1.0);
        let (eye, target) = (inside(), inside());
        let eye = eye + Vec3::Z * (300.0 + 3000.0 * number());
        let aim = ViewAim::At { eye, target: target.with_z(low.z) };
        let view =
            SceneView { name: format!("random {camera}"), aim, fov_y_rad: 0.4 + 0.6 * number(), paper: None };
        let size = PictureSize { width: 320, height: 180 };
        let Ok(picture) = render_view(&scene, &view, size, RenderBackend::Cpu, &|_| {}) else { continue };
        let found = overlaps(&picture.annotations);
        assert!(found.is_empty(), "{view:?}: {found:?}");
        boxes += picture.annotations.boxes.len();
        placed += picture.annotations.placed.len();
    }
    assert!(boxes > 5000 && placed > 500, "{boxes} boxes of {placed} labels are too few to test anything");
}

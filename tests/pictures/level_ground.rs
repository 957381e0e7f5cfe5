//! Contours on pictures of ground that is level at the height of a line.

use std::fmt::Write;

use sandtable_draw::list::FeatureId;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::open_scene;
use sandtable_sheet::picture::{PictureSize, draw_view};

use crate::common::scratch::Scratch;

/// Posts along each side, 20 m apart.
const POSTS: u32 = 61;

/// Of the bare ground within 1 m of 100 m, the pixels that a print of `height`, in whole meters, leaves black, as `camera`
/// shows them, and all of them.
fn black_on_the_plain(camera: &str, height: impl Fn(f64, f64) -> f64) -> (usize, usize) {
    let mut dem = format!("ncols {POSTS}\nnrows {POSTS}\nxllcenter 500000\nyllcenter 5000000\ncellsize 20\n");
    for index in 0..POSTS * POSTS {
        let (column, row) = (f64::from(index % POSTS), f64::from(index / POSTS));
        let _ = write!(dem, "{} ", height(column, row).round());
    }
    let text = "[terrain]\ndem = \"dem.asc\"\ncrs = \"EPSG:32633\"\ninfer_water = false\n\
                [style]\npreset = \"print\"\n[style.contours]\ninterval = 10\nmajor_every = 2\n\
                [furniture]\nlayout = \"none\"\n\
                [[camera]]\nname = \"plan\"\nprojection = \"plan\"\n\
                [[camera]]\nname = \"low\"\nazimuth = 20\npitch = 25\n\
                [[camera]]\nname = \"oblique\"\nprojection = \"oblique\"\nazimuth = 70\n";
    let folder = Scratch::new();
    folder.write("dem.asc", dem);
    let scene = open_scene(&folder.write("scene.toml", text), &[], &|_| ()).expect("sound");
    let view = scene.view(Some(camera)).expect("a camera of the scene");
    let size = PictureSize { width: 600, height: 480 };
    let drawn = draw_view(&scene, view, size, RenderBackend::Cpu, &|_| ()).expect("a picture");
    let (mut black, mut all) = (0, 0);
    let shown = drawn.picture.features.iter().zip(&drawn.picture.depth_m).enumerate();
    for (index, (_, depth_m)) in shown.filter(|(_, (feature, _))| **feature == FeatureId::GROUND) {
        let (x, y) = (index as u32 % size.width, index as u32 / size.width);
        let pixel = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let height_m = scene.scale.elevation_m(f64::from(drawn.camera.point_at(pixel, *depth_m).z));
        if (height_m - 100.0).abs() < 1.0 {
            all += 1;
            black += usize::from(drawn.picture.pixels.at(x, y).0[0] < 110);
        }
    }
    (black, all)
}

fn cone(x: f64, y: f64, at: [f64; 2]) -> f64 {
    (40.0 - 4.0 * (x - at[0]).hypot(y - at[1])).max(0.0)
}

#[test]
fn a_plain_at_the_height_of_a_line_has_no_line_under_hills() {
    for camera in ["plan", "low", "oblique"] {
        let hills = |x: f64, y: f64| 100.0 + cone(x, y, [18.0, 20.0]) + cone(x, y, [45.0, 40.0]);
        let (black, all) = black_on_the_plain(camera, hills);
        assert!(all > 20_000, "{camera}: {all} pixels");
        assert_eq!(black, 0, "{camera}: black on the plain");
    }
}

#[test]
fn a_plain_has_one_thin_line_round_each_hole() {
    let holes = |x: f64, y: f64| 100.0 - cone(x, y, [18.0, 20.0]) - cone(x, y, [45.0, 40.0]);
    let (black, all) = black_on_the_plain("plan", holes);
    // Two rings of some 20 cells across, of 7 pixels a cell, two pixels wide.
    assert!(all > 20_000 && (600..4000).contains(&black), "{black} of {all} pixels");
}

//! Real places, from their files to a picture, held against what GDAL and PROJ say of them.
//!
//! The pictures are left in the target folder as `tmp/real_*.png`, to be looked at.

mod common;

#[path = "real_data/broken.rs"]
mod broken;
#[path = "real_data/first_picture.rs"]
mod first_picture;
#[path = "real_data/ground_looks.rs"]
mod ground_looks;
#[path = "real_data/legible.rs"]
mod legible;
#[path = "real_data/line_widths.rs"]
mod line_widths;
#[path = "real_data/new_choices.rs"]
mod new_choices;
#[path = "real_data/oracle.rs"]
mod oracle;
#[path = "real_data/places.rs"]
mod places;
#[path = "real_data/swellendam.rs"]
mod swellendam;
#[path = "real_data/vectors.rs"]
mod vectors;
#[path = "real_data/whole.rs"]
mod whole;

use std::path::{Path, PathBuf};

use glam::DVec2;
use sandtable_annotate::paint::annotate;
use sandtable_description::parse::parse_bytes;
use sandtable_draw::list::{DepthLayer, FeatureId};
use sandtable_new::{self as new_scene, NewSceneOptions};
use sandtable_picture::{ViewDraw, build_draw_list, camera};
use sandtable_render::cpu;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::labels::{AnnotatedGround, annotations};
use sandtable_terrain::triangle_surface::TriangleSurface;

use common::data::data;
use common::scratch::Scratch;

/// The scene that `text` describes, written to `folder` and reading what lies there and under `allowed`.
fn scene(folder: &Scratch, text: &str, allowed: &[PathBuf]) -> Result<SceneModel, String> {
    let path = folder.write("scenes/scene.toml", text);
    let document =
        parse_bytes(&path.to_string_lossy(), text.as_bytes()).map_err(|report| report.to_string())?;
    let assets = Assets::new(&path, allowed).map_err(|error| error.to_string())?;
    build(&document, &assets, &|_| ()).map_err(|diagnostic| diagnostic.to_string())
}

/// What `new` writes to `folder` for elevation and vectors among the data of scenes, and the scene of it; `None` without
/// the data.
fn first_scene(folder: &Scratch, dem: &str, vectors: &[&str]) -> Option<(String, SceneModel)> {
    let dem = data(&format!("scenes/{dem}"))?;
    let vectors: Vec<PathBuf> = vectors.iter().filter_map(|file| data(&format!("scenes/{file}"))).collect();
    let allowed = vec![dem.parent().expect("in a folder").to_path_buf()];
    let options =
        NewSceneOptions { folder: folder.at("scene"), dem: vec![dem], vectors, ..NewSceneOptions::default() };
    let written = new_scene::write(&options, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let text = std::fs::read_to_string(&written.path).expect("it was written");
    let scene = open_scene(&written.path, &allowed, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    Some((text, scene))
}

/// What one picture came of.
struct Pictured {
    shot: ViewDraw,
    /// How many pixels show each kind of feature.
    pixels: Vec<(FeatureKind, usize)>,
    /// How many pixels show ground.
    ground_pixels: usize,
}

/// Renders the scene's camera and leaves the annotated picture as `tmp/real_<name>.png` in the target folder.
fn picture(scene: &SceneModel, view: &str, name: &str, size: (u32, u32)) -> Pictured {
    let view = scene.view(Some(view)).expect("a camera of the scene");
    let camera = camera(scene, view, size).expect("a sound camera");
    let shot = build_draw_list(scene, &camera, &|_| ());
    shot.list.check().expect("a sound draw list");
    let mut picture =
        cpu::render(&shot.list, &camera, &cpu::RenderQuality::default()).expect("a sound draw list");
    let showing =
        |wanted: &dyn Fn(u32) -> bool| picture.features.iter().filter(|feature| wanted(feature.0)).count();
    let of_kind = |kind| {
        let is = |id: u32| FeatureId(id).index().is_some_and(|index| scene.features[index].kind == kind);
        (kind, showing(&is))
    };
    let pixels = scene.census().into_iter().map(|(kind, _)| of_kind(kind)).collect();
    let ground_pixels = showing(&|id| id == FeatureId::GROUND.0);
    let shown =
        AnnotatedGround { graphics: &shot.graphic_texts, nested: &shot.nested, list: Some(&shot.list) };
    let annotations = annotations(scene, &camera, &picture, None, &shown);
    annotate(&mut picture.pixels, &annotations);
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("real_{name}.png"));
    image::save_buffer(&path, picture.pixels.bytes(), size.0, size.1, image::ColorType::Rgba8)
        .expect("the target folder is writable");
    Pictured { shot, pixels, ground_pixels }
}

/// The largest distance in meters of a draped corner from the displayed ground, and how many were looked at.
///
/// # Panics
/// Where a corner is off by more than the rounding of its coordinates: they are 32-bit floats, up to 4 mm off
/// where the model reaches past 65 km, and on steep ground X and Y that are off mean height that is off.
fn clearance_of_draped(shot: &ViewDraw) -> (f64, usize) {
    let ground = &*shot.displayed;
    let draped = shot.list.items.iter().filter(|item| matches!(item.layer, DepthLayer::Draped(_)));
    let corners = draped.flat_map(|item| &shot.list.meshes[item.mesh.0 as usize].vertices);
    let (mut worst, mut count) = (0.0, 0);
    for corner in corners {
        let [x, y, z] = corner.position;
        let at = DVec2::new(f64::from(x), f64::from(y));
        let rounding = |number: f32| f64::from(number.abs().next_up() - number.abs());
        let aside = f64::max(rounding(x), rounding(y));
        let Some(here) = ground.displayed_z(at) else { continue };
        let across = DVec2::new(1.0, -1.0);
        let around =
            [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y, DVec2::ONE, -DVec2::ONE, across, -across];
        let reach = around.iter().filter_map(|&way| ground.displayed_z(at + way * 2.0 * aside));
        // Beside 0 m, where heights cancel, their sum is less exact than its own digits: a nanometer is as good as none.
        let allowed = reach.map(|z| (z - here).abs()).fold(f64::max(2.0 * rounding(z), 1e-9), f64::max);
        let off = (f64::from(z) - here).abs();
        assert!(off <= allowed, "{off} m off the ground at {at}, where rounding explains {allowed} m");
        (worst, count) = (f64::max(worst, off), count + 1);
    }
    (worst, count)
}

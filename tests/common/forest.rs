//! A forest over rolling ground: as many firs as wanted, strewn evenly, the same every time.

use std::fs;
use std::path::Path;

use glam::{Vec2, Vec3};
use sandtable_description::parse::parse_bytes;
use sandtable_description::words::Clamp;
use sandtable_picture as picture;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::placed_model::{GroundFit, Placement};
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

use super::scratch::Scratch;

/// Posts along the side of the ground, 10 m apart.
const POSTS: u32 = 257;

/// Meters along the side of the ground.
pub const SIDE_M: f32 = (POSTS - 1) as f32 * 10.0;

/// The scene with `count` placements of `models`, in turn, files of the project's own.
pub fn forest(count: usize, models: &[&str]) -> SceneModel {
    let scratch = Scratch::new();
    scratch.write("hills.asc", hills());
    let assets = Path::new(env!("SANDTABLE_ROOT")).join("assets/models");
    for entry in fs::read_dir(assets).expect("the assets are there") {
        let path = entry.expect("it can be read").path();
        let name = path.file_name().expect("a file").to_string_lossy().into_owned();
        scratch.write(&name, fs::read(&path).expect("it can be read"));
    }
    let tables: String =
        models.iter().map(|file| format!("[[model]]\nfile = \"{file}\"\nat = [100, 100]\n")).collect();
    let text = format!("[terrain]\ndem = \"hills.asc\"\ncrs = \"EPSG:32633\"\n{tables}");
    let document = parse_bytes("scene.toml", text.as_bytes()).expect("sound");
    let assets = Assets::new(&scratch.at("scene.toml"), &[]).expect("the folder is there");
    let mut scene = build(&document, &assets, &|_| ()).expect("sound");
    scene.placements = placements(count, models.len());
    scene
}

fn hills() -> String {
    let height = |index: u32| {
        let (x, y) = (f64::from(index % POSTS) * 0.05, f64::from(index / POSTS) * 0.05);
        300.0 + 40.0 * libm::sin(x) * libm::cos(y * 0.8) + 15.0 * libm::sin(x * 2.7 + y * 1.9)
    };
    let heights: Vec<String> = (0..POSTS * POSTS).map(|index| format!("{:.2}", height(index))).collect();
    let header = format!("ncols {POSTS}\nnrows {POSTS}\nxllcorner 0\nyllcorner 0\ncellsize 10\n");
    header + &heights.join(" ")
}

/// Places by the additive recurrence of the plastic number (Roberts, 2018), which fills the square evenly at every
/// count; headings and sizes by the same.
fn placements(count: usize, models: usize) -> Vec<Placement> {
    let share = |index: usize, ratio: f64| (0.5 + index as f64 * ratio).fract() as f32;
    (0..count)
        .map(|index| {
            let plan =
                Vec2::new(share(index, 0.754_877_666_246_692_7), share(index, 0.569_840_290_998_053_3));
            Placement {
                standing: GroundFit::default(),
                model: index % models,
                at: plan * (SIDE_M - 20.0) + 10.0,
                clamp: Clamp::Ground,
                height: 0.0,
                heading_rad: share(index, 0.618_033_988_749_895) * std::f32::consts::TAU,
                scale: 0.7 + 0.8 * share(index, 0.414_213_562_373_095),
                feature: sandtable_draw::list::FeatureId(2 + index as u32),
            }
        })
        .collect()
}

/// A picture over the whole forest from above its southern edge.
pub fn overlook(scene: &SceneModel, size: (u32, u32)) -> Camera {
    seen_from(
        scene,
        Vec3::new(SIDE_M * 0.5, -60.0, 520.0),
        Vec3::new(SIDE_M * 0.5, SIDE_M * 0.4, 280.0),
        size,
    )
}

/// A picture from anywhere.
pub fn seen_from(scene: &SceneModel, eye: Vec3, target: Vec3, size: (u32, u32)) -> Camera {
    let view = sandtable_scene::scene_view::SceneView {
        name: String::new(),
        aim: sandtable_scene::scene_view::ViewAim::At { eye, target },
        fov_y_rad: 0.7,
        paper: None,
    };
    picture::camera(scene, &view, size).expect("sound")
}

//! Scenes of every kind of feature, in any shape, over a small ground: built, and drawn.

use std::fmt::Write;

use glam::DVec2;
use sandtable_picture::{build_draw_list, camera};
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::build_scene_text;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::{PictureSize, annotate_view, draw_view};

use super::byte_source::ByteSource;
use super::hill;

/// The south-west corner of the hill, and its sides in meters.
const CORNER: DVec2 = DVec2::new(500_000.0, 4_000_000.0);
pub const SIDE_M: f64 = 480.0;

/// The most features of a scene, and points of a feature: enough for every pair to meet.
const MOST_FEATURES: usize = 6;
const MOST_POINTS: usize = 14;

/// A key that takes a number, with its usual range.
type NumberKey = (&'static str, f64, f64);

/// A key that takes a word.
type WordKey = (&'static str, &'static [&'static str]);

/// Tables of features with their keys.
const TABLES: &[(&str, &[NumberKey], &[WordKey])] = &[
    (
        "road",
        &[
            ("width", 0.5, 20.0),
            ("shoulder", 0.0, 5.0),
            ("max_grade", 0.5, 30.0),
            ("max_fill", 0.1, 20.0),
            ("max_cut", 0.1, 20.0),
            ("level", -2.0, 2.0),
        ],
        &[
            ("surface", &["asphalt", "gravel", "track"]),
            ("profile", &["conform", "conform", "drape"]),
            ("join", &["miter", "bevel", "round"]),
        ],
    ),
    (
        "river",
        &[("width", 0.5, 40.0), ("bank", 0.0, 20.0), ("max_cut", 0.1, 20.0)],
        &[("water", &["falls", "drape"])],
    ),
    ("lake", &[("level", 60.0, 200.0)], &[("level_rule", &["lowest", "mean", "median"])]),
    (
        "area",
        &[("border_width", 0.5, 10.0)],
        &[("cover", &["forest", "field", "sand", "rock", "restricted"]), ("border", &["solid", "dashed"])],
    ),
    (
        "building",
        &[("height", 1.0, 60.0), ("roof_height", 0.0, 20.0)],
        &[
            ("roof", &["flat", "gabled", "hipped", "pyramidal"]),
            ("base", &["lowest", "mean", "highest", "pad"]),
        ],
    ),
    (
        "fence",
        &[("height", 0.2, 8.0), ("spacing", 0.5, 30.0)],
        &[("kind", &["fence", "wall", "hedge", "power-line", "trench", "obstacles", "boundary"])],
    ),
    ("bridge", &[("width", 1.0, 20.0), ("pier_spacing", 1.0, 60.0)], &[]),
    (
        "earthwork",
        &[
            ("radius", 1.0, 60.0),
            ("depth", 0.1, 20.0),
            ("width", 0.5, 20.0),
            ("height", 0.2, 20.0),
            ("level", 60.0, 200.0),
        ],
        &[("kind", &["crater", "trench", "track", "level", "raise"])],
    ),
    ("label", &[], &[("kind", &["place", "peak", "water"])]),
    ("scatter", &[("density", 0.1, 400.0), ("spacing", 0.0, 40.0)], &[]),
    ("graphic", &[("width", 1.0, 60.0)], &[("kind", &["phase_line", "axis_main_attack", "axis_feint"])]),
];

/// A scene file of what `bytes` choose.
pub fn scene_file(bytes: &mut ByteSource<'_>) -> String {
    let mut text = "crs = \"EPSG:32616\"\n[terrain]\ndem = \"hill.asc\"\n".to_owned();
    if bytes.byte() > 192 {
        let _ = writeln!(text, "vertical_exaggeration = {:?}", bytes.number(0.1, 5.0));
    }
    if bytes.byte() > 192 {
        let _ = writeln!(text, "tolerance_px = {:?}", bytes.number(0.1, 20.0));
    }
    for _ in 0..=bytes.below(MOST_FEATURES) {
        feature(bytes, &mut text);
    }
    let [from, to] = [point(bytes), point(bytes)];
    let _ = writeln!(
        text,
        "[[camera]]\nname = \"a\"\neye = [{:?}, {:?}]\neye_height = {:?}\nlook_at = [{:?}, {:?}]",
        from.0,
        from.1,
        bytes.number(1.0, 300.0),
        to.0,
        to.1
    );
    text
}

fn feature(bytes: &mut ByteSource<'_>, text: &mut String) {
    let (table, numbers, words) = bytes.pick(TABLES);
    let _ = writeln!(text, "[[{table}]]\nname = \"{table}\"");
    let points: Vec<String> = (0..=bytes.below(MOST_POINTS))
        .map(|_| point(bytes))
        .map(|(x, y)| format!("[{x:?}, {y:?}]"))
        .collect();
    match *table {
        "label" => {
            let _ = writeln!(text, "text = \"A name\"\nat = {}", points[0]);
        }
        _ => {
            let _ = writeln!(text, "points = [{}]", points.join(", "));
        }
    }
    if *table == "scatter" {
        text.push_str("of = \"conifer\"\n");
    }
    for (key, low, high) in *numbers {
        if bytes.byte() > 96 {
            let _ = writeln!(text, "{key} = {:?}", bytes.number(*low, *high));
        }
    }
    for (key, choices) in *words {
        if bytes.byte() > 64 {
            let _ = writeln!(text, "{key} = \"{}\"", bytes.pick(choices));
        }
    }
}

/// Mostly on the ground; some on a grid, so that features meet and repeat points exactly.
fn point(bytes: &mut ByteSource<'_>) -> (f64, f64) {
    let (low, high) = (-0.2 * SIDE_M, 1.2 * SIDE_M);
    let at = match bytes.byte() {
        0..8 => DVec2::new(bytes.number(low, high), bytes.number(low, high)),
        8..120 => DVec2::new(bytes.below(17) as f64, bytes.below(17) as f64) * 30.0,
        _ => DVec2::new(bytes.between(low, high), bytes.between(low, high)),
    };
    (CORNER + at).into()
}

/// The scene that `bytes` choose; `None` where it is refused.
pub fn built(bytes: &mut ByteSource<'_>) -> Option<SceneModel> {
    let text = scene_file(bytes);
    match build_scene_text(&hill().join("scene.toml"), &text, &[], &|_| {}) {
        Ok(scene) => Some(scene),
        Err(error) => {
            assert!(!error.to_string().is_empty(), "an error that says nothing");
            None
        }
    }
}

/// Builds a scene; its draw list is sound.
pub fn listed(bytes: &[u8]) {
    let Some(scene) = built(&mut ByteSource::new(bytes)) else { return };
    for view in &scene.cameras {
        let Ok(camera) = camera(&scene, view, (64, 48)) else { continue };
        let drawn = build_draw_list(&scene, &camera, &|_| {});
        if let Err(error) = drawn.list.check() {
            panic!("{error}");
        }
    }
}

/// Builds a scene and draws it with its labels.
pub fn drawn(bytes: &[u8]) {
    let Some(scene) = built(&mut ByteSource::new(bytes)) else { return };
    let size = PictureSize { width: 64, height: 48 };
    for view in &scene.cameras {
        if let Ok(drawn) = draw_view(&scene, view, size, RenderBackend::Cpu, &|_| {}) {
            drop(annotate_view(&scene, drawn, &|_| {}));
        }
    }
}

//! A new scene file, with the comments that somebody needs who changes it.

use std::fmt::Write;

use glam::DVec2;
use serde_json::Value;

use crate::annotate::nice::NiceNumber;
use crate::app::new::survey::{Chosen, RULES, SurveyedLayer, TableMatch};

/// What is known of the ground; zero and nothing where it is not yet.
#[derive(Default)]
pub(super) struct GroundDraft {
    pub title: String,
    /// As the scene file names them.
    pub dem: Vec<String>,
    /// What the user stated.
    pub crs: Option<String>,
    /// The scene's.
    pub crs_name: String,
    /// The longer side.
    pub size_m: f64,
    /// From the lowest to the highest.
    pub relief_m: f64,
    /// 0 for none stated.
    pub exaggeration: f64,
    pub contours_m: Option<f64>,
    pub camera: Option<CameraDraft>,
}

/// A camera as its table says it.
pub(super) struct CameraDraft {
    pub name: String,
    pub eye: DVec2,
    pub eye_elevation_m: f64,
    pub look_at: DVec2,
    pub look_at_height_m: f64,
    pub field_of_view_deg: f64,
}

/// A vector file and what it holds.
pub(super) struct Vectors {
    /// As the scene file names it.
    pub file: String,
    pub layers: Vec<SurveyedLayer>,
}

/// The extent up to which things are drawn as wide as they are: on a picture a thousand pixels wide a pixel is then
/// four meters, and a street of five just shows.
const TRUE_TO_SCALE_M: f64 = 4000.0;

/// The text of the scene file.
pub(super) fn scene(ground: &GroundDraft, vectors: &[Vectors]) -> String {
    let mut out = head(ground);
    out.push_str(&terrain(ground));
    out.push_str(&style(ground));
    let factor =
        NiceNumber::at_most(ground.size_m / TRUE_TO_SCALE_M).map_or(1.0, |nice| nice.value().max(1.0));
    if factor > 1.0 && vectors.iter().any(|file| !file.layers.is_empty()) {
        let _ = writeln!(
            out,
            "\n# The ground is {:.0} km wide: roads and rivers are drawn {factor} times as wide as they are, so that they\n\
             # show. For a view from near by, divide the widths by {factor}.",
            ground.size_m / 1000.0
        );
    }
    let layers = || vectors.iter().flat_map(|file| file.layers.iter().map(move |layer| (file, layer)));
    for rule in &RULES {
        for (file, layer) in layers() {
            let of_this_rule = |found: &&TableMatch| found.rule.what == rule.what;
            layer
                .found
                .iter()
                .filter(of_this_rule)
                .for_each(|found| table(&mut out, file, layer, found, factor));
        }
    }
    layers().for_each(|(file, layer)| rest(&mut out, file, layer));
    out.push_str(&camera(ground));
    out
}

fn head(ground: &GroundDraft) -> String {
    let (title, crs) = (quoted(&ground.title), &ground.crs_name);
    format!(
        "# Lengths and heights are meters, angles degrees, file names relative to this file.\n\
         # Every key: `sandtable schema > schema.json`, which editors use once the first line here says\n\
         # `#:schema schema.json`. Inline points are in the scene's coordinate system, {crs},\n\
         # unless `points_crs` or a table's `crs` says otherwise.\n\n\
         title = {title}\n"
    )
}

/// The table of the terrain; alone it is a scene.
pub(super) fn terrain(ground: &GroundDraft) -> String {
    let mut out = "\n[terrain]\n".to_owned();
    let dem = match &ground.dem[..] {
        [only] => quoted(only),
        several => format!("[{}]", several.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", ")),
    };
    let _ = writeln!(out, "dem = {dem}");
    if let Some(crs) = &ground.crs {
        let _ = writeln!(out, "crs = {}", quoted(crs));
    }
    if ground.exaggeration > 0.0 {
        let _ = writeln!(out, "# 1 is true to scale; flat country shows its forms at 2 or 3.");
        let _ = writeln!(out, "vertical_exaggeration = {}", ground.exaggeration);
    }
    out
}

fn style(ground: &GroundDraft) -> String {
    let mut out = "\n[style]\n# Or \"desert\", \"gray\", or stops of your own: [[0, \"#7f9f6b\"], [400, \"#c9cf97\"]].\n\
                   ramp = \"atlas\"\n"
        .to_owned();
    if let Some(interval) = ground.contours_m {
        let relief = ground.relief_m;
        let _ = writeln!(out, "\n# The ground rises by {relief:.0} m.");
        let _ = writeln!(out, "[style.contours]\ninterval = {interval}\nmajor_every = 5");
    }
    out.push_str("\n[style.light]\nazimuth = 315\naltitude = 45\n");
    out
}

fn table(out: &mut String, file: &Vectors, layer: &SurveyedLayer, found: &TableMatch, factor: f64) {
    let (rule, count) = (found.rule, found.count);
    let _ = writeln!(out, "\n# {} ({count}).\n[[{}]]\nfile = {}", rule.what, rule.table, quoted(&file.file));
    if let Some(layer) = &layer.layer {
        let _ = writeln!(out, "layer = {}", quoted(layer));
    }
    if found.chosen == Chosen::ByRule {
        let _ = writeln!(out, "where = {}", quoted(rule.condition));
    }
    if let Some(width_m) = rule.width.and_then(|width| width.parse::<f64>().ok()) {
        let _ = writeln!(out, "width = {}", width_m * factor);
    }
    for key in rule.keys {
        let _ = writeln!(out, "{key}");
    }
}

/// What could be made of the rest.
fn rest(out: &mut String, file: &Vectors, layer: &SurveyedLayer) {
    for (kind, count) in &layer.rest {
        let _ = writeln!(out, "\n# In no table of this file ({count} {kind}); to draw them:");
        let instances = *kind == "points";
        let head = match *kind {
            "lines" => "# [[fence]]\n# kind = \"boundary\"",
            "polygons" => "# [[area]]\n# cover = \"meadow\"",
            _ => "# [[model]]\n# file = \"model.glb\"\n# [model.instances]",
        };
        let _ = writeln!(out, "{head}\n# file = {}", quoted(&file.file));
        if let Some(layer) = &layer.layer {
            let _ = writeln!(out, "# layer = {}", quoted(layer));
        }
        let _ =
            writeln!(out, "# where = \"{}\"", if instances { "natural = 'tree'" } else { "name = '...'" });
    }
}

fn camera(ground: &GroundDraft) -> String {
    let Some(camera) = &ground.camera else {
        return "\n# Without a [[camera]] one is made that sees the whole ground.\n".into();
    };
    let decimals = if ground.size_m < 200.0 { 2 } else { 0 };
    let point = |at: DVec2| format!("[{:.decimals$}, {:.decimals$}]", at.x, at.y);
    format!(
        "\n# The whole ground from the south. `eye_height` in place of `eye_elevation` counts from the ground.\n\
         [[camera]]\nname = {}\neye = {}\neye_elevation = {:.decimals$}\nlook_at = {}\nlook_at_height = {:.decimals$}\n\
         field_of_view = {:.0}\n",
        quoted(&camera.name),
        point(camera.eye),
        camera.eye_elevation_m,
        point(camera.look_at),
        camera.look_at_height_m,
        camera.field_of_view_deg
    )
}

/// A text in double quotes; what JSON escapes, TOML reads.
fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

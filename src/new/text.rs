//! The text of a new scene file, with the comments that its editor needs.

use std::fmt::Write;
use std::ptr;

use serde_json::Value;

use crate::buildings;
use crate::cameras::CameraDraft;
use crate::crop::ExtentDraft;
use crate::overlays::{self, OverlayDraft};
use crate::rules::{self, RULES};
use crate::survey::{FeatureSelection, LeftFeatures, SurveyedLayer, TableMatch};
use crate::title;
use sandtable_base::limits::SCENE_GRAPHICS;
use sandtable_geom::rect::Rect;
use sandtable_raster::undeclared::UndeclaredNodata;
use sandtable_scene::class_raster::legend::ClassLegend;

/// The properties of the scene; zero and empty before they are determined.
#[derive(Default)]
pub(super) struct SceneDraft {
    pub title: String,
    /// The elevation files as the scene file names them.
    pub dem: Vec<String>,
    /// Values that may mean no data without being declared so.
    pub nodata: Vec<UndeclaredNodata>,
    /// The coordinate system that the user states.
    pub crs: Option<String>,
    /// The name of the scene's coordinate system.
    pub crs_name: String,
    /// From the lowest to the highest post.
    pub relief_m: f64,
    /// 0 where none is stated.
    pub exaggeration: f64,
    /// Between measured posts.
    pub post_m: f64,
    pub contours_m: Option<f64>,
    pub cameras: Vec<CameraDraft>,
    /// Whether a coast runs through ground that holds the depths of the sea.
    pub has_sea_bed: bool,
    /// The part of the elevation that the scene is made of, in the scene's system; `None` for all of it.
    pub extent: Option<ExtentDraft>,
}

/// A vector file and its layers.
pub(super) struct VectorDraft {
    /// The file as the scene file names it.
    pub file: String,
    pub layers: Vec<SurveyedLayer>,
    /// The classification of a raster of land cover, which has no layers.
    pub land_cover: Option<ClassLegend>,
}

/// A file and one of its layers.
#[derive(Clone, Copy)]
struct LayerSource<'a> {
    file: &'a str,
    layer: &'a SurveyedLayer,
}

/// The text of the scene file.
pub(super) fn scene(draft: &SceneDraft, vectors: &[VectorDraft], overlays: &[OverlayDraft]) -> String {
    let mut out = head(draft);
    out.push_str(&terrain(draft));
    out.push_str(&style(draft));
    let sources: Vec<LayerSource<'_>> = vectors
        .iter()
        .flat_map(|VectorDraft { file, layers, .. }| {
            layers.iter().map(move |layer| LayerSource { file, layer })
        })
        .collect();
    for VectorDraft { file, land_cover, .. } in vectors {
        if let Some(legend) = land_cover {
            let (file, name) = (quoted(file), legend.name());
            let _ = writeln!(
                out,
                "\n# Land cover by {name}. Its water has no cover: lakes, rivers and coasts draw it.\n[[area]]\nfile = {file}\n\
                 where = \"cover\"\ncover = \"(cover)\""
            );
        }
    }
    for rule in RULES {
        for &source in &sources {
            for found in source.layer.matches.iter().filter(|found| ptr::eq(found.rule, rule)) {
                table(&mut out, source, found, draft.post_m);
            }
        }
    }
    if sources.iter().any(|source| is_drawn_plain(source.layer)) {
        out.push_str("\n# A legend of all that is drawn.\n[furniture]\nclasses = true\n");
    }
    for &source in &sources {
        if is_drawn_plain(source.layer) {
            neutral(&mut out, source);
        } else {
            rest(&mut out, source);
        }
    }
    out.push_str(&overlays::text(overlays));
    out.push_str(
        "\n# A camera without `eye` and `look_at` is fitted to the ground that it shows. `eye`, `eye_height` and `look_at` put\n\
         # it in a place of your own.\n",
    );
    draft.cameras.iter().for_each(|draft| camera(&mut out, draft));
    out
}

fn head(draft: &SceneDraft) -> String {
    let (title, crs) = (quoted(&draft.title), &draft.crs_name);
    format!(
        "# Lengths and heights are meters, angles degrees, file names relative to this file.\n\
         # Every key: `sandtable schema > schema.json`, which editors use once the first line here says\n\
         # `#:schema schema.json`. Inline points are in the scene's coordinate system, {crs},\n\
         # unless `points_crs` or a table's `crs` says otherwise.\n\n\
         title = {title}\n"
    )
}

/// The table of the terrain, which alone makes a scene.
pub(super) fn terrain(draft: &SceneDraft) -> String {
    let mut out = "\n[terrain]\n".to_owned();
    let dem = match &draft.dem[..] {
        [only] => quoted(only),
        several => format!("[{}]", several.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", ")),
    };
    let _ = writeln!(out, "dem = {dem}");
    if let Some(crs) = &draft.crs {
        let _ = writeln!(out, "crs = {}", quoted(crs));
    }
    for (index, found) in draft.nodata.iter().enumerate() {
        let (evidence, value) = (&found.evidence, found.written());
        let (advice, off) = if index == 0 {
            ("That is taken for missing data; remove the next line if it is ground", "")
        } else {
            ("If that means no data:", "# ")
        };
        let _ = writeln!(out, "# In the file {evidence}. {advice}\n{off}nodata = {value}");
    }
    if let Some(ExtentDraft { rect, holds }) = &draft.extent {
        let corners = corners(rect);
        let _ = writeln!(out, "# {holds}; remove it to see the whole elevation model.\nextent = {corners}");
    }
    if draft.has_sea_bed {
        let _ = writeln!(
            out,
            "# A coastline runs through the ground, which reaches below 0 m at its border; remove the next line where that \
             is dry.\nsea_level = 0"
        );
    }
    if draft.exaggeration > 0.0 {
        let _ = writeln!(out, "# 1 is true to scale; flat country shows its forms at 2 or 3.");
        let _ = writeln!(out, "vertical_exaggeration = {}", draft.exaggeration);
    }
    out
}

fn style(draft: &SceneDraft) -> String {
    let mut out = "\n[style]\n# Tints of the place's climate. Or \"desert\", \"gray\", or stops of your own: [[0, \"#7f9f6b\"], [400, \"#c9cf97\"]].\n\
                   ramp = \"atlas\"\n\
                   # Woods, fields, meadow, scree, rock and snow, inferred from climate, height and slope; false shows the tints alone.\n\
                   land_cover = true\n"
        .to_owned();
    if let Some(interval) = draft.contours_m {
        let _ = writeln!(out, "\n# The ground rises by {:.0} m.", draft.relief_m);
        let _ = writeln!(out, "[style.contours]\ninterval = {interval}\nmajor_every = 5");
    }
    out.push_str(
        "\n# The light comes from the left of each picture; `azimuth` and `altitude` put it elsewhere, and a date and\n\
         # time puts it where the sun stood then.\n[style.light]\n# time = \"2026-06-21T09:30:00Z\"\n",
    );
    out
}

fn table(out: &mut String, source: LayerSource<'_>, found: &TableMatch, post_m: f64) {
    let (rule, count) = (found.rule, found.count);
    let stated = |expression: &str| rules::of_layer(expression, source.layer.has_fclass);
    let _ = writeln!(out, "\n# {} ({count}).\n[[{}]]\nfile = {}", rule.what, rule.table, quoted(source.file));
    if let Some(name) = &source.layer.name {
        let _ = writeln!(out, "layer = {}", quoted(name));
    }
    if found.selection == FeatureSelection::ByCondition {
        let _ = writeln!(out, "where = {}", quoted(&stated(rule.condition)));
    }
    if let Some(label) = &rule.label {
        let _ = writeln!(out, "text = {}", quoted(&stated(label.text)));
        let _ = writeln!(out, "rank = {}\nmost = {}", quoted(&stated(label.rank)), label.most);
    }
    for key in rule.keys {
        let _ = writeln!(out, "{}", stated(key));
    }
    if rule.table == "building" {
        out.push_str(&buildings::keys(rule, post_m, source.layer.building_height_m));
    }
}

/// Whether a layer of no known schema is drawn by its shapes: those off the ground, and too many, stay a comment.
fn is_drawn_plain(layer: &SurveyedLayer) -> bool {
    let count = layer.rest.iter().map(|rest| rest.count).sum::<usize>();
    layer.is_on_ground && layer.matches.is_empty() && (1..=SCENE_GRAPHICS.count() / 2).contains(&count)
}

/// Tables for a layer of no known schema: names of its points, else its shapes in a neutral style.
fn neutral(out: &mut String, source: LayerSource<'_>) {
    /// The most names of points that are written.
    const MOST_NAMES: u32 = 30;
    let LayerSource { file, layer } = source;
    let counts: Vec<String> = layer.rest.iter().map(|rest| format!("{} {}", rest.count, rest.kind)).collect();
    let name = title::of_layer(layer.name.as_deref(), file);
    let _ = writeln!(out, "\n# {name}: of no known kind ({}).", counts.join(", "));
    let layer_key =
        layer.name.as_ref().map_or_else(String::new, |name| format!("layer = {}\n", quoted(name)));
    let file_key = format!("file = {}\n{layer_key}", quoted(file));
    match &layer.rest[..] {
        [points] if points.kind == "points" && name.to_lowercase().contains("tree") => {
            let _ = write!(out, "[[model]]\nfile = \"broadleaf\"\n[model.instances]\n{file_key}");
        }
        [LeftFeatures { kind: "points", name_property: Some(property), .. }] => {
            let text = if is_plain(property) { property.clone() } else { format!("`{property}`") };
            let _ = write!(out, "[[label]]\n{file_key}text = {}\nmost = {MOST_NAMES}\n", quoted(&text));
        }
        _ => {
            let legend = layer.only_area.as_ref().map_or(name.as_str(), |area| area.name.as_str());
            let _ = write!(out, "[[overlay]]\nname = {}\n{file_key}", quoted(legend));
        }
    }
    layer.rest.iter().for_each(|left| properties(out, left));
}

/// Tables, commented out, for the features that no table takes, with their properties.
fn rest(out: &mut String, source: LayerSource<'_>) {
    for left in &source.layer.rest {
        let LeftFeatures { kind, count, examples, .. } = left;
        let named = examples.iter().map(|(name, _)| name).find(|name| name.eq_ignore_ascii_case("name"));
        let head = match (*kind, named) {
            ("lines", _) => "# [[fence]]\n# kind = \"boundary\"".to_owned(),
            ("polygons", _) => "# [[area]]\n# cover = \"meadow\"".to_owned(),
            (_, Some(name)) => format!("# [[label]]\n# text = {}", quoted(name)),
            (_, None) => "# [[model]]\n# file = \"conifer\"\n# [model.instances]".to_owned(),
        };
        let _ = writeln!(out, "\n# In no table of this file ({count} {kind}); to draw them:");
        let _ = writeln!(out, "{head}\n# file = {}", quoted(source.file));
        if let Some(name) = &source.layer.name {
            let _ = writeln!(out, "# layer = {}", quoted(name));
        }
        let mut telling = examples.iter().filter(|(name, _)| Some(name) != named);
        if let Some(condition) = telling.find_map(|(name, value)| condition(name, value)) {
            let _ = writeln!(out, "# where = {}", quoted(&condition));
        }
        properties(out, left);
    }
}

/// A comment with the properties of features and examples of their values.
fn properties(out: &mut String, LeftFeatures { examples, .. }: &LeftFeatures) {
    if !examples.is_empty() {
        let _ = writeln!(out, "# Their properties, each with a value that it has:");
    }
    for (name, value) in examples {
        let shown: String = value.to_string().chars().take(MOST_SHOWN).collect();
        let _ = writeln!(out, "#   {} = {shown}", if is_plain(name) { name.clone() } else { quoted(name) });
    }
}

/// The most characters of an example.
const MOST_SHOWN: usize = 60;

/// The condition that a property has a value, where both are plain and short.
fn condition(name: &str, value: &Value) -> Option<String> {
    let value = match value {
        Value::String(text) if text.len() < MOST_SHOWN => format!("'{}'", text.replace('\'', "''")),
        Value::Number(number) => number.to_string(),
        _ => return None,
    };
    // The identifiers of OpenStreetMap select one feature each.
    (is_plain(name) && !name.contains("id")).then(|| format!("{name} = {value}"))
}

/// Whether a name needs no quotation marks in an expression.
fn is_plain(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(|first| first.is_ascii_alphabetic())
        && letters.all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
}

fn camera(out: &mut String, camera: &CameraDraft) {
    let _ = writeln!(out, "\n# {}\n[[camera]]\nname = {}", camera.about, quoted(camera.name));
    for (key, angle) in [("azimuth", camera.azimuth_deg), ("pitch", camera.pitch_deg)] {
        if let Some(angle) = angle {
            let _ = writeln!(out, "{key} = {angle}");
        }
    }
    if let Some(shown) = &camera.shown {
        let _ = writeln!(out, "shows = {}", corners(shown));
    }
}

/// The corners of a rectangle in whole meters, as a list of points.
fn corners(Rect { min, max }: &Rect) -> String {
    format!("[[{:.0}, {:.0}], [{:.0}, {:.0}]]", min.x, min.y, max.x, max.y)
}

/// A text in double quotes; JSON's escapes are TOML's.
pub(super) fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

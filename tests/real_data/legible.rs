//! Names on pictures of real places, `new` and its scenes unchanged: they can be read, and none covers another or its halo.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use sandtable_annotate::report::{AnnotationReport, SheetBox};
use sandtable_draw::color::luminance;
use sandtable_draw::pixels::Pixels;
use sandtable_new::{self as new_scene, NewSceneOptions};
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::{PictureSize, annotate_view, draw_view};

use crate::common::data::data;
use crate::common::scratch::Scratch;

/// As WCAG 2.2, 1.4.3 asks of text.
const LEAST_CONTRAST: f64 = 4.5;
const SIZE: PictureSize = PictureSize { width: 1280, height: 720 };

/// Elevation and the features on it, below the folder of scenes.
const PLACES: [(&str, &[&str]); 3] = [
    ("monaco/N43E007.hgt.zip", &["monaco/monaco.osm.gz"]),
    (
        "swellendam_za/dem_srtm_utm33s_i16.tif",
        &["swellendam_za/rivers.shp", "swellendam_za/water.shp", "swellendam_za/places.shp"],
    ),
    ("redbutte_us/red_butte_dem.tif", &["redbutte_us/red_butte_road.geojson"]),
];

/// The contrast of the letters of a name with their halo: of the darkest twentieth of what is painted in its boxes with the
/// lightest sixth. `None` where hardly anything is painted.
fn contrast(mut lights: Vec<f64>) -> Option<f64> {
    lights.sort_by(f64::total_cmp);
    // A symbol or the end of a line alone is no text.
    let (dark, pale) = (lights.get(lights.len() / 20)?, lights.get(lights.len() * 5 / 6)?);
    (lights.len() > 60).then(|| (pale + 0.05) / (dark + 0.05))
}

/// The luminances of the pixels in a box that annotations changed.
fn painted(before: &Pixels, after: &Pixels, area: &SheetBox) -> Vec<f64> {
    let clamp = |at: f32, most: u32| (at.max(0.0) as u32).min(most);
    let [left, right] = [area.min.x, area.max.x].map(|x| clamp(x, after.width()));
    let [top, bottom] = [area.min.y, area.max.y].map(|y| clamp(y, after.height()));
    let inside = (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y)));
    let changed = inside.filter(|&(x, y)| before.at(x, y) != after.at(x, y));
    changed.map(|(x, y)| f64::from(luminance(after.at(x, y).linear()))).collect()
}

/// Numbers of contours are as faint as their lines.
fn is_name(text: &str) -> bool {
    text.chars().any(char::is_alphabetic)
}

/// The names in all views of a scene whose contrast is too low or that meet another's box, halos among it; and how many
/// names there are.
fn faults(what: &str, scene: &SceneModel) -> (Vec<String>, usize) {
    let (mut faults, mut count) = (Vec::new(), 0);
    for view in &scene.cameras {
        let drawn = draw_view(scene, view, SIZE, RenderBackend::Cpu, &|_| ()).expect("sound");
        let before = drawn.picture.pixels.clone();
        let after = annotate_view(scene, drawn, &|_| ());
        let place = format!("{what} {}", view.name);
        // The letters of a name along a line have boxes of their own.
        let mut names: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for area in &after.annotations.boxes {
            if let Some(text) = area.text.as_deref().filter(|text| is_name(text)) {
                names.entry(text).or_default().extend(painted(&before, &after.pixels, area));
            }
        }
        for (text, found) in names.into_iter().filter_map(|(text, lights)| Some((text, contrast(lights)?))) {
            count += 1;
            let faint = (found < LEAST_CONTRAST).then(|| format!("{place}: contrast of '{text}' {found:.2}"));
            faults.extend(faint);
        }
        faults.extend(meeting(&after.annotations).into_iter().map(|pair| format!("{place}: {pair}")));
    }
    (faults, count)
}

/// The pairs of texts and furniture that overlap and are not of one name; a box holds a text with its halo.
fn meeting(report: &AnnotationReport) -> Vec<String> {
    let name = |one: &SheetBox| one.text.clone().unwrap_or_else(|| "furniture".to_owned());
    let overlap =
        |one: &SheetBox, other: &SheetBox| one.min.cmplt(other.max).all() && other.min.cmplt(one.max).all();
    let boxes = report.boxes.iter().enumerate();
    let pairs =
        boxes.flat_map(|(index, one)| report.boxes[index + 1..].iter().map(move |other| (one, other)));
    pairs
        .filter(|(one, other)| one.text != other.text && overlap(one, other))
        .map(|(one, other)| format!("'{}' meets '{}'", name(one), name(other)))
        .collect()
}

#[test]
fn names_on_first_pictures_can_be_read_and_none_covers_another_s_halo() {
    let (mut all, mut count) = (Vec::new(), 0);
    for (dem, vectors) in PLACES {
        let Some(dem) = data(&format!("scenes/{dem}")) else { return };
        let vectors: Vec<PathBuf> =
            vectors.iter().filter_map(|file| data(&format!("scenes/{file}"))).collect();
        let folder = Scratch::new();
        let allowed = vec![dem.parent().expect("in a folder").to_path_buf()];
        let options = NewSceneOptions {
            folder: folder.at("scene"),
            dem: vec![dem],
            vectors,
            ..NewSceneOptions::default()
        };
        let written = new_scene::write(&options, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
        let scene = open_scene(&written.path, &allowed, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
        let (faults, names) = faults(&written.path.to_string_lossy(), &scene);
        println!("{}: {names} names", written.path.display());
        all.extend(faults);
        count += names;
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
    assert!(count > 25, "{count} names are too few");
}

#[test]
fn names_of_scenes_can_be_read_and_none_covers_another_s_halo() {
    let (mut all, mut count) = (Vec::new(), 0);
    for name in ["jacksboro", "labels", "lettering", "panorama"] {
        let path = Path::new(env!("SANDTABLE_ROOT")).join(format!("scenes/{name}.toml"));
        let scene = open_scene(&path, &[], &|_| ()).unwrap_or_else(|error| panic!("{error}"));
        let (faults, names) = faults(name, &scene);
        all.extend(faults);
        count += names;
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
    assert!(count > 60, "{count} names are too few");
}

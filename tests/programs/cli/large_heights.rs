//! Pictures of means of samples print the heights of all of them, and show what is seen on all of them.

use serde_json::Value;

use crate::cli::near_ground::{LARGE, SIDE, height, scene};
use crate::cli::run_in;
use crate::common::scratch::Scratch;

/// A camera from which the ground is of means everywhere.
const FAR: &str = "[[camera]]\nname = \"far\"\nprojection = \"plan\"\n";

/// A camera that shows all samples of a part of the ground.
const PART: &str =
    "[[camera]]\nname = \"part\"\nprojection = \"plan\"\nshows = [[503000, 4002500], [504500, 4003500]]\n";

const TERRAIN: &str = "[terrain]\ndem = \"hill.tif\"\n";

/// What the program says of a picture, and the labels on it and beside it.
struct LabeledPicture {
    said: Value,
    texts: Vec<String>,
    pixels: Vec<u8>,
}

impl LabeledPicture {
    fn of(scratch: &Scratch, more: &[&str]) -> Self {
        let command = ["render", "s.toml", "--json", "--sidecar", "--size", "480x320", "-o", "out.png"];
        let said = run_in(scratch.folder(), &[&command[..], more].concat()).ok();
        let sidecar = std::fs::read(scratch.at("out.json")).expect("a sidecar");
        let sidecar: Value = serde_json::from_slice(&sidecar).expect("JSON");
        let labels = sidecar["labels"].as_array().expect("labels").iter();
        let mut texts: Vec<String> =
            labels.map(|label| label["text"].as_str().expect("a text").to_owned()).collect();
        texts.sort();
        let pixels = image::open(scratch.at("out.png")).expect("a picture").into_rgb8().into_raw();
        Self { said: serde_json::from_str(&said).expect("JSON"), texts, pixels }
    }

    fn is_of_means(&self) -> bool {
        self.said["notes"].to_string().contains("printed heights and visibility use all samples")
    }

    /// The share of bytes that differ from those of another by no more than `levels`.
    fn share_within(&self, other: &Self, levels: u8) -> f64 {
        let pairs = self.pixels.iter().zip(&other.pixels);
        let near = pairs.filter(|(a, b)| a.abs_diff(**b) <= levels).count();
        near as f64 / self.pixels.len() as f64
    }
}

#[test]
fn labels_of_a_large_model_print_the_heights_that_a_query_answers() {
    let places = [[501234.5, 4002345.6], [503003.0, 4007777.7], [505555.1, 4001111.9], [507003.3, 4006006.6]];
    let label = |[x, y]: &[f64; 2]| format!("[[label]]\nat = [{x}, {y}]\ntext = \"at {x}: {{height}}\"\n");
    let labels: String = places.iter().map(label).collect();
    let scratch = scene(&format!("{TERRAIN}{labels}{FAR}"));
    let picture = LabeledPicture::of(&scratch, &LARGE);
    assert!(picture.is_of_means(), "{}", picture.said);
    let mut queried: Vec<String> = places
        .iter()
        .map(|[x, y]| {
            let at = format!("{x},{y}");
            let answer = run_in(scratch.folder(), &["height", "hill.tif", "--at", &at, "--json"]).ok();
            let answer: Value = serde_json::from_str(&answer).expect("JSON");
            let found = answer.pointer("/0/height").or(answer.pointer("/height"));
            format!("at {x}: {:.0}", found.and_then(Value::as_f64).unwrap_or_else(|| panic!("{answer}")))
        })
        .collect();
    queried.sort();
    assert_eq!(picture.texts, queried);
    assert_eq!(picture.texts, LabeledPicture::of(&scratch, &[]).texts, "as of all samples in memory");
}

#[test]
fn summits_of_a_large_model_have_the_height_of_their_highest_sample() {
    let scratch = scene(&format!("{TERRAIN}[style]\nspot_heights = 8\n{FAR}"));
    let [large, whole] = [&LARGE[..], &[]].map(|more| LabeledPicture::of(&scratch, more));
    assert!(large.is_of_means() && !whole.is_of_means());
    let highest = (0..SIDE * SIDE).map(|at| height(at % SIDE, at / SIDE)).fold(f64::MIN, f64::max);
    let highest = format!("{highest:.0}");
    // Means of 8 x 8 samples are a meter or two lower there.
    assert!(whole.texts.contains(&highest), "{:?}", whole.texts);
    assert!(large.texts.contains(&highest), "{:?} without {highest}", large.texts);
    assert_eq!(large.texts.len(), 8);
}

#[test]
fn sight_over_a_large_model_is_that_over_all_of_its_samples() {
    let viewshed = "[[viewshed]]\nobservers = [[503700, 4002900], [504100, 4003300]]\nrange = 700\n";
    let sight = "[[sight]]\nobserver = [503200, 4002600]\ntargets = [[504300, 4003300], [503300, 4003400]]\n";
    let range = "[[range]]\nat = [503800, 4003000]\ndistances = [200, 450]\nfill = \"seen\"\n";
    for layer in [viewshed, sight, range] {
        let scratch = scene(&format!("{TERRAIN}{layer}{PART}"));
        let [large, whole] = [&LARGE[..], &[]].map(|more| LabeledPicture::of(&scratch, more));
        assert!(large.is_of_means() && !whole.is_of_means());
        let share = large.share_within(&whole, 12);
        assert!(share > 0.99, "{layer}: {share}");
    }
}

#[test]
fn numbers_and_sight_of_a_large_model_are_of_the_ground_as_it_is_shaped() {
    let lake = "[[lake]]\nlevel = 250.4\npoints = [[503000, 4002500], [503600, 4002500], [503600, 4003100], [503000, 4003100]]\n";
    let label = "[[label]]\nat = [503300, 4002800]\ntext = \"lake {height}\"\n";
    let scratch = scene(&format!("{TERRAIN}{lake}{label}{FAR}"));
    let [large, whole] = [&LARGE[..], &[]].map(|more| LabeledPicture::of(&scratch, more));
    assert!(large.is_of_means(), "{}", large.said);
    assert_eq!((large.texts, whole.texts), (vec!["lake 250".to_owned()], vec!["lake 250".to_owned()]));
}

#[test]
fn more_places_far_apart_than_parts_are_built_for_are_said_to_be_unshaped() {
    let lake =
        "[[lake]]\nlevel = 250.4\npoints = [[500500, 4000500], [500700, 4000500], [500700, 4000700]]\n";
    let scratch = scene(TERRAIN);
    let label = |index: u32| {
        let (x, y) = (500_150 + 2900 * (index % 4), 4_000_150 + 2900 * (index / 4));
        format!("[[label]]\nat = [{x}, {y}]\ntext = \"{index}: {{height}}\"\n")
    };
    let notes = |count: u32| {
        let labels: String = (0..count).map(label).collect();
        scratch.write("s.toml", format!("{TERRAIN}{lake}{labels}{FAR}"));
        LabeledPicture::of(&scratch, &LARGE).said["notes"].to_string()
    };
    let unshaped = "printed heights are those of the elevation model";
    assert!(!notes(8).contains(unshaped));
    assert!(notes(16).contains(&format!("8 {unshaped}")), "{}", notes(16));
}

#[test]
fn a_viewshed_without_a_range_is_refused_where_it_would_read_too_much() {
    let scratch = scene(&format!("{TERRAIN}[[viewshed]]\nobservers = [[503700, 4002900]]\n{FAR}"));
    let picture = LabeledPicture::of(&scratch, &LARGE);
    let notes = picture.said["notes"].to_string();
    assert!(notes.contains("took all 900 x 900 samples"), "{notes}");
    let render = ["render", "s.toml", "-o", "out.png", "--limit", "raster-samples=500k"];
    let said = run_in(scratch.folder(), &[&render[..], &LARGE].concat()).failed(1);
    assert!(said.contains("900 x 900 samples") && said.contains("state `range`, in meters"), "{said}");
}

#[test]
fn buffers_are_of_the_picture_as_it_is_drawn_and_say_so() {
    let scratch = scene(&format!("{TERRAIN}{FAR}"));
    let render = ["render", "s.toml", "--size", "160x120", "-o", "out.png", "--buffers", "b"];
    let raster = |more: &[&str]| {
        run_in(scratch.folder(), &[&render[..], more].concat()).ok();
        let bytes = std::fs::read(scratch.at("b/elevation.tif")).expect("a raster");
        let says = bytes.windows(13).any(|text| text == b"is their mean");
        let values = run_in(scratch.folder(), &["dem", "info", "b/elevation.tif", "--json"]).ok();
        let values: Value = serde_json::from_str(&values).expect("JSON");
        (says, values)
    };
    let ((large_says, large), (whole_says, whole)) = (raster(&LARGE), raster(&[]));
    assert!(large_says && !whole_says);
    assert_eq!(large["width"], whole["width"], "{large}");
}

//! `export` of features, read back by our own readers.

use glam::DVec2;
use sandtable_symbology::code::SymbolCode;
use sandtable_vector::feature::{Feature, VectorLayer};
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read;

use crate::cli::{project, run_in};
use crate::common::scratch::Scratch;

/// A file of a scene's features, read layer by layer.
struct Exported<'a> {
    scratch: &'a Scratch,
    file: String,
}

impl<'a> Exported<'a> {
    fn new(scratch: &'a Scratch, scene: &str, extension: &str) -> Self {
        let file = format!("a.{extension}");
        let mut arguments = vec!["export".to_owned(), project(scene), "-o".to_owned(), file.clone()];
        if extension == "gpkg" {
            arguments.extend(["--crs".to_owned(), "EPSG:4326".to_owned()]);
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        run_in(scratch.folder(), &arguments).ok();
        Self { scratch, file }
    }

    fn layer(&self, layer: Option<&str>) -> VectorLayer {
        let bytes = std::fs::read(self.scratch.at(&self.file)).expect("written");
        let hints = VectorHints { layer, ..VectorHints::default() };
        let read =
            read::read(&self.file, &bytes, &hints).unwrap_or_else(|error| panic!("{}: {error}", self.file));
        assert!(read.faults.is_empty(), "{}: {:?}", self.file, read.faults);
        read
    }
}

fn text<'a>(feature: &'a Feature, property: &str) -> &'a str {
    feature.properties.get(property).and_then(|value| value.as_str()).unwrap_or_default()
}

fn of_layer<'a>(layer: &'a VectorLayer, name: &str) -> Vec<&'a Feature> {
    layer.features.iter().filter(|feature| text(feature, "layer") == name).collect()
}

fn places(features: &[&Feature]) -> Vec<DVec2> {
    features.iter().flat_map(|feature| feature.geometry.vertices().copied()).collect()
}

fn assert_same_places(one: &[DVec2], other: &[DVec2], what: &str) {
    assert_eq!(one.len(), other.len(), "{what}");
    for (a, b) in one.iter().zip(other) {
        assert!((*a - *b).abs().max_element() < 1.1e-9, "{what}: {a} {b}");
    }
}

#[test]
fn symbols_are_read_back_the_same_from_every_format() {
    let scratch = Scratch::new();
    let of = |extension| Exported::new(&scratch, "scenes/symbols.toml", extension);
    let all = of("geojson").layer(None);
    let expected = of_layer(&all, "symbols");
    let codes: Vec<&str> = expected.iter().map(|unit| text(unit, "sidc")).collect();
    assert!(expected.len() > 15);
    for extension in ["gpkg", "kmz", "nvg"] {
        let found = of(extension).layer(Some("symbols"));
        let found: Vec<&Feature> = found.features.iter().collect();
        assert_same_places(&places(&found), &places(&expected), extension);
        assert_eq!(found.iter().map(|unit| text(unit, "sidc")).collect::<Vec<_>>(), codes, "{extension}");
        for (one, other) in found.iter().zip(&expected) {
            let designation = "unique_designation";
            assert_eq!(text(one, designation), text(other, designation), "{extension}");
        }
    }
    let msdl = of("msdl").layer(None);
    let with_letters: Vec<&Feature> = expected
        .iter()
        .copied()
        .filter(|unit| SymbolCode::parse(text(unit, "sidc")).is_ok_and(|code| code.letters().is_some()))
        .collect();
    assert_eq!(msdl.features.len(), with_letters.len());
    let kind =
        |unit: &Feature| SymbolCode::parse(text(unit, "sidc")).map(|code| (code.set.number(), code.entity));
    let mut found: Vec<_> = msdl.features.iter().map(|unit| kind(unit).expect("a code")).collect();
    let mut known: Vec<_> = with_letters.iter().map(|unit| kind(unit).expect("a code")).collect();
    found.sort_unstable();
    known.sort_unstable();
    assert_eq!(found, known);
}

#[test]
fn layers_of_ground_graphics_and_sight_are_the_same_in_geojson_and_geopackage() {
    for (scene, layers) in [
        (
            "scenes/operation.toml",
            &["lakes", "rivers", "contours", "graphic_lines", "graphic_areas", "graphics_drawn"][..],
        ),
        ("scenes/sight.toml", &["seen", "hidden", "sight_lines"][..]),
        ("scenes/jacksboro.toml", &["roads", "centerlines", "labels"][..]),
    ] {
        let scratch = Scratch::new();
        let all = Exported::new(&scratch, scene, "geojson").layer(None);
        let package = Exported::new(&scratch, scene, "gpkg");
        for name in layers {
            let (one, other) = (of_layer(&all, name), package.layer(Some(name)));
            assert!(!one.is_empty(), "{scene} {name}");
            assert_eq!(one.len(), other.features.len(), "{scene} {name}");
            let count = |features: &mut dyn Iterator<Item = &Feature>| {
                features.map(|f| f.geometry.vertices().count()).sum::<usize>()
            };
            assert_eq!(count(&mut one.iter().copied()), count(&mut other.features.iter()), "{scene} {name}");
        }
    }
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    for extension in ["gpkg", "kmz", "nvg", "msdl", "geojson"] {
        let bytes = [(); 2].map(|()| {
            let scratch = Scratch::new();
            Exported::new(&scratch, "scenes/symbols.toml", extension);
            std::fs::read(scratch.at(&format!("a.{extension}"))).expect("written")
        });
        assert!(bytes[0] == bytes[1], "{extension}");
    }
}

#[test]
fn what_a_format_cannot_hold_is_an_error_or_a_note_and_nothing_is_half_written() {
    let scratch = Scratch::new();
    let lake = project("scenes/lake.toml");
    let said = run_in(scratch.folder(), &["export", &lake, "-o", "a.msdl"]).failed(1);
    assert!(said.contains("nothing that an .msdl holds"), "{said}");
    let said =
        run_in(scratch.folder(), &["export", &lake, "-o", "a.geojson", "--crs", "EPSG:32616"]).failed(2);
    assert!(said.contains("--crs has no effect on"), "{said}");
    let said = run_in(scratch.folder(), &["export", &lake, "-o", "a.gpkg", "--max-error", "1"]).failed(2);
    assert!(said.contains("--max-error has no effect on a file of features"), "{said}");
    assert_eq!(scratch.names(), Vec::<String>::new());
}

//! Checks of the scenes of the gallery and of real places: all that is found in them is true of them.

use std::path::Path;

use sandtable_description::finding::Finding;

use crate::common::findings::{findings, grave};
use crate::common::places::{PLACES, text_of};
use crate::common::scratch::Scratch;

/// What is true of the scenes that are shown to users, by code.
const TRUE_OF_GALLERY: &[(&str, &[&str])] = &[
    // Rivers of the gazetteer, drawn for maps of 1 : 100 000, on an elevation model of 90 m.
    (
        "river-uphill",
        &[
            "areas",
            "bridge",
            "briefing",
            "expressions",
            "grid",
            "illuminated",
            "jacksboro",
            "labels",
            "lake",
            "landing",
            "lettering",
            "models",
            "observation",
            "obstacles",
            "operation",
            "paper",
            "phases",
            "preset-atlas",
            "preset-clay",
            "preset-military",
            "preset-night",
            "preset-print",
            "preset-relief",
            "preset-satellite",
            "preset-swiss",
            "preset-topographic",
            "river",
            "routes",
            "sheet",
            "water",
        ],
    ),
    // Roads of the same maps, which show no bridge; one of a map that was drawn by hand.
    (
        "road-in-water",
        &[
            "areas",
            "briefing",
            "expressions",
            "heightmap",
            "jacksboro",
            "landing",
            "observation",
            "obstacles",
            "operation",
            "paper",
            "preset-print",
            "routes",
            "sheet",
            "water",
        ],
    ),
    // Roads as wide as a symbol on a map has to be, on a pass road with hairpins.
    (
        "tight-curve",
        &[
            "expressions",
            "illuminated",
            "jacksboro",
            "preset-atlas",
            "preset-clay",
            "preset-military",
            "preset-night",
            "preset-print",
            "preset-relief",
            "preset-satellite",
            "preset-swiss",
            "preset-topographic",
            "road",
            "sheet",
            "symbols",
        ],
    ),
    // A ridge without a road, and hills that were made up to show how roads lie on them.
    ("road-steep", &["bridge", "junctions"]),
    // A bridge from the bottom of a valley to its side, 35 m higher.
    ("bridge-steep", &["bridge"]),
    // A hill that a road goes through to show the cutting.
    ("deep-earthwork", &["earthworks"]),
    // A reservoir, with the valley below its dam in its outline.
    ("lake-shore-gap", &["jacksboro", "operation", "panorama"]),
    // Models tens of times as large as they are, to be seen on the block; and one of each anchor on a slope.
    ("model-floats", &["jacksboro", "models", "phases", "placement"]),
    ("models-overlap", &["jacksboro"]),
    ("model-buried", &["placement"]),
];

/// What is true of real places: place, code, and words of the message.
const TRUE_OF: &[(&str, &str, &str)] = &[
    // A margin of zeros, where the model ends.
    ("swellendam", "flat-margin", ""),
    // One outline that runs back over itself.
    ("monaco", "empty-shape", ""),
    // Digitized by hand over contours of 20 m.
    ("swellendam", "crosses-itself", "area 'town' crosses itself"),
    ("swellendam", "river-uphill", "in 'Buffeljagsrivier'"),
    ("swellendam", "lake-shore-gap", "half of its shore"),
    ("swellendam", "road-in-water", "river 'Leeu River', 20 m wide"),
    // Hiking trails, steps and driveways turn on the spot, and are stated to be roads meters wide.
    ("swellendam", "tight-curve", "road 'Wolfkloof Hut to Glenstroom Hut' turns by 165°"),
    ("swellendam", "tight-curve", "road 'Rhenius Street' turns by 87°"),
    ("porto_alegre", "tight-curve", "road 'Beco da Praça' turns by 130°"),
    ("porto_alegre", "tight-curve", "radius of 1.0 m; half its width is 3.5 m"),
    ("porto_alegre", "tight-curve", "road 'Avenida São Sebastião' turns by 74°"),
    ("monaco", "tight-curve", "turns by 169°"),
    ("monaco", "tight-curve", "road 'Rue Plati' turns by 93°"),
    ("porto_alegre", "doubles-back", "comes back on itself at station 17.0 m"),
    // The elevation model there is one of surfaces, with a cell of 28 m.
    ("porto_alegre", "road-steep", "road 'Travessa P' is 37 % steep"),
    // A stream in a pipe that its file does not tell.
    ("monaco", "road-in-water", "4 m wide, on the ground at (373327, 4844233)"),
    // One line of four begins at (0, 0).
    ("taunton", "partly-off-terrain", "of 4 features of"),
    // Streams of a single point, which the tracing left.
    ("wake", "empty-shape", "15 rivers left out: all of their points are one place"),
    // Streams traced on another elevation model than the scene's, meander by meander.
    ("wake", "river-uphill", "places of 26 rivers"),
    ("wake", "tight-curve", "turns by 109°"),
    ("wake", "lake-shore-gap", "half of its shore"),
];

/// Compares what is found in a place with [`TRUE_OF`]; the differences, for a message.
fn differences(place: &str, all: &[Finding]) -> Vec<String> {
    let expected: Vec<_> = TRUE_OF.iter().filter(|(name, _, _)| *name == place).collect();
    let is = |finding: &Finding, (_, code, words): &(&str, &str, &str)| {
        finding.code.word() == *code && finding.message.contains(words)
    };
    let more = grave(all).into_iter().filter(|finding| !expected.iter().any(|row| is(finding, row)));
    let more = more.map(|finding| format!("{place}: {finding}"));
    let less = expected.iter().filter(|row| !all.iter().any(|finding| is(finding, row)));
    more.chain(less.map(|row| format!("{place}: not found: {row:?}"))).collect()
}

/// Compares what is found in a scene of the gallery with [`TRUE_OF_GALLERY`]; the differences, for a message.
fn gallery_differences(scene: &str, all: &[Finding]) -> Vec<String> {
    let is_true = |code: &str| {
        TRUE_OF_GALLERY.iter().any(|(true_code, scenes)| *true_code == code && scenes.contains(&scene))
    };
    let more = grave(all).into_iter().filter(|finding| !is_true(finding.code.word()));
    let more = more.map(|finding| format!("{scene}: {finding}"));
    let less = TRUE_OF_GALLERY.iter().filter(|(code, scenes)| {
        scenes.contains(&scene) && !all.iter().any(|finding| finding.code.word() == *code)
    });
    more.chain(less.map(|(code, _)| format!("{scene}: not found: {code}"))).collect()
}

#[test]
fn scenes_of_the_gallery_have_no_mistakes_but_those_they_show() {
    let folder = Path::new(env!("SANDTABLE_ROOT")).join("scenes");
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .expect("the gallery")
        .map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned())
        .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
        .collect();
    names.sort();
    assert!(names.len() > 20, "{names:?}");
    let of = |name: &String| gallery_differences(name, &findings(&folder.join(format!("{name}.toml")), &[]));
    let wrong: Vec<String> = names.iter().flat_map(of).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn real_places_have_no_mistakes_but_those_of_their_data() {
    let mut wrong = Vec::new();
    for place in PLACES {
        let Some((text, allowed)) = text_of(place) else { return };
        let folder = Scratch::new();
        let path = folder.write("scene.toml", &text);
        wrong.extend(differences(place, &findings(&path, &allowed)));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

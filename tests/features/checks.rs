//! Checks of what is built: every seeded mistake is found on its line, and sound scenes are silent.

use std::path::{Path, PathBuf};

use sandtable::description::finding::{Finding, Severity};
use sandtable::pipeline::scene_file::open_linted;

use crate::common::places::{PLACES, text_of};
use crate::common::scratch::Scratch;

/// A square kilometer with posts every 10 m: level at 100 m, with a hill of 80 m around (700, 700) that is 48 % steep, and
/// a slope of 30 % that rises westward from x = 200 m.
fn ground() -> String {
    let height = |x: f64, y: f64| {
        let off2 = (x - 700.0).powi(2) + (y - 700.0).powi(2);
        100.0 + 80.0 * (-off2 / 20_000.0).exp() + (200.0 - x).max(0.0) * 0.3
    };
    let row = |row: u32| {
        let y = 1000.0 - 10.0 * f64::from(row);
        (0..=100)
            .map(|column| format!("{:.3}", height(10.0 * f64::from(column), y)))
            .collect::<Vec<_>>()
            .join(" ")
    };
    let rows: Vec<String> = (0..=100).map(row).collect();
    format!("ncols 101\nnrows 101\nxllcenter 0\nyllcenter 0\ncellsize 10\n{}\n", rows.join("\n"))
}

/// A box as OBJ, Y up: from one corner to the other.
fn block([x0, y0, z0]: [f64; 3], [x1, y1, z1]: [f64; 3]) -> String {
    let corners = [
        [x0, y0, z0],
        [x1, y0, z0],
        [x1, y1, z0],
        [x0, y1, z0],
        [x0, y0, z1],
        [x1, y0, z1],
        [x1, y1, z1],
        [x0, y1, z1],
    ];
    let vertices: Vec<String> = corners.iter().map(|[x, y, z]| format!("v {x} {y} {z}")).collect();
    let faces =
        ["1 4 3 2", "5 6 7 8", "1 2 6 5", "4 8 7 3", "1 5 8 4", "2 3 7 6"].map(|face| format!("f {face}"));
    format!("{}\n{}\n", vertices.join("\n"), faces.join("\n"))
}

/// What a check finds in a scene over that ground; `house.obj` is 10 × 8 m and 6 m high, `tower.obj` has Z up.
fn found(features: &str) -> (String, Vec<Finding>) {
    let folder = Scratch::new();
    folder.write("ground.asc", ground());
    folder.write("house.obj", block([-5.0, 0.0, -4.0], [5.0, 6.0, 4.0]));
    folder.write("tower.obj", block([-3.0, -3.0, 0.0], [3.0, 3.0, 20.0]));
    let text = format!("[terrain]\ndem = \"ground.asc\"\n{features}");
    let path = folder.write("scene.toml", &text);
    (text, findings(&path, &[]))
}

fn findings(path: &Path, allowed: &[PathBuf]) -> Vec<Finding> {
    let (_, findings) =
        open_linted(path, allowed, &|_| ()).unwrap_or_else(|error| panic!("{error}: {error:?}"));
    findings
}

/// What is wrong, or looks wrong, with what is built: nothing that a finding only notes, nothing about files and data.
fn mistakes(all: &[Finding]) -> Vec<&Finding> {
    let is_seeded = |finding: &&Finding| SEEDED.iter().any(|(code, _, _)| finding.code.word() == *code);
    all.iter().filter(|finding| finding.severity() != Severity::Note).filter(is_seeded).collect()
}

/// Mistakes by code: a scene with `# here` on the line that is wrong, and what the message states.
const SEEDED: &[(&str, &str, &[&str])] = &[
    (
        "road-steep",
        "[[road]]\nname = \"Up\"\npoints = [[500, 700], [700, 700]] # here\n",
        &["road 'Up' is 4", "% steep over the 30 m from station", "35 %"],
    ),
    (
        "deep-earthwork",
        "[[road]]\nprofile = \"conform\"\npoints = [[400, 700], [990, 700]] # here\nmax_grade = 4\n",
        &["in a cutting of", "m at station", "(700, 700)"],
    ),
    (
        "deep-earthwork",
        "[[road]]\nprofile = \"conform\"\npoints = [[700, 700], [850, 700]] # here\nmax_grade = 4\n",
        &["on an embankment of", "more than 15 m"],
    ),
    (
        "river-uphill",
        "[[river]]\nwater = \"drape\"\npoints = [[400, 700], [990, 700]] # here\n",
        &["rises downstream by 7", "(700, 700)"],
    ),
    (
        "river-uphill",
        "[[river]]\nname = \"Ay\"\npoints = [[400, 700], [990, 700]] # here\n",
        &["rises downstream at 1 places", "in 'Ay'", "(700, 700)"],
    ),
    (
        "road-in-water",
        "[[river]]\nname = \"Ay\"\nwidth = 12\npoints = [[250, 300], [900, 300]]\n[[road]]\nname = \"A\"\npoints = [[500, 200], [500, 400]] # here\n",
        &["road 'A' crosses river 'Ay', 12 m wide, on the ground at (500, 300)"],
    ),
    (
        "road-in-water",
        "[[lake]]\nname = \"L\"\npoints = [[400, 100], [600, 100], [600, 200], [400, 200]]\n[[road]]\npoints = [[300, 150], [700, 150]] # here\n",
        &["runs 200 m through lake 'L' on the ground from (400, 150) on"],
    ),
    (
        "lake-level-wrong",
        "[[lake]]\nlevel = -5000\npoints = [[400, 100], [600, 100], [600, 200], [400, 200]] # here\n",
        &["-5000 m", "5100 m below all ground along its shore"],
    ),
    (
        "lake-shore-gap",
        "[[lake]]\nlevel = 121\npoints = [[400, 100], [600, 100], [600, 200], [400, 200]] # here\n",
        &["stands 21.0 m above the lowest ground of its shore"],
    ),
    (
        "lake-shore-gap",
        "[[lake]]\npoints = [[20, 300], [100, 300], [100, 400], [20, 400]] # here\n",
        &["half of its shore at least 1"],
    ),
    (
        "tight-curve",
        "[[road]]\npoints = [[300, 500], [340, 500], [340, 501], [300, 501]] # here\n",
        &["turns by 180°", "station 40.0 to 41.0 m at (340, 500)", "radius of 0.5 m", "3.0 m"],
    ),
    ("narrow-width", "[[road]]\nwidth = 0.05\npoints = [[300, 500], [400, 500]] # here\n", &["0.05 m wide"]),
    (
        "crosses-itself",
        "[[road]]\npoints = [[300, 500], [400, 500], [400, 550], [350, 550], [350, 450]] # here\n",
        &["crosses itself at (350, 500)"],
    ),
    (
        "crosses-itself",
        "[[area]]\nname = \"Tie\"\ncover = \"forest\"\npoints = [[300, 300], [400, 300], [300, 400], [400, 400]] # here\n",
        &["area 'Tie' crosses itself at (350, 350)"],
    ),
    (
        "crosses-itself",
        "[[lake]]\npoints = [[300, 300], [400, 300], [300, 400], [400, 400]] # here\n",
        &["crosses itself at (350, 350)"],
    ),
    (
        "doubles-back",
        "[[road]]\npoints = [[300, 500], [400, 500], [350, 500], [350, 600]] # here\n",
        &["comes back on itself at station 100.0 m at (400, 500)"],
    ),
    (
        "model-size",
        "[[model]]\nfile = \"house.obj\"\nat = [500, 300] # here\nscale = 1000\n",
        &["10000 × 8000 × 6000 m", "`scale = 1`", "10 × 8.00 × 6.00 m"],
    ),
    (
        "model-size",
        "[[model]]\nfile = \"house.obj\"\nat = [500, 300] # here\nscale = 0.001\n",
        &["0.01 × 0.01 × 0.01 m large, less than a brick", "`scale = 1`"],
    ),
    (
        "model-on-side",
        "[[model]]\nfile = \"tower.obj\"\nat = [500, 300] # here\n",
        &["seems to lie on its side", "toward the front, 20.0 m long", "6.0 m"],
    ),
    (
        "model-floats",
        "[[model]]\nfile = \"house.obj\"\nat = [100, 300] # here\n",
        &["floats by up to 1.50 m at (100, 300)", "front left", "+1.50 m", "-1.50 m"],
    ),
    (
        "model-buried",
        "[[model]]\nfile = \"house.obj\"\nat = [100, 300] # here\nanchor = \"lowest\"\n",
        &["6.0 m high and buried by up to 3.00 m"],
    ),
    (
        "models-overlap",
        "[[model]]\nname = \"A\"\nfile = \"house.obj\"\nat = [500, 300]\n[[model]]\nname = \"B\"\nfile = \"house.obj\"\nat = [503, 300] # here\n",
        &["model 'B' at (503, 300) stands in model 'A'", "70 %"],
    ),
    (
        "models-overlap",
        "[[building]]\nname = \"Inn\"\npoints = [[490, 290], [510, 290], [510, 310], [490, 310]]\n[[model]]\nfile = \"house.obj\"\nat = [500, 300] # here\n",
        &["stands in building 'Inn': 100 % of its foot"],
    ),
    (
        "models-overlap",
        "[[road]]\nname = \"A\"\npoints = [[300, 300], [700, 300]]\n[[model]]\nfile = \"house.obj\"\nat = [500, 302] # here\n",
        &["stands on the middle of road 'A'"],
    ),
    (
        "camera-underground",
        "[[camera]]\nname = \"c\"\neye = [700, 700] # here\neye_elevation = 150\nlook_at = [500, 300]\n",
        &["30.0 m under the ground"],
    ),
    (
        "camera-sees-nothing",
        "[[camera]]\nname = \"c\"\neye = [500, 2500] # here\neye_elevation = 9000\nlook_at = [500, 990]\nlook_at_height = 90000\n",
        &["camera 'c' sees nothing of the scene"],
    ),
    (
        "camera-far",
        "[[camera]]\nname = \"c\"\neye = [1e6, 1e6] # here\neye_elevation = 500000\nlook_at = [500, 500]\n",
        &["1499 km away", "pixels of its picture wide"],
    ),
    (
        "camera-blocked",
        "[[camera]]\nname = \"c\"\neye = [640, 700] # here\nlook_at = [990, 700]\n",
        &["looks into the ground", "m before it"],
    ),
    (
        "camera-blocked",
        "[[model]]\nname = \"H\"\nfile = \"house.obj\"\nat = [510, 300]\n[[camera]]\nname = \"c\"\neye = [500, 300] # here\nlook_at = [650, 300]\n",
        &["has model 'H' 5", "rays through its picture"],
    ),
    (
        "out-of-view",
        "[[road]]\npoints = [[300, 900], [500, 900]] # here\n[[camera]]\nname = \"c\"\neye = [500, 300]\neye_height = 50\nlook_at = [500, 100]\n",
        &["camera 'c' shows none of the 1 road of this table"],
    ),
    ("tolerance-budget", "tolerance_px = 20 # here\n", &["off by 20 pixels", "more than 4"]),
    (
        "label-illegible",
        "[[label]]\ntext = \"山\" # here\nat = [500, 300]\n",
        &["camera 'overview'", "'山' is drawn with boxes"],
    ),
];

#[test]
fn labels_that_are_not_drawn_are_noted_with_the_reason() {
    let camera = "[[camera]]\nname = \"c\"\neye = [500, 50]\neye_height = 40\nlook_at = [500, 300]\n";
    for (label, why) in [
        ("text = \"A\" # here\nat = [500, 10]", "behind the eye"),
        ("text = \"A\" # here\nat = [900, 990]", "the ground hides"),
    ] {
        let (text, all) = found(&format!("[[label]]\n{label}\n{camera}"));
        let line = 1 + text.lines().position(|line| line.ends_with("# here")).expect("a marked line");
        let dropped = all.iter().find(|finding| finding.code.word() == "label-dropped");
        let dropped = dropped.unwrap_or_else(|| panic!("{label}: {all:?}"));
        assert_eq!(dropped.place.as_ref().map(|place| place.position().line), Some(line));
        assert!(dropped.message.contains(why) && dropped.message.contains("1 of the 1 labels"), "{dropped}");
    }
}

#[test]
fn every_seeded_mistake_is_found_on_its_line() {
    for (code, features, wanted) in SEEDED {
        let (text, all) = found(features);
        let line = 1 + text.lines().position(|line| line.ends_with("# here")).expect("a marked line");
        let shown: Vec<String> = all.iter().map(ToString::to_string).collect();
        let is_meant = |finding: &&Finding| {
            finding.code.word() == *code && wanted.iter().all(|words| finding.message.contains(words))
        };
        let finding = all.iter().find(is_meant);
        let finding =
            finding.unwrap_or_else(|| panic!("{code}: {wanted:?} of\n{features}\n{}", shown.join("\n")));
        let place = finding.place.as_ref().unwrap_or_else(|| panic!("{code} has a place"));
        assert_eq!(place.position().line, line, "{finding}");
        let others: Vec<_> = mistakes(&all).into_iter().filter(|other| other.code != finding.code).collect();
        assert!(others.is_empty(), "of {features}\nnothing but {code}: {}", shown.join("\n"));
    }
}

#[test]
fn what_is_as_it_should_be_is_not_found() {
    for features in [
        // A road along the foot of the hill, and one over it that the ground may not follow but by a tunnel.
        "[[road]]\npoints = [[250, 300], [900, 300], [950, 600]]\n",
        "[[road]]\nprofile = \"conform\"\npoints = [[400, 700], [990, 700]]\nmax_cut = 20\nmax_grade = 4\n",
        // A path climbs it.
        "[[road]]\nsurface = \"track\"\nwidth = 2\npoints = [[500, 700], [700, 700]]\n",
        // A bridge over a river, and a stream in a pipe.
        "[[river]]\nwidth = 12\npoints = [[250, 300], [900, 300]]\n[[road]]\npoints = [[500, 200], [500, 280]]\n\
         [[bridge]]\npoints = [[500, 270], [500, 330]]\n[[road]]\npoints = [[500, 320], [500, 400]]\n",
        "[[river]]\nwidth = 2\npoints = [[250, 300], [900, 300]]\n[[road]]\npoints = [[500, 200], [500, 400]]\n",
        // A lake as its shore has it, and a road beside it.
        "[[lake]]\npoints = [[400, 100], [600, 100], [600, 200], [400, 200]]\n[[road]]\npoints = [[300, 220], [700, 220]]\n",
        // Models on the level, and on the slope with a footing; a tree on it, a car on a road.
        "[[model]]\nfile = \"house.obj\"\nat = [500, 300]\n[[model]]\nfile = \"house.obj\"\nat = [515, 300]\n",
        "[[model]]\nfile = \"house.obj\"\nat = [100, 300]\nfooting = \"plinth\"\nanchor = \"highest\"\n",
        "[[model]]\nfile = \"house.obj\"\nat = [100, 300]\nfooting = \"pad\"\n",
        "[[model]]\nfile = \"conifer\"\nat = [100, 300]\n",
        "[[road]]\npoints = [[300, 300], [700, 300]]\n[[model]]\nfile = \"house.obj\"\nscale = 0.4\nat = [500, 302]\n",
        "[[camera]]\nname = \"c\"\neye = [300, 100]\neye_height = 60\nlook_at = [700, 700]\n",
    ] {
        let (_, all) = found(features);
        let shown: Vec<String> = mistakes(&all).into_iter().map(ToString::to_string).collect();
        assert!(shown.is_empty(), "{features}\n{}", shown.join("\n"));
    }
}

/// What is true of the scenes that are shown to users, by code.
const TRUE_OF_GALLERY: &[(&str, &[&str])] = &[
    // Rivers of the gazetteer, drawn for maps of 1 : 100 000, on an elevation model of 90 m.
    (
        "river-uphill",
        &[
            "areas",
            "bridge",
            "expressions",
            "grid",
            "jacksboro",
            "labels",
            "lake",
            "lettering",
            "models",
            "operation",
            "paper",
            "phases",
            "preset-night",
            "preset-print",
            "preset-relief",
            "preset-satellite",
            "river",
            "sheet",
        ],
    ),
    // Roads of the same maps, which show no bridge; one of a map that was drawn by hand.
    (
        "road-in-water",
        &["areas", "expressions", "heightmap", "jacksboro", "operation", "paper", "preset-print", "sheet"],
    ),
    // Roads as wide as a symbol on a map has to be, on a pass road with hairpins.
    (
        "tight-curve",
        &[
            "expressions",
            "jacksboro",
            "preset-night",
            "preset-print",
            "preset-relief",
            "preset-satellite",
            "road",
            "sheet",
            "symbols",
        ],
    ),
    // A ridge without a road, and hills that were made up to show how roads lie on them.
    ("road-steep", &["bridge", "junctions"]),
    // A hill that a road goes through to show the cutting.
    ("deep-earthwork", &["earthworks"]),
    // A reservoir, with the valley below its dam in its outline.
    ("lake-shore-gap", &["jacksboro", "operation"]),
    // Models tens of times as large as they are, to be seen on the block; and one of each anchor on a slope.
    ("model-floats", &["jacksboro", "models", "phases", "placement"]),
    ("models-overlap", &["jacksboro"]),
    ("model-buried", &["placement"]),
];

/// What is true of real places: place, code, and words of the message.
const TRUE_OF: &[(&str, &str, &str)] = &[
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
    let more = mistakes(all).into_iter().filter(|finding| !expected.iter().any(|row| is(finding, row)));
    let more = more.map(|finding| format!("{place}: {finding}"));
    let less = expected.iter().filter(|row| !all.iter().any(|finding| is(finding, row)));
    more.chain(less.map(|row| format!("{place}: not found: {row:?}"))).collect()
}

/// Compares what is found in a scene of the gallery with [`TRUE_OF_GALLERY`]; the differences, for a message.
fn gallery_differences(scene: &str, all: &[Finding]) -> Vec<String> {
    let is_true = |code: &str| {
        TRUE_OF_GALLERY.iter().any(|(true_code, scenes)| *true_code == code && scenes.contains(&scene))
    };
    let more = mistakes(all).into_iter().filter(|finding| !is_true(finding.code.word()));
    let more = more.map(|finding| format!("{scene}: {finding}"));
    let less = TRUE_OF_GALLERY.iter().filter(|(code, scenes)| {
        scenes.contains(&scene) && !all.iter().any(|finding| finding.code.word() == *code)
    });
    more.chain(less.map(|(code, _)| format!("{scene}: not found: {code}"))).collect()
}

#[test]
fn scenes_of_the_gallery_have_no_mistakes_but_those_they_show() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
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

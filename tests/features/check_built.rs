//! Checks of what is built: every seeded mistake is found on its line, and sound scenes are silent.

use sandtable_description::finding::Finding;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_files::png::encode_png;

use crate::common::findings::{findings, grave};
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

/// A box as [`block`] makes it, with the library of materials `box.mtl` and texture coordinates from above: the walls take
/// a line of the picture each.
fn textured_from_above(block: &str) -> String {
    let coordinate = |line: &str| {
        let numbers: Vec<f64> =
            line.split_whitespace().skip(1).map(|number| number.parse().expect("a number")).collect();
        format!("vt {} {}", numbers[0] / 10.0, numbers[2] / 10.0)
    };
    let coordinates: Vec<String> =
        block.lines().filter(|line| line.starts_with("v ")).map(coordinate).collect();
    let face = |line: &str| match line.strip_prefix("f ") {
        Some(corners) => {
            let corners: Vec<String> =
                corners.split_whitespace().map(|corner| format!("{corner}/{corner}")).collect();
            format!("f {}", corners.join(" "))
        }
        None => line.to_owned(),
    };
    let lines: Vec<String> = block.lines().map(face).collect();
    format!("mtllib box.mtl\nusemtl wall\n{}\n{}\n", coordinates.join("\n"), lines.join("\n"))
}

/// A picture of squares, 64 × 64 pixels.
fn squares() -> Pixels {
    Pixels::from_fn(64, 64, |x, y| {
        let value = if (x / 4 + y / 4) % 2 == 0 { 90 } else { 220 };
        Srgba([value, value, value, 255])
    })
}

/// What a check finds in a scene over that ground; `house.obj` is 10 × 8 m and 6 m high, `tower.obj` has Z up, and
/// `smeared.obj` is a house with a texture from above.
fn found(features: &str) -> (String, Vec<Finding>) {
    let folder = Scratch::new();
    folder.write("ground.asc", ground());
    folder.write("house.obj", block([-5.0, 0.0, -4.0], [5.0, 6.0, 4.0]));
    folder.write("smeared.obj", textured_from_above(&block([-5.0, 0.0, -4.0], [5.0, 6.0, 4.0])));
    folder.write("box.mtl", "newmtl wall\nmap_Kd squares.png\n");
    folder.write("squares.png", encode_png(&squares()));
    folder.write("tower.obj", block([-3.0, -3.0, 0.0], [3.0, 3.0, 20.0]));
    let text = format!("[terrain]\ndem = \"ground.asc\"\n{features}");
    let path = folder.write("scene.toml", &text);
    (text, findings(&path, &[]))
}

/// Mistakes by code: a scene with `# here` on the line that is wrong, and what the message states.
const SEEDED: &[(&str, &str, &[&str])] = &[
    (
        "road-steep",
        "[[road]]\nname = \"Up\"\npoints = [[500, 700], [700, 700]] # here\n",
        &["road 'Up' is 4", "% steep over the 30 m from station", "35 %"],
    ),
    (
        "bridge-steep",
        "[[bridge]]\nname = \"B\"\npoints = [[500, 700], [700, 700]] # here\n",
        &["bridge 'B' is ", "% steep over the 30 m from station", "to 180.0 m", "less than 15 %"],
    ),
    (
        "bridge-steep",
        "[[road]]\nname = \"R\"\nprofile = \"conform\"\nmax_grade = 4\nbridge = \"true\"\npoints = [[500, 700], [600, 700]] # here\n",
        &["bridge 'R' is ", "its road states at most 4.0 %"],
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
        &["rises downstream at 1 place of 1 river", "in 'Ay'", "(700, 700)"],
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
    (
        "tight-curve",
        "[[road]]\npoints = [[300, 500], [340, 500], [340.02, 500.02], [340.02, 540]] # here\n",
        &[
            "has a corner at station 40.0 m at (340, 500): it turns by 90° within 0.03 m",
            "half its width is 3.0 m",
        ],
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
        "crosses-itself",
        "[[building]]\nname = \"Tie\"\npoints = [[300, 300], [340, 300], [300, 340], [340, 340]] # here\n",
        &["building 'Tie' crosses itself at (320, 320): it is built in pieces"],
    ),
    (
        "crosses-itself",
        "[[scatter]]\nof = \"conifer\"\npoints = [[300, 300], [400, 300], [300, 400], [400, 400]] # here\n",
        &["a scatter without a name crosses itself at (350, 350)"],
    ),
    (
        "crosses-itself",
        "[[fence]]\npoints = [[300, 500], [400, 500], [400, 550], [350, 550], [350, 450]] # here\n",
        &["a line without a name crosses itself at (350, 500)"],
    ),
    (
        "empty-shape",
        "[[area]]\nname = \"A\"\ncover = \"forest\"\npoints = [[300, 300], [400, 300], [350, 300]] # here\n",
        &["1 area of 'A' left out: their outlines enclose no area"],
    ),
    (
        "empty-shape",
        "[[lake]]\nname = \"L\"\npoints = [[300, 300], [400, 300], [350, 300]] # here\n",
        &["lake 'L' left out: its shore encloses no area"],
    ),
    (
        "empty-shape",
        "[[building]]\npoints = [[300, 300], [310, 300], [305, 300]] # here\n",
        &["1 building left out: the footprint encloses no area"],
    ),
    (
        "empty-shape",
        "[[road]]\npoints = [[300, 300], [300, 300]] # here\n",
        &["1 road left out: all of their points are one place"],
    ),
    (
        "no-earth-moved",
        "[[earthwork]]\nkind = \"crater\"\npoints = [[505, 305]] # here\nradius = 0.5\n",
        &["1 of 1 earthwork moved no earth"],
    ),
    (
        "camera-far",
        "[[camera]]\nname = \"c\"\neye = [1e9, 1e9] # here\neye_elevation = 9000\nlook_at = [500, 500]\n",
        &["km away", "pixels of its picture wide"],
    ),
    (
        "wrong-value",
        "[[camera]]\nname = \"c\"\neye = [500, 500]\neye_height = 2\nlook_at = [500, 500] # here\nlook_at_height = 2\n",
        &["the camera looks at the place where its eye is"],
    ),
    (
        "pad-refused",
        "[[lake]]\npoints = [[400, 100], [600, 100], [600, 200], [400, 200]]\n[[building]]\nbase = \"pad\"\npoints = [[490, 140], [510, 140], [510, 160], [490, 160]] # here\n",
        &["1 building without its pad"],
    ),
    (
        "junction-untrimmed",
        "[[road]]\nname = \"A\"\npoints = [[500, 300], [900, 300]] # here\n[[road]]\nname = \"B\"\npoints = [[500, 300], [900, 310]]\n",
        &["road 'A' and road 'B' leave (500, 300) at 1.4° to each other", "their edges meet 240 m away"],
    ),
    (
        "scatter-empty",
        "[[scatter]]\nname = \"S\"\nof = \"conifer\"\nslope = [60, 90]\npoints = [[300, 300], [400, 300], [400, 400], [300, 400]] # here\n",
        &["scatter 'S' places no model: of ", " on ground beyond `slope`"],
    ),
    (
        "scatter-empty",
        "[[scatter]]\nof = \"conifer\"\ndensity = 1\npoints = [[300, 300], [302, 300], [302, 302], [300, 302]] # here\n",
        &["places no model: its areas are too small for one"],
    ),
    (
        "scatter-blocked",
        "[[lake]]\npoints = [[300, 300], [400, 300], [400, 390], [300, 390]]\n[[scatter]]\nof = \"conifer\"\npoints = [[300, 300], [400, 300], [400, 400], [300, 400]] # here\n",
        &["places free, which lie on roads, water, buildings or models"],
    ),
    (
        "texture-stretched",
        "[[model]]\nname = \"H\"\nfile = \"smeared.obj\"\nat = [500, 300] # here\n",
        &["model 'H' has stretched pictures on 57 % of its textured faces", "over 1 km long and 0.2 m wide"],
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
        (
            "text = \"A\" # here\nat = [500, 310]\n[[building]]\nname = \"Inn\"\nheight = 40\n\
             points = [[480, 270], [520, 270], [520, 290], [480, 290]]",
            "building 'Inn' hides their places",
        ),
        (
            "text = \"A\" # here\nat = [500, 310]\n[[model]]\nname = \"H\"\nfile = \"house.obj\"\nscale = 4\nat = [500, 280]",
            "model 'H' hides their places",
        ),
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
        let others: Vec<_> = grave(&all).into_iter().filter(|other| other.code != finding.code).collect();
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
        // A bridge as steep as its road may be.
        "[[road]]\nprofile = \"conform\"\nmax_grade = 45\nbridge = \"true\"\npoints = [[500, 700], [600, 700]]\n",
        // A bridge from bank to bank, and one of planks for walkers up a slope.
        "[[bridge]]\npoints = [[300, 300], [360, 300]]\n",
        "[[bridge]]\nsurface = \"track\"\nwidth = 2\npoints = [[600, 700], [660, 700]]\n",
        // A wood around a pond.
        "[[lake]]\npoints = [[330, 330], [370, 330], [370, 370], [330, 370]]\n[[scatter]]\nof = \"conifer\"\n\
         points = [[300, 300], [400, 300], [400, 400], [300, 400]]\n",
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
        let shown: Vec<String> = grave(&all).into_iter().map(ToString::to_string).collect();
        assert!(shown.is_empty(), "{features}\n{}", shown.join("\n"));
    }
}

//! Scene files as users write them: complete, and broken in every way that has a message of its own.

mod layers;
mod reference;
mod schema;
mod symbols_page;

use proptest::prelude::{ProptestConfig, any};
use sandtable_base::limits::SCENE_BYTES;
use sandtable_description::color::{Color, RampChoice};
use sandtable_description::diagnostic::Diagnostics;
use sandtable_description::document::Document;
use sandtable_description::feature_value::FeatureValue;
use sandtable_description::parse::{parse, parse_bytes};
use sandtable_description::scalar::Scalar;
use sandtable_description::selection::Selection;
use sandtable_description::words::{Clamp, LabelKind, RampName, RoadSurface};
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

/// Every key that there is.
const COMPLETE: &str = r##"title = "Tal 山谷"
subtitle = "from the south"
crs = "EPSG:32616"
points_crs = "epsg:4326"

[terrain]
dem = "data/hill.tif"
crs = "EPSG:32616"
height_scale = 0.5
height_offset = -10
cell = 30
vertical_exaggeration = 1.5
tolerance_px = 0.5

[style]
ramp = [[0, "#1b7837"], [500.5, "#fff"], [1_000, "#10203040"]]
haze = 0

[style.contours]
interval = 20
major_every = 10
color = "#80552a80"

[style.light]
azimuth = 225
altitude = 90

[[road]]
name = "B 17"
points = [[-87.0, 42.0], [-87.1, 42.1], [-87.2, 42]]
crs = "EPSG:4326"
width = 7.5
surface = "gravel"

[[road]]
file = "roads.geojson"
where = { highway = ["primary", "secondary"], lanes = 2, bridge = false }

[[river]]
name = "Lech"
file = "rivers.geojson"
width = 12

[[lake]]
name = "Weiher"
points = [[0, 0], [1, 0], [1, 1], [0, 0]]
level = 412.5

[[model]]
name = "barn"
file = "models/barn.3ds"
at = [1, 2]
crs = "EPSG:32616"
heading = -90
scale = 0.01
clamp = "relative"
height = 3

[[label]]
text = "Spitz {height}"
at = [3, 4]
crs = "EPSG:32616"
height = 10
kind = "summit"

[[camera]]
name = "south"
eye = [5, 6]
eye_height = 300
look_at = [7, 8]
look_at_height = -1
crs = "EPSG:32616"
field_of_view = 60

[[camera]]
name = "high"
eye = [5, 6]
eye_elevation = 3000
look_at = [7, 8]

[furniture]
title = true
north_arrow = false
scale_bar = true
legend = false
"##;

/// Features of every kind, with values of every kind.
const FEATURES: &str = r##"
[styles.wide]
width = "width ?? 12"

[[road]]
style = "wide"
file = "roads.gpkg"
layer = "roads"
where = "highway in ('primary', 'secondary')"
surface = "if(surface = 'gravel', 'gravel', 'asphalt')"
shoulder = 1.5
markings = "solid"
join = "round"
miter_limit = 3
profile = "conform"
max_grade = "max_grade ?? 6"
crown = 2.5
fill_slope = 1.5
cut_slope = 1
max_fill = 12
max_cut = 15
bridge = "bridge and not tunnel"
tunnel = "tunnel"
level = "layer ?? 0"

[[road]]
points = [[0, 0], [1, 1]]
widths = [6, 8]

[[bridge]]
points = [[0, 0], [1, 1]]
width = 9
deck = 312.5
pier_spacing = 30

[[river]]
file = "rivers.shp"
width = 4
mouth_width = 9
bank = 1
water = "drape"

[[lake]]
file = "lakes.geojson"
level_rule = "median"

[[area]]
file = "landuse.geojson"
where = { landuse = ["forest", "meadow"] }
cover = "match(landuse, 'forest', 'forest', 'meadow')"
color = "#80a06080"
border = "dashed"
border_width = 2

[[building]]
file = "buildings.geojson"
height = "height ?? `building:levels` * 3 ?? 6"
base = "pad"
roof = "hipped"
roof_height = 2
wall_color = "#eee"
roof_color = "#a54"

[[fence]]
file = "power.geojson"
kind = "power-line"
height = 25
width = 6
spacing = 200
sag = 0.02

[[model]]
file = "tree.glb"
variants = { oak = "oak.glb", fir = "fir.glb" }
variant = "species"
heading = "heading ?? 0"
anchor = "lowest"
tilt = 10
sink = 0.2
footing = "plinth"
[model.instances]
file = "trees.geojson"
where = "natural = 'tree'"

[[scatter]]
file = "woods.geojson"
of = ["conifer", "broadleaf"]
density = 200
spacing = 3
scale = [0.7, 1.3]
slope = [0, 40]
elevation = [100, 900]
seed = 7
"##;

/// The least there can be; broken files below are this and something after it.
const LEAST: &str = "[terrain]\ndem = \"a.tif\"\n";

fn read(text: &str) -> Result<Document, Diagnostics> {
    parse("hill.toml", text)
}

fn messages(text: &str) -> String {
    match read(text) {
        Ok(_) => panic!("this was understood, though it should not:\n{text}"),
        Err(errors) => errors.to_string(),
    }
}

#[test]
fn a_scene_with_every_key_is_read_completely() {
    let document = read(COMPLETE).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(document.title.as_deref(), Some("Tal 山谷"));
    assert_eq!(document.subtitle.as_deref(), Some("from the south"));
    assert_eq!(document.crs.as_ref().and_then(Crs::epsg), Some(32616));
    assert_eq!(document.points_crs.as_ref().and_then(Crs::epsg), Some(4326));
    assert_eq!((document.roads.len(), document.rivers.len(), document.lakes.len()), (2, 1, 1));
    assert_eq!((document.models.len(), document.labels.len(), document.cameras.len()), (1, 1, 2));
    let furniture = document.furniture;
    assert_eq!(
        (furniture.title, furniture.north_arrow, furniture.scale_bar, furniture.legend),
        (true, false, true, false)
    );
}

#[test]
fn the_ground_and_its_look_are_read() {
    let document = read(COMPLETE).expect("a valid scene");
    let terrain = &document.terrain;
    assert_eq!(terrain.dem.iter().map(|tile| &tile.file).collect::<Vec<_>>(), ["data/hill.tif"]);
    assert_eq!((terrain.height_scale, terrain.height_offset, terrain.cell), (Some(0.5), -10.0, Some(30.0)));
    assert_eq!((terrain.vertical_exaggeration, *terrain.tolerance_px), (1.5, 0.5));
    let style = &document.style;
    let stops = vec![
        (0.0, Color([0x1b, 0x78, 0x37, 255])),
        (500.5, Color([255; 4])),
        (1000.0, Color([0x10, 0x20, 0x30, 0x40])),
    ];
    assert_eq!((&*style.ramp, style.haze), (&RampChoice::Stops(stops), Some(0.0)));
    let contours = style.contours.as_ref().expect("contours");
    assert_eq!((contours.interval, contours.major_every), (20.0, 10));
    assert_eq!(contours.color, Some(Color([0x80, 0x55, 0x2a, 0x80])));
    assert_eq!((style.light.azimuth, style.light.altitude), (Some(225.0), Some(90.0)));
}

#[test]
fn features_are_read_with_their_sources() {
    let document = read(COMPLETE).expect("a valid scene");
    let [first, second] = &document.roads[..] else { panic!("two roads") };
    assert_eq!(first.name.as_deref(), Some("B 17"));
    let points = first.source.points.as_ref().expect("points");
    assert_eq!(**points, [[-87.0, 42.0], [-87.1, 42.1], [-87.2, 42.0]].map(Position::from));
    assert_eq!(Some(first.source.span()), points.span());
    assert_eq!(first.surface.stated(), Some(&FeatureValue::Fixed(RoadSurface::Gravel)));
    assert_eq!(second.source.file.as_ref().map(|file| file.as_str()), Some("roads.geojson"));
    let Some(Selection::Matching(wanted)) = second.source.selection.as_deref() else { panic!("a filter") };
    assert_eq!(wanted["lanes"], [Scalar::Number(2.0)]);
    assert_eq!(wanted["bridge"], [Scalar::Bool(false)]);
    assert_eq!(wanted["highway"], ["primary", "secondary"].map(|kind| Scalar::Text(kind.into())));
    assert_eq!(document.lakes[0].level, Some(FeatureValue::Fixed(412.5)));
    let model = &document.models[0];
    assert_eq!((model.file.as_str(), model.at.as_deref()), ("models/barn.3ds", Some(&[1.0, 2.0].into())));
    assert_eq!((model.clamp, document.labels[0].kind), (Clamp::Relative, LabelKind::Summit));
    assert_eq!(document.cameras[1].eye_elevation, Some(3000.0));
}

#[test]
fn the_least_scene_is_an_elevation_file() {
    let document = read(LEAST).expect("a valid scene");
    assert!(document.cameras.is_empty() && document.style.contours.is_none());
    assert!(document.furniture.title && document.furniture.legend);
}

#[test]
fn a_ramp_may_be_a_word_and_tables_may_be_inline() {
    let text =
        format!("{LEAST}[style]\nramp = \"desert\"\ncontours = {{ interval = 5 }}\nlight.azimuth = 3\n");
    let style = read(&text).unwrap_or_else(|errors| panic!("{errors}")).style;
    assert_eq!(*style.ramp, RampChoice::Named(RampName::Desert));
    assert!(style.contours.is_some() && style.light.azimuth == Some(3.0));
}

/// What stands after [`LEAST`] (whose two lines come first), and what the messages must contain.
const BROKEN: &[(&str, &[&str])] = &[
    // unknown keys
    (
        "[[road]]\nfile = \"r.json\"\nwidht = 4\n",
        &[
            "hill.toml:5:1: error[unknown-key]: unknown key `widht` in [[road]]",
            "5 | widht = 4\n  | ^^^^^\n",
            "did you mean `width`?",
        ],
    ),
    (
        "[style]\nelephant = 1\n",
        &[
            "hill.toml:4:1:",
            "[style] knows `preset`, `ramp`, `contours`, `rock`, `spot_heights`, `imagery`, `land_cover`, `wireframe`, `light`, `haze` and `table`",
        ],
    ),
    ("[style.light]\nalitude = 3\n", &["hill.toml:4:1:", "in [style.light]", "did you mean `altitude`?"]),
    ("exaggeration = 2\n", &["hill.toml:3:1:", "in [terrain]", "did you mean `vertical_exaggeration`?"]),
    ("title = \"x\"\n", &["hill.toml:3:1:", "write it at the top, before the first [table]"]),
    (
        "[[roads]]\nfile = \"x\"\n",
        &["hill.toml:3:3:", "unknown key `roads` in the scene file", "did you mean `road`?"],
    ),
    (
        "[[camera]]\nNAME = \"a\"\neye = [0, 0]\nlook_at = [1, 1]\n",
        &["hill.toml:4:1:", "did you mean `name`?"],
    ),
    // wrong kinds
    (
        "[[road]]\nfile = \"r\"\nwidth = \"6\"\n",
        &["hill.toml:5:9:", "`width` must be a number, but this is text", "write 6 without quotes"],
    ),
    (
        "[[road]]\nfile = 3\n",
        &["hill.toml:4:8:", "`file` must be text, but this is a number", "double quotes"],
    ),
    ("[road]\nfile = \"r\"\n", &["hill.toml:3:1:", "`road` is a list of tables", "write [[road]]"]),
    ("[[style]]\nhaze = 3\n", &["hill.toml:3:1:", "`style` must be a table, but this is a list", "[style]"]),
    ("[furniture]\nlegend = \"no\"\n", &["hill.toml:4:10:", "`legend` must be true or false"]),
    (
        "[[model]]\nfile = \"m\"\nat = [1, 2, 3]\n",
        &["hill.toml:5:6:", "a point has two numbers, but this has 3"],
    ),
    ("[[model]]\nfile = \"m\"\nat = [1, \"2\"]\n", &["hill.toml:5:10:", "`at` must be a number"]),
    (
        "[[model]]\nfile = \"m\"\nat = 1979-05-27\n",
        &["hill.toml:5:6:", "`at` must be a point, but this is a date"],
    ),
    ("[style]\nhaze = [3]\n", &["hill.toml:4:8:", "but this is a list"]),
    ("[[road]]\nfile = \"r\"\nwhere = { a = { b = 1 } }\n", &["hill.toml:5:15:", "`a` cannot equal a table"]),
    (
        "[[road]]\nfile = \"r\"\nwhere = 1\n",
        &["hill.toml:5:9:", "`where` must be a table or an expression", "{ property = value }"],
    ),
    (
        "[[road]]\nfile = \"r\"\nwhere = \"a == 1\"\n",
        &["hill.toml:5:12:", "\"==\" means nothing here", "write = to compare"],
    ),
    // missing keys
    (
        "[[model]]\nat = [1, 2]\n",
        &["hill.toml:3:1:", "[[model]] needs the key `file`", "add a line `file = ...`"],
    ),
    ("[style.contours]\n", &["hill.toml:3:1:", "[style.contours] needs the key `interval`"]),
    ("[[road]]\nname = \"x\"\n", &["hill.toml:3:1:", "[[road]] has neither `points` nor `file`"]),
    ("[[road]]\nname = \"x\"\npoint = [[1, 2], [3, 4]]\n", &["hill.toml:5:1:", "did you mean `points`?"]),
    // out of range
    (
        "vertical_exaggeration = 0\n",
        &["hill.toml:3:25:", "must be greater than 0 and at most 1000, but this is 0"],
    ),
    ("tolerance_px = -1\n", &["hill.toml:3:16:", "`tolerance_px` must be greater than 0"]),
    ("height_scale = inf\n", &["hill.toml:3:16:", "but this is inf"]),
    ("height_offset = nan\n", &["hill.toml:3:17:", "but this is NaN"]),
    ("cell = 99999999999999999999\n", &["hill.toml:3:8:", "`cell` must be a number"]),
    ("[style.light]\naltitude = 0\n", &["hill.toml:4:12:", "at most 90, but this is 0"]),
    ("[style.light]\naltitude = 90.5\n", &["hill.toml:4:12:", "but this is 90.5"]),
    ("[style.contours]\ninterval = 0\n", &["hill.toml:4:12:", "`interval` must be from 0.01"]),
    (
        "[style.contours]\ninterval = 9\nmajor_every = 2.5\n",
        &["hill.toml:5:15:", "a whole number from 1 to 1000"],
    ),
    ("[[road]]\nfile = \"r\"\nwidth = -6\n", &["hill.toml:5:9:", "`width` must be from 0.01 to 10000"]),
    (
        "[[lake]]\npoints = [[0, 0], [1, 1e300], [2, 2]]\n",
        &["hill.toml:4:23:", "must be from -1e9 to 1e9, but this is 1e300"],
    ),
    (
        "[[lake]]\npoints = [[0, 0], [1, 1], [0, 0]]\n",
        &["hill.toml:4:10:", "`points` has 2 of the 3 points it needs"],
    ),
    ("[[river]]\npoints = [[0, 0]]\n", &["hill.toml:4:10:", "`points` has 1 of the 2 points it needs"]),
    (
        "[[camera]]\nname = \"a\"\neye = [0, 0]\nlook_at = [1, 1]\nfield_of_view = 180\n",
        &["hill.toml:7:17:", "`field_of_view` must be from 1 to 170, but this is 180"],
    ),
    (
        "[[model]]\nfile = \"m\"\nat = [0, 0]\nscale = 0\n",
        &["hill.toml:6:9:", "`scale` must be greater than 0"],
    ),
    // words, colors, systems
    (
        "[[road]]\nfile = \"r\"\nsurface = \"asfalt\"\n",
        &[
            "hill.toml:5:11:",
            "`surface` cannot be \"asfalt\"",
            "did you mean `asphalt`?",
            "| surface = \"asfalt\"\n  |           ^^^^^^^^",
        ],
    ),
    ("[[road]]\nfile = \"r\"\nsurface = \"ice\"\n", &["it may be `asphalt`, `gravel` or `track`"]),
    (
        "[[label]]\ntext = \"a\"\nat = [0, 0]\nkind = \"peak\"\n",
        &["hill.toml:6:8:", "it may be `summit`, `place`, `water`, `road`, `area` or `point`"],
    ),
    ("[style]\nramp = \"grey\"\n", &["hill.toml:4:8:", "did you mean `gray`?"]),
    ("[style]\nramp = [[0, \"#fff\"]]\n", &["hill.toml:4:8:", "from 2 to 256 stops, but this has 1"]),
    (
        "[style]\nramp = [[9, \"#fff\"], [3, \"#000\"]]\n",
        &["hill.toml:4:22:", "not higher than the one before"],
    ),
    (
        "[style]\nramp = [[9, \"white\"], [10, \"#000\"]]\n",
        &["hill.toml:4:13:", "\"white\" is not a color", "#rrggbb"],
    ),
    (
        "crs = \"ESPG:4326\"\n",
        &["hill.toml:3:7:", "'ESPG:4326' is not a coordinate reference system", "EPSG:n"],
    ),
    ("crs = \"EPSG:999999\"\n", &["hill.toml:3:7:", "EPSG:999999"]),
    // keys that exclude or need each other
    (
        "[[road]]\nfile = \"r\"\npoints = [[0, 0], [1, 1]]\n",
        &["hill.toml:4:1:", "has both `points` and `file`"],
    ),
    (
        "[[road]]\npoints = [[0, 0], [1, 1]]\nwhere = { a = 1 }\n",
        &["hill.toml:5:1:", "`where` has no effect on inline `points`", "name a `file`"],
    ),
    (
        "[[road]]\npoints = [[0, 0], [1, 1]]\nlayer = \"a\"\n",
        &["hill.toml:5:1:", "`layer` has no effect on inline `points`"],
    ),
    ("[[model]]\nfile = \"m\"\nat = [0, 0]\nheight = 3\n", &["hill.toml:6:1:", "`clamp = \"relative\"`"]),
    (
        "[[model]]\nfile = \"m\"\nat = [0, 0]\nclamp = \"absolute\"\n",
        &["hill.toml:6:9:", "this needs a `height`"],
    ),
    (
        "[[camera]]\nname = \"a\"\neye = [0, 0]\nlook_at = [1, 1]\neye_height = 3\neye_elevation = 4\n",
        &["hill.toml:8:17:", "both a height and an elevation"],
    ),
    (
        "[[camera]]\nname = \"a\"\neye = [0, 0]\nlook_at = [1, 1]\n[[camera]]\nname = \"a\"\neye = [0, 0]\nlook_at = [1, 1]\n",
        &["hill.toml:8:8:", "the camera on line 4 already has this name"],
    ),
    // not TOML
    ("a =\n", &["hill.toml:3:4:", "a value is missing here", "3 | a =\n  |    ^"]),
    ("cell = 3\ncell = 4\n", &["hill.toml:4:1:", "`cell` is already given above", "remove one"]),
    ("[terrain]\n", &["hill.toml:3:2:", "`terrain` is already given above"]),
    ("[style]\nramp = atlas\n", &["hill.toml:4:8:", "text must be in quotes", "write \"atlas\""]),
    ("[[camera]]\nname = \"x\n", &["hill.toml:4:10:", "no closing quote"]),
    ("[[camera]]\nname = 'x\n", &["hill.toml:4:10:", "no closing quote"]),
    ("[[road\n", &["hill.toml:3:", "unclosed"]),
    ("cell = 3 4\n", &["hill.toml:3:8:", "text must be in quotes"]),
    // many-byte characters and tabs before the place
    (
        "[style]\nlight = { \"名\" = 1, altitude = 0 }\n",
        &["hill.toml:4:11: error[unknown-key]: unknown key `名`", "hill.toml:4:31:"],
    ),
    ("[style]\n\thaze = -1\n", &["hill.toml:4:9:", "4 |     haze = -1\n  |            ^^"]),
];

#[test]
fn every_mistake_is_told_with_its_place_and_a_remedy() {
    for (rest, fragments) in BROKEN {
        let text = format!("{LEAST}{rest}");
        let shown = messages(&text);
        for fragment in *fragments {
            assert!(shown.contains(fragment), "no {fragment:?} in what is said of\n{text}\n---\n{shown}");
        }
        let errors = read(&text).expect_err("it is broken");
        let syntax = shown.contains("unclosed");
        assert!(syntax || errors.as_slice().iter().all(|error| error.help().is_some()), "no help:\n{shown}");
    }
}

#[test]
fn one_mistake_gives_one_message() {
    for (rest, _) in BROKEN.iter().filter(|(rest, _)| !rest.contains('名')) {
        let errors = read(&format!("{LEAST}{rest}")).expect_err("it is broken");
        assert_eq!(errors.as_slice().len(), 1, "of\n{rest}\n---\n{errors}");
    }
}

#[test]
fn all_mistakes_are_told_in_one_run_in_the_order_of_the_file() {
    let text = "color = 1\n[terrain]\ncell = -1\n[[road]]\nwidht = 3\nsurface = \"ice\"\n[[camera]]\n";
    let errors = read(text).expect_err("it is broken");
    let lines: Vec<usize> = errors.as_slice().iter().map(|error| error.position().line).collect();
    assert_eq!(lines, [1, 2, 3, 4, 5, 6, 7], "{errors}");
}

#[test]
fn a_duplicate_does_not_hide_other_mistakes() {
    let shown = messages("[terrain]\ndem = \"a\"\ndem = \"b\"\ncell = -1\n");
    assert!(shown.contains("hill.toml:3:1:") && shown.contains("hill.toml:4:8:"), "{shown}");
}

#[test]
fn a_scene_without_terrain_is_told_so() {
    let shown = messages("");
    assert!(
        shown.contains("hill.toml:1:1: error[missing-key]: the scene file has no [terrain] table"),
        "{shown}"
    );
    let shown = messages("[terain]\ndem = \"a\"\n");
    assert!(shown.contains("did you mean `terrain`?") && !shown.contains("has no"), "{shown}");
}

#[test]
fn a_scene_in_degrees_or_feet_is_refused() {
    let shown = messages(&format!("crs = \"EPSG:4326\"\n{LEAST}"));
    assert!(
        shown.contains("hill.toml:1:7:") && shown.contains("must be metric, but EPSG:4326 is in degrees"),
        "{shown}"
    );
    let feet = messages(&format!("crs = \"EPSG:2264\"\n{LEAST}"));
    assert!(feet.contains("must be metric, but a unit of EPSG:2264 is 0.3048"), "{feet}");
}

#[test]
fn later_rooms_can_point_at_a_value() {
    let document = read(COMPLETE).expect("a valid scene");
    let error = document.error(&document.terrain.dem, "no such file").with_help("check the name");
    let shown = error.to_string();
    assert!(shown.starts_with("hill.toml:7:7: error[wrong-value]: no such file\n"), "{shown}");
    assert!(
        shown.contains(
            "7 | dem = \"data/hill.tif\"\n  |       ^^^^^^^^^^^^^^^\n  |\n  = help: check the name"
        ),
        "{shown}"
    );
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_are_welcome() {
    let text = format!("\u{feff}{}", COMPLETE.replace('\n', "\r\n"));
    read(&text).unwrap_or_else(|errors| panic!("{errors}"));
    let shown = messages("\u{feff}color = 1\r\n[terrain]\r\ndem = \"a\"\r\n");
    assert!(shown.contains("hill.toml:1:1:") && shown.contains("1 | color = 1\n  | ^^^^^"), "{shown}");
}

#[test]
fn bytes_that_are_not_text_are_told_with_their_place() {
    let errors = parse_bytes("hill.toml", b"title = \"x\"\nsubtitle = \"\xff\"\n").expect_err("not UTF-8");
    assert!(
        errors.to_string().starts_with("hill.toml:2:13: error[syntax]: this is not UTF-8 text"),
        "{errors}"
    );
    assert!(parse_bytes("hill.toml", LEAST.as_bytes()).is_ok());
}

#[test]
fn too_much_is_refused() {
    assert!(messages(&" ".repeat(SCENE_BYTES.count() + 1)).contains("more than the 4194304 allowed"));
    let points = "[1,2],".repeat(100_001);
    let shown = messages(&format!("{LEAST}[[road]]\npoints = [{points}]\n"));
    assert!(
        shown.contains("100001 points are more than the 100000 allowed") && shown.len() < 1000,
        "{shown}"
    );
    let roads = "[[label]]\n".repeat(10_001);
    let shown = messages(&format!("{LEAST}{roads}"));
    assert!(shown.contains("hill.toml:3:3:") && shown.contains("10001 [[label]] tables"), "{shown}");
    let shown = messages(&format!("{LEAST}[style]\nhaze = {}1{}\n", "[".repeat(50_000), "]".repeat(50_000)));
    assert!(shown.contains("cannot recurse further"), "{shown}");
    let shown = messages(&format!("{LEAST}{}", "x = 1\n".repeat(500_000)));
    assert!(shown.contains("hill.toml:4:1:") && shown.len() < 1000, "{shown}");
    let shown = messages(&format!("{LEAST}{}", "x = \n".repeat(1000)));
    assert!(shown.contains("and 950 more errors"), "{shown}");
}

proptest::proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Some bytes of a good file replaced, removed or repeated: an answer, and messages that can be printed.
    #[test]
    fn no_mutation_of_a_scene_file_panics(
        edits in proptest::collection::vec((any::<proptest::sample::Index>(), 0u8..4, any::<u8>(), 0usize..40), 1..6)
    ) {
        let mut bytes = COMPLETE.as_bytes().to_vec();
        for (index, kind, byte, length) in edits {
            let at = index.index(bytes.len().max(1)).min(bytes.len());
            let end = (at + length).min(bytes.len());
            match kind {
                0 => bytes.splice(at..end, [byte]).for_each(drop),
                1 => drop(bytes.drain(at..end)),
                2 => bytes.splice(at..at, b"=[{\"'#\n,.1-"[usize::from(byte) % 11..][..1].to_vec()).for_each(drop),
                _ => {
                    let copy = bytes[at..end].to_vec();
                    bytes.splice(at..at, copy).for_each(drop);
                }
            }
        }
        if let Err(errors) = parse_bytes("hill.toml", &bytes) {
            proptest::prop_assert!(!errors.as_slice().is_empty());
            proptest::prop_assert!(errors.to_string().starts_with("hill.toml:"));
        }
    }
}

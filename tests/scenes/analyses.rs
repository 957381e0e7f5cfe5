//! Analyses that scenes state.

use std::fmt::Write;
use std::path::Path;

use sandtable_analysis::arguments::{AnalysisArguments, ArgumentValue};
use sandtable_analysis::outcome::{FeatureRole, OutcomeShape, PropertyValue};
use sandtable_analysis::run::run;
use sandtable_annotate::class_legend::LegendSwatch;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::StylePreset;
use sandtable_draw::list::{DepthLayer, DrawItem, FeatureId};
use sandtable_render::RenderBackend;
use sandtable_scene::land::land_of;
use sandtable_scene::planned_pictures::ElevationNeed;
use sandtable_scene::scene_file::{build_scene_text, open_scene, open_scene_for};
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::legend_overlay::overlay_entries;
use sandtable_sheet::picture::{DrawnView, PictureSize, draw_view};
use sandtable_terrain::stop_flag::StopFlag;

use crate::common::scratch::Scratch;

const SIZE: PictureSize = PictureSize { width: 960, height: 960 };

/// A plain of 2 km by 2 km that a ridge of 60 % slopes crosses from south to north, with the tables of `text` on it.
fn scene(text: &str) -> Result<SceneModel, String> {
    let folder = Scratch::new();
    let mut grid = "ncols 101\nnrows 101\nxllcenter 5000\nyllcenter 7000\ncellsize 20\n".to_owned();
    for row in 0..101_i32 {
        for column in 0..101_i32 {
            // Level ground would be water.
            let ridge = (160 - 12 * (column - 50).abs()).max(0);
            let _ = write!(grid, "{:.1} ", f64::from(ridge + 100) + 0.4 * f64::from(row));
        }
        grid.push('\n');
    }
    folder.write("ground.asc", &grid);
    let text = format!("[terrain]\ndem = \"ground.asc\"\n{text}");
    let path = folder.write("scene.toml", &text);
    build_scene_text(&path, &text, &[], &|_| ()).map_err(|error| {
        let findings = error.findings();
        let said = |finding: &sandtable_description::finding::Finding| {
            format!("{}\n{:?}", finding.message, finding.help)
        };
        findings.iter().map(said).collect::<Vec<_>>().join("\n")
    })
}

fn drawn(scene: &SceneModel) -> DrawnView {
    let view = scene.cameras.first().expect("a camera");
    draw_view(scene, view, SIZE, RenderBackend::Cpu, &|_| ()).expect("a picture")
}

const PLAN: &str = "[[camera]]\nname = \"plan\"\nprojection = \"plan\"\n[furniture]\nlayout = \"none\"\n";

const OBSTACLES: &str = "[[analysis]]\nkind = \"obstacles\"\nvehicle = \"tracked\"\n";

#[test]
fn a_scene_has_the_bits_that_the_functions_of_the_kinds_give() {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/obstacles.toml");
    let scene = open_scene(&path, &[], &|_| ()).expect("a sound scene");
    let analysis = &scene.analyses[0];
    let arguments = AnalysisArguments::new(analysis.kind).with("vehicle", ArgumentValue::Word("tank".into()));
    let land = land_of(&scene, analysis.kind.layers);
    let outcome = run(&land, &arguments, &StopFlag::default()).expect("an outcome");
    let [own, found] =
        [&analysis.outcome, &outcome].map(|outcome| outcome.raster.as_ref().expect("a raster"));
    assert_eq!(own.values, found.values);
    assert_eq!(analysis.outcome.figures, outcome.figures);
    // All three classes are there, and the scene's own vehicle is meant.
    assert!(outcome.figures.iter().all(|figure| figure.value > 0.0), "{:?}", outcome.figures);
}

#[test]
fn within_an_extent_values_are_those_of_the_whole() {
    let whole = scene(OBSTACLES).expect("a sound scene");
    let part = scene(&format!("{OBSTACLES}extent = [[5800, 7200], [6400, 7600]]\n")).expect("a sound scene");
    let [whole, part] = [&whole, &part].map(|scene| &scene.analyses[0]);
    assert_eq!((part.ground.columns(), part.ground.rows()), (31, 21));
    let values = |of: &sandtable_scene::analyses::SceneAnalysis| {
        of.outcome.raster.as_ref().map(|raster| raster.values.clone())
    };
    let (whole_values, part_values) = (values(whole).expect("a raster"), values(part).expect("a raster"));
    for post in part.ground.posts() {
        let in_whole = post.offset(40, 10);
        assert_eq!(
            part_values.value(part.ground.index(post)).to_bits(),
            whole_values.value(whole.ground.index(in_whole)).to_bits()
        );
    }
}

#[test]
fn an_analysis_lies_under_water_and_roads_and_over_what_covers_the_ground() {
    let tables = "[[area]]\ncover = \"forest\"\npoints = [[5100, 7100], [5900, 7100], [5900, 7900]]\n\
                  [[road]]\nwidth = 30\npoints = [[5100, 8000], [6900, 8000]]\n";
    let scene = scene(&format!("{OBSTACLES}{tables}{PLAN}")).expect("a sound scene");
    let drawn = drawn(&scene);
    let place = |of: &dyn Fn(&DrawItem) -> bool| drawn.drawn.list.items.iter().position(of);
    let feature = scene.analyses[0].feature;
    let tint = place(&|item| item.feature == feature && item.layer == DepthLayer::Draped(0)).expect("a tint");
    let kind = |item: &DrawItem| item.feature.index().and_then(|index| scene.features.get(index));
    let is = |noun: &'static str| move |item: &DrawItem| kind(item).is_some_and(|of| of.kind.noun(1) == noun);
    assert!(place(&is("area")).expect("an area") < tint);
    assert!(place(&is("road")).expect("a road") > tint);
    let layers: Vec<DepthLayer> = drawn.drawn.list.items.iter().map(|item| item.layer).collect();
    assert!(layers.is_sorted());
}

/// The share of black pixels of an analysis where `is_there`, by the place of the pixel across the picture.
fn black_share(drawn: &DrawnView, feature: FeatureId, is_there: impl Fn(f64) -> bool) -> f64 {
    let (width, pixels) = (drawn.picture.pixels.width() as usize, drawn.picture.pixels.data());
    let there = (0..pixels.len()).filter(|at| is_there((at % width) as f64 / width as f64));
    let (mut count, mut black) = (0, 0);
    for at in there {
        count += 1;
        black += usize::from(drawn.picture.features[at] == feature && pixels[at].0[0] < 60);
    }
    f64::from(black as u32) / f64::from(count)
}

#[test]
fn in_black_on_white_severely_restricted_ground_is_hatched_and_open_ground_is_not() {
    let scene = scene(&format!("{OBSTACLES}{PLAN}[style]\npreset = \"print\"\n")).expect("a sound scene");
    assert_eq!(scene.preset, Some(StylePreset::Print));
    let (drawn, feature) = (drawn(&scene), scene.analyses[0].feature);
    // The ridge is as wide as a quarter of the ground.
    let on_ridge = black_share(&drawn, feature, |x| (0.42..0.58).contains(&x));
    let beside = black_share(&drawn, feature, |x| (0.05..0.3).contains(&x));
    assert!(on_ridge > 0.08 && on_ridge < 0.5, "{on_ridge}");
    assert!(beside < 0.001, "{beside}");
    let entries = overlay_entries(&scene, &drawn.picture);
    assert!(entries.iter().any(|entry| matches!(entry.swatch, LegendSwatch::Pattern(_))), "{entries:?}");
}

#[test]
fn relief_shows_through_a_tint() {
    let shaded = scene(&format!("{OBSTACLES}{PLAN}[style]\npreset = \"military\"\n")).expect("a sound scene");
    let drawn = drawn(&shaded);
    let (width, height) = (drawn.picture.pixels.width(), drawn.picture.pixels.height());
    // The slopes toward the light and away from it, at the same height, both severely restricted.
    let mean = |from: f64, to: f64| {
        let columns = (from * f64::from(width)) as u32..(to * f64::from(width)) as u32;
        let rows = height * 2 / 5..height * 3 / 5;
        let lights = columns.flat_map(|x| rows.clone().map(move |y| (x, y)));
        let lights: Vec<f32> = lights.map(|(x, y)| drawn.picture.pixels.at(x, y).linear().y).collect();
        lights.iter().sum::<f32>() / lights.len() as f32
    };
    let (lit, shade) = (mean(0.43, 0.48), mean(0.52, 0.57));
    assert!(lit > shade * 1.3, "{lit} {shade}");
}

#[test]
fn a_phase_has_the_analyses_that_state_it() {
    let folder = Scratch::new();
    folder.write(
        "ground.asc",
        "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n2 3 4\n3 4 5\n",
    );
    let text = "[[phase]]\nname = \"a\"\n[[phase]]\nname = \"b\"\n[terrain]\ndem = \"ground.asc\"\n\
                [[analysis]]\nkind = \"slope\"\nphases = [\"b\"]\n[[analysis]]\nkind = \"aspect\"\n";
    let path = folder.write("scene.toml", text);
    let kinds = |phase: &str| -> Vec<&str> {
        let scene = open_scene_for(&path, &[], Some(phase), ElevationNeed::AllThatFit, &|_| ());
        scene.expect("a sound scene").analyses.iter().map(|analysis| analysis.kind.name).collect()
    };
    assert_eq!(kinds("a"), ["aspect"]);
    assert_eq!(kinds("b"), ["slope", "aspect"]);
}

#[test]
fn cut_and_fill_between_two_phases_is_the_earth_that_one_of_them_moves() {
    let folder = Scratch::new();
    let row = |row: i32| (0..41).map(|column| format!("{} ", 100 + column + row)).collect::<String>() + "\n";
    let grid: String = (0..41).map(row).collect();
    folder.write("ground.asc", format!("ncols 41\nnrows 41\nxllcenter 0\nyllcenter 0\ncellsize 5\n{grid}"));
    let text = "[[phase]]\nname = \"before\"\n[[phase]]\nname = \"after\"\n[terrain]\ndem = \"ground.asc\"\n\
                [[earthwork]]\nkind = \"crater\"\npoints = [[100, 100]]\nradius = 20\nphases = [\"after\"]\n\
                [[analysis]]\nkind = \"cut-fill\"\nagainst = \"phase:before\"\n";
    let path = folder.write("scene.toml", text);
    let figures = |phase: &str| -> Vec<f64> {
        let scene = open_scene_for(&path, &[], Some(phase), ElevationNeed::AllThatFit, &|_| ());
        let scene = scene.expect("a sound scene");
        scene.analyses[0].outcome.figures.iter().map(|figure| figure.value).collect()
    };
    assert_eq!(figures("before"), [0.0, 0.0, 0.0]);
    assert!(figures("after")[0] > 100.0, "{:?}", figures("after"));
    let missing = text.replace("phase:before", "phase:befor");
    let path = folder.write("missing.toml", missing);
    let said = open_scene(&path, &[], &|_| ()).err().expect("no such phase");
    let said = format!("{:?}", said.findings());
    assert!(said.contains("befor") && said.contains("before"), "{said}");
}

#[test]
fn walls_and_trenches_of_a_scene_stop_vehicles_and_fences_do_not() {
    let share = |kind: &str| {
        let line =
            format!("[[fence]]\nkind = \"{kind}\"\nwidth = 3\npoints = [[5100, 7300], [5300, 7300]]\n");
        let of_truck = OBSTACLES.replace("tracked", "truck");
        let scene = scene(&format!("{of_truck}{line}")).expect("a sound scene");
        let outcome = &scene.analyses[0].outcome;
        outcome.figures.iter().find(|figure| figure.name == "severely restricted").expect("a figure").value
    };
    let bare = share("boundary");
    assert!(share("wall") > bare + 0.003 && share("trench") > bare + 0.003, "{bare} {}", share("wall"));
    assert_eq!(share("fence"), bare);
}

#[test]
fn a_route_states_its_way_points_and_its_march_table() {
    let route = "[[analysis]]\nname = \"Red\"\nkind = \"route\"\nvehicle = \"foot\"\nfrom = [5100, 7100]\n\
                 via = [[5500, 8000]]\nto = [5900, 8900]\n";
    let scene = scene(route).expect("a sound scene");
    let outcome = &scene.analyses[0].outcome;
    let roles: Vec<FeatureRole> = outcome.features.iter().map(|feature| feature.role).collect();
    assert_eq!(roles[0], FeatureRole::Route);
    assert_eq!(roles.iter().filter(|role| **role == FeatureRole::Place).count(), 3);
    let OutcomeShape::Line(line) = &outcome.features[0].shape else { panic!("{:?}", outcome.features[0]) };
    assert_eq!(line.first().map(|at| at.to_array()), Some([5100.0, 7100.0]));
    let table = &outcome.tables[0];
    assert_eq!(table.rows.len(), 3);
    let km = |row: &Vec<PropertyValue>| match row[1] {
        PropertyValue::Number(km) => km,
        _ => f64::NAN,
    };
    assert!((km(&table.rows[0]) + km(&table.rows[1]) - km(&table.rows[2])).abs() < 1e-9);
}

#[test]
fn ground_that_no_earthworks_touch_is_neither_cut_nor_filled() {
    // The scene's roads need posts between the measured ones.
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/cut.toml");
    let text = "include = \"earthworks.toml\"\n[[analysis]]\nkind = \"cut-fill\"\nagainst = \"source\"\n";
    let scene = build_scene_text(&path, text, &[], &|_| ()).expect("a sound scene");
    let analysis = &scene.analyses[0];
    let raster = analysis.outcome.raster.as_ref().expect("a raster");
    assert!(analysis.ground.doublings() > 0);
    let (mut far, mut near) = (0.0_f32, 0.0_f32);
    for post in analysis.ground.posts() {
        let value = raster.values.value(analysis.ground.index(post)).abs();
        let is_far = analysis.ground.map_position(post).y > 400.0;
        let most = if is_far { &mut far } else { &mut near };
        *most = most.max(value);
    }
    assert!(far < 1e-4 && near > 5.0, "{far} {near}");
}

#[test]
fn what_an_analysis_does_not_know_is_a_note_at_its_kind() {
    let scene = scene("[[analysis]]\nkind = \"obstacles\"\nvehicle = \"foot\"\n").expect("a sound scene");
    let notes: Vec<_> =
        scene.findings.iter().filter(|finding| finding.code == FindingCode::AnalysisLimited).collect();
    assert!(notes[0].message.contains("nothing is known of"), "{notes:?}");
}

#[test]
fn errors_name_the_key_and_what_to_write() {
    let wrong = |table: &str, wanted: &[&str]| {
        let said = scene(table).err().unwrap_or_else(|| panic!("{table} is sound"));
        for text in wanted {
            assert!(said.contains(text), "{table}: {text} is not in {said}");
        }
    };
    wrong("[[analysis]]\nkind = \"slop\"\n", &["`kind`", "slope"]);
    wrong(
        "[[analysis]]\nkind = \"slope\"\nvehicle = \"foot\"\n",
        &["`vehicle` has no effect", "slope knows"],
    );
    wrong("[[analysis]]\nkind = \"time\"\nvehicle = \"foot\"\n", &["needs the key `from`"]);
    wrong("[[analysis]]\nkind = \"slope\"\nunit = \"degree\"\n", &["`unit`", "degrees"]);
    wrong("[[analysis]]\nkind = \"obstacles\"\nvehicle = \"tanc\"\n[vehicle.tank]\n", &["`tanc`", "`tank`"]);
    wrong("[vehicle.tank]\nslope_up_percent = [45, 30]\n", &["slope_up_percent", "ends below"]);
    wrong("[vehicle.tank]\nspeed_kmh = 0\n", &["speed_kmh", "0.1"]);
    wrong("[vehicle.tank]\nroad_speed_kmh = [30, 40]\n", &["road_speed_kmh", "2 speeds"]);
    wrong("[vehicle.tank]\nroad_speed_kmh = [0, 0.01, 40, 40, 40]\n", &["road_speed_kmh", "0.01"]);
    wrong("[vehicle.tank]\nwight_m = 3\n", &["wight_m", "width_m"]);
    wrong(
        "[[analysis]]\nkind = \"time\"\nvehicle = \"foot\"\nfrom = [5100, 7100]\nclasses_min = [10, 5]\n",
        &["classes_min", "rise"],
    );
    wrong("[[analysis]]\nkind = \"time\"\nvehicle = \"foot\"\nfrom = [1, 1]\n", &["off the elevation model"]);
    wrong(&format!("{OBSTACLES}extent = [[0, 0], [10, 10]]\n"), &["`extent`", "off the land"]);
    wrong(
        "[[analysis]]\nkind = \"route\"\nvehicle = \"truck\"\nfrom = [5100, 8000]\nto = [6900, 8000]\n",
        &["`to`"],
    );
    wrong("[[analysis]]\nkind = \"cut-fill\"\nagainst = \"none.tif\"\n", &["none.tif"]);
}

#[test]
fn posts_that_two_analyses_number_alike_have_letters_on_the_ground_and_in_tables() {
    let viewsheds = |posts: &str, show: &str| {
        format!("[[analysis]]\nkind = \"viewsheds\"\nposts = {posts}\nshow = \"{show}\"\n")
    };
    let (two, one) = ("[[5400, 7900], [5500, 8200]]", "[[6500, 8000]]");
    let names = |scene: &SceneModel| -> Vec<Vec<String>> {
        let of = |features: &[sandtable_analysis::outcome::OutcomeFeature]| {
            features.iter().map(|feature| feature.name.clone()).collect()
        };
        scene.analyses.iter().map(|analysis| of(&analysis.outcome.features)).collect()
    };
    let both = scene(&(viewsheds(two, "first") + &viewsheds(one, "count"))).expect("sound");
    assert_eq!(names(&both), [vec!["A1", "A2"], vec!["B1"]]);
    for (analysis, features) in both.analyses.iter().zip(names(&both)) {
        let cells = analysis.outcome.tables[0].written_rows().map(|row| row[0].clone());
        assert_eq!(cells.collect::<Vec<_>>(), features, "the tables name what the picture shows");
        let figures = &analysis.outcome.figures;
        assert_eq!(figures[0].name, format!("seen from post {}", features[0]));
    }
    let classes = &both.analyses[0].outcome.raster.as_ref().expect("a raster").classes;
    assert_eq!(classes[1].label, "post A1");
    let counted = &both.analyses[1].outcome.raster.as_ref().expect("a raster").classes;
    assert_eq!(counted[1].label, "seen by 1", "a count is no name");
    let alone = scene(&viewsheds(two, "first")).expect("sound");
    assert_eq!(names(&alone), [["1", "2"]]);
    let unseen = scene(&(viewsheds(two, "first") + &viewsheds(one, "count") + "draw = \"nothing\"\n"));
    assert_eq!(names(&unseen.expect("sound")), [vec!["1", "2"], vec!["1"]], "marks that no picture shows");
}

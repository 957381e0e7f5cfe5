//! Tactical graphics and layers of sight in scenes.

use std::fmt::Write;
use std::path::Path;

use glam::{DVec2, Vec3};
use sandtable_description::parse::parse_bytes;
use sandtable_draw::list::{DepthLayer, FeatureId};
use sandtable_picture::{ViewDraw, build_draw_list};
use sandtable_ribbon::drape::check_clearance;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;
use sandtable_symbology::graphic::kind::{GraphicKind, GraphicShape, MOST_POINTS};
use sandtable_symbology::graphic::kind_table::GRAPHIC_KINDS;
use sandtable_symbology::graphic::rules::{NUMBER_MEANINGS, POINT_MEANINGS};
use sandtable_terrain::sight::viewshed::{PostVisibility, viewshed};

use crate::common::forest::seen_from;
use crate::common::golden::is_blessing;
use crate::common::scratch::Scratch;

/// What is draped is off the displayed triangles by no more than rounding, meters.
const CLEARANCE_M: f64 = 0.01;

/// Rolling ground of 20 km by 20 km with the tables of `text` on it.
fn scene(text: &str) -> Result<SceneModel, String> {
    scene_with(text, "")
}

/// The same, with `features` in a file `graphics.geojson` beside the scene.
fn scene_with(text: &str, features: &str) -> Result<SceneModel, String> {
    let folder = Scratch::new();
    folder.write(
        "graphics.geojson",
        format!("{{\"type\": \"FeatureCollection\", \"features\": [{features}]}}"),
    );
    let mut grid = "ncols 101\nnrows 101\nxllcenter 0\nyllcenter 0\ncellsize 200\n".to_owned();
    for row in 0..101 {
        for column in 0..101 {
            let height =
                300.0 + 90.0 * libm::sin(f64::from(column) * 0.21) * libm::cos(f64::from(row) * 0.17);
            let _ = write!(grid, "{height:.1} ");
        }
        grid.push('\n');
    }
    folder.write("ground.asc", &grid);
    let text = format!("[terrain]\ndem = \"ground.asc\"\n{text}");
    let path = folder.write("scene.toml", &text);
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&path, &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

fn drawn(scene: &SceneModel) -> ViewDraw {
    let camera = seen_from(scene, Vec3::new(10e3, -9e3, 12e3), Vec3::new(10e3, 9e3, 300.0), (1280, 720));
    build_draw_list(scene, &camera, &|_| ())
}

/// Points in a cell of 700 m that fit a kind.
fn points_of(kind: &GraphicKind, corner: DVec2) -> String {
    let ring: &[[f64; 2]] = &[[0.0, 0.0], [1.2, 0.0], [1.2, 1.0], [0.0, 1.1]];
    let axis: &[[f64; 2]] = &[[1.3, 0.6], [0.6, 0.4], [0.0, 0.6], [1.1, 0.9]];
    let line: &[[f64; 2]] = &[[0.0, 0.2], [0.6, 0.6], [1.3, 0.5]];
    let figure: &[[f64; 2]] = &[[0.0, 1.0], [0.0, 0.2], [1.2, 0.7], [1.3, 0.1], [0.9, 0.4], [0.8, 0.1]];
    let points = match kind.shape {
        GraphicShape::Area => ring,
        GraphicShape::Axis | GraphicShape::Wide => axis,
        GraphicShape::Line => line,
        GraphicShape::Corridor => &line[..kind.points[1].min(3)],
        _ => &figure[..kind.points[0]],
    };
    let places = points.iter().map(|&at| corner + DVec2::from(at) * 470.0);
    let places: Vec<String> = places.map(|at| format!("[{:.0}, {:.0}]", at.x, at.y)).collect();
    format!("[{}]", places.join(", "))
}

#[test]
fn every_graphic_lies_in_the_displayed_triangles_and_shows() {
    let mut text = String::new();
    for (index, kind) in GRAPHIC_KINDS.iter().enumerate() {
        let corner = DVec2::new((index % 27) as f64, (index / 27) as f64) * 700.0 + 250.0;
        let points = points_of(kind, corner);
        let _ =
            writeln!(text, "[[graphic]]\nkind = \"{}\"\npoints = {points}\ndesignation = \"A\"", kind.word);
        let numbers = match kind.shape {
            GraphicShape::Corridor => "width = 150",
            GraphicShape::Circle => "distances = [150, 250]",
            GraphicShape::Sector if kind.rule == "POINT18" => "distances = [150, 250]\nazimuths = [10, 80]",
            GraphicShape::Sector => "distances = [150, 250]\nazimuths = [10, 80, 20, 70]",
            GraphicShape::Ellipse => "distances = [250, 150]\nazimuths = [10]",
            _ => "",
        };
        let _ = writeln!(text, "{numbers}");
    }
    let scene = scene(&text).expect("a scene with every graphic");
    assert_eq!(scene.graphics.len(), GRAPHIC_KINDS.len());
    let shot = drawn(&scene);
    shot.list.check().expect("a sound draw list");
    for graphic in &scene.graphics {
        let mut items = shot.list.items.iter().filter(|item| item.feature == graphic.feature);
        assert!(items.any(|item| !item.triangles.is_empty()), "{} does not show", graphic.kind.word);
    }
    for item in shot.list.items.iter().filter(|item| matches!(item.layer, DepthLayer::Draped(_))) {
        let mesh = &shot.list.meshes[item.mesh.0 as usize];
        let clearance_m = check_clearance(mesh, &*shot.displayed);
        assert!(clearance_m < CLEARANCE_M, "{clearance_m}");
    }
}

#[test]
fn a_graphic_that_does_not_fit_its_rule_is_refused_with_place_and_remedy() {
    let cases = [
        ("kind = \"block\"\npoints = [[0, 0], [900, 0]]", "block has 2 points and needs 3"),
        ("kind = \"phase_lin\"\npoints = [[0, 0], [900, 0]]", "did you mean `phase_line`?"),
        ("kind = \"phase_line\"\npoints = [[0, 0], [0.2, 0]]", "points 1 and 2"),
        (
            "kind = \"objective\"\npoints = [[0, 0], [900, 900], [900, 0], [0, 900]]",
            "crosses itself between points 1 and 2, and 3 and 4",
        ),
        ("kind = \"circular_target\"\npoints = [[900, 900]]", "has no `distances`"),
        ("kind = \"air_corridor\"\npoints = [[0, 0], [900, 900]]", "has no `width`"),
        ("sidc = \"10031000001211000000\"\npoints = [[900, 900]]", "use `[[symbol]]` for it"),
        ("sidc = \"10032500009999990000\"\npoints = [[900, 900]]", "999999"),
        ("points = [[900, 900]]", "neither `kind` nor `sidc`"),
    ];
    for (table, expected) in cases {
        let error = scene(&format!("[[graphic]]\n{table}\n")).map(|_| ()).expect_err(table);
        assert!(error.contains(expected), "{table}: {error}");
        assert!(error.contains("scene.toml:"), "{error}");
    }
    let many: Vec<String> = (0..=MOST_POINTS).map(|index| format!("[{index}, 0]")).collect();
    let table = format!("[[graphic]]\nkind = \"phase_line\"\npoints = [{}]\n", many.join(", "));
    assert!(scene(&table).is_err(), "more points than are checked for crossings");
}

#[test]
fn a_code_gives_the_kind_the_side_the_status_and_the_echelon() {
    let text = "[[graphic]]\nsidc = \"10062510181101000000\"\npoints = [[1000, 1000], [9000, 1200]]\n";
    let scene = scene(text).expect("a boundary");
    let graphic = &scene.graphics[0];
    assert_eq!((graphic.kind.word, graphic.fields.echelon.as_str()), ("boundary", "X"));
    let words = (format!("{:?}", graphic.side), format!("{:?}", graphic.status));
    assert_eq!(words, ("Hostile".to_owned(), "Planned".to_owned()));
}

#[test]
fn an_axis_is_taken_from_start_to_tip_with_a_width_or_by_the_standard() {
    let start = "[2000, 2000], [6000, 3000], [9000, 7000]";
    let tip = "[9000, 7000], [6000, 3000], [2000, 2000]";
    let forms = [
        format!("width = 1000\npoints = [{start}]"),
        format!("width = 1000\norder = \"standard\"\npoints = [{tip}]"),
        format!("order = \"drawn\"\npoints = [{start}, [8400, 7400]]"),
        format!("points = [{tip}, [8400, 7400]]"),
    ];
    for form in forms {
        let scene = scene(&format!("[[graphic]]\nkind = \"axis_main_attack\"\n{form}\n")).expect("an axis");
        assert_eq!(scene.graphics[0].points[0], DVec2::new(9000.0, 7000.0), "{form}");
    }
    let arrow =
        format!("[[graphic]]\nkind = \"main_direction_of_attack\"\norder = \"drawn\"\npoints = [{start}]\n");
    assert_eq!(scene(&arrow).expect("an arrow").graphics[0].points[0], DVec2::new(9000.0, 7000.0));
    let wrong = [
        (
            format!("kind = \"axis_main_attack\"\npoints = [{start}, [8400, 7400]]"),
            "lies beside point 3 and not beside point 1",
        ),
        (
            format!("kind = \"phase_line\"\norder = \"drawn\"\npoints = [{start}]"),
            "`order` has no effect on phase_line",
        ),
        (
            "kind = \"seize\"\npoints = [[0, 0], [900, 0]]".to_owned(),
            "1 the middle of the circle, 2 a place on it",
        ),
    ];
    for (table, expected) in wrong {
        let error = scene(&format!("[[graphic]]\n{table}\n")).map(|_| ()).expect_err(&table);
        assert!(error.contains(expected), "{table}: {error}");
    }
}

#[test]
fn graphics_of_a_file_have_their_numbers_from_properties() {
    let feature = |properties: &str, shape: &str, places: &str| {
        format!(
            "{{\"type\": \"Feature\", \"properties\": {{{properties}}}, \"geometry\": {{\"type\": \"{shape}\", \
             \"coordinates\": {places}}}}}"
        )
    };
    let text = "crs = \"EPSG:32616\"\n[[graphic]]\nfile = \"graphics.geojson\"\ncrs = \"EPSG:32616\"\n";
    let features = [
        feature(
            "\"sidc\": \"10032500001514030000\", \"width\": 800, \"unique_designation\": \"IRON\"",
            "LineString",
            "[[2000, 2000], [6000, 3000], [9000, 7000]]",
        ),
        feature(
            "\"kind\": \"launch_area\", \"distances\": \"800, 300\", \"azimuths\": 45",
            "Point",
            "[9000, 9000]",
        ),
        feature("\"kind\": \"45110301\"", "LineString", "[[2000, 9000], [6000, 9500]]"),
    ];
    let scene = scene_with(text, &features.join(",")).expect("three graphics");
    let axis = &scene.graphics[0];
    assert_eq!((axis.width_m, axis.fields.designation.as_str()), (Some(800.0), "IRON"));
    assert_eq!(axis.points[0], DVec2::new(9000.0, 7000.0), "from start to tip");
    let fields = &scene.graphics[1].fields;
    assert_eq!(
        (fields.distances_m.as_slice(), fields.azimuths_deg.as_slice()),
        (&[800.0, 300.0][..], &[45.0][..])
    );
    assert_eq!(scene.graphics[2].kind.word, "cold_front");
    let wrong = feature("\"kind\": \"launch_area\", \"distances\": \"wide\"", "Point", "[9000, 9000]");
    let error = scene_with(text, &wrong).map(|_| ()).expect_err("no number");
    assert!(error.contains("the property `distances` lists 'wide'"), "{error}");
}

#[test]
fn areas_of_the_hostile_side_are_marked_and_weather_has_its_colors() {
    let square = "[[2000, 2000], [6000, 2000], [6000, 6000], [2000, 6000]]";
    let text = format!(
        "[[graphic]]\nsidc = \"10062500001517000000\"\npoints = {square}\n[[graphic]]\nsidc = \
         \"10034500001103120000\"\npoints = [[2000, 9000], [9000, 9000]]\n[[graphic]]\nkind = \"bottom_clay\"\npoints = \
         [[9000, 2000], [12000, 2000], [12000, 6000]]\n"
    );
    let scene = scene(&text).expect("an objective, a front and clay");
    assert_eq!(scene.graphics[0].fields.hostile, "ENY");
    let shot = drawn(&scene);
    let marks = shot.graphic_texts.iter().filter(|text| text.text == "ENY").count();
    assert_eq!(marks, 2, "on two sides");
    let colors = |graphic: usize| -> Vec<[u8; 4]> {
        let feature = scene.graphics[graphic].feature;
        let items =
            shot.list.items.iter().filter(|item| item.feature == feature && !item.triangles.is_empty());
        items.map(|item| shot.list.materials[item.material.0 as usize].base_color.0).collect()
    };
    let front = colors(1);
    assert!(front.contains(&[255, 0, 0, 255]) && front.contains(&[0, 0, 255, 255]), "{front:?}");
    assert!(colors(2).contains(&[100, 130, 255, 110]), "{:?}", colors(2));
}

#[test]
fn a_line_is_as_wide_on_the_picture_near_as_far() {
    let text = "[[graphic]]\nkind = \"light_line\"\npoints = [[10000, 200], [10000, 19000]]\n";
    let scene = scene(text).expect("a line");
    let camera = seen_from(&scene, Vec3::new(10e3, -9e3, 12e3), Vec3::new(10e3, 9e3, 300.0), (1280, 720));
    let picture = sandtable_render::cpu::render(
        &build_draw_list(&scene, &camera, &|_| ()).list,
        &camera,
        &sandtable_render::cpu::RenderQuality::default(),
    )
    .expect("a picture");
    let line = scene.graphics[0].feature;
    let width = picture.pixels.width() as usize;
    let widths: Vec<usize> = picture
        .features
        .chunks_exact(width)
        .map(|row| row.iter().filter(|feature| **feature == line).count())
        .filter(|&count| count > 0)
        .collect();
    assert!(widths.len() > 150, "{}", widths.len());
    // 5 pixels of a picture 1080 lines high are 3.3 of this one.
    let usual = widths.iter().filter(|&&count| (2..=5).contains(&count)).count();
    assert!(usual * 20 > widths.len() * 19, "{widths:?}");
}

#[test]
fn a_viewshed_of_two_observers_is_what_either_sees() {
    let text =
        "[[viewshed]]\nobservers = [[5000, 5000], [14000, 12000]]\nobserver_height = 5\nrange = 6000\n";
    let scene = scene(text).expect("a viewshed");
    let layer = &scene.sight.viewsheds[0];
    let seen = layer.seen(&scene.lattice).expect("observers on the ground");
    let alone: Vec<_> = layer
        .observers
        .iter()
        .map(|options| viewshed(&scene.lattice, options).expect("an observer on the ground"))
        .collect();
    for (index, post) in seen.viewshed.posts.iter().enumerate() {
        let either = alone.iter().any(|one| one.posts[index] == PostVisibility::Visible);
        assert_eq!(*post == PostVisibility::Visible, either, "post {index}");
    }
    let shot = drawn(&scene);
    shot.list.check().expect("a sound draw list");
    let tint =
        shot.list.items.iter().find(|item| shot.list.materials[item.material.0 as usize].name == "tint");
    let mesh = &shot.list.meshes[tint.expect("a tint").mesh.0 as usize];
    assert!(check_clearance(mesh, &*shot.displayed) < CLEARANCE_M);
    assert_eq!(tint.map(|item| item.feature), Some(FeatureId(2)));
}

#[test]
fn layers_of_sight_off_the_ground_are_refused_by_their_place() {
    for table in [
        "[[viewshed]]\nobservers = [[5000, 5000], [99000, 0]]",
        "[[sight]]\nobserver = [5000, 5000]\ntargets = [[-9000, 5000]]",
        "[[range]]\nat = [99000, 5000]\ndistances = [100]",
    ] {
        let error = scene(&format!("{table}\n")).map(|_| ()).expect_err(table);
        assert!(error.contains("lies off the elevation model"), "{error}");
    }
    let error =
        scene("[[range]]\nat = [9000, 5000]\ndistances = [200, 100]\n").map(|_| ()).expect_err("falls");
    assert!(error.contains("100 follows 200"), "{error}");
}

#[test]
fn every_observer_target_and_place_off_the_ground_is_told_by_its_own_place() {
    let text = "[[viewshed]]\nobservers = [[5000, 5000], [99000, 0], [6000, 6000], [0, 77000]]\n\
                [[sight]]\nobserver = [-5000, 5000]\ntargets = [[5000, 5000], [-9000, 5000],\n[9000, -50]]\n\
                [[range]]\nat = [99000, 5000]\ndistances = [200, 100]\n";
    let error = scene(text).map(|_| ()).expect_err("off the ground");
    for told in [
        "scene.toml:4:28: ",
        "scene.toml:4:54: ",
        "scene.toml:6:12: ",
        "scene.toml:7:26: ",
        "scene.toml:8:1: ",
        "scene.toml:10:6: ",
        "100 follows 200",
    ] {
        assert!(error.contains(told), "{told} in {error}");
    }
    assert_eq!(error.matches("lies off the elevation model").count(), 6, "{error}");
}

/// The part of `scenes/SYMBOLS.md` on graphics.
fn graphics_page() -> String {
    let mut page = String::from(
        "<!-- graphics -->\n\n## Tactical graphics\n\nWhat `[[graphic]]` draws of symbol set 25 (control measures) and of 45 \
         and 46 (lines and areas of weather and sea). `kind` takes\nthe word, or the code of set 25. The draw rule is that of \
         MIL-STD-2525D (2014), appendix H, or of 2525E, which is the source of\nevery row: it says where the points go, in \
         which order; the table of rules follows. Areas of the hostile side are marked `ENY`.\nFields: T `designation`, T1 `designation_2`, B `echelon`, AS `country`, N \
         `hostile`, H `further`, V `type`, C `quantity`, Y `location`, Q `direction`, AP `target`, W `from`, W1 `until`, X\n`elevations`, AM `distances`, AN `azimuths`.\n\n| code | \
         kind | name | rule | points | fields |\n|---|---|---|---|---|---|\n",
    );
    let mut set = 25;
    for kind in GRAPHIC_KINDS {
        if kind.set != set {
            set = kind.set;
            let title = if set == 45 { "Weather" } else { "Sea" };
            let _ = write!(
                page,
                "\n### {title}: symbol set {set}\n\n| code | kind | name | rule | points | fields |\n|---|---|---|---|---|---|\n"
            );
        }
        let points = match kind.points {
            [least, most] if least == most => least.to_string(),
            [least, MOST_POINTS] => format!("{least} or more"),
            [least, most] => format!("{least} to {most}"),
        };
        let GraphicKind { word, code, name, rule, fields, .. } = kind;
        let _ = writeln!(
            page,
            "| {code} | `{word}` | {name} | {rule} | {points} | {} |",
            fields.replace(' ', ", ")
        );
    }
    let _ = write!(page, "\n### Draw rules\n\n| rule | its points |\n|---|---|\n");
    for (rule, meaning) in POINT_MEANINGS.iter().chain(&NUMBER_MEANINGS) {
        let _ = writeln!(page, "| {rule} | {meaning} |");
    }
    let set = include_str!("../symbology/set_25.txt");
    let rows = set.lines().filter_map(|line| line.split_once(' ')).filter(|(code, _)| *code != "#");
    let missing: Vec<String> = rows
        .filter(|(code, _)| GraphicKind::of_code(25, code).is_none())
        .map(|(code, name)| format!("{code} {name}"))
        .collect();
    let _ = write!(
        page,
        "\n{} kinds are drawn. Of symbol set 25 {}.\n\n<!-- end of graphics -->\n",
        GRAPHIC_KINDS.len(),
        if missing.is_empty() {
            "nothing is missing".to_owned()
        } else {
            format!("these are not: {}", missing.join("; "))
        }
    );
    page
}

#[test]
fn the_page_of_symbols_lists_every_graphic() {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/SYMBOLS.md");
    let page = std::fs::read_to_string(&path).unwrap_or_else(|_| "# Symbols and graphics\n\n".to_owned());
    let wanted = graphics_page();
    let (head, rest) = page.split_once("<!-- graphics -->").unwrap_or((&page, ""));
    let tail = rest.split_once("<!-- end of graphics -->\n").map_or("", |(_, tail)| tail);
    let made = format!("{head}{wanted}{tail}");
    if is_blessing() {
        std::fs::write(&path, made).expect("the page is writable");
    } else {
        assert!(
            made == page,
            "SANDTABLE_BLESS=1 cargo test --test scenes page_of_symbols makes the page anew"
        );
    }
}

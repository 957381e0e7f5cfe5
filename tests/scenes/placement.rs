//! Models on the ground: whatever the camera and the level of detail, they touch it as they were told to.

use crate::common::scratch::Scratch;
use glam::{DVec2, Vec2, Vec3};
use sandtable_description::document::Document;
use sandtable_description::parse::parse_bytes;
use sandtable_draw::list::DrawItem;
use sandtable_picture::{ViewDraw, build_draw_list, camera};
use sandtable_scene::assets::Assets;
use sandtable_scene::build::{build, build_ground};
use sandtable_scene::report::ModelRow;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::triangle_surface::TriangleSurface;

/// A house of 30 × 20 m and 12 m high, its foot at z = −2, as an OBJ file (Y up, front toward +Z).
const HOUSE: &str = "v -15 -2 10\nv 15 -2 10\nv 15 -2 -10\nv -15 -2 -10\nv -15 10 10\nv 15 10 10\nv 15 10 -10\n\
                     v -15 10 -10\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\nf 4 3 2 1\n";
const LOWEST_Z: f32 = -2.0;
const HALF: Vec2 = Vec2::new(15.0, 10.0);

/// Uneven hills: 200 × 200 posts 10 m apart from (5, 5).
fn hills() -> String {
    let height = |index: u32| {
        let (x, y) = (f64::from(index % 200), f64::from(index / 200));
        300.0 + 40.0 * libm::sin(x * 0.11) * libm::cos(y * 0.07) + 6.0 * libm::sin(x * 0.9 + y * 0.5)
    };
    let heights: Vec<String> = (0..40_000).map(|index| format!("{:.3}", height(index))).collect();
    "ncols 200\nnrows 200\nxllcorner 0\nyllcorner 0\ncellsize 10\n".to_owned() + &heights.join(" ")
}

/// The scene with `text` after its `[terrain]`, or the message that refuses it.
fn scene(text: &str) -> Result<SceneModel, String> {
    built(text, |document, assets| build(document, assets, &|_| ()))
}

/// What `build` makes of the scene file with `text` after its `[terrain]`.
fn built<T, E: std::fmt::Display>(
    text: &str,
    build: impl Fn(&Document, &Assets) -> Result<T, E>,
) -> Result<T, String> {
    let scratch = Scratch::new();
    scratch.write("s/hills.asc", hills());
    scratch.write("s/house.obj", HOUSE);
    let points: Vec<String> = (0..60)
        .map(|index| {
            let (x, y) = (100.0 + f64::from(index) * 40.0, 700.0);
            let kind = ["oak", "fir", "elm"][index as usize % 3];
            format!(
                "{{\"type\":\"Feature\",\"properties\":{{\"kind\":\"{kind}\",\"size\":{},\"turn\":{index}}},\
                 \"geometry\":{{\"type\":\"Point\",\"coordinates\":[{x},{y}]}}}}",
                1.0 + f64::from(index) / 100.0
            )
        })
        .collect();
    let points = format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", points.join(","));
    scratch.write("s/trees.geojson", points);
    let file = scratch.at("s/scene.toml");
    let text =
        format!("[terrain]\ndem = \"hills.asc\"\ncrs = \"EPSG:32616\"\nvertical_exaggeration = 1.5\n{text}");
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&file, &[]).expect("the folder is there");
    build(&document, &assets).map_err(|error| error.to_string())
}

#[test]
fn the_ground_alone_is_the_scene_s_and_no_scene_is_lit_before_a_picture() {
    let pads = "[[model]]\nfile = \"house.obj\"\nat = [700, 900]\nheading = 20\nfooting = \"pad\"\n\
                [[model]]\nfile = \"house.obj\"\nat = [720, 930]\nfooting = \"plinth\"\n";
    let scene = scene(pads).expect("sound");
    assert!(!scene.is_lit());
    let ground = built(pads, build_ground).expect("sound").heights.snapshot();
    let bits =
        |lattice: &Lattice| lattice.heights().iter().map(|height| height.to_bits()).collect::<Vec<_>>();
    assert!(bits(ground.lattice()) == bits(&scene.lattice));
    assert!(ground.lattice().pinned().contains(&true), "the pad is there");
}

#[test]
fn the_sun_of_a_time_stands_over_the_middle_of_the_scene() {
    // The sun's noon at 91.5° west, almost on the equator, at the equinox.
    let noon = scene("[style.light]\ntime = \"2026-03-20T18:13:30Z\"\n").expect("sound");
    assert!(noon.sunlight.altitude_rad > 1.56, "{:?}", noon.sunlight);
    let fault = |light: &str| scene(&format!("[style.light]\n{light}\n")).err().expect("refused");
    assert!(fault("time = \"yesterday\"").contains("\"yesterday\" is not a date and time with an offset"));
    assert!(fault("time = \"2026-03-20T06:00:00Z\"").contains("below the horizon"));
    let both = fault("time = \"2026-03-20T18:00:00Z\"\nazimuth = 90");
    assert!(both.contains("`azimuth` and `altitude` have no effect beside `time`"), "{both}");
}

#[test]
fn a_picture_of_wide_ground_has_a_ground_map_of_its_pixels() {
    let scene = scene("[[camera]]\nname = \"all\"\n").expect("sound");
    let cell = |width: u32| {
        let size = (width, width * 9 / 16);
        let camera = camera(&scene, &scene.cameras[0], size).expect("sound");
        build_draw_list(&scene, &camera, &|_| ()).list.ground.expect("there is ground").cell.x
    };
    assert_eq!([1600, 300, 64, 30].map(cell), [2.5, 10.0, 20.0, 40.0]);
}

#[test]
fn the_ground_alone_reads_no_model_without_a_pad() {
    let missing =
        |footing: &str| format!("[[model]]\nfile = \"none.obj\"\nat = [700, 900]\nfooting = \"{footing}\"\n");
    assert!(built(&missing("plinth"), build_ground).is_ok());
    assert!(built(&missing("pad"), build_ground).is_err());
    assert!(scene(&missing("plinth")).is_err());
}

/// Houses here and there, all with the same lines in their tables.
fn houses(lines: &str) -> SceneModel {
    let table = |index: u32| {
        let (x, y) = (300 + index % 4 * 420, 350 + index / 4 * 520);
        format!(
            "[[model]]\nname = \"{index}\"\nfile = \"house.obj\"\nat = [{x}, {y}]\nheading = {}\n{lines}\n",
            index * 29
        )
    };
    scene(&(0..12).map(table).collect::<String>()).expect("sound")
}

/// What a camera somewhere sees at a tolerance, for a few of both.
fn shots(mut scene: SceneModel, mut check: impl FnMut(&SceneModel, &ViewDraw)) {
    for (index, tolerance_px) in [0.5, 2.0, 8.0, 40.0, 200.0].into_iter().enumerate() {
        scene.tolerance_px = tolerance_px;
        let turn = index as f32 * 1.3;
        let eye = Vec3::new(1000.0 + 2600.0 * turn.cos(), 1000.0 + 2600.0 * turn.sin(), 1500.0);
        let target = Vec3::new(1000.0, 1000.0, 450.0);
        let aim = ViewAim::At { eye, target };
        let view = SceneView { name: String::new(), aim, fov_y_rad: 0.8, paper: None };
        let camera = camera(&scene, &view, (640, 360)).expect("sound");
        check(&scene, &build_draw_list(&scene, &camera, &|_| ()));
    }
}

/// The drawn gaps under 7 × 7 places of a house's foot, where the ground is displayed.
fn gaps(item: &DrawItem, shot: &ViewDraw) -> Vec<f64> {
    let part = |index: i32| index as f32 / 3.0;
    let places = (-3..=3).flat_map(|x| (-3..=3).map(move |y| Vec2::new(part(x), part(y)) * HALF * 0.9999));
    places
        .map(|at| item.world_from_mesh.transform_point3(at.extend(LOWEST_Z)))
        .filter_map(|at| Some(f64::from(at.z) - shot.displayed.displayed_z(at.truncate().as_dvec2())?))
        .collect()
}

/// The items of the features from 2 on that a scene's houses are.
fn items(shot: &ViewDraw) -> impl Iterator<Item = &DrawItem> {
    let mut seen = Vec::new();
    let items = shot.list.items.iter().filter(|item| item.feature.index().is_some());
    items.filter(move |item| {
        let is_first = !seen.contains(&item.feature);
        seen.push(item.feature);
        is_first
    })
}

fn most(gaps: &[f64]) -> f64 {
    gaps.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn least(gaps: &[f64]) -> f64 {
    gaps.iter().copied().fold(f64::INFINITY, f64::min)
}

/// The gaps of every house in every shot.
fn each(lines: &str, mut check: impl FnMut(&[f64])) {
    let mut count = 0;
    shots(houses(lines), |_, shot| {
        for gaps in items(shot).map(|item| gaps(item, shot)).filter(|gaps| gaps.len() == 49) {
            check(&gaps);
            count += 1;
        }
    });
    assert!(count > 30, "{count} houses were looked at");
}

/// Heights are f32 at some hundred meters.
const ROUNDING_M: f64 = 1e-3;

#[test]
fn anchored_at_the_lowest_ground_no_house_floats_at_any_level_of_detail() {
    each("anchor = \"lowest\"", |gaps| assert!(most(gaps) < ROUNDING_M, "{gaps:?}"));
}

#[test]
fn anchored_at_the_highest_ground_no_house_is_buried_at_any_level_of_detail() {
    each("anchor = \"highest\"", |gaps| assert!(least(gaps) > -ROUNDING_M, "{gaps:?}"));
}

#[test]
fn anchored_at_its_origin_or_the_mean_a_house_touches_the_ground() {
    each("", |gaps| assert!(gaps[24].abs() < ROUNDING_M, "its middle: {gaps:?}"));
    each("anchor = \"mean\"", |gaps| {
        assert!(least(gaps) < ROUNDING_M && most(gaps) > -ROUNDING_M, "{gaps:?}");
    });
}

#[test]
fn free_to_lean_it_touches_more_of_the_ground() {
    let worst = |lines: &str| {
        let mut sum = 0.0;
        each(lines, |gaps| sum += most(gaps) - least(gaps));
        sum
    };
    let (upright, leaning) = (worst("anchor = \"mean\""), worst("anchor = \"mean\"\ntilt = 90"));
    assert!(leaning < upright * 0.6, "{leaning} m of gaps for {upright}");
}

#[test]
fn a_plinth_reaches_from_the_house_into_the_ground() {
    let mut count = 0;
    shots(houses("anchor = \"highest\"\nfooting = \"plinth\""), |_, shot| {
        for item in shot.list.items.iter().filter(|item| item.feature.index().is_some()) {
            if shot.list.materials[item.material.0 as usize].name != "concrete" {
                continue;
            }
            let mesh = &shot.list.meshes[item.mesh.0 as usize];
            let foot = mesh.vertices.iter().map(|vertex| vertex.position[2]).fold(f32::INFINITY, f32::min);
            let plan = |at: &[f32; 3]| DVec2::new(f64::from(at[0]), f64::from(at[1]));
            let ground: Option<Vec<f64>> = mesh
                .vertices
                .iter()
                .map(|vertex| shot.displayed.displayed_z(plan(&vertex.position)))
                .collect();
            for z in ground.iter().flatten() {
                assert!(f64::from(foot) < z - 0.4, "its foot at {foot} is in the ground at {z}");
            }
            count += usize::from(ground.is_some());
        }
    });
    assert!(count > 30, "{count} plinths were looked at");
}

/// The gaps under the corners: front left, front right, back right and back left.
fn gaps_of(row: &ModelRow) -> [f64; 4] {
    [row.gap_front_left, row.gap_front_right, row.gap_back_right, row.gap_back_left]
        .map(|gap| gap.expect("ground"))
}

#[test]
fn a_pad_is_level_ground_and_what_it_cost_is_told() {
    let scene = houses("anchor = \"mean\"\nfooting = \"pad\"");
    assert_eq!(scene.report.models.len(), 12);
    for row in &scene.report.models {
        assert!(gaps_of(row).into_iter().all(|gap| gap.abs() < ROUNDING_M), "{row:?}");
        assert!(row.cut > Some(0.0) && row.fill > Some(0.0), "earth was moved: {row:?}");
    }
    shots(scene, |_, shot| {
        for item in items(shot) {
            for gap in gaps(item, shot) {
                assert!(gap.abs() < 2.0 * ROUNDING_M, "flat at every level of detail: {gap}");
            }
        }
    });
}

#[test]
fn the_report_tells_the_gap_under_each_corner() {
    let scene = houses("");
    let lattice = &scene.lattice;
    assert_eq!(scene.report.models.len(), scene.placements.len());
    for (row, placement) in scene.report.models.iter().zip(&scene.placements) {
        let at = placement.at.as_dvec2();
        let z = |at: DVec2| {
            ground_height(lattice, Interpolation::Planar, at + lattice.origin()).height_m().expect("ground")
        };
        assert!((row.anchor.expect("ground") - z(at)).abs() < ROUNDING_M);
        // Seen from before it, the front is at −Y and its left at −X, turned by π − heading.
        let turn = DVec2::from_angle(std::f64::consts::PI - f64::from(placement.heading_rad));
        let corners = [(-15.0, -10.0), (15.0, -10.0), (15.0, 10.0), (-15.0, 10.0)];
        for (reported, corner) in gaps_of(row).into_iter().zip(corners) {
            let gap = 1.5 * (z(at) - z(at + turn.rotate(DVec2::from(corner))));
            assert!((reported - gap).abs() < 5e-3, "{reported} for {gap}");
        }
    }
}

const INSTANCES: &str = "[[model]]\nname = \"row\"\nfile = \"shrub\"\nvariants = { oak = \"broadleaf\", fir = \"conifer\" }\n\
    variant = \"kind\"\nscale = \"size\"\nheading = \"turn\"\n[model.instances]\nfile = \"trees.geojson\"\ncrs = \"EPSG:32616\"\n";

#[test]
fn instances_stand_at_their_points_as_their_properties_say() {
    let scene = scene(INSTANCES).expect("sound");
    // Points lie every 40 m from x = 100; the last post is at x = 1995.
    assert_eq!(scene.placements.len(), 48);
    for (index, placement) in scene.placements.iter().enumerate() {
        let name = scene.models[placement.model].parts[0].name.as_str();
        assert_eq!(name, ["broadleaf", "conifer", "shrub"][index % 3]);
        assert!((placement.scale - (1.0 + index as f32 / 100.0)).abs() < 1e-6);
        assert!((placement.heading_rad.to_degrees() - index as f32).abs() < 1e-4);
    }
    let notes = scene.notes().join("\n");
    assert!(notes.contains("12 models of 'row' left out: off the elevation model"), "{notes}");
    assert!(notes.contains("16 models of 'row' name none of its variants; 'shrub' was taken"), "{notes}");
    let row = &scene.report.instances[0];
    assert_eq!((row.models, row.off_the_ground, row.of_no_variant), (48, 12, 16));
}

#[test]
fn what_makes_no_sense_is_refused_at_its_place() {
    let model = |lines: &str| format!("[[model]]\nfile = \"house.obj\"\n{lines}\n");
    let instances = "[model.instances]\npoints = [[500, 500]]\n";
    for (lines, place, words) in [
        ("at = [500, 500]\nvariant = \"kind\"".into(), "8:1", "on a model at one place"),
        (format!("variants = {{ a = \"shrub\" }}\n{instances}"), "7:1", "without a `variant`"),
        (format!("variant = \"kind\"\n{instances}"), "7:1", "without `variants`"),
        ("at = [500, 500]\nclamp = \"absolute\"\nheight = 4\ntilt = 3".into(), "10:1", "stated elevation"),
    ] {
        let error = scene(&model(&lines)).err().expect("refused");
        assert!(error.contains(&format!("scene.toml:{place}")) && error.contains(words), "{error}");
    }
    let error = scene("[[model]]\nfile = \"oak\"\nat = [500, 500]\n").err().expect("refused");
    assert!(error.contains("the built-in models are conifer, broadleaf, shrub, rock"), "{error}");
    let points = vec!["[500, 500]"; 400].join(", ");
    let wide = format!("anchor = \"mean\"\nscale = 90000\n[model.instances]\npoints = [{points}]\n");
    let error = scene(&model(&wide)).err().expect("refused");
    assert!(error.contains("scene.toml:8:9") && error.contains("check `scale`"), "{error}");
}

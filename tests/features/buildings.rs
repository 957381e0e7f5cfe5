//! Buildings from scene files: closed, on their ground at every level of detail, and counted.

use std::path::{Path, PathBuf};

use glam::{DVec2, Vec3};
use proptest::prelude::*;
use sandtable_draw::list::{DrawMesh, FeatureId};
use sandtable_picture::display;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::report::BuildingPadRow;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_structure::building::{self, Measures};
use sandtable_structure::draped_solid::DrapedSolid;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::support_surface::{SupportSurface, ground_runs};
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

use crate::common::data::data;
use crate::common::scratch::Scratch;

const HILLS: &str = concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/hills.png");

/// A scene of the hills with `tables`.
fn scene(tables: &str) -> SceneModel {
    let scratch = Scratch::new();
    std::fs::copy(HILLS, scratch.at("hills.png")).expect("copied");
    let ground = "[terrain]\ndem = \"hills.png\"\nheight_scale = 0.1\ncell = 10\n";
    load_scene(&scratch.write("scene.toml", format!("{ground}{tables}")), &[])
}

fn load_scene(path: &Path, allow: &[PathBuf]) -> SceneModel {
    open_scene(path, allow, &|_| {}).unwrap_or_else(|failure| panic!("{failure:?}"))
}

fn demo() -> SceneModel {
    load_scene(&Path::new(env!("SANDTABLE_ROOT")).join("scenes/buildings.toml"), &[])
}

fn measured(scene: &SceneModel) -> Vec<(FeatureId, Measures)> {
    let measures = |mesh: &DrawMesh| building::check(mesh).unwrap_or_else(|fault| panic!("{fault}"));
    scene.solids.iter().map(|solid| (solid.feature, measures(&solid.mesh))).collect()
}

#[test]
fn every_building_of_the_hamlet_is_closed_and_roofs_what_it_stands_on() {
    let scene = demo();
    let measured = measured(&scene);
    assert!(measured.len() >= 12);
    let inn = scene.features.iter().position(|feature| feature.name == "inn").expect("there") as u32;
    let (_, measures) = measured.iter().find(|(id, _)| id.0 == inn + 2).expect("raised");
    assert!((measures.roof_m2 - 220.0).abs() < 2.0, "{measures:?}");
}

#[test]
fn a_building_stands_on_the_ground_that_its_rule_names() {
    for (base, stands) in [("lowest", 0.0), ("mean", 0.5), ("highest", 1.0)] {
        let scene = scene(&format!(
            "[[building]]\npoints = [[200, 500], [212, 500], [212, 508], [200, 508]]\nheight = 7\nbase = \"{base}\"\n"
        ));
        let lattice = &scene.lattice;
        let heights: Vec<f64> = (0..=40)
            .flat_map(|x| {
                (0..=40).map(move |y| DVec2::new(200.0 + f64::from(x) * 0.3, 500.0 + f64::from(y) * 0.2))
            })
            .filter_map(|at| ground_height(lattice, Interpolation::Planar, at + lattice.origin()).height_m())
            .collect();
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let zs = || scene.solids[0].mesh.vertices.iter().map(|vertex| f64::from(vertex.position[2]));
        let (foot, top) = (zs().fold(f64::INFINITY, f64::min), zs().fold(f64::NEG_INFINITY, f64::max));
        let expected = if base == "mean" {
            heights.iter().sum::<f64>() / heights.len() as f64
        } else {
            low + (high - low) * stands
        };
        assert!((top - 7.0 - expected).abs() < 0.05, "{base}: top at {top}, ground {low} to {high}");
        assert!(foot < low - 0.9 && foot > low - 1.1, "{base}: foot at {foot}, lowest ground {low}");
    }
}

#[test]
fn a_pad_is_level_under_the_whole_footprint_and_its_earth_is_told() {
    let scene = scene(
        "[[building]]\nname = \"hall\"\npoints = [[200, 500], [230, 500], [230, 520], [200, 520]]\nbase = \"pad\"\n",
    );
    let BuildingPadRow { name, level, cut, fill } = &scene.report.building_pads[0];
    assert_eq!(name, "hall");
    assert!(*cut > 100.0 && *fill > 100.0, "{cut} {fill}");
    let lattice = &scene.lattice;
    for (x, y) in [(200.0, 500.0), (230.0, 520.0), (215.0, 510.0), (229.0, 501.0)] {
        let at = lattice.origin() + DVec2::new(x, y);
        let height = ground_height(lattice, Interpolation::Planar, at).height_m().expect("ground");
        assert!((height - level).abs() < 1e-3, "{height} {level}");
    }
}

#[test]
fn what_is_no_building_and_what_hangs_over_the_edge_is_left_out_with_a_note() {
    let scene = scene(
        "[[building]]\npoints = [[100, 100], [120, 100], [140, 100]]\n\
         [[building]]\npoints = [[-5, 100], [20, 100], [20, 120]]\n\
         [[building]]\npoints = [[100, 100], [120, 120], [120, 100], [100, 120]]\n",
    );
    assert_eq!(scene.solids.len(), 2, "both lobes of the last");
    let notes = scene.notes().join("\n");
    for part in ["1 building left out: the footprint encloses no area", "not wholly on", "1 building mended"]
    {
        assert!(notes.contains(part), "{notes}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn no_building_floats_whatever_the_camera_and_the_tolerance(
        eye in (-500f32..1800.0, -500f32..1800.0, 150f32..2500.0),
        tolerance in 0usize..3,
    ) {
        static SCENES: std::sync::LazyLock<Vec<SceneModel>> = std::sync::LazyLock::new(|| {
            [1.0, 15.0, 120.0].into_iter().map(|tolerance_px| {
                let mut scene = demo();
                scene.tolerance_px = tolerance_px;
                scene
            }).collect()
        });
        let scene = &SCENES[tolerance];
        let camera = Camera::new(Vec3::new(eye.0, eye.1, eye.2), Vec3::new(210.0, 550.0, 50.0), 0.8, (800, 600), (0.5, 9000.0));
        prop_assume!(camera.is_ok());
        let displayed = display(scene, &camera.expect("checked"));
        let ground = FullResolution { lattice: scene.ground().lattice() };
        for standing in &scene.uprights {
            let DrapedSolid::Footing(footing) = &standing.upright else { continue };
            let mesh = standing.upright.mesh(SupportSurface { displayed: &displayed, ground: &ground });
            let foot = mesh.vertices.iter().map(|vertex| vertex.position[2]).fold(footing.foot_z, f32::min);
            let lowest = lowest_along(&footing.rings[0], &displayed);
            prop_assert!(f64::from(foot) <= lowest + 1e-3, "foot at {foot}, ground at {lowest}");
        }
    }
}

fn lowest_along(ring: &[DVec2], ground: &dyn TriangleSurface) -> f64 {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    let runs = edges.flat_map(|(from, to)| ground_runs(ground, *from, *to));
    runs.flat_map(|run| run.values().to_vec()).fold(f64::INFINITY, f64::min)
}

/// Buildings of a real place, each with every roof that is asked for.
fn city(folder: &str, dem: &str, buildings: &str) -> Option<Vec<SceneModel>> {
    let folder = data(folder)?;
    let scratch = Scratch::new();
    let scenes = ["flat", "gabled", "hipped"].map(|roof| {
        let text = format!(
            "[terrain]\ndem = \"{0}/{dem}\"\n[[building]]\nfile = \"{0}/{buildings}\nroof = \"{roof}\"\n",
            folder.display()
        );
        load_scene(&scratch.write(&format!("{roof}.toml"), text), std::slice::from_ref(&folder))
    });
    Some(scenes.into())
}

fn raised(scene: &SceneModel) -> usize {
    scene.features.iter().filter(|feature| feature.kind == FeatureKind::Building).count()
}

#[test]
fn every_building_of_swellendam_is_raised_and_closed() {
    let file = "training_data.gpkg\"\nlayer = \"buildings\"";
    let Some(scenes) = city("scenes/swellendam_za", "dem_srtm_utm33s_i16.tif", file) else { return };
    for scene in &scenes {
        assert_eq!(raised(scene), 4708);
        assert!(measured(scene).len() >= 4708);
    }
    let asked: Vec<&str> =
        scenes[1].notes().into_iter().filter(|note| note.contains("another roof")).collect();
    assert_eq!(asked.len(), 1, "{:?}", scenes[1].notes());
}

#[test]
fn every_building_of_monaco_but_the_one_without_area_is_raised_and_closed() {
    let Some(scenes) = city("scenes/monaco", "N43E007.hgt.zip", "derived/buildings.geojson\"") else {
        return;
    };
    for scene in &scenes {
        assert_eq!(raised(scene), 964);
        assert!(measured(scene).len() >= 964);
        assert!(
            scene.notes().iter().any(|note| note.starts_with("1 building left out")),
            "{:?}",
            scene.notes()
        );
    }
}

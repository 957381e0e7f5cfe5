//! Zhang, Wang and Wu: the digital terrain model of features laid over a block ROAM by height.

#[path = "../refinement/papers/world.rs"]
mod world;

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DVec2, Vec3};
use sandtable_description::parse::parse_bytes;
use sandtable_draw::list::DepthLayer;
use sandtable_earthworks::alignment::Alignment;
use sandtable_geom::polyline::Polyline;
use sandtable_picture::{build_draw_list, camera as scene_camera};
use sandtable_ribbon::drape::{check_clearance, drape};
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::stroke::{StrokeOptions, StrokePath, stroke};
use sandtable_roam::criterion::screen::ScreenError;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::feature::FeatureKind;
use sandtable_terrain::triangle_surface::TriangleSurface;

use crate::common::scratch::Scratch;
use world::{World, camera};

#[test]
fn features_get_their_elevation_from_the_ground_that_roam_built() {
    let world = World::hills(97, 97, 32);
    let camera = camera(Vec3::new(100.0, 100.0, 120.0), Vec3::new(600.0, 600.0, 0.0));
    let criterion = ScreenError::new(world.ground(), &world.errors, &world.heights, &camera, 4.0);
    let active = rebuild(&world.layout, &criterion, world.layout.patches());
    let patches = world.layout.patches().collect();
    let displayed = DisplayedTerrain::new(Arc::new(world.lattice.clone()), active, patches);

    let line =
        Polyline::new(vec![DVec2::new(50.0, 80.0), DVec2::new(400.0, 300.0), DVec2::new(900.0, 820.0)], 0.01)
            .expect("a line");
    let mut plan = PlanMesh::default();
    let alignment = Alignment::on_ground(line, 12.0);
    stroke(&StrokePath::alone(&alignment), &StrokeOptions::default(), &mut plan);
    assert!(!plan.triangles.is_empty(), "triangles from centerline and width");
    let draped = drape(&plan, &displayed);
    assert!(draped.triangles.len() > plan.triangles.len(), "cut by the ground");
    assert!(check_clearance(&draped, &displayed) < 1e-3, "it lies on the ground that is shown");
    let model = displayed.displayed_z(DVec2::new(444.0, 333.0)).expect("on the ground");
    assert!(model.abs() < 60.0, "a model's foot stands at {model} m");
}

#[test]
fn a_digital_terrain_model_is_heights_features_and_what_is_no_terrain() {
    let folder = Scratch::new();
    let heights: Vec<String> =
        (0..60 * 60).map(|at| format!("{:.2}", 100.0 + 9.0 * libm::sin(f64::from(at % 60) * 0.3))).collect();
    let grid = "ncols 60\nnrows 60\nxllcorner 0\nyllcorner 0\ncellsize 10\n".to_string();
    folder.write("hill.asc", grid + &heights.join(" "));
    let model = std::fs::read(concat!(env!("SANDTABLE_ROOT"), "assets/models/watchtower.3ds"));
    folder.write("tower.3ds", model.expect("the project's own model"));
    let text = r##"
        title = "Hill"
        subtitle = "from the south"
        crs = "EPSG:32616"
        [terrain]
        dem = "hill.asc"
        [[road]]
        points = [[50, 100], [300, 220], [550, 180]]
        width = 8
        [[river]]
        points = [[100, 550], [320, 400], [540, 500]]
        width = 12
        [[lake]]
        points = [[400, 300], [460, 300], [460, 350], [400, 350]]
        [[model]]
        file = "tower.3ds"
        at = [200, 300]
        [[label]]
        text = "Tower {height}"
        at = [200, 300]
    "##;
    let file = folder.write("scene.toml", text);
    let document = parse_bytes("scene.toml", text.as_bytes()).unwrap_or_else(|errors| panic!("{errors}"));
    let assets = Assets::new(&file, &[]).expect("the folder is there");
    let scene = build(&document, &assets, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let kinds = scene.features.iter().map(|feature| feature.kind).collect::<BTreeSet<_>>();
    let all = [FeatureKind::Lake, FeatureKind::River, FeatureKind::Road, FeatureKind::Model];
    assert!(all.iter().all(|kind| kinds.contains(kind)), "regular and irregular features: {kinds:?}");
    assert_eq!((scene.title.as_deref(), scene.labels.len()), (Some("Hill"), 1), "what is no terrain");

    let view = &scene.cameras[0];
    let shot = build_draw_list(&scene, &scene_camera(&scene, view, (640, 480)).expect("sound"), &|_| ());
    assert!(shot.ground_triangles > 100, "the elevation model");
    let draped = shot.list.items.iter().filter(|item| matches!(item.layer, DepthLayer::Draped(_)));
    // The line that the picture draws along a shore is no feature of the model, nor is what is painted on a road; white water and bars
    // are of the river.
    let draped = draped.filter(|item| {
        let name = &shot.list.materials[item.material.0 as usize].name;
        let is_of_river = ["rapids", "falls", "bar"].contains(&name.as_str());
        !name.ends_with("shoreline") && !name.starts_with("markings") && !is_of_river
    });
    let mut ribbons = 0;
    for item in draped {
        let mesh = &shot.list.meshes[item.mesh.0 as usize];
        assert!(check_clearance(mesh, &*shot.displayed) < 1e-3, "laid over the ground by height");
        let material = &shot.list.materials[item.material.0 as usize];
        assert!(material.texture.is_some(), "each triangle is textured: {}", material.name);
        ribbons += 1;
    }
    assert_eq!(ribbons, 3, "a lake, a river and a road");
    let tower = shot.list.items.iter().find(|item| item.feature == scene.placements[0].feature);
    let foot = tower.expect("the model is drawn").world_from_mesh.transform_point3(Vec3::ZERO);
    let ground = shot.displayed.displayed_z(foot.truncate().as_dvec2()).expect("on the ground") as f32;
    assert!((foot.z - ground).abs() < 1.0, "the model stands at {} on {ground}", foot.z);
}

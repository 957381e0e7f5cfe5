//! Simpler forms of models: what they save, and what of it can be seen.

use std::path::PathBuf;

use crate::common::forest::{SIDE_M, forest, overlook, seen_from};
use glam::Vec3;
use sandtable_draw::list::{DrawItem, DrawList, FeatureId};
use sandtable_geom::aabb::Aabb;
use sandtable_mesh::sink::VertexId;
use sandtable_model::error::CompanionError;
use sandtable_model::read::read;
use sandtable_model::simplify::levels;
use sandtable_model::{Companions, Model, ModelPart};
use sandtable_picture::{build_draw_list, display, draw_list};
use sandtable_render::cpu::{RenderQuality, render};
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

struct Assets;

impl Companions for Assets {
    fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
        let folder: PathBuf = concat!(env!("SANDTABLE_ROOT"), "assets/models").into();
        Ok(std::fs::read(folder.join(name))?)
    }
}

fn asset(name: &str) -> Model {
    read(name, &Assets.load(name).expect("the asset is there"), &Assets).expect("the asset can be read")
}

/// The picture as seen, and the one in which every model is drawn in full.
fn pictures(scene: &SceneModel, camera: &Camera) -> ([DrawList; 2], [Rendering; 2]) {
    let seen = build_draw_list(scene, camera, &|_| ()).list;
    let (mut full, _) = draw_list(scene, &display(scene, camera), &|_| ());
    // Without a camera there is no haze, and the light is that of a map.
    (full.lighting, full.ground) = (seen.lighting, seen.ground.clone());
    let drawn = |list: &DrawList| render(list, camera, &RenderQuality::default()).expect("sound");
    let pictures = [drawn(&seen), drawn(&full)];
    ([seen, full], pictures)
}

/// The mean difference of a channel in 8-bit steps over the pixels that either picture has a model in.
fn mean_difference([one, other]: &[Rendering; 2]) -> (f64, usize) {
    let pixels = one.pixels.data().iter().zip(other.pixels.data());
    let features = one.features.iter().zip(&other.features);
    let (mut sum, mut count) = (0u64, 0);
    for ((a, b), _) in pixels.zip(features).filter(|(_, (a, b))| a.0 > 1 || b.0 > 1) {
        sum += (0..3).map(|channel| u64::from(a.0[channel].abs_diff(b.0[channel]))).sum::<u64>();
        count += 1;
    }
    (sum as f64 / 3.0 / f64::from(count.max(1)), count as usize)
}

/// The mean colors of both pictures where both have a model.
fn mean_colors([one, other]: &[Rendering; 2]) -> [Vec3; 2] {
    let features = one.features.iter().zip(&other.features);
    let both: Vec<bool> = features.map(|(a, b)| a.0 > 1 && b.0 > 1).collect();
    let mean = |picture: &Rendering| {
        let models = picture.pixels.data().iter().zip(&both).filter(|(_, both)| **both);
        let (sum, count) = models.fold((Vec3::ZERO, 0.0), |(sum, count), (pixel, _)| {
            let [red, green, blue, _] = pixel.0.map(f32::from);
            (sum + Vec3::new(red, green, blue), count + 1.0)
        });
        sum / f32::max(count, 1.0)
    };
    [mean(one), mean(other)]
}

#[test]
fn a_forest_looks_the_same_at_a_tenth_of_its_triangles() {
    let scene = forest(6000, &["firtree.obj"]);
    let camera = overlook(&scene, (960, 540));
    let (lists, pictures) = pictures(&scene, &camera);
    let triangles = lists.each_ref().map(DrawList::triangle_count);
    let (mean, pixels) = mean_difference(&pictures);
    let colors = mean_colors(&pictures);
    println!("{triangles:?} triangles, {mean:.2} steps over {pixels} pixels, mean colors {colors:?}");
    assert!(triangles[0] * 10 < triangles[1], "{triangles:?}");
    assert!(pixels > 20_000, "{pixels}");
    assert!(mean < 10.0, "{mean}");
    assert!((colors[0] - colors[1]).abs().max_element() < 6.0, "{colors:?}");
}

#[test]
fn models_near_the_eye_are_drawn_in_full_and_far_ones_as_pictures() {
    let scene = forest(30_000, &["firtree.obj"]);
    let full = asset("firtree.obj").triangle_count();
    let eye = Vec3::new(1280.0, 1280.0, 345.0);
    let camera = seen_from(&scene, eye, eye + Vec3::new(0.0, 100.0, -12.0), (960, 540));
    let list = build_draw_list(&scene, &camera, &|_| ()).list;
    let mut nearest = f32::INFINITY;
    let mut farthest_full = 0f32;
    for item in list.items.iter().filter(|item| item.feature.0 > 1) {
        let distance = item.world_from_mesh.w_axis.truncate().distance(eye);
        match item.triangles.len() {
            2 => nearest = nearest.min(distance),
            count if count * 2 > full / 2 => farthest_full = farthest_full.max(distance),
            _ => {}
        }
    }
    assert!(nearest > 150.0 && nearest.is_finite(), "the nearest picture is {nearest} m away");
    assert!(farthest_full > 20.0, "the farthest full model is {farthest_full} m away");
}

#[test]
fn a_scene_of_few_models_is_drawn_in_full() {
    let scene = forest(60, &["firtree.obj", "farmhouse.obj"]);
    let camera = overlook(&scene, (320, 200));
    let ([seen, full], pictures) = pictures(&scene, &camera);
    assert!(seen.items.len() <= full.items.len());
    assert!(pictures[0].pixels == pictures[1].pixels && pictures[0].features == pictures[1].features);
}

/// A wood of conifers over 600 m of the ground, one feature.
fn wood(count: usize) -> SceneModel {
    let mut scene = forest(count, &["conifer"]);
    for placement in &mut scene.placements {
        placement.at = placement.at * (600.0 / SIDE_M) + 980.0;
        placement.feature = FeatureId(2);
    }
    scene
}

/// The canopies of a list and the trees that are drawn one by one.
fn canopies_and_trees(list: &DrawList) -> [Vec<&DrawItem>; 2] {
    let is_canopy = |item: &&DrawItem| list.materials[item.material.0 as usize].name == "canopy";
    let (canopies, trees) =
        list.items.iter().filter(|item| item.feature == FeatureId(2)).partition(is_canopy);
    [canopies, trees]
}

#[test]
fn a_wood_of_specks_is_drawn_as_a_canopy_of_the_same_tone() {
    let scene = wood(4000);
    let camera =
        seen_from(&scene, Vec3::new(1280.0, -8000.0, 3600.0), Vec3::new(1280.0, 1280.0, 300.0), (640, 360));
    let (lists, pictures) = pictures(&scene, &camera);
    let [canopies, trees] = canopies_and_trees(&lists[0]);
    assert!(canopies.len() == 1 && trees.is_empty(), "{} canopies, {} trees", canopies.len(), trees.len());
    assert!(lists[0].triangle_count() * 20 < lists[1].triangle_count());
    let colors = mean_colors(&pictures);
    let shown = pictures.each_ref().map(|picture| picture.features.iter().filter(|id| id.0 == 2).count());
    println!("mean colors {colors:?}, {shown:?} pixels");
    assert!((colors[0] - colors[1]).abs().max_element() < 10.0, "{colors:?}");
    assert!(shown[0] > 200 && shown[0].abs_diff(shown[1]) * 5 < shown[1], "{shown:?}");
}

#[test]
fn a_canopy_lies_over_the_ground_no_higher_than_the_trees_below() {
    let scene = wood(4000);
    let camera =
        seen_from(&scene, Vec3::new(1280.0, -8000.0, 3600.0), Vec3::new(1280.0, 1280.0, 300.0), (640, 360));
    let view = build_draw_list(&scene, &camera, &|_| ());
    let [canopies, _] = canopies_and_trees(&view.list);
    let tallest = 1.5 * scene.models[0].bounds().expect("a tree").max.z;
    let mut highest = 0f32;
    for vertex in &view.list.meshes[canopies[0].mesh.0 as usize].vertices {
        let at = Vec3::from(vertex.position);
        let ground = view.displayed.displayed_z(at.truncate().as_dvec2()).expect("ground") as f32;
        assert!((-0.01..=tallest).contains(&(at.z - ground)), "{} m over the ground at {at}", at.z - ground);
        highest = highest.max(at.z - ground);
    }
    assert!(highest > 0.4 * tallest, "{highest} m of {tallest} m");
}

#[test]
fn near_trees_are_drawn_one_by_one_and_lone_ones_have_no_canopy() {
    let near = wood(4000);
    let camera = overlook(&near, (960, 540));
    let list = build_draw_list(&near, &camera, &|_| ()).list;
    let [canopies, trees] = canopies_and_trees(&list).map(|all| all.len());
    assert!(canopies == 0 && trees > 1000, "{canopies} canopies, {trees} trees");
    let few = wood(20);
    let camera =
        seen_from(&few, Vec3::new(1280.0, -20_000.0, 7000.0), Vec3::new(1280.0, 1280.0, 300.0), (640, 360));
    let list = build_draw_list(&few, &camera, &|_| ()).list;
    let [canopies, trees] = canopies_and_trees(&list).map(|all| all.len());
    assert!(canopies == 0 && trees == 0, "{canopies} canopies, {trees} trees");
}

fn vertices(parts: &[ModelPart]) -> impl Iterator<Item = Vec3> + '_ {
    parts.iter().flat_map(|part| part.mesh.vertices.iter().map(|vertex| Vec3::from(vertex.position)))
}

fn area(parts: &[ModelPart]) -> f32 {
    let at = |part: &ModelPart, id: VertexId| Vec3::from(part.mesh.vertices[id.index()].position);
    let corners =
        parts.iter().flat_map(|part| part.mesh.triangles.iter().map(|ids| ids.map(|id| at(part, id))));
    corners.map(|[a, b, c]| (b - a).cross(c - a).length() * 0.5).sum()
}

#[test]
fn levels_of_every_model_stay_within_its_bounds_and_keep_its_area() {
    for name in ["watchtower.3ds", "farmhouse.obj", "bridge.glb", "tent.glb", "truck.3ds", "firtree.obj"] {
        let model = asset(name);
        let Aabb { min, max } = model.bounds().expect("it has vertices");
        let levels = levels(&model);
        let counts: Vec<(usize, f32)> =
            levels.iter().map(|level| (level.triangle_count(), level.error)).collect();
        println!("{name}: {} triangles, {counts:?}", model.triangle_count());
        for level in &levels {
            assert!(vertices(&level.parts).all(|at| at.cmpge(min).all() && at.cmple(max).all()), "{name}");
            assert!(area(&level.parts) > 0.8 * area(&model.parts), "{name}");
        }
        assert!(counts.windows(2).all(|pair| pair[1].0 < pair[0].0 && pair[1].1 >= pair[0].1), "{name}");
    }
}

#[test]
fn the_same_model_gives_the_same_levels() {
    let triangles = || -> Vec<Vec<ModelPart>> {
        levels(&asset("bridge.glb")).into_iter().map(|level| level.parts).collect()
    };
    let [one, other] = [triangles(), triangles()];
    assert_eq!(one.len(), other.len());
    for (one, other) in one.iter().flatten().zip(other.iter().flatten()) {
        assert_eq!(one.mesh, other.mesh);
    }
}

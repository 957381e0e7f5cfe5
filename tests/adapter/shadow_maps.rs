//! Shadow maps that an adapter draws against those that the processor draws.

use crate::adapters::gpus;
use crate::common::forest::{forest, overlook, seen_from};
use crate::common::synthetic::{HOUSE, camera, scene};
use std::f32::consts::FRAC_PI_2;
use std::path::Path;

use glam::{Vec2, Vec3};
use sandtable_draw::list::DrawList;
use sandtable_gpu::picture_renderer::PictureRenderer;
use sandtable_gpu::shadow_maps::ShadowMaker;
use sandtable_gpu::shadow_maps::read_back::drawn_shadows;
use sandtable_picture::{build_draw_list, camera as scene_camera};
use sandtable_render::cpu::{RenderQuality, SampleCount, render};
use sandtable_render::picture::Rendering;
use sandtable_render::shadow::{PAGE, ShadowMap, ShadowTexel, Shadows};
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::axes::DirectionAxes;
use sandtable_view::camera::{Camera, ParallelFrame};

/// How much the texels of two maps differ.
#[derive(Clone, Copy, Debug, Default)]
struct MapDifference {
    /// Heights of solids or of the ground that either map has.
    covered: usize,
    /// Those that one of them has and the other lacks.
    one_alone: usize,
    /// Those that lie farther apart than a texel is wide.
    apart: usize,
}

/// The greatest share of what is covered that may be covered by one alone, or lie apart: along the borders of triangles, of
/// which leaves as large as a texel have many, corners are rounded to a coarser grid.
const ALLOWED: f64 = 5e-3;

/// The difference between the processor's map and the adapter's, which have the same pages.
fn difference(own: &ShadowMap, other: &ShadowMap) -> MapDifference {
    assert_eq!((&own.levels, own.scale, own.axes), (&other.levels, other.scale, other.axes));
    let numbers = |map: &ShadowMap| map.pages.iter().map(|page| page.number).collect::<Vec<_>>();
    assert_eq!(numbers(own), numbers(other));
    assert_eq!(own.texels.len(), other.texels.len());
    let mut found = MapDifference::default();
    let per_page = (PAGE * PAGE) as usize;
    for level in &own.levels {
        for page in own.pages[level.pages()].iter().filter(|page| page.number > 0) {
            let first = (page.number as usize - 1) * per_page;
            for (one, other) in own.texels[first..][..per_page].iter().zip(&other.texels[first..][..per_page])
            {
                for [one, other] in [[one.solid, other.solid], [one.ground, other.ground]] {
                    let is_there = [one, other].map(|height| height > ShadowTexel::EMPTY.solid);
                    found.covered += usize::from(is_there[0] || is_there[1]);
                    found.one_alone += usize::from(is_there[0] != is_there[1]);
                    found.apart += usize::from(is_there == [true; 2] && (one - other).abs() > level.texel_m);
                }
            }
        }
    }
    found
}

/// Holds the highest values of a map's pages against its texels.
fn assert_highest(map: &ShadowMap) {
    let texels = |number: u32| &map.texels[(number as usize - 1) * 1024..][..1024];
    for level in &map.levels {
        let (columns, rows) = (level.columns as usize, level.rows as usize);
        let pages = &map.pages[level.pages()];
        for (index, page) in pages.iter().enumerate().filter(|(_, page)| page.number > 0) {
            let (column, row) = (index % columns, index / columns);
            let near = (row.saturating_sub(1)..(row + 2).min(rows)).flat_map(|y| {
                (column.saturating_sub(1)..(column + 2).min(columns)).map(move |x| y * columns + x)
            });
            let stored = near.map(|near| pages[near].number).filter(|&number| number > 0);
            let highest = stored.flat_map(texels).fold(ShadowTexel::EMPTY, |all, texel| ShadowTexel {
                solid: all.solid.max(texel.solid),
                ground: all.ground.max(texel.ground),
            });
            assert_eq!(page.highest, highest, "page {}", page.number);
        }
    }
}

/// Compares the maps of all adapters that can draw them with the processor's.
fn compare(list: &DrawList, camera: &Camera, what: &str) {
    let own = Shadows::new(list, camera).expect("memory");
    let drawn = |gpu| drawn_shadows(gpu, list, camera).unwrap_or_else(|error| panic!("{what}: {error}"));
    for gpu in gpus() {
        let Some(drawn) = drawn(gpu) else {
            eprintln!("{} draws no shadow maps", gpu.name());
            continue;
        };
        for (own, drawn) in own.maps().into_iter().zip(drawn.maps()) {
            assert_eq!(own.is_some(), drawn.is_some(), "{what}");
            let (Some(own), Some(drawn)) = (own, drawn) else { continue };
            let found = difference(own, drawn);
            println!("{what}, {} levels, {} pages: {found:?}", own.levels.len(), own.stored());
            let share = (found.one_alone + found.apart) as f64 / found.covered as f64;
            assert!(share <= ALLOWED, "{what} on {}: {found:?}", gpu.name());
            assert_highest(drawn);
        }
    }
}

#[test]
fn the_synthetic_scene_has_the_shadows_of_the_processor() {
    compare(&scene(), &camera(640, 480), "the scene");
}

#[test]
fn parallel_rays_have_the_shadows_of_the_processor() {
    for (azimuth, pitch) in [(0.0, FRAC_PI_2), (0.6, 0.7)] {
        let axes = DirectionAxes::new(azimuth, pitch);
        let frame = ParallelFrame { half_m: Vec2::splat(420.0), dpi: 96.0 };
        let eye = Vec3::new(320.0, 320.0, 40.0) - axes.forward * 1500.0;
        let camera = Camera::parallel(eye, &axes, frame, (400, 400), (1.0, 3000.0)).expect("sound");
        compare(&scene(), &camera, &format!("parallel rays at pitch {pitch}"));
    }
}

#[test]
fn scenes_of_the_project_have_the_shadows_of_the_processor() {
    for name in ["forest", "bridge", "buildings", "models"] {
        let (scene, camera) = scene_of(name, (640, 360));
        compare(&build_draw_list(&scene, &camera, &|_| ()).list, &camera, name);
    }
}

#[test]
fn a_forest_around_the_eye_has_the_shadows_of_the_processor() {
    let scene = forest(3000, &["firtree.obj", "tent.glb"]);
    for camera in [
        overlook(&scene, (640, 360)),
        seen_from(&scene, Vec3::new(1280.0, 600.0, 330.0), Vec3::new(1280.0, 900.0, 320.0), (640, 360)),
    ] {
        compare(&build_draw_list(&scene, &camera, &|_| ()).list, &camera, "a forest");
    }
}

/// The greatest mean difference of an adapter's pictures by who draws the maps, in 8-bit steps.
const ALLOWED_BY_MAKER: f64 = 0.05;

#[test]
fn pictures_show_the_shadows_of_the_processor() {
    let Some(gpu) = gpus().first() else { return };
    // The most that pictures may differ from the processor's, as in `render_parity`.
    for (name, allowed) in [("bridge", 1.2), ("buildings", 1.5), ("forest", 4.0)] {
        let (scene, camera) = scene_of(name, (320, 180));
        let list = build_draw_list(&scene, &camera, &|_| ()).list;
        let options = RenderQuality { samples: SampleCount::Four, ..RenderQuality::default() };
        let own = render(&list, &camera, &options).expect("sound");
        let [by_processor, by_adapter] = [ShadowMaker::Processor, ShadowMaker::Adapter].map(|maker| {
            let mut renderer = PictureRenderer::with_shadow_maker(gpu, maker).expect("it opened before");
            renderer.render(&list, &camera, &|_| ()).unwrap_or_else(|error| panic!("{name}: {error}"))
        });
        let [by_maker, mean] = [&by_processor, &own].map(|other| mean_difference(&by_adapter, other));
        println!("{name} on {}: {by_maker} by maker, {mean}", gpu.name());
        assert!(by_maker <= ALLOWED_BY_MAKER, "{name} on {}: {by_maker}", gpu.name());
        assert!(mean <= allowed, "{name} on {}: {mean}, allowed {allowed}", gpu.name());
    }
}

#[test]
fn corners_of_no_real_scene_are_left_to_the_processor_and_far_ones_drawn() {
    for (far, is_drawn) in
        [(5e6, true), (1e9, false), (1e30, false), (f32::INFINITY, false), (f32::NAN, false)]
    {
        let mut list = scene();
        let mut broken = list.meshes[3].clone();
        broken.vertices[0].position = [far, -far, 90.0];
        broken.vertices[1].position = [-far, far, far.min(200.0)];
        let mut item = list.items[3].clone();
        item.mesh = list.add_mesh(broken);
        list.items.push(item);
        for gpu in gpus() {
            let camera = camera(160, 120);
            let drawn = drawn_shadows(gpu, &list, &camera).unwrap_or_else(|error| panic!("{far}: {error}"));
            assert!(drawn.is_none() || is_drawn, "{far}");
            let mut renderer =
                PictureRenderer::with_shadow_maker(gpu, ShadowMaker::Adapter).expect("it opened before");
            let picture = renderer.render(&list, &camera, &|_| ());
            let picture = picture.unwrap_or_else(|error| panic!("{far}: {error}"));
            assert!(picture.features.contains(&HOUSE), "{far}");
        }
    }
}

#[test]
fn far_from_the_origin_shadows_are_those_of_the_processor() {
    let offset = Vec3::new(81_920.0, -40_960.0, 512.0);
    let mut list = scene();
    // Multiples of what floats resolve there: rounding is not what this is about.
    let rounded = |at: f32| (at * 64.0).round() / 64.0;
    for mesh in &mut list.meshes {
        for vertex in &mut mesh.vertices {
            vertex.position = (Vec3::from(vertex.position).map(rounded) + offset).to_array();
        }
    }
    compare(&list, &camera(320, 240).moved(offset), "far from the origin");
}

fn mean_difference(one: &Rendering, other: &Rendering) -> f64 {
    let pixels = one.pixels.data().iter().zip(other.pixels.data());
    let steps = pixels.map(|(a, b)| a.0.iter().zip(b.0).map(|(a, b)| u64::from(a.abs_diff(b))).sum::<u64>());
    steps.sum::<u64>() as f64 / one.pixels.data().len() as f64 / 3.0
}

/// A scene of the project and its first view.
fn scene_of(name: &str, size: (u32, u32)) -> (SceneModel, Camera) {
    let path = Path::new(env!("SANDTABLE_ROOT")).join(format!("scenes/{name}.toml"));
    let scene = open_scene(&path, &[], &|_| {}).unwrap_or_else(|failure| panic!("{name}: {failure:?}"));
    let camera = scene_camera(&scene, &scene.cameras[0], size).expect("a sound view");
    (scene, camera)
}

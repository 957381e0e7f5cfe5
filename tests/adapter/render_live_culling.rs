//! Frames whose instances the device culls, against those whose instances the processor culls.

use glam::{Mat4, Vec3};
use sandtable_draw::list::{DrawItem, DrawList, FeatureId};
use sandtable_gpu::adapter::Gpu;
use sandtable_gpu::live::{LiveQuality, LiveRenderer};
use sandtable_view::camera::Camera;

use crate::adapters::gpus;
use crate::common::skip::skipped;
use crate::common::synthetic::{HOUSE, MASKED, camera, scene};
use crate::render_live::{SIZE, WINDOW, Window, changes};

/// Instances of each of two meshes.
const COUNT: u16 = 700;

/// The scene with many of its things, strewn over its ground and far beyond it.
fn crowded() -> DrawList {
    let mut list = scene();
    let share = |index: u16, ratio: f32| (0.5 + f32::from(index) * ratio).fract();
    for feature in [HOUSE, MASKED] {
        let of_feature = |item: &&DrawItem| item.feature == feature;
        let item = list.items.iter().find(of_feature).expect("in the scene").clone();
        let vertices = &list.meshes[item.mesh.0 as usize].vertices;
        let middle = vertices.iter().map(|vertex| Vec3::from(vertex.position)).sum::<Vec3>();
        let to_middle = Mat4::from_translation(-middle / vertices.len() as f32);
        list.items.extend((0..COUNT).map(|index| {
            let at =
                Vec3::new(share(index, 0.754_88) * 1600.0 - 480.0, share(index, 0.569_84) * 1600.0, 60.0);
            let size = Mat4::from_scale(Vec3::splat(0.2 + 0.4 * share(index, 0.618_03)));
            let world_from_mesh = Mat4::from_translation(at) * size * to_middle;
            let feature = FeatureId(100 + u32::from(index));
            DrawItem { world_from_mesh, feature, ..item.clone() }
        }));
    }
    list
}

/// A renderer of one sample a pixel.
fn renderer(gpu: &Gpu) -> LiveRenderer {
    let quality = LiveQuality { samples: 1, anisotropy: 4 };
    LiveRenderer::with_quality(gpu, WINDOW, quality).unwrap_or_else(|error| panic!("{error}"))
}

/// Shows a scene with all its ground.
fn load(renderer: &mut LiveRenderer, list: &DrawList) {
    renderer.load(list).unwrap_or_else(|error| panic!("{error}"));
    renderer.update(&changes(list)).unwrap_or_else(|error| panic!("{error}"));
}

/// Cameras over the whole scene, low in it, and away from all that is strewn.
fn cameras() -> [Camera; 3] {
    let toward =
        |eye: Vec3, target: Vec3| Camera::new(eye, target, 0.85, SIZE, (1.0, 5000.0)).expect("sound");
    let amid = Vec3::new(320.0, 320.0, 90.0);
    [
        camera(SIZE.0, SIZE.1),
        toward(amid, amid + Vec3::new(1.0, 0.3, -0.1)),
        toward(amid, amid + Vec3::Z + Vec3::X * 0.01),
    ]
}

#[test]
fn frames_are_the_same_whether_the_device_or_the_processor_culls() {
    let (list, bare) = (crowded(), scene());
    list.check().expect("a sound list");
    for gpu in gpus() {
        let window = Window::new(gpu, WINDOW);
        let [mut by_device, mut by_processor, mut without] = [renderer(gpu), renderer(gpu), renderer(gpu)];
        if !by_device.cull_on_device() {
            skipped(&format!("{} culls no instances", gpu.name()));
            continue;
        }
        by_processor.cull_on_processor();
        load(&mut by_device, &list);
        load(&mut by_processor, &list);
        load(&mut without, &bare);
        for (number, camera) in cameras().iter().enumerate() {
            let [one, other, empty] =
                [&mut by_device, &mut by_processor, &mut without].map(|each| window.frame(each, camera));
            let apart = one.iter().zip(&other).filter(|(one, other)| one != other).count();
            assert_eq!(apart, 0, "pixels by camera {number} on {}", gpu.name());
            let seen = one.iter().zip(&empty).filter(|(one, empty)| one != empty).count();
            assert_eq!(seen > 1000, number < 2, "{seen} pixels by camera {number}");
        }
    }
}

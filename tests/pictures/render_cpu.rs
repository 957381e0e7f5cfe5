//! Whole pictures by the CPU renderer: what hides what, what is where, and that it is always the same.

mod hiding;
mod hostile;
mod landscape;
mod reflections;
mod shadows;
mod surfaces;

use glam::Vec3;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawList, DrawMesh, FeatureId};
use sandtable_mesh::sink::MeshSink;
use sandtable_render::cpu::{RenderQuality, SampleCount, render};
use sandtable_render::picture::Rendering;
use sandtable_view::camera::Camera;

fn looking(eye: Vec3, target: Vec3, size: (u32, u32)) -> Camera {
    Camera::new(eye, target, 0.8, size, (0.5, 60_000.0)).expect("a sound camera")
}

fn shot(list: &DrawList, camera: &Camera) -> Rendering {
    render(list, camera, &RenderQuality::default()).expect("a sound list")
}

/// The feature at a pixel.
fn feature(picture: &Rendering, x: u32, y: u32) -> FeatureId {
    picture.features[(y * picture.pixels.width() + x) as usize]
}

/// The depth at a pixel.
fn depth(picture: &Rendering, x: u32, y: u32) -> f32 {
    picture.depth_m[(y * picture.pixels.width() + x) as usize]
}

/// How many pixels show a feature.
fn count(picture: &Rendering, feature: FeatureId) -> usize {
    picture.features.iter().filter(|&&seen| seen == feature).count()
}

/// A rectangle with corners `a`, `b`, `c`, `d`, counter-clockwise as seen, and (0, 1) at `a`.
fn quad(corners: [Vec3; 4], color: Srgba) -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
    let ids: Vec<_> = corners
        .into_iter()
        .zip([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])
        .map(|(position, uv)| {
            let (position, normal) = (position.into(), normal.into());
            mesh.vertex(sandtable_draw::list::DrawVertex { position, normal, uv, color })
        })
        .collect();
    mesh.triangle([ids[0], ids[1], ids[2]]);
    mesh.triangle([ids[0], ids[2], ids[3]]);
    mesh
}

/// A rectangle that faces a viewer in the south: `y` meters north, `x` and `z` from low to high.
fn wall(y: f32, x: [f32; 2], z: [f32; 2], color: Srgba) -> DrawMesh {
    let corner = |x: f32, z: f32| Vec3::new(x, y, z);
    quad([corner(x[0], z[0]), corner(x[1], z[0]), corner(x[1], z[1]), corner(x[0], z[1])], color)
}

/// Ten meters south of the origin's surroundings, looking north.
fn northward(size: (u32, u32)) -> Camera {
    looking(Vec3::ZERO, Vec3::Y, size)
}

/// Light that shows every albedo as it is.
fn plain_light(list: &mut DrawList) {
    list.lighting.sun = Vec3::ZERO;
    list.lighting.sky = Vec3::ONE;
    list.lighting.bounce = Vec3::ONE;
}

#[test]
fn an_empty_list_shows_the_sky() {
    let (list, camera) = (DrawList::default(), northward((40, 30)));
    let picture = shot(&list, &camera);
    assert_eq!(count(&picture, FeatureId::NONE), 40 * 30);
    assert!(picture.depth_m.iter().all(|&depth| depth == f32::INFINITY));
    let ray = camera.ray_through(glam::Vec2::new(7.5, 3.5));
    assert_eq!(picture.pixels.at(7, 3), Srgba::from_linear(list.lighting.sky_color(ray)));
}

#[test]
fn one_two_and_three_threads_give_the_same_bytes() {
    let list = landscape::landscape(60);
    let camera = looking(Vec3::new(300.0, -9_400.0, 700.0), Vec3::new(0.0, -3_000.0, 0.0), (330, 190));
    let pictures = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| shot(&list, &camera))
    });
    for other in &pictures[1..] {
        assert!(pictures[0].pixels == other.pixels);
        assert!(pictures[0].features == other.features);
        let bits =
            |picture: &Rendering| picture.depth_m.iter().map(|depth| depth.to_bits()).collect::<Vec<_>>();
        assert!(bits(&pictures[0]) == bits(other));
    }
}

#[test]
fn every_number_of_samples_sees_the_same_things() {
    let list = landscape::landscape(60);
    let camera = looking(Vec3::new(300.0, -9_400.0, 700.0), Vec3::new(0.0, -3_000.0, 0.0), (330, 190));
    let eight = shot(&list, &camera);
    for samples in [SampleCount::One, SampleCount::Four] {
        let options = RenderQuality { samples, ..RenderQuality::default() };
        let other = render(&list, &camera, &options).expect("a sound list");
        let differing = eight.features.iter().zip(&other.features).filter(|(a, b)| a != b).count();
        assert!(differing < 330 * 190 / 100, "{samples:?}: {differing} pixels");
    }
}

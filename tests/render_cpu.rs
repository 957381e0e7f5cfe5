//! Whole pictures by the CPU renderer: what hides what, what is where, and that it is always the same.

#[path = "render_cpu/landscape.rs"]
mod landscape;

use glam::Vec3;
use sandtable::draw::pixels::Pixels;
use sandtable::render::cpu::{Options, render};
use sandtable::render::picture::Picture;
use sandtable::view::camera::Camera;

fn save(picture: &Pixels, name: &str) {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    image::save_buffer(&path, picture.bytes(), picture.width(), picture.height(), image::ColorType::Rgba8)
        .expect("the target folder is writable");
}

fn looking(eye: Vec3, target: Vec3, size: (u32, u32)) -> Camera {
    Camera::new(eye, target, 0.8, size, (1.0, 60_000.0)).expect("a sound camera")
}

fn shot(list: &sandtable::draw::list::DrawList, camera: &Camera) -> Picture {
    render(list, camera, &Options::default()).expect("a sound list")
}

#[test]
#[ignore = "writes large pictures to look at; times itself"]
fn the_landscape_for_the_eye() {
    let list = landscape::landscape(300);
    let above = |x: f32, y: f32, rise: f32| Vec3::new(x, y, landscape::height(x, y) + rise);
    for (name, eye, target, size) in [
        ("wide.png", Vec3::new(300.0, -9_400.0, 700.0), Vec3::new(0.0, -3_000.0, 0.0), (1920, 1080)),
        ("near.png", above(-20.0, -8_320.0, 40.0), above(40.0, -7_900.0, 0.0), (1920, 1080)),
        ("low.png", above(5.0, -8_500.0, 2.0), above(-20.0, -8_300.0, 0.0), (1280, 720)),
        ("above.png", Vec3::new(0.0, -4_000.0, 6_000.0), Vec3::new(0.0, -3_900.0, 0.0), (1280, 720)),
    ] {
        let camera = looking(eye, target, size);
        let start = std::time::Instant::now();
        let picture = shot(&list, &camera);
        println!("{name}: {} triangles, {:?}", list.triangle_count(), start.elapsed());
        save(&picture.pixels, name);
    }
}

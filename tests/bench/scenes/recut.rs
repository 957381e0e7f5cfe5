//! What one dirty patch costs: everything that lies in it, cut to its triangles again.

use std::path::Path;
use std::sync::Arc;

use sandtable_picture::{camera, display, recut};
use sandtable_ribbon::patches::StalePatch;
use sandtable_scene::scene_file::open_scene;

use crate::rounds::{median, quantile, time_ms};

/// Prints the demonstration's patches.
pub fn print() {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/jacksboro.toml");
    let scene = open_scene(&path, &[], &|_| {}).expect("the demonstration is sound");
    let mut drapes = None;
    let dividing = time_ms(|| drapes = Some(recut::drapes(&scene)));
    let mut drapes = drapes.expect("just made");
    println!(
        "scenes/jacksboro.toml: {} ribbons divided among patches in {dividing:.1} ms",
        scene.ribbons.len()
    );
    println!("{:<12}{:>10}{:>14}{:>14}{:>14}", "view", "patches", "median", "95 %", "all at once");
    for view in &scene.cameras {
        let camera = camera(&scene, view, (1920, 1080)).expect("a sound camera");
        let displayed = Arc::new(display(&scene, &camera));
        let all: Vec<usize> = (0..scene.ground().layout().patch_count()).collect();
        let together = time_ms(|| {
            drapes.recut(&all.iter().copied().map(StalePatch::whole).collect::<Vec<_>>(), &*displayed)
        });
        let occupied: Vec<usize> = all
            .into_iter()
            .filter(|&patch| drapes.in_patch(patch).any(|(_, mesh)| !mesh.triangles.is_empty()))
            .collect();
        let each: Vec<f64> = occupied
            .iter()
            .map(|&patch| time_ms(|| drapes.recut(&[StalePatch::whole(patch)], &*displayed)) * 1e3)
            .collect();
        if each.is_empty() {
            continue;
        }
        println!(
            "{:<12}{:>10}{:>11.0} µs{:>11.0} µs{together:>11.2} ms",
            view.name,
            occupied.len(),
            median(&each),
            quantile(&each, 0.95)
        );
    }
}

//! Many models in one picture: what is left out, what is drawn at once, and that nobody can tell.

use crate::common::forest::{forest, overlook, seen_from};
use glam::Vec3;
use sandtable_picture::{build_draw_list, display, draw_list};
use sandtable_render::cpu::{RenderQuality, render};

#[test]
fn leaving_out_what_is_beside_the_picture_changes_no_pixel() {
    let scene = forest(300, &["firtree.obj", "tent.glb"]);
    let eye = Vec3::new(900.0, 700.0, 360.0);
    for (turn, toward) in [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y].into_iter().enumerate() {
        let camera = seen_from(&scene, eye, eye + toward * 100.0 - Vec3::Z * 15.0, (320, 200));
        let seen = build_draw_list(&scene, &camera, &|_| ()).list;
        let (mut all, _) = draw_list(&scene, &display(&scene, &camera), &|_| ());
        // Without a camera there is no haze, and the light is that of a map.
        (all.lighting, all.ground) = (seen.lighting, seen.ground.clone());
        assert!(
            seen.items.len() * 2 < all.items.len(),
            "{turn}: {} of {}",
            seen.items.len(),
            all.items.len()
        );
        let [seen, all] =
            [seen, all].map(|list| render(&list, &camera, &RenderQuality::default()).expect("sound"));
        assert!(seen.pixels == all.pixels && seen.features == all.features, "{turn}");
    }
}

#[test]
fn runs_cover_all_items_and_are_few() {
    let scene = forest(3000, &["firtree.obj", "tent.glb"]);
    let list = build_draw_list(&scene, &overlook(&scene, (640, 360)), &|_| ()).list;
    let runs: Vec<_> = list.runs().collect();
    assert_eq!(runs.iter().map(ExactSizeIterator::len).sum::<usize>(), list.items.len());
    assert!(runs.windows(2).all(|pair| pair[0].end == pair[1].start));
    for run in &runs {
        assert!(list.items[run.clone()].iter().all(|item| item.batches_with(&list.items[run.start])));
    }
    assert!(runs.len() < 200 && list.items.len() > 1500, "{} runs of {} items", runs.len(), list.items.len());
    list.check().expect("sound");
}

#[test]
fn a_forest_is_the_same_bytes_for_one_thread_and_for_two() {
    let picture = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
        pool.install(|| {
            let scene = forest(3000, &["firtree.obj", "farmhouse.obj"]);
            let camera = overlook(&scene, (480, 270));
            render(&build_draw_list(&scene, &camera, &|_| ()).list, &camera, &RenderQuality::default())
                .expect("sound")
        })
    };
    let [one, two] = [picture(1), picture(2)];
    assert!(one.pixels == two.pixels && one.features == two.features && one.depth_m == two.depth_m);
}

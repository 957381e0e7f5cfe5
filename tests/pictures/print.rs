//! The print look, as a photocopier sees it: black or white, and nothing between.

use std::collections::BTreeMap;
use std::path::Path;

use sandtable_draw::list::FeatureId;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::{PictureSize, draw_view};

const SIZE: PictureSize = PictureSize { width: 960, height: 540 };

/// Pixels of a feature, and how many of them a copier leaves black.
#[derive(Clone, Copy, Debug, Default)]
struct CopiedPixels {
    count: usize,
    black: usize,
}

fn copied(scene: &SceneModel) -> BTreeMap<FeatureId, CopiedPixels> {
    let view = scene.cameras.first().expect("a camera");
    let drawn = draw_view(scene, view, SIZE, RenderBackend::Cpu, &|_| ()).expect("a picture");
    let mut pixels: BTreeMap<FeatureId, CopiedPixels> = BTreeMap::new();
    for (feature, pixel) in drawn.picture.features.iter().zip(drawn.picture.pixels.data()) {
        let [red, green, blue, _] = pixel.0;
        assert!(red == green && green == blue, "{pixel:?} has a color");
        let of_feature = pixels.entry(*feature).or_default();
        of_feature.count += 1;
        of_feature.black += usize::from(red < 128);
    }
    pixels
}

#[test]
fn a_copier_keeps_the_contours_and_every_feature_of_a_print() {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/preset-print.toml");
    let mut scene = open_scene(&path, &[], &|_| ()).expect("a sound scene");
    let pixels = copied(&scene);
    let ground = pixels[&FeatureId::GROUND];
    let share = ground.black as f64 / ground.count as f64;
    assert!((0.02..0.2).contains(&share), "{share} of the ground is black");
    let mut seen = 0;
    for (feature, of_feature) in pixels.iter().filter(|(feature, _)| feature.index().is_some()) {
        let name = &scene.features[feature.index().expect("a feature")].name;
        if of_feature.count >= 100 {
            assert!(of_feature.black * 20 > of_feature.count, "{name}: {of_feature:?} fades to white");
            seen += 1;
        }
    }
    assert!(seen >= 8, "{seen} features");
    for blank in [FeatureId::NONE, FeatureId::PLINTH] {
        assert_eq!(pixels[&blank].black, 0);
    }
    scene.contours = None;
    assert_eq!(copied(&scene)[&FeatureId::GROUND].black, 0, "the relief alone fades to white");
}

//! Real road networks: every road is laid, nothing lies over anything else.

use std::path::PathBuf;

use sandtable_ribbon::texture::RibbonSurface;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;

use crate::common::data::data;
use crate::common::scratch::Scratch;
use crate::roads::{area_m2, built, check_laid};

/// The scene of a place, with `PLACE` in `text` for where its files lie.
fn place(name: &str, text: &str) -> Option<SceneModel> {
    let at: PathBuf = data(&format!("scenes/{name}"))?;
    let text = text.replace("PLACE", &at.to_string_lossy());
    let folder = Scratch::new();
    let scene = built(&folder.write("scene.toml", text), &[at]);
    check_laid(&scene);
    Some(scene)
}

fn roads(scene: &SceneModel) -> usize {
    scene.features.iter().filter(|feature| feature.kind == FeatureKind::Road).count()
}

#[test]
fn porto_alegre_s_15_852_roads_lie_apart() {
    let text = "[terrain]\ndem = 'PLACE/poa_elevation.tif'\n\
                [[road]]\nfile = 'PLACE/poa_osm.pbf'\nlayer = 'roads'\nwidth = 7\n";
    let Some(scene) = place("porto_alegre_br", text) else { return };
    assert_eq!(roads(&scene), 15_852);
    let joints = area_m2(&scene, &[RibbonSurface::AsphaltJunction]);
    let ribbons = area_m2(&scene, &[RibbonSurface::Asphalt]);
    assert!(
        ribbons > 6e6 && (0.05..0.5).contains(&(joints / ribbons)),
        "{ribbons} m2 and {joints} m2 of junctions"
    );
}

#[test]
fn monaco_s_roads_lie_apart_and_its_tunnels_are_not_laid() {
    let text = "[terrain]\ndem = 'PLACE/N43E007.hgt.zip'\n\
                [[road]]\nfile = 'PLACE/monaco.osm.gz'\nlayer = 'roads'\nwidth = 6\nshoulder = 1\n";
    let Some(scene) = place("monaco", text) else { return };
    let laid: std::collections::BTreeSet<u32> = scene.ribbons.iter().map(|ribbon| ribbon.feature.0).collect();
    assert!(laid.len() < roads(&scene), "{} of {} have ground under them", laid.len(), roads(&scene));
    assert!(area_m2(&scene, &[RibbonSurface::Shoulder]) > 1e4);
}

#[test]
fn swellendam_s_717_roads_lie_apart() {
    let text = "[terrain]\ndem = 'PLACE/dem_srtm_utm33s_i16.tif'\n\
                [[road]]\nfile = 'PLACE/training_data.gpkg'\nlayer = 'roads'\nwidth = 8\nsurface = 'gravel'\n";
    let Some(scene) = place("swellendam_za", text) else { return };
    assert!((50..=717).contains(&roads(&scene)), "{} roads on the model", roads(&scene));
    assert!(area_m2(&scene, &[RibbonSurface::GravelJunction]) > 1e3);
}

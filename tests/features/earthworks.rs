//! Earthworks of the scene file: what they do to the ground, to water and roads, and what they cost.

use std::path::Path;

use glam::DVec2;
use sandtable_base::message::chain::error_text;
use sandtable_scene::scene_file::{open_scene, open_scene_ground};
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::water_cover::{WaterRules, water_cover};

use crate::common::scratch::Scratch;

const ROOT: &str = env!("SANDTABLE_ROOT");

/// The scene of the hills, 10 m between posts, with `tables`, or the message about it.
fn built(tables: &str) -> Result<SceneModel, String> {
    let scratch = Scratch::new();
    std::fs::copy(Path::new(ROOT).join("assets/jacksboro/hills.png"), scratch.at("hills.png"))
        .expect("copied");
    let ground = "[terrain]\ndem = \"hills.png\"\nheight_scale = 0.1\ncell = 10\ncrs = \"EPSG:32616\"\n";
    scratch.write(
        "shots.geojson",
        r#"{"type":"FeatureCollection","features":[
            {"type":"Feature","properties":{"name":"large","r":60},"geometry":{"type":"Point","coordinates":[400,400]}},
            {"type":"Feature","properties":{"name":"small","r":30},"geometry":{"type":"Point","coordinates":[800,700]}}]}"#,
    );
    let path = scratch.write("scene.toml", format!("{ground}{tables}"));
    let scene = open_scene(&path, &[], &|_| {}).map_err(|failure| error_text(&failure))?;
    let ground = open_scene_ground(&path, &[]).expect("as the scene");
    let same = ground.heights.snapshot().lattice().heights() == scene.lattice.heights();
    assert!(same, "the ground that height queries build is that of the scene");
    Ok(scene)
}

fn sound(tables: &str) -> SceneModel {
    built(tables).unwrap_or_else(|message| panic!("{message}"))
}

fn rises(tables: &str, base: &str) -> Vec<(Post, f32)> {
    let (before, after) = (sound(base), sound(&format!("{base}{tables}")));
    let rise = |post: Post| after.lattice.height(post) - before.lattice.height(post);
    before.lattice.posts().map(|post| (post, rise(post))).filter(|&(_, rise)| rise != 0.0).collect()
}

fn world(lattice: &Lattice, post: Post) -> DVec2 {
    lattice.position(post).as_dvec2()
}

#[test]
fn a_crater_of_every_point_of_a_file_has_the_size_of_its_property() {
    let scene = sound(
        "[[earthwork]]\nkind = \"crater\"\nfile = \"shots.geojson\"\ncrs = \"EPSG:32616\"\nradius = \"r\"\ndepth = 20\nrim = 5\n",
    );
    let rows = &scene.report.earthworks;
    assert_eq!(rows.iter().map(|row| row.name.as_str()).collect::<Vec<_>>(), ["large", "small"]);
    for (row, radius) in rows.iter().zip([60.0f64, 30.0]) {
        let cut = std::f64::consts::PI * radius * radius * 400.0 / (2.0 * 25.0);
        assert!((row.cut / cut - 1.0).abs() < 0.2, "{} of {cut}", row.cut);
        assert!(row.fill > 0.0 && row.area > radius * radius);
    }
    assert!(scene.notes().iter().any(|note| note.starts_with("2 earthworks:")), "{:?}", scene.notes());
}

#[test]
fn earthworks_are_done_in_the_order_of_the_file() {
    let level = "[[earthwork]]\nkind = \"level\"\npoints = [[300, 300], [500, 300], [500, 500], [300, 500]]\nlevel = 90\n";
    let crater = "[[earthwork]]\nkind = \"crater\"\npoints = [[400, 400]]\nradius = 50\ndepth = 10\n";
    let middle = Post { column: 40, row: 40 };
    assert_eq!(sound(&format!("{level}{crater}")).lattice.height(middle), 80.0);
    assert_eq!(sound(&format!("{crater}{level}")).lattice.height(middle), 90.0);
}

#[test]
fn water_stays_level_and_roads_follow() {
    let lake = "[[lake]]\npoints = [[300, 300], [500, 300], [500, 500], [300, 500]]\n";
    let crater = "[[earthwork]]\nkind = \"crater\"\npoints = [[500, 400]]\nradius = 60\n";
    let with = sound(&format!("{lake}{crater}"));
    let level = with.report.lakes[0].level as f32;
    let mut under = 0;
    for post in with.lattice.posts() {
        let at = world(&with.lattice, post);
        if (300.0..=500.0).contains(&at.x) && (300.0..=500.0).contains(&at.y) {
            assert_eq!(with.lattice.height(post), level, "{at}");
            under += 1;
        }
    }
    assert!(under > 100);
    assert!(!rises(crater, lake).is_empty(), "the shore beside it is dug");
    let road = "[[road]]\nprofile = \"conform\"\nwidth = 12\npoints = [[300, 400], [700, 420]]\n";
    let dug = rises(crater, road);
    assert!(dug.iter().any(|&(_, rise)| rise < -10.0), "the road is dug, too: {}", dug.len());
}

#[test]
fn a_leveled_pit_is_not_drawn_as_a_lake_nor_is_a_bank_in_the_sea_water() {
    let pit = "[[earthwork]]\nkind = \"level\"\npoints = [[300, 300], [600, 300], [600, 600], [300, 600]]\nlevel = 20\n";
    let scene = sound(pit);
    let dug = scene.report.earthworks[0].area;
    assert!(scene.water().lakes.is_empty() && dug > 90_000.0, "{:?} of {dug}", scene.water().lakes);
    assert!(
        water_cover(&scene.lattice, &WaterRules::default()).lakes.len() == 1,
        "its heights alone would make it one"
    );
    let sea = "height_offset = -200\nsea_level = 0\n";
    let bank = "[[earthwork]]\nkind = \"raise\"\npoints = [[300, 300], [900, 900]]\nlevel = 5\nwidth = 40\n";
    let scene = sound(&format!("{sea}{bank}"));
    let water = scene.water();
    let on_bank = scene.lattice.index(Post { column: 60, row: 60 });
    let beside = scene.lattice.index(Post { column: 60, row: 10 });
    assert!(scene.has_sea() && !water.is_water[on_bank] && water.is_water[beside]);
}

#[test]
fn works_too_small_or_off_the_model_are_noted_and_too_many_refused() {
    let scene = sound(
        "[[earthwork]]\nkind = \"trench\"\npoints = [[203, 504], [323, 521]]\n[[earthwork]]\nkind = \"crater\"\npoints = [[-900, 0]]\n",
    );
    let notes = scene.notes().join("\n");
    assert!(notes.contains("1 earthwork narrower than two cells"), "{notes}");
    assert!(notes.contains("moved no earth: off the elevation model"), "{notes}");
    let ring: Vec<String> = (0..60_000).map(|at| format!("[{}, {}]", at % 1200, at / 60)).collect();
    let started = std::time::Instant::now();
    let huge = format!("[[earthwork]]\nkind = \"trench\"\nwidth = 9000\npoints = [{}]\n", ring.join(", "));
    let message = built(&huge).err().expect("refused");
    assert!(
        message.contains("moving the earth takes more than") && message.contains("scene.toml:9"),
        "{message}"
    );
    assert!(started.elapsed().as_secs() < 20);
}

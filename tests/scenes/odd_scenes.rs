//! Scenes that nobody plans and somebody writes: what they make, or how they are refused.

use std::fs;
use std::path::PathBuf;

use glam::Vec3;
use sandtable_description::parse::parse_bytes;
use sandtable_picture::{build_draw_list, camera};
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::plinth::base_z;
use sandtable_scene::scene_model::SceneModel;

/// A folder of its own for one test, with `hill.asc` in it: `columns` × `rows` posts 10 m apart from (5, 5).
fn folder(test: &str, (columns, rows): (u32, u32)) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("odd_scenes").join(test);
    fs::create_dir_all(&folder).expect("a folder");
    let height = |index: u32| 100.0 + libm::sin(f64::from(index % columns) * 0.2) * 30.0;
    let heights: Vec<String> = (0..columns * rows).map(|index| format!("{:.3}", height(index))).collect();
    let grid = format!("ncols {columns}\nnrows {rows}\nxllcorner 0\nyllcorner 0\ncellsize 10\n");
    fs::write(folder.join("hill.asc"), grid + &heights.join(" ")).expect("a file");
    let triangle = "v 0 0 0\nv 4 0 0\nv 0 300 0\nf 1 2 3\n";
    fs::write(folder.join("mast.obj"), triangle).expect("a file");
    folder
}

/// The scene over the hill of `size` posts with `text` after its `[terrain]`, or the message that refuses it.
fn scene(test: &str, size: (u32, u32), text: &str) -> Result<SceneModel, String> {
    let file = folder(test, size).join("scene.toml");
    let text = format!("[terrain]\ndem = \"hill.asc\"\n{text}");
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&file, &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

#[test]
fn the_overview_shows_all_of_the_ground_whatever_its_shape() {
    let cases = [((120, 80), 1.0), ((200, 3), 1.0), ((3, 200), 1.0), ((2, 2), 1.0), ((60, 60), 500.0)];
    for (index, (posts, exaggeration)) in cases.into_iter().enumerate() {
        let text = format!("crs = \"EPSG:32616\"\nvertical_exaggeration = {exaggeration}");
        let scene = scene(&format!("overview{index}"), posts, &text).expect("sound");
        let base_z = base_z(scene.bounds);
        for (width, height) in [(1920, 1080), (640, 480)] {
            let camera = camera(&scene, &scene.cameras[0], (width, height)).expect("sound");
            let posts_on_ground = scene.lattice.posts().flat_map(|post| {
                let plan = scene.lattice.position(post);
                [scene.scale.world_z(scene.lattice.height(post)), base_z].map(|z| plan.extend(z))
            });
            for at in posts_on_ground {
                let seen = camera.project(at).expect("in front of the eye").pixel;
                let inside =
                    seen.x >= 0.0 && seen.x <= width as f32 && seen.y >= 0.0 && seen.y <= height as f32;
                assert!(inside, "{posts:?} ×{exaggeration}: {at} at {seen} of {width}×{height}");
            }
        }
    }
}

#[test]
fn a_model_whose_foot_is_out_of_view_is_drawn_all_the_same() {
    let text = "[[model]]\nfile = \"mast.obj\"\nat = [1000, 1500]\n\
        [[camera]]\nname = \"top\"\neye = [1000, 500]\neye_elevation = 400\nlook_at = [1000, 1500]\n\
        look_at_height = 310\nfield_of_view = 12\n";
    let scene = scene("mast", (200, 200), text).expect("sound");
    let camera = camera(&scene, &scene.cameras[0], (640, 360)).expect("sound");
    let shot = build_draw_list(&scene, &camera, &|_| ());
    assert_eq!(shot.ground_triangles, 0, "no ground is in view");
    let feature = sandtable_draw::list::FeatureId(2);
    let mast = shot.list.items.iter().find(|item| item.feature == feature).expect("the mast is drawn");
    let foot = mast.world_from_mesh.transform_point3(Vec3::ZERO);
    assert!((70.0..130.0).contains(&foot.z), "it stands on the ground, at {foot}");
}

#[test]
fn a_camera_that_looks_nowhere_is_refused_at_its_place() {
    let text = "[[camera]]\nname = \"c\"\neye = [300, 300]\neye_height = 0\nlook_at = [300, 300]\n";
    let error = scene("nowhere", (60, 60), text).err().expect("refused");
    assert!(error.contains("scene.toml:7:11") && error.contains("place where its eye is"), "{error}");
}

#[test]
fn an_eye_under_the_ground_is_told() {
    let text = "[[camera]]\nname = \"mole\"\neye = [300, 300]\neye_elevation = 20\nlook_at = [300, 500]\n";
    let scene = scene("mole", (60, 60), text).expect("sound");
    let notes = scene.notes();
    assert!(
        notes.iter().any(|note| note.contains("'mole'") && note.contains("under the ground")),
        "{notes:?}"
    );
}

#[test]
fn a_lake_larger_than_the_ground_takes_its_level_from_the_shore_on_it() {
    let text = "[[lake]]\nname = \"sea\"\n\
        points = [[-9e8, -9e8], [9e8, -9e8], [9e8, 305], [500, 305], [100, 305], [-9e8, 305]]\n";
    let scene = scene("sea", (60, 60), text).expect("sound");
    let (low, _) = scene.lattice.height_range();
    assert!((69.9..72.0).contains(&low), "the lowest ground of the row, not of the few samples on it: {low}");
}

#[test]
fn a_lake_without_an_area_leaves_the_ground_alone() {
    let text = "[[lake]]\nname = \"line\"\npoints = [[100, 300], [200, 300], [400, 300]]\n";
    let scene = scene("line", (60, 60), text).expect("sound");
    assert!(scene.features.is_empty());
    assert!(scene.notes().iter().any(|note| note.contains("encloses no area")), "{:?}", scene.notes());
}

#[test]
fn a_sheet_without_a_place_on_earth_says_what_it_lacks() {
    let furniture = "[furniture]\ngrid = \"mgrs\"\nlayout = \"military\"\n";
    let notes = |test: &str, crs: &str| {
        let text = format!("crs = \"{crs}\"\n{furniture}");
        scene(test, (40, 40), &text).unwrap_or_else(|error| panic!("{error}")).notes().join("\n")
    };
    let unknown = "+proj=tmerc +lat_0=36 +lon_0=-84 +ellps=bessel +units=m";
    let said = notes("unplaced", unknown);
    assert!(said.contains("the mgrs grid and the three norths are not drawn"), "{said}");
    let placed = notes("placed", "EPSG:32616");
    assert!(!placed.contains("not drawn"), "{placed}");
}

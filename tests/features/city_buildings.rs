//! Buildings of CityJSON: their own surfaces, at their own heights or set on the ground.

use std::path::{Path, PathBuf};

use glam::{DVec2, Vec3};
use sandtable_description::finding::Finding;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawMesh;
use sandtable_mesh::sink::VertexId;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::feature_meshes::{Coat, Solid};
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::query::{Interpolation, ground_height};

use crate::common::data::data;
use crate::common::scratch::Scratch;

const ASSETS: &str = concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro");

fn load(path: &Path, allow: &[PathBuf]) -> Result<SceneModel, String> {
    open_scene(path, allow, &|_| {}).map_err(|failure| format!("{failure:?}"))
}

/// The hamlet, changed by `change`, in the valley, with `keys`.
fn hamlet(keys: &str, change: impl Fn(String) -> String) -> Result<SceneModel, String> {
    let scratch = Scratch::new();
    std::fs::copy(format!("{ASSETS}/valley.asc"), scratch.at("valley.asc")).expect("copied");
    let text = std::fs::read_to_string(format!("{ASSETS}/hamlet.city.json")).expect("there");
    scratch.write("hamlet.city.json", change(text));
    let scene = format!(
        "[terrain]\ndem = \"valley.asc\"\ncrs = \"EPSG:32616\"\n[[building]]\nfile = \"hamlet.city.json\"\n{keys}"
    );
    load(&scratch.write("scene.toml", scene), &[])
}

fn sheets(scene: &SceneModel) -> impl Iterator<Item = &Solid> {
    scene.solids.iter().filter(|solid| matches!(solid.coat, Coat::Sheet | Coat::Picture(_)))
}

fn area_m2(scene: &SceneModel) -> f64 {
    let triangle = |mesh: &DrawMesh, ids: &[VertexId; 3]| {
        let [a, b, c] = ids.map(|id| Vec3::from(mesh.vertices[id.0 as usize].position).as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    };
    sheets(scene)
        .map(|solid| solid.mesh.triangles.iter().map(|ids| triangle(&solid.mesh, ids)).sum::<f64>())
        .sum()
}

/// The lowest and the highest Z of the surfaces.
fn reach(scene: &SceneModel) -> (f32, f32) {
    let zs = || sheets(scene).flat_map(|solid| solid.mesh.vertices.iter().map(|vertex| vertex.position[2]));
    (zs().fold(f32::INFINITY, f32::min), zs().fold(f32::NEG_INFINITY, f32::max))
}

fn told<'a>(scene: &'a SceneModel, code: &str) -> Vec<&'a str> {
    let coded = |finding: &&Finding| finding.code.word() == code;
    scene.findings.iter().filter(coded).map(|finding| finding.message.as_str()).collect()
}

#[test]
fn a_hamlet_keeps_its_own_heights_where_they_fit_the_ground() {
    let scene = hamlet("", |text| text).expect("built");
    let buildings = scene.features.iter().filter(|feature| feature.kind == FeatureKind::Building).count();
    assert_eq!(buildings, 15, "two parts of the church, thirteen houses");
    let (low, high) = reach(&scene);
    assert!(
        (low - 377.506).abs() < 0.01 && (high - 411.211).abs() < 0.01,
        "{low} {high}: the box that cjio tells"
    );
    let told_heights = told(&scene, "city-heights");
    assert!(told_heights[0].starts_with("14 buildings at the heights of the file"), "{told_heights:?}");
    assert!(told(&scene, "city-off-ground").is_empty());
    let left_out = told(&scene, "left-out");
    assert!(left_out[0].contains("1 LandUse, 1 WaterBody"), "{left_out:?}");
}

#[test]
fn heights_from_another_zero_are_set_on_the_ground_and_told() {
    let lifted = |text: String| text.replace("4020300.0,0.0]", "4020300.0,47.0]");
    let own = hamlet("", |text| text).expect("built");
    let scene = hamlet("", lifted).expect("built");
    let heights = told(&scene, "city-heights");
    assert!(
        heights[0].contains("14 buildings set on the ground")
            && heights[0].contains("m over the ground, because"),
        "{heights:?}"
    );
    let ((low, high), (own_low, own_high)) = (reach(&scene), reach(&own));
    assert!((low - own_low).abs() < 4.0 && (high - own_high).abs() < 4.0, "{low} {high}");
    let kept = hamlet("base = \"own\"\n", lifted).expect("built");
    assert!((reach(&kept).0 - own_low - 47.0).abs() < 0.01);
    let off = told(&kept, "city-off-ground");
    assert!(off[0].contains("over the ground on walls that reach down to it"), "{off:?}");
    // Nothing floats: under each are walls into the ground.
    for solid in kept.solids.iter().filter(|solid| solid.coat == Coat::Painted) {
        let lowest = solid.mesh.vertices.iter().min_by(|a, b| a.position[2].total_cmp(&b.position[2]));
        let [x, y, z] = lowest.expect("walls").position.map(f64::from);
        let at = DVec2::new(x, y) + kept.lattice.origin();
        let ground = ground_height(&kept.lattice, Interpolation::Planar, at).height_m().expect("ground");
        assert!(z < ground, "{z} over {ground}");
    }
}

#[test]
fn a_level_of_detail_and_colors_are_taken_by_keys() {
    let fine = hamlet("", |text| text).expect("built");
    let coarse = hamlet("lod = \"1.2\"\nheight = 7\nroof_color = \"#102030\"\n", |text| text).expect("built");
    let triangles = |scene: &SceneModel| sheets(scene).map(|solid| solid.mesh.triangles.len()).sum::<usize>();
    assert_eq!(triangles(&coarse), 15 * 12, "boxes");
    assert!(triangles(&fine) > 1000);
    assert!(
        told(&coarse, "default-taken")[0]
            .contains("without effect on CityJSON, whose own surfaces are drawn: `height`")
    );
    let vertices = sheets(&coarse).flat_map(|solid| &solid.mesh.vertices);
    let roofs: Vec<_> = vertices.filter(|vertex| vertex.normal[2] > 0.9).collect();
    assert_eq!(roofs.len(), 15 * 4);
    roofs.iter().for_each(|vertex| assert_eq!(vertex.color.0, [16, 32, 48, 255]));
    let slate = Srgba::opaque(107, 112, 120);
    assert!(sheets(&fine).flat_map(|solid| &solid.mesh.vertices).any(|vertex| vertex.color == slate));
}

#[test]
fn keys_of_cityjson_are_refused_beside_other_sources() {
    for key in ["lod = \"1\"", "base = \"own\""] {
        let scratch = Scratch::new();
        std::fs::copy(format!("{ASSETS}/hills.png"), scratch.at("hills.png")).expect("copied");
        let points = "points = [[200, 500], [230, 500], [230, 520]]";
        let text = format!(
            "[terrain]\ndem = \"hills.png\"\nheight_scale = 0.1\ncell = 10\n[[building]]\n{points}\n{key}\n"
        );
        let error = load(&scratch.write("scene.toml", text), &[]).err().expect("refused");
        assert!(error.contains("CityJSON") || error.contains("`lod`"), "{error}");
    }
}

#[test]
fn surfaces_with_pictures_show_them() {
    let textured = |text: String| {
        text.replace("\"appearance\":{", "\"appearance\":{\"textures\":[{\"type\":\"PNG\",\"image\":\"a/hills.png\"}],\"vertices-texture\":[[0,0],[1,0],[1,1],[0,1]],")
            .replace("\"pond\":{", "\"shed\":{\"type\":\"Building\",\"geometry\":[{\"type\":\"MultiSurface\",\"lod\":\"2\",\"boundaries\":[[[0,1,2,3]]],\"texture\":{\"t\":{\"values\":[[[0,0,1,2,3]]]}}}]},\n\"pond\":{")
    };
    let missing = hamlet("", textured).expect("built");
    assert!(told(&missing, "texture-missing")[0].contains("a/hills.png"), "{:?}", missing.notes());
    assert!(missing.pictures.is_empty());
    let scratch = Scratch::new();
    std::fs::copy(format!("{ASSETS}/valley.asc"), scratch.at("valley.asc")).expect("copied");
    std::fs::create_dir(scratch.at("a")).expect("made");
    std::fs::copy(format!("{ASSETS}/hills.png"), scratch.at("a/hills.png")).expect("copied");
    let text = std::fs::read_to_string(format!("{ASSETS}/hamlet.city.json")).expect("there");
    scratch.write("hamlet.city.json", textured(text));
    let scene =
        "[terrain]\ndem = \"valley.asc\"\ncrs = \"EPSG:32616\"\n[[building]]\nfile = \"hamlet.city.json\"\n";
    let shown = load(&scratch.write("scene.toml", scene), &[]).expect("built");
    assert_eq!(shown.pictures.len(), 1);
    let solid = shown.solids.iter().find(|solid| solid.coat == Coat::Picture(0)).expect("with a picture");
    assert!(solid.mesh.vertices.iter().any(|vertex| vertex.uv == [1.0, 0.0]), "V runs downward");
}

/// Objects with surfaces, and the area of these in square meters, by `cjio` 0.10 and Newell's sum.
const CITIES: [(&str, usize, f64); 7] = [
    ("DH_01_subs.city.json", 9, 1730.835),
    ("composite_solid_with_material.json", 1, 12.0),
    ("delft_1b.json", 1, 2221.898),
    ("multi_lod.json", 10, 2622.118),
    ("multisurface_with_material.json", 0, 0.0),
    ("rotterdam_one.json", 1, 316.177),
    ("rotterdam_subset.json", 16, 10_636.278),
];

#[test]
fn real_cities_have_all_their_objects_and_the_area_of_their_surfaces() {
    let Some(folder) = data("cityjson") else { return };
    for (file, objects, area) in CITIES {
        let text = std::fs::read_to_string(folder.join(file)).expect("there");
        let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let number = |pointer: &str| value.pointer(pointer).and_then(serde_json::Value::as_f64);
        let [scale, x, y] =
            ["/transform/scale/0", "/transform/translate/0", "/transform/translate/1"].map(number);
        let (scale, x, y) = (scale.unwrap_or(1.0), x.unwrap_or(0.0), y.unwrap_or(0.0));
        let least = |axis: usize| {
            let vertices = value["vertices"].as_array().expect("vertices").iter();
            vertices.filter_map(|at| at[axis].as_f64()).fold(f64::INFINITY, f64::min)
        };
        let (west, south) = (x + least(0) * scale, y + least(1) * scale);
        let scratch = Scratch::new();
        let row = ["0 "; 41].concat() + "\n";
        let grid = format!(
            "ncols 41\nnrows 41\nxllcorner {}\nyllcorner {}\ncellsize 20\n{}",
            west - 200.0,
            south - 200.0,
            row.repeat(41)
        );
        scratch.write("flat.asc", grid);
        let scene = format!(
            "[terrain]\ndem = \"flat.asc\"\ncrs = \"EPSG:28992\"\n[[building]]\nfile = \"{}/{file}\"\ncrs = \"EPSG:28992\"\n",
            folder.display()
        );
        let built = load(&scratch.write("scene.toml", scene), std::slice::from_ref(&folder));
        if objects == 0 {
            let built = built.expect("built");
            assert!(!built.notes().is_empty(), "what is left out is told");
            continue;
        }
        let built = built.unwrap_or_else(|error| panic!("{file}: {error}"));
        let drawn = built.features.iter().filter(|feature| feature.kind == FeatureKind::Building).count();
        assert_eq!(drawn, objects, "{file}: {:?}", built.notes());
        assert!((area_m2(&built) - area).abs() < 2e-3 * area, "{file}: {} of {area}", area_m2(&built));
    }
    let minimal = folder.join("minimal.json");
    let scratch = Scratch::new();
    std::fs::copy(format!("{ASSETS}/valley.asc"), scratch.at("valley.asc")).expect("copied");
    let scene = format!(
        "[terrain]\ndem = \"valley.asc\"\ncrs = \"EPSG:32616\"\n[[building]]\ncrs = \"EPSG:28992\"\nfile = \"{}\"\n",
        minimal.display()
    );
    let refused = load(&scratch.write("scene.toml", scene), std::slice::from_ref(&folder)).err();
    assert!(refused.expect("refused").contains("holds no features"));
}

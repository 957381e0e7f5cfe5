//! What covers the ground: nothing over itself, the later over the earlier, everything else above.

use glam::DVec2;
use sandtable_description::parse::parse_bytes;
use sandtable_description::words::Cover;
use sandtable_draw::list::DepthLayer;
use sandtable_draw::material::AlphaMode;
use sandtable_picture::{build_draw_list, camera};
use sandtable_ribbon::partition::overlap_m2;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_ribbon::texture::cover::cover_length_m;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;

use crate::common::scratch::Scratch;

/// A scene over hills of 300 m by 300 m, from `text` after its `[terrain]`, with `uses.geojson` beside it.
fn scene(text: &str) -> SceneModel {
    let folder = Scratch::new();
    let height =
        |index: i32| 100.0 + 8.0 * libm::sin(f64::from(index % 31) * 0.4) + f64::from(index / 31) * 0.7;
    let heights: Vec<String> = (0..31 * 31).map(|index| format!("{:.2}", height(index))).collect();
    let grid = "ncols 31\nnrows 31\nxllcorner -5\nyllcorner -5\ncellsize 10\n";
    folder.write("hills.asc", format!("{grid}{}", heights.join(" ")));
    let square = |low: i32, class: &str| {
        let high = low + 50;
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"use:class\":\"{class}\"}},\"geometry\":{{\"type\":\"Polygon\",\
             \"coordinates\":[[[{low},{low}],[{high},{low}],[{high},{high}],[{low},{high}],[{low},{low}]]]}}}}"
        )
    };
    let features = [square(20, "forest"), square(100, "meadow"), square(180, "nothing known")].join(",");
    folder.write("uses.geojson", format!("{{\"type\":\"FeatureCollection\",\"features\":[{features}]}}"));
    let text = format!("[terrain]\ndem = \"hills.asc\"\ncrs = \"EPSG:32633\"\n{text}");
    let path = folder.write("scene.toml", &text);
    let document = parse_bytes("scene.toml", text.as_bytes()).expect("a scene file");
    let assets = Assets::new(&path, &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).unwrap_or_else(|error| panic!("{error}"))
}

fn area_m2(scene: &SceneModel, wanted: RibbonSurface) -> f64 {
    // What fades along the outline is the same cover.
    let is_wanted = |surface: RibbonSurface| match surface {
        RibbonSurface::CoverEdge(cover) => wanted == surface || wanted == RibbonSurface::Cover(cover),
        other => wanted == other,
    };
    scene.ribbons.iter().filter(|ribbon| is_wanted(ribbon.surface)).map(|ribbon| ribbon.plan.area_m2()).sum()
}

const TWO: &str = "[[area]]\ncover = \"forest\"\npoints = [[50, 50], [150, 50], [150, 150], [50, 150]]\n\
    [[area]]\ncover = \"field\"\nborder = \"dashed\"\npoints = [[100, 100], [200, 100], [200, 200], [100, 200]]\n";

#[test]
fn the_later_of_two_areas_lies_on_top_and_nothing_lies_over_anything_else() {
    let scene = scene(TWO);
    assert!(overlap_m2(scene.ribbons.iter().map(|ribbon| &ribbon.plan).collect::<Vec<_>>()) < 1e-2);
    assert!((area_m2(&scene, RibbonSurface::Cover(Cover::Forest)) - 7500.0).abs() < 0.1);
    let (field, line) =
        (area_m2(&scene, RibbonSurface::Cover(Cover::Field)), area_m2(&scene, RibbonSurface::Border));
    assert!((field + line - 10_000.0).abs() < 0.1 && line > 500.0, "{field} {line}");
}

#[test]
fn textures_lie_where_the_world_has_them() {
    let scene = scene(TWO);
    for ribbon in &scene.ribbons {
        let RibbonSurface::Cover(cover) = ribbon.surface else { continue };
        for vertex in &ribbon.plan.vertices {
            let expected = (DVec2::new(vertex.at.x, -vertex.at.y) / cover_length_m(cover)).as_vec2();
            assert!((vertex.uv - expected).length() < 1e-4, "{vertex:?}");
        }
    }
}

#[test]
fn water_and_roads_lie_over_areas_and_the_ground_shows_through_them() {
    let text = format!(
        "{TWO}[[road]]\npoints = [[20, 120], [280, 120]]\n[[river]]\npoints = [[120, 280], [120, 20]]\nbank = 3\n\
         [[camera]]\nname = \"top\"\neye = [150, 20]\neye_elevation = 500\nlook_at = [150, 150]\n"
    );
    let scene = scene(&text);
    assert!(overlap_m2(scene.ribbons.iter().map(|ribbon| &ribbon.plan).collect::<Vec<_>>()) < 1e-2);
    assert!(area_m2(&scene, RibbonSurface::Bank) > 500.0);
    let camera = camera(&scene, &scene.cameras[0], (320, 200)).expect("sound");
    let list = build_draw_list(&scene, &camera, &|_| {}).list;
    assert_eq!(list.check(), Ok(()));
    let kind = |feature: sandtable_draw::list::FeatureId| scene.features[feature.0 as usize - 2].kind;
    let draped = list.items.iter().filter(|item| matches!(item.layer, DepthLayer::Draped(_)));
    let order: Vec<FeatureKind> = draped.clone().map(|item| kind(item.feature)).collect();
    let last_area = order.iter().rposition(|kind| *kind == FeatureKind::Area).expect("areas");
    let first_other = order.iter().position(|kind| *kind != FeatureKind::Area).expect("others");
    assert!(last_area < first_other, "{order:?}");
    for item in draped.filter(|item| kind(item.feature) == FeatureKind::Area) {
        assert_eq!(list.materials[item.material.0 as usize].alpha, AlphaMode::Blend);
    }
}

#[test]
fn a_cover_comes_from_a_property_and_what_has_none_is_told() {
    let text =
        "[[area]]\nname = \"uses\"\nfile = \"uses.geojson\"\ncrs = \"EPSG:32633\"\ncover = \"use:class\"\n";
    let scene = scene(text);
    assert!((area_m2(&scene, RibbonSurface::Cover(Cover::Forest)) - 2500.0).abs() < 0.1);
    assert!((area_m2(&scene, RibbonSurface::Cover(Cover::Meadow)) - 2500.0).abs() < 0.1);
    assert!(
        scene.notes().iter().any(|note| note.contains("1 area of 'uses' left out")),
        "{:?}",
        scene.notes()
    );
}

#[test]
fn a_restricted_area_has_a_border_unless_it_says_otherwise() {
    let ring = "points = [[50, 50], [150, 50], [150, 150], [50, 150]]\n";
    let bordered = scene(&format!("[[area]]\ncover = \"restricted\"\n{ring}"));
    assert!((area_m2(&bordered, RibbonSurface::Border) - (10_000.0 - 92.0 * 92.0)).abs() < 0.1);
    let bare = scene(&format!("[[area]]\ncover = \"restricted\"\nborder = \"none\"\n{ring}"));
    assert_eq!(area_m2(&bare, RibbonSurface::Border), 0.0);
}

#[test]
fn natural_cover_fades_along_its_outline_and_what_is_built_or_bordered_does_not() {
    let faded = |keys: &str, points: &str| {
        let scene = scene(&format!("[[area]]\n{keys}\npoints = {points}\n"));
        let edges = [Cover::Forest, Cover::BuiltUp].map(RibbonSurface::CoverEdge);
        edges.map(|edge| area_m2(&scene, edge)).iter().sum::<f64>()
    };
    let square = "[[50, 50], [150, 50], [150, 150], [50, 150]]";
    let clockwise = "[[50, 50], [50, 150], [150, 150], [150, 50]]";
    for points in [square, clockwise] {
        let found = faded("cover = \"forest\"", points);
        assert!((found - (10_000.0 - 76.0 * 76.0)).abs() < 0.1, "{found}");
    }
    let copse = faded("cover = \"forest\"", "[[50, 50], [74, 50], [74, 74], [50, 74]]");
    assert!((copse - (24.0 * 24.0 - 18.0 * 18.0)).abs() < 0.1, "{copse}");
    assert_eq!(faded("cover = \"forest\"\nborder = \"solid\"", square), 0.0);
    assert_eq!(faded("cover = \"built-up\"", square), 0.0);
}

#[test]
fn a_color_tints_cover_and_border() {
    let text = "[[area]]\ncover = \"forest\"\nborder = \"solid\"\ncolor = \"#80ff0080\"\n\
        points = [[50, 50], [150, 50], [150, 150], [50, 150]]\n";
    let scene = scene(text);
    assert_eq!(scene.ribbons.len(), 2);
    for ribbon in &scene.ribbons {
        assert_eq!(ribbon.tint.0[2], 0, "{:?}", ribbon.surface);
        assert!(ribbon.tint.0[3] <= 0x80);
    }
}

//! Roads are drawn as wide as they are, or as wide as they need to be to be seen.

use glam::{DVec2, Vec2, Vec3};
use sandtable_description::parse::parse_bytes;
use sandtable_draw::list::{DepthLayer, DrawItem, FeatureId};
use sandtable_draw::material::AlphaMode;
use sandtable_geom::polyline::Polyline;
use sandtable_picture::{build_draw_list, draw_list};
use sandtable_render::cpu::{RenderQuality, render};
use sandtable_render::picture::Rendering;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

use crate::common::forest::seen_from;
use crate::common::scratch::Scratch;

const ROAD_M: f64 = 6.0;

/// The least width of a road six meters wide on a picture 1080 lines high.
const LEAST_PX: f64 = 2.5;

/// East, northeast and north.
const POINTS: [(f64, f64); 4] = [(6e3, 12e3), (16e3, 12e3), (18e3, 15e3), (18e3, 21e3)];

/// Level ground of 30 km by 30 km with one road.
fn scene() -> SceneModel {
    let folder = Scratch::new();
    let row = "100 ".repeat(21);
    let grid = format!(
        "ncols 21\nnrows 21\nxllcenter 0\nyllcenter 0\ncellsize 1500\n{}",
        [row.as_str(); 21].join("\n")
    );
    folder.write("ground.asc", &grid);
    let points = POINTS.map(|(x, y)| format!("[{x}, {y}]")).join(", ");
    let text = format!("[terrain]\ndem = \"ground.asc\"\n[[road]]\nwidth = {ROAD_M}\npoints = [{points}]\n");
    let path = folder.write("scene.toml", &text);
    let document = parse_bytes("scene.toml", text.as_bytes()).expect("a scene file");
    let assets = Assets::new(&path, &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).unwrap_or_else(|error| panic!("{error}"))
}

fn road(scene: &SceneModel) -> FeatureId {
    let at = scene.features.iter().position(|feature| feature.kind == FeatureKind::Road);
    FeatureId(at.expect("a road") as u32 + 2)
}

/// World X and Y of the scene's origin are those of its south-west post.
fn world(at: DVec2) -> Vec3 {
    at.as_vec2().extend(100.0)
}

/// The width of the road on the picture where its line goes through `at`, in pixels; `None` where that is out of view.
fn width_px(picture: &Rendering, camera: &Camera, road: FeatureId, at: DVec2, along: DVec2) -> Option<f64> {
    const STEP_PX: f32 = 0.125;
    let [center, ahead] = [at, at + along].map(|at| camera.project(world(at)).map(|seen| seen.pixel));
    let (center, across) = (center?, (ahead? - center?).normalize().perp());
    let size = Vec2::new(picture.pixels.width() as f32, picture.pixels.height() as f32);
    let inside = |pixel: Vec2| pixel.cmpge(Vec2::ZERO).all() && pixel.cmplt(size).all();
    let is_road = |step: i32| {
        let pixel = center + across * STEP_PX * step as f32;
        let index = pixel.y as usize * picture.pixels.width() as usize + pixel.x as usize;
        inside(pixel) && picture.features[index] == road
    };
    inside(center).then(|| {
        let steps = [1, -1].map(|side| (0..4000).take_while(|step| is_road(side * step)).count());
        f64::from(STEP_PX) * (steps[0] + steps[1]) as f64
    })
}

/// The widths at places all along the road that are in view.
fn widths_px(scene: &SceneModel, camera: &Camera) -> Vec<f64> {
    let picture = render(&build_draw_list(scene, camera, &|_| ()).list, camera, &RenderQuality::default());
    let picture = picture.expect("sound");
    let line = Polyline::new(POINTS.map(DVec2::from), 0.0).expect("a line");
    let step_m = line.length() / 2000.0;
    let place = |index: u32| {
        let from = line.at(f64::from(index) * step_m);
        let to = line.at(f64::from(index + 1) * step_m);
        width_px(&picture, camera, road(scene), from.midpoint(to), to - from)
    };
    (1..1999).filter_map(place).collect()
}

#[test]
fn a_road_seen_from_far_away_has_its_least_width_wherever_it_is_visible() {
    let scene = scene();
    for eye in [Vec3::new(15e3, -4e3, 12_100.0), Vec3::new(15e3, 14e3, 20_100.0)] {
        let camera = seen_from(&scene, eye, Vec3::new(15e3, 15e3, 100.0), (1440, 1080));
        let widths = widths_px(&scene, &camera);
        assert!(widths.len() > 1900, "{} places are in view", widths.len());
        let (least, most) = widths.iter().fold((f64::MAX, 0f64), |(a, b), &px| (a.min(px), b.max(px)));
        assert!(least >= LEAST_PX && most < 4.0 * LEAST_PX, "from {least} to {most} px");
    }
}

#[test]
fn a_road_seen_from_near_has_its_true_width() {
    let scene = scene();
    let (at, half) = (DVec2::new(12e3, 12e3), DVec2::new(0.0, ROAD_M / 2.0));
    let camera = seen_from(&scene, Vec3::new(12e3, 11_960.0, 150.0), world(at), (1440, 1080));
    let list = build_draw_list(&scene, &camera, &|_| ()).list;
    let picture = render(&list, &camera, &RenderQuality::default()).expect("sound");
    let found = width_px(&picture, &camera, road(&scene), at, DVec2::X).expect("in view");
    let edges = [at + half, at - half].map(|at| camera.project(world(at)).expect("in view").pixel);
    let expected = f64::from(edges[0].distance(edges[1]));
    assert!(expected > 50.0 && (found - expected).abs() < 2.0, "{found} px, not {expected}");
}

#[test]
fn what_no_camera_sees_has_its_true_width() {
    let scene = scene();
    let ground = sandtable_picture::display(
        &scene,
        &seen_from(&scene, Vec3::new(15e3, -4e3, 12_100.0), Vec3::new(15e3, 15e3, 100.0), (1440, 1080)),
    );
    let (list, _) = draw_list(&scene, &ground, &|_| ());
    let roads = list.items.iter().filter(|item| item.feature == road(&scene));
    let area = |mesh: &sandtable_draw::list::DrawMesh| -> f64 {
        let corner = |id: sandtable_mesh::sink::VertexId| {
            Vec3::from(mesh.vertices[id.index()].position).truncate().as_dvec2()
        };
        let doubled = |[a, b, c]: [DVec2; 3]| (b - a).perp_dot(c - a);
        mesh.triangles.iter().map(|ids| doubled(ids.map(corner)) / 2.0).sum()
    };
    let found: f64 = roads.map(|item| area(&list.meshes[item.mesh.0 as usize])).sum();
    let expected: f64 = scene.ribbons.iter().map(|ribbon| ribbon.plan.area_m2()).sum();
    assert!((found - expected).abs() < 1e-3 * expected, "{found} m², not {expected}");
}

/// A valley 55 m deep, 30 cells of 10 m wide, with a road over it that has `keys`, as `camera` sees it.
fn valley(keys: &str, camera: &str) -> (SceneModel, Camera) {
    let folder = Scratch::new();
    let height = |column: u32| {
        let off = f64::from(column).mul_add(10.0, -500.0) / 150.0;
        100.0 - 55.0 * libm::exp(-off.powi(4))
    };
    let row: Vec<String> = (0..101).map(|column| format!("{:.2}", height(column))).collect();
    let row = row.join(" ");
    let grid = "ncols 101\nnrows 101\nxllcenter 0\nyllcenter 0\ncellsize 10\n".to_owned();
    folder.write("valley.asc", grid + &[row.as_str(); 101].join("\n"));
    let text = format!(
        "[terrain]\ndem = \"valley.asc\"\ninfer_water = false\n[[road]]\npoints = [[100, 500], [300, 500], [700, 500], \
         [900, 500]]\nwidth = 9\n{keys}\n[[camera]]\nname = \"a\"\n{camera}\n"
    );
    let path = folder.write("scene.toml", &text);
    let document = parse_bytes("scene.toml", text.as_bytes()).expect("a scene file");
    let assets = Assets::new(&path, &[]).expect("the folder is there");
    let scene = build(&document, &assets, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let camera = sandtable_picture::camera(&scene, &scene.cameras[0], (900, 600)).expect("sound");
    (scene, camera)
}

/// What the picture shows at a place in the world.
fn seen_at(picture: &Rendering, camera: &Camera, at: Vec3) -> FeatureId {
    let pixel = camera.project(at).expect("in view").pixel;
    picture.features[pixel.y as usize * picture.pixels.width() as usize + pixel.x as usize]
}

/// The parts of the symbols of roads that lie on decks, in a picture of `camera`.
fn raised(scene: &SceneModel, camera: &Camera) -> usize {
    let list = build_draw_list(scene, camera, &|_| ()).list;
    let is_raised = |item: &&DrawItem| {
        item.layer == DepthLayer::Solid && scene.feature_name(item.feature).starts_with("road")
    };
    let parts: Vec<&DrawItem> = list.items.iter().filter(is_raised).collect();
    for item in &parts {
        let alpha = list.materials[item.material.0 as usize].alpha;
        assert_eq!(alpha, AlphaMode::Blend, "what blends casts no shadow");
    }
    parts.len()
}

#[test]
fn the_symbol_of_a_bridge_lies_on_its_deck_and_not_on_the_ground_below() {
    let views = [
        "projection = \"orthographic\"\nazimuth = 20\npitch = 20",
        "projection = \"orthographic\"\nazimuth = 20\npitch = 35",
        "projection = \"oblique\"",
        "azimuth = 20\npitch = 20",
        "azimuth = 200\npitch = 35",
    ];
    for keys in ["profile = \"conform\"\nmax_fill = 10", "bridge = \"true\""] {
        for view in views {
            let (scene, camera) = valley(keys, view);
            let symbol = scene.symbols.iter().find(|symbol| symbol.deck.is_some()).expect("a bridge");
            let deck = symbol.deck.as_ref().expect("its deck");
            let list = build_draw_list(&scene, &camera, &|_| ()).list;
            let picture = render(&list, &camera, &RenderQuality::default()).expect("sound");
            let names = |at: Vec3| scene.feature_name(seen_at(&picture, &camera, at));
            for x in [440.0, 480.0, 500.0, 520.0, 560.0] {
                let ground = Vec3::new(x, 500.0, 45.0);
                assert!(!names(ground).starts_with("road"), "{keys} {view}: {} below", names(ground));
                let level_m = deck.level_at(DVec2::new(f64::from(x), 500.0));
                let carried = names(Vec3::new(x, 500.0, level_m as f32));
                let is_bridge = carried.starts_with("road") || carried.starts_with("bridge");
                assert!(is_bridge, "{keys} {view}: {carried} on the deck");
            }
        }
    }
}

#[test]
fn the_symbol_of_a_bridge_lies_on_the_ground_only_where_it_is_seen_from_above() {
    for (view, count) in [
        ("projection = \"plan\"", 0),
        ("projection = \"orthographic\"\npitch = 20", 2),
        ("projection = \"orthographic\"\nazimuth = 20\npitch = 20", 2),
        ("pitch = 20", 2),
    ] {
        for keys in ["profile = \"conform\"\nmax_fill = 10", "bridge = \"true\""] {
            let (scene, camera) = valley(keys, view);
            assert_eq!(raised(&scene, &camera), count, "casing and fill: {keys} {view}");
        }
    }
}

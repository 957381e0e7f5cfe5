//! Strewn models: where they may stand, how many, and that each has a place of its own.

use std::collections::BTreeSet;

use crate::common::scratch::Scratch;
use glam::{DVec2, Vec2};
use sandtable_description::parse::parse_bytes;
use sandtable_geom::polygon;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::query::gradient::{GradientSurface, ground_gradient};
use sandtable_terrain::query::{Interpolation, ground_height};

/// 101 × 101 posts 10 m apart; the south-west post stands at `corner`. A valley along x = 500.
fn valley(corner: (f64, f64), posts: u32) -> String {
    let height = |index: u32| {
        let x = corner.0 + f64::from(index % posts) * 10.0;
        100.0 + (x - 500.0).abs() * (x - 500.0).abs() / 1000.0
    };
    let heights: Vec<String> = (0..posts * posts).map(|index| format!("{:.3}", height(index))).collect();
    let (west, south) = (corner.0 - 5.0, corner.1 - 5.0);
    format!("ncols {posts}\nnrows {posts}\nxllcorner {west}\nyllcorner {south}\ncellsize 10\n")
        + &heights.join(" ")
}

fn scene_on(ground: String, text: &str) -> Result<SceneModel, String> {
    let scratch = Scratch::new();
    scratch.write("s/valley.asc", ground);
    scratch.write("s/wood.geojson", WOOD);
    let file = scratch.at("s/scene.toml");
    let text = format!("[terrain]\ndem = \"valley.asc\"\ncrs = \"EPSG:32616\"\n{text}");
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&file, &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

fn scene(text: &str) -> Result<SceneModel, String> {
    scene_on(valley((0.0, 0.0), 101), text)
}

/// A square wood with a square clearing.
const WOOD: &str = r#"{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[
    [[100,100],[900,100],[900,900],[100,900],[100,100]],[[300,300],[300,700],[700,700],[700,300],[300,300]]]}}"#;

fn table(points: &str, lines: &str) -> String {
    format!("[[scatter]]\nof = \"conifer\"\npoints = {points}\n{lines}\n")
}

const ALL: &str = "[[0, 0], [1000, 0], [1000, 1000], [0, 1000]]";

/// Where trees stand, in map coordinates, as bits, so that they can be told apart and compared.
fn places(scene: &SceneModel) -> BTreeSet<(u64, u64)> {
    let map = |at: Vec2| at.as_dvec2() + scene.lattice.origin();
    scene
        .placements
        .iter()
        .map(|placement| map(placement.at))
        .map(|at| (at.x.to_bits(), at.y.to_bits()))
        .collect()
}

fn at((x, y): (u64, u64)) -> DVec2 {
    DVec2::new(f64::from_bits(x), f64::from_bits(y))
}

#[test]
fn the_same_tree_stands_where_it_stood_when_the_area_changes() {
    let one = places(&scene(&table("[[100, 100], [700, 120], [650, 800], [80, 600]]", "")).expect("sound"));
    let other =
        places(&scene(&table("[[300, 0], [1000, 500], [500, 1000], [200, 700]]", "")).expect("sound"));
    let rings = [
        [(100.0, 100.0), (700.0, 120.0), (650.0, 800.0), (80.0, 600.0)].map(DVec2::from),
        [(300.0, 0.0), (1000.0, 500.0), (500.0, 1000.0), (200.0, 700.0)].map(DVec2::from),
    ];
    let common = |set: &BTreeSet<(u64, u64)>| -> Vec<_> {
        let inside = |place: DVec2| rings.iter().all(|ring| polygon::contains([&ring[..]], place));
        set.iter().copied().filter(|&place| inside(at(place))).collect()
    };
    assert!(common(&one).len() > 1000);
    assert_eq!(common(&one), common(&other));
}

#[test]
fn the_same_tree_stands_where_it_stood_on_another_cut_of_the_ground() {
    let area = "[[300, 300], [600, 300], [600, 600], [300, 600]]";
    let whole = scene(&table(area, "")).expect("sound");
    let part = scene_on(valley((200.0, 250.0), 60), &table(area, "")).expect("sound");
    let near = |scene: &SceneModel| -> Vec<DVec2> { places(scene).into_iter().map(at).collect() };
    let (whole, part) = (near(&whole), near(&part));
    assert!(whole.len() > 700 && whole.len() == part.len(), "{} and {}", whole.len(), part.len());
    // A place is kept in f32 from the ground's own origin.
    assert!(whole.iter().all(|tree| part.iter().any(|other| tree.distance(*other) < 1e-3)));
}

#[test]
fn density_and_spacing_are_as_asked() {
    for (density, spacing) in [(100.0, 5.0), (25.0, 10.0), (200.0, 0.0)] {
        let text = table(ALL, &format!("density = {density}\nspacing = {spacing}"));
        let found = places(&scene(&text).expect("sound"));
        let expected = density * 100.0;
        assert!((found.len() as f64 / expected - 1.0).abs() < 0.05, "{} for {expected}", found.len());
        let mut trees: Vec<DVec2> = found.into_iter().map(at).collect();
        trees.sort_by(|a, b| a.y.total_cmp(&b.y));
        for (index, tree) in trees.iter().enumerate() {
            let near = trees[index + 1..].iter().take_while(|other| other.y - tree.y < spacing);
            near.for_each(|other| assert!(tree.distance(*other) >= spacing - 1e-3));
        }
    }
}

#[test]
fn spacing_that_leaves_no_room_for_the_density_is_told() {
    let scene = scene(&table(ALL, "density = 40\nspacing = 10")).expect("sound");
    assert!((2850..3150).contains(&scene.placements.len()), "{}", scene.placements.len());
    assert!(
        scene.notes().iter().any(|note| note.contains("`spacing` leaves no room")),
        "{:?}",
        scene.notes()
    );
}

#[test]
fn nothing_stands_in_a_clearing() {
    let text = "[[scatter]]\nof = [\"shrub\", \"rock\"]\nfile = \"wood.geojson\"\ncrs = \"EPSG:32616\"\n";
    let scene = scene(text).expect("sound");
    assert!((4500..5100).contains(&scene.placements.len()), "48 ha: {}", scene.placements.len());
    for tree in places(&scene).into_iter().map(at) {
        let clearing = (300.0..700.0).contains(&tree.x) && (300.0..700.0).contains(&tree.y);
        assert!(!clearing && tree.x >= 100.0 && tree.y <= 900.0, "{tree}");
    }
    let shrubs = scene.placements.iter().filter(|placement| placement.model == 0).count();
    assert!((0.45..0.55).contains(&(shrubs as f64 / scene.placements.len() as f64)), "{shrubs}");
}

#[test]
fn slope_and_elevation_limits_hold_and_what_they_cost_is_told() {
    let scene = scene(&table(ALL, "slope = [10, 25]\nelevation = [120, 200]")).expect("sound");
    let lattice = &scene.lattice;
    assert!(scene.placements.len() > 1000);
    for placement in &scene.placements {
        let map = placement.at.as_dvec2() + lattice.origin();
        let height = ground_height(lattice, Interpolation::Planar, map).height_m().expect("ground");
        let slope = ground_gradient(lattice, GradientSurface::Planar, map).expect("ground").slope_deg();
        assert!((119.99..=200.01).contains(&height), "{height}");
        assert!((9.9..=25.1).contains(&slope), "{slope}");
    }
    let row = &scene.report.scattered[0];
    assert_eq!(row.models, scene.placements.len());
    assert!(row.by_slope > 1000 && row.by_elevation > 1000, "{row:?}");
    assert!(scene.notes().iter().any(|note| note.contains("models stand in 1 area")), "{:?}", scene.notes());
}

#[test]
fn nothing_stands_on_roads_water_or_what_stands_there() {
    let text = table(ALL, "scale = [1, 1]")
        + "[[road]]\npoints = [[100, 0], [600, 1000]]\nwidth = 30\n\
           [[lake]]\npoints = [[700, 200], [900, 200], [900, 400], [700, 400]]\nlevel = 120\n\
           [[model]]\nfile = \"rock\"\nat = [800, 800]\nscale = 40\n";
    let scene = scene(&text).expect("sound");
    let (from, to) = (DVec2::new(100.0, 0.0), DVec2::new(600.0, 1000.0));
    let across = (to - from).normalize().perp();
    let strewn = &scene.placements[1..];
    assert!(strewn.len() > 8000);
    for placement in strewn {
        let tree = placement.at.as_dvec2() + scene.lattice.origin();
        // A spruce keeps half its boughs' reach of some 3.7 m.
        assert!((tree - from).dot(across).abs() > 16.5, "{tree} on the road");
        let water = (699.0..901.0).contains(&tree.x) && (199.0..401.0).contains(&tree.y);
        assert!(!water, "{tree} in the lake");
        assert!(tree.distance(DVec2::splat(800.0)) > 20.0, "{tree} in the rock");
    }
}

#[test]
fn areas_that_overlap_have_each_tree_once_and_seeds_strew_otherwise() {
    let once = places(&scene(&table(ALL, "")).expect("sound"));
    let seeded = places(&scene(&table(ALL, "seed = 1")).expect("sound"));
    assert!(once.is_disjoint(&seeded));
    let scratch = r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[0,0],[600,0],[600,1000],[0,1000],[0,0]]]}},
        {"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[400,0],[1000,0],[1000,1000],[400,1000],[400,0]]]}}]}"#;
    let folder = Scratch::new();
    folder.write("s/valley.asc", valley((0.0, 0.0), 101));
    folder.write("s/two.geojson", scratch);
    let text = "[terrain]\ndem = \"valley.asc\"\ncrs = \"EPSG:32616\"\n[[scatter]]\nof = \"conifer\"\n\
                file = \"two.geojson\"\ncrs = \"EPSG:32616\"\n";
    let document = parse_bytes("scene.toml", text.as_bytes()).expect("sound");
    let assets = Assets::new(&folder.at("s/scene.toml"), &[]).expect("the folder is there");
    let two = build(&document, &assets, &|_| ()).expect("sound");
    assert_eq!(two.placements.len(), places(&two).len(), "each once");
    assert_eq!(places(&two), once);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let text = table(ALL, "density = 300\nscale = [0.5, 2]");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let scene = pool.install(|| scene(&text)).expect("sound");
        let looks = |placement: &sandtable_scene::placed_model::Placement| {
            [placement.at.x, placement.at.y, placement.scale, placement.heading_rad].map(f32::to_bits)
        };
        scene.placements.iter().map(looks).collect::<Vec<_>>()
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn more_than_can_stand_is_refused() {
    for (lines, words) in [
        ("density = 3000\nspacing = 0", "more than 1000000 models stand"),
        ("density = 100000\nspacing = 0\nelevation = [5000, 6000]", "so dense a pattern"),
    ] {
        let wide = valley((0.0, 0.0), 601);
        let area = "[[0, 0], [6000, 0], [6000, 6000], [0, 6000]]";
        let error = scene_on(wide, &table(area, lines)).err().expect("refused");
        assert!(error.contains(words), "{error}");
    }
}

//! Bridges and tunnels of whole scenes: decks one can ask heights of, solids without holes, and what the report says.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::common::data::data;
use crate::common::scratch::Scratch;
use glam::{DVec2, Vec3};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, FeatureId};
use sandtable_picture::build_draw_list;
use sandtable_render::cpu;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::feature_meshes::Coat;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_structure::deck_check::closed;
use sandtable_terrain::query::{Interpolation, Surface, ground_height};
use sandtable_view::camera::Camera;

fn scene(path: &Path, allow: Vec<PathBuf>) -> SceneModel {
    open_scene(path, &allow, &|_| {}).unwrap_or_else(|failure| panic!("{failure:?}"))
}

fn crossing() -> SceneModel {
    scene(&Path::new(env!("SANDTABLE_ROOT")).join("scenes/bridge.toml"), Vec::new())
}

/// Every bridge's solids, by feature.
fn bridges(scene: &SceneModel) -> BTreeMap<FeatureId, Vec<&DrawMesh>> {
    let mut all: BTreeMap<FeatureId, Vec<&DrawMesh>> = BTreeMap::new();
    for solid in &scene.solids {
        if scene.features[solid.feature.0 as usize - 2].kind == FeatureKind::Bridge {
            all.entry(solid.feature).or_default().push(&solid.mesh);
        }
    }
    all
}

#[test]
fn on_a_bridge_the_scene_is_its_deck_and_the_ground_is_the_ground() {
    let scene = crossing();
    // Over the creek, on the middle of the viaduct.
    let at = DVec2::new(747_840.0, 4_022_965.0);
    let height =
        |surface| scene.heights.height(surface, Interpolation::Planar, at).height_m().expect("ground");
    let (deck, ground) = (height(Surface::Scene), height(Surface::Ground));
    assert!(deck > 440.0 && deck < 480.0, "the deck lies at {deck} m");
    assert!(deck - ground > 60.0, "{deck} m over {ground} m");
    let aside = at + DVec2::new(60.0, -60.0);
    let asked = |surface| scene.heights.height(surface, Interpolation::Planar, aside);
    assert_eq!(asked(Surface::Scene), asked(Surface::Ground), "beside the bridge there is only the ground");
}

/// A color that only the dark of a tunnel's mouth has.
fn is_dark(color: Srgba) -> bool {
    color == Srgba::opaque(22, 21, 22)
}

/// The corners of the dark of each tunnel's mouth, with its normal: out of the tunnel.
fn mouths(scene: &SceneModel) -> Vec<(Vec<Vec3>, Vec3)> {
    let is_tunnel = |feature: FeatureId| scene.features[feature.0 as usize - 2].kind == FeatureKind::Tunnel;
    let portals = scene.solids.iter().filter(|solid| is_tunnel(solid.feature));
    let mouth = |mesh: &DrawMesh| {
        let dark: Vec<_> = mesh.vertices.iter().filter(|vertex| is_dark(vertex.color)).collect();
        (dark.iter().map(|vertex| Vec3::from(vertex.position)).collect(), Vec3::from(dark[0].normal))
    };
    portals.map(|solid| mouth(&solid.mesh)).collect()
}

#[test]
fn no_ground_is_seen_in_the_mouth_of_a_tunnel() {
    for name in ["bridge.toml", "earthworks.toml"] {
        let scene = scene(&Path::new(env!("SANDTABLE_ROOT")).join("scenes").join(name), Vec::new());
        let mouths = mouths(&scene);
        assert!(mouths.len() > 1, "{name}");
        for (corners, outward) in mouths {
            let top = corners.iter().map(|at| at.z).fold(f32::MIN, f32::max);
            let middle = corners.iter().sum::<Vec3>() / corners.len() as f32;
            let half = corners.iter().map(|at| (*at - middle).truncate().length()).fold(0.0, f32::max);
            let height = 6.0 + 0.25 * (2.0 * half - 7.2f32).max(0.0);
            let foot = middle.with_z(top - height);
            let (eye, target) = (foot + outward * 14.0 + Vec3::Z * 2.5, foot + Vec3::Z * 0.5 * height);
            let camera = Camera::new(eye, target, 1.2, (480, 360), (0.2, 20_000.0)).expect("sound");
            let shot = build_draw_list(&scene, &camera, &|_| ());
            let picture = cpu::render(&shot.list, &camera, &cpu::RenderQuality::default()).expect("sound");
            let aside = outward.cross(Vec3::Z).normalize();
            let mut seen = 0;
            for step in 0..21 * 12 {
                let part = ((step % 21) as f32 / 10.0 - 1.0) * 0.88;
                // As high as the upright part reaches, and from above the road's crown.
                let above = height * (0.04 + 0.42 * (step / 21) as f32 / 11.0);
                let at = foot + aside * half * part + Vec3::Z * above;
                let pixel = camera.project(at).expect("in view").pixel;
                let index = pixel.y as usize * 480 + pixel.x as usize;
                assert!(
                    picture.features[index] != FeatureId::GROUND,
                    "{name}: ground in the mouth at {at}, {part} aside and {above} m up"
                );
                seen += 1;
            }
            assert_eq!(seen, 252);
        }
    }
}

#[test]
fn no_ground_stands_over_a_deck() {
    for (name, scale) in [("bridge.toml", 1.5), ("earthworks.toml", 1.0)] {
        let scene = scene(&Path::new(env!("SANDTABLE_ROOT")).join("scenes").join(name), Vec::new());
        let is_bridge =
            |feature: FeatureId| scene.features[feature.0 as usize - 2].kind == FeatureKind::Bridge;
        let decks = scene
            .solids
            .iter()
            .filter(|solid| is_bridge(solid.feature) && matches!(solid.coat, Coat::Surface(_)));
        let mouths = mouths(&scene);
        let is_in_tunnel = |at: Vec3| {
            mouths.iter().any(|(corners, outward)| {
                let from_mouth = (at - corners[0]).with_z(0.0);
                from_mouth.length() < 60.0 && from_mouth.dot(*outward) < 0.0
            })
        };
        let mut looked_at = 0;
        for mesh in decks.map(|solid| &solid.mesh) {
            for triangle in &mesh.triangles {
                let corners = triangle.map(|id| Vec3::from(mesh.vertices[id.index()].position));
                // Off the line where the deck lies on the ground.
                let middle = corners.iter().sum::<Vec3>() / 3.0;
                let places = corners.map(|corner| corner.lerp(middle, 0.05)).into_iter();
                for at in places.filter(|&at| !is_in_tunnel(at)) {
                    let map = scene.lattice.origin() + at.truncate().as_dvec2();
                    let ground = ground_height(&scene.lattice, Interpolation::Planar, map).height_m();
                    let over = ground.expect("on the model") * scale - f64::from(at.z);
                    // What a tunnel's mouth allows.
                    assert!(over < 0.25, "{name}: ground {over} m over a deck at {at}");
                    looked_at += 1;
                }
            }
        }
        assert!(looked_at > 100, "{name}");
    }
}

#[test]
fn a_valley_crossing_has_two_bridges_and_a_tunnel_with_two_portals() {
    let scene = crossing();
    let kinds: Vec<(FeatureKind, usize)> = scene.census();
    assert!(
        kinds.contains(&(FeatureKind::Bridge, 2)) && kinds.contains(&(FeatureKind::Tunnel, 1)),
        "{kinds:?}"
    );
    let portals = scene
        .solids
        .iter()
        .filter(|solid| scene.features[solid.feature.0 as usize - 2].kind == FeatureKind::Tunnel);
    assert_eq!(portals.count(), 2);
    let viaduct = scene.report.bridges_and_tunnels.iter().find(|row| row.name == "Cove Creek viaduct");
    let viaduct = viaduct.expect("it is reported");
    assert_eq!((viaduct.kind, viaduct.by), ("bridge", "tag"));
    assert!(viaduct.greatest_height_above_ground > 60.0, "{viaduct:?}");
    assert!(viaduct.greatest_depth_below_ground < 0.01, "{viaduct:?}");
    assert!(viaduct.lowest_clearance > Some(50.0), "the creek and the track are far below: {viaduct:?}");
    assert!(matches!(viaduct.piers, Some(5..20)), "{viaduct:?}");
}

#[test]
fn every_bridge_is_closed_and_stands_on_the_ground() {
    let scene = crossing();
    let all = bridges(&scene);
    assert_eq!(all.len(), 2);
    for (feature, meshes) in all {
        assert_eq!(closed(&meshes), Ok(()), "{feature:?}");
    }
}

#[test]
fn too_many_piers_are_refused_at_the_bridge_that_asks_for_most() {
    let scratch = Scratch::new();
    let dem = Path::new(env!("SANDTABLE_ROOT")).join("assets/jacksboro/valley.asc");
    scratch.write("valley.asc", std::fs::read(dem).expect("readable"));
    let zigzag: Vec<String> =
        (0..100).map(|at| format!("[{}, {}]", 746_100 + at * 80, 4_015_200 + at % 2 * 8000)).collect();
    let text = format!(
        "[terrain]\ndem = \"valley.asc\"\ncrs = \"EPSG:32616\"\n[[bridge]]\npier_spacing = 1\npoints = [{}]\n\
         [[camera]]\nname = \"a\"\neye = [750000, 4018000]\neye_height = 900\nlook_at = [750100, 4019000]\n",
        zigzag.join(", ")
    );
    let path = scratch.write("scene.toml", text);
    let failure = open_scene(&path, &[], &|_| {}).err().expect("too many");
    assert!(format!("{failure:?}").contains("piers"), "{failure:?}");
}

/// Builds a city's roads and tells how its bridges and tunnels came out.
fn city(dem: &str, roads: &str) -> Option<SceneModel> {
    let (dem, roads) = (data(dem)?, data(roads)?);
    let scratch = Scratch::new();
    let text = format!(
        "points_crs = \"EPSG:4326\"\n[terrain]\ndem = {dem:?}\n[[road]]\nfile = {roads:?}\nwidth = 7\n"
    );
    let path = scratch.write("scene.toml", text);
    let folders = [dem, roads].iter().filter_map(|file| file.parent().map(Path::to_path_buf)).collect();
    Some(scene(&path, folders))
}

fn holds(scene: &SceneModel) {
    for (feature, meshes) in bridges(scene) {
        assert_eq!(closed(&meshes), Ok(()), "{feature:?}");
    }
    let rows = &scene.report.bridges_and_tunnels;
    let of_kind = |kind: &'static str| rows.iter().filter(move |row| row.kind == kind);
    for row in of_kind("bridge") {
        assert!(row.greatest_depth_below_ground < 0.3, "a deck lies below the ground: {row:?}");
    }
    for kind in ["bridge", "tunnel", "underpass"] {
        let portals: usize = of_kind(kind).filter_map(|row| row.portals).sum();
        println!("{} of kind {kind}, {portals} portals", of_kind(kind).count());
    }
    let steepest = of_kind("bridge").map(|row| row.steepest_grade).fold(0.0, f64::max);
    println!("the steepest bridge rises {steepest:.1} %");
}

#[test]
fn monaco_s_bridges_and_tunnels_are_built() {
    let roads = "scenes/monaco/derived/roads.geojson";
    let Some(scene) = city("scenes/monaco/N43E007.hgt.zip", roads) else { return };
    assert_eq!(scene.report.bridges_and_tunnels.len(), 83, "20 bridges and 63 tunnels");
    holds(&scene);
}

#[test]
fn porto_alegre_s_bridges_and_tunnels_are_built() {
    let roads = "scenes/porto_alegre_br/derived/roads_centre.geojson";
    let Some(scene) = city("scenes/porto_alegre_br/poa_elevation.tif", roads) else { return };
    holds(&scene);
    assert!(bridges(&scene).len() > 40);
}

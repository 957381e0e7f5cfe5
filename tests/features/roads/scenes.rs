//! Small scenes on level ground, where every area can be worked out by hand.

use sandtable_mesh::sink::VertexId;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_scene::scene_model::SceneModel;

use crate::common::scratch::Scratch;
use crate::roads::{area_m2, built, check_laid, scene};

const ASPHALT: [RibbonSurface; 4] = [
    RibbonSurface::Asphalt,
    RibbonSurface::AsphaltSolid,
    RibbonSurface::AsphaltEdges,
    RibbonSurface::AsphaltPlain,
];

fn laid(features: &str) -> SceneModel {
    let scene = scene(&Scratch::new(), features);
    check_laid(&scene);
    scene
}

#[track_caller]
fn assert_area(scene: &SceneModel, surfaces: &[RibbonSurface], expected_m2: f64) {
    let found = area_m2(scene, surfaces);
    assert!(
        (found - expected_m2).abs() < 0.01 + 1e-6 * expected_m2,
        "{surfaces:?}: {found} m2, not {expected_m2}"
    );
}

#[test]
fn a_crossing_without_a_vertex_is_joined_and_both_roads_end_at_it() {
    let scene = laid(
        "[[road]]\nwidth = 10\npoints = [[100, 500], [900, 500]]\n\
         [[road]]\nwidth = 6\nmarkings = 'solid'\npoints = [[500, 100], [500, 900]]\n",
    );
    assert_area(&scene, &[RibbonSurface::AsphaltJunction], 60.0);
    assert_area(&scene, &[RibbonSurface::Asphalt], 794.0 * 10.0);
    assert_area(&scene, &[RibbonSurface::AsphaltSolid], 790.0 * 6.0);
}

#[test]
fn a_track_ends_at_the_curb_of_the_asphalt_that_goes_through() {
    let scene = laid(
        "[[road]]\nwidth = 10\npoints = [[100, 500], [500, 500], [900, 500]]\n\
         [[road]]\nwidth = 4\nsurface = 'track'\npoints = [[500, 500], [500, 900]]\n",
    );
    assert_area(&scene, &[RibbonSurface::Asphalt], 8000.0);
    assert_area(&scene, &[RibbonSurface::Track, RibbonSurface::TrackJunction], 395.0 * 4.0);
}

#[test]
fn asphalt_that_ends_on_gravel_is_joined_to_it_in_asphalt() {
    let scene = laid(
        "[[road]]\nwidth = 8\nsurface = 'gravel'\npoints = [[100, 500], [500, 500], [900, 500]]\n\
         [[road]]\nwidth = 6\npoints = [[500, 500], [500, 900]]\n",
    );
    assert_area(&scene, &[RibbonSurface::AsphaltJunction], 48.0);
    assert_area(&scene, &[RibbonSurface::Gravel], 794.0 * 8.0);
    assert_area(&scene, &[RibbonSurface::Asphalt], 396.0 * 6.0);
}

#[test]
fn the_ground_below_an_overpass_runs_through_and_a_bridge_is_not_laid() {
    let line = |bridge: &str, points: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"bridge\":\"{bridge}\"}},\
             \"geometry\":{{\"type\":\"LineString\",\"coordinates\":[{points}]}}}}"
        )
    };
    let lines = [
        line("no", "[100, 500], [500, 500], [900, 500]"),
        line("no", "[500, 100], [500, 450]"),
        line("yes", "[500, 450], [500, 500], [500, 550]"),
        line("no", "[500, 550], [500, 900]"),
    ];
    let folder = Scratch::new();
    let text = format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", lines.join(","));
    folder.write("roads.geojson", text);
    let ground = "crs = 'EPSG:32616'\n[[road]]\nfile = 'roads.geojson'\ncrs = 'EPSG:32616'\nwidth = 8\n";
    let scene = scene(&folder, ground);
    check_laid(&scene);
    assert_area(&scene, &[RibbonSurface::AsphaltJunction], 0.0);
    assert_area(&scene, &[RibbonSurface::Asphalt], (800.0 + 2.0 * 350.0) * 8.0);
}

#[test]
fn shoulders_lie_beside_the_carriageway_and_join_below_every_other_road() {
    let scene = laid(
        "[[road]]\nwidth = 10\nshoulder = 3\npoints = [[100, 500], [500, 500], [900, 500]]\n\
         [[road]]\nwidth = 4\nsurface = 'track'\npoints = [[500, 500], [500, 900]]\n",
    );
    assert_area(&scene, &ASPHALT, 8000.0);
    assert_area(&scene, &[RibbonSurface::Shoulder], 800.0 * 6.0 - 3.0 * 4.0);
}

#[test]
fn widths_at_each_point_give_trapezia_with_one_texture_length() {
    let scene = laid("[[road]]\nwidths = [4, 4, 12]\npoints = [[100, 500], [500, 500], [900, 500]]\n");
    assert_area(&scene, &[RibbonSurface::Asphalt], 400.0 * 4.0 + 400.0 * 8.0);
}

#[test]
fn dashes_go_on_where_one_line_ends_and_the_next_begins() {
    let scene = laid(
        "[[road]]\nwidth = 10\npoints = [[100, 500], [510, 500]]\n\
         [[road]]\nwidth = 10\npoints = [[900, 500], [510, 500]]\n",
    );
    let v_at_joint = |road: usize| {
        let plan = &scene.ribbons[road].plan;
        let corner = |id: &VertexId| plan.vertices[id.index()];
        let at_joint =
            plan.triangles.iter().flatten().map(corner).find(|corner| (corner.at.x - 510.0).abs() < 1e-9);
        at_joint.expect("both end there").uv.y
    };
    assert!((v_at_joint(0) - v_at_joint(1)).abs() < 1e-4);
    assert!((v_at_joint(0) - 410.0 / 25.0).abs() < 1e-4);
}

#[test]
fn a_road_beyond_all_measure_still_has_no_two_triangles_over_one_another() {
    let scene = laid(
        "[[road]]\nwidth = 400\npoints = [[100, 100], [110, 100], [110, 115], [105, 101], [300, 700]]\n\
         [[road]]\nwidth = 300\njoin = 'round'\npoints = [[100, 900], [900, 100], [105, 895]]\n",
    );
    assert!(area_m2(&scene, &ASPHALT) + area_m2(&scene, &[RibbonSurface::AsphaltJunction]) > 2e5);
}

#[test]
fn the_junctions_of_the_gallery_lie_apart() {
    let scenes = std::path::Path::new(env!("SANDTABLE_ROOT")).join("scenes");
    for name in ["junctions.toml", "road.toml", "jacksboro.toml"] {
        check_laid(&built(&scenes.join(name), &[]));
    }
}

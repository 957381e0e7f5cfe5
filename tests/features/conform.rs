//! Roads that the ground follows, from the scene file to the ground: what is promised of them, on made-up hills and on
//! real ones.

use std::path::Path;

use glam::DVec2;
use sandtable_description::parse::parse_bytes;
use sandtable_earthworks::alignment::Support;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::report::ConformedRoadRow;
use sandtable_scene::roads::profiles::RoadProfile;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::query::{Interpolation, ground_height};

use crate::common::data::data;
use crate::common::scratch::Scratch;

/// How far a level that was rounded to f32 may be off, in meters.
const ROUNDED_M: f64 = 1e-3;

fn scene(file: &Path, text: &str) -> Result<SceneModel, String> {
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(file, &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

/// A scene over 81 × 61 posts 10 m apart with this height at each place, `text` after its `[terrain]`.
fn made_up(height: impl Fn(f64, f64) -> f64, text: &str) -> Result<SceneModel, String> {
    let scratch = Scratch::new();
    let at = |index: u32| (f64::from(index % 81) * 10.0, f64::from(60 - index / 81) * 10.0);
    let heights: Vec<String> = (0..81 * 61).map(at).map(|(x, y)| format!("{:.4}", height(x, y))).collect();
    let grid =
        "ncols 81\nnrows 61\nxllcorner -5\nyllcorner -5\ncellsize 10\n".to_owned() + &heights.join(" ");
    std::fs::write(scratch.at("ground.asc"), grid).expect("a file");
    scene(
        &scratch.at("scene.toml"),
        &format!("[terrain]\ndem = \"ground.asc\"\ncrs = \"EPSG:32616\"\n{text}"),
    )
}

fn hills(x: f64, y: f64) -> f64 {
    120.0 + 14.0 * libm::sin(x / 60.0) * libm::cos(y / 80.0) + 3.0 * libm::sin(x / 17.0 + y / 23.0)
}

/// What the report says of the first road that conforms.
fn conformed(scene: &SceneModel) -> &ConformedRoadRow {
    scene.report.conformed_roads.first().expect("a road conforms")
}

fn ground(scene: &SceneModel, at: DVec2) -> f64 {
    let answer = ground_height(&scene.lattice, Interpolation::Planar, at);
    answer.height_m().expect("on the model")
}

fn steepest(profile: &RoadProfile) -> f64 {
    let pairs = profile.design.stations().windows(2).zip(profile.design.values().windows(2));
    let grades = pairs
        .filter(|(at, _)| at[1] - at[0] > 1e-3)
        .map(|(at, level)| (level[1] - level[0]).abs() / (at[1] - at[0]));
    grades.fold(0.0, f64::max)
}

#[test]
fn the_ground_takes_the_road_s_level_and_its_profile_tells_it() {
    let road = "[[road]]\nname = \"lane\"\nprofile = \"conform\"\nwidth = 8\nmax_grade = 6\npoints = [[30, 300], [760, 300]]";
    let scene = made_up(hills, road).expect("sound");
    let [profile] = &scene.profiles[..] else { panic!("one road") };
    assert_eq!((profile.name.as_str(), profile.design.stations()[0]), ("lane", 0.0));
    assert!(steepest(profile) <= 0.06 + 1e-6, "{}", steepest(profile));
    let moved = conformed(&scene).cut + conformed(&scene).fill;
    assert!(moved > 10_000.0, "{moved} m³");
    for (station, (before, design)) in
        profile.design.stations().iter().zip(profile.ground.values().iter().zip(profile.design.values()))
    {
        let x = 30.0 + station;
        assert!((before - hills(x, 300.0)).abs() < 1.0, "the ground as it was at {x}");
        for y in [296.5, 300.0, 303.5] {
            let off = ground(&scene, DVec2::new(x, y)) - design;
            assert!(off.abs() < 0.03, "{off} m at ({x}, {y})");
        }
    }
}

#[test]
fn far_from_the_road_the_ground_answers_as_before() {
    let road = "[[road]]\nprofile = \"conform\"\nwidth = 8\npoints = [[30, 300], [760, 300]]";
    let [before, after] = ["", road].map(|text| made_up(hills, text).expect("sound"));
    assert!(after.lattice.columns() > before.lattice.columns(), "more posts were put in");
    assert_eq!(after.lattice.extent(), before.lattice.extent());
    for index in 0..500 {
        let at = DVec2::new(f64::from(index) * 1.6, f64::from(index * 37 % 180));
        assert!((ground(&after, at) - ground(&before, at)).abs() < 1e-4, "at {at}");
    }
}

#[test]
fn roads_that_meet_agree_on_their_level_whether_or_not_they_share_a_vertex() {
    let road = |points: &str| {
        format!("[[road]]\nprofile = \"conform\"\nmax_grade = 5\nwidth = 7\npoints = {points}\n")
    };
    let text = road("[[40, 200], [400, 240], [760, 200]]")
        + &road("[[400, 240], [420, 560]]")
        + &road("[[600, 40], [620, 560]]");
    let scene = made_up(hills, &text).expect("sound");
    let level = |road: usize, station: f64| {
        let profile = &scene.profiles[road];
        let place =
            profile.design.stations().iter().position(|at| (at - station).abs() < 1e-6).expect("a station");
        profile.design.values()[place]
    };
    let first = DVec2::new(40.0, 200.0).distance(DVec2::new(400.0, 240.0));
    assert_eq!(level(0, first), level(1, 0.0));
    // They cross at y = 240 − 40 (x − 400) / 360 and x = 600 + 20 (y − 40) / 520.
    let y = (240.0 - 40.0 * (600.0 - 400.0 - 800.0 / 520.0) / 360.0) / (1.0 + 40.0 * 20.0 / (360.0 * 520.0));
    let crossing = DVec2::new(600.0 + 20.0 * (y - 40.0) / 520.0, y);
    let along = [
        (0, first + crossing.distance(DVec2::new(400.0, 240.0))),
        (2, crossing.distance(DVec2::new(600.0, 40.0))),
    ];
    let levels = along.map(|(road, station)| level(road, station));
    assert!((levels[0] - levels[1]).abs() < 1e-6, "{levels:?}");
}

#[test]
fn a_ravine_is_bridged_and_a_ridge_tunneled_by_rule() {
    let land = |x: f64, _: f64| match x {
        x if (300.0..340.0).contains(&x) => 60.0,
        x if (540.0..660.0).contains(&x) => 160.0,
        _ => 100.0,
    };
    let road = "[[road]]\nprofile = \"conform\"\nwidth = 8\nmax_fill = 8\nmax_cut = 10\npoints = [[30, 300], [760, 300]]";
    let scene = made_up(land, road).expect("sound");
    let row = conformed(&scene);
    assert_eq!((row.bridges, row.tunnels), (1, 1));
    assert!(row.highest_fill <= 8.0 && row.deepest_cut <= 10.0);
    let carried: Vec<Support> = scene.profiles[0].supports.clone();
    let mut order = carried.clone();
    order.dedup();
    let expected = [Support::Ground, Support::Bridge, Support::Ground, Support::Tunnel, Support::Ground];
    assert_eq!(order, expected);
    assert!(ground(&scene, DVec2::new(320.0, 300.0)) < 61.0, "the ravine stays");
    assert!(ground(&scene, DVec2::new(600.0, 300.0)) > 159.0, "the ridge stays");
    assert!(
        scene.notes().iter().any(|note| note.contains("on bridges 1 time and in tunnels 1 time")),
        "{:?}",
        scene.notes()
    );
}

#[test]
fn a_lake_s_level_holds_beside_an_embankment() {
    let text = "[[lake]]\nlevel = 90\npoints = [[300, 320], [500, 320], [500, 500], [300, 500]]\n\
        [[road]]\nprofile = \"conform\"\nwidth = 8\npoints = [[30, 290], [760, 290]]";
    let scene = made_up(|_, _| 100.0, text).expect("sound");
    for (x, y) in [(310.0, 330.0), (400.0, 325.0), (490.0, 480.0)] {
        assert_eq!(ground(&scene, DVec2::new(x, y)), 90.0);
    }
}

#[test]
fn more_road_than_can_be_held_is_refused_and_not_begun() {
    let end = |index: u32| if index.is_multiple_of(2) { "[0, 0]" } else { "[800, 600]" };
    let points: Vec<&str> = (0..100_000).map(end).collect();
    let text = format!("[[road]]\nprofile = \"conform\"\npoints = [{}]", points.join(", "));
    let refused = made_up(|_, _| 100.0, &text).err().expect("too many");
    assert!(refused.contains("stations") && refused.contains("let fewer of them conform"), "{refused}");
}

#[test]
fn a_real_town_s_roads_keep_their_grade_and_agree_where_they_meet() {
    let Some(folder) = data("scenes/swellendam_za") else { return };
    let text = "[terrain]\ndem = \"dem_srtm_wgs84_f32.tif\"\n\
        [[road]]\nfile = \"training_data.gpkg\"\nlayer = \"roads\"\nprofile = \"conform\"\n\
        width = 8\nmax_grade = 12\nmax_fill = 12\nmax_cut = 15\n";
    let scene = scene(&folder.join("scene.toml"), text).expect("sound");
    assert!(scene.profiles.len() > 600, "{} roads conform", scene.profiles.len());
    for profile in &scene.profiles {
        assert!(steepest(profile) <= 0.12 + 1e-6, "{} climbs {}", profile.name, steepest(profile));
    }
    assert!(!scene.report.conformed_roads.is_empty());
    for row in &scene.report.conformed_roads {
        assert!(row.highest_fill <= 12.0 + ROUNDED_M && row.deepest_cut <= 15.0 + ROUNDED_M, "{row:?}");
    }
}

/// A road of LandXML 100 m north of the hills' corner: 600 m east, up at 12 %, then down.
const ALIGNMENT: &str = "<LandXML><Units><Metric linearUnit=\"meter\"/></Units><CoordinateSystem epsgCode=\"32616\"/>\
    <Alignments><Alignment name=\"relief road\" staStart=\"1000\"><CoordGeom><Line><Start>100 60</Start><End>100 660</End></Line>\
    </CoordGeom><Profile><ProfAlign name=\"FG\"><PVI>1000 110</PVI><ParaCurve length=\"120\">1300 146</ParaCurve>\
    <PVI>1600 120</PVI></ProfAlign></Profile></Alignment></Alignments></LandXML>";

#[test]
fn a_road_keeps_the_profile_of_its_file_and_others_meet_it_there() {
    let scratch = Scratch::new();
    let at = |index: u32| (f64::from(index % 81) * 10.0, f64::from(60 - index / 81) * 10.0);
    let heights: Vec<String> = (0..81 * 61).map(at).map(|(x, y)| format!("{:.4}", hills(x, y))).collect();
    let grid =
        "ncols 81\nnrows 61\nxllcorner -5\nyllcorner -5\ncellsize 10\n".to_owned() + &heights.join(" ");
    scratch.write("ground.asc", grid);
    scratch.write("road.xml", ALIGNMENT);
    let text = |profile: &str| {
        format!(
            "[terrain]\ndem = \"ground.asc\"\ncrs = \"EPSG:32616\"\n[[road]]\nfile = \"road.xml\"\nlayer = \"alignments\"\nwidth = 8\n{profile}\n\
             [[road]]\nname = \"side\"\nprofile = \"conform\"\npoints = [[360, 100], [360, 400]]\n"
        )
    };
    let own = scene(&scratch.at("scene.toml"), &text("profile = \"own\"")).expect("a scene");
    let design =
        &own.profiles.iter().find(|profile| profile.name == "relief road").expect("it conforms").design;
    // Up, over the crest 120 · 0.2067 / 8 m below the intersection, and down.
    let crest = 146.0 - 120.0 * (0.12 + 26.0 / 300.0) / 8.0;
    for (station, level) in
        [(0.0, 110.0), (240.0, 138.8), (300.0, crest), (400.0, 146.0 - 26.0 / 3.0), (600.0, 120.0)]
    {
        assert!(
            (design.at(station) - level).abs() < 2e-3,
            "{station}: {} and not {level}",
            design.at(station)
        );
        if station > 0.0 && station < 600.0 {
            let on_ground = ground(&own, DVec2::new(60.0 + station, 100.0));
            assert!(
                (on_ground - level).abs() < 0.02,
                "{station}: the ground at {on_ground}, the road at {level}"
            );
        }
    }
    let side = own.profiles.iter().find(|profile| profile.name == "side").expect("it conforms");
    assert!((side.design.at(0.0) - crest).abs() < 0.01, "{}", side.design.at(0.0));
    let designed = scene(&scratch.at("scene.toml"), &text("profile = \"conform\"")).expect("a scene");
    let gentle = designed.profiles.iter().find(|profile| profile.name == "relief road").expect("it conforms");
    assert!(steepest(gentle) < 0.0801, "of its own accord it is no steeper than 8 %");
    let without = ALIGNMENT.replace("ProfAlign", "Other");
    scratch.write("road.xml", without);
    let told = scene(&scratch.at("scene.toml"), &text("profile = \"own\"")).expect("a scene");
    assert!(
        told.notes().iter().any(|note| note.contains("1 road without elevations all along")),
        "{:?}",
        told.notes()
    );
}

//! Water as water lies: rivers fall all the way, lakes are level, neither floats nor drowns its banks.

use glam::{DVec2, Vec3};
use proptest::prelude::*;
use sandtable_dem::hints::DemHints;
use sandtable_dem::read as dem;
use sandtable_description::parse::parse_bytes;
use sandtable_draw::list::DepthLayer;
use sandtable_earthworks::alignment::Alignment;
use sandtable_earthworks::channel;
use sandtable_earthworks::channel::check_rise;
use sandtable_earthworks::channel::flow;
use sandtable_earthworks::channel::flow::Flow;
use sandtable_earthworks::channel::river_cut::Channel;
use sandtable_earthworks::shore::{self, LakeBasin};
use sandtable_geom::polyline::Polyline;
use sandtable_picture::{build_draw_list, camera};
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_vector::feature::Geometry;
use sandtable_vector::read as vector;
use sandtable_view::camera::Camera;

use crate::common::data::data;
use crate::common::scratch::Scratch;

/// Rounding of a thousand meters to f32, on either side of a place.
const ROUNDING_M: f64 = 1e-3;

const SIDE: u32 = 48;
const CELL_M: f64 = 10.0;

/// Hills with rough ground on them, `steep` times as high.
fn hills(steep: f64) -> Lattice {
    let height = |index: u32| {
        let (x, y) = (f64::from(index % SIDE), f64::from(index / SIDE));
        let wave = |fx: f64, fy: f64| libm::sin(x * fx + y * fy);
        (300.0 + steep * (9.0 * wave(0.11, 0.05) + 4.0 * wave(-0.2, 0.3) + 2.0 * wave(1.7, 2.3))) as f32
    };
    let heights = (0..SIDE * SIDE).map(height).collect();
    Lattice::new(DVec2::new(4e5, 5e6), DVec2::splat(CELL_M), SIDE, heights).expect("sound")
}

/// Lines through points of one list, so that they share vertices, cross, turn back and leave the ground.
fn networks() -> impl Strategy<Value = Vec<(Polyline, f64)>> {
    let places = prop::collection::vec((-40.0..510.0f64, -40.0..510.0f64), 4..12);
    let lines = prop::collection::vec((prop::collection::vec(0usize..64, 2..7), 0.5..45.0f64), 1..6);
    (places, lines).prop_map(|(places, lines)| {
        let line = |(through, width_m): (Vec<usize>, f64)| {
            let points = through.into_iter().map(|index| DVec2::from(places[index % places.len()]));
            Polyline::new(points, 0.01).map(|line| (line, width_m))
        };
        lines.into_iter().filter_map(line).collect()
    })
}

/// The channels of `network`, cut as deep as it takes.
fn channels(lattice: &Lattice, network: &[(Polyline, f64)]) -> Vec<Channel> {
    let lines: Vec<&Polyline> = network.iter().map(|(line, _)| line).collect();
    let flows = flow::directions(lattice, &lines);
    let channel = |((line, width_m), flow): (&(Polyline, f64), Flow)| {
        let line = if flow == Flow::AsDrawn { line.clone() } else { line.reversed() };
        Channel {
            alignment: Alignment::on_ground(line, *width_m),
            bank_m: width_m / 3.0,
            max_cut_m: f64::INFINITY,
        }
    };
    network.iter().zip(flows).map(channel).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_ground_rises_along_any_river_of_any_network(network in networks(), steep in 0.0..4.0f64) {
        let mut lattice = hills(steep);
        let channels = channels(&lattice, &network);
        let cuts = channel::cut(&mut lattice, &channels).expect("narrow enough");
        prop_assert!(cuts.cuts.iter().all(|cut| cut.climbs.is_empty()));
        for channel in &channels {
            let rise_m = check_rise(&lattice, &channel.alignment.line, &[]);
            prop_assert!(rise_m < ROUNDING_M, "{rise_m}");
        }
    }

    #[test]
    fn nothing_is_cut_deeper_than_allowed_and_ground_rises_only_where_climbs_say_so(
        network in networks(), steep in 0.0..6.0f64, max_cut_m in 0.5..12.0f64, lake_m in 285.0..315.0f32,
    ) {
        let mut lattice = hills(steep);
        let shore = [(150.0, 160.0), (330.0, 140.0), (350.0, 300.0), (240.0, 260.0), (140.0, 330.0)];
        flood(&mut lattice, &shore.map(DVec2::from), lake_m);
        let mut channels = channels(&lattice, &network);
        channels.iter_mut().for_each(|channel| channel.max_cut_m = max_cut_m);
        let before = lattice.heights().to_vec();
        let cuts = channel::cut(&mut lattice, &channels).expect("narrow enough");
        for (after, before) in lattice.heights().iter().zip(&before) {
            prop_assert!(f64::from((after - before).abs()) < max_cut_m + ROUNDING_M, "{before} {after}");
        }
        for (channel, cut) in channels.iter().zip(&cuts.cuts) {
            let rise_m = check_rise(&lattice, &channel.alignment.line, &cut.climbs);
            prop_assert!(rise_m < ROUNDING_M, "{rise_m} {:?}", cut.climbs);
            prop_assert!(cut.climbs.windows(2).all(|pair| pair[0].to_m < pair[1].from_m));
        }
    }

    #[test]
    fn rivers_leave_a_lake_as_it_is_and_fall_to_it_and_from_it(
        network in networks(), steep in 0.0..4.0f64, level_m in 285.0..315.0f32,
    ) {
        let mut lattice = hills(steep);
        let shore = [(150.0, 160.0), (330.0, 140.0), (350.0, 300.0), (240.0, 260.0), (140.0, 330.0)];
        flood(&mut lattice, &shore.map(DVec2::from), level_m);
        let lake: Vec<Post> = lattice.posts().filter(|&post| lattice.is_pinned(post)).collect();
        prop_assert!(lake.len() > 200);
        let channels = channels(&lattice, &network);
        let cuts = channel::cut(&mut lattice, &channels).expect("narrow enough");
        prop_assert!(lake.iter().all(|&post| lattice.height(post) == level_m));
        prop_assert!(cuts.cuts.iter().all(|cut| cut.climbs.is_empty()));
        for channel in &channels {
            let rise_m = check_rise(&lattice, &channel.alignment.line, &[]);
            prop_assert!(rise_m < ROUNDING_M, "{rise_m}");
        }
    }
}

/// Levels the ground within a shore.
fn flood(lattice: &mut Lattice, shore: &[DVec2], level_m: f32) {
    let reach_m = shore::reach_m(0.0);
    shore::flood(lattice, &[LakeBasin { exterior: shore, holes: &[], level_m, reach_m }]);
}

#[test]
fn a_brook_on_ground_that_falls_already_takes_no_more_than_the_fall_across_it() {
    let heights = (0..SIDE * SIDE).map(|index| 500.0 - (index % SIDE) as f32).collect();
    let mut lattice = Lattice::new(DVec2::ZERO, DVec2::splat(CELL_M), SIDE, heights).expect("sound");
    let before = lattice.heights().to_vec();
    let line = Polyline::new([(12.0, 103.0), (233.0, 221.0), (440.0, 144.0)].map(DVec2::from), 0.0);
    let network = [(line.expect("a line"), 1.0)];
    let channels = channels(&lattice, &network);
    let cuts = channel::cut(&mut lattice, &channels).expect("narrow enough");
    // It is a meter wide, and the ground falls by a tenth.
    assert!(cuts.cuts[0].deepest_m < 0.06, "{:?}", cuts.cuts[0]);
    let moved = lattice.heights().iter().zip(&before).filter(|(after, before)| after != before).count();
    assert!(moved < 20, "a strip 3 m wide and 440 m long holds 13 posts 10 m apart, not {moved}");
}

/// Ground that falls a fiftieth eastward, with a ridge across it from south to north at 250 m.
fn ridge(height_m: f64) -> Lattice {
    let height = |index: u32| {
        let x = f64::from(index % SIDE) * CELL_M;
        (200.0 - x / 50.0 + height_m * (1.0 - (x - 250.0).abs() / 40.0).max(0.0)) as f32
    };
    Lattice::new(DVec2::ZERO, DVec2::splat(CELL_M), SIDE, (0..SIDE * SIDE).map(height).collect())
        .expect("sound")
}

fn across_the_ridge() -> [Channel; 1] {
    let line = Polyline::new([(20.0, 233.0), (450.0, 236.0)].map(DVec2::from), 0.0).expect("a line");
    [Channel { alignment: Alignment::on_ground(line, 6.0), bank_m: 2.0, max_cut_m: 10.0 }]
}

#[test]
fn a_dam_is_cut_through_and_a_ridge_is_left_and_told_of() {
    let mut dam = ridge(6.0);
    let cuts = channel::cut(&mut dam, &across_the_ridge()).expect("narrow enough").cuts;
    assert!(cuts[0].climbs.is_empty() && cuts[0].deepest_m > 4.0, "{:?}", cuts[0]);
    let mut hill = ridge(30.0);
    let before = hill.heights().to_vec();
    let cuts = channel::cut(&mut hill, &across_the_ridge()).expect("narrow enough").cuts;
    assert_eq!(cuts[0].climbs.len(), 1);
    let climb = cuts[0].climbs[0];
    assert!((climb.rise_m - 29.2).abs() < 0.5 && climb.from_m > 180.0 && climb.to_m < 235.0, "{climb:?}");
    let deepest =
        hill.heights().iter().zip(&before).map(|(after, before)| before - after).fold(0.0, f32::max);
    assert!(deepest < 0.2, "nothing is dug for a ridge that stays: {deepest} m");
}

#[test]
fn a_gully_beside_a_river_on_a_hillside_does_not_lower_all_below_it() {
    let height = |index: u32| 200.0 - (index % SIDE) as f32 / 5.0 - 2.0 * (index / SIDE) as f32;
    let even: Vec<f32> = (0..SIDE * SIDE).map(height).collect();
    let mut gullied = even.clone();
    (24..28).for_each(|row| gullied[row * SIDE as usize + 12] -= 80.0);
    let [even, gullied] = [even, gullied].map(|heights| {
        let mut lattice = Lattice::new(DVec2::ZERO, DVec2::splat(CELL_M), SIDE, heights).expect("sound");
        let cuts = channel::cut(&mut lattice, &across_the_ridge()).expect("narrow enough").cuts;
        (lattice, cuts[0].climbs.len())
    });
    assert!(even.1 == 0 && gullied.1 > 0, "{} {}", even.1, gullied.1);
    for post in even.0.posts().filter(|post| post.column > 16) {
        let deeper_m = even.0.height(post) - gullied.0.height(post);
        assert!(deeper_m.abs() < 0.1, "{post:?} is {deeper_m} m lower for a gully upstream");
    }
}

#[test]
fn a_river_wider_than_cells_lies_level_on_its_whole_width() {
    for quarter in 0..4 {
        let turned =
            |(x, y): (f64, f64)| (0..quarter).fold(DVec2::new(x, y) - 235.0, |at, _| at.perp()) + 235.0;
        let mut lattice = hills(1.0);
        let line = Polyline::new([turned((60.0, 235.0)), turned((410.0, 235.0))], 0.0).expect("a line");
        let channels = channels(&lattice, &[(line, 60.0)]);
        channel::cut(&mut lattice, &channels).expect("narrow enough");
        for step in 0..14 {
            let at = |aside: f64| {
                let world = turned((100.0 + 20.0 * f64::from(step), 235.0 + aside));
                let (post, _) = lattice.cell_at(world).expect("on the ground");
                f64::from(lattice.height(post))
            };
            let across: Vec<f64> = [-25.0, -15.0, -5.0, 5.0, 15.0, 25.0].map(at).to_vec();
            let (low, high) = across.iter().fold((f64::MAX, f64::MIN), |(l, h), &z| (l.min(z), h.max(z)));
            // A cell along the water may hold a fall; across it there is none.
            assert!(high - low < 1.0, "{across:?}");
        }
    }
}

#[test]
fn a_bed_of_more_posts_than_there_is_time_for_is_refused() {
    let mut lattice = hills(1.0);
    let zigzag = (0..20_000)
        .map(|index| DVec2::new(200.0 + f64::from(index % 2) * 90.0, 230.0 + f64::from(index) * 1e-3));
    let line = Polyline::new(zigzag, 0.0).expect("a line");
    let channel = Channel { alignment: Alignment::on_ground(line, 9000.0), bank_m: 1000.0, max_cut_m: 10.0 };
    let before = lattice.heights().to_vec();
    assert!(channel::cut(&mut lattice, &[channel]).is_err());
    assert_eq!(lattice.heights(), before);
}

fn gallery(name: &str) -> SceneModel {
    let path = std::path::Path::new(env!("SANDTABLE_ROOT")).join("scenes").join(name);
    open_scene(&path, &[], &|_| {}).unwrap_or_else(|failure| panic!("{failure:?}"))
}

#[test]
fn a_lake_is_level_for_every_camera() {
    let scene = gallery("lake.toml");
    let kind = |feature: sandtable_draw::list::FeatureId| scene.features[feature.0 as usize - 2].kind;
    for step in 0..60u16 {
        let turn = f32::from(step) * 2.399;
        let away = 600.0 + 120.0 * f32::from(step);
        let target = Vec3::new(4060.0, 6200.0, 470.0);
        let eye = target + Vec3::new(libm::cosf(turn), libm::sinf(turn), 0.4) * away;
        let Ok(camera) = Camera::new(eye, target, 0.7, (480, 270), (0.5, 60_000.0)) else { continue };
        let shot = build_draw_list(&scene, &camera, &|_| {});
        let lakes = shot.list.items.iter().filter(|item| {
            // Not the line along its shore.
            let is_water = shot.list.materials[item.material.0 as usize].is_water;
            is_water && matches!(item.layer, DepthLayer::Draped(_)) && kind(item.feature) == FeatureKind::Lake
        });
        let heights: Vec<f32> = lakes
            .flat_map(|item| &shot.list.meshes[item.mesh.0 as usize].vertices)
            .map(|vertex| vertex.position[2])
            .collect();
        assert!(heights.len() > 10, "the lake is in view of camera {step}");
        assert!(heights.iter().all(|&height| height == 312.5 * 1.5), "camera {step}");
    }
}

#[test]
fn the_report_tells_of_every_river_and_lake() {
    let scene = gallery("river.toml");
    let rivers = &scene.report.rivers;
    assert_eq!(rivers.len(), 3);
    assert!(rivers.iter().all(|river| river.to.is_some() && river.from > river.to), "{rivers:?}");
    let lakes = gallery("lake.toml").report.lakes;
    assert!(lakes.len() == 1 && lakes[0].level == 312.5 && lakes[0].area > 1e5, "{lakes:?}");
}

#[test]
fn no_river_of_the_gallery_is_a_canyon() {
    for name in ["river.toml", "lake.toml", "jacksboro.toml"] {
        let scene = gallery(name);
        let deepest = scene.report.rivers.iter().map(|river| river.deepest_cut).reduce(f64::max);
        let deepest = deepest.expect("a river");
        assert!(deepest < 10.0 + ROUNDING_M, "{name}: {deepest} m");
    }
}

#[test]
fn a_river_over_a_hill_is_told_of_and_a_deeper_cut_lets_it_through() {
    // The ground rises eastward, and of two ends that lie level with each other neither is the lower.
    let points = "points = [[60, 150], [250, 160], [60, 170]]\nwidth = 4\n";
    let scene = ramp(&format!("[[river]]\n{points}")).expect("sound");
    assert_eq!(scene.report.rivers.len(), 1);
    assert!(scene.report.rivers[0].greatest_climb > Some(10.0));
    assert!(scene.notes().iter().any(|note| note.contains("rises downstream at")), "{:?}", scene.notes());
    let scene = ramp(&format!("[[river]]\n{points}max_cut = 40\n")).expect("sound");
    assert!(scene.report.rivers[0].deepest_cut > 10.0);
    assert!(!scene.notes().iter().any(|note| note.contains("rises downstream at")), "{:?}", scene.notes());
}

#[test]
fn water_that_follows_the_ground_is_not_cut() {
    let text = "[[river]]\npoints = [[50, 150], [250, 150]]\nwater = \"drape\"\nmax_cut = 5\n";
    let refused = ramp(text).err().expect("it is not sensible");
    assert!(refused.contains("`max_cut` has no effect on draped water"), "{refused}");
}

/// A scene over ground that rises 1 m a post eastward, from `text` after its `[terrain]`.
fn ramp(text: &str) -> Result<SceneModel, String> {
    let heights: Vec<String> = (0..31 * 31).map(|index| (100 + index % 31).to_string()).collect();
    over_grid("xllcorner -5\nyllcorner -5\ncellsize 10", &heights, text)
}

/// A scene over 31 × 31 posts whose place is that of `grid`, from `text` after its `dem` and `crs`.
pub(crate) fn over_grid(grid: &str, heights: &[String], text: &str) -> Result<SceneModel, String> {
    over_grid_in(&Scratch::new(), grid, heights, text)
}

/// The same, beside the files of a folder.
pub(crate) fn over_grid_in(
    folder: &Scratch,
    grid: &str,
    heights: &[String],
    text: &str,
) -> Result<SceneModel, String> {
    folder.write("grid.asc", format!("ncols 31\nnrows 31\n{grid}\n{}", heights.join(" ")));
    let text = format!("[terrain]\ndem = \"grid.asc\"\ncrs = \"EPSG:32633\"\n{text}");
    let path = folder.write("scene.toml", &text);
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&path, &[]).map_err(|error| error.to_string())?;
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

/// A scene of lakes on a hillside of 90 m posts that rises 7 m in 10 m eastward and rolls northward.
fn coarse_hillside(lakes: &str) -> SceneModel {
    let height = |index: u32| {
        let (column, row) = (f64::from(index % 31), f64::from(index / 31));
        (300.0 + 63.0 * column + 40.0 * libm::sin(row * 0.7)).to_string()
    };
    let heights: Vec<String> = (0..31 * 31).map(height).collect();
    over_grid("xllcorner -45\nyllcorner -45\ncellsize 90", &heights, lakes).expect("sound")
}

#[test]
fn a_small_lake_on_a_coarse_model_moves_land_only_beside_its_shore() {
    // 1.57 ha, and a model of which one cell is half as large.
    let (low, high) = (DVec2::new(1217.0, 1240.0), DVec2::new(1342.0, 1365.6));
    let shore = format!(
        "[[{}, {}], [{}, {}], [{}, {}], [{}, {}]]",
        low.x, low.y, high.x, low.y, high.x, high.y, low.x, high.y
    );
    let (plain, lake) = (coarse_hillside(""), coarse_hillside(&format!("[[lake]]\npoints = {shore}\n")));
    let height = |scene: &SceneModel, at: DVec2| {
        ground_height(&scene.lattice, Interpolation::Planar, at).height_m().expect("on the model")
    };
    let (mut changed_m2, mut farthest_m) = (0.0, 0.0f64);
    for step in 0..400 * 400 {
        let at = DVec2::new(880.0, 900.0) + DVec2::new(f64::from(step % 400), f64::from(step / 400)) * 2.0;
        if (height(&plain, at) - height(&lake, at)).abs() > 0.01 {
            changed_m2 += 4.0;
            farthest_m = farthest_m.max((at - at.clamp(low, high)).length());
        }
    }
    println!(
        "{changed_m2} m² changed, up to {farthest_m} m from the shore, on posts {} m apart",
        lake.lattice.cell()
    );
    let area_m2 = (high - low).element_product();
    // A moved post moves the ground up to the next one.
    assert!(farthest_m < shore::reach_m(area_m2) + lake.lattice.cell().length(), "{farthest_m} m");
    assert!(changed_m2 > area_m2 && changed_m2 < area_m2 * 2.5, "{changed_m2} m² for a lake of {area_m2} m²");
    let level = lake.report.lakes[0].level;
    assert!((height(&lake, (low + high) / 2.0) - level).abs() < 1e-3);
}

#[test]
fn lakes_that_touch_have_the_same_levels_in_any_order() {
    let lake = |name: &str, from: f64| {
        let to = from + 150.0;
        format!(
            "[[lake]]\nname = \"{name}\"\npoints = [[{from}, 900], [{to}, 900], [{to}, 1100], [{from}, 1100]]\n"
        )
    };
    let lakes = [lake("west", 900.0), lake("middle", 1050.0), lake("east", 1200.0)];
    let scene = |order: [usize; 3]| coarse_hillside(&order.map(|index| lakes[index].as_str()).concat());
    let first = scene([0, 1, 2]);
    let levels: Vec<f64> = first.report.lakes.iter().map(|lake| lake.level).collect();
    // Each is measured on the hillside as it is: 150 m east is 105 m up.
    assert!(levels.windows(2).all(|pair| (pair[1] - pair[0] - 105.0).abs() < 0.1), "{levels:?}");
    for order in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let other = scene(order);
        assert!(other.lattice.heights() == first.lattice.heights(), "{order:?}");
        for row in &other.report.lakes {
            let same = first.report.lakes.iter().find(|same| same.name == row.name).expect("by name");
            assert_eq!((row.level, row.cut, row.fill), (same.level, same.cut, same.fill));
        }
    }
}

#[test]
fn large_lakes_put_no_posts_into_the_demonstration() {
    assert_eq!(gallery("jacksboro.toml").lattice.doublings(), 0);
}

#[test]
fn a_lake_takes_its_level_by_its_rule() {
    let shore = "points = [[50, 100], [90, 100], [250, 50], [250, 250], [50, 250]]\n";
    for (rule, low, high) in [("lowest", 104.99, 105.01), ("median", 115.0, 121.0), ("mean", 113.0, 120.0)] {
        let scene = ramp(&format!("[[lake]]\n{shore}level_rule = \"{rule}\"\n")).expect("sound");
        let level = scene.report.lakes[0].level;
        assert!(level > low && level < high, "{rule}: {level}");
        assert_eq!(scene.report.lakes[0].lowest_shore, Some(105.0));
    }
}

#[test]
fn a_river_s_width_grows_to_its_mouth_whichever_way_it_is_drawn() {
    for points in ["[[250, 150], [50, 150]]", "[[50, 150], [250, 150]]"] {
        let scene = ramp(&format!("[[river]]\npoints = {points}\nwidth = 4\nmouth_width = 20\n"));
        let scene = scene.expect("sound");
        let plan = &scene.ribbons[0].plan;
        let width_at = |x: f64| {
            let near = plan.vertices.iter().filter(|vertex| (vertex.at.x - x).abs() < 0.01);
            near.map(|vertex| (vertex.at.y - 150.0).abs() * 2.0).fold(0.0, f64::max)
        };
        assert!((width_at(50.0) - 20.0).abs() < 0.1, "the mouth lies low, in the west: {}", width_at(50.0));
        assert!((width_at(250.0) - 4.0).abs() < 0.1, "{}", width_at(250.0));
        assert!((plan.area_m2() - 12.0 * 200.0).abs() < 1.0, "{}", plan.area_m2());
    }
}

#[test]
fn widths_stay_with_their_points_when_a_river_is_turned_downstream() {
    let text = "[[river]]\npoints = [[50, 150], [150, 150], [250, 150]]\nwidths = [30, 20, 6]\n";
    let plan = &ramp(text).expect("sound").ribbons[0].plan;
    assert!((plan.area_m2() - (25.0 * 100.0 + 13.0 * 100.0)).abs() < 1.0, "{}", plan.area_m2());
    let widest = plan.vertices.iter().filter(|vertex| (vertex.at.y - 165.0).abs() < 1e-6);
    assert!(widest.clone().count() > 0 && widest.clone().all(|vertex| vertex.at.x < 51.0));
}

#[test]
fn draped_water_moves_no_earth() {
    let text = "[[river]]\npoints = [[50, 150], [250, 150]]\nwater = \"drape\"\n";
    let scene = ramp(text).expect("sound");
    assert!(scene.report.rivers.is_empty());
    assert!(scene.lattice.pinned().iter().all(|pinned| !pinned));
}

#[test]
fn thousands_of_real_streams_fall_all_the_way() {
    let Some(folder) = data("scenes/wake_nc_us") else { return };
    let read = |name: &str| std::fs::read(folder.join(name)).expect("readable");
    let companions = |_: &str| None;
    let hints = DemHints { companions: &companions, ..DemHints::default() };
    let raster = dem::read("elev_ned_30m.tif", &read("elev_ned_30m.tif"), &hints).expect("sound");
    let mut lattice = Lattice::from_raster(&raster).expect("sound");
    let crs = raster.crs.expect("stated");
    let bytes = read("derived/streams_west.fgb");
    let layer = vector::read("streams_west.fgb", &bytes, &sandtable_vector::hints::VectorHints::default())
        .expect("sound");
    let lines = layer.features.iter().flat_map(|feature| match &feature.geometry {
        Geometry::Lines(lines) => lines.clone(),
        _ => Vec::new(),
    });
    let place = |at: DVec2| layer.crs.transform(&crs, at).expect("near") - lattice.origin();
    let network: Vec<(Polyline, f64)> = lines
        .filter_map(|line| Polyline::new(line.into_iter().map(place), 0.01))
        .map(|line| (line, 3.0))
        .collect();
    assert!(network.len() > 2000, "{}", network.len());
    let channels = channels(&lattice, &network);
    let start = std::time::Instant::now();
    let cuts = channel::cut(&mut lattice, &channels).expect("narrow enough");
    println!("{} streams cut in {:.2} s", channels.len(), start.elapsed().as_secs_f64());
    assert!(cuts.cuts.iter().all(|cut| cut.climbs.is_empty()));
    for channel in &channels {
        let rise_m = check_rise(&lattice, &channel.alignment.line, &[]);
        assert!(rise_m < ROUNDING_M, "{rise_m}");
    }
    let deepest = cuts.cuts.iter().map(|cut| cut.deepest_m).fold(0.0, f64::max);
    assert!(deepest < 40.0, "a brook needs no canyon: {deepest} m");
}

#[test]
fn a_view_of_wide_water_is_drawn() {
    let scene = gallery("lake.toml");
    let camera = camera(&scene, &scene.cameras[0], (480, 270)).expect("sound");
    assert!(build_draw_list(&scene, &camera, &|_| {}).list.check().is_ok());
}

/// A scene of 60 × 50 posts, 10 m apart, whose heights are `height` of column and row from the south-west.
fn posts(height: impl Fn(u32, u32) -> f64, keys: &str) -> SceneModel {
    let folder = Scratch::new();
    let grid = "ncols 60\nnrows 50\nxllcenter 500000\nyllcenter 5000000\ncellsize 10\n".to_owned();
    let height = &height;
    let heights: Vec<String> = (0..50)
        .rev()
        .flat_map(|row| (0..60).map(move |column| format!("{:.2}", height(column, row))))
        .collect();
    folder.write("ground.asc", grid + &heights.join(" "));
    let path = folder.write("scene.toml", format!("[terrain]\ndem = \"ground.asc\"\n{keys}"));
    open_scene(&path, &[], &|_| ()).unwrap_or_else(|failure| panic!("{failure:?}"))
}

#[test]
fn sloping_ground_below_0_is_land_and_a_note_says_how_to_make_it_sea() {
    let valley = |column: u32, row: u32| -70.0 + f64::from(column) * 0.8 + f64::from(row) * 0.013;
    let scene = posts(valley, "");
    assert!(!scene.has_sea() && scene.shore_m().is_none());
    let notes = scene.inferred_notes().join("\n");
    assert!(notes.contains("0.30 km² below 0 m") && notes.contains("`sea_level = 0`"), "{notes}");
    assert_eq!(scene.ramp().stops()[0].0, scene.height_range_m.0, "the colors are those of land");

    let scene = posts(valley, "sea_level = -40");
    assert!(scene.has_sea() && scene.shore_m() == Some(-40.0));
    let count = scene.lattice.heights().iter().filter(|height| **height <= -40.0).count();
    assert_eq!(scene.water().sea_posts, count);
    assert!(scene.inferred_notes().is_empty(), "{:?}", scene.inferred_notes());
    let dry = posts(valley, "sea_level = -100").inferred_notes().join("\n");
    assert!(dry.contains("`sea_level = -100` has no effect"), "{dry}");
    let off = posts(valley, "infer_water = false").inferred_notes();
    assert!(off.is_empty(), "{off:?}");
}

#[test]
fn a_polder_beside_the_sea_keeps_the_colors_of_land() {
    let coast = |column: u32, row: u32| match row {
        0..20 => 0.0,
        20 => 6.0,
        _ => -4.0 + f64::from(column) * 0.2 + f64::from(row) * 0.013,
    };
    let scene = posts(coast, "");
    assert_eq!(scene.water().sea_posts, 20 * 60);
    assert_eq!(scene.shore_m(), None, "land lies below the sea");
    let notes = scene.inferred_notes().join("\n");
    assert!(notes.contains("0.12 km² are drawn as sea: level ground at 0 m"), "{notes}");
    assert!(notes.contains("below 0 m that reach the border are not drawn as sea"), "{notes}");
    let above = |column: u32, row: u32| coast(column, row).abs();
    assert_eq!(posts(above, "").shore_m(), Some(0.0));
}

//! The ground of a scene over elevation in degrees: straight edges, filled voids, and notes on both.

use glam::DVec2;
use sandtable_description::parse::parse_bytes;
use sandtable_geom::crs::Crs;
use sandtable_raster::answer::Answer;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::query::Interpolation;
use sandtable_terrain::query::source::source_heights;

use crate::common::scratch::Scratch;

const COLUMNS: u32 = 90;
const ROWS: u32 = 60;

/// The scene of a grid in degrees, 2.4° east of the meridian of its zone, with `height` at each column and row.
fn scene(terrain: &str, height: impl Fn(u32, u32) -> f64) -> SceneModel {
    let scratch = Scratch::new();
    let heights = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (column, row)));
    let heights: Vec<String> = heights.map(|(column, row)| height(column, row).to_string()).collect();
    let head = format!(
        "ncols {COLUMNS}\nnrows {ROWS}\nxllcorner 17.4\nyllcorner 60\ncellsize 0.001\nNODATA_value -7777\n"
    );
    scratch.write("s/a.asc", head + &heights.join(" "));
    let text = format!("[terrain]\ndem = \"a.asc\"\ncrs = \"EPSG:4326\"\n{terrain}");
    let document = parse_bytes("a.toml", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    let assets = Assets::new(&scratch.at("s/a.toml"), &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).unwrap_or_else(|error| panic!("{error}"))
}

fn hills(column: u32, row: u32) -> f64 {
    200.0 + 40.0 * libm::sin(f64::from(column) * 0.2) * libm::cos(f64::from(row) * 0.3)
}

/// Posts with data, and all posts.
fn posts(scene: &SceneModel) -> (usize, usize) {
    let lattice = &scene.lattice;
    let all: Vec<f32> = lattice.posts().map(|post| lattice.height(post)).collect();
    (all.iter().filter(|height| !height.is_nan()).count(), all.len())
}

fn told(scene: &SceneModel, what: &str) -> bool {
    scene.notes().iter().any(|note| note.contains(what))
}

#[test]
fn a_warped_model_has_straight_edges_and_a_stated_extent_counts_before_them() {
    let whole = scene("", hills);
    let (filled, all) = posts(&whole);
    assert_eq!(filled, all, "no empty wedge is left");
    // The wedges of a turn by 2.1° along 4.9 km by 6.7 km.
    assert!((4300..5200).contains(&all), "{all} of {} samples", COLUMNS * ROWS);
    assert!(told(&whole, "% of the elevation model is cut off along its border"), "{:?}", whole.notes());
    let stated = scene("extent = [[0, 0], [9000000, 9000000]]\n", hills);
    let (filled, all) = posts(&stated);
    assert!(filled < all && all > 5600, "{filled} of {all}");
    assert!(!told(&stated, "cut off"), "{:?}", stated.notes());
}

#[test]
fn an_enclosed_void_is_filled_in_the_ground_and_not_in_the_source() {
    let hole = |column: u32, row: u32| {
        if (40..45).contains(&column) && (30..33).contains(&row) { -7777.0 } else { hills(column, row) }
    };
    let at = [DVec2::new(17.4425, 60.0285)];
    for (terrain, ground_is_filled, source_is_filled) in
        [("", true, false), ("fill_voids = true\n", true, true), ("fill_voids = false\n", false, false)]
    {
        let scene = scene(terrain, hole);
        let (filled, all) = posts(&scene);
        assert_eq!(filled == all, ground_is_filled, "{terrain}: {filled} of {all}");
        assert!(all > 4300, "{terrain}: a void does not shrink the model, {all} posts");
        assert_eq!(told(&scene, "15 samples in 1 void filled"), ground_is_filled, "{terrain}");
        let mut answer = [Answer::Outside];
        let snapshot = scene.heights.snapshot();
        source_heights(snapshot.source(), &Crs::wgs84(), Interpolation::Bilinear, &at, &mut answer);
        assert_eq!(matches!(answer[0], Answer::Height(_)), source_is_filled, "{terrain}: {answer:?}");
    }
}

#[test]
fn a_ragged_coast_keeps_its_capes_and_loses_the_wedges_alone() {
    let coast = |column: u32, row: u32| {
        let sea = column < 30 && row % 20 < 14;
        if sea { -7777.0 } else { hills(column, row) }
    };
    let scene = scene("", coast);
    let lattice = &scene.lattice;
    let (filled, all) = posts(&scene);
    assert!(filled < all && filled * 10 > all * 6, "{filled} of {all}");
    // Along three sides there is ground all through.
    let east = (0..lattice.rows()).filter(|&row| {
        let column = lattice.columns() - 1;
        lattice.height(sandtable_terrain::lattice::Post { column, row }).is_nan()
    });
    assert_eq!(east.count(), 0);
    assert!(told(&scene, "cut off"), "{:?}", scene.notes());
}

#[test]
fn values_that_mean_no_data_without_saying_so_are_told() {
    let sunken = |column: u32, row: u32| if column < 9 { -32767.0 } else { hills(column, row) };
    let noted = "540 samples (10.0 %) are -32767; the others are from 160 to 239.9, and no ground is so low: if that means no data, \
         say `nodata = -32767` under [terrain]";
    let scene_of = |terrain: &str| scene(terrain, sunken);
    let told_of = scene_of("");
    assert!(told(&told_of, noted), "{:?}", told_of.notes());
    let stated = scene_of("nodata = -32767\n");
    assert!(!told(&stated, "if that means no data"), "{:?}", stated.notes());
    assert!(stated.height_range_m.0 > 100.0);
}

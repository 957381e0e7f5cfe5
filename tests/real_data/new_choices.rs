//! What `new` chooses for real places: the title, the direction and the frame of the first picture, and what is drawn.

use glam::DVec2;
use sandtable_new::{self as new_scene, NewSceneOptions};
use sandtable_picture::camera;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::open_scene;
use sandtable_sheet::picture::{PictureSize, draw_view};
use sandtable_sheet::picture_statistics::PictureStatistics;
use sandtable_vector::feature::Geometry;
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read;

use crate::common::data::data;
use crate::common::scratch::Scratch;
use crate::first_scene;

/// A place and what is wanted of its first picture.
struct Choices {
    dem: &'static str,
    vectors: &'static [&'static str],
    title: &'static str,
    /// Lines of its scene file.
    holds: &'static [&'static str],
}

const PLACES: [Choices; 5] = [
    Choices {
        dem: "monaco/N43E007.hgt.zip",
        vectors: &["monaco/monaco.osm.gz"],
        title: "Monaco",
        holds: &["[[coast]]", "base = \"mean\"", "height = 15", "# The boldest relief among the features"],
    },
    // The model is a strip aslant in its box: its ends are past the borders of the picture.
    Choices {
        dem: "redbutte_us/red_butte_dem.tif",
        vectors: &[
            "redbutte_us/red_butte_reservoir.geojson",
            "redbutte_us/red_butte_road.geojson",
            "redbutte_us/red_butte_rna.geojson",
        ],
        title: "Red Butte Canyon",
        holds: &[
            "so that it is filled; without `shows`",
            "[[overlay]]\nname = \"Red Butte Canyon\"",
            "classes = true",
        ],
    },
    Choices {
        dem: "taunton_uk/dtm.tif",
        vectors: &["taunton_uk/buildings.shp", "taunton_uk/trees.shp", "taunton_uk/lines.shp"],
        title: "51.06° N 3.12° W",
        holds: &["[[model]]\nfile = \"broadleaf\"", "[[overlay]]\nname = \"Lines\""],
    },
    Choices { dem: "crater_lake_bt/crater.bt", vectors: &[], title: "42.9° N 122.2° W", holds: &[] },
    Choices {
        dem: "swellendam_za/dem_srtm_utm33s_i16.tif",
        vectors: &["swellendam_za/rivers.shp", "swellendam_za/water.shp", "swellendam_za/places.shp"],
        title: "Swellendam",
        holds: &["[[label]]"],
    },
];

/// The least share of a first picture that is filled.
const FILLED: f64 = 0.6;

/// A first picture looks at most this far from north, as the dot product with north of its direction on the plan: 45°.
const LEAST_NORTH: f32 = 0.7;

#[test]
fn a_new_scene_looks_north_fills_its_picture_and_is_named_after_its_place() {
    for place in &PLACES {
        let folder = Scratch::new();
        let Some((text, scene)) = first_scene(&folder, place.dem, place.vectors) else { return };
        for line in place.holds {
            assert!(text.contains(line), "{}: {line} in\n{text}", place.dem);
        }
        assert_eq!(scene.title.as_deref(), Some(place.title), "{}", place.dem);
        let view = scene.view(Some("overview")).expect("the first camera");
        let north = camera(&scene, view, (320, 200)).expect("sound").forward().truncate();
        let north = north.try_normalize().map_or(0.0, |toward| toward.y);
        assert!(north > LEAST_NORTH, "{}: {north}", place.dem);
        let size = PictureSize { width: 320, height: 200 };
        let drawn = draw_view(&scene, view, size, RenderBackend::Cpu, &|_| ()).expect("sound");
        let filled = PictureStatistics::new(&drawn.picture).filled;
        println!("{}: filled {filled:.3}", place.dem);
        assert!(filled >= FILLED, "{}: {filled}", place.dem);
    }
}

/// The 90 m model holds a degree of Earth, and the roads a thousandth of it: one way of many leads out of the town.
#[test]
fn a_stray_way_does_not_widen_the_frame_and_little_of_the_roads_is_cut_off() {
    let Some(dem) = data("scenes/monaco/N43E007.hgt.zip") else { return };
    let Some(roads) = data("scenes/monaco/derived/roads.geojson") else { return };
    let folder = Scratch::new();
    let stray = r#"{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"highway": "path"},
        "geometry": {"type": "LineString", "coordinates": [[7.9, 43.95], [7.905, 43.95]]}}]}"#;
    folder.write("data/stray.geojson", stray);
    let sizes = [false, true].map(|has_stray| {
        let name = if has_stray { "with" } else { "without" };
        let mut vectors = vec![roads.clone()];
        vectors.extend(has_stray.then(|| folder.at("data/stray.geojson")));
        let allowed = vec![dem.parent().expect("in a folder").to_path_buf()];
        let allowed = [allowed, vec![roads.parent().expect("in a folder").to_path_buf()]].concat();
        let options = NewSceneOptions {
            folder: folder.at(name),
            dem: vec![dem.clone()],
            vectors,
            ..NewSceneOptions::default()
        };
        let written = new_scene::write(&options, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
        let scene = open_scene(&written.path, &allowed, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
        let bytes = std::fs::read(&roads).expect("readable");
        let layer = read::read("roads.geojson", &bytes, &VectorHints::default()).expect("sound");
        let ground = scene.lattice.map_extent();
        let (mut inside_m, mut all_m) = (0.0, 0.0);
        for feature in &layer.features {
            let Geometry::Lines(lines) = &feature.geometry else { continue };
            for ends in lines.iter().flat_map(|line| line.windows(2)) {
                let [from, to] = [ends[0], ends[1]]
                    .map(|at: DVec2| layer.crs.transform(&scene.crs, at).expect("on Earth"));
                all_m += from.distance(to);
                inside_m += ground.clip_line(from, to).map_or(0.0, |(from, to)| from.distance(to));
            }
        }
        assert!(inside_m >= 0.95 * all_m, "{name}: {inside_m} of {all_m} m");
        ground.size()
    });
    assert!((sizes[1] / sizes[0]).max_element() < 1.05, "{sizes:?}");
}

//! The first picture of real places: what `new` writes and `render` draws with nothing changed by hand.

use std::path::PathBuf;

use sandtable::pipeline::new_scene::{self, NewSceneOptions};
use sandtable::pipeline::picture::{PictureSize, draw_view};
use sandtable::pipeline::picture_statistics::PictureStatistics;
use sandtable::pipeline::scene_file::open_scene;
use sandtable::render::RenderBackend;

use crate::common::data::data;
use crate::common::scratch::Scratch;

/// A place, and what its overview must reach.
struct Place {
    dem: &'static str,
    vectors: &'static [&'static str],
    /// The least share of the picture that is filled. A square block seen from the south fills six tenths of a picture of
    /// 16:9, a longer one less.
    filled: f64,
    /// The least standard deviation of the lightness of the ground.
    sd: f64,
}

const PLACES: [Place; 6] = [
    Place { dem: "crater_lake_bt/crater.bt", vectors: &[], filled: 0.45, sd: 9.0 },
    Place {
        dem: "redbutte_us/red_butte_dem.tif",
        vectors: &["redbutte_us/red_butte_reservoir.geojson", "redbutte_us/red_butte_road.geojson"],
        filled: 0.55,
        sd: 9.0,
    },
    Place {
        dem: "swellendam_za/dem_srtm_utm33s_i16.tif",
        vectors: &["swellendam_za/rivers.shp", "swellendam_za/water.shp"],
        filled: 0.6,
        sd: 9.0,
    },
    Place { dem: "taunton_uk/dtm.tif", vectors: &["taunton_uk/buildings.shp"], filled: 0.6, sd: 9.0 },
    Place { dem: "wake_nc_us/elev_ned_30m.tif", vectors: &["wake_nc_us/lakes.shp"], filled: 0.6, sd: 9.0 },
    Place {
        dem: "porto_alegre_br/poa_elevation.tif",
        vectors: &["porto_alegre_br/poa_osm.pbf"],
        filled: 0.6,
        sd: 9.0,
    },
];

#[test]
fn the_first_picture_of_a_place_is_filled_and_its_relief_is_clear() {
    for place in &PLACES {
        let Some(dem) = data(&format!("scenes/{}", place.dem)) else { return };
        let vectors: Vec<PathBuf> =
            place.vectors.iter().filter_map(|file| data(&format!("scenes/{file}"))).collect();
        let folder = Scratch::new();
        let allowed = vec![dem.parent().expect("in a folder").to_path_buf()];
        let options = NewSceneOptions {
            folder: folder.at("scene"),
            dem: vec![dem],
            vectors,
            ..NewSceneOptions::default()
        };
        let written = new_scene::write(&options, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
        let scene = open_scene(&written.path, &allowed, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
        let view = scene.view(Some("overview")).expect("the first camera");
        let size = PictureSize { width: 960, height: 540 };
        let drawn = draw_view(&scene, view, size, RenderBackend::Cpu, &|_| ()).expect("sound");
        let found = PictureStatistics::new(&drawn.picture);
        let lightness = found.ground_lightness.expect("there is ground");
        println!("{}: {found:?}", place.dem);
        assert!(found.filled >= place.filled, "{}: {found:?}", place.dem);
        assert!(lightness.sd >= place.sd && lightness.p2 <= 38.5, "{}: {found:?}", place.dem);
        assert!(lightness.p98 >= 82.0, "{}: {found:?}", place.dem);
    }
}

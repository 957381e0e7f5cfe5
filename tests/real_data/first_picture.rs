//! The first picture of real places: what `new` writes and `render` draws with nothing changed by hand.

use sandtable_draw::color::{Srgba, luminance};
use sandtable_draw::pixels::Pixels;
use sandtable_render::RenderBackend;
use sandtable_sheet::picture::{PictureSize, annotate_view, draw_view};
use sandtable_sheet::picture_statistics::PictureStatistics;

use crate::common::scratch::Scratch;
use crate::first_scene;

/// A place.
struct Place {
    dem: &'static str,
    vectors: &'static [&'static str],
}

const PLACES: [Place; 7] = [
    Place { dem: "crater_lake_bt/crater.bt", vectors: &[] },
    Place { dem: "monaco/N43E007.hgt.zip", vectors: &["monaco/monaco.osm.gz"] },
    Place {
        dem: "redbutte_us/red_butte_dem.tif",
        vectors: &["redbutte_us/red_butte_reservoir.geojson", "redbutte_us/red_butte_road.geojson"],
    },
    Place {
        dem: "swellendam_za/dem_srtm_utm33s_i16.tif",
        vectors: &["swellendam_za/rivers.shp", "swellendam_za/water.shp", "swellendam_za/places.shp"],
    },
    Place { dem: "taunton_uk/dtm.tif", vectors: &["taunton_uk/buildings.shp"] },
    Place { dem: "wake_nc_us/elev_ned_30m.tif", vectors: &["wake_nc_us/lakes.shp"] },
    Place { dem: "porto_alegre_br/poa_elevation.tif", vectors: &["porto_alegre_br/poa_osm.pbf"] },
];

/// The least share of the picture that is filled.
const FILLED: f64 = 0.6;

/// The least standard deviation of the lightness of the ground, and what its 2nd percentile is at most and its 98th at
/// least.
const SPREAD: f64 = 9.0;
const DARK: f64 = 38.0;
const LIGHT: f64 = 85.0;

/// The least contrast of letters with what is around them (WCAG 2.2, 1.4.3).
const CONTRAST: f32 = 4.5;

#[test]
#[ignore = "slow: first pictures of all real places"]
fn the_first_picture_of_a_place_is_filled_and_its_relief_is_clear() {
    for place in &PLACES {
        let folder = Scratch::new();
        let Some((_, scene)) = first_scene(&folder, place.dem, place.vectors) else { return };
        let view = scene.view(Some("overview")).expect("the first camera");
        let size = PictureSize { width: 960, height: 540 };
        let drawn = draw_view(&scene, view, size, RenderBackend::Cpu, &|_| ()).expect("sound");
        let found = PictureStatistics::new(&drawn.picture);
        let lightness = found.ground_lightness.expect("there is ground");
        println!("{}: {found:?}", place.dem);
        assert!(found.filled >= FILLED, "{}: {found:?}", place.dem);
        assert!(lightness.sd >= SPREAD && lightness.p2 <= DARK, "{}: {found:?}", place.dem);
        assert!(lightness.p98 >= LIGHT, "{}: {found:?}", place.dem);
        let bare = drawn.picture.pixels.clone();
        let annotated = annotate_view(&scene, drawn, &|_| ());
        let lettered = least_contrast(&bare, &annotated.pixels);
        assert!(lettered.is_none_or(|contrast| contrast >= CONTRAST), "{}: {lettered:?}", place.dem);
        assert!(lettered.is_some(), "{}: the title at least is written", place.dem);
    }
}

/// The least contrast of the ink at the edges of letters with the lightest pixel nearby; `None` without ink.
fn least_contrast(bare: &Pixels, annotated: &Pixels) -> Option<f32> {
    /// The inks of letters: of names, of notes and of waters.
    const INKS: [Srgba; 3] =
        [Srgba::opaque(0x1e, 0x23, 0x27), Srgba::opaque(0x3c, 0x42, 0x47), Srgba::opaque(0x14, 0x4f, 0x7e)];
    /// How far letters' surroundings are looked at, pixels: as far as half a bold stroke and its halo.
    const NEAR: u32 = 3;
    let (width, height) = (bare.width(), bare.height());
    let light = |x: u32, y: u32| luminance(annotated.at(x, y).linear());
    let mut least: Option<f32> = None;
    for y in NEAR..height - NEAR {
        for x in NEAR..width - NEAR {
            let beside = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
            let is_inner = beside.iter().all(|&(x, y)| INKS.contains(&annotated.at(x, y)));
            let is_ink = INKS.contains(&annotated.at(x, y)) && bare.at(x, y) != annotated.at(x, y);
            if !is_ink || is_inner {
                continue;
            }
            let around = (y - NEAR..=y + NEAR)
                .flat_map(|y| (x - NEAR..=x + NEAR).map(move |x| light(x, y)))
                .fold(0.0, f32::max);
            let contrast = (around + 0.05) / (light(x, y) + 0.05);
            least = Some(least.map_or(contrast, |least| least.min(contrast)));
        }
    }
    least
}

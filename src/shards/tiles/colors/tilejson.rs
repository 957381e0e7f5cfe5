//! The description of a pyramid of pictures: TileJSON 3.0 (Mapbox 2021), by which viewers find its tiles.

use serde_json::{Value, json};

use crate::tiles::colors::pyramid::{ColorPyramid, PIXELS};
use crate::tiles::degree_bounds::described_bounds;
use sandtable_dem::formats::height_encoding::HeightEncoding;

/// The description of all tiles, with the keys `encoding` and `tileSize` of a source `raster-dem` of MapLibre and Mapbox.
pub fn tilejson(pyramid: &ColorPyramid) -> Value {
    let encoding = match pyramid.encoding {
        HeightEncoding::TerrainRgb => "mapbox",
        HeightEncoding::Terrarium => "terrarium",
    };
    json!({
        "tilejson": "3.0.0",
        "name": "sandtable",
        "version": "1.0.0",
        "scheme": "xyz",
        "tiles": ["{z}/{x}/{y}.png"],
        "bounds": described_bounds(pyramid.bounds),
        "minzoom": 0,
        "maxzoom": pyramid.max_zoom,
        "encoding": encoding,
        "tileSize": PIXELS,
    })
}

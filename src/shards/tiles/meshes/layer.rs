//! The description of a pyramid of meshes: `layer.json`, by which viewers find its tiles.

use serde_json::{Value, json};

use crate::tiles::arguments::TilesArguments;
use crate::tiles::degree_bounds::described_bounds;
use crate::tiles::meshes::groups;
use crate::tiles::tiling::TileRange;

/// The description of all tiles.
pub fn layer(arguments: &TilesArguments) -> Value {
    let available = |level: u32| -> Value {
        let TileRange { x, y, .. } = groups::meeting(level, arguments.bounds);
        let ranges = x
            .iter()
            .map(|x| json!({ "startX": x.start(), "startY": y.start(), "endX": x.end(), "endY": y.end() }));
        ranges.collect()
    };
    let levels: Vec<Value> = (0..=arguments.max_zoom).map(available).collect();
    json!({
        "tilejson": "2.1.0",
        "name": "sandtable",
        "version": "1.0.0",
        "format": "quantized-mesh-1.0",
        "scheme": "tms",
        "projection": "EPSG:4326",
        "tiles": ["{z}/{x}/{y}.terrain"],
        "bounds": described_bounds(arguments.bounds),
        "minzoom": 0,
        "maxzoom": arguments.max_zoom,
        "available": levels,
    })
}

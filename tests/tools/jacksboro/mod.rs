//! The demonstration landscape, derived from nothing but its elevation model.
//!
//! ```text
//! dem.tif ── ground ──┬── flow ───── streams ── streams.geojson
//!                     ├── lakes ─────────────── lake.geojson
//!                     ├── roads ── network ──── roads.geojson
//!                     └── samples ───────────── valley.asc, hills.png
//! ```
//!
//! Everything is deterministic: ties are broken by post number, and the only transcendental functions come
//! from `libm`. So the committed files can be derived again and compared byte for byte.

pub mod flow;
pub mod ground;
pub mod lakes;
pub mod line;
pub mod network;
pub mod roads;
pub mod samples;
pub mod streams;
pub mod write;

use ground::Ground;

/// The files that are derived, as they are committed.
pub struct Derived {
    /// `streams.geojson`.
    pub streams: String,
    /// `lake.geojson`.
    pub lakes: String,
    /// `roads.geojson`.
    pub roads: String,
    /// `valley.asc`.
    pub valley: String,
    /// What a scene's author wants to know: junctions, crossings, lengths.
    pub notes: Vec<String>,
}

/// Derives all text files from the ground.
pub fn derive(ground: &Ground) -> Derived {
    let mut notes = Vec::new();
    let lakes = lakes::find(ground);
    let flow = flow::Flow::over(ground, &lakes.water);
    let streams = streams::trace(ground, &flow, &lakes.water);
    let roads = network::build(ground, &flow, &lakes.water, &mut notes);
    network::note_crossings(ground, &roads, &streams, &mut notes);
    Derived {
        streams: write::streams(ground, &streams),
        lakes: write::lakes(ground, &lakes),
        roads: write::roads(ground, &roads),
        valley: samples::valley(ground),
        notes,
    }
}

//! Terrain analyses of kinds whose values depend on the land within a reach: tiles of posts, and the raster of all.
//!
//! ```text
//! plan ──► shards.jsonl      tiles of posts, each as large as the others or a post less
//! work ──► 000012.tif        the values of a tile, of the land with the reach of the kind around it
//!          000012.tally.json what its figures are made of
//! gather ► analysis.tif      the bytes that `analyze` writes, and its figures; or its features as .gpkg or .geojson
//! ```

pub mod arguments;
pub mod gather;
pub mod plan;
pub mod said;
pub mod work;

//! Lines, polygons and points with properties: what maps are made of, one file per format.

mod collect;
pub mod error;
pub mod feature;
pub mod filter;
pub mod geojson;
pub mod read;

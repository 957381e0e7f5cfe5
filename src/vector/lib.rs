//! Lines, polygons and points with properties, read from vector files: one file or folder for each format.

mod broken_records;
mod builder;
pub mod cityjson;
mod cot;
mod dxf;
mod encoding;
pub mod error;
pub mod feature;
pub mod feature_table;
pub mod filter;
mod flatgeobuf;
mod geojson;
#[cfg(feature = "vector-db")]
mod geopackage;
mod gpx;
pub mod hints;
mod kml;
mod kml_style;
mod landxml;
mod milx;
pub mod moment;
mod msdl;
mod nvg;
mod orbat;
mod osm;
pub mod overlay_schema;
pub mod read;
mod rings;
mod shapefile;
mod svg_style;
mod table;
mod tally;
mod wkb;
mod xml;

//! Lines, polygons and points with properties: what maps are made of, one file or folder per format.

mod codepage;
mod collect;
mod cursor;
pub mod error;
pub mod feature;
pub mod filter;
mod flatgeobuf;
pub mod geojson;
mod geopackage;
mod gpx;
mod kml;
mod osm;
mod packed;
pub mod read;
mod rings;
mod shapefile;
mod wkb;
mod xml;

//! The scene file as plain data: its keys are declared once, and decoder, schema and reference page follow from that.

#[macro_use]
mod table;

pub mod analyses;
pub mod bounds;
pub mod color;
pub mod declaration;
mod decode_context;
pub mod diagnostic;
pub mod document;
pub mod earthworks;
pub mod elevation_file;
pub mod expression;
pub mod feature_source;
pub mod feature_value;
pub mod features;
pub mod finding;
pub mod finding_code;
pub mod graphics;
pub mod include;
mod key;
pub mod overlays;
pub mod panorama_keys;
pub mod parse;
pub mod phases;
mod reader;
pub mod scalar;
pub mod schema;
pub mod selection;
pub mod source_place;
pub mod source_text;
pub mod stated;
pub mod styles;
pub mod symbols;
mod table_key;
mod table_name;
pub mod table_sources;
pub mod unused;
mod value;
pub mod words;

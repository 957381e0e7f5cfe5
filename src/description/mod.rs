//! The scene file as plain data, with the place of every value that may turn out wrong later.

pub mod bounds;
mod decode;
mod decode_features;
pub mod defaults;
pub mod diagnostic;
pub mod document;
mod documentation;
pub mod expression;
pub mod features;
pub mod include;
mod item;
pub mod parse;
mod reader;
pub mod schema;
mod selection;
mod sketch;
mod snippet;
pub mod source_text;
mod styles;
pub mod suggest;
pub mod words;

//! The scene file as plain data, with the place of every value that may turn out wrong later.

pub mod bounds;
mod decode;
mod decode_features;
pub mod diagnostic;
pub mod document;
pub mod expression;
pub mod features;
mod item;
pub mod parse;
mod reader;
mod snippet;
pub mod source_text;
pub mod suggest;
pub mod words;

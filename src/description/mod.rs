//! The scene file as plain data, with the place of every value that may turn out wrong later.

mod decode;
pub mod diagnostic;
pub mod document;
mod item;
pub mod parse;
mod reader;
mod snippet;
pub mod source_text;
pub mod suggest;
pub mod words;

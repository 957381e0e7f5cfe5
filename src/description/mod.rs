//! The scene file as plain data, with the place of every value that may turn out wrong later.

pub mod document;

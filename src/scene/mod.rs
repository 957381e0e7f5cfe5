//! From the scene file to what a renderer draws.
//!
//! `build` turns a document and its assets into a [`kind::Scene`], one pass a file: the ground (`ground`),
//! lakes, rivers and roads (`features`), models (`models`), labels and cameras (`views`). `picture` turns a
//! scene and a camera into a draw list.

pub mod assets;
pub mod build;
pub mod features;
pub mod ground;
pub mod kind;
pub mod models;
pub mod picture;
pub mod place;
pub mod plinth;
pub mod roads;
pub mod sources;
pub mod style;
pub mod views;

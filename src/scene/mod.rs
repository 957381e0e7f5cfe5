//! From the scene file to what a renderer draws.
//!
//! `build` turns a document and its assets into a [`kind::Scene`], one pass a file: the ground (`ground`), what lies on
//! it (`areas`, `water`, `roads`), what stands on it (`buildings`, `fences`), models (`models`, `scatter`; `footprint` and
//! `stand` say how they meet the ground), labels and cameras (`views`); the passes gather what they make in `collected`.
//! `picture` turns a scene and a camera into a draw list.

pub mod areas;
pub mod assets;
pub mod attributes;
pub mod bridges;
pub mod build;
pub mod building_colors;
pub mod buildings;
pub mod collected;
pub mod fences;
pub mod footprint;
pub mod ground;
pub mod kind;
pub mod models;
pub mod near;
pub mod picture;
pub mod place;
pub mod plinth;
pub mod report;
pub mod roads;
pub mod scatter;
pub mod sources;
pub mod stand;
pub mod style;
pub mod views;
pub mod water;

//! Draped features: roads, rivers and lakes as meshes cut to the displayed triangles.
//!
//! `stroke` and `area` make triangles in plan; `drape` cuts them along the edges of the displayed triangles, so
//! that every piece lies in the plane of one of them and nothing sinks or floats, whatever the level of detail.

pub mod area;
pub mod border;
pub mod chain;
pub mod crossing;
mod cut_part;
mod cutting;
pub mod drape;
mod joint;
pub mod junction;
pub mod partition;
pub mod patches;
pub mod plan;
pub mod stroke;
pub mod texture;

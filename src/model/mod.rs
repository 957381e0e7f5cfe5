//! Model files — 3DS, OBJ with MTL, glTF and GLB — to one [`kind::Model`], Z up, no file system.
//!
//! ```text
//! bytes ── read ──┬─ three_ds ─┐
//!                 ├─ obj ──────┼─ normals, triangulate, part, texture ──► Model
//!                 └─ gltf ─────┘
//! ```
//!
//! How a model is drawn where it is small is its own matter too: `detail` chooses between the model, its coarser levels
//! (`simplify`, by collapsing edges of a `soup` of all parts) and pictures of it (`impostor`).
//!
//! Trees, a shrub and a rock are [`built_in`]. What a model file names — buffers, textures, material libraries — comes
//! through [`kind::Companions`]. A file that cannot be trusted is an error; a picture that cannot be had is a note on a
//! model without it.

pub mod built_in;
pub mod detail;
pub mod error;
pub mod gltf;
pub mod impostor;
mod impostor_raster;
pub mod kind;
mod nearest;
mod normals;
pub mod obj;
mod part;
mod quadric;
pub mod read;
pub mod simplify;
mod soup;
mod texture;
pub mod three_ds;
mod triangulate;

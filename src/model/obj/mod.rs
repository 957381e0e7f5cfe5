//! Wavefront OBJ with MTL: text, Y up, polygons.
//!
//! ```text
//! bytes ─ text (encodings, continued lines) ─ plain (checked, absolute, bare) ─ tobj ─ assemble ─► Model
//!                                              └─ mtl (material libraries) ──────────────┘
//! ```
//!
//! `tobj` 4.0.5 multiplies forged indices until they overflow, mixes up corners with and without texture
//! coordinates, and gives up a library for one odd line. So it gets a text rewritten from what has been
//! checked here, in which all it can meet is what it does well: numbers, absolute indices and object names.

mod assemble;
mod mtl;
mod plain;
mod text;

use crate::model::error::ModelError;
use crate::model::{Companions, Model};

/// The model in the bytes of an OBJ file. Y up becomes Z up: (x, y, z) to (x, −z, y).
///
/// # Errors
/// [`ModelError::Obj`] and [`ModelError::TooLarge`]. A library or texture that cannot be had is a note.
pub fn read(bytes: &[u8], companions: &dyn Companions) -> Result<Model, ModelError> {
    let text = text::decode(bytes);
    let plain = plain::check(&text)?;
    assemble::assemble(&plain, companions)
}

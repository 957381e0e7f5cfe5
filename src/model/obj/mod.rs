//! Wavefront OBJ with MTL: text, Y up, polygons.
//!
//! ```text
//! bytes ─ text (encodings, continued lines) ─ parse (statements, indices checked) ─ assemble ─► Model
//!                                            └─ mtl (material libraries) ─────────────┘
//! ```
//!
//! The reader is our own: `tobj` 4.0.5 has no smoothing groups, drops the name of a material whose library is missing,
//! refuses a file or library for one odd number, mixes up corners with and without texture coordinates, and multiplies
//! forged indices until they overflow.

mod assemble;
mod mtl;
mod parse;
mod text;

use crate::error::ModelError;
use crate::{Companions, Model};

/// The model in the bytes of an OBJ file. Y up becomes Z up: (x, y, z) to (x, −z, y).
///
/// # Errors
/// [`ModelError::Obj`] and [`ModelError::TooLarge`]. A library or texture that cannot be loaded is a note.
pub fn read(bytes: &[u8], companions: &dyn Companions) -> Result<Model, ModelError> {
    let file = parse::parse(&text::decode(bytes))?;
    assemble::assemble(&file, companions)
}

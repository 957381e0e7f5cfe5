//! Wavefront OBJ with MTL: text, Y up, polygons.
//!
//! ```text
//! bytes ─ text (encodings, continued lines) ─ sound (indices checked, repaired lines) ─ tobj ─ assemble ─► Model
//!                                           └─ mtl (repaired material libraries) ────── tobj ──┤
//!                                                                            map_options ──┘
//! ```
//!
//! `tobj` 4.0.5 reads what is repaired before: left to itself it has no smoothing groups, drops the name of a material
//! whose library is missing, refuses a file or library for one odd number, mixes up corners with and without texture
//! coordinates, takes lines for faces, and multiplies forged indices until they overflow.

mod assemble;
mod map_options;
mod mtl;
mod sound;
mod text;

use crate::error::ModelError;
use crate::{Companions, Model};

/// The model in the bytes of an OBJ file. Y up becomes Z up: (x, y, z) to (x, −z, y).
///
/// # Errors
/// [`ModelError::Obj`] and [`ModelError::TooLarge`]. A library or texture that cannot be loaded is a note.
pub fn read(bytes: &[u8], companions: &dyn Companions) -> Result<Model, ModelError> {
    assemble::assemble(&sound::read(&text::decode(bytes))?, companions)
}

//! Military symbols and tactical graphics: their codes, and how they are drawn in the plane.

pub mod code;
pub mod fields;
pub mod graphic;
mod letter_code;

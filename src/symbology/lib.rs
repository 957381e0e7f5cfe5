//! Military symbols and tactical graphics: their codes, and how they are drawn in the plane.
//!
//! ```text
//!  text ──► code (digits, fields; letter_code) ──► frame, entities, modifiers, amplifiers ──► symbol: marks in a box
//! ```

mod amplifiers;
pub mod code;
mod control_point;
pub mod drawing;
pub mod entities;
pub mod fields;
pub mod frame;
pub mod graphic;
mod letter_code;
pub mod modifiers;
mod pieces;
pub mod symbol;
pub mod texts;

/// The program of the README runs as a test.
#[cfg(doctest)]
#[doc = include_str!("README.md")]
pub struct SymbologyReadme;

//! Military symbols and tactical graphics: their codes, and how they are drawn in the plane.
//!
//! ```text
//!  text ──► code (digits, fields; letter_code) ──► frame, entities, modifiers, amplifiers ──► symbol: marks in a box
//!  symbol, texts, engagement ──► labeled: with the text round it ──► svg
//! ```

mod amplifiers;
pub mod code;
mod control_point;
pub mod country;
pub mod drawing;
pub mod engagement;
pub mod entities;
pub mod fields;
pub mod frame;
mod frame_marks;
pub mod graphic;
pub mod labeled;
mod letter_code;
mod letter_functions;
pub mod modifiers;
mod pieces;
pub mod svg;
pub mod symbol;
pub mod texts;

/// The program of the README runs as a test.
#[cfg(doctest)]
#[doc = include_str!("README.md")]
pub struct SymbologyReadme;

//! An atlas: the ground of a scene in annotated sheets side by side, at one true scale.
//!
//! ```text
//!        1      2      3
//!    ┌──────┬──────┬──────┐     neighbors meet along their frames: a point of the ground is on one sheet
//!  A │  A1  │  A2  │  A3  │
//!    ├──────┼──────┼──────┤     sheets without ground are left out
//!  B │  B1  │  B2  │
//!    └──────┴──────┘
//! ```
//!
//! A sheet is what `render` draws of a plan of that rectangle, with its name under the title and its neighbors in the notes of
//! the margin, where the scene's layout has one.

pub mod arguments;
pub mod gather;
pub mod index;
pub mod items;
pub mod plan;
pub(crate) mod renderer;
mod sheet_grid;
pub mod work;

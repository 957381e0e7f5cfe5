//! Water: lakes level the ground they lie on, rivers cut it so that they fall.
//!
//! Lakes come first: a river that runs through one takes its level.

pub mod culvert;
pub mod lake_level;
pub mod lakes;
pub mod network;
pub mod order;
pub mod rivers;

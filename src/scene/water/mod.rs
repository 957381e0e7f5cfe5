//! Water: lakes level the ground they lie on, rivers cut it so that they fall.
//!
//! The sea comes first, then lakes: a river that runs into one takes its level.

pub mod coast;
pub mod culvert;
pub mod lake_level;
pub mod lakes;
pub mod network;
pub mod order;
pub mod reaches;
pub mod rivers;

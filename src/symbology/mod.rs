//! Military symbols and tactical graphics: their codes, and how they are drawn in the plane.

pub mod graphic;

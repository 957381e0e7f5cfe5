//! Height queries, lines of sight and viewsheds.

#[path = "../common/mod.rs"]
mod common;

mod cubic;
mod heights;
mod sight;
mod viewshed;
mod windows;

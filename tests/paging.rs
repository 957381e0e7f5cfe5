//! Terrain out of memory's reach: windows of files against whole files, and walks out of memory against walks in it.

#[path = "paging/blocks.rs"]
mod blocks;
#[allow(dead_code, reason = "each test uses its own part")]
#[path = "common/data.rs"]
mod data;
#[path = "common/skip.rs"]
mod skip;
#[path = "common/tiles.rs"]
mod tiles;
#[path = "paging/walk.rs"]
mod walk;
#[path = "paging/windows.rs"]
mod windows;

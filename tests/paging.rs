//! Terrain out of memory's reach: windows of files against whole files, and walks out of memory against walks in it.

#[allow(dead_code, reason = "each test uses its own part")]
#[path = "common/data.rs"]
mod data;
#[path = "common/skip.rs"]
mod skip;
#[path = "common/tiles.rs"]
mod tiles;
#[path = "paging/windows.rs"]
mod windows;

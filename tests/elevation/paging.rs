//! Terrain out of memory's reach: windows of files against whole files, and walks out of memory against walks in it.

mod blocks;
mod walk;
mod windows;

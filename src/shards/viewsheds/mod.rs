//! Cumulative viewsheds: how many of many observers see each post of the ground.
//!
//! ```text
//! observers ─► posts within range of each ─► shards of neighboring observers      plan
//! shard ─► viewsheds of its observers ─► 000012.tif: their counts                 work
//! *.tif ─► viewsheds.tif: the sums                                                gather
//! ```
//!
//! Posts have their columns and rows in the whole ground, so that windows are added post by post.

pub mod arguments;
mod counts;
pub mod gather;
pub mod plan;
pub mod work;

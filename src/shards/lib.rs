//! Work that is too long for one machine, cut into shards: planned, done one by one by any number of programs, gathered.
//!
//! Each product has a folder: the arguments and how they are cut into shards (`plan`), one shard (`work`), and how results
//! become the product (`gather`). All else is the same for all: the files of a plan, its inputs, records, workers.
//!
#![doc = include_str!("SHARDS.md")]

pub mod analysis;
pub mod atlas;
pub mod error;
pub mod gather;
pub mod heights;
pub mod input;
pub mod plan;
pub mod plan_path;
pub mod planned_dataset;
mod point_stream;
pub mod raster_result;
pub mod record;
pub mod shard;
pub mod tiles;
pub mod viewsheds;
pub mod work;

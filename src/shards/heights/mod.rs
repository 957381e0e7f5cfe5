//! Heights of many points: each shard reads a part of the elevation once.
//!
//! ```text
//! points.csv ─► squares of the raster ─► shards of neighboring squares ─► points.bin, order.bin     plan
//! points.bin ─► 000012.heights                                                                      work
//! points.csv + order.bin + *.heights ─► heights.csv                                                 gather
//! ```
//!
//! Nothing holds all points: the table is read twice when it is planned and once when it is gathered, and a shard has at most
//! [`MOST_POINTS`](plan::MOST_POINTS).

pub mod arguments;
pub mod csv;
pub mod gather;
pub mod plan;
mod squares;
pub mod work;

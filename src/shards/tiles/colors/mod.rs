//! Tiles as pictures: heights as colors of PNG in Web Mercator, as map viewers read them.
//!
//! ```text
//! level 0                ┌───┐                    gather: the levels above all shards
//!                        └───┘
//! level s - 3    ┌───┐ ┌───┐ ┌───┐ ┌───┐          the roots of shards
//!                └───┘ └───┘ └───┘ └───┘
//! level s       ▪▪▪▪▪ ▪▪▪▪▪ ▪▪▪▪▪ ▪▪▪▪▪           where the elevation is queried: pixels as close as its samples
//! ```
//!
//! A pixel of a level is the mean of those of the four below it that have elevation, down to level s, where it is the height at
//! the pixel's center. So no sample is left out of a coarse level, and none is seen alone. The levels that are written end at
//! `max_zoom`, which may be above s, and all are the same then. A shard keeps the heights of its root as a result, of which
//! `gather` makes the levels above.

pub mod gather;
mod means;
mod pixels;
pub mod plan;
pub mod pyramid;
pub mod tilejson;
pub mod work;

//! Tiles as meshes on the ellipsoid: quantized-mesh 1.0 in longitude and latitude.
//!
//! ```text
//! level 0   ┌───┬───┐   posts of a tile: 65 x 65, those of a level are every second one of the next
//!           └───┴───┘
//! level 1   ┌─┬─┬─┬─┐   a shard: a tile and those below it, five levels; or the tiles above all of these
//!           ├─┼─┼─┼─┤
//!           └─┴─┴─┴─┘
//! ```
//!
//! The height of a post depends on its place alone: its longitude and latitude are computed from its number in the whole
//! level, which is the same from either side of an edge. All tiles count heights in the same steps. So the edges of neighbors
//! agree bit for bit, and no tile waits for another.

pub mod groups;
pub mod layer;
pub mod plan;
mod posts;
mod quantized_mesh;
pub mod work;

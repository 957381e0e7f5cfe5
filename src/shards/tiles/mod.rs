//! A pyramid of terrain tiles: meshes for globes in browsers, or heights as colors of pictures for maps.

pub mod arguments;
mod colors;
mod degree_bounds;
pub mod encoding;
pub mod gather;
mod meshes;
pub mod plan;
mod tiling;
pub mod work;

//! From bits to triangles: one file per way.
//!
//! An emitter calls a closure with triples of grid vertices, counter-clockwise seen from above. It knows no
//! heights: `world::placing` makes a closure that puts the triples into a mesh in world space, `strips` and the
//! like make closures that count or collect them.
//!
//! | file | source | from |
//! |---|---|---|
//! | `bintree` | Duchaineau et al. 1997 | active vertices |
//! | `quadtree` | the restricted quadtree of five-vertex nodes; fans | active vertices |
//! | `strips` | triangle strips along the bintree's order | any triangles in order |
//! | `geomipmap` | de Boer 2000, GeoMipMap | a level a patch |
//! | `full` | – | the posts alone |
//!
//! The first three give the same triangles from the same bits. `walk` is the one way down the bintree.

pub mod bintree;
pub mod full;
pub mod geomipmap;
pub mod quadtree;
pub mod strips;
pub mod walk;
pub mod world;

#[cfg(test)]
mod examples;

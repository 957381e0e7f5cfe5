//! The level-of-detail core: longest-edge bisection on one vertex graph.
//!
//! A bintree triangle is split at the midpoint of its hypotenuse, and that midpoint is a grid vertex. So the
//! whole state of a mesh is one bit per vertex — active or not — and the mesh is conforming exactly when
//! every active vertex has its parents active:
//!
//! - `graph` is the arithmetic of vertices: level, parents, children; it knows no heights.
//! - `bintree` is the arithmetic of triangles: roots of a patch, splitting.
//! - `layout` lays patches over a lattice of any size; `ground` places their vertices in drawn world space,
//!   `field` does so for many.
//! - `errors` measures, once, how far each vertex's triangles are off the ground.
//! - `active` holds the bits; activating a vertex first activates its parents (the forced split).
//! - `roughness` says how rough the ground is around each post.
//! - `spheres` turns errors into nested spheres; `block` is one patch of them on its own.
//! - `criterion` turns an error and a view into a decision.
//! - `culling` tells which patches can be seen.
//! - `refine` sets the bits.
//! - `emit` turns the bits into triangles, in several ways; `quadtree` is the arithmetic of one of them.
//! - `displayed` is what the bits show, for what lies on it.
//! - `levels` is the order in which whatever is nested up the graph is made.
//! - `edit` mends errors and spheres after heights changed; `dynamic` is a terrain that can be edited.
//! - `closure` sets the fewest bits that keep an error bound; `bound` measures a mesh at every post.
//! - `paging` has patches of terrain larger than the memory, on demand.
//! - `shown` is what one frame shows as index lists; `frames` compares frames, `measure` the frame and the ground.
//! - `extract` reads triangles for a tolerance without a view off the errors themselves.
//!
//! Sources: Duchaineau et al. 1997 (ROAM); the patch-based forced splits and the screen-space error of the
//! later papers; Lindstrom and Pascucci 2001 for errors kept monotone up the graph.

pub mod active;
pub mod bintree;
pub mod block;
pub mod bound;
pub mod closure;
pub mod criterion;
pub mod culling;
pub mod displayed;
pub mod dynamic;
pub mod edit;
pub mod emit;
pub mod errors;
pub mod extract;
pub mod field;
pub mod frames;
pub mod graph;
pub mod layout;
pub mod levels;
pub mod measure;
pub mod paging;
pub mod patched_ground;
pub mod quadtree;
pub mod refine;
pub mod roughness;
pub mod shown;
pub mod spheres;

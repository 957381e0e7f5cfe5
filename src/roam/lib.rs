//! The level-of-detail core: longest-edge bisection on one vertex graph.
//!
//! A bintree triangle is split at the midpoint of its hypotenuse, and that midpoint is a grid vertex. So the state of a mesh
//! is one bit per vertex, active or not, and the mesh is conforming exactly when every active vertex has its parents active:
//!
//! - `graph`, `bintree`, `quadtree`: arithmetic of vertices, triangles and quadtree nodes, without heights.
//! - `layout`, `patched_ground`, `field`: patches over a lattice of any size, and the positions of their vertices.
//! - `errors`, `roughness`, `spheres`, `sphere_nest`: measures of each vertex, computed once; `block` is one patch of spheres.
//! - `active`: the bits; activating a vertex first activates its parents (the forced split).
//! - `criterion`, `culling`: whether a vertex is wanted in a view, and which patches are in view.
//! - `refine`: policies that set the bits; `closure`: the fewest bits that keep an error bound.
//! - `emit`, `extract`: triangles from bits, and from errors alone, without a view.
//! - `displayed`: the mesh of the bits as a surface for features; `measured_ground`: a ground with all its measures.
//! - `levels`, `edit`, `dynamic`: updates of errors and spheres after heights changed, and a terrain that can be edited;
//!   `sphere_task`: its spheres for another picture, made on another thread.
//! - `paging`: terrain larger than memory, for walks; `parts`: for a mesh of all of it.
//! - `shown`, `frames`, `measure`, `bound`, `part_bound`: index lists of a frame, comparisons of frames, of a frame with the ground, and of
//!   a mesh with the ground.
//!
//! Sources: Duchaineau et al. 1997 (ROAM); patch-based forced splits and screen-space errors of the later papers; Lindstrom
//! and Pascucci 2001 for errors kept monotone up the graph.

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
pub mod measured_ground;
pub mod paging;
pub mod part_bound;
pub mod parts;
pub mod patched_ground;
pub mod quadtree;
pub mod refine;
pub mod roughness;
pub mod shown;
mod sphere_nest;
pub mod sphere_task;
pub mod spheres;

/// The program of the README runs as a test.
#[cfg(doctest)]
#[doc = include_str!("README.md")]
pub struct RoamReadme;

//! Terrain out of memory's reach: patches are read when they are needed, and a few are kept.
//!
//! The vertices of a patch depend on the ground around it, but not far: a vertex's error and nested sphere hold those
//! of its descendants, and these lie less than one patch beyond its own.
//!
//! ```text
//! ┌───┬───┬───┐   the patch P, and the region that is read for it: its neighbors all round, clipped
//! │   │   │   │   at the terrain's border, and one more column or row of patches to the west or south
//! ├───┼───┼───┤   where the region would else begin at a patch whose diagonal runs the other way
//! │   │ P │   │
//! ├───┼───┼───┤   the middle of P's east side has descendants ½ + ¼ + ⅛ + … of a patch further east,
//! │   │   │   │   never a whole one
//! └───┴───┴───┘
//! ```
//!
//! So the region is measured like any terrain, by the same functions, and its patch P is bit for bit the one of the
//! whole terrain in memory: neighbors agree about the vertices they share without talking to each other.
//!
//! What is kept of every patch is a summary: enough to cull it, to tell that it is seen from so far that none of its
//! vertices is active, and to draw it then.
//!
//! - `region` reads a piece of the terrain and measures it.
//! - `summary` is what is always known of a patch, gathered in one pass over the terrain.
//! - `ground` is the source of patches with its bounded cache.
//! - `walk` is the plain way from an eye to triangles; a refiner does the same by what changed.
//!
//! Paper 000 names this as its future work; the patches as units of paging are those of its forced splits.

pub mod ground;
pub mod region;
pub mod summary;
pub mod walk;

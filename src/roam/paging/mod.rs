//! Terrain larger than memory: patches are read when they are needed, and a few are kept.
//!
//! The vertices of a patch depend on the ground around it, but not far: a vertex's error and nested sphere hold those of its
//! descendants, which lie less than one patch beyond its own.
//!
//! ```text
//! ┌───┬───┬───┐   the patch P and its region, which is read with it: its neighbors all round, clipped at
//! │   │   │   │   the terrain's border, and one more column or row of patches to the west or south
//! ├───┼───┼───┤   where the region would else begin at a patch with the other diagonal
//! │   │ P │   │
//! ├───┼───┼───┤   the middle of P's east side has descendants ½ + ¼ + ⅛ + … of a patch further east,
//! │   │   │   │   never a whole one
//! └───┴───┴───┘
//! ```
//!
//! So the region is measured like any terrain, by the same functions, and its patch P is bit for bit the one of the whole
//! terrain in memory: neighbors agree about the vertices they share.
//!
//! A summary is kept of every patch: enough to cull it, to know that the eye is so far away that none of its vertices is
//! active, and to draw it then.
//!
//! - `region` reads a piece of the terrain and measures it.
//! - `summary` is kept of every patch, gathered in one pass over the terrain.
//! - `ground` is the source of patches with its bounded cache.
//! - `walk` makes the triangles for an eye; a refiner does the same from frame to frame.
//!
//! Lin et al. (patch-based ROAM) name this as future work, with the patches of their forced splits as units of paging.

pub mod ground;
pub mod region;
pub mod summary;
pub mod walk;

//! Draw lists as files that other programs open: binary glTF and OBJ.
//!
//! What is drawn for a camera is not yet what a modeling program can show: the ground's color comes from a map that is
//! read at every pixel, and what lies on the ground lies in its very triangles, where a program that draws both sees
//! them flicker. So a list is prepared first:
//!
//! ```text
//!  DrawList ─► bake   the ground map as a texture
//!           ─► inlay  the ground without what lies on it
//!           ─► prepare: normals, and nothing without area  ─► glb | obj
//! ```

pub mod bake;
pub mod glb;
pub mod inlay;
pub mod obj;
pub mod png;
pub mod prepare;

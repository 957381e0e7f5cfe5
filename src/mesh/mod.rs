//! Triangle meshes: the plain value, the sink generators write to, the checks every mesh must pass, and the files
//! they are written to.

pub mod check;
pub mod sink;
pub mod trimesh;
pub mod write;

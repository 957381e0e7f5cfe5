//! Triangle meshes: the plain value, the sink generators write to, and the checks every mesh must pass.

pub mod check;
pub mod sink;
pub mod trimesh;

//! Triangle meshes: the value, the sink that generators write to, the checks that a terrain mesh must pass, and the
//! writers of mesh files.

pub mod check;
pub mod numbering;
pub mod sink;
pub mod trimesh;
pub mod write;

//! Triangle meshes: the value, the sink that generators write to, the source that writers read, the checks that a terrain mesh and a solid must pass,
//! solids for printers, and the writers of mesh files.

pub mod check;
pub mod numbering;
pub mod sink;
pub mod solid;
pub mod source;
pub mod trimesh;
pub mod write;

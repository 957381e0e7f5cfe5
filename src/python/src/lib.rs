//! The Python package `sandtable`: elevation and scenes of the library, NumPy arrays in and out.
//!
//! ```text
//! python/sandtable/__init__.py ─► _sandtable (this crate) ─► the front door of the library
//! ```
//!
//! Nothing is computed here: arguments become the library's options, answers become arrays. Work runs without the
//! interpreter's lock, so that other threads of Python run meanwhile. What Python sees is described in
//! `python/sandtable/__init__.pyi`.

#![forbid(unsafe_code)]

mod analysis;
mod arguments;
mod dem;
mod error;
mod findings;
mod plan;
mod program;
mod progress;
mod rasters;
mod remote;
mod results;
mod scene;
mod scene_data;
mod symbol;

use pyo3::prelude::*;

/// Elevation and scenes: heights, profiles, lines of sight, viewsheds, meshes and pictures.
#[pymodule]
mod _sandtable {
    #[pymodule_export]
    use crate::analysis::analysis_kinds;
    #[pymodule_export]
    use crate::dem::{PyDem, open_dem};
    #[pymodule_export]
    use crate::findings::PyFinding;
    #[pymodule_export]
    use crate::plan::PyPlan;
    #[pymodule_export]
    use crate::program::run_in_process;
    #[pymodule_export]
    use crate::rasters::{PyMesh, PyRaster};
    #[pymodule_export]
    use crate::results::{PyLineOfSight, PyProfile};
    #[pymodule_export]
    use crate::scene::PyScene;
    #[pymodule_export]
    use crate::scene_data::{PyFeatureLayer, features};
    #[pymodule_export]
    use crate::symbol::PySymbol;
    #[pymodule_export]
    use crate::{licenses, set_limit};

    /// The version of the library.
    #[pymodule_export]
    const __VERSION__: &str = env!("CARGO_PKG_VERSION");
}

/// Sets a limit on input and work by its name, such as "raster-samples", for the whole process: once, and before any file is
/// read. Raises ValueError where there is no such limit or the value is out of range.
#[pyfunction]
fn set_limit(name: &str, value: u64) -> PyResult<()> {
    sandtable::set_limit(name, value).map_err(error::wrong_value)
}

/// The notices of what the package is made of.
#[pyfunction]
fn licenses() -> String {
    [include_str!("../NOTICES.txt"), include_str!("../../../assets/NOTICES.txt")].join("\n")
}

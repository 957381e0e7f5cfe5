//! Terrain analyses: arguments of Python become texts, outcomes arrays of xarray, features and tables.

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyAnyMethods, PyDict};
use sandtable::{Analysis, Crs, Error, Samples, StopFlag};

use crate::arguments::{crs_name, transform};
use crate::error::failed;
use crate::progress::{SaidWork, said_meanwhile};
use crate::rasters::shaped;

/// The module of Python that reads arguments and makes what users see.
const HALF: &str = "sandtable._analysis";

/// The kinds of analysis as the text of a JSON list.
#[pyfunction(name = "_analysis_kinds")]
pub fn analysis_kinds() -> String {
    sandtable::analysis_kinds()
}

/// The one step of an analysis.
const ANALYZING: &str = "analyzing";

/// Calls `analyze` with the arguments of Python as texts, and makes its outcome a value of Python. `progress` is what the user
/// gave for it.
pub fn analyzed<'py>(
    py: Python<'py>,
    (arguments, progress): (Option<&Bound<'py, PyDict>>, Option<&Bound<'py, PyAny>>),
    crs: Crs,
    analyze: impl FnOnce(&[(&str, &str)], &Crs, &StopFlag) -> Result<Analysis, Error> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let half = py.import(HALF)?;
    let given = arguments.map_or_else(|| PyDict::new(py), Clone::clone);
    let written: Vec<(String, String)> = half.call_method1("written", (given,))?.extract()?;
    let texts: Vec<(&str, &str)> =
        written.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    let stop = StopFlag::default();
    let how_far = || stop.share().map(|share| (ANALYZING, Some(share)));
    let work = SaidWork { how_far: &how_far, stop: &|| stop.stop() };
    let made = said_meanwhile(py, progress, &work, || analyze(&texts, &crs, &stop))?;
    let analysis = made.map_err(failed)?;
    let said = PyDict::new(py);
    said.set_item("json", analysis.json())?;
    said.set_item("features", analysis.features())?;
    said.set_item("crs", crs_name(analysis.crs()))?;
    said.set_item("raster", raster(py, &analysis)?)?;
    half.call_method1("made", (said,))
}

/// The array of values with what it says of itself; None where there is none.
fn raster<'py>(py: Python<'py>, analysis: &Analysis) -> PyResult<Bound<'py, PyAny>> {
    let Some(dem) = analysis.raster() else { return py.None().into_bound_py_any(py) };
    let numbers = match dem.samples() {
        Samples::F32(values) => values.clone(),
        Samples::F64(values) => values.iter().map(|&value| value as f32).collect(),
    };
    let array = match analysis.has_codes() {
        true => {
            let code = |value: &f32| if value.is_nan() { u8::MAX } else { *value as u8 };
            shaped(py, numbers.iter().map(code).collect(), dem.size())?.into_bound(py).into_any()
        }
        false => shaped(py, numbers, dem.size())?.into_bound(py).into_any(),
    };
    let classes = analysis.classes();
    let tint = |[red, green, blue, opacity]: [u8; 4]| format!("#{red:02x}{green:02x}{blue:02x}{opacity:02x}");
    let said = PyDict::new(py);
    said.set_item("array", array)?;
    said.set_item("transform", transform(dem.geotransform()))?;
    said.set_item("name", analysis.name())?;
    said.set_item("units", analysis.unit())?;
    said.set_item("classes", classes.iter().map(|class| class.label.as_str()).collect::<Vec<_>>())?;
    said.set_item("class_from", classes.iter().map(|class| class.from).collect::<Vec<_>>())?;
    said.set_item("class_tints", classes.iter().map(|class| tint(class.tint)).collect::<Vec<_>>())?;
    Ok(said.into_any())
}

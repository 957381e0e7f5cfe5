//! Data of Python that a scene is built of: features of data frames, elevation of arrays, contents of files.

use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::{PyBool, PyBytes, PyFloat, PyInt, PyString};
use sandtable::{ColumnValues, FeatureColumn, FeatureLayer, SceneData};
use serde_json::{Number, Value};

use crate::dem::PyDem;
use crate::error::{failed, wrong_value};

/// Features in memory, for a scene.
#[pyclass(name = "_Features", module = "sandtable", frozen)]
pub struct PyFeatureLayer {
    layer: FeatureLayer,
}

#[pymethods]
impl PyFeatureLayer {
    fn __len__(&self) -> usize {
        self.layer.feature_count()
    }

    /// The name of the system of their coordinates.
    #[getter]
    fn crs(&self) -> String {
        self.layer.crs().name().to_owned()
    }
}

/// The features of `shapes`, well-known binary or None, and of `columns`, pairs of a name and an array or a list with a value a
/// shape, in the system `crs`.
#[pyfunction(name = "_features")]
pub fn features(
    py: Python<'_>,
    shapes: Vec<Option<PyBackedBytes>>,
    columns: Vec<(String, Bound<'_, PyAny>)>,
    crs: &Bound<'_, PyAny>,
) -> PyResult<PyFeatureLayer> {
    let crs = crate::arguments::crs(crs)?;
    let columns = columns.into_iter().map(|(name, values)| {
        let values = column_values(&values)?;
        if values.row_count() != shapes.len() {
            let (rows, count) = (values.row_count(), shapes.len());
            return Err(wrong_value(format!("column {name} has {rows} values for {count} shapes")));
        }
        Ok(FeatureColumn { name, values })
    });
    let columns = columns.collect::<PyResult<Vec<_>>>()?;
    let made =
        py.detach(|| FeatureLayer::from_wkb(crs, shapes.iter().map(|shape| shape.as_deref()), columns));
    Ok(PyFeatureLayer { layer: made.map_err(failed)? })
}

/// A column of NumPy, or a list of values of any type.
fn column_values(values: &Bound<'_, PyAny>) -> PyResult<ColumnValues> {
    if let Ok(numbers) = values.extract::<PyReadonlyArray1<'_, f64>>() {
        return Ok(ColumnValues::Numbers(numbers.as_array().to_vec()));
    }
    if let Ok(integers) = values.extract::<PyReadonlyArray1<'_, i64>>() {
        return Ok(ColumnValues::Integers(integers.as_array().to_vec()));
    }
    if let Ok(switches) = values.extract::<PyReadonlyArray1<'_, bool>>() {
        return Ok(ColumnValues::Switches(switches.as_array().to_vec()));
    }
    let mixed: PyResult<Vec<Value>> = values.try_iter()?.map(|value| property(&value?)).collect();
    Ok(ColumnValues::Mixed(mixed?))
}

/// A value of a property: a text, number or truth as such, what is missing as null, and everything else as its text.
fn property(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.extract()?));
    }
    if value.is_none() {
        return Ok(Value::Null);
    }
    if let Ok(switch) = value.cast::<PyBool>() {
        return Ok(Value::Bool(switch.is_true()));
    }
    if value.is_instance_of::<PyInt>()
        && let Ok(integer) = value.extract::<i64>()
    {
        return Ok(Value::Number(integer.into()));
    }
    if value.is_instance_of::<PyFloat>() || value.is_instance_of::<PyInt>() {
        return Ok(Number::from_f64(value.extract()?).map_or(Value::Null, Value::Number));
    }
    // What is missing is not equal to itself (NaT), or has no answer (NA).
    let is_missing = value.ne(value).unwrap_or(true);
    Ok(if is_missing { Value::Null } else { Value::String(value.str()?.extract()?) })
}

/// The data that a scene names: each features, elevation of an array, or the bytes of a file.
pub fn scene_data(given: &[(String, Bound<'_, PyAny>)]) -> PyResult<SceneData> {
    let mut data = SceneData::default();
    for (name, value) in given {
        if let Ok(features) = value.cast::<PyFeatureLayer>() {
            data.add_features(name, &features.get().layer);
        } else if let Ok(dem) = value.cast::<PyDem>() {
            let opened = || wrong_value(format!("{name} is of a file; name the file in the scene"));
            data.add_dem(name, dem.get().samples().ok_or_else(opened)?);
        } else if let Ok(bytes) = value.cast::<PyBytes>() {
            data.add_file(name, bytes.as_bytes().to_vec());
        } else {
            let kind = value.get_type().name()?;
            return Err(PyTypeError::new_err(format!("{name} is of type {kind}")));
        }
    }
    Ok(data)
}

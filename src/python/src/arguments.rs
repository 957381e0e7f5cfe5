//! Arguments of Python as the library's values: positions, coordinate systems, transforms, ends of lines of sight.

use std::borrow::Cow;

use numpy::{AllowTypeChange, PyArrayLike2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use sandtable::{Crs, Curvature, DVec2, Position, SightEnd};

use crate::error::wrong_value;

/// The highest end of a line of sight above the ground, meters: as the command line has it.
const HIGHEST_M: f64 = 1e5;

/// Positions as Python gives them.
pub enum PositionsArgument<'py> {
    /// An array of shape (N, 2), or what NumPy makes one of.
    Numbers(PyArrayLike2<'py, f64, AllowTypeChange>),
    /// Texts, in the system that is asked in.
    Places(Vec<DVec2>),
}

/// The positions of a text, of a sequence or an array of texts, or of an array of numbers, in `crs`.
pub fn positions<'py>(name: &str, value: &Bound<'py, PyAny>, crs: &Crs) -> PyResult<PositionsArgument<'py>> {
    if let Ok(text) = value.extract::<String>() {
        return Ok(PositionsArgument::Places(vec![place(name, &text, crs)?]));
    }
    // Arrays of NumPy and columns of pandas that hold texts.
    let kind = value.getattr("dtype").and_then(|dtype| dtype.getattr("kind")?.extract::<String>());
    let listed = match kind.as_deref() {
        Ok("O" | "U" | "T") => &value.call_method0("tolist")?,
        _ => value,
    };
    match listed.extract::<Vec<String>>() {
        Ok(texts) if !texts.is_empty() => {
            let places: PyResult<Vec<DVec2>> = texts.iter().map(|text| place(name, text, crs)).collect();
            Ok(PositionsArgument::Places(places?))
        }
        _ => Ok(PositionsArgument::Numbers(value.extract()?)),
    }
}

impl PositionsArgument<'_> {
    /// The positions; borrowed where rows of numbers follow each other in memory. `name` is that of the argument.
    pub fn positions(&self, name: &str) -> PyResult<Cow<'_, [DVec2]>> {
        let array = match self {
            Self::Numbers(array) => array,
            Self::Places(places) => return Ok(Cow::Borrowed(places)),
        };
        let shape = array.shape();
        if shape[1] != 2 {
            let (rows, columns) = (shape[0], shape[1]);
            return Err(wrong_value(format!(
                "{name} has shape ({rows}, {columns}); give (N, 2), x and y of each position"
            )));
        }
        let view = array.as_array();
        Ok(match view.to_slice() {
            Some(numbers) => Cow::Borrowed(bytemuck::cast_slice(numbers)),
            None => Cow::Owned(view.rows().into_iter().map(|row| DVec2::new(row[0], row[1])).collect()),
        })
    }
}

/// The place that a text states, in `crs`.
fn place(name: &str, text: &str, crs: &Crs) -> PyResult<DVec2> {
    let position =
        Position::parse(text).map_err(|error| wrong_value(format!("{name}: {}", error.with_forms())))?;
    position.in_system(crs).map_err(|error| wrong_value(format!("{name}: {error}")))
}

/// The coordinate system that a text, an EPSG code, a `pyproj.CRS` or a `rasterio.crs.CRS` names.
pub fn crs(value: &Bound<'_, PyAny>) -> PyResult<Crs> {
    if let Ok(text) = value.extract::<String>() {
        return Crs::parse(&text).map_err(wrong_value);
    }
    let code = match value.extract::<u32>() {
        Ok(code) => Some(code),
        Err(_) => value.call_method0("to_epsg")?.extract::<Option<u32>>()?,
    };
    if let Some(code) = code {
        return Crs::from_epsg(code).map_err(wrong_value);
    }
    let version = [("version", "WKT1_GDAL")].into_py_dict(value.py())?;
    let text: String = value.call_method("to_wkt", (), Some(&version))?.extract()?;
    Crs::parse(&text).map_err(wrong_value)
}

/// The system of positions: the stated one, or else `own`.
pub fn crs_or(stated: Option<&Bound<'_, PyAny>>, own: impl FnOnce() -> Crs) -> PyResult<Crs> {
    stated.map_or_else(|| Ok(own()), crs)
}

/// The name of a system; `None` for coordinates that have no place on Earth.
pub fn crs_name(crs: &Crs) -> Option<String> {
    (*crs != Crs::local()).then(|| crs.name().to_owned())
}

/// Six numbers in the order of the package `affine`: x per column, x per row, x of the north-west corner, and the same of y.
pub type Transform = (f64, f64, f64, f64, f64, f64);

/// GDAL's order of numbers in that of `affine`.
pub fn transform([x, x_column, x_row, y, y_column, y_row]: [f64; 6]) -> Transform {
    (x_column, x_row, x, y_column, y_row, y)
}

/// Six numbers, or the nine of an `affine.Affine`, in GDAL's order.
pub fn geotransform(transform: &[f64]) -> PyResult<[f64; 6]> {
    match *transform {
        [x_column, x_row, x, y_column, y_row, y]
        | [x_column, x_row, x, y_column, y_row, y, 0.0, 0.0, 1.0] => {
            Ok([x, x_column, x_row, y, y_column, y_row])
        }
        _ => Err(wrong_value(format!(
            "transform has {} numbers; give an affine.Affine, or its first six: x per column, x per row, x of the \
             north-west corner, and the same of y",
            transform.len()
        ))),
    }
}

/// An end of a line of sight or of a viewshed: (x, y) in `crs`, or a text.
pub fn end(name: &str, at: &Bound<'_, PyAny>, above_m: f64, crs: &Crs) -> PyResult<SightEnd> {
    let at = match at.extract::<String>() {
        Ok(text) => place(name, &text, crs)?,
        Err(_) => DVec2::from(at.extract::<[f64; 2]>()?),
    };
    if !at.is_finite() {
        return Err(wrong_value(format!("{name} is at {}, {}; give two finite numbers", at.x, at.y)));
    }
    Ok(SightEnd { at, above_m: height(name, above_m)? })
}

/// Meters above the ground at an end.
pub fn height(name: &str, above_m: f64) -> PyResult<f64> {
    if above_m.is_nan() || above_m.abs() > HIGHEST_M {
        return Err(wrong_value(format!("{name}_height is {above_m} m; give meters from -100000 to 100000")));
    }
    Ok(above_m)
}

/// The curvature that a refraction coefficient and a flat Earth state.
pub fn curvature(refraction: Option<f64>, flat: bool) -> PyResult<Curvature> {
    let round = Curvature::default();
    match (refraction, flat) {
        (Some(_), true) => {
            Err(wrong_value("refraction has no effect on a flat Earth; leave one of the two out"))
        }
        (Some(refraction), false) if !(-1.0..1.0).contains(&refraction) => Err(wrong_value(format!(
            "refraction is {refraction}; give a number from -1 to below 1, 0.13 to 0.17 is usual"
        ))),
        (_, true) => Ok(Curvature::FLAT),
        (stated, false) => Ok(Curvature { refraction: stated.unwrap_or(round.refraction), ..round }),
    }
}

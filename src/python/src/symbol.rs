//! Military symbols.

use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use sandtable::Symbol;

use crate::error::wrong_value;

/// Least and greatest height of the frame of a friendly unit, in pixels.
const SIZES: std::ops::RangeInclusive<f32> = 8.0..=1000.0;
/// That height in a notebook.
const NOTEBOOK_SIZE: f32 = 64.0;

/// A military symbol of MIL-STD-2525 or APP-6 with the text round it.
#[pyclass(name = "Symbol", module = "sandtable", frozen)]
pub struct PySymbol {
    code: String,
    symbol: Symbol,
}

#[pymethods]
impl PySymbol {
    /// The symbol of a code of 20 or 30 digits or of 15 letters; fields of text are keywords, such as
    /// unique_designation="1-12". Raises ValueError where the code is none or no symbol has such a field.
    #[new]
    #[pyo3(signature = (code, **fields))]
    fn new(code: String, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let fields: Vec<(String, String)> = match fields {
            Some(fields) => fields
                .iter()
                .filter(|(_, text)| !text.is_none())
                .map(|(key, text)| Ok((key.extract()?, text.str()?.extract()?)))
                .collect::<PyResult<_>>()?,
            None => Vec::new(),
        };
        let stated: Vec<(&str, &str)> =
            fields.iter().map(|(key, text)| (key.as_str(), text.as_str())).collect();
        let symbol = Symbol::new(&code, &stated).map_err(wrong_value)?;
        Ok(Self { code, symbol })
    }

    /// The code as it was stated.
    #[getter]
    fn code(&self) -> &str {
        &self.code
    }

    /// What the symbol is, such as "friend, land unit, infantry".
    #[getter]
    fn description(&self) -> String {
        self.symbol.description()
    }

    /// Parts of the code that the drawing lacks.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.symbol.notes().to_vec()
    }

    /// The text of an SVG picture, in which the frame of a friendly unit is `size` pixels high.
    #[pyo3(signature = (size = 100.0))]
    fn svg(&self, size: f32) -> PyResult<String> {
        Ok(self.symbol.svg(checked(size)?))
    }

    /// The bytes of a PNG picture, transparent where nothing is drawn.
    #[pyo3(signature = (size = 100.0))]
    fn png<'py>(&self, py: Python<'py>, size: f32) -> PyResult<Bound<'py, PyBytes>> {
        let size = checked(size)?;
        Ok(PyBytes::new(py, &py.detach(|| self.symbol.png(size))))
    }

    /// The picture as uint8 of shape (height, width, 4): red, green, blue and alpha.
    #[pyo3(signature = (size = 100.0))]
    fn render(&self, py: Python<'_>, size: f32) -> PyResult<Py<PyArray3<u8>>> {
        let size = checked(size)?;
        let picture = py.detach(|| self.symbol.render(size));
        let (width, height) = picture.size();
        let bytes = PyArray1::from_slice(py, picture.rgba());
        Ok(bytes.reshape([height as usize, width as usize, 4])?.unbind())
    }

    fn _repr_svg_(&self) -> String {
        self.symbol.svg(NOTEBOOK_SIZE)
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.symbol.png(NOTEBOOK_SIZE)))
    }

    fn __repr__(&self) -> String {
        format!("<Symbol {}: {}>", self.code, self.symbol.description())
    }
}

fn checked(size: f32) -> PyResult<f32> {
    let advice = "pixels are a number from 8 to 1000";
    Some(size)
        .filter(|size| SIZES.contains(size))
        .ok_or_else(|| wrong_value(format!("size {size}: {advice}")))
}

//! Errors of the library as exceptions of Python.

use std::fmt::Display;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::findings::PyFinding;

pyo3::import_exception!(sandtable._errors, SandtableError);

/// `SandtableError` with the file and the place of the library's error.
pub fn failed(error: sandtable::Error) -> PyErr {
    let file = error.file().map(|file| file.display().to_string());
    let findings: Vec<PyFinding> = error.findings().iter().map(PyFinding::new).collect();
    let (line, column) = findings.first().map_or((None, None), |first| (first.line, first.column));
    SandtableError::new_err((error.text(), file, line, column, findings))
}

/// `ValueError` about an argument.
pub fn wrong_value(reason: impl Display) -> PyErr {
    PyValueError::new_err(reason.to_string())
}

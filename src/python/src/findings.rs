//! The findings of the check of a scene.

use pyo3::prelude::*;
use sandtable::Finding;

/// A fault or a probable mistake in a scene.
#[pyclass(name = "Finding", module = "sandtable", frozen, get_all)]
pub struct PyFinding {
    /// Its stable code, such as "river-uphill"; `sandtable explain CODE` explains it.
    pub code: &'static str,
    /// "error", "warning" or "note".
    pub severity: &'static str,
    /// A sentence with numbers and units.
    pub message: String,
    /// The remedy, or None.
    pub help: Option<String>,
    /// The scene file, or one that it includes; None where the finding is about none in particular.
    pub file: Option<String>,
    /// The line there, from 1.
    pub line: Option<usize>,
    /// The column there, from 1, in characters.
    pub column: Option<usize>,
}

impl PyFinding {
    /// The library's finding.
    pub fn new(finding: &Finding) -> Self {
        let place = finding.place.as_ref();
        let position = place.map(|place| place.position());
        Self {
            code: finding.code.word(),
            severity: finding.severity().word(),
            message: finding.message.clone(),
            help: finding.help.clone(),
            file: place.map(|place| place.file().to_owned()),
            line: position.map(|position| position.line),
            column: position.map(|position| position.column),
        }
    }
}

#[pymethods]
impl PyFinding {
    fn __repr__(&self) -> String {
        let place = match (&self.file, self.line) {
            (Some(file), Some(line)) => format!("{file}:{line}: "),
            _ => String::new(),
        };
        format!("<Finding {place}{}[{}]: {}>", self.severity, self.code, self.message)
    }
}

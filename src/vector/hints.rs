//! Options for reading vector files.

use crate::geom::crs::{Crs, CrsError};
use crate::vector::error::VectorError;

/// Options for reading a vector file.
#[derive(Clone, Copy)]
pub struct VectorHints<'a> {
    /// The coordinate system; overrides what the file states.
    pub crs: Option<&'a Crs>,
    /// The name of the requested layer; without it the file must hold one layer.
    pub layer: Option<&'a str>,
    /// Returns the bytes of a file beside this one, `None` where there is none. The argument is the file's name with
    /// another extension.
    pub companions: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl Default for VectorHints<'_> {
    fn default() -> Self {
        Self { crs: None, layer: None, companions: &|_| None }
    }
}

impl VectorHints<'_> {
    /// Returns the stated system, else longitude and latitude on WGS 84.
    pub(crate) fn crs_or_wgs84(&self) -> Crs {
        self.crs.cloned().unwrap_or_else(Crs::wgs84)
    }

    /// Returns the stated system, else that of an EPSG code, else that of a definition (WKT or PROJ); `None` without
    /// any of them.
    ///
    /// # Errors
    /// [`CrsError`] where the last of those that are given is not understood.
    pub(crate) fn crs_or(
        &self,
        code: Option<u32>,
        definition: Option<&str>,
    ) -> Result<Option<Crs>, CrsError> {
        match (self.crs, code.map(Crs::from_epsg), definition) {
            (Some(crs), _, _) => Ok(Some(crs.clone())),
            (None, Some(Ok(crs)), _) => Ok(Some(crs)),
            (None, _, Some(definition)) => Crs::parse(definition).map(Some),
            (None, code, None) => code.transpose(),
        }
    }

    /// Returns the index of the requested layer among `names`, or of the only one.
    ///
    /// # Errors
    /// [`VectorError::NoSuchLayer`], [`VectorError::WhichLayer`].
    pub(crate) fn choose_layer(&self, names: &[&str]) -> Result<usize, VectorError> {
        match self.layer {
            Some(wanted) => {
                let index = names.iter().position(|&name| name == wanted);
                index.ok_or_else(|| VectorError::no_such_layer(wanted, names))
            }
            None if names.len() == 1 => Ok(0),
            None => Err(VectorError::which_layer(names)),
        }
    }
}

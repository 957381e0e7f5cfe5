//! Options for reading vector files.

use crate::error::VectorError;
use sandtable_geom::crs::{Crs, CrsError};

/// Options for reading a vector file.
#[derive(Clone, Copy)]
pub struct VectorHints<'a> {
    /// The coordinate system; overrides what the file states.
    pub crs: Option<&'a Crs>,
    /// Called with the system that the file states where `crs` takes its place.
    pub overridden: &'a dyn Fn(&Crs),
    /// The name of the requested layer; without it the file must hold one layer.
    pub layer: Option<&'a str>,
    /// What columns of a table hold: `position`, `lon`, `lat`, `x`, `y`, `zone`, `z` or `shape`, or the name of a property, each with
    /// the name of a column; by the names of the columns where it is empty.
    pub columns: &'a [(String, String)],
    /// Returns the bytes of a file beside this one, `None` where there is none. The argument is the file's name with
    /// another extension.
    pub companions: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl Default for VectorHints<'_> {
    fn default() -> Self {
        Self { crs: None, overridden: &|_| (), layer: None, columns: &[], companions: &|_| None }
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
        let own = match (code.map(Crs::from_epsg), definition) {
            (Some(Ok(crs)), _) => Ok(Some(crs)),
            (_, Some(definition)) => Crs::parse(definition).map(Some),
            (code, None) => code.transpose(),
        };
        let Some(crs) = self.crs else { return own };
        // What the file states may be unreadable: another is stated for that.
        if let Ok(Some(own)) = own {
            (self.overridden)(&own);
        }
        Ok(Some(crs.clone()))
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

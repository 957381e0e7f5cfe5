//! The datasets that are served, by name.
//!
//! They are opened when the service starts, so that no request reads from disk. Their ground in meters, for which an
//! elevation file in degrees must be warped, is made in the background; queries for it wait.

use std::sync::Arc;

use crate::message::chain::error_text;
use crate::pipeline::dataset::{Dataset, OpenError};
use crate::pipeline::service::{NamedFile, ServiceOptions};
use crate::serve::reply::{HttpError, quoted};
use crate::terrain::query::service::Snapshot;

pub struct ServedDataset {
    pub name: String,
    pub dataset: Dataset,
}

impl ServedDataset {
    /// The current ground; waits while it is being made.
    pub fn snapshot(&self) -> Result<Arc<Snapshot>, HttpError> {
        let service = self.dataset.service().map_err(|error| {
            let (name, reason) = (quoted(&self.name), error_text(&error));
            HttpError::wrong(format!("dataset {name} has no ground in meters: {reason}"))
        })?;
        Ok(service.snapshot())
    }
}

/// All datasets, in the order in which they were named; at least one.
pub struct Datasets(Vec<ServedDataset>);

impl Datasets {
    pub fn open(options: &ServiceOptions) -> Result<Self, OpenError> {
        let open = |file: &NamedFile| {
            let dataset = Dataset::open(file.path(), &options.dataset)?;
            let warn = |warning: &str| (options.write_line)(&format!("warning: {warning}"));
            dataset.warning().into_iter().for_each(warn);
            dataset.ground_note().iter().for_each(|note| (options.write_line)(&format!("note: {note}")));
            Ok(ServedDataset { name: file.name().to_owned(), dataset })
        };
        options.datasets.iter().map(open).collect::<Result<_, _>>().map(Self)
    }

    pub fn all(&self) -> &[ServedDataset] {
        &self.0
    }

    pub fn at(&self, index: usize) -> &ServedDataset {
        &self.0[index]
    }

    fn find(&self, name: &str) -> Result<usize, HttpError> {
        self.0.iter().position(|served| served.name == name).ok_or_else(|| {
            HttpError::unknown(format!("there is no dataset {}; there are {}", quoted(name), self.names()))
        })
    }

    /// The indices of the datasets in a list of names with commas between.
    pub fn find_all(&self, list: &str) -> Result<Vec<usize>, HttpError> {
        let mut indices = Vec::new();
        for name in list.split(',') {
            let index = self.find(name)?;
            if indices.contains(&index) {
                return Err(HttpError::wrong(format!("dataset {} is named twice", quoted(name))));
            }
            indices.push(index);
        }
        Ok(indices)
    }

    /// The index of the dataset `name`, which may be missing where only one is served.
    pub fn find_one(&self, name: Option<&str>) -> Result<usize, HttpError> {
        match name {
            Some(name) => self.find(name),
            None if self.0.len() == 1 => Ok(0),
            None => Err(HttpError::wrong(format!(
                "'dataset' is missing; write it as in dataset={}, there are {}",
                self.0[0].name,
                self.names()
            ))),
        }
    }

    pub fn names(&self) -> String {
        let names: Vec<&str> = self.0.iter().map(|served| served.name.as_str()).collect();
        names.join(", ")
    }
}

//! The datasets that are served, by name.
//!
//! They are opened when the program starts, and never again: nothing that a request says reaches the disk. Their ground
//! in meters, which an elevation file in degrees must be warped for, is made in the background then; who asks for it
//! before it is there waits for it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use crate::app::arguments::{Access, StatedHeights};
use crate::app::dataset::Dataset;
use crate::app::failure::CliError;
use crate::app::serve::json;
use crate::app::serve::params::Params;
use crate::app::serve::reply::{HttpError, quoted};
use crate::terrain::query::service::Snapshot;

/// What is asked for at `/v1/NAME` and is no dataset.
const TAKEN: [&str; 3] = ["los", "profile", "viewshed"];

/// A dataset and its name.
pub struct Served {
    /// What requests call it.
    pub name: String,
    /// The name as a JSON string, quotes and all.
    pub name_json: Vec<u8>,
    /// What answers.
    pub data: Dataset,
    ground: OnceLock<Result<(), String>>,
}

/// Whether a dataset's ground in meters can be asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroundState<'a> {
    /// It is there.
    Ready,
    /// It is being made.
    Awaited,
    /// The dataset has none: why.
    None(&'a str),
}

impl Served {
    /// Opens what an argument names: `NAME=FILE`, or `FILE` whose name without its ending is the dataset's.
    ///
    /// # Errors
    /// The file cannot be had or read, or its name cannot be part of an address.
    pub fn open(argument: &str, heights: StatedHeights, access: &Access) -> Result<Self, CliError> {
        let (name, path) = named(argument);
        check_name(&name, argument)?;
        let data = Dataset::open(&path, heights, access)?;
        let mut name_json = Vec::new();
        json::string(&mut name_json, &name);
        Ok(Self { name, name_json, data, ground: OnceLock::new() })
    }

    /// Makes the ground in meters, where it is not there yet.
    pub fn prepare(&self) {
        self.ground.get_or_init(|| match self.data.service() {
            Ok(_) => Ok(()),
            Err(CliError::Input(reason) | CliError::Usage(reason)) => Err(reason),
        });
    }

    /// Whether the ground can be asked.
    pub fn ground(&self) -> GroundState<'_> {
        match self.ground.get() {
            Some(Ok(())) => GroundState::Ready,
            Some(Err(reason)) => GroundState::None(reason),
            None => GroundState::Awaited,
        }
    }

    /// The ground as it is now; waits for it where it is being made.
    ///
    /// # Errors
    /// There is none; the message says why.
    pub fn epoch(&self) -> Result<Arc<Snapshot>, HttpError> {
        self.prepare();
        match self.data.service() {
            Ok(service) => Ok(service.snapshot()),
            Err(CliError::Input(reason) | CliError::Usage(reason)) => Err(HttpError::wrong(format!(
                "dataset {} has no ground in meters: {reason}",
                quoted(&self.name)
            ))),
        }
    }
}

/// All datasets, in the order of the arguments.
pub struct Datasets(Vec<Served>);

impl Datasets {
    /// Opens all that the arguments name.
    ///
    /// # Errors
    /// As for [`Served::open`]; or two have the same name.
    pub fn open(arguments: &[String], heights: StatedHeights, access: &Access) -> Result<Self, CliError> {
        let mut all: Vec<Served> = Vec::with_capacity(arguments.len());
        for argument in arguments {
            let next = Served::open(argument, heights, access)?;
            if all.iter().any(|other| other.name == next.name) {
                return Err(CliError::Usage(format!(
                    "two datasets are named '{0}': give one of them another name, as in other={argument}",
                    next.name
                )));
            }
            all.push(next);
        }
        Ok(Self(all))
    }

    /// All of them, in the order of the arguments.
    pub fn all(&self) -> &[Served] {
        &self.0
    }

    /// The dataset at an index that [`Datasets::find`] returned.
    pub fn at(&self, index: usize) -> &Served {
        &self.0[index]
    }

    /// The index of the dataset with a name.
    ///
    /// # Errors
    /// There is none; the message lists those that there are.
    pub fn find(&self, name: &str) -> Result<usize, HttpError> {
        self.0.iter().position(|served| served.name == name).ok_or_else(|| {
            HttpError::unknown(format!("there is no dataset {}; there are {}", quoted(name), self.names()))
        })
    }

    /// The indices of the datasets whose names stand in `list` with commas between.
    ///
    /// # Errors
    /// There is no such dataset, or one is named twice.
    pub fn find_all(&self, list: &str) -> Result<Vec<usize>, HttpError> {
        let mut found = Vec::new();
        for name in list.split(',') {
            let index = self.find(name)?;
            if found.contains(&index) {
                return Err(HttpError::wrong(format!("dataset {} is named twice", quoted(name))));
            }
            found.push(index);
        }
        Ok(found)
    }

    /// The index of the dataset that the parameter `dataset` names; where only one is served, it need not be named.
    ///
    /// # Errors
    /// There is no such dataset, or none is named and several are served.
    pub fn asked(&self, params: &Params<'_>) -> Result<usize, HttpError> {
        match params.get("dataset") {
            Some(name) => self.find(name),
            None if self.0.len() == 1 => Ok(0),
            None => Err(HttpError::wrong(format!(
                "'dataset' is missing; write it as in dataset={}, there are {}",
                self.0[0].name,
                self.names()
            ))),
        }
    }

    /// All names, for a message.
    pub fn names(&self) -> String {
        let names: Vec<&str> = self.0.iter().map(|served| served.name.as_str()).collect();
        names.join(", ")
    }
}

/// The name and the file of an argument. An `=` that is part of the path of a file that is there divides nothing.
fn named(argument: &str) -> (String, PathBuf) {
    let whole = Path::new(argument);
    let divided = argument.split_once('=').filter(|(name, _)| !name.contains(['/', '\\']));
    match divided {
        Some((name, file)) if !whole.exists() => (name.to_owned(), PathBuf::from(file)),
        _ => {
            let stem = whole.file_stem().unwrap_or_default();
            (stem.to_string_lossy().into_owned(), whole.to_path_buf())
        }
    }
}

fn check_name(name: &str, argument: &str) -> Result<(), CliError> {
    let wrong = if TAKEN.contains(&name) {
        "is the address of a question"
    } else if name.is_empty() {
        "is empty"
    } else if name.len() > 100 {
        "is longer than 100 bytes"
    } else if name.contains(|c: char| c.is_control() || matches!(c, ',' | '/' | '?' | '#' | '%' | '\\')) {
        "holds a character that an address cannot"
    } else {
        return Ok(());
    };
    Err(CliError::Usage(format!(
        "the dataset name '{name}' {wrong}: give it another, as in hills={}",
        argument.split_once('=').map_or(argument, |(_, file)| file)
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dataset_has_the_name_that_is_given_or_its_files() {
        assert_eq!(named("data/hills.tif"), ("hills".into(), "data/hills.tif".into()));
        assert_eq!(named("a=data/hills.tif"), ("a".into(), "data/hills.tif".into()));
        assert_eq!(named("data/x=1/hills.tif"), ("hills".into(), "data/x=1/hills.tif".into()));
        assert_eq!(named("a=b=c.tif"), ("a".into(), "b=c.tif".into()));
    }

    #[test]
    fn names_that_an_address_cannot_hold_are_refused() {
        for wrong in ["", "los", "a,b", "a/b", "50%", "a\nb", &"x".repeat(101)] {
            assert!(check_name(wrong, "f.tif").is_err(), "{wrong}");
        }
        for right in ["N43E007", "dem_srtm wgs84", "höhen", "a.b-c"] {
            assert!(check_name(right, "f.tif").is_ok(), "{right}");
        }
    }
}

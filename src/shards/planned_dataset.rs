//! The elevation file or scene of a plan, and how it is read.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{PlanError, PlanFault, ShardError};
use crate::input::{PlanInput, elevation_files};
use crate::plan_path::{place, relative, written};
use sandtable_base::message::choice::Choice;
use sandtable_dem::hints::DemOptions;
use sandtable_geom::crs::Crs;
use sandtable_query::dataset::{Dataset, DatasetOptions};

/// A dataset as a plan states it: what [`DatasetOptions`] says, in words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedDataset {
    file: PathBuf,
    /// The system of positions; the dataset's own where none is stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    crs: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    height_scale: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    height_offset: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    nodata: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    height_encoding: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    vertical_datum: Option<String>,
    /// Meters in the unit of elevations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    vertical_unit: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    raw: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    allow: Vec<PathBuf>,
}

/// A dataset that is opened, and the system of positions.
pub struct QueriedDataset {
    /// Where it is.
    pub path: PathBuf,
    /// The dataset.
    pub dataset: Dataset,
    /// The system of positions.
    pub crs: Crs,
}

impl PlannedDataset {
    /// The dataset at `file` for a plan in `folder`. `crs` is the stated system of positions.
    pub fn new(file: &Path, options: &DatasetOptions, crs: Option<&Crs>, folder: &Path) -> Self {
        let DemOptions { height_scale, height_offset, nodata, height_encoding, vertical_unit, raw, .. } =
            options.dem;
        Self {
            file: written(file, folder),
            crs: crs.map(|crs| crs.name().to_owned()),
            height_scale,
            height_offset,
            nodata,
            height_encoding: height_encoding.map(|encoding| encoding.to_string()),
            vertical_datum: options.dem.vertical_datum.clone(),
            vertical_unit,
            raw: raw.map(|raw| raw.to_string()),
            allow: options.allowed.iter().map(|allowed| written(allowed, folder)).collect(),
        }
    }

    /// The path of the file, of a plan in `folder`.
    pub fn path(&self, folder: &Path) -> PathBuf {
        place(&self.file, folder)
    }

    /// The folders that a scene may read besides the parent of its own, of a plan in `folder`.
    pub fn allowed(&self, folder: &Path) -> Vec<PathBuf> {
        self.allow.iter().map(|allowed| folder.join(allowed)).collect()
    }

    /// Opens the dataset of a plan in `folder`.
    ///
    /// # Errors
    /// An argument is wrong, or the dataset cannot be opened.
    pub fn open(&self, folder: &Path) -> Result<QueriedDataset, ShardError> {
        let fault = |name: &str, found: &str, why: String| wrong_value(folder, name, found, &why);
        let parse_raw = |raw: &String| raw.parse().map_err(|error| fault("raw", raw, format!("{error}")));
        let raw = self.raw.as_ref().map(parse_raw).transpose()?;
        let parse_encoding = |encoding: &String| {
            encoding.parse().map_err(|error| fault("height_encoding", encoding, format!("{error}")))
        };
        let height_encoding = self.height_encoding.as_ref().map(parse_encoding).transpose()?;
        let crs = self.stated_crs(folder)?;
        let dem = DemOptions {
            height_scale: self.height_scale,
            height_offset: self.height_offset,
            nodata: self.nodata,
            height_encoding,
            raw,
            vertical_datum: self.vertical_datum.clone(),
            vertical_unit: self.vertical_unit,
            ..DemOptions::default()
        };
        let options = DatasetOptions { dem, allowed: self.allowed(folder), ..DatasetOptions::default() };
        let path = self.path(folder);
        let dataset = Dataset::open(&path, &options)?;
        let crs = crs.unwrap_or_else(|| dataset.crs());
        Ok(QueriedDataset { path, dataset, crs })
    }

    /// The system of positions that the plan states.
    ///
    /// # Errors
    /// It is none.
    pub fn stated_crs(&self, folder: &Path) -> Result<Option<Crs>, ShardError> {
        let parse = |crs: &String| {
            Crs::parse(crs).map_err(|error| wrong_value(folder, "crs", crs, &error.to_string()))
        };
        self.crs.as_ref().map(parse).transpose()
    }

    /// The files that the opened dataset is read of, as inputs of a plan in `folder`.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn inputs(&self, dataset: &Dataset, folder: &Path) -> Result<Vec<PlanInput>, ShardError> {
        match dataset.scene_files() {
            Some(files) => scene_inputs(&self.file, files, folder),
            None => inputs(&self.file, &elevation_files(&self.path(folder))?, folder),
        }
    }
}

/// The error about a value of the plan in `folder`.
fn wrong_value(folder: &Path, name: &str, found: &str, why: &str) -> ShardError {
    let fault = PlanFault::Value(format!("`{name}` is '{found}': {why}"));
    PlanError::new(&folder.join("plan.json"), fault).into()
}

/// A scene file, which a plan in `folder` calls `stated`, and the files that it was made of.
///
/// # Errors
/// One cannot be read.
pub fn scene_inputs(stated: &Path, files: &[PathBuf], folder: &Path) -> Result<Vec<PlanInput>, ShardError> {
    let files: Vec<PathBuf> = [place(stated, folder)].into_iter().chain(files.iter().cloned()).collect();
    inputs(stated, &files, folder)
}

/// Files as inputs of a plan in `folder`, stated relative to it where `stated` is.
fn inputs(stated: &Path, files: &[PathBuf], folder: &Path) -> Result<Vec<PlanInput>, ShardError> {
    let input = |file: &PathBuf| {
        let path = if stated.is_absolute() { file.clone() } else { relative(file, folder) };
        (file.clone(), path)
    };
    Ok(PlanInput::all(&files.iter().map(input).collect::<Vec<_>>())?)
}

/// A value that a plan states by its word.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlannedWord<T>(pub T);

impl<T: Default + PartialEq> PlannedWord<T> {
    /// Whether it is the word that holds where a plan states none.
    pub fn is_default(&self) -> bool {
        self.0 == T::default()
    }
}

impl<T: Choice> Serialize for PlannedWord<T> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.word())
    }
}

impl<'de, T: Choice> Deserialize<'de> for PlannedWord<T> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        let words: Vec<&str> = T::CHOICES.iter().map(|choice| choice.word).collect();
        let unknown =
            || serde::de::Error::custom(format!("found '{word}', the words are {}", words.join(", ")));
        T::from_word(&word).map(Self).ok_or_else(unknown)
    }
}

//! The datasets that are served, by name.
//!
//! They are opened when the service starts, so that no request reads from disk, but for elevation larger than a raster in
//! memory may be: of that, a request reads what it needs. Their ground in meters, for which an
//! elevation file in degrees must be warped, is made in the background; queries for it wait. What lies on the ground of a
//! scene is built when the first analysis needs it; for the map of an analysis the scene is read again.

use std::path::PathBuf;
use std::sync::OnceLock;

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use glam::DVec2;
use serde::Serialize;

use crate::reply::{HttpError, OK, quoted};
use crate::service::Service;
use sandtable_base::message::chain::error_text;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_draw::ground::ColorRamp;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_query::dataset::{Dataset, OpenError, QueryError};
use sandtable_query::ground::QueriedGround;
use sandtable_query::overviews::Overviews;
use sandtable_query::service::{NamedFile, ServiceOptions};
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_raster::raster::Raster;
use sandtable_scene::analysis_map::{MapTexts, ground_map, scene_map};
use sandtable_scene::climate::Climate;
use sandtable_scene::ramps::{self, TintedGround};
use sandtable_scene::scene_file::open_scene_land;
use sandtable_scene::scene_model::SceneModel;

pub struct ServedDataset {
    pub name: String,
    pub dataset: Dataset,
    source: DatasetSource,
    /// The scene with what lies on its ground, true to scale, once an analysis needs it.
    scene: OnceLock<Result<Box<SceneModel>, String>>,
    /// Where it lies on Earth; `None` where that is not known.
    bounds: Option<DatasetBounds>,
    /// What tiles of its map need, once the first is drawn.
    tile_map: OnceLock<Result<TileMap, String>>,
}

/// What tiles of a map need.
pub struct TileMap {
    /// Smaller rasters, for pixels of many samples.
    pub overviews: Overviews,
    /// The tints of heights.
    pub ramp: ColorRamp,
}

/// Where a dataset was opened.
struct DatasetSource {
    path: PathBuf,
    allowed: Vec<PathBuf>,
}

impl ServedDataset {
    /// The scene with what lies on its ground; `None` of an elevation file. Waits while it is being built.
    pub fn scene(&self) -> Result<Option<&SceneModel>, HttpError> {
        if self.dataset.scene_files().is_none() {
            return Ok(None);
        }
        let DatasetSource { path, allowed } = &self.source;
        let build = || open_scene_land(path, allowed, &|_| ()).map(Box::new);
        let built = self.scene.get_or_init(|| build().map_err(|error| error_text(&error)));
        match built {
            Ok(scene) => Ok(Some(scene)),
            Err(reason) => {
                let reason = format!("dataset {} cannot be built: {reason}", quoted(&self.name));
                Err(HttpError::new(StatusCode::INTERNAL_SERVER_ERROR, reason))
            }
        }
    }

    /// The scene under the map of an analysis: of a scene file, which is read again, or of the ground alone.
    pub fn map(&self, texts: MapTexts, ground: impl FnOnce() -> Raster) -> Result<SceneModel, HttpError> {
        let DatasetSource { path, allowed } = &self.source;
        let map = match self.dataset.scene_files() {
            Some(_) => scene_map(path, allowed, texts, &|_| ()),
            None => ground_map(path, ground(), texts, &|_| ()),
        };
        map.map_err(|error| {
            let reason =
                format!("the map of dataset {} cannot be built: {}", quoted(&self.name), error_text(&error));
            HttpError::new(StatusCode::INTERNAL_SERVER_ERROR, reason)
        })
    }

    /// The texts of the map of an analysis, with its arguments as they are stated.
    pub fn map_texts<'a>(
        &self,
        kind: &AnalysisKind,
        stated: impl Iterator<Item = (&'a str, &'a str)>,
    ) -> MapTexts {
        MapTexts::of_analysis(kind, &self.source.path, stated)
    }

    /// Where it lies on Earth; `None` where that is not known.
    pub fn bounds(&self) -> Option<&DatasetBounds> {
        self.bounds.as_ref()
    }

    /// What tiles of its map need. Waits while smaller rasters are made, for which a file without overviews is read once.
    pub fn tile_map(&self) -> Result<&TileMap, HttpError> {
        let make = || {
            let overviews = Overviews::new(&self.dataset)?;
            let middle = |bounds: &DatasetBounds| {
                let (west, east, south, north) = (bounds.west, bounds.east, bounds.south, bounds.north);
                DVec2::new(f64::midpoint(west, east), f64::midpoint(south, north))
            };
            let climate = Climate::at(self.bounds.as_ref().map(middle));
            let ramp = ramps::atlas(&TintedGround { range_m: overviews.range_m(), climate, has_sea: false });
            Ok(TileMap { overviews, ramp })
        };
        let made = self.tile_map.get_or_init(|| make().map_err(|error: QueryError| error_text(&error)));
        made.as_ref().map_err(|reason| {
            HttpError::wrong(format!("dataset {} has no map: {reason}", quoted(&self.name)))
        })
    }

    /// The facts about the dataset.
    pub fn facts(&self) -> DatasetFacts<'_> {
        let source = self.dataset.header();
        let extent = source.extent();
        DatasetFacts {
            name: &self.name,
            crs: source.crs.as_ref().map(|crs| crs.name().to_owned()),
            extent: DatasetExtent {
                min_x: extent.min.x,
                min_y: extent.min.y,
                max_x: extent.max.x,
                max_y: extent.max.y,
            },
            columns: source.width,
            rows: source.height,
            bounds: self.bounds.as_ref(),
        }
    }

    /// The current ground as far as a query reaches; waits while it is being made.
    pub fn ground(&self, reach: &GroundReach) -> Result<QueriedGround, HttpError> {
        self.dataset.ground(reach).map_err(|error| self.no_ground(&error))
    }

    /// Waits until queries for the ground can be answered.
    pub fn prepare_ground(&self) -> Result<(), HttpError> {
        self.dataset.prepare_ground().map_err(|error| self.no_ground(&error))
    }

    fn no_ground(&self, error: &QueryError) -> HttpError {
        let (name, reason) = (quoted(&self.name), error_text(error));
        HttpError::wrong(format!("dataset {name} has no ground in meters: {reason}"))
    }
}

/// The description of a dataset in answers.
#[derive(Serialize)]
pub struct DatasetFacts<'a> {
    name: &'a str,
    crs: Option<String>,
    /// Of the raster as read, out to its outer edges, in `crs`.
    extent: DatasetExtent,
    columns: u32,
    rows: u32,
    /// Its place on Earth; left out where that is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    bounds: Option<&'a DatasetBounds>,
}

/// The latitudes and longitudes between which a dataset lies, degrees on WGS 84.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DatasetBounds {
    pub south: f64,
    pub west: f64,
    pub north: f64,
    pub east: f64,
}

impl DatasetBounds {
    /// The bounds of the places of a raster that maps in Web Mercator reach; `None` without a system, or without such places.
    fn of(raster: &Raster) -> Option<Self> {
        /// The latitude where the world of Web Mercator, a square, ends.
        const NORTHERNMOST: f64 = 85.051_128;
        let (crs, wgs84) = (raster.crs.as_ref()?, Crs::wgs84());
        let places = raster.extent().grid_points().filter_map(|at| crs.transform(&wgs84, at).ok());
        let bounds = Rect::around(places);
        let (south, north) = (bounds.min.y.max(-NORTHERNMOST), bounds.max.y.min(NORTHERNMOST));
        let is_place = south < north && bounds.min.x < bounds.max.x;
        is_place.then_some(Self { south, west: bounds.min.x, north, east: bounds.max.x })
    }
}

#[derive(Serialize)]
struct DatasetExtent {
    min_x: f64,
    min_y: f64,
    max_x: f64,
    max_y: f64,
}

/// `/datasets`, in the frame that the Open Topo Data API gives it.
#[derive(Serialize)]
struct DatasetList<'a> {
    results: Vec<DatasetFacts<'a>>,
    status: &'static str,
}

pub fn page(service: &Service) -> Response {
    let results = service.datasets.all().iter().map(ServedDataset::facts).collect();
    Json(DatasetList { results, status: OK }).into_response()
}

/// All datasets, in the order in which they were named; at least one.
pub struct Datasets(Vec<ServedDataset>);

impl Datasets {
    pub fn open(options: &ServiceOptions) -> Result<Self, OpenError> {
        let open = |file: &NamedFile| {
            let dataset = Dataset::open(file.path(), &options.dataset)?;
            let warn = |warning: &str| (options.write_line)(&format!("warning: {warning}"));
            dataset.warning().into_iter().for_each(warn);
            dataset.reading_notes().iter().for_each(|note| (options.write_line)(&format!("note: {note}")));
            dataset.ground_note().iter().for_each(|note| (options.write_line)(&format!("note: {note}")));
            let source =
                DatasetSource { path: file.path().to_owned(), allowed: options.dataset.allowed.clone() };
            let bounds = DatasetBounds::of(&dataset.header());
            Ok(ServedDataset {
                name: file.name().to_owned(),
                dataset,
                source,
                scene: OnceLock::new(),
                bounds,
                tile_map: OnceLock::new(),
            })
        };
        options.datasets.iter().map(open).collect::<Result<_, _>>().map(Self)
    }

    pub fn all(&self) -> &[ServedDataset] {
        &self.0
    }

    pub fn at(&self, index: usize) -> &ServedDataset {
        &self.0[index]
    }

    /// The dataset of this name.
    pub fn named(&self, name: &str) -> Option<&Dataset> {
        self.0.iter().find(|served| served.name == name).map(|served| &served.dataset)
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

//! Errors of plans and shards.

use std::path::Path;

use sandtable_base::limits::{PLAN_OBSERVERS, PLAN_POINTS, PLAN_SHARDS, RASTER_SAMPLES};
use sandtable_export::features::FeatureExportError;
use sandtable_files::disk::{ReadFileError, WriteFileError};
use sandtable_files::error::FileError;
use sandtable_files::raster_file::WriteRasterError;
use sandtable_query::analysis::AnalyzeError;
use sandtable_query::dataset::{OpenError, QueryError};
use sandtable_query::dem::OpenDemError;
use sandtable_query::ground::GroundError;
use sandtable_query::heights_above::HeightsAboveError;
use sandtable_query::positions::PositionsError;
use sandtable_render::RenderError;
use sandtable_scene::scene_file::OpenSceneError;
use sandtable_sheet::picture::PictureError;

/// A plan that cannot be made, a shard that cannot be done, or results that cannot be gathered.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ShardError {
    #[error(transparent)]
    Read(#[from] ReadFileError),
    #[error(transparent)]
    Write(#[from] WriteFileError),
    #[error(transparent)]
    WriteRaster(#[from] WriteRasterError),
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error(transparent)]
    Open(#[from] OpenError),
    #[error(transparent)]
    OpenResult(#[from] OpenDemError),
    #[error(transparent)]
    Query(#[from] QueryError),
    #[error(transparent)]
    Ground(#[from] GroundError),
    #[error(transparent)]
    Scene(#[from] OpenSceneError),
    #[error(transparent)]
    Picture(#[from] PictureError),
    #[error(transparent)]
    Points(#[from] PositionsError),
    #[error(transparent)]
    Above(#[from] FileError<HeightsAboveError>),
    #[error(transparent)]
    Analyze(Box<AnalyzeError>),
    #[error(transparent)]
    Features(#[from] FeatureExportError),
}

impl From<AnalyzeError> for ShardError {
    fn from(error: AnalyzeError) -> Self {
        Self::Analyze(Box::new(error))
    }
}

impl ShardError {
    /// The file that is at fault; `None` where the error is about none in particular.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Read(error) => Some(&error.path),
            Self::Write(error) => Some(&error.path),
            Self::Plan(error) => Some(&error.path),
            Self::OpenResult(error) | Self::Open(OpenError::Dem(error)) => error.file(),
            Self::Open(OpenError::Scene(error)) => error.file(),
            Self::Query(error) => error.dataset().map(Path::new),
            Self::Above(error) => Some(&error.path),
            _ => None,
        }
    }
}

/// A file of a plan, an input or a result that is refused.
pub type PlanError = FileError<PlanFault>;

/// Why a file of a plan, an input or a result is refused.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum PlanFault {
    #[error("this is not a plan as `sandtable plan` writes it; plan again")]
    Json(#[from] serde_json::Error),
    #[error("line {0}: this is not a shard as `sandtable plan` writes it; plan again")]
    Line(usize, #[source] serde_json::Error),
    #[error("the plan has version {found}, and this program works on version {known}; plan again with it")]
    Version { found: u32, known: u32 },
    #[error(
        "the plan was made by sandtable {found}, and this is {own}, whose results may differ; plan again with it"
    )]
    Program { found: String, own: &'static str },
    #[error("its `backend` is gpu: work on it where there is a graphics adapter, or plan again with cpu")]
    Backend(#[source] Box<RenderError>),
    #[error("{0}; plan again")]
    Value(String),
    #[error("{0}")]
    Output(String),
    #[error("the plan has no shard {found}; its shards are 0 to {last}")]
    NoShard { found: usize, last: usize },
    #[error("it holds no points")]
    NoPoints,
    #[error("it names no coordinate system, or lies nowhere on the globe; tiles need longitude and latitude")]
    NoPlace,
    #[error(
        "it lies between latitudes {south} and {north}, and Web Mercator ends at 85.05; plan quantized-mesh tiles of it"
    )]
    BeyondMercator { south: f64, north: f64 },
    #[error("its ground has no elevation anywhere")]
    NoGround,
    #[error("it holds more than the {PLAN_POINTS} points of a plan; cut it, or {PLAN_POINTS:#}")]
    TooManyPoints,
    #[error("{0} shards are more than the {PLAN_SHARDS} of a plan; plan fewer, or {PLAN_SHARDS:#}")]
    TooManyShards(u64),
    #[error("a line of more than {0} bytes is no line of points")]
    LongLine(usize),
    /// An input that is not the one that was planned with.
    #[error("stale: {0}; plan again")]
    Stale(String),
    #[error("the result is not the one of its record; do the shard again")]
    Result,
    #[error("it holds more than the {PLAN_OBSERVERS} observers of a plan; cut it, or {PLAN_OBSERVERS:#}")]
    TooManyObservers,
    #[error(
        "all observers together look at {columns} x {rows} posts, more than the {RASTER_SAMPLES} of a raster in memory; \
         plan parts of the region, or {RASTER_SAMPLES:#}"
    )]
    Region { columns: u64, rows: u64 },
    #[error(
        "the analysis has {columns} x {rows} posts, more than the {RASTER_SAMPLES} of a raster in memory; plan an `extent` of the \
         land, or {RASTER_SAMPLES:#}"
    )]
    AnalysisPosts { columns: u64, rows: u64 },
}

//! The one error of the library's operations.

use std::path::{Path, PathBuf};

use glam::DVec2;

use crate::api::analysis::AnalysisFailure;
use crate::api::dem::SamplesError;
use sandtable_base::message::chain::error_text;
use sandtable_dem::formats::WRITTEN_EXTENSIONS;
use sandtable_description::finding::Finding;
use sandtable_files::disk::WriteFileError;
use sandtable_files::error::diagnostics_text;
use sandtable_files::raster_file::WriteRasterError;
use sandtable_query::bounded_mesh::MeshError;
use sandtable_query::dataset::{OpenError, QueryError};
use sandtable_query::dem::OpenDemError;
use sandtable_query::ground::GroundError;
use sandtable_query::profile::ProfileError;
use sandtable_raster::answer::Status;
use sandtable_scene::scene_file::OpenSceneError;
use sandtable_shards::error::ShardError;
use sandtable_sheet::picture::PictureError;
use sandtable_symbology::labeled::LabeledSymbolError;
use sandtable_vector::error::VectorError;
use sandtable_view::camera::CameraError;

/// Why an operation failed. The operation's own error is the source, or the error itself where nothing is to add.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An elevation file cannot be opened.
    #[error(transparent)]
    OpenDem(#[from] OpenDemError),
    /// Samples make no elevation model.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// A query has no answer.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// A line gives no profile.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// Elevation cannot be brought to a ground in meters.
    #[error(transparent)]
    Ground(#[from] GroundError),
    /// A scene cannot be opened.
    #[error(transparent)]
    OpenScene(#[from] OpenSceneError),
    /// A scene has no view of this name.
    #[error("the scene has no view '{0}'; its views are {1}")]
    NoView(String, String),
    /// There is no height at a position.
    #[error("{}, {}: {}", .0.x, .0.y, match .1 {
        Status::NoData => "the elevation model has no data there",
        _ => "the position lies outside the elevation model",
    })]
    NoHeight(DVec2, Status),
    /// A camera cannot be made.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The ground gives no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A picture cannot be made.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A code or fields make no military symbol.
    #[error(transparent)]
    Symbol(#[from] LabeledSymbolError),
    /// A plan cannot be read, a shard cannot be done, or the product cannot be written.
    #[error(transparent)]
    Plan(Box<ShardError>),
    /// Shapes make no features.
    #[error(transparent)]
    Features(#[from] VectorError),
    /// An analysis has no outcome.
    #[error(transparent)]
    Analysis(Box<AnalysisFailure>),
    /// No raster format has this extension.
    #[error("{}: rasters are written as {WRITTEN_EXTENSIONS}; name a file that ends so", .0.display())]
    NoFormat(PathBuf),
    /// A raster cannot be written.
    #[error(transparent)]
    WriteRaster(#[from] WriteRasterError),
    /// A file cannot be written.
    #[error(transparent)]
    WriteFile(#[from] WriteFileError),
}

impl From<ShardError> for Error {
    fn from(error: ShardError) -> Self {
        Self::Plan(Box::new(error))
    }
}

impl From<AnalysisFailure> for Error {
    fn from(error: AnalysisFailure) -> Self {
        Self::Analysis(Box::new(error))
    }
}

impl From<OpenError> for Error {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::Dem(error) => Self::OpenDem(error),
            OpenError::Scene(error) => Self::OpenScene(error),
        }
    }
}

impl Error {
    /// The message with its causes, as the program prints it: that of a scene file shows each wrong line.
    pub fn text(&self) -> String {
        diagnostics_text(self).unwrap_or_else(|| error_text(self))
    }

    /// The file that the error is about, where it is about one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::OpenDem(error) => error.file(),
            Self::OpenScene(error) => error.file(),
            Self::Query(error) | Self::Profile(ProfileError::Query(error)) => error.dataset().map(Path::new),
            Self::Plan(error) => error.file(),
            Self::NoFormat(path) => Some(path),
            Self::WriteFile(error) => Some(&error.path),
            _ => None,
        }
    }

    /// The errors in a scene file that keep it from being built, each with its place; none where the error is about
    /// something else.
    pub fn findings(&self) -> Vec<Finding> {
        match self {
            Self::OpenScene(error) => error.findings(),
            _ => Vec::new(),
        }
    }
}

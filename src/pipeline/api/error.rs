//! The one error of the library's operations.

use std::path::PathBuf;

use glam::DVec2;

use crate::dem::answer::Status;
use crate::dem::formats::WRITTEN_EXTENSIONS;
use crate::pipeline::bounded_mesh::MeshError;
use crate::pipeline::dem::OpenDemError;
use crate::pipeline::files::WriteFileError;
use crate::pipeline::ground::GroundError;
use crate::pipeline::picture::PictureError;
use crate::pipeline::raster_file::WriteRasterError;
use crate::pipeline::scene_file::OpenSceneError;
use crate::view::camera::CameraError;

/// Why an operation failed. The operation's own error is the source, or the error itself where nothing is to add.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An elevation file cannot be opened.
    #[error(transparent)]
    OpenDem(#[from] OpenDemError),
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

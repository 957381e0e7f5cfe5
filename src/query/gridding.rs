//! Opening scattered points and breaklines for gridding.

use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};

use sandtable_dem::points;
use sandtable_dem::points::cloud::{PointCloud, PointHints};
use sandtable_dem::points::error::PointsError;
use sandtable_files::disk::{self, ReadFileError};
use sandtable_files::error::FileError;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_vector::error::VectorError;
use sandtable_vector::feature::{Feature, Geometry, Polygon, VectorLayer};
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read;

/// Points that cannot be opened.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum OpenPointsError {
    #[error(transparent)]
    File(#[from] ReadFileError),
    #[error(transparent)]
    Points(#[from] FileError<PointsError>),
    #[error(transparent)]
    Vector(#[from] FileError<VectorError>),
    #[error("{}: no point in it has an elevation; points with a z are needed", .0.display())]
    FlatPoints(PathBuf),
    #[error("{}: no line in it has an elevation at every vertex; breaklines with a z are needed", .0.display())]
    FlatLines(PathBuf),
    #[error(transparent)]
    Crs(#[from] FileError<CrsError>),
    #[error("name at least one file of points")]
    NoFiles,
}

/// The files of a survey.
#[derive(Clone, Debug, Default)]
pub struct PointSources<'a> {
    /// Files of points.
    pub points: &'a [PathBuf],
    /// Vector files whose lines the ground breaks along.
    pub breaklines: &'a [PathBuf],
    /// The coordinate system, in place of the ones that the files state.
    pub crs: Option<Crs>,
    /// The classes of LAS points that are taken. Empty: ground (class 2) where a file has any, else all.
    pub classes: &'a [u8],
}

impl PointSources<'_> {
    /// All points and breaklines, in the coordinate system and the vertical unit of the first file.
    ///
    /// # Errors
    /// See [`OpenPointsError`].
    pub fn open(&self) -> Result<PointCloud, OpenPointsError> {
        let points = self.points.iter().map(|path| (path, self.open_points(path)));
        let breaklines = self.breaklines.iter().map(|path| (path, self.open_breaklines(path)));
        let mut clouds = points.chain(breaklines);
        let (_, first) = clouds.next().ok_or(OpenPointsError::NoFiles)?;
        clouds.try_fold(first?, |cloud, (path, next)| Ok(joined(cloud, next?).map_err(FileError::at(path))?))
    }

    fn open_points(&self, path: &Path) -> Result<PointCloud, OpenPointsError> {
        let bytes = disk::read(path)?;
        if points::recognizes(&disk::file_name(path), &bytes) {
            let hints = PointHints { crs: self.crs.as_ref(), classes: self.classes };
            return Ok(points::read(&bytes, &hints).map_err(FileError::at(path))?);
        }
        let layer = self.read_layer(path, &bytes)?;
        let points: Vec<DVec3> = layer.features.iter().flat_map(vertices).collect();
        if points.is_empty() {
            return Err(OpenPointsError::FlatPoints(path.to_owned()));
        }
        let vertices =
            layer.features.iter().map(|feature| feature.geometry.vertices().count()).sum::<usize>();
        let mut cloud = cloud(layer);
        if let Some(without @ 1..) = vertices.checked_sub(points.len()) {
            cloud.notes.push(format!("{without} points without a height were left out"));
        }
        Ok(PointCloud { points, ..cloud })
    }

    fn open_breaklines(&self, path: &Path) -> Result<PointCloud, OpenPointsError> {
        let layer = self.read_layer(path, &disk::read(path)?)?;
        let breaklines: Vec<Vec<DVec3>> = layer.features.iter().flat_map(breaklines).collect();
        if breaklines.is_empty() {
            return Err(OpenPointsError::FlatLines(path.to_owned()));
        }
        let parts = layer.features.iter().map(|feature| parts(&feature.geometry)).sum::<usize>();
        let mut cloud = cloud(layer);
        if let Some(without @ 1..) = parts.checked_sub(breaklines.len()) {
            cloud.notes.push(format!("{without} lines with a vertex without a height were left out"));
        }
        Ok(PointCloud { breaklines, ..cloud })
    }

    fn read_layer(&self, path: &Path, bytes: &[u8]) -> Result<VectorLayer, OpenPointsError> {
        let companions = &disk::beside(path);
        let hints = VectorHints { crs: self.crs.as_ref(), companions, ..VectorHints::default() };
        Ok(read::read(&disk::file_name(path), bytes, &hints).map_err(FileError::at(path))?)
    }
}

/// A cloud with the system and the notes of a layer, and no points yet.
fn cloud(layer: VectorLayer) -> PointCloud {
    let notes = layer.reading_notes().cloned().collect();
    PointCloud { crs: Some(layer.crs), notes, ..PointCloud::new(Vec::new()) }
}

/// The vertices of a feature that have an elevation.
fn vertices(feature: &Feature) -> Vec<DVec3> {
    let elevations = feature.elevations.as_deref().unwrap_or_default();
    let vertices = feature.geometry.vertices().zip(elevations).map(|(at, &z)| at.extend(z));
    vertices.filter(|vertex| vertex.is_finite()).collect()
}

/// The lines of a feature, and the borders of its polygons, where every vertex has an elevation.
fn breaklines(feature: &Feature) -> Vec<Vec<DVec3>> {
    let elevations = feature.elevations.as_deref().unwrap_or_default();
    let mut elevations = elevations.iter().copied().chain(std::iter::repeat(f64::NAN));
    let mut line = |part: &[DVec2]| -> Vec<DVec3> {
        part.iter().zip(elevations.by_ref()).map(|(at, z)| at.extend(z)).collect()
    };
    let lines: Vec<Vec<DVec3>> = match &feature.geometry {
        Geometry::Points(_) => Vec::new(),
        Geometry::Lines(lines) => lines.iter().map(|part| line(part)).collect(),
        Geometry::Polygons(polygons) => {
            let closed = |mut ring: Vec<DVec3>| {
                ring.extend(ring.first().copied());
                ring
            };
            polygons.iter().flat_map(Polygon::rings).map(|ring| closed(line(ring))).collect()
        }
    };
    lines.into_iter().filter(|line| line.len() > 1 && line.iter().all(|vertex| vertex.is_finite())).collect()
}

/// The lines of a shape and the borders of its polygons.
fn parts(geometry: &Geometry) -> usize {
    match geometry {
        Geometry::Points(_) => 0,
        Geometry::Lines(lines) => lines.len(),
        Geometry::Polygons(polygons) => polygons.iter().map(|polygon| polygon.rings().count()).sum(),
    }
}

/// Two clouds in the system and the unit of the first.
fn joined(mut first: PointCloud, mut second: PointCloud) -> Result<PointCloud, CrsError> {
    let factor = second.meters_per_z / first.meters_per_z;
    let systems = first.crs.as_ref().zip(second.crs.as_ref()).filter(|(to, from)| to != from);
    for point in second.points.iter_mut().chain(second.breaklines.iter_mut().flatten()) {
        if let Some((to, from)) = systems {
            *point = from.transform(to, point.truncate())?.extend(point.z);
        }
        if factor != 1.0 {
            point.z *= factor;
        }
    }
    first.points.append(&mut second.points);
    first.breaklines.append(&mut second.breaklines);
    first.crs = first.crs.or(second.crs);
    first.vertical_datum = first.vertical_datum.or(second.vertical_datum);
    first.notes.append(&mut second.notes);
    Ok(first)
}

//! Arrays with their place: rasters of bytes, and meshes.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use sandtable::{Dem, Terrain, TriMesh};

use crate::arguments::{Transform, crs_name, transform};

/// An array with its georeference, such as a viewshed or a hillshade.
#[pyclass(name = "Raster", module = "sandtable", frozen, get_all)]
pub struct PyRaster {
    /// uint8 of shape (rows, columns), from the north-west.
    array: Py<PyArray2<u8>>,
    /// Six numbers as in `affine.Affine(*transform)`, of the outer north-west corner.
    transform: Transform,
    /// The coordinate system, or None.
    crs: Option<String>,
    /// The value that means no data.
    nodata: u8,
}

impl PyRaster {
    /// The raster of bytes `dem`.
    pub fn new(py: Python<'_>, dem: &Dem) -> PyResult<Self> {
        let nodata = dem.nodata().map_or(u8::MAX, |nodata| nodata as u8);
        let bytes: Vec<u8> = py.detach(|| {
            dem.samples().iter().map(|value| if value.is_nan() { nodata } else { value as u8 }).collect()
        });
        Ok(Self {
            array: shaped(py, bytes, dem.size())?,
            transform: transform(dem.geotransform()),
            crs: dem.crs().and_then(crs_name),
            nodata,
        })
    }
}

#[pymethods]
impl PyRaster {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shape = self.array.bind(py).getattr("shape")?;
        Ok(format!("<Raster {shape}, crs {}>", self.crs.as_deref().unwrap_or("None")))
    }
}

/// The array of samples, row by row, of so many columns and rows.
pub fn shaped<T: numpy::Element>(
    py: Python<'_>,
    samples: Vec<T>,
    (columns, rows): (u32, u32),
) -> PyResult<Py<PyArray2<T>>> {
    let array = PyArray1::from_vec(py, samples).reshape([rows as usize, columns as usize])?;
    Ok(array.unbind())
}

/// A mesh of the ground.
#[pyclass(name = "Mesh", module = "sandtable", frozen, get_all)]
pub struct PyMesh {
    /// float32 of shape (V, 3): meters east and north of `origin`, and the elevation.
    vertices: Py<PyArray2<f32>>,
    /// uint32 of shape (T, 3): indices of vertices, counter-clockwise seen from above.
    triangles: Py<PyArray2<u32>>,
    /// Map coordinates of the south-west post.
    origin: (f64, f64),
    /// The coordinate system of `origin`, or None.
    crs: Option<String>,
}

impl PyMesh {
    /// A mesh of `terrain`.
    pub fn new(py: Python<'_>, terrain: &Terrain, mesh: &TriMesh) -> PyResult<Self> {
        let positions = mesh.positions.iter().flat_map(|position| position.to_array()).collect();
        let corners = mesh.triangles.iter().flat_map(|corners| corners.map(|corner| corner.index() as u32));
        let (south_west, _) = terrain.extent();
        Ok(Self {
            vertices: shaped(py, positions, (3, mesh.positions.len() as u32))?,
            triangles: shaped(py, corners.collect(), (3, mesh.triangles.len() as u32))?,
            origin: south_west.into(),
            crs: crs_name(terrain.crs()),
        })
    }
}

#[pymethods]
impl PyMesh {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let count = |array: Bound<'_, PyAny>| array.len();
        let (vertices, triangles) = (
            count(self.vertices.bind(py).clone().into_any())?,
            count(self.triangles.bind(py).clone().into_any())?,
        );
        Ok(format!("<Mesh of {vertices} vertices and {triangles} triangles>"))
    }
}

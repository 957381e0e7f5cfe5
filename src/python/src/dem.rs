//! Elevation models and the queries of them.

use std::ffi::CString;
use std::path::PathBuf;

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyUserWarning};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyAnyMethods, PyDict, PyTuple};
use sandtable::{
    Crs, Curvature, Dem, DemOptions, Elevation, HeightSlices, HillshadeOptions, Interpolation, Samples,
    Sampling, Sector, SightQuery, Status, StopFlag, Surface, ViewshedOptions,
};

use crate::analysis::analyzed;
use crate::arguments::{
    Transform, crs_name, crs_or, curvature, end, geotransform, height, positions, transform,
};
use crate::error::{failed, wrong_value};
use crate::rasters::{PyMesh, PyRaster, shaped};
use crate::results::{PyLineOfSight, PyProfile, sight_chart};

/// An elevation model. Made by `Dem.open` or `Dem.from_array`.
#[pyclass(name = "Dem", module = "sandtable", frozen)]
pub struct PyDem {
    elevation: Elevation,
    /// Where it was opened; `None` for an array.
    file: Option<DemSource>,
    /// The samples of an array; `None` of a file.
    samples: Option<Dem>,
}

/// A file, what it does not state and the hosts that it may be read from: all that another process needs to open it.
#[derive(Clone)]
struct DemSource {
    path: PathBuf,
    stated: StatedDem,
    allow_remote: Vec<String>,
}

/// What an elevation file does not state: the system, the value for no data, the vertical datum, meters in the unit of heights, meters
/// per value and of value 0, and meters between samples.
type StatedDem =
    (Option<String>, Option<f64>, Option<String>, Option<f64>, Option<f64>, Option<f64>, Option<f64>);

impl DemSource {
    fn open(self, py: Python<'_>) -> PyResult<PyDem> {
        crate::remote::allow(&self.allow_remote)?;
        let (crs, nodata, vertical_datum, vertical_unit, height_scale, height_offset, cell) =
            self.stated.clone();
        let crs = crs.map(|text| Crs::parse(&text)).transpose().map_err(wrong_value)?;
        let opened = py.detach(|| {
            let options = DemOptions {
                crs,
                nodata,
                vertical_datum,
                vertical_unit,
                height_scale,
                height_offset,
                cell,
                ..DemOptions::default()
            };
            Elevation::open_with(&self.path, &options)
        });
        let elevation = opened.map_err(failed)?;
        if let Some(warning) = elevation.warning() {
            let text = CString::new(warning.replace('\0', " ")).map_err(wrong_value)?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 2)?;
        }
        Ok(PyDem { elevation, file: Some(self), samples: None })
    }
}

/// Opens what `Dem.__reduce__` names.
#[pyfunction(name = "_open_dem")]
pub fn open_dem(
    py: Python<'_>,
    path: PathBuf,
    stated: StatedDem,
    allow_remote: Vec<String>,
) -> PyResult<PyDem> {
    DemSource { path, stated, allow_remote }.open(py)
}

impl PyDem {
    /// The line of sight from an observer to a target at heights above the ground, in meters.
    fn sight_query(
        &self,
        [observer, target]: [&Bound<'_, PyAny>; 2],
        [observer_m, target_m]: [f64; 2],
        curvature: Curvature,
        crs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<SightQuery> {
        let crs = crs_or(crs, || self.elevation.crs())?;
        let ends = [end("observer", observer, observer_m, &crs)?, end("target", target, target_m, &crs)?];
        Ok(SightQuery { ends, crs, curvature })
    }

    /// The samples of an array; `None` of a file.
    pub fn samples(&self) -> Option<&Dem> {
        self.samples.as_ref()
    }
}

#[pymethods]
impl PyDem {
    /// Opens an elevation file with its sidecars, the tiles in a folder, or the ground of a scene (.toml).
    ///
    /// A file of more than a million samples stays on disk where its format allows that, and queries read what they need.
    /// `crs`, `nodata`, `vertical_datum`, `vertical_unit` (meters in the unit of its heights), `height_scale` and `height_offset`
    /// (meters) and `cell` (meters) state what the file does not.
    ///
    /// `path` may be an address, a str: https://, s3://, gs:// or az://. Its host must be one of `allow_remote`, each HOST or
    /// HOST:PORT, which are allowed in this process from then on; credentials come from the variables of the clouds. Raises
    /// SandtableError.
    #[staticmethod]
    #[pyo3(signature = (path, *, crs = None, nodata = None, vertical_datum = None, vertical_unit = None, height_scale = None, height_offset = None, cell = None, allow_remote = Vec::new()), text_signature = "(path, *, crs=None, nodata=None, vertical_datum=None, vertical_unit=None, height_scale=None, height_offset=None, cell=None, allow_remote=())")]
    #[expect(clippy::too_many_arguments, reason = "they are keywords of Python")]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        crs: Option<&Bound<'_, PyAny>>,
        nodata: Option<f64>,
        vertical_datum: Option<String>,
        vertical_unit: Option<f64>,
        height_scale: Option<f64>,
        height_offset: Option<f64>,
        cell: Option<f64>,
        allow_remote: Vec<String>,
    ) -> PyResult<Self> {
        let crs = crs.map(crate::arguments::crs).transpose()?.map(|crs| crs.name().to_owned());
        let stated = (crs, nodata, vertical_datum, vertical_unit, height_scale, height_offset, cell);
        DemSource { path, stated, allow_remote }.open(py)
    }

    /// The elevation model of an array of shape (rows, columns) in meters, from the north-west, which is copied.
    ///
    /// `transform` is an `affine.Affine` or its first six numbers, of the outer north-west corner; NaN, `nodata` and masked
    /// values mean no data. Raises SandtableError.
    #[staticmethod]
    #[pyo3(signature = (array, transform, crs = None, *, nodata = None))]
    fn from_array(
        array: &Bound<'_, PyAny>,
        transform: Vec<f64>,
        crs: Option<&Bound<'_, PyAny>>,
        nodata: Option<f64>,
    ) -> PyResult<Self> {
        let (columns, samples) = samples(array, nodata)?;
        let crs = crs.map(crate::arguments::crs).transpose()?;
        let dem = Dem::from_samples(columns, samples, geotransform(&transform)?, crs).map_err(failed)?;
        Ok(Self { elevation: Elevation::new(&dem), file: None, samples: Some(dem) })
    }

    /// The file that it was opened of, and what was stated besides, by the keys of `[terrain]`; None of an array.
    #[getter]
    fn _source<'py>(&self, py: Python<'py>) -> PyResult<Option<(PathBuf, Bound<'py, PyDict>)>> {
        let Some(DemSource { path, stated, .. }) = &self.file else { return Ok(None) };
        let (crs, nodata, vertical_datum, vertical_unit, height_scale, height_offset, cell) = stated;
        let keys = PyDict::new(py);
        keys.set_item("crs", crs)?;
        keys.set_item("nodata", nodata)?;
        keys.set_item("vertical_datum", vertical_datum)?;
        keys.set_item("vertical_unit", vertical_unit)?;
        keys.set_item("height_scale", height_scale)?;
        keys.set_item("height_offset", height_offset)?;
        keys.set_item("cell", cell)?;
        Ok(Some((path.clone(), keys)))
    }

    /// Writes the samples of an array as a raster, in the format of the path's extension.
    fn _save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let samples = self.samples.as_ref().ok_or_else(|| wrong_value("it was opened of a file"))?;
        py.detach(|| samples.save(&path)).map_err(failed)
    }

    /// (rows, columns).
    #[getter]
    fn shape(&self) -> (u32, u32) {
        let (columns, rows) = self.elevation.size();
        (rows, columns)
    }

    /// (west, south, east, north): the outer edges of the samples in map coordinates.
    #[getter]
    fn bounds(&self) -> (f64, f64, f64, f64) {
        let [x, x_column, x_row, y, y_column, y_row] = self.elevation.geotransform();
        let (columns, rows) = self.elevation.size();
        let side = |start: f64, across: f64, down: f64| {
            let (across, down) = (across * f64::from(columns), down * f64::from(rows));
            let corners = [start, start + across, start + down, start + across + down];
            corners
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &at| (low.min(at), high.max(at)))
        };
        let ((west, east), (south, north)) = (side(x, x_column, x_row), side(y, y_column, y_row));
        (west, south, east, north)
    }

    /// Six numbers as in `affine.Affine(*transform)`: x per column, x per row, x of the outer north-west corner, and the same
    /// of y.
    #[getter]
    fn transform(&self) -> Transform {
        transform(self.elevation.geotransform())
    }

    /// The coordinate system as `pyproj` and `rasterio` read it, such as "EPSG:32616"; None where the file states none.
    #[getter]
    fn crs(&self) -> Option<String> {
        crs_name(&self.elevation.crs())
    }

    /// What heights are counted from, in the file's words; None where not stated.
    #[getter]
    fn vertical_datum(&self) -> Option<String> {
        self.elevation.vertical_datum()
    }

    /// What reading its files left out or guessed, each in a sentence.
    #[getter]
    fn notes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.elevation.notes())
    }

    /// The samples: float32 or float64 of shape (rows, columns), from the north-west, NaN for no data, in the file's vertical
    /// unit.
    fn to_numpy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let dem = py.detach(|| self.elevation.dem()).map_err(failed)?;
        Ok(match dem.samples() {
            Samples::F32(values) => shaped(py, values.clone(), dem.size())?.into_bound(py).into_any(),
            Samples::F64(values) => shaped(py, values.clone(), dem.size())?.into_bound(py).into_any(),
        })
    }

    /// The heights at positions: float64 of shape (N,), meters, NaN where there is no data or the position lies outside.
    ///
    /// `xy` is float64 of shape (N, 2) in `crs`, by default the file's; it is read in place where its rows follow each other in
    /// memory. Or it is a text or texts that state their places: grid references, UTM, degrees with letters. `interpolation` is "bilinear", "planar", "nearest", "cubic" or "distance-weighted"; `surface` is "source", the
    /// raster as read, or "ground", the ground in meters, by default the source of a file and the ground of a scene.
    #[pyo3(signature = (xy, interpolation = "bilinear", *, surface = None, crs = None))]
    fn heights<'py>(
        &self,
        py: Python<'py>,
        xy: &Bound<'py, PyAny>,
        interpolation: &str,
        surface: Option<&str>,
        crs: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let interpolation: Interpolation = interpolation.parse().map_err(wrong_value)?;
        let surface = surface.map_or(Ok(self.elevation.default_surface()), str::parse::<Surface>);
        let (surface, crs) = (surface.map_err(wrong_value)?, crs_or(crs, || self.elevation.crs())?);
        let given = positions("xy", xy, &crs)?;
        let at = given.positions("xy")?;
        let heights = PyArray1::<f64>::zeros(py, at.len(), false);
        let mut written = heights.readwrite();
        let heights_m = written.as_slice_mut()?;
        let answered = py.detach(|| {
            let mut statuses = vec![Status::Outside; at.len()];
            let out = HeightSlices { heights_m, statuses: &mut statuses };
            self.elevation.heights(surface, interpolation, (&crs, &at), out)
        });
        drop(written);
        answered.map_err(failed)?;
        Ok(heights)
    }

    /// The ground along a line: a station wherever it bends, and every `step` meters.
    ///
    /// `line` is float64 of shape (N, 2), at least two positions in `crs`, by default the file's, or texts as in `heights`. The line is straight in the
    /// ground's coordinate system.
    #[pyo3(signature = (line, *, interpolation = "planar", step = None, crs = None))]
    fn profile(
        &self,
        py: Python<'_>,
        line: &Bound<'_, PyAny>,
        interpolation: &str,
        step: Option<f64>,
        crs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyProfile> {
        let crs = crs_or(crs, || self.elevation.crs())?;
        let given = positions("line", line, &crs)?;
        let vertices = given.positions("line")?;
        if vertices.len() < 2 {
            return Err(wrong_value(format!("line has {} positions; give at least two", vertices.len())));
        }
        let interpolation: Interpolation = interpolation.parse().map_err(wrong_value)?;
        let sampling = Sampling { interpolation, step_m: step };
        let profile = py.detach(|| self.elevation.profile((&crs, &vertices), sampling)).map_err(failed)?;
        PyProfile::new(py, &profile)
    }

    /// Whether `target` is seen from `observer`, both (x, y) in `crs`, by default the file's, or texts as in `heights`.
    ///
    /// `observer_height` and `target_height` are meters above the ground; `refraction` is the share of the Earth's curvature
    /// that bent light makes up for, 1/7 by default; `flat` assumes a flat Earth without air.
    #[pyo3(signature = (observer, target, *, observer_height = 2.0, target_height = 0.0, refraction = None, flat = false, crs = None))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords of Python")]
    fn line_of_sight(
        &self,
        py: Python<'_>,
        observer: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
        observer_height: f64,
        target_height: f64,
        refraction: Option<f64>,
        flat: bool,
        crs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyLineOfSight> {
        let above_m = [observer_height, target_height];
        let query = self.sight_query([observer, target], above_m, curvature(refraction, flat)?, crs)?;
        let report = py.detach(|| self.elevation.line_of_sight(query)).map_err(failed)?;
        Ok(PyLineOfSight::new(&report))
    }

    /// What a chart of the line of sight shows, for `sandtable.plot`; the arguments are those of `line_of_sight`. All heights are
    /// less the drop of the curved Earth.
    #[pyo3(signature = (observer, target, *, observer_height = 2.0, target_height = 0.0, refraction = None, flat = false, crs = None))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords of Python")]
    fn _sight_chart<'py>(
        &self,
        py: Python<'py>,
        observer: &Bound<'py, PyAny>,
        target: &Bound<'py, PyAny>,
        observer_height: f64,
        target_height: f64,
        refraction: Option<f64>,
        flat: bool,
        crs: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let above_m = [observer_height, target_height];
        let query = self.sight_query([observer, target], above_m, curvature(refraction, flat)?, crs)?;
        let chart = py.detach(|| self.elevation.sight_chart(query, String::new())).map_err(failed)?;
        sight_chart(py, &chart)
    }

    /// What is seen from `observer`, (x, y) in `crs` or a text as in `heights`: a Raster of 1 in sight, 0 hidden, 255 not looked at or without data.
    ///
    /// `range` is in meters, without limit by default; `sector` is two azimuths in degrees clockwise from north; the others are
    /// those of `line_of_sight`. The raster lies on the ground in meters: in the UTM zone of a model in degrees.
    #[pyo3(signature = (observer, *, observer_height = 2.0, target_height = 0.0, range = None, sector = None, refraction = None, flat = false, crs = None))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords of Python")]
    fn viewshed(
        &self,
        py: Python<'_>,
        observer: &Bound<'_, PyAny>,
        observer_height: f64,
        target_height: f64,
        range: Option<f64>,
        sector: Option<(f64, f64)>,
        refraction: Option<f64>,
        flat: bool,
        crs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyRaster> {
        let crs = crs_or(crs, || self.elevation.crs())?;
        let observer = end("observer", observer, observer_height, &crs)?;
        let range_m = range.unwrap_or(f64::INFINITY);
        if range_m.is_nan() || range_m <= 0.0 {
            return Err(wrong_value(format!("range is {range_m} m; give meters above 0")));
        }
        let sector = match sector {
            Some((from, to)) if !(from.is_finite() && to.is_finite()) => {
                return Err(wrong_value(format!("sector is ({from}, {to}); give two azimuths in degrees")));
            }
            Some((from, to)) => Sector::between(from, to),
            None => Sector::ALL,
        };
        let target_above_m = height("target", target_height)?;
        let curvature = curvature(refraction, flat)?;
        let options = ViewshedOptions { observer, target_above_m, range_m, sector, curvature };
        let seen = py.detach(|| self.elevation.viewshed(&crs, &options)).map_err(failed)?;
        PyRaster::new(py, &seen)
    }

    /// Analyzes the ground, as `sandtable analyze`: `kind` and the keywords are those of `sandtable.kinds()`.
    ///
    /// Positions are (x, y) in `crs`, by default the file's, texts that state places, lists or arrays of them, or shapes of
    /// shapely. `extent` is (x0, y0, x1, y1), two opposite corners or a ring. A kind that gives a raster alone makes an
    /// `xarray.DataArray`, which needs xarray; every other an `Analysis`. Roads, water,
    /// woods and buildings are not known, and a note says so. Raises SandtableError.
    ///
    /// `progress` is called with the share that is done, 0 to 1, some times a second; an exception of it ends the analysis. With
    /// `progress=True` the share is printed on standard error. By default a notebook shows it under the cell while work takes longer
    /// than a second; `progress=False` shows nothing.
    #[pyo3(signature = (kind, *, crs = None, progress = None, **arguments))]
    fn analyze<'py>(
        &self,
        py: Python<'py>,
        kind: &str,
        crs: Option<&Bound<'py, PyAny>>,
        progress: Option<&Bound<'py, PyAny>>,
        arguments: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let crs = crs_or(crs, || self.elevation.crs())?;
        let analyze = |texts: &[(&str, &str)], crs: &Crs, stop: &StopFlag| {
            self.elevation.analyze_until(kind, texts, crs, stop)
        };
        analyzed(py, (arguments, progress), crs, analyze)
    }

    /// The mesh of the ground with few triangles that is nowhere off by more than `max_error` meters, verified at every post.
    fn mesh(&self, py: Python<'_>, max_error: f64) -> PyResult<PyMesh> {
        if max_error.is_nan() || max_error < 0.0 {
            return Err(wrong_value(format!("max_error is {max_error} m; give meters from 0 on")));
        }
        let made = py.detach(|| {
            let terrain = self.elevation.terrain()?;
            let mesh = terrain.mesh_within(max_error)?;
            Ok((terrain, mesh))
        });
        let (terrain, mesh) = made.map_err(failed)?;
        PyMesh::new(py, &terrain, &mesh)
    }

    /// How directly the ground faces the sun: a Raster of 1, facing away, to 255, facing it, and 0 without data.
    ///
    /// `azimuth` is in degrees clockwise from north, `altitude` in degrees above the horizon, 0 to 90. Equal to
    /// `gdaldem hillshade` within one gray level.
    #[pyo3(signature = (azimuth = 315.0, altitude = 45.0))]
    fn hillshade(&self, py: Python<'_>, azimuth: f64, altitude: f64) -> PyResult<PyRaster> {
        if !azimuth.is_finite() || !(0.0..=90.0).contains(&altitude) {
            return Err(wrong_value(format!(
                "azimuth is {azimuth} and altitude {altitude}; give degrees, the altitude from 0 to 90"
            )));
        }
        let options = HillshadeOptions { azimuth_deg: azimuth, altitude_deg: altitude };
        let shaded = py.detach(|| Ok(self.elevation.terrain()?.hillshade(&options))).map_err(failed)?;
        PyRaster::new(py, &shaded)
    }

    fn __repr__(&self) -> String {
        let (rows, columns) = self.shape();
        format!("<Dem {rows} x {columns}, crs {}>", self.crs().as_deref().unwrap_or("None"))
    }

    /// A file is named, so that another process opens it; an array is copied.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        let pickled = match &this.file {
            Some(DemSource { path, stated, allow_remote }) => {
                let opener = py.import("sandtable._sandtable")?.getattr("_open_dem")?;
                // As text: a path of Python has no // of an address.
                (opener, (path.as_os_str(), stated.clone(), allow_remote.clone())).into_pyobject(py)?
            }
            None => {
                let maker = slf.get_type().getattr("from_array")?;
                let transform = this.transform();
                (maker, (this.to_numpy(py)?, transform, this.crs())).into_pyobject(py)?
            }
        };
        Ok(pickled.into_any())
    }
}

/// The columns and the samples of an array of shape (rows, columns); 32-bit floats where they hold all of its values.
fn samples(array: &Bound<'_, PyAny>, nodata: Option<f64>) -> PyResult<(u32, Samples)> {
    let (py, numpy) = (array.py(), array.py().import("numpy")?);
    if array.is_instance(&numpy.getattr("ma")?.getattr("MaskedArray")?)? {
        let floats = array.call_method1("astype", ("f8",))?;
        return samples(&floats.call_method1("filled", (f64::NAN,))?, nodata);
    }
    let columns = |shape: &[usize]| u32::try_from(shape[1]).map_err(wrong_value);
    if let Ok(array) = array.extract::<PyReadonlyArray2<'_, f32>>() {
        let missing = nodata.map(|nodata| nodata as f32);
        let value = |&value: &f32| if Some(value) == missing { f32::NAN } else { value };
        return Ok((columns(array.shape())?, Samples::F32(array.as_array().iter().map(value).collect())));
    }
    if let Ok(array) = array.extract::<PyReadonlyArray2<'_, f64>>() {
        let value = |&value: &f64| if Some(value) == nodata { f64::NAN } else { value };
        return Ok((columns(array.shape())?, Samples::F64(array.as_array().iter().map(value).collect())));
    }
    let array = numpy.call_method1("asarray", (array,))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let dimensions: usize = array.getattr("ndim")?.extract()?;
    if dimensions != 2 || !"iufb".contains(&kind) {
        let shape = array.getattr("shape")?;
        return Err(PyTypeError::new_err(format!(
            "the array has shape {shape} and type {}; give numbers of shape (rows, columns)",
            array.getattr("dtype")?
        )));
    }
    let fits = numpy.call_method1("can_cast", (array.getattr("dtype")?, "f4"))?.is_truthy()?;
    let like = [("order", "C")].into_py_dict(py)?;
    samples(&array.call_method("astype", (if fits { "f4" } else { "f8" },), Some(&like))?, nodata)
}

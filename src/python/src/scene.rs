//! Scenes and their pictures.

use std::path::PathBuf;
use std::sync::OnceLock;

use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use sandtable::{Crs, Finding, Scene, SceneOptions, StepWatch, StopFlag, View};

use crate::analysis::analyzed;
use crate::arguments::crs_or;
use crate::error::{failed, wrong_value};
use crate::findings::PyFinding;
use crate::progress::watched;
use crate::scene_data::scene_data;

/// Pixels on a side of a picture, least and most.
const SIDES: std::ops::RangeInclusive<u32> = 16..=16384;

/// What messages call the text of a scene that is in no file.
const TEXT_NAME: &str = "<scene>";

/// A scene that is built: the ground, the features on it, and its cameras.
#[pyclass(name = "_BuiltScene", module = "sandtable", frozen)]
pub struct PyScene {
    scene: Scene,
    findings: OnceLock<Vec<Finding>>,
}

#[pymethods]
impl PyScene {
    /// Opens a scene file and the files that it names under the parent of its folder, or under the folders `allow`.
    ///
    /// Elevation that has an address is read from the hosts `allow_remote`, each HOST or HOST:PORT, which are allowed in this
    /// process from then on. Raises SandtableError with file, line and column where the scene is wrong; `findings` of the
    /// exception are all errors.
    #[staticmethod]
    #[pyo3(signature = (path, *, allow = Vec::new(), allow_remote = Vec::new(), progress = None), text_signature = "(path, *, allow=(), allow_remote=(), progress=None)")]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        allow: Vec<PathBuf>,
        allow_remote: Vec<String>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        crate::remote::allow(&allow_remote)?;
        let open = |watch: &StepWatch| {
            let progress = |step| watch.begin(step);
            Scene::open_with(&path, &SceneOptions { allowed: &allow, progress: &progress })
        };
        let scene = watched(py, progress, open)?.map_err(failed)?;
        Ok(Self { scene, findings: OnceLock::new() })
    }

    /// Builds the scene of a text that is in no file: names are relative to the current folder. `given` are pairs of a name in the
    /// text and features, a Dem of an array or bytes; all else is as in `open`.
    #[staticmethod]
    #[pyo3(signature = (text, given, *, allow = Vec::new(), allow_remote = Vec::new(), progress = None), text_signature = "(text, given, *, allow=(), allow_remote=(), progress=None)")]
    fn build(
        py: Python<'_>,
        text: &str,
        given: Vec<(String, Bound<'_, PyAny>)>,
        allow: Vec<PathBuf>,
        allow_remote: Vec<String>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        crate::remote::allow(&allow_remote)?;
        let data = scene_data(&given)?;
        let build = |watch: &StepWatch| {
            let progress = |step| watch.begin(step);
            let options = SceneOptions { allowed: &allow, progress: &progress };
            Scene::from_text(TEXT_NAME, text, &data, &options)
        };
        let scene = watched(py, progress, build)?.map_err(failed)?;
        Ok(Self { scene, findings: OnceLock::new() })
    }

    /// The names of the cameras, the first one that of the default.
    #[getter]
    fn cameras<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.scene.view_names().collect::<Vec<_>>())
    }

    /// What was done that a user should know, each in a sentence.
    #[getter]
    fn notes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.scene.notes())
    }

    /// What was found while it was built: fewer findings than `findings` has.
    #[getter]
    fn built_findings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.scene.findings().iter().map(PyFinding::new).collect::<Vec<_>>())
    }

    /// What is wrong with the scene or looks wrong, as `sandtable check` finds it: the file is read and checked when this is
    /// first asked for.
    #[getter]
    fn findings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        if self.findings.get().is_none() {
            let found = py.detach(|| self.scene.check()).map_err(failed)?;
            // Another thread that was first found the same.
            let _ = self.findings.set(found);
        }
        let found = self.findings.get().map_or(&[][..], Vec::as_slice);
        PyTuple::new(py, found.iter().map(PyFinding::new).collect::<Vec<_>>())
    }

    /// Renders the view of a camera, with its annotations: uint8 of shape (H, W, 3), red, green and blue.
    ///
    /// `camera` is one of `cameras`, the first by default; `size` is (width, height), 16 to 16384 pixels each, by default that
    /// of the camera's paper or (1920, 1080), or as many in the shape of what a map shows. The pixels are those of `sandtable render`.
    /// `progress` is that of `analyze`.
    #[pyo3(signature = (camera = None, size = None, *, progress = None))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        camera: Option<&str>,
        size: Option<(u32, u32)>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let view = self.view(camera, size)?;
        let rendered = watched(py, progress, |watch| {
            let picture = self.scene.render_watched(&view, watch)?;
            let rgb: Vec<u8> =
                picture.rgba().as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
            Ok((rgb, picture.size()))
        });
        let (rgb, (width, height)) = rendered?.map_err(failed)?;
        PyArray1::from_vec(py, rgb).reshape([height as usize, width as usize, 3])
    }

    /// The picture of `render` as the bytes of a PNG file.
    ///
    /// `longest` is the most pixels of a side; a larger picture is drawn as much smaller.
    #[pyo3(signature = (camera = None, size = None, *, longest = None, progress = None))]
    fn png<'py>(
        &self,
        py: Python<'py>,
        camera: Option<&str>,
        size: Option<(u32, u32)>,
        longest: Option<u32>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let view = within(self.view(camera, size)?, longest);
        let draw = |watch: &StepWatch| Ok(self.scene.render_watched(&view, watch)?.png());
        let png = watched(py, progress, draw)?.map_err(failed)?;
        Ok(PyBytes::new(py, &png))
    }

    /// Writes a file in the format of its extension: a picture as `.png`, `.pdf` or `.svg`, a model as `.glb` or `.obj`, a page as
    /// `.html`. `camera` and `size` are those of a picture, as in `render`.
    #[pyo3(signature = (path, camera = None, size = None, *, progress = None))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        camera: Option<&str>,
        size: Option<(u32, u32)>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let view = self.view(camera, size)?;
        watched(py, progress, |watch| self.scene.save_watched(&view, &path, watch))?.map_err(failed)
    }

    /// The page for browsers, as the bytes of an HTML file that needs no network.
    #[pyo3(signature = (*, progress = None))]
    fn page<'py>(
        &self,
        py: Python<'py>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let page = watched(py, progress, |watch| self.scene.page_watched(watch))?.map_err(failed)?;
        Ok(PyBytes::new(py, &page))
    }

    /// Analyzes the ground, as `sandtable analyze`: `kind` and the keywords are those of `sandtable.kinds()`.
    ///
    /// Positions are (x, y) in `crs`, by default the scene's, texts that state places, lists or arrays of them, or shapes of
    /// shapely. `extent` is (x0, y0, x1, y1), two opposite corners or a ring. A kind that gives a raster alone makes an
    /// `xarray.DataArray`, which needs xarray; every other an `Analysis`. The ground has its
    /// earthworks, and roads, water, woods and buildings are known. Raises SandtableError.
    ///
    /// `progress` is called with the share that is done, 0 to 1, some times a second; an exception of it ends the analysis. With
    /// `progress=True` the share is printed on standard error, with `False` nothing is, and by default a notebook shows it.
    #[pyo3(signature = (kind, *, crs = None, progress = None, **arguments))]
    fn analyze<'py>(
        &self,
        py: Python<'py>,
        kind: &str,
        crs: Option<&Bound<'py, PyAny>>,
        progress: Option<&Bound<'py, PyAny>>,
        arguments: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let crs = crs_or(crs, || self.scene.crs())?;
        let analyze = |texts: &[(&str, &str)], crs: &Crs, stop: &StopFlag| {
            self.scene.analyze_until(kind, texts, crs, stop)
        };
        analyzed(py, (arguments, progress), crs, analyze)
    }
}

impl PyScene {
    /// The view of a camera, the first by default, of a size.
    fn view(&self, camera: Option<&str>, size: Option<(u32, u32)>) -> PyResult<View> {
        let first = || self.scene.view_names().next().unwrap_or_default();
        let view = self.scene.view(camera.unwrap_or_else(first)).map_err(failed)?;
        let Some((width, height)) = size else { return Ok(view) };
        if !SIDES.contains(&width) || !SIDES.contains(&height) {
            return Err(wrong_value(format!(
                "size is ({width}, {height}); give (width, height) of 16 to 16384 pixels each"
            )));
        }
        Ok(view.with_size(width, height))
    }
}

/// The view with sides of at most `longest` pixels.
fn within(view: View, longest: Option<u32>) -> View {
    let (width, height) = view.size();
    match longest {
        Some(most) if most < width.max(height) => {
            let scaled = |side: u32| {
                let side = u64::from(side) * u64::from(most) / u64::from(width.max(height));
                u32::try_from(side).unwrap_or(most).clamp(*SIDES.start(), *SIDES.end())
            };
            view.with_size(scaled(width), scaled(height))
        }
        _ => view,
    }
}

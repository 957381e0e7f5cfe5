//! Answers about lines: profiles and lines of sight.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sandtable::{Blocker, GroundProfile, Rise, SightChart, SightReport};

use crate::rasters::shaped;

/// The ground along a line.
#[pyclass(name = "Profile", module = "sandtable", frozen, get_all)]
pub struct PyProfile {
    /// float64 of shape (N,): meters from the start.
    stations: Py<PyArray1<f64>>,
    /// float64 of shape (N, 2): positions of the stations in the line's coordinate system.
    xy: Py<PyArray2<f64>>,
    /// float64 of shape (N,): meters, NaN where there is no ground.
    heights: Py<PyArray1<f64>>,
    /// The length of the line in plan, meters.
    length: f64,
    /// The length of its parts with ground, meters in plan.
    covered: f64,
    /// The length over the ground, up and down, meters.
    ground_length: f64,
    /// The sum of all climbs, meters.
    ascent: f64,
    /// The sum of all descents, meters; not negative.
    descent: f64,
}

impl PyProfile {
    /// The library's profile.
    pub fn new(py: Python<'_>, profile: &GroundProfile) -> PyResult<Self> {
        let stations = profile.stations.iter().map(|station| station.station_m).collect();
        let heights = profile.stations.iter().map(|station| station.ground.parts().0).collect();
        let positions: Vec<f64> = profile.positions.iter().flat_map(|at| at.to_array()).collect();
        let summary = &profile.summary;
        Ok(Self {
            stations: PyArray1::from_vec(py, stations).unbind(),
            xy: shaped(py, positions, (2, profile.positions.len() as u32))?,
            heights: PyArray1::from_vec(py, heights).unbind(),
            length: summary.length_m,
            covered: summary.covered_m,
            ground_length: summary.ground_length_m,
            ascent: summary.ascent_m,
            descent: summary.descent_m,
        })
    }
}

#[pymethods]
impl PyProfile {
    fn __repr__(&self) -> String {
        format!("<Profile {:.1} m long, up {:.1} m, down {:.1} m>", self.length, self.ascent, self.descent)
    }
}

/// A line of sight. True where the target is visible.
#[pyclass(name = "LineOfSight", module = "sandtable", frozen, get_all)]
pub struct PyLineOfSight {
    /// Whether the observer sees the target.
    visible: bool,
    /// The distance in plan, meters.
    distance: f64,
    /// The elevations of the eye and of the target, meters.
    heights: (f64, f64),
    /// x, y, distance from the observer and elevation of the first place that blocks the line, or None.
    blocker: Option<(f64, f64, f64, f64)>,
    /// How far the line runs above the ground at least, meters; negative where it is blocked. None where no ground lies
    /// between the ends.
    clearance: Option<f64>,
    /// How far the target must rise to be seen, meters; negative where it may sink.
    target_rise: Option<f64>,
    /// How far the observer must rise to see the target, meters; negative where it may sink.
    observer_rise: Option<f64>,
}

impl PyLineOfSight {
    /// The library's report.
    pub fn new(report: &SightReport) -> Self {
        let rise_m = |rise: Option<Rise>| rise.map(|rise| rise.rise_m);
        let place = |Blocker { at, distance_m, height_m }: Blocker| (at.x, at.y, distance_m, height_m);
        Self {
            visible: report.blocker.is_none(),
            distance: report.distance_m,
            heights: report.ends.map(|end| end.height_m()).into(),
            blocker: report.blocker.map(place),
            clearance: rise_m(report.both_rise).map(|rise_m| -rise_m),
            target_rise: rise_m(report.target_rise),
            observer_rise: rise_m(report.observer_rise),
        }
    }
}

#[pymethods]
impl PyLineOfSight {
    fn __bool__(&self) -> bool {
        self.visible
    }

    fn __repr__(&self) -> String {
        let seen = if self.visible { "visible" } else { "blocked" };
        format!("<LineOfSight {seen}, {:.1} m>", self.distance)
    }
}

/// What a chart of a line of sight shows: `stations` and `ground`, float64 of shape (N,), meters; `visible`, float64 of shape
/// (K, 2), the stretches in sight; the heights `eye` and `target`; `blocker`, its station and height, or None; `title`.
pub fn sight_chart<'py>(py: Python<'py>, chart: &SightChart) -> PyResult<Bound<'py, PyDict>> {
    let stations = chart.points.iter().map(|point| point.along_m).collect();
    let ground = chart.points.iter().map(|point| point.ground.parts().0).collect();
    let visible = chart.visible_m.iter().flat_map(|&(from_m, to_m)| [from_m, to_m]).collect();
    let blocker = chart.blocker.as_ref().map(|blocker| (blocker.along_m, blocker.height_m));
    let said = PyDict::new(py);
    said.set_item("stations", PyArray1::<f64>::from_vec(py, stations))?;
    said.set_item("ground", PyArray1::<f64>::from_vec(py, ground))?;
    said.set_item("visible", shaped::<f64>(py, visible, (2, chart.visible_m.len() as u32))?)?;
    said.set_item("eye", chart.eye_m)?;
    said.set_item("target", chart.target_m)?;
    said.set_item("blocker", blocker)?;
    said.set_item("title", &chart.text.subtitle)?;
    said.set_item("axis", &chart.text.height_axis)?;
    Ok(said)
}

//! What the questions about the ground have in common: the dataset, the coordinates, heights above the ground, and
//! how the Earth bends a line of sight.

use std::sync::Arc;

use glam::DVec2;

use crate::app::serve::params::Params;
use crate::app::serve::places::Coordinates;
use crate::app::serve::question::Service;
use crate::app::serve::reply::HttpError;
use crate::terrain::query::service::Snapshot;
use crate::terrain::sight::Curvature;

/// Heights above the ground reach from the ground to where aircraft fly.
const HIGHEST_M: f64 = 100_000.0;

/// The dataset that a question is asked of, and the coordinates that it is asked in.
pub struct Grounded {
    /// The dataset's index.
    pub dataset: usize,
    /// Coordinates of the request and of its answer.
    pub coordinates: Coordinates,
}

impl Grounded {
    /// What `dataset` and `crs` say.
    ///
    /// # Errors
    /// There is no such dataset or system, or no way between the two.
    pub fn read(service: &Service, params: &Params<'_>) -> Result<Self, HttpError> {
        let dataset = service.datasets.asked(params)?;
        let native = service.datasets.at(dataset).data.crs();
        let coordinates = Coordinates::read(params, &native, &service.wgs84)?;
        Ok(Self { dataset, coordinates })
    }

    /// The ground now; waits for it where it is being made.
    ///
    /// # Errors
    /// The dataset has none.
    pub fn epoch(&self, service: &Service) -> Result<Arc<Snapshot>, HttpError> {
        service.datasets.at(self.dataset).epoch()
    }

    /// The place of the request at a place on the ground; not finite where there is none.
    pub fn back(&self, epoch: &Snapshot, at: DVec2) -> DVec2 {
        epoch.crs().transform(&self.coordinates.crs, at).unwrap_or(DVec2::NAN)
    }
}

/// Meters above the ground: the parameter `name`, or `default`.
///
/// # Errors
/// It is no number, or below the ground.
pub fn above_m(params: &Params<'_>, name: &str, default: f64) -> Result<f64, HttpError> {
    params.number(name, 0.0..=HIGHEST_M, default)
}

/// How high an observer's eyes are where nothing else is said, as GDAL's viewsheds have it.
pub const OBSERVER_M: f64 = 2.0;

/// What `earth` and `refraction` say; without them, [`Curvature::default`].
///
/// # Errors
/// `earth` is neither `round` nor `flat`, or the refraction is none that air has.
pub fn curvature(params: &Params<'_>) -> Result<Curvature, HttpError> {
    let round = Curvature::default();
    let refraction = params.number("refraction", -1.0..=1.0, round.refraction)?;
    let earth = params.choice("earth", &[("round", round), ("flat", Curvature::FLAT)])?;
    Ok(match earth {
        Some(Curvature::FLAT) => Curvature::FLAT,
        _ => Curvature { refraction, ..round },
    })
}

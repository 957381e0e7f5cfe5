//! The trait of all queries, and parameters that several queries have.

use axum::response::Response;
use glam::DVec2;

use crate::coordinates::{Coordinates, Location};
use crate::datasets::ServedDataset;
use crate::parameters::Parameters;
use crate::reply::HttpError;
use crate::service::Service;
use sandtable_query::ground::QueriedGround;
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::stop_flag::StopFlag;

/// The greatest height above the ground, in meters: above all aircraft.
const HIGHEST_M: f64 = 100_000.0;

/// The default height of an observer's eye, as in GDAL's viewsheds.
pub const OBSERVER_M: f64 = 2.0;

/// The thread that executes a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueryWeight {
    /// The thread that parsed it; it takes microseconds.
    Light,
    /// A blocking thread, in its turn; milliseconds.
    Heavy,
    /// A blocking thread and perhaps all others, in its turn among its like; seconds.
    Expensive,
    /// As an expensive one, while no other picture is drawn.
    Picture,
}

/// A query with an address of its own.
pub trait Query: Sized + Send + 'static {
    /// Parses the query. `name` is the last part of an address that ends with a list of datasets or a kind; else empty.
    fn read(service: &Service, name: &str, parameters: &Parameters) -> Result<Self, HttpError>;

    /// Heavy by default, since the ground may have to be made first.
    fn weight(&self, _: &Service) -> QueryWeight {
        QueryWeight::Heavy
    }

    /// The size of the answer in bytes, at most, of a query that is not light; 0 for short ones.
    fn most_bytes(&self, _: &Service) -> usize {
        0
    }

    /// Answers the query; long computations check `stop` and end early where it is set.
    fn answer(self, service: &Service, stop: &StopFlag) -> Result<Response, HttpError>;
}

/// The dataset of a query about its ground, and the coordinates of the request and its answer.
pub struct GroundQuery {
    /// The index of the dataset.
    dataset: usize,
    pub coordinates: Coordinates,
}

impl GroundQuery {
    /// Reads `dataset`, `crs` and `positions`; refuses parameters that are not `known`.
    pub fn read(service: &Service, parameters: &Parameters, known: &[&str]) -> Result<Self, HttpError> {
        parameters.allow_only(known)?;
        let dataset = service.datasets.find_one(parameters.get("dataset"))?;
        let native = service.datasets.at(dataset).dataset.crs();
        let coordinates = Coordinates::read(parameters, &native, &service.wgs84)?;
        Ok(Self { dataset, coordinates })
    }

    pub fn served<'s>(&self, service: &'s Service) -> &'s ServedDataset {
        service.datasets.at(self.dataset)
    }

    /// The reach of a query about positions of the request, and `around_m` meters around them.
    pub fn reach<'q>(&'q self, at: &'q [DVec2], around_m: f64) -> GroundReach<'q> {
        GroundReach { crs: &self.coordinates.crs, at, around_m }
    }

    /// A position of the request in the ground's system; `what` names it in messages.
    pub fn to_ground(&self, what: &str, at: DVec2, ground: &QueriedGround) -> Result<DVec2, HttpError> {
        let transformed = self.coordinates.crs.transform(&ground.crs, at);
        transformed.map_err(|error| HttpError::wrong(format!("{what}: {error}")))
    }

    /// A position on the ground as a location of the answer; not finite where the request's system has none.
    pub fn location(&self, ground: &QueriedGround, at: DVec2) -> Location {
        let at = ground.crs.transform(&self.coordinates.crs, at).unwrap_or(DVec2::NAN);
        self.coordinates.location(at)
    }
}

/// Meters above the ground: the parameter `name`, or `default`.
pub fn above_m(parameters: &Parameters, name: &str, default: f64) -> Result<f64, HttpError> {
    parameters.number(name, 0.0..=HIGHEST_M, default)
}

/// The curvature that `earth` and `refraction` state; by default, [`Curvature::default`].
pub fn curvature(parameters: &Parameters) -> Result<Curvature, HttpError> {
    let round = Curvature::default();
    let refraction = parameters.number("refraction", -1.0..=1.0, round.refraction)?;
    let round = Curvature { refraction, ..round };
    let earth = parameters.word("earth", [("round", round), ("flat", Curvature::FLAT)])?;
    Ok(earth.unwrap_or(round))
}

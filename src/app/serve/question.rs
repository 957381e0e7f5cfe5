//! What every question has in common: it is read from parameters, weighed, and answered.

use crate::app::serve::datasets::Datasets;
use crate::app::serve::limits::{ServeLimits, Turnstile};
use crate::app::serve::params::Params;
use crate::app::serve::reply::{HttpError, Reply};
use crate::geom::crs::Crs;

/// All that is asked, one for the whole program.
pub struct Service {
    /// The datasets.
    pub datasets: Datasets,
    /// What may be asked.
    pub limits: ServeLimits,
    /// WGS 84, which most requests speak in.
    pub wgs84: Crs,
    /// Requests that are being answered.
    pub requests: Turnstile,
    /// Viewsheds that are being looked for: each takes all cores and a byte a post.
    pub viewsheds: Turnstile,
    /// Whether each request is told on standard error.
    pub log: Log,
}

/// Whether requests are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Log {
    /// A line each.
    Requests,
    /// Nothing.
    Silent,
}

/// A request, as far as a question reads it.
pub struct QueryRequest<'a> {
    /// What the address names after `/v1/`; empty where the question has an address of its own.
    pub dataset: &'a str,
    /// Its parameters.
    pub params: Params<'a>,
}

/// On which thread a question is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// On the one that read it, within microseconds.
    Light,
    /// On one that may take its time.
    Heavy,
}

/// A question that an address stands for.
pub trait Question: Sized + Send + 'static {
    /// Reads it.
    ///
    /// # Errors
    /// A parameter is missing, wrong, or asks for more than may be asked.
    fn read(service: &Service, asked: &QueryRequest<'_>) -> Result<Self, HttpError>;

    /// On which thread it is to be answered.
    fn weight(&self, service: &Service) -> Weight;

    /// Answers it.
    ///
    /// # Errors
    /// What the datasets cannot answer.
    fn answer(self, service: &Service) -> Result<Reply, HttpError>;
}

//! The state of the service: what it serves, what it allows, and who is being answered.

use std::sync::Arc;

use tokio::sync::Semaphore;

use crate::answers::AnswerMemory;
use crate::clients::Clients;
use crate::datasets::Datasets;
use crate::ready::Readiness;
use sandtable_geom::crs::Crs;
use sandtable_geom::geoid::Geoid;
use sandtable_query::service::{PathPrefix, RequestLog, ServiceLimits};

/// The service, one for the whole program.
pub struct Service {
    pub datasets: Datasets,
    pub limits: ServiceLimits,
    /// WGS 84, the system of most requests.
    pub wgs84: Crs,
    /// The names by which clients may reach it, beside its addresses.
    pub hosts: Vec<String>,
    /// What paths begin with.
    pub prefix: PathPrefix,
    pub readiness: Readiness,
    pub clients: Arc<Clients>,
    pub answers: AnswerMemory,
    /// The geoid, with the nodes that requests have needed.
    pub geoid: Geoid,
    /// Permits for long bodies that are being received.
    pub long_bodies: Arc<Semaphore>,
    /// Permits for heavy queries that are worked on.
    pub heavy: Arc<Semaphore>,
    /// Permits for expensive queries that are worked on: each may take all cores and a byte a post.
    pub expensive: Arc<Semaphore>,
    /// The permit for a picture that is drawn: each takes a scene and its pixels.
    pub pictures: Arc<Semaphore>,
    pub log: RequestLog,
    /// Writes a line for the user.
    pub write_line: fn(&str),
}

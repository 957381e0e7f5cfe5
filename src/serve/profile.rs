//! `/v1/profile`: the ground along a line, at its vertices and wherever it bends.
//!
//! ```text
//! {"dataset":"a","length_m":3120.4,"results":[
//!  {"station_m":0.0,"elevation":1043.2,"location":{"lat":…,"lng":…},"status":"Ok"}, …],"status":"OK"}
//! ```
//!
//! Between two stations in a row the ground is straight. The line is straight between its vertices on the ground's map,
//! where its stations are measured too.

use axum::Json;
use axum::response::{IntoResponse, Response};
use glam::DVec2;
use serde::Serialize;

use crate::api;
use crate::coordinates::Location;
use crate::parameters::Parameters;
use crate::query::{GroundQuery, Query, QueryWeight};
use crate::reply::{HttpError, JsonArray, OK};
use crate::service::Service;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::profile::profile;
use sandtable_terrain::stop_flag::StopFlag;

/// The limit of a profile's stations, as a multiple of the limit of a request's points, since every edge of a triangle
/// adds a station.
const STATIONS_PER_POINT: usize = 10;

/// The approximate size of a station in JSON.
const STATION_BYTES: usize = 130;

pub struct ProfileQuery {
    ground: GroundQuery,
    /// The vertices, in the request's coordinates.
    vertices: Vec<DVec2>,
}

#[derive(Serialize)]
struct ProfileAnswer<'a, R> {
    dataset: &'a str,
    length_m: f64,
    results: R,
    status: &'static str,
}

#[derive(Serialize)]
struct ProfileResult {
    station_m: f64,
    elevation: Option<f64>,
    location: Location,
    status: &'static str,
}

impl Query for ProfileQuery {
    fn read(service: &Service, _: &str, parameters: &Parameters) -> Result<Self, HttpError> {
        let ground = GroundQuery::read(service, parameters, &api::PROFILE.names())?;
        let text = parameters.required("locations", "46.2,-122.19|46.21,-122.2")?;
        let vertices = ground.coordinates.positions(text, service.limits.max_points as usize)?;
        if vertices.len() < 2 {
            return Err(HttpError::wrong("a profile lies along a line, which needs two locations or more"));
        }
        Ok(Self { ground, vertices })
    }

    fn weight(&self, _: &Service) -> QueryWeight {
        QueryWeight::Expensive
    }

    fn most_bytes(&self, service: &Service) -> usize {
        let source = self.ground.served(service).dataset.header();
        // A warped ground has about as many posts; twice as many are enough for any.
        let on_leg = 4 * (source.width as usize + source.height as usize) + 4;
        let most = service.limits.max_points as usize * STATIONS_PER_POINT;
        let stations = (self.vertices.len() * on_leg).min(most);
        stations * STATION_BYTES + self.ground.coordinates.form_bytes(stations)
    }

    fn answer(self, service: &Service, stop: &StopFlag) -> Result<Response, HttpError> {
        let served = self.ground.served(service);
        // The line's length is known before the ground under it is read.
        let start = served.ground(&self.ground.reach(&self.vertices[..1], 0.0))?;
        let to_ground =
            |(&at, number): (&DVec2, usize)| self.ground.to_ground(&format!("location {number}"), at, &start);
        let line: Vec<DVec2> = self.vertices.iter().zip(1..).map(to_ground).collect::<Result<_, _>>()?;
        let most = service.limits.max_points as usize * STATIONS_PER_POINT;
        let expected = most_stations(&start.lattice, &line);
        if expected > most as f64 {
            return Err(HttpError::wrong(format!(
                "the line may have {expected:.0} stations, {most} are the most of one profile; ask for a part of it"
            )));
        }
        let ground = served.ground(&self.ground.reach(&self.vertices, 0.0))?;
        let stations = profile(&ground.lattice, &line);
        if stop.is_stopped() {
            return Err(HttpError::stopped());
        }
        let results = stations.iter().map(|station| ProfileResult {
            station_m: station.station_m,
            elevation: station.ground.height_m(),
            location: self.ground.location(&ground, station.at),
            status: station.ground.status(),
        });
        Ok(Json(ProfileAnswer {
            dataset: &served.name,
            length_m: stations.last().map_or(0.0, |last| last.station_m),
            results: JsonArray(results),
            status: OK,
        })
        .into_response())
    }
}

/// An upper bound of the stations of a profile along `line`: its vertices, and on every leg each column and row of
/// posts that it passes and one diagonal for each cell between them.
fn most_stations(lattice: &Lattice, line: &[DVec2]) -> f64 {
    let size = DVec2::new(f64::from(lattice.columns()), f64::from(lattice.rows()));
    let on_leg = |pair: &[DVec2]| {
        let passed = ((pair[1] - pair[0]) / lattice.cell()).abs().min(size);
        2.0 * (passed.x + passed.y) + 4.0
    };
    line.windows(2).map(on_leg).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_profile_has_more_stations_than_the_bound() {
        let heights = (0..441).map(|index| ((index * 7919) % 101) as f32).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::new(10.0, 20.0), 21, heights).expect("sound");
        let lines = [
            [DVec2::ZERO, DVec2::new(200.0, 400.0)],
            [DVec2::new(3.0, 7.0), DVec2::new(199.0, 11.0)],
            [DVec2::new(55.0, 399.0), DVec2::new(54.0, 1.0)],
            [DVec2::new(0.5, 0.5), DVec2::new(0.6, 0.6)],
        ];
        for line in lines {
            let stations = profile(&lattice, &line).len() as f64;
            assert!(stations <= most_stations(&lattice, &line), "{line:?}: {stations}");
        }
    }
}

//! `/v1/profile`: the ground along a line, at its vertices and at every place where it bends.
//!
//! ```text
//! {"dataset":"a","length_m":3120.4,"results":[
//!  {"station_m":0.0,"elevation":1043.2,"location":{"lat":…,"lng":…},"status":"Ok"}, …],"status":"OK"}
//! ```
//!
//! Between two stations in a row the ground is straight. The line is straight between its vertices on the ground's map,
//! where its stations are measured too.

use glam::DVec2;

use crate::app::serve::ground::Grounded;
use crate::app::serve::json;
use crate::app::serve::question::{QueryRequest, Question, Service, Weight};
use crate::app::serve::reply::{BodyFormat, HttpError, Reply};
use crate::terrain::lattice::Lattice;
use crate::terrain::profile::{ProfileStation, profile};
use crate::terrain::query::service::Snapshot;

/// The ground along a line.
pub struct ProfileQuestion {
    grounded: Grounded,
    /// The line's vertices, in the request's coordinates.
    vertices: Vec<DVec2>,
}

const KNOWN: [&str; 3] = ["dataset", "locations", "crs"];

/// Bytes of a station in JSON, about.
const STATION_BYTES: usize = 140;

impl Question for ProfileQuestion {
    fn read(service: &Service, asked: &QueryRequest<'_>) -> Result<Self, HttpError> {
        let params = &asked.params;
        params.only(&KNOWN)?;
        let grounded = Grounded::read(service, params)?;
        let text = params.required("locations", "46.2,-122.19|46.21,-122.2")?;
        let vertices = grounded.coordinates.places(text, service.limits.points())?;
        if vertices.len() < 2 {
            return Err(HttpError::wrong("a profile lies along a line, which needs two locations or more"));
        }
        Ok(Self { grounded, vertices })
    }

    fn weight(&self, _: &Service) -> Weight {
        Weight::Heavy
    }

    fn answer(self, service: &Service) -> Result<Reply, HttpError> {
        let epoch = self.grounded.epoch(service)?;
        let line: Vec<DVec2> = self
            .vertices
            .iter()
            .enumerate()
            .map(|(index, &at)| {
                self.grounded.coordinates.bring(&format!("location {}", index + 1), at, epoch.crs())
            })
            .collect::<Result<_, _>>()?;
        let (expected, most) = (stations_at_most(epoch.lattice(), &line), service.limits.stations());
        if expected > most as f64 {
            return Err(HttpError::wrong(format!(
                "the line may have {expected:.0} stations, {most} are the most of one profile; ask for a part of it"
            )));
        }
        let stations = profile(epoch.lattice(), &line);
        let mut body = Vec::with_capacity(128 + stations.len() * STATION_BYTES);
        self.write(service, &epoch, &stations, &mut body);
        Ok(Reply { form: BodyFormat::Json, body })
    }
}

impl ProfileQuestion {
    fn write(&self, service: &Service, epoch: &Snapshot, stations: &[ProfileStation], out: &mut Vec<u8>) {
        json::raw(out, "{\"dataset\":");
        out.extend_from_slice(&service.datasets.at(self.grounded.dataset).name_json);
        json::raw(out, ",\"length_m\":");
        json::number(out, stations.last().map_or(0.0, |last| last.station_m));
        json::raw(out, ",\"results\":[");
        for (index, station) in stations.iter().enumerate() {
            json::raw(out, if index == 0 { "{\"station_m\":" } else { ",{\"station_m\":" });
            json::number(out, station.station_m);
            json::raw(out, ",\"elevation\":");
            json::number(out, station.ground.height_m().unwrap_or(f64::NAN));
            json::raw(out, ",\"location\":");
            self.grounded.coordinates.write(out, self.grounded.back(epoch, station.at));
            json::raw(out, ",\"status\":\"");
            json::raw(out, station.ground.status());
            json::raw(out, "\"}");
        }
        json::raw(out, "],\"status\":\"OK\"}");
    }
}

/// No fewer stations than a profile along `line` has: its vertices, and on every leg each column and row of posts that
/// it passes and one diagonal for each cell between them.
fn stations_at_most(lattice: &Lattice, line: &[DVec2]) -> f64 {
    let size = DVec2::new(f64::from(lattice.columns()), f64::from(lattice.rows()));
    let of_leg = |pair: &[DVec2]| {
        let passed = ((pair[1] - pair[0]) / lattice.cell()).abs().min(size);
        2.0 * (passed.x + passed.y) + 4.0
    };
    line.windows(2).map(of_leg).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_profile_has_more_stations_than_was_said_before() {
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
            assert!(stations <= stations_at_most(&lattice, &line), "{line:?}: {stations}");
        }
    }
}

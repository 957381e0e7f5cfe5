//! `/v1/los`: whether one point can be seen from another, and what stands between.
//!
//! ```text
//! {"dataset":"a","sight":"Blocked","visible":false,"distance_m":4201.5,
//!  "blocker":{"location":{"lat":…,"lng":…},"distance_m":812.0,"elevation":1043.2},"status":"OK"}
//! ```
//!
//! `sight` is `Clear`, `Blocked`, or where an end has no ground under it what the ground answers there, `NoData` or
//! `Outside`; `visible` is then null. `distance_m` lies on the ground's map.

use crate::app::serve::ground::{self, Grounded};
use crate::app::serve::json;
use crate::app::serve::question::{QueryRequest, Question, Service, Weight};
use crate::app::serve::reply::{BodyFormat, HttpError, Reply};
use crate::terrain::query::service::Snapshot;
use crate::terrain::sight::Curvature;
use crate::terrain::sight::line::{Blocker, Sight, SightEnd, line_of_sight};

/// Whether one point can be seen from another.
pub struct Los {
    grounded: Grounded,
    /// Where both ends are, in the request's coordinates.
    ends: [SightEnd; 2],
    curvature: Curvature,
}

const KNOWN: [&str; 8] =
    ["dataset", "from", "to", "observer_height", "target_height", "refraction", "earth", "crs"];

impl Question for Los {
    fn read(service: &Service, asked: &QueryRequest<'_>) -> Result<Self, HttpError> {
        let params = &asked.params;
        params.only(&KNOWN)?;
        let grounded = Grounded::read(service, params)?;
        let end = |what: &str, height: &str, default: f64| {
            let text = params.required(what, "46.2,-122.19")?;
            let at = grounded.coordinates.place(what, text)?;
            Ok(SightEnd { at, above_m: ground::above_m(params, height, default)? })
        };
        let ends = [end("from", "observer_height", ground::OBSERVER_M)?, end("to", "target_height", 0.0)?];
        let curvature = ground::curvature(params)?;
        Ok(Self { grounded, ends, curvature })
    }

    fn weight(&self, _: &Service) -> Weight {
        // A line across thousands of posts takes a fraction of a millisecond; the ground may have to be awaited.
        Weight::Heavy
    }

    fn answer(self, service: &Service) -> Result<Reply, HttpError> {
        let epoch = self.grounded.epoch(service)?;
        let on_ground = |what: &str, end: SightEnd| {
            let at = self.grounded.coordinates.bring(what, end.at, epoch.crs())?;
            Ok(SightEnd { at, ..end })
        };
        let (observer, target) = (on_ground("from", self.ends[0])?, on_ground("to", self.ends[1])?);
        let sight = line_of_sight(epoch.lattice(), observer, target, self.curvature);
        let mut body = Vec::with_capacity(256);
        self.write(service, &epoch, (observer, target, sight), &mut body);
        Ok(Reply { form: BodyFormat::Json, body })
    }
}

impl Los {
    fn write(
        &self,
        service: &Service,
        epoch: &Snapshot,
        (observer, target, sight): (SightEnd, SightEnd, Sight),
        out: &mut Vec<u8>,
    ) {
        json::raw(out, "{\"dataset\":");
        out.extend_from_slice(&service.datasets.at(self.grounded.dataset).name_json);
        let (word, visible) = match sight {
            Sight::Clear => ("Clear", "true"),
            Sight::Blocked(_) => ("Blocked", "false"),
            Sight::NoGround(answer) => (answer.status(), "null"),
        };
        json::raw(out, ",\"sight\":\"");
        json::raw(out, word);
        json::raw(out, "\",\"visible\":");
        json::raw(out, visible);
        json::raw(out, ",\"distance_m\":");
        json::number(out, observer.at.distance(target.at));
        json::raw(out, ",\"blocker\":");
        match sight {
            Sight::Blocked(blocker) => self.write_blocker(epoch, blocker, out),
            Sight::Clear | Sight::NoGround(_) => json::raw(out, "null"),
        }
        json::raw(out, ",\"status\":\"OK\"}");
    }

    fn write_blocker(&self, epoch: &Snapshot, blocker: Blocker, out: &mut Vec<u8>) {
        json::raw(out, "{\"location\":");
        self.grounded.coordinates.write(out, self.grounded.back(epoch, blocker.at));
        json::raw(out, ",\"distance_m\":");
        json::number(out, blocker.distance_m);
        json::raw(out, ",\"elevation\":");
        json::number(out, blocker.height_m);
        json::raw(out, "}");
    }
}

//! `/v1/los`: whether one point can be seen from another, and the first obstacle between them.
//!
//! ```text
//! {"dataset":"a","sight":"Blocked","visible":false,"distance_m":4201.5,
//!  "blocker":{"location":{"lat":…,"lng":…},"distance_m":812.0,"elevation":1043.2},"status":"OK"}
//! ```
//!
//! `sight` is `Clear`, `Blocked`, or where an end has no ground under it, the status of the ground there: `NoData` or
//! `Outside`; `visible` is then null. `distance_m` is measured on the ground's map.

use axum::Json;
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::api;
use crate::coordinates::Location;
use crate::parameters::Parameters;
use crate::query::{GroundQuery, OBSERVER_M, Query, above_m, curvature};
use crate::reply::{HttpError, OK};
use crate::service::Service;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::{Sight, SightEnd, line_of_sight};
use sandtable_terrain::stop_flag::StopFlag;

pub struct LosQuery {
    ground: GroundQuery,
    /// The observer and the target, in the request's coordinates.
    ends: [SightEnd; 2],
    curvature: Curvature,
}

#[derive(Serialize)]
struct LosAnswer<'a> {
    dataset: &'a str,
    sight: &'static str,
    visible: Option<bool>,
    distance_m: f64,
    blocker: Option<LosBlocker>,
    status: &'static str,
}

#[derive(Serialize)]
struct LosBlocker {
    location: Location,
    distance_m: f64,
    elevation: f64,
}

impl Query for LosQuery {
    fn read(service: &Service, _: &str, parameters: &Parameters) -> Result<Self, HttpError> {
        let ground = GroundQuery::read(service, parameters, &api::LOS.names())?;
        let end = |name: &str, height: &str, default_m: f64| {
            let text = parameters.required(name, "46.2,-122.19")?;
            let at = ground.coordinates.position(name, text)?;
            Ok::<_, HttpError>(SightEnd { at, above_m: above_m(parameters, height, default_m)? })
        };
        let ends = [end("from", "observer_height", OBSERVER_M)?, end("to", "target_height", 0.0)?];
        Ok(Self { ends, curvature: curvature(parameters)?, ground })
    }

    fn answer(self, service: &Service, _: &StopFlag) -> Result<Response, HttpError> {
        let served = self.ground.served(service);
        let ground = served.ground(&self.ground.reach(&self.ends.map(|end| end.at), 0.0))?;
        let on_ground = |what: &str, end: SightEnd| {
            Ok::<_, HttpError>(SightEnd { at: self.ground.to_ground(what, end.at, &ground)?, ..end })
        };
        let (observer, target) = (on_ground("from", self.ends[0])?, on_ground("to", self.ends[1])?);
        let sight = line_of_sight(&ground.lattice, observer, target, self.curvature);
        let (word, visible, blocker) = match sight {
            Sight::Clear => ("Clear", Some(true), None),
            Sight::Blocked(blocker) => ("Blocked", Some(false), Some(blocker)),
            Sight::NoGround(answer) => (answer.status(), None, None),
        };
        Ok(Json(LosAnswer {
            dataset: &served.name,
            sight: word,
            visible,
            distance_m: observer.at.distance(target.at),
            blocker: blocker.map(|blocker| LosBlocker {
                location: self.ground.location(&ground, blocker.at),
                distance_m: blocker.distance_m,
                elevation: blocker.height_m,
            }),
            status: OK,
        })
        .into_response())
    }
}

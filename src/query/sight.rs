//! A line of sight between two positions: the first obstacle, the clearance, and a chart.

use glam::DVec2;

use crate::dataset::{QueryError, transform};
use crate::ground::QueriedGround;
use crate::positions::format_position;
use crate::profile::chart_points;
use sandtable_annotate::chart::ChartText;
use sandtable_annotate::chart_sight::{SightBlocker, SightChart};
use sandtable_annotate::nice;
use sandtable_geom::crs::Crs;
use sandtable_raster::answer::Answer;
use sandtable_terrain::profile::profile;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::{Blocker, Sight, SightEnd, line_of_sight};
use sandtable_terrain::sight::outlook::visible_stretches;
use sandtable_terrain::sight::rise::{Raised, Rise, required_rise};

/// The names of both ends in messages.
const END_NAMES: [&str; 2] = ["the observer at", "the target at"];

/// A line of sight to examine.
pub struct SightQuery {
    /// The observer and the target, in coordinates of `crs`.
    pub ends: [SightEnd; 2],
    /// The coordinate system of both positions.
    pub crs: Crs,
    /// The Earth's curvature and refraction.
    pub curvature: Curvature,
}

/// One end of an examined line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundedEnd {
    /// The position in the query's system.
    pub at: DVec2,
    /// The ground there, meters.
    pub ground_m: f64,
    /// Meters above the ground.
    pub above_m: f64,
}

/// An examined line of sight. Places are in the query's coordinate system.
pub struct SightReport {
    /// The query.
    pub query: SightQuery,
    /// The observer and the target.
    pub ends: [GroundedEnd; 2],
    /// The distance between the ends on the ground's map, meters.
    pub distance_m: f64,
    /// The first place that blocks the line.
    pub blocker: Option<Blocker>,
    /// How far the target must rise to be seen; negative where there is height to spare, `None` where no ground lies
    /// between.
    pub target_rise: Option<Rise>,
    /// How far the observer must rise.
    pub observer_rise: Option<Rise>,
    /// How far both must rise.
    pub both_rise: Option<Rise>,
}

impl GroundedEnd {
    /// The height of the end, meters.
    pub fn height_m(&self) -> f64 {
        self.ground_m + self.above_m
    }
}

impl SightReport {
    /// Examines a line of sight over `ground`, which reaches both ends.
    ///
    /// # Errors
    /// An end has no ground under it, or has no position in the ground's system.
    pub fn new(ground: &QueriedGround, query: SightQuery) -> Result<Self, QueryError> {
        let lattice = &ground.lattice;
        let [observer, target] = query.on_ground(ground)?;
        let no_ground = |index: usize, answer| QueryError::NoGround {
            what: END_NAMES[index].into(),
            at: query.ends[index].at,
            answer,
        };
        let ground_m =
            |index: usize, end: SightEnd| match ground_height(lattice, Interpolation::Planar, end.at) {
                Answer::Height(height_m) => Ok(height_m),
                missing => Err(no_ground(index, missing)),
            };
        let feet_m = [ground_m(0, observer)?, ground_m(1, target)?];
        let in_query = |place: Blocker| {
            let at = transform("the place at", &ground.crs, &query.crs, place.at)?;
            Ok(Blocker { at, ..place })
        };
        let blocker = match line_of_sight(lattice, observer, target, query.curvature) {
            Sight::Blocked(blocker) => Some(in_query(blocker)?),
            Sight::Clear => None,
            Sight::NoGround(answer) => return Err(no_ground(0, answer)),
        };
        let rise = |raised| {
            let rise = required_rise(lattice, observer, target, query.curvature, raised)
                .map_err(|answer| no_ground(0, answer))?;
            rise.map(|rise| Ok(Rise { grazing: in_query(rise.grazing)?, ..rise })).transpose()
        };
        let grounded = |index: usize, end: SightEnd| {
            let at = transform("the place at", &ground.crs, &query.crs, end.at)?;
            Ok(GroundedEnd { at, ground_m: feet_m[index], above_m: end.above_m })
        };
        Ok(Self {
            ends: [grounded(0, observer)?, grounded(1, target)?],
            distance_m: observer.at.distance(target.at),
            blocker,
            target_rise: rise(Raised::Target)?,
            observer_rise: rise(Raised::Observer)?,
            both_rise: rise(Raised::Both)?,
            query,
        })
    }

    /// The chart of the line of sight, heights less the drop of the curved Earth.
    ///
    /// # Errors
    /// As [`SightReport::new`].
    pub fn chart(&self, ground: &QueriedGround, title: String) -> Result<SightChart, QueryError> {
        let curvature = self.query.curvature;
        let [observer, target] = self.query.on_ground(ground)?;
        let drop_m = |along_m: f64| curvature.drop_per_square_m() * along_m * along_m;
        let stations = profile(&ground.lattice, &[observer.at, target.at]);
        let [eye_m, target_m] = self.ends.map(|end| end.height_m());
        let datum = ground.vertical_datum.as_ref().map_or(String::new(), |datum| format!(", {datum}"));
        let sunk = if curvature == Curvature::FLAT { "" } else { ", less the Earth’s curvature" };
        let [start, end] = self.query.ends.map(|end| format_position(&self.query.crs, end.at));
        Ok(SightChart {
            text: ChartText {
                title,
                subtitle: self.subtitle(),
                height_axis: format!("Height (m{datum}{sunk})"),
                along_axis: "Distance from the observer".into(),
                start: format!("Observer  {start}"),
                end: format!("{end}  Target"),
            },
            points: chart_points(&stations, |along_m, height_m| height_m - drop_m(along_m)),
            visible_m: visible_stretches(&stations, eye_m, curvature)
                .iter()
                .map(|seen| (seen.from_m, seen.to_m))
                .collect(),
            eye_m,
            target_m: target_m - drop_m(self.distance_m),
            blocker: self.blocker.map(|Blocker { distance_m, height_m, .. }| {
                let (distance, height) =
                    (nice::format_distance(distance_m), nice::format_number(height_m, 0));
                let label = format!("blocked at {distance}, {height} m high");
                SightBlocker { along_m: distance_m, height_m: height_m - drop_m(distance_m), label }
            }),
            observer_label: format!("{} m", nice::format_number(eye_m, 0)),
            target_label: format!("{} m", nice::format_number(target_m, 0)),
        })
    }

    fn subtitle(&self) -> String {
        let sight = match (&self.blocker, self.target_rise, self.both_rise) {
            (Some(_), Some(rise), _) => {
                format!("hidden; seen if {} m higher", nice::format_number(rise.rise_m, 1))
            }
            (None, _, Some(rise)) => {
                format!("visible, {} m clear of the ground", nice::format_number(-rise.rise_m, 1))
            }
            (Some(_), None, _) => "hidden".into(),
            (None, _, None) => "visible".into(),
        };
        let earth = match self.query.curvature {
            Curvature::FLAT => "flat Earth".to_owned(),
            curved => format!("refraction {}", nice::format_trimmed(curved.refraction, 3)),
        };
        let distance = nice::format_distance(self.distance_m);
        format!("Target {distance} away is {sight} · {earth} · light ground is in sight of the observer")
    }
}

impl SightQuery {
    /// Both ends in the ground's coordinate system.
    fn on_ground(&self, ground: &QueriedGround) -> Result<[SightEnd; 2], QueryError> {
        let end = |index: usize| {
            let end = self.ends[index];
            let at = transform(END_NAMES[index], &self.crs, &ground.crs, end.at)?;
            Ok(SightEnd { at, ..end })
        };
        Ok([end(0)?, end(1)?])
    }
}

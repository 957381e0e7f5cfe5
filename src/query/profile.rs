//! The profile of the ground along a line, and its chart.
//!
//! The vertices of the line are brought to the ground's coordinate system and joined by straight lines *there*: a line
//! given in degrees is not the one that is straight on a map in degrees. Positions of stations are returned in the
//! line's own system.

use glam::DVec2;

use crate::dataset::{QueryError, transform};
use crate::ground::QueriedGround;
use crate::positions::{InputLine, format_position};
use sandtable_annotate::chart::ChartText;
use sandtable_annotate::chart_ground::ChartPoint;
use sandtable_annotate::chart_profile::ProfileChart;
use sandtable_annotate::nice;
use sandtable_base::limits::PROFILE_STEPS;
use sandtable_geom::crs::Crs;
use sandtable_raster::answer::Answer;
use sandtable_terrain::profile::{ProfileStation, ProfileSummary, Sampling, sampled_profile};

/// Stretches without ground that are shorter than this, in meters, are not mentioned.
const LEAST_GAP_M: f64 = 0.5;

/// A line that gives no profile.
#[derive(Clone, Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ProfileError {
    #[error(transparent)]
    Query(#[from] QueryError),
    #[error("a step of {step_m} m: give meters above 0")]
    Step { step_m: f64 },
    #[error(
        "a step of {step_m} m: the line is {length_m:.0} m long, and at most {PROFILE_STEPS} steps are made; take longer ones, or {PROFILE_STEPS:#}"
    )]
    ShortStep { step_m: f64, length_m: f64 },
}

/// The ground along a line.
pub struct GroundProfile {
    /// The line as given.
    pub line: InputLine,
    /// The coordinate system in which it is straight between its vertices.
    pub ground_crs: Crs,
    /// Its stations.
    pub stations: Vec<ProfileStation>,
    /// The positions of the stations in the line's system.
    pub positions: Vec<DVec2>,
    /// Lengths, climbs and extremes.
    pub summary: ProfileSummary,
    vertical_datum: Option<String>,
    /// Stations of the vertices between the ends, meters.
    bends_m: Vec<f64>,
}

impl GroundProfile {
    /// The profile of `ground` along `line`, which it reaches.
    ///
    /// # Errors
    /// See [`ProfileError`].
    pub fn new(ground: &QueriedGround, line: InputLine, sampling: Sampling) -> Result<Self, ProfileError> {
        let to_ground = |&at: &DVec2| transform("the position", &line.crs, &ground.crs, at);
        let vertices: Vec<DVec2> = line.vertices.iter().map(to_ground).collect::<Result<_, _>>()?;
        let lengths_m = vertices.windows(2).map(|pair| pair[0].distance(pair[1]));
        let mut bends_m: Vec<f64> = lengths_m
            .scan(0.0, |station_m, length_m| {
                *station_m += length_m;
                Some(*station_m)
            })
            .collect();
        check_step(sampling.step_m, bends_m.pop().unwrap_or_default())?;
        let stations = sampled_profile(&ground.lattice, &vertices, sampling);
        let from_ground =
            |station: &ProfileStation| transform("the station at", &ground.crs, &line.crs, station.at);
        Ok(Self {
            positions: stations.iter().map(from_ground).collect::<Result<_, _>>()?,
            summary: ProfileSummary::from_stations(&stations),
            stations,
            ground_crs: ground.crs.clone(),
            line,
            vertical_datum: ground.vertical_datum.clone(),
            bends_m,
        })
    }

    /// The chart of the profile.
    pub fn chart(&self, title: String) -> ProfileChart {
        let end = |at: Option<&DVec2>| format_position(&self.line.crs, at.copied().unwrap_or_default());
        let ProfileSummary { length_m, covered_m, ascent_m, descent_m, .. } = self.summary;
        let mut subtitle = format!(
            "{} long, climbs {} m and falls {} m",
            nice::format_distance(length_m),
            nice::format_number(ascent_m, 0),
            nice::format_number(descent_m, 0)
        );
        if length_m - covered_m > LEAST_GAP_M {
            subtitle += &format!("; {} without ground", nice::format_distance(length_m - covered_m));
        }
        let datum = self.vertical_datum.as_deref();
        ProfileChart {
            text: ChartText {
                title,
                subtitle,
                height_axis: datum.map_or("Height (m)".into(), |datum| format!("Height (m, {datum})")),
                along_axis: "Distance along the line".into(),
                start: format!("A  {}", end(self.line.vertices.first())),
                end: format!("{}  B", end(self.line.vertices.last())),
            },
            points: chart_points(&self.stations, |_, height_m| height_m),
            bends_m: self.bends_m.clone(),
        }
    }
}

fn check_step(step_m: Option<f64>, length_m: f64) -> Result<(), ProfileError> {
    match step_m {
        Some(step_m) if !(step_m > 0.0 && step_m.is_finite()) => Err(ProfileError::Step { step_m }),
        Some(step_m) if length_m / step_m > PROFILE_STEPS.get() as f64 => {
            Err(ProfileError::ShortStep { step_m, length_m })
        }
        _ => Ok(()),
    }
}

/// Stations as points of a chart; `height_m` maps a station and its height to the height that is drawn.
pub fn chart_points(stations: &[ProfileStation], height_m: impl Fn(f64, f64) -> f64) -> Vec<ChartPoint> {
    let point = |station: &ProfileStation| ChartPoint {
        along_m: station.station_m,
        ground: match station.ground {
            Answer::Height(height) => Answer::Height(height_m(station.station_m, height)),
            missing => missing,
        },
    };
    stations.iter().map(point).collect()
}

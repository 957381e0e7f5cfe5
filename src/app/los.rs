//! `sandtable los`: whether one point can be seen from another, what stands between, and how much is missing.

use std::path::PathBuf;

use clap::Args;
use glam::DVec2;
use serde_json::{Value, json};

use crate::annotate::chart::ChartText;
use crate::annotate::chart_sight::{SightBlocker, SightChart, paint};
use crate::annotate::nice;
use crate::app::arguments::{Access, PictureSize, StatedHeights};
use crate::app::dataset::Dataset;
use crate::app::failure::CliError;
use crate::app::places::{Observer, check_picture_place, on_ground, spoken, stated_crs};
use crate::app::profile::{file_title, points};
use crate::app::{files, output, picture};
use crate::geom::crs::Crs;
use crate::terrain::lattice::Lattice;
use crate::terrain::profile::profile;
use crate::terrain::query::{Answer, Interpolation, ground_height};
use crate::terrain::sight::Curvature;
use crate::terrain::sight::line::{Blocker, Sight, SightEnd, line_of_sight};
use crate::terrain::sight::outlook::visible_stretches;
use crate::terrain::sight::rise::{Raised, Rise, required_rise};

/// `los`.
#[derive(Debug, Args)]
#[command(
    after_help = "The exit code is 0 whether the target is visible or not. Ground without data blocks nothing.\n\
                  The line is straight in the ground's coordinate system."
)]
pub struct LosOptions {
    /// The elevation file or scene
    pub file: PathBuf,
    /// Where the observer stands, and meters above the ground there
    #[arg(long, value_name = "X,Y[,H]", allow_hyphen_values = true)]
    pub from: Observer,
    /// Where the target stands, and meters above the ground there
    #[arg(long, value_name = "X,Y[,H]", allow_hyphen_values = true)]
    pub to: Observer,
    /// Meters of the observer's eye above the ground, where --from gives none
    #[arg(long, value_name = "METERS", default_value = "2", allow_negative_numbers = true, value_parser = meters)]
    pub observer_height: f64,
    /// Meters of the target above the ground, where --to gives none
    #[arg(long, value_name = "METERS", default_value = "0", allow_negative_numbers = true, value_parser = meters)]
    pub target_height: f64,
    /// The coordinate system of both positions, for example EPSG:4326 [default: the file's]
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
    /// The refraction coefficient: the share of the Earth's curvature that bent light makes up for [default: 1/7]
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = meters)]
    pub refraction: Option<f64>,
    /// As if the Earth were flat
    #[arg(long, conflicts_with = "refraction")]
    pub flat: bool,
    /// Where a chart goes
    #[arg(short, long, value_name = "OUT.png")]
    pub output: Option<PathBuf>,
    /// Size of the chart in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x800")]
    pub size: PictureSize,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// What gray values mean.
    #[command(flatten)]
    pub heights: StatedHeights,
    /// What may be read.
    #[command(flatten)]
    pub access: Access,
}

/// A finite number.
fn meters(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| "write a number".into())
}

/// Runs the command.
///
/// # Errors
/// The file cannot be had or read, has no place in meters, or an end has no ground under it.
pub fn run(options: &LosOptions) -> Result<(), CliError> {
    if let Some(path) = &options.output {
        check_picture_place(path, &options.file)?;
    }
    let dataset = Dataset::open(&options.file, options.heights, &options.access)?;
    let crs = stated_crs(options.crs.as_deref())?.unwrap_or_else(|| dataset.crs());
    let epoch = dataset.service()?.snapshot();
    let look = SightOutcome::new(options, &crs, (epoch.crs(), epoch.lattice()))?;
    if let Some(path) = &options.output {
        let datum = epoch.source().vertical_datum.as_deref();
        let pixels =
            paint((options.size.width, options.size.height), &look.chart(options, epoch.lattice(), datum));
        files::write_whole(path, &picture::png(&pixels)?)?;
    }
    if options.json {
        output::print(&format!("{}\n", look.describe()?))
    } else {
        output::print(&look.tell()?)
    }
}

/// What was asked and what came of it.
struct SightOutcome<'a> {
    crs: &'a Crs,
    ground: &'a Crs,
    ends: [SightEnd; 2],
    /// The ground under both ends, meters.
    feet_m: [f64; 2],
    curvature: Curvature,
    blocker: Option<Blocker>,
    target_rise: Option<Rise>,
    observer_rise: Option<Rise>,
    both_rise: Option<Rise>,
}

impl<'a> SightOutcome<'a> {
    fn new(
        options: &LosOptions,
        crs: &'a Crs,
        (ground, lattice): (&'a Crs, &Lattice),
    ) -> Result<Self, CliError> {
        let asked =
            [("--from", options.from, options.observer_height), ("--to", options.to, options.target_height)];
        let mut ends = [SightEnd { at: DVec2::ZERO, above_m: 0.0 }; 2];
        let mut feet_m = [0.0; 2];
        for (index, (name, stand, usual_m)) in asked.into_iter().enumerate() {
            let at = on_ground(name, crs, ground, stand.at)?;
            ends[index] = SightEnd { at, above_m: stand.above_m.unwrap_or(usual_m) };
            feet_m[index] = match ground_height(lattice, Interpolation::Planar, at) {
                Answer::Height(height_m) => height_m,
                missing => return Err(no_ground(name, stand.at, missing)),
            };
        }
        let curvature = match (options.flat, options.refraction) {
            (true, _) => Curvature::FLAT,
            (false, Some(refraction)) => Curvature { refraction, ..Curvature::default() },
            (false, None) => Curvature::default(),
        };
        let [observer, target] = ends;
        let blocker = match line_of_sight(lattice, observer, target, curvature) {
            Sight::Blocked(blocker) => Some(blocker),
            Sight::Clear => None,
            Sight::NoGround(missing) => return Err(no_ground("the line", observer.at, missing)),
        };
        let rise = |raised| {
            required_rise(lattice, observer, target, curvature, raised)
                .map_err(|missing| no_ground("the line", observer.at, missing))
        };
        Ok(Self {
            crs,
            ground,
            ends,
            feet_m,
            curvature,
            blocker,
            target_rise: rise(Raised::Target)?,
            observer_rise: rise(Raised::Observer)?,
            both_rise: rise(Raised::Both)?,
        })
    }

    fn length_m(&self) -> f64 {
        self.ends[0].at.distance(self.ends[1].at)
    }

    fn asked(&self, at: DVec2) -> Result<DVec2, CliError> {
        on_ground("the place at", self.ground, self.crs, at)
    }

    fn place(&self, place: &Blocker) -> Result<Value, CliError> {
        let at = self.asked(place.at)?;
        Ok(json!({"x": at.x, "y": at.y, "distance_m": place.distance_m, "height_m": place.height_m}))
    }

    fn end(&self, index: usize) -> Result<Value, CliError> {
        let at = self.asked(self.ends[index].at)?;
        let above_m = self.ends[index].above_m;
        let height_m = self.feet_m[index] + above_m;
        Ok(
            json!({"x": at.x, "y": at.y, "ground_m": self.feet_m[index], "above_m": above_m, "height_m": height_m}),
        )
    }

    fn describe(&self) -> Result<Value, CliError> {
        let place = |rise: Option<Rise>| rise.map(|rise| self.place(&rise.grazing)).transpose();
        let rise_m = |rise: Option<Rise>| rise.map(|rise| rise.rise_m);
        let is_flat = self.curvature == Curvature::FLAT;
        Ok(json!({
            "crs": self.crs.name(),
            "visible": self.blocker.is_none(),
            "distance_m": self.length_m(),
            "observer": self.end(0)?,
            "target": self.end(1)?,
            "blocker": self.blocker.as_ref().map(|blocker| self.place(blocker)).transpose()?,
            "clearance_m": rise_m(self.both_rise).map(|rise_m| -rise_m),
            "least_clearance_at": place(self.both_rise)?,
            "target_rise_m": rise_m(self.target_rise),
            "grazing": place(self.target_rise)?,
            "observer_rise_m": rise_m(self.observer_rise),
            "earth_radius_m": if is_flat { None } else { Some(self.curvature.radius_m) },
            "refraction": if is_flat { None } else { Some(self.curvature.refraction) },
        }))
    }

    fn tell(&self) -> Result<String, CliError> {
        let spoken_at = |at: DVec2| self.asked(at).map(|at| spoken(self.crs, at));
        let mut lines = Vec::new();
        match &self.blocker {
            None => lines.push("visible".to_owned()),
            Some(blocker) => lines.push(format!(
                "blocked at {}, {:.1} m from the observer, where the ground is {:.2} m high",
                spoken_at(blocker.at)?,
                blocker.distance_m,
                blocker.height_m
            )),
        }
        lines.push(format!("  distance   {:.1} m", self.length_m()));
        for (name, index) in [("observer", 0), ("target  ", 1)] {
            let (ground_m, above_m) = (self.feet_m[index], self.ends[index].above_m);
            lines.push(format!("  {name}   {:.2} m high, {above_m} m above the ground", ground_m + above_m));
        }
        if let Some(rise) = self.both_rise {
            let place = format!("{} ({:.1} m along)", spoken_at(rise.grazing.at)?, rise.grazing.distance_m);
            lines.push(format!("  clearance  {:.2} m, least at {place}", -rise.rise_m));
        }
        if self.blocker.is_some() {
            for (name, rise) in [("the target", self.target_rise), ("the observer", self.observer_rise)] {
                if let Some(rise) = rise {
                    lines.push(format!("  to be seen, {name} must rise {:.2} m", rise.rise_m));
                }
            }
        }
        lines.push(format!("  Earth      {}", self.earth()));
        Ok(output::text_of(&lines))
    }

    fn earth(&self) -> String {
        if self.curvature == Curvature::FLAT {
            return "flat".into();
        }
        let (radius_km, k) =
            (self.curvature.radius_m / 1000.0, nice::format_trimmed(self.curvature.refraction, 3));
        format!("curved, radius {} km, refraction {k}", nice::format_number(radius_km, 0))
    }

    fn chart(&self, options: &LosOptions, lattice: &Lattice, datum: Option<&str>) -> SightChart {
        let [observer, target] = self.ends;
        let drop_m = |along_m: f64| self.curvature.drop_per_square_m() * along_m * along_m;
        let stations = profile(lattice, &[observer.at, target.at]);
        let eye_m = self.feet_m[0] + observer.above_m;
        let seen = visible_stretches(&stations, eye_m, self.curvature);
        let length_m = self.length_m();
        let datum = datum.map_or(String::new(), |datum| format!(", {datum}"));
        let sunk = if self.curvature == Curvature::FLAT { "" } else { ", less the Earth’s curvature" };
        SightChart {
            text: ChartText {
                title: file_title("Line of sight", &options.file),
                subtitle: self.subtitle(length_m),
                height_axis: format!("Height (m{datum}{sunk})"),
                along_axis: "Distance from the observer".into(),
                start: format!("Observer  {}", spoken(self.crs, options.from.at)),
                end: format!("{}  Target", spoken(self.crs, options.to.at)),
            },
            points: points(&stations, |along_m, height_m| height_m - drop_m(along_m)),
            visible_m: seen.iter().map(|stretch| (stretch.from_m, stretch.to_m)).collect(),
            eye_m,
            target_m: self.feet_m[1] + target.above_m - drop_m(length_m),
            blocker: self.blocker.map(|blocker| SightBlocker {
                along_m: blocker.distance_m,
                height_m: blocker.height_m - drop_m(blocker.distance_m),
                label: format!(
                    "blocked at {}, {} m high",
                    nice::format_distance(blocker.distance_m),
                    nice::format_number(blocker.height_m, 0)
                ),
            }),
            observer_label: format!("{} m", nice::format_number(eye_m, 0)),
            target_label: format!("{} m", nice::format_number(self.feet_m[1] + target.above_m, 0)),
        }
    }

    fn subtitle(&self, length_m: f64) -> String {
        let far = nice::format_distance(length_m);
        let came = match (&self.blocker, self.target_rise, self.both_rise) {
            (Some(_), Some(rise), _) => {
                format!("hidden; seen if {} m higher", nice::format_number(rise.rise_m, 1))
            }
            (None, _, Some(rise)) => {
                format!("visible, {} m clear of the ground", nice::format_number(-rise.rise_m, 1))
            }
            (Some(_), None, _) => "hidden".into(),
            (None, _, None) => "visible".into(),
        };
        let earth = match self.curvature == Curvature::FLAT {
            true => "flat Earth".to_owned(),
            false => format!("refraction {}", nice::format_trimmed(self.curvature.refraction, 3)),
        };
        format!("Target {far} away is {came} · {earth} · light ground is in sight of the observer")
    }
}

fn no_ground(name: &str, at: DVec2, missing: Answer) -> CliError {
    let why = match missing {
        Answer::NoData => "the elevation model has no data there",
        _ => "this lies outside the elevation model",
    };
    CliError::input(format!("{name} {},{}: {why}", at.x, at.y))
}

//! `sandtable los`: whether one point can be seen from another, the first obstacle, and the clearance.

use clap::Args;
use glam::DVec2;
use serde_json::{Value, json};

use crate::error::CliError;
use crate::options::{ChartArguments, DatasetArguments};
use crate::output::{print, print_lines, row};
use crate::positions::{PositionPrinter, PositionsArguments, placed_one};
use crate::values::{RaisedPosition, number, raised_position};
use sandtable_annotate::chart_sight::paint;
use sandtable_annotate::nice;
use sandtable_base::message::numbers::fixed;
use sandtable_files::disk;
use sandtable_query::positions::format_position;
use sandtable_query::sight::{GroundedEnd, SightQuery, SightReport};
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::{Blocker, SightEnd};
use sandtable_terrain::sight::rise::Rise;

#[derive(Debug, Args)]
#[command(
    after_help = "The exit code is 0 whether the target is visible or not. Ground without data blocks nothing.\n\
                  The line is straight in the ground's coordinate system."
)]
pub struct LosArguments {
    #[command(flatten)]
    pub dataset: DatasetArguments,
    /// The position of the observer in any form, and meters above the ground there
    #[arg(long, value_name = "POSITION[,H]", allow_hyphen_values = true, value_parser = raised_position)]
    pub from: RaisedPosition,
    /// The position of the target in any form, and meters above the ground there
    #[arg(long, value_name = "POSITION[,H]", allow_hyphen_values = true, value_parser = raised_position)]
    pub to: RaisedPosition,
    /// Meters of the observer's eye above the ground, where --from states none
    #[arg(long, value_name = "METERS", default_value = "2", allow_negative_numbers = true, value_parser = number::<f64>(.., "write a number"))]
    pub observer_height: f64,
    /// Meters of the target above the ground, where --to states none
    #[arg(long, value_name = "METERS", default_value = "0", allow_negative_numbers = true, value_parser = number::<f64>(.., "write a number"))]
    pub target_height: f64,
    /// The refraction coefficient: the share of the Earth's curvature that bent light makes up for [default: 1/7]
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = number::<f64>(.., "write a number"))]
    pub refraction: Option<f64>,
    /// Assume a flat Earth
    #[arg(long, conflicts_with = "refraction")]
    pub flat: bool,
    #[command(flatten)]
    pub positions: PositionsArguments,
    #[command(flatten)]
    pub chart: ChartArguments,
}

pub fn run(arguments: &LosArguments) -> Result<(), CliError> {
    arguments.chart.check(&arguments.dataset.file)?;
    let dataset = arguments.dataset.open()?;
    let crs = arguments.dataset.crs(&dataset);
    let printer = arguments.positions.printer(&crs)?;
    let (from, to) = (&arguments.from, &arguments.to);
    let at = [placed_one("--from", &from.at, &crs)?, placed_one("--to", &to.at, &crs)?];
    let reach = GroundReach { crs: &crs, at: &at, around_m: 0.0 };
    let ground = arguments.dataset.ground(&dataset, &reach)?;
    let end = |at: DVec2, stated_m: Option<f64>, default_m: f64| SightEnd {
        at,
        above_m: stated_m.unwrap_or(default_m),
    };
    let query = SightQuery {
        ends: [
            end(at[0], from.above_m, arguments.observer_height),
            end(at[1], to.above_m, arguments.target_height),
        ],
        crs: crs.clone(),
        curvature: curvature(arguments.flat, arguments.refraction),
    };
    let report = SightReport::new(&ground, query)?;
    if let Some(path) = &arguments.chart.output {
        let size = arguments.chart.size;
        let chart = report.chart(&ground, arguments.dataset.chart_title("Line of sight"))?;
        disk::write_picture(path, &paint((size.width, size.height), &chart))?;
    }
    if arguments.dataset.json {
        print(&format!("{}\n", json(&report, printer)))
    } else {
        print_lines(&text(&report, printer))
    }
}

/// The curvature that `--flat` and `--refraction` state.
pub fn curvature(flat: bool, refraction: Option<f64>) -> Curvature {
    let round = Curvature::default();
    match flat {
        true => Curvature::FLAT,
        false => Curvature { refraction: refraction.unwrap_or(round.refraction), ..round },
    }
}

fn json(report: &SightReport, printer: PositionPrinter<'_>) -> Value {
    let with_position = |mut object: Value, at: DVec2| {
        printer.add_to(&mut object, at);
        object
    };
    let place = |Blocker { at, distance_m, height_m }: Blocker| {
        with_position(json!({"x": at.x, "y": at.y, "distance_m": distance_m, "height_m": height_m}), at)
    };
    let [observer, target] = report.ends.map(|end: GroundedEnd| {
        let GroundedEnd { at, ground_m, above_m } = end;
        let height_m = end.height_m();
        let object =
            json!({"x": at.x, "y": at.y, "ground_m": ground_m, "above_m": above_m, "height_m": height_m});
        with_position(object, at)
    });
    let grazing = |rise: Option<Rise>| rise.map(|rise| place(rise.grazing));
    let rise_m = |rise: Option<Rise>| rise.map(|rise| rise.rise_m);
    let curved = Some(report.query.curvature).filter(|curvature| *curvature != Curvature::FLAT);
    json!({
        "crs": report.query.crs.name(),
        "visible": report.blocker.is_none(),
        "distance_m": report.distance_m,
        "observer": observer,
        "target": target,
        "blocker": report.blocker.map(place),
        "clearance_m": rise_m(report.both_rise).map(|rise_m| -rise_m),
        "least_clearance_at": grazing(report.both_rise),
        "target_rise_m": rise_m(report.target_rise),
        "grazing": grazing(report.target_rise),
        "observer_rise_m": rise_m(report.observer_rise),
        "earth_radius_m": curved.map(|curvature| curvature.radius_m),
        "refraction": curved.map(|curvature| curvature.refraction),
    })
}

fn text(report: &SightReport, printer: PositionPrinter<'_>) -> Vec<String> {
    let position = |at: DVec2| printer.row(at, || format_position(&report.query.crs, at));
    let mut lines = vec![match &report.blocker {
        None => "visible".to_owned(),
        Some(Blocker { at, distance_m, height_m }) => format!(
            "blocked at {}, {distance_m:.1} m from the observer, where the ground is {} m high",
            position(*at),
            fixed(*height_m, 2)
        ),
    }];
    lines.push(row(10, "distance", format!("{:.1} m", report.distance_m)));
    for (name, end) in ["observer", "target"].iter().zip(report.ends) {
        let height = format!("{} m high, {} m above the ground", fixed(end.height_m(), 2), end.above_m);
        lines.push(row(10, name, height));
    }
    if let Some(Rise { rise_m, grazing }) = report.both_rise {
        let place = format!("{} ({:.1} m along)", position(grazing.at), grazing.distance_m);
        lines.push(row(10, "clearance", format!("{} m, least at {place}", fixed(-rise_m, 2))));
    }
    let rises = [("the target", report.target_rise), ("the observer", report.observer_rise)];
    for (name, rise) in rises.into_iter().filter(|_| report.blocker.is_some()) {
        lines.extend(rise.map(|rise| format!("  to be seen, {name} must rise {} m", fixed(rise.rise_m, 2))));
    }
    lines.push(row(10, "Earth", earth(report.query.curvature)));
    lines
}

fn earth(curvature: Curvature) -> String {
    if curvature == Curvature::FLAT {
        return "flat".into();
    }
    let radius_km = nice::format_number(curvature.radius_m / 1000.0, 0);
    format!("curved, radius {radius_km} km, refraction {}", nice::format_trimmed(curvature.refraction, 3))
}

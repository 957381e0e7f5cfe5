//! Positions in arguments, and in what commands print.

use std::collections::BTreeSet;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use glam::DVec2;
use serde_json::Value;

use crate::error::CliError;
use crate::output::warn;
use sandtable_geom::crs::Crs;
use sandtable_geom::position::notation::PositionForm;
use sandtable_geom::position::wgs84;
use sandtable_query::positions::{PositionArgument, WrittenPosition, shift_note};

/// How positions are printed.
#[derive(Clone, Copy, Debug, Args)]
pub struct PositionsArguments {
    /// Write positions on WGS 84 in this form, which is read back [default: x and y]
    #[arg(long = "positions", value_name = "FORM", value_parser = position_form())]
    form: Option<PositionForm>,
}

/// A system of positions, and the form in which they are printed.
#[derive(Clone, Copy, Debug)]
pub struct PositionPrinter<'a> {
    crs: &'a Crs,
    form: Option<PositionForm>,
}

fn position_form() -> impl TypedValueParser<Value = PositionForm> {
    let values = PositionForm::WORDS.map(|(_, word, meaning)| PossibleValue::new(word).help(meaning));
    PossibleValuesParser::new(values)
        .map(|word| PositionForm::from_word(&word).expect("only listed words are accepted"))
}

impl PositionsArguments {
    /// The printer of positions in `crs`.
    ///
    /// # Errors
    /// A form is stated, and `crs` has no place on Earth.
    pub fn printer<'a>(&self, crs: &'a Crs) -> Result<PositionPrinter<'a>, CliError> {
        if self.form.is_some() && *crs == Crs::local() {
            return Err(CliError::input(
                "--positions: the data state no coordinate system, so that only x and y are known",
            ));
        }
        Ok(PositionPrinter { crs, form: self.form })
    }
}

impl PositionPrinter<'_> {
    /// The position as text; `None` where no form is stated. A place beyond the Earth is empty.
    pub fn text(&self, at: DVec2) -> Option<String> {
        self.form.map(|form| form.write(self.crs, at).unwrap_or_default())
    }

    /// Adds the position to an object of JSON, where a form is stated.
    pub fn add_to(&self, object: &mut Value, at: DVec2) {
        if let Some(position) = self.text(at) {
            object["position"] = position.into();
        }
    }

    /// The names of the columns of a position.
    pub fn columns(&self) -> &'static str {
        if self.form.is_some() { "position" } else { "x,y" }
    }

    /// The columns of a position, of which x and y are written so where no form is stated.
    pub fn row(&self, at: DVec2, x_y: impl FnOnce() -> String) -> String {
        self.text(at).unwrap_or_else(x_y)
    }
}

/// The positions of the arguments of an option, in `crs`; prints which squares grid references name, and how good the shift
/// of the datum is.
///
/// # Errors
/// A position has no coordinates in `crs`.
pub fn placed(
    option: &str,
    arguments: &[PositionArgument],
    crs: &Crs,
) -> Result<Vec<WrittenPosition<'static>>, CliError> {
    let place = |argument: &PositionArgument| {
        argument.written(crs).map_err(|error| CliError::input(format!("{option} '{argument}': {error}")))
    };
    let positions: Vec<_> = arguments.iter().map(place).collect::<Result<_, _>>()?;
    note(&positions, crs);
    Ok(positions)
}

/// As [`placed`], of one argument.
pub fn placed_one(option: &str, argument: &PositionArgument, crs: &Crs) -> Result<DVec2, CliError> {
    Ok(placed(option, std::slice::from_ref(argument), crs)?[0].at)
}

/// Prints what is to be known of positions that were brought to `crs`.
pub fn note(positions: &[WrittenPosition<'_>], crs: &Crs) {
    // In micrometers, so that they have an order.
    let sides: BTreeSet<u64> =
        positions.iter().filter_map(|position| position.side_m).map(|side_m| (side_m * 1e6) as u64).collect();
    if let Some(&most) = sides.last().filter(|&&side| side > 1_000_000) {
        let (side, most) = (if sides.len() == 1 { "" } else { "up to " }, length(most / 1_000_000));
        warn(&format!("note: grid references name squares of {side}{most}; their middles are taken"));
    }
    if positions.iter().any(|position| position.is_brought)
        && let Some(note) = shift_note(wgs84(), crs)
    {
        warn(&format!("note: {note}"));
    }
}

fn length(meters: u64) -> String {
    if meters >= 1000 { format!("{} km", meters / 1000) } else { format!("{meters} m") }
}

//! The features of a table, by what its columns mean.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};
use serde_json::Value;

use super::cells::{TableRow, TableRows, cell_number, is_faithful_number, number, written};
use super::columns::{self, RowPlace, TableColumns};
use super::wkt;
use crate::builder::{FeatureParts, LayerBuilder, position};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::overlay_schema::{self as schema, bare_code};
use crate::tally::RecordTally;
use sandtable_geom::crs::Crs;
use sandtable_geom::position::degrees::DegreeAxis;
use sandtable_geom::position::{Position, parse_angle};

pub(super) const FORMAT: &str = "table";

/// Reads the features of a table.
///
/// # Errors
/// [`VectorError`]: no column says where the rows lie, their system is not stated, or no row is sound.
pub(super) fn read(table: &TableRows, hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let columns = columns::find(table, hints.columns)?;
    let rows = &table.rows[columns.first..];
    let crs = system(rows, &columns, hints)?;
    let reader = RowsReader {
        columns: &columns,
        order: order(rows, &columns, hints),
        crs: crs.clone(),
        is_stated: hints.crs.is_some(),
    };
    let numeric = numeric_columns(table, &columns);
    let mut builder = LayerBuilder::new(crs);
    let mut codes = CodeTally::default();
    for row in rows {
        let place = || format!("{} {}", table.unit, row.number);
        match reader.parts(row) {
            Ok(parts) => {
                let properties = properties(row, &columns, &numeric, &mut codes, place);
                builder.add_at(parts, properties, place);
            }
            Err(reason) => builder.add_broken(place(), VectorError::broken(FORMAT, place(), reason)),
        }
    }
    table.faults.iter().for_each(|fault| builder.fault(fault.clone()));
    codes.report(&mut builder);
    builder.finish()
}

/// The system of the coordinates.
fn system(rows: &[TableRow], columns: &TableColumns, hints: &VectorHints) -> Result<Crs, VectorError> {
    let reason = "has columns of eastings and northings and names no system";
    match (hints.crs, columns.placement) {
        (Some(crs), _) => Ok(crs.clone()),
        (None, RowPlace::Plane { .. }) => Err(VectorError::NoCrs { format: FORMAT, reason }),
        (None, RowPlace::Shape(column)) => {
            let code =
                rows.iter().filter_map(|row| row.text(column)).find_map(|text| wkt::read(&text).ok()?.1);
            Ok(code.map(Crs::from_epsg).transpose()?.unwrap_or_else(Crs::wgs84))
        }
        _ => Ok(Crs::wgs84()),
    }
}

/// The order of two numbers in a column of positions.
#[derive(Clone, Copy, PartialEq)]
enum NumberOrder {
    /// As the stated system has them.
    EastFirst,
    NorthFirst,
    Unknown,
}

/// The order of degrees without letters: a number beyond 90 can be a longitude only, and says it for all rows.
fn order(rows: &[TableRow], columns: &TableColumns, hints: &VectorHints) -> NumberOrder {
    let RowPlace::Position(column) = columns.placement else { return NumberOrder::EastFirst };
    if hints.crs.is_some() {
        return NumberOrder::EastFirst;
    }
    let pairs = rows.iter().filter_map(|row| Position::parse(&row.text(column)?).ok()?.numbers());
    let [mut first, mut second] = [false; 2];
    for pair in pairs {
        first |= pair.x.abs() > 90.0;
        second |= pair.y.abs() > 90.0;
    }
    match (first, second) {
        (true, false) => NumberOrder::EastFirst,
        (false, true) => NumberOrder::NorthFirst,
        _ => NumberOrder::Unknown,
    }
}

/// Reads the places of rows.
struct RowsReader<'a> {
    columns: &'a TableColumns,
    order: NumberOrder,
    crs: Crs,
    is_stated: bool,
}

impl RowsReader<'_> {
    fn parts(&self, row: &TableRow) -> Result<FeatureParts, String> {
        let mut parts = FeatureParts::default();
        if let RowPlace::Shape(column) = self.columns.placement {
            let text = row.text(column).ok_or_else(|| self.empty(column))?;
            return wkt::read(&text)
                .map(|(parts, _)| parts)
                .map_err(|reason| format!("'{}': {reason}", shorten(&text)));
        }
        let at = self.place(row)?;
        let cell = self.columns.elevation.and_then(|column| row.cell(column));
        let elevation = cell.and_then(cell_number);
        if cell.is_some() && elevation.is_none() {
            parts.count_elevation();
        }
        parts.add_points(vec![with_elevation(at, elevation)]);
        Ok(parts)
    }

    fn place(&self, row: &TableRow) -> Result<DVec2, String> {
        match self.columns.placement {
            RowPlace::Degrees { longitude, latitude } => {
                let plain =
                    (row.cell(longitude).and_then(cell_number), row.cell(latitude).and_then(cell_number));
                if let (Some(x), Some(y)) = plain {
                    let at = DVec2::new(x, y);
                    if !self.crs.is_geographic() {
                        return Ok(at);
                    }
                    let is_degrees = x.abs() <= 360.0 && y.abs() <= 90.0;
                    return is_degrees
                        .then_some(at)
                        .ok_or_else(|| format!("({x}, {y}) is no longitude and latitude"));
                }
                let angle = |column: usize, axis: DegreeAxis| {
                    let text = row.text(column).ok_or_else(|| self.empty(column))?;
                    parse_angle(&text, axis).map_err(|error| error.to_string())
                };
                let x = angle(longitude, DegreeAxis::Longitude)?;
                self.placed(Position::on_earth(DVec2::new(x, angle(latitude, DegreeAxis::Latitude)?)))
            }
            RowPlace::Plane { x, y } => {
                let number = |column: usize| {
                    let cell = row.cell(column).ok_or_else(|| self.empty(column))?;
                    cell_number(cell).ok_or_else(|| format!("'{}' is no number", shorten(&written(cell))))
                };
                Ok(DVec2::new(number(x)?, number(y)?))
            }
            RowPlace::Utm { zone, x, y } => {
                let text = |column: usize| row.text(column).ok_or_else(|| self.empty(column));
                let number = |column: usize| {
                    let text = text(column)?;
                    number(&text).ok_or_else(|| format!("'{}' is no number", shorten(&text)))
                };
                self.position(&format!("{} {} {}", text(zone)?, number(x)?, number(y)?))
            }
            RowPlace::Position(column) => self.position(&row.text(column).ok_or_else(|| self.empty(column))?),
            RowPlace::Shape(column) => Err(self.empty(column)),
        }
    }

    fn position(&self, text: &str) -> Result<DVec2, String> {
        let position = Position::parse(text).map_err(|error| error.to_string())?;
        let Some(pair) = position.numbers().filter(|_| !self.is_stated) else { return self.placed(position) };
        let is_degrees = |pair: DVec2| pair.x.abs() <= 360.0 && pair.y.abs() <= 90.0;
        let swapped = DVec2::new(pair.y, pair.x);
        match self.order {
            NumberOrder::EastFirst if is_degrees(pair) => Ok(pair),
            NumberOrder::NorthFirst if is_degrees(swapped) => Ok(swapped),
            NumberOrder::Unknown if is_degrees(pair) || is_degrees(swapped) => Err(format!(
                "'{}' can be longitude {} and latitude {}, or latitude {} and longitude {}; write their letters, as in 36.3N 84.2W, or state the key 'crs', whose order is X,Y",
                shorten(text),
                pair.x,
                pair.y,
                pair.x,
                pair.y
            )),
            _ => Err(format!(
                "'{}' is two numbers of a system that is not named; state it with the key 'crs'",
                shorten(text)
            )),
        }
    }

    fn placed(&self, position: Position) -> Result<DVec2, String> {
        position.in_system(&self.crs).map_err(|error| error.to_string())
    }

    fn empty(&self, column: usize) -> String {
        let name = self.columns.names.get(&column).map_or("", String::as_str);
        format!("nothing stands in the column '{}'", shorten(name))
    }
}

fn with_elevation(at: DVec2, elevation: Option<f64>) -> DVec3 {
    position(at.x, at.y, elevation)
}

/// The columns of a table of text in which every cell is a number.
fn numeric_columns(table: &TableRows, columns: &TableColumns) -> BTreeSet<usize> {
    if !table.is_text {
        return BTreeSet::new();
    }
    let mut numeric: BTreeSet<usize> = columns.names.keys().copied().collect();
    for (column, cell) in table.rows[columns.first..].iter().flat_map(|row| &row.cells) {
        if numeric.contains(column) && !cell.as_str().is_some_and(is_faithful_number) {
            numeric.remove(column);
        }
    }
    numeric
}

fn properties(
    row: &TableRow,
    columns: &TableColumns,
    numeric: &BTreeSet<usize>,
    codes: &mut CodeTally,
    place: impl Fn() -> String + Copy,
) -> Properties {
    let mut properties = Properties::new();
    for (column, cell) in &row.cells {
        let Some(name) = columns.names.get(column) else { continue };
        let typed = cell.as_str().filter(|_| numeric.contains(column)).and_then(number);
        properties.insert(name.clone(), typed.map_or_else(|| cell.clone(), Value::from));
    }
    for (column, property) in &columns.properties {
        let Some(cell) = row.cell(*column) else { continue };
        if property == schema::SIDC {
            let own = columns.names.get(column).map_or("", String::as_str);
            codes.read(cell, own, &mut properties, place);
        } else if columns.names.values().any(|name| name == property)
            && columns.names.get(column) != Some(property)
        {
            // Another column has the property's own name.
        } else {
            schema::set(&mut properties, property, written(cell));
        }
    }
    properties
}

/// The cells of the column of codes that are none.
#[derive(Default)]
struct CodeTally {
    rounded: RecordTally,
    other: RecordTally,
}

impl CodeTally {
    /// Sets the code of a cell.
    fn read(&mut self, cell: &Value, own: &str, properties: &mut Properties, place: impl Fn() -> String) {
        let text = written(cell);
        if is_rounded(cell, &text) {
            properties.remove(own);
            properties.remove(schema::SIDC);
            self.rounded.add(place);
        } else if let Some(code) = bare_code(&text) {
            schema::set(properties, schema::SIDC, code);
        } else {
            self.other.add(place);
        }
    }

    fn report(&self, builder: &mut LayerBuilder) {
        let rounded = self.rounded.text(
            "symbol code is a number that lost its last digits; format the column as text and enter it again",
            "symbol codes are numbers that lost their last digits; format the column as text and enter them again",
        );
        let other = self.other.text(
            "cell of the column of codes is no symbol code",
            "cells of the column of codes are no symbol codes",
        );
        rounded.into_iter().chain(other).for_each(|text| builder.fault(text));
    }
}

/// Whether a code is a number that a spreadsheet rounded: it keeps fifteen digits.
fn is_rounded(cell: &Value, text: &str) -> bool {
    match cell {
        Value::Number(number) => number.as_f64().is_some_and(|number| number.abs() >= 1e15),
        _ => text.contains(['e', 'E']) && number(text).is_some_and(|number| number.abs() >= 1e15),
    }
}

//! What the columns of a table mean: by the row of names, or as the user states it.

use std::collections::BTreeMap;

use super::cells::{TableRow, TableRows, cell_number, written};
use super::names::{self, ColumnRole};
use crate::error::VectorError;
use crate::overlay_schema as schema;
use sandtable_geom::position::Position;

/// The rows at the top among which the names are searched: titles and remarks stand above them.
const PROBED_ROWS: usize = 40;

/// The rows below the names that show whether a column holds positions.
const PROBED_CELLS: usize = 200;

/// Where a row lies, by its columns from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RowPlace {
    Shape(usize),
    Degrees { longitude: usize, latitude: usize },
    Position(usize),
    Plane { x: usize, y: usize },
    Utm { zone: usize, x: usize, y: usize },
}

/// The columns of a table.
#[derive(Debug)]
pub(super) struct TableColumns {
    pub placement: RowPlace,
    /// The column of elevations.
    pub elevation: Option<usize>,
    /// The columns of the overlay schema, with its properties.
    pub properties: Vec<(usize, String)>,
    /// All columns with the names of their properties, none twice.
    pub names: BTreeMap<usize, String>,
    /// The index of the first row below the names.
    pub first: usize,
}

/// The meaning of the columns of a table; `stated` has roles or properties with names of columns.
///
/// # Errors
/// [`VectorError::NoSuchColumn`], [`VectorError::NoPlaceColumns`].
pub(super) fn find(table: &TableRows, stated: &[(String, String)]) -> Result<TableColumns, VectorError> {
    let probed = || table.rows.iter().enumerate().take(PROBED_ROWS);
    if !stated.is_empty() {
        let holds_all = |row: &TableRow| stated.iter().all(|(_, name)| column_of(row, name).is_some());
        if let Some((index, _)) = probed().find(|(_, row)| holds_all(row)) {
            return of_row(table, index, stated).ok_or_else(|| no_place(&table.rows[index]));
        }
        let most = |row: &TableRow| stated.iter().filter(|(_, name)| column_of(row, name).is_some()).count();
        let key = |(index, row): &(usize, &TableRow)| (most(row), texts(row), PROBED_ROWS - index);
        let header = probed().max_by_key(key).map(|(_, row)| row);
        let header = header.cloned().unwrap_or_default();
        let missing = stated.iter().find(|(_, name)| column_of(&header, name).is_none());
        let wanted = missing.map_or("", |(_, name)| name.as_str());
        return Err(VectorError::no_such_column(wanted, &listed(&header)));
    }
    let found = probed().find_map(|(index, _)| of_row(table, index, stated));
    let header = || {
        // The row with the most texts is what a reader takes for the names.
        let best = probed().max_by_key(|(index, row)| (texts(row), PROBED_ROWS - index));
        best.map(|(_, row)| row.clone()).unwrap_or_default()
    };
    found.ok_or_else(|| no_place(&header()))
}

/// How many cells of a row are no numbers.
fn texts(row: &TableRow) -> usize {
    row.cells.iter().filter(|(_, cell)| cell_number(cell).is_none()).count()
}

fn no_place(header: &TableRow) -> VectorError {
    VectorError::NoPlaceColumns { names: listed(header) }
}

fn listed(header: &TableRow) -> Vec<String> {
    header.cells.iter().map(|(_, cell)| written(cell)).collect()
}

/// The column of a name, in any case where none has it in its own.
fn column_of(header: &TableRow, name: &str) -> Option<usize> {
    let find = |is_same: &dyn Fn(&str) -> bool| {
        header.cells.iter().find(|(_, cell)| is_same(written(cell).trim())).map(|(column, _)| *column)
    };
    find(&|found| found == name.trim())
        .or_else(|| find(&|found| found.to_lowercase() == name.trim().to_lowercase()))
}

/// The columns by the row of names at `index`; `None` where they say no place.
fn of_row(table: &TableRows, index: usize, stated: &[(String, String)]) -> Option<TableColumns> {
    let header = &table.rows[index];
    let below = &table.rows[index + 1..];
    // By its role, each column with how sure it is.
    let mut known: BTreeMap<ColumnRole, Vec<(usize, usize)>> = BTreeMap::new();
    for (column, cell) in &header.cells {
        if let Some((role, rank)) = cell.as_str().and_then(names::role) {
            known.entry(role).or_default().push((rank, *column));
        }
    }
    known.values_mut().for_each(|columns| columns.sort_unstable());
    let mut properties = Vec::new();
    let mut said: BTreeMap<ColumnRole, usize> = BTreeMap::new();
    for (word, name) in stated {
        let column = column_of(header, name)?;
        match names::STATED.iter().find(|(known, _)| known == word) {
            Some((_, role)) => drop(said.insert(*role, column)),
            None => properties.push((column, word.clone())),
        }
    }
    let placement = match said.keys().any(|role| !matches!(role, ColumnRole::Z)) {
        true => placement(&|role| said.get(&role).copied())?,
        false => {
            let of = |role: ColumnRole| match role {
                ColumnRole::Position => {
                    let columns = known.get(&role)?.iter().map(|(_, column)| *column);
                    columns.into_iter().find(|column| holds_positions(below, *column))
                }
                _ => known.get(&role)?.first().map(|(_, column)| *column),
            };
            placement(&of)?
        }
    };
    let elevation = said.get(&ColumnRole::Z).copied();
    let elevation = elevation.or_else(|| Some(known.get(&ColumnRole::Z)?.first()?.1));
    for (role, columns) in &known {
        if let (ColumnRole::Property(name), Some((_, column))) = (role, columns.first())
            && !properties.iter().any(|(_, stated)| stated == name)
        {
            properties.push((*column, (*name).to_owned()));
        }
    }
    // A column of codes is known by what it holds, whatever it is called.
    if !properties.iter().any(|(_, name)| name == schema::SIDC) {
        let codes = header.cells.iter().find(|(column, _)| holds_codes(below, *column));
        properties.extend(codes.map(|(column, _)| (*column, schema::SIDC.to_owned())));
    }
    Some(TableColumns { placement, elevation, properties, names: property_names(header), first: index + 1 })
}

fn placement(column: &dyn Fn(ColumnRole) -> Option<usize>) -> Option<RowPlace> {
    if let Some(shape) = column(ColumnRole::Shape) {
        return Some(RowPlace::Shape(shape));
    }
    if let (Some(longitude), Some(latitude)) = (column(ColumnRole::Longitude), column(ColumnRole::Latitude)) {
        return Some(RowPlace::Degrees { longitude, latitude });
    }
    if let Some(position) = column(ColumnRole::Position) {
        return Some(RowPlace::Position(position));
    }
    let (x, y) = (column(ColumnRole::X)?, column(ColumnRole::Y)?);
    Some(match column(ColumnRole::Zone) {
        Some(zone) => RowPlace::Utm { zone, x, y },
        None => RowPlace::Plane { x, y },
    })
}

fn probed_texts(rows: &[TableRow], column: usize) -> impl Iterator<Item = String> + '_ {
    rows.iter().take(PROBED_CELLS).filter_map(move |row| row.text(column))
}

/// Whether some cell is a position: columns called location hold the names of places as well.
fn holds_positions(rows: &[TableRow], column: usize) -> bool {
    probed_texts(rows, column).any(|text| Position::parse(&text).is_ok())
}

/// Whether the cells of a column are codes.
fn holds_codes(rows: &[TableRow], column: usize) -> bool {
    let is_code = |text: &String| {
        schema::bare_code(text).is_some_and(|code| code == *text && (code.len() == 20 || code.len() == 15))
    };
    let mut cells = probed_texts(rows, column).peekable();
    cells.peek().is_some() && cells.all(|text| is_code(&text))
}

/// The names of the columns as properties: a name that is there twice gets a number.
fn property_names(header: &TableRow) -> BTreeMap<usize, String> {
    let mut used: BTreeMap<String, usize> = BTreeMap::new();
    let mut name_of = |cell: &serde_json::Value| {
        let name = written(cell).split_whitespace().collect::<Vec<_>>().join(" ");
        let count = used.entry(name.clone()).or_default();
        *count += 1;
        if *count == 1 { name } else { format!("{name}_{count}") }
    };
    header.cells.iter().map(|(column, cell)| (*column, name_of(cell))).collect()
}

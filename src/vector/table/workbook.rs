//! Spreadsheets: xlsx and xlsm by `calamine`, whose cells come one by one, and OpenDocument by hand.
//!
//! Nothing is allocated by what a sheet declares as its size: only cells that hold something are kept. Members of the archive are
//! unpacked within a limit before anything else reads them. `calamine`'s reader of OpenDocument repeats cells before it counts
//! them, and that of xls allocates what the file declares, so that neither is used: [`workbook_97`](super::workbook_97) reads those.

use std::io::Cursor;

use calamine::{DataRef, Reader, Xlsx};
use serde_json::Value;

use super::cells::{TableRow, TableRows, text_value};
use super::{layer, workbook_97};
use crate::error::VectorError;
use crate::feature::VectorLayer;
use crate::hints::VectorHints;
use crate::xml::{self, XmlElement, XmlReader};
use sandtable_base::archive::ZipReader;
use sandtable_base::limits::UNPACKED_VECTOR_BYTES;

const FORMAT: &str = "spreadsheet";

/// How often a row or a cell of OpenDocument that holds something may be repeated.
const MOST_REPEATS: usize = 1 << 20;

/// The bytes that a cell takes besides its text.
const CELL_BYTES: u64 = 64;

/// Whether the archive is a spreadsheet that is read.
pub(in super::super) fn is_workbook(zip: &ZipReader<'_>) -> bool {
    is_xlsx(zip) || is_ods(zip)
}

fn is_xlsx(zip: &ZipReader<'_>) -> bool {
    zip.names().any(|name| name.eq_ignore_ascii_case("xl/workbook.xml"))
}

fn is_ods(zip: &ZipReader<'_>) -> bool {
    zip.names().any(|name| name == "content.xml")
        && zip
            .read_head("mimetype", 100)
            .is_ok_and(|kind| kind.starts_with(b"application/vnd.oasis.opendocument.spreadsheet"))
}

/// Reads a sheet of a workbook as a table; the only one that has rows where none is asked for.
///
/// # Errors
/// [`VectorError`], as for a table of text; several sheets have rows and none is asked for.
pub(in super::super) fn read(
    bytes: &[u8],
    zip: &ZipReader<'_>,
    limit: u64,
    hints: &VectorHints,
) -> Result<VectorLayer, VectorError> {
    let sheets = if is_xlsx(zip) { xlsx(bytes, zip, limit)? } else { ods(&zip.read("content.xml", limit)?)? };
    chosen(sheets, hints)
}

/// Reads a sheet of a workbook of Excel 97 to 2003, as [`read`] does.
///
/// # Errors
/// As [`read`].
pub(in super::super) fn read_97(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let found =
        workbook_97::sheets(bytes).map_err(|reason| VectorError::broken(FORMAT, "its workbook", reason))?;
    let mut budget = CellBudget::new();
    let mut sheets = Vec::new();
    for (name, cells) in found {
        cells.iter().try_for_each(|(.., value)| budget.take(value))?;
        sheets.push((name, sheet_of(cells)));
    }
    chosen(sheets, hints)
}

/// The table of the sheet that is meant.
fn chosen(sheets: Vec<(String, TableRows)>, hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let filled = || sheets.iter().filter(|(_, rows)| !rows.rows.is_empty());
    let names: Vec<&str> = match hints.layer {
        Some(_) => sheets.iter().map(|(name, _)| name.as_str()).collect(),
        None => filled().map(|(name, _)| name.as_str()).collect(),
    };
    if names.is_empty() {
        return layer::read(&TableRows::default(), hints);
    }
    // Without a layer, the only sheet with places is meant.
    if hints.layer.is_none() && names.len() > 1 {
        let placed: Vec<&(String, TableRows)> =
            filled().filter(|(_, rows)| super::columns::find(rows, hints.columns).is_ok()).collect();
        if let [(_, only)] = placed[..] {
            return layer::read(only, hints);
        }
    }
    let wanted = names[hints.choose_layer(&names)?];
    let sheet = sheets.iter().find(|(name, _)| name == wanted);
    layer::read(sheet.map_or(&TableRows::default(), |(_, rows)| rows), hints)
}

/// Collects the cells of a workbook within a limit of memory.
struct CellBudget {
    left: u64,
}

impl CellBudget {
    fn new() -> Self {
        Self { left: UNPACKED_VECTOR_BYTES.get() }
    }

    fn take(&mut self, cell: &Value) -> Result<(), VectorError> {
        let bytes = CELL_BYTES + cell.as_str().map_or(0, |text| text.len() as u64);
        self.left = self.left.checked_sub(bytes).ok_or_else(|| VectorError::Unsupported {
            format: FORMAT,
            content: format!("more than {UNPACKED_VECTOR_BYTES} bytes of cells").into(),
            remedy: "part it, or save the sheet as CSV",
        })?;
        Ok(())
    }
}

fn new_sheet() -> TableRows {
    TableRows { unit: "row", ..TableRows::default() }
}

fn xlsx(bytes: &[u8], zip: &ZipReader<'_>, limit: u64) -> Result<Vec<(String, TableRows)>, VectorError> {
    let mut left = limit;
    for name in zip.names().filter(|name| !name.starts_with("xl/media/")) {
        left = left.saturating_sub(zip.read(name, left)?.len() as u64);
    }
    let broken = |place: &str, error: calamine::XlsxError| VectorError::broken(FORMAT, place, error);
    let mut workbook = Xlsx::new(Cursor::new(bytes)).map_err(|error| broken("its workbook", error))?;
    let mut budget = CellBudget::new();
    let mut sheets = Vec::new();
    let sheet_names: Vec<String> = workbook
        .sheets_metadata()
        .iter()
        .filter(|sheet| sheet.typ == calamine::SheetType::WorkSheet)
        .map(|sheet| sheet.name.clone())
        .collect();
    for name in sheet_names {
        let place = format!("the sheet '{}'", crate::error::shorten(&name));
        let mut cells = workbook.worksheet_cells_reader(&name).map_err(|error| broken(&place, error))?;
        let mut found: Vec<(u32, u32, Value)> = Vec::new();
        while let Some(cell) = cells.next_cell().map_err(|error| broken(&place, error))? {
            let value = xlsx_value(cell.get_value());
            if value.is_null() {
                continue;
            }
            budget.take(&value)?;
            let (row, column) = cell.get_position();
            found.push((row, column, value));
        }
        sheets.push((name, sheet_of(found)));
    }
    Ok(sheets)
}

/// The rows of the cells of a sheet. Cells come in order, but where a file is odd.
fn sheet_of(mut found: Vec<(u32, u32, Value)>) -> TableRows {
    found.sort_by_key(|(row, column, _)| (*row, *column));
    found.dedup_by_key(|(row, column, _)| (*row, *column));
    let mut sheet = new_sheet();
    for (row, column, value) in found {
        let number = row as usize + 1;
        if sheet.rows.last().is_none_or(|last| last.number != number) {
            sheet.rows.push(TableRow { number, cells: Vec::new() });
        }
        if let Some(last) = sheet.rows.last_mut() {
            last.cells.push((column as usize, value));
        }
    }
    sheet
}

fn xlsx_value(cell: &DataRef<'_>) -> Value {
    match cell {
        DataRef::Int(number) => Value::from(*number),
        DataRef::Float(number) => Value::from(*number),
        DataRef::String(found) | DataRef::DateTimeIso(found) | DataRef::DurationIso(found) => {
            text_value(found)
        }
        DataRef::SharedString(found) => text_value(found),
        DataRef::Bool(is) => Value::Bool(*is),
        DataRef::DateTime(moment) if moment.is_datetime() && (0.0..3e6).contains(&moment.as_f64()) => {
            let (year, month, day, hour, minute, second, _) = moment.to_ymd_hms_milli();
            let day = format!("{year:04}-{month:02}-{day:02}");
            let is_day = (hour, minute, second) == (0, 0, 0);
            Value::String(if is_day { day } else { format!("{day}T{hour:02}:{minute:02}:{second:02}Z") })
        }
        DataRef::DateTime(moment) => Value::from(moment.as_f64()),
        DataRef::Error(_) | DataRef::Empty => Value::Null,
    }
}

/// The tables of an OpenDocument spreadsheet's content.
fn ods(content: &[u8]) -> Result<Vec<(String, TableRows)>, VectorError> {
    let decoded = xml::decode(content, FORMAT)?;
    let mut xml = XmlReader::new(&decoded.text, FORMAT);
    let (mut sheets, mut budget) = (Vec::new(), CellBudget::new());
    xml.root()?;
    while let Some(child) = xml.next_child()? {
        if child.name() != "body" {
            xml.skip()?;
            continue;
        }
        while let Some(kind) = xml.next_child()? {
            if kind.name() != "spreadsheet" {
                xml.skip()?;
                continue;
            }
            while let Some(table) = xml.next_child()? {
                if table.name() != "table" {
                    xml.skip()?;
                    continue;
                }
                let name = table.local_attribute("name").map_or_else(String::new, |name| name.into_owned());
                let mut sheet = new_sheet();
                ods_rows(&mut xml, &mut sheet, &mut 1, &mut budget)?;
                sheets.push((name, sheet));
            }
        }
    }
    Ok(sheets)
}

/// Reads the rows of an open table, or of a group of rows; `number` is that of the next row.
fn ods_rows(
    xml: &mut XmlReader<'_>,
    sheet: &mut TableRows,
    number: &mut usize,
    budget: &mut CellBudget,
) -> Result<(), VectorError> {
    while let Some(child) = xml.next_child()? {
        match child.name() {
            "table-row" => {
                let row = xml.read(child)?;
                let repeats = repeats(&row, "number-rows-repeated");
                let cells = ods_cells(&row, budget)?;
                let count = if cells.is_empty() { 0 } else { repeats.min(MOST_REPEATS) };
                for index in 0..count {
                    if index > 0 {
                        cells.iter().try_for_each(|(_, cell)| budget.take(cell))?;
                    }
                    sheet.rows.push(TableRow { number: *number + index, cells: cells.clone() });
                }
                *number = number.saturating_add(repeats);
            }
            "table-rows" | "table-header-rows" | "table-row-group" => ods_rows(xml, sheet, number, budget)?,
            _ => xml.skip()?,
        }
    }
    Ok(())
}

fn repeats(element: &XmlElement<'_>, name: &str) -> usize {
    element
        .local_attribute(name)
        .and_then(|count| count.trim().parse::<usize>().ok())
        .unwrap_or(1)
        .clamp(1, u32::MAX as usize)
}

fn ods_cells(row: &XmlElement<'_>, budget: &mut CellBudget) -> Result<Vec<(usize, Value)>, VectorError> {
    let (mut cells, mut column) = (Vec::new(), 0usize);
    for cell in row.children().filter(|cell| matches!(cell.name(), "table-cell" | "covered-table-cell")) {
        let repeats = repeats(cell, "number-columns-repeated");
        let value = ods_value(cell);
        if !value.is_null() {
            for index in 0..repeats.min(MOST_REPEATS) {
                budget.take(&value)?;
                cells.push((column.saturating_add(index), value.clone()));
            }
        }
        column = column.saturating_add(repeats);
    }
    Ok(cells)
}

fn ods_value(cell: &XmlElement<'_>) -> Value {
    let text = || {
        // Notes stand in the cell as well.
        let lines: Vec<String> = cell.children_named("p").map(XmlElement::text).collect();
        Some(lines.join("\n").trim().to_owned())
            .filter(|text| !text.is_empty())
            .map_or(Value::Null, Value::String)
    };
    match cell.local_attribute("value-type").as_deref() {
        Some("float" | "percentage" | "currency") => {
            let number = cell
                .local_attribute("value")
                .and_then(|number| number.trim().parse().ok())
                .filter(|number: &f64| number.is_finite());
            number.map_or_else(text, Value::from)
        }
        Some("boolean") => Value::Bool(cell.local_attribute("boolean-value").as_deref() == Some("true")),
        Some("date") => {
            cell.local_attribute("date-value").map_or_else(text, |date| Value::String(date.into_owned()))
        }
        Some("string") => match cell.local_attribute("string-value") {
            Some(stated) if !stated.trim().is_empty() => Value::String(stated.trim().to_owned()),
            _ => text(),
        },
        _ => text(),
    }
}

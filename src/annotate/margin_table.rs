//! Tables in the margin of a sheet: march tables, posts, zones.

use glam::Vec2;

use crate::composer::{Composer, widest};
use crate::drawing::Drawing;
use crate::pixel_box::PixelSegment;
use crate::sheet::{FRAME, INK, SOFT_INK};
use crate::text::{TextStyle, TypesetLine};

/// The sizes of its type in design pixels that are tried, the largest first.
const TYPE: [f32; 4] = [13.5, 12.0, 10.5, 9.0];
/// The space between columns, and the distance of lines, in heights of its type.
const GAP_EM: f32 = 0.7;
const LEAD_EM: f32 = 1.36;
/// Rows at most: a margin holds no more.
const MOST_ROWS: usize = 16;

/// A table in the margin of a sheet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MarginTable {
    /// Its title.
    pub title: String,
    /// The heading of each column and its unit, which may be empty.
    pub columns: Vec<(String, String)>,
    /// Its rows, a text for each column.
    pub rows: Vec<Vec<String>>,
}

/// A column that is set: heading, unit, cells.
struct SetColumn {
    lines: Vec<TypesetLine>,
    width: f32,
}

/// The table with its upper left corner at the origin, at most `width` pixels wide: in the largest type in which it fits; in
/// the smallest without its last columns where it does not. `None` without rows or columns.
pub(crate) fn compose(table: &MarginTable, width: f32, composer: &mut Composer) -> Option<Drawing> {
    if table.rows.is_empty() || table.columns.is_empty() {
        return None;
    }
    let mut set = None;
    for size in TYPE {
        let style = composer.style(size, TextStyle::REGULAR);
        let columns = set_columns(table, style, composer);
        let is_narrow = total_width(&columns, style) <= width;
        set = Some((columns, style));
        if is_narrow {
            break;
        }
    }
    let (mut columns, style) = set?;
    while columns.len() > 1 && total_width(&columns, style) > width {
        columns.pop();
    }
    let mut drawing = Drawing::default();
    let head_style = composer.style(15.0, TextStyle::MEDIUM);
    let head = composer.fitted(&table.title, head_style, width)?;
    let mut baseline = head_style.cap_px().ceil();
    drawing.record_text(&table.title, head.missing, head.shortened);
    drawing.write(&head, Vec2::new(0.0, baseline), INK);
    let lead = (style.size_px * LEAD_EM).round();
    baseline += (lead * 1.15).round();
    let has_units = table.columns.iter().any(|(_, unit)| !unit.is_empty());
    let count = columns.first().map_or(0, |column| column.lines.len());
    let rule_after = if has_units { 1 } else { 0 };
    let full = total_width(&columns, style);
    for line in 0..count {
        if line == 1 && !has_units {
            continue;
        }
        let mut left = 0.0;
        for (number, column) in columns.iter().enumerate() {
            let text = &column.lines[line];
            // What is first tells the row; numbers end at the right.
            let x = if number == 0 { left } else { left + column.width - text.advance };
            drawing.write(text, Vec2::new(x, baseline).round(), if line < 2 { SOFT_INK } else { INK });
            left += column.width + style.size_px * GAP_EM;
        }
        if line == rule_after {
            let y = (baseline + style.size_px * 0.36).round() + 0.5;
            let rule = PixelSegment { from: Vec2::new(0.0, y), to: Vec2::new(full, y) };
            drawing.line(rule, composer.sheet.hairline(), FRAME);
        }
        baseline += lead;
    }
    Some(drawing)
}

fn total_width(columns: &[SetColumn], style: TextStyle) -> f32 {
    let gaps = style.size_px * GAP_EM * columns.len().saturating_sub(1) as f32;
    columns.iter().map(|column| column.width).sum::<f32>() + gaps
}

fn set_columns(table: &MarginTable, style: TextStyle, composer: &mut Composer) -> Vec<SetColumn> {
    let rows = &table.rows[..table.rows.len().min(MOST_ROWS)];
    let more = table.rows.len() - rows.len();
    let column = |(number, (head, unit)): (usize, &(String, String))| {
        let cells = rows.iter().map(|row| row.get(number).map_or("", String::as_str));
        let rest = match (more, number) {
            (0, _) => None,
            (more, 0) => Some(format!("and {more} more")),
            _ => Some(String::new()),
        };
        let texts: Vec<String> =
            [head.as_str(), unit.as_str()].into_iter().chain(cells).map(str::to_owned).chain(rest).collect();
        let lines: Vec<TypesetLine> = texts.iter().map(|text| composer.line(text, style)).collect();
        let width = widest(&lines);
        SetColumn { lines, width }
    };
    table.columns.iter().enumerate().map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn march(columns: usize, rows: usize) -> MarginTable {
        let head = |number: usize| (format!("head {number}"), "km".to_owned());
        let row = |row: usize| (0..columns).map(|column| format!("{}", row * 1000 + column)).collect();
        MarginTable {
            title: "March table".into(),
            columns: (0..columns).map(head).collect(),
            rows: (0..rows).map(row).collect(),
        }
    }

    #[test]
    fn a_table_is_as_wide_as_the_margin_at_most() {
        let mut composer = Composer::new(1920, 1080);
        for columns in [1, 4, 6, 30] {
            let drawing = compose(&march(columns, 5), 286.0, &mut composer).expect("rows");
            let bounds = drawing.bounds();
            assert!(bounds.max.x <= 288.0, "{columns}: {bounds:?}");
        }
    }

    #[test]
    fn each_row_has_a_line_and_those_beyond_the_last_are_counted() {
        let mut composer = Composer::new(1920, 1080);
        let mut height = |rows: usize| {
            compose(&march(3, rows), 286.0, &mut composer).map(|drawing| drawing.bounds().size().y)
        };
        assert_eq!(height(0), None);
        let (three, four) = (height(3).expect("rows"), height(4).expect("rows"));
        assert!((four - three - 18.0).abs() < 2.0, "{three} {four}");
        assert_eq!(height(MOST_ROWS + 1), height(MOST_ROWS + 100));
    }
}

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

/// The type of a table in blocks, in design pixels, and the space between them in heights of it.
const BLOCK_TYPE: f32 = 12.0;
const BLOCK_GAP_EM: f32 = 0.5;

/// A column that is set: heading, unit, cells.
#[derive(Clone)]
struct SetColumn {
    lines: Vec<TypesetLine>,
    width: f32,
}

/// The table with its upper left corner at the origin, at most `width` pixels wide: in the largest type in which it fits, or
/// in blocks one below the other, each with the first column and as many others as fit. `None` without rows or columns.
pub(crate) fn compose(table: &MarginTable, width: f32, composer: &mut Composer) -> Option<Drawing> {
    if table.rows.is_empty() || table.columns.is_empty() {
        return None;
    }
    let mut drawing = Drawing::default();
    let head_style = composer.style(15.0, TextStyle::MEDIUM);
    let head = composer.fitted(&table.title, head_style, width)?;
    drawing.record_text(&table.title, head.missing, head.shortened);
    drawing.write(&head, Vec2::new(0.0, head_style.cap_px().ceil()), INK);
    let mut top = head_style.cap_px().ceil();
    for (columns, style) in blocks(table, width, composer) {
        top = draw_block(&mut drawing, (table, &columns), (style, top), composer)
            + style.size_px * BLOCK_GAP_EM;
    }
    Some(drawing)
}

/// The columns of each block with their type.
fn blocks(table: &MarginTable, width: f32, composer: &mut Composer) -> Vec<(Vec<SetColumn>, TextStyle)> {
    for size in TYPE {
        let style = composer.style(size, TextStyle::REGULAR);
        let columns = set_columns(table, style, composer);
        if total_width(&columns, style) <= width {
            return vec![(columns, style)];
        }
    }
    let style = composer.style(BLOCK_TYPE, TextStyle::REGULAR);
    let mut columns = set_columns(table, style, composer).into_iter();
    let Some(first) = columns.next() else { return Vec::new() };
    let mut blocks = vec![vec![first.clone()]];
    for column in columns {
        let taken = blocks.last().map_or(0.0, |block| total_width(block, style));
        let is_begun = blocks.last().is_some_and(|block| block.len() > 1);
        if is_begun && taken + style.size_px * GAP_EM + column.width > width {
            blocks.push(vec![first.clone()]);
        }
        blocks.last_mut().into_iter().for_each(|block| block.push(column.clone()));
    }
    blocks.into_iter().map(|block| (block, style)).collect()
}

/// Draws columns side by side below `top`; where the next line would lie.
fn draw_block(
    drawing: &mut Drawing,
    (table, columns): (&MarginTable, &[SetColumn]),
    (style, top): (TextStyle, f32),
    composer: &Composer,
) -> f32 {
    let lead = (style.size_px * LEAD_EM).round();
    let mut baseline = top + (lead * 1.15).round();
    let has_units = table.columns.iter().any(|(_, unit)| !unit.is_empty());
    let count = columns.first().map_or(0, |column| column.lines.len());
    let rule_after = if has_units { 1 } else { 0 };
    let full = total_width(columns, style);
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
    baseline - lead
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

    #[test]
    fn a_table_that_is_too_wide_has_its_columns_in_blocks_below_each_other() {
        let mut composer = Composer::new(1920, 1080);
        let mut wide = march(6, 3);
        let cells = (0..6).map(|column| format!("a wide text {column}"));
        wide.rows = vec![cells.collect(); 3];
        let blocks = blocks(&wide, 286.0, &mut composer);
        let counts: Vec<usize> = blocks.iter().map(|(columns, _)| columns.len()).collect();
        assert!(counts.len() > 1 && counts.iter().all(|&count| count > 1), "{counts:?}");
        assert_eq!(counts.iter().map(|count| count - 1).sum::<usize>(), 5, "each column once: {counts:?}");
        let drawing = compose(&wide, 286.0, &mut composer).expect("rows");
        assert!(drawing.bounds().max.x <= 288.0, "{:?}", drawing.bounds());
    }
}

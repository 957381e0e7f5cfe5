//! What stands for symbols that have no room: numbers at their places with a list of them, and counts where a list would be
//! too long.
//!
//! ```text
//!   ┌──┐                ┌───────────────────────────────────┐
//!   │12│                │ 11  2-77 IN    16S GF 55447 24162 │
//!   └─┬┘ numbered       │ 12  B/1-9      16S GF 55502 24090 │
//!     •                 │ ×n  n units near it               │
//!   ┌───┐               └───────────────────────────────────┘
//!   │×37│ counted
//!   └───┘
//! ```

use std::collections::BTreeMap;

use glam::Vec2;

use crate::annotation::PictureSymbol;
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::sheet::{HALO, INK, Sheet};
use crate::symbol_stack::{StackPosition, Standing};
use crate::text::{TextStyle, TypesetLine};
use sandtable_draw::color::Srgba;
use sandtable_symbology::drawing::SymbolMark;

/// The size of type in design pixels.
const TYPE: f32 = 12.0;
/// From one row to the next, in sizes of the type.
const ROW_PITCH: f32 = 1.35;
/// The widths of a row in design pixels: number, name, grid reference.
const COLUMNS: [f32; 3] = [34.0, 120.0, 138.0];
/// From the panel's edge to its text, in design pixels.
const PADDING: f32 = 8.0;
/// The largest part of a picture's width and height that the list takes.
const LARGEST_SHARE: Vec2 = Vec2::new(0.45, 0.85);
/// Between a badge's text and its edge, in design pixels.
const BADGE_PADDING: f32 = 3.0;
/// The side of the squares in which symbols are counted, in design pixels.
const COUNTED_IN: f32 = 96.0;
/// Their least side, in sizes of the type: on small pictures type is large.
const LEAST_COUNTED_IN: f32 = 6.0;
const BLACK: Srgba = Srgba::opaque(0, 0, 0);

/// The list of symbols without room, before its rows are known.
pub(crate) struct SymbolList {
    /// Its place, for all rows.
    pub area: PixelBox,
    /// The most symbols that it lists.
    pub rows: usize,
    rows_in_column: usize,
}

impl SymbolList {
    /// The largest list for up to `wanted` symbols that has a place on the picture; `None` where not one row has.
    pub fn reserve(
        wanted: usize,
        bounds: PixelBox,
        furniture: &[PixelBox],
        composer: &Composer,
    ) -> Option<Self> {
        let sheet = composer.sheet;
        let (row, column, padding) = (row_px(&sheet), column_px(&sheet), sheet.px(PADDING));
        let most = bounds.size() * LARGEST_SHARE;
        let mut rows_in_column = ((most.y - 2.0 * padding) / row).floor().max(0.0) as usize;
        let most_columns = ((most.x - 2.0 * padding) / column).floor().max(0.0) as usize;
        while rows_in_column > 1 && most_columns > 0 {
            // The last row says what is counted.
            let columns = wanted.div_ceil(rows_in_column - 1).min(most_columns);
            for columns in (1..=columns).rev() {
                let height = rows_in_column.min(wanted.div_ceil(columns) + 1);
                let size =
                    Vec2::new(column * columns as f32 + 2.0 * padding, row * height as f32 + 2.0 * padding);
                if let Some(area) = free_place(size.ceil(), bounds, furniture) {
                    return Some(Self { area, rows: height * columns - 1, rows_in_column: height });
                }
            }
            rows_in_column = rows_in_column * 3 / 4;
        }
        None
    }

    /// The list of the first of `left`, in as many rows as it needs, and its place.
    pub fn draw(&self, left: &[&PictureSymbol], composer: &mut Composer) -> (Drawing, PixelBox) {
        let sheet = composer.sheet;
        let (row, column, padding) = (row_px(&sheet), column_px(&sheet), sheet.px(PADDING));
        let style = composer.style(TYPE, TextStyle::REGULAR);
        let listed = left.len().min(self.rows);
        let mut texts: Vec<[String; 3]> = left[..listed]
            .iter()
            .enumerate()
            .map(|(index, symbol)| {
                let reference = symbol.reference.clone().unwrap_or_default();
                [(index + 1).to_string(), symbol.name.clone(), reference]
            })
            .collect();
        if left.len() > listed {
            texts.push(["×n".to_owned(), "n units near it".to_owned(), String::new()]);
        }
        let columns = texts.len().div_ceil(self.rows_in_column).max(1);
        let rows = texts.len().div_ceil(columns);
        let size = Vec2::new(column * columns as f32, row * rows as f32) + Vec2::splat(2.0 * padding);
        let mut drawing = Drawing::default();
        for (index, cells) in texts.iter().enumerate() {
            let at = Vec2::new((index / rows) as f32 * column, (index % rows) as f32 * row);
            let mut at = at + Vec2::splat(padding) + Vec2::new(0.0, (row + style.cap_px()) * 0.5);
            for (text, width) in cells.iter().zip(COLUMNS) {
                let width = sheet.px(width);
                if let Some(line) = composer.fitted(text, style, width - sheet.px(6.0)) {
                    drawing.record_text(text, line.missing, line.shortened);
                    drawing.write(&line, at.round(), INK);
                }
                at.x += width;
            }
        }
        let area = PixelBox::at(self.area.min, size.ceil());
        (drawing.on_panel(size.ceil(), &sheet).moved(area.min), area)
    }
}

fn row_px(sheet: &Sheet) -> f32 {
    sheet.type_px(TYPE) * ROW_PITCH
}

fn column_px(sheet: &Sheet) -> f32 {
    sheet.px(COLUMNS.iter().sum())
}

/// The first place along the right edge, then the left, from the top, that overlaps no furniture.
fn free_place(size: Vec2, bounds: PixelBox, furniture: &[PixelBox]) -> Option<PixelBox> {
    let room = bounds.size() - size;
    if room.min_element() < 0.0 {
        return None;
    }
    let steps = (room.y / 8.0).floor() as u32;
    let across = [bounds.max.x - size.x, bounds.min.x];
    let places = across.into_iter().flat_map(|x| {
        (0..=steps)
            .map(move |step| PixelBox::at(Vec2::new(x, bounds.min.y + step as f32 * 8.0).floor(), size))
    });
    places.filter(|area| bounds.holds(area)).find(|area| !furniture.iter().any(|other| other.overlaps(area)))
}

/// The number of a symbol in the list, or the count of several, at their place.
pub(crate) struct SymbolBadge {
    anchor: Vec2,
    text: TypesetLine,
    /// Its box, from its middle.
    pub area: PixelBox,
    color: Srgba,
    is_on_map: bool,
    /// Whether it is a number of the list.
    pub is_listed: bool,
    /// The symbols for which it stands.
    pub names: Vec<String>,
}

/// Numbers for the first `rows` of the symbols and counts for the others, by place and color.
pub(crate) fn badges(left: &[&PictureSymbol], rows: usize, composer: &mut Composer) -> Vec<SymbolBadge> {
    let (listed, others) = left.split_at(left.len().min(rows));
    let side = composer.sheet.px(COUNTED_IN).max(composer.sheet.type_px(TYPE) * LEAST_COUNTED_IN).max(1.0);
    let mut counted: BTreeMap<(i64, i64, [u8; 4]), Vec<&PictureSymbol>> = BTreeMap::new();
    for symbol in others {
        let cell = (symbol.anchor_px / side).floor();
        counted.entry((cell.y as i64, cell.x as i64, color(symbol).0)).or_default().push(symbol);
    }
    let numbers: Vec<(String, bool, Vec<&PictureSymbol>)> = listed
        .iter()
        .enumerate()
        .map(|(index, symbol)| ((index + 1).to_string(), true, vec![*symbol]))
        .chain(counted.into_values().map(|symbols| (format!("×{}", symbols.len()), false, symbols)))
        .collect();
    numbers
        .into_iter()
        .map(|(text, is_listed, symbols)| {
            let style = composer.style(TYPE, TextStyle::BOLD);
            let text = composer.line(&text, style);
            let padding = composer.sheet.px(BADGE_PADDING).max(2.0);
            let half = (Vec2::new(text.advance, style.cap_px()) * 0.5 + Vec2::splat(padding)).ceil();
            SymbolBadge {
                anchor: symbols[0].anchor_px,
                text,
                area: PixelBox::around(Vec2::ZERO, half),
                color: color(symbols[0]),
                is_on_map: symbols[0].is_on_map,
                is_listed,
                names: symbols.iter().map(|symbol| symbol.name.clone()).collect(),
            }
        })
        .collect()
}

/// The color that a symbol's frame is filled with.
fn color(symbol: &PictureSymbol) -> Srgba {
    let fill = symbol.symbol.marks.iter().find_map(|mark| match mark {
        SymbolMark::Shape { fill, .. } => *fill,
        SymbolMark::Text { .. } => None,
    });
    fill.map_or(Srgba::WHITE, |[red, green, blue]| Srgba::opaque(red, green, blue))
}

impl SymbolBadge {
    /// How it stands.
    pub fn standing(&self) -> Standing {
        Standing {
            anchor: self.anchor,
            boxes: vec![self.area],
            face: self.area,
            ends_at_foot: false,
            may_cover_anchor: self.is_on_map,
        }
    }

    /// Draws its leader among the staffs, and itself among the faces.
    pub fn draw(
        &self,
        position: &StackPosition,
        sheet: &Sheet,
        (staffs, faces): (&mut Drawing, &mut Drawing),
    ) {
        let width = sheet.px(1.2).max(1.0);
        if let Some(PixelSegment { from, to }) = position.staff {
            staffs.line(PixelSegment { from, to }, width + sheet.px(2.0).max(1.4), HALO);
            staffs.line(PixelSegment { from, to }, width, BLACK);
            staffs.disc(from, sheet.px(2.4).max(1.8), BLACK);
        }
        let area = self.area.moved(position.foot);
        faces.rect(area, self.color);
        faces.frame(area, width.round().max(1.0), BLACK);
        let style = self.text.style;
        let at = position.foot + Vec2::new(-self.text.advance * 0.5, style.cap_px() * 0.5);
        faces.write(&self.text, at.round(), BLACK);
    }
}

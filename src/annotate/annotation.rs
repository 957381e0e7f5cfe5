//! The annotations of a picture, in picture coordinates.
//!
//! The caller has projected places to pixels and tested them against the depth buffer: annotations know neither scene
//! nor terrain.

use glam::Vec2;

use crate::class_legend::LegendEntry;
use crate::cover::SceneCover;
use crate::grid::PictureGrid;
use crate::legend::Legend;
use crate::margin::MarginNotes;
use crate::north::NorthArrow;
use crate::rim::RimMark;
use crate::scale_bar::ScaleBar;
use crate::sheet::Sheet;
use sandtable_description::words::{LabelKind, RoadShield};
use sandtable_draw::color::Srgba;
use sandtable_draw::font::FontFile;
use sandtable_symbology::symbol::MilitarySymbol;
use sandtable_symbology::texts::SymbolNote;

/// Everything to paint on one picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Annotations {
    /// Names and heights, in any order.
    pub labels: Vec<PictureLabel>,
    /// Names along lines, in any order.
    pub line_labels: Vec<LineLabel>,
    /// The strokes of rock, under all else.
    pub rock: Vec<TaperedStroke>,
    /// Numbers and ticks of contour lines.
    pub contours: Option<ContourMarks>,
    /// Texts of graphics, the more important first.
    pub fixed_texts: Vec<OverlayText>,
    /// The font for characters that the embedded fonts lack.
    pub font: Option<FontFile>,
    /// Coordinates along the edge of the block; those that come first are drawn first.
    pub rim: Vec<RimMark>,
    /// The coordinate grid on the ground, under everything else.
    pub grid: Option<PictureGrid>,
    /// The scale of azimuths of a panorama and the names over its skyline, placed before labels.
    pub panorama: Option<PanoramaMarks>,
    /// Military symbols, placed before labels.
    pub symbols: Vec<PictureSymbol>,
    /// The title, upper left.
    pub title: Option<String>,
    /// A second line under the title.
    pub subtitle: Option<String>,
    /// The north arrow, upper right.
    pub north: Option<NorthArrow>,
    /// The scale bar, lower left or under the title.
    pub scale_bar: Option<ScaleBar>,
    /// The elevation legend, lower right or under the north arrow.
    pub legend: Option<Legend>,
    /// The legend of the classes that the picture shows; on a sheet with a margin it is in the margin.
    pub classes: Vec<LegendEntry>,
    /// The source of the data, small along the lower border.
    pub credit: Option<String>,
    /// The content of the margin around the picture; furniture is then in the margin, and not on the picture.
    pub margin: Option<MarginNotes>,
    /// The part of the picture that shows the scene; scale bar and legend move from a lower corner to the top if they would cover
    /// the scene in the lower corner and less of it there.
    pub cover: Option<SceneCover>,
}

/// A stroke whose width changes evenly from its start to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct TaperedStroke {
    /// Its middle line, pixels.
    pub path_px: Vec<Vec2>,
    /// Its widths at its start and at its end, pixels.
    pub width_px: [f32; 2],
}

/// What a panorama has besides labels.
#[derive(Clone, Debug, PartialEq)]
pub struct PanoramaMarks {
    /// The azimuth of its left border, clockwise from north, degrees.
    pub from_deg: f64,
    /// How far round it reaches, degrees.
    pub span_deg: f64,
    /// The names over its skyline, the more important first.
    pub peaks: Vec<SkylineName>,
}

/// A name in the sky, with a line to what it names.
#[derive(Clone, Debug, PartialEq)]
pub struct SkylineName {
    /// The name; on a further line, in smaller type, a note on it.
    pub text: String,
    /// What it names, in pixels.
    pub at_px: Vec2,
    /// Whether the report says so where there is no place for it.
    pub is_wanted: bool,
}

/// A name whose letters follow a line on the picture: a river, a road, a phase line, the axis of an area.
#[derive(Clone, Debug, PartialEq)]
pub struct LineLabel {
    /// The name, on one line.
    pub text: String,
    /// The parts of the line that are seen: vertices in pixels from the picture's upper left corner, Y down, in either
    /// direction; the name is never upside down. Parts outside the picture are cut off.
    pub path_px: Vec<Vec<Vec2>>,
    /// Half of the width with which the line is drawn, in pixels; the name keeps clear of it, or stands inside a line
    /// that is wide enough. 0 for no width.
    pub half_width_px: f32,
    /// Where along the line.
    pub placement: LinePlacement,
    /// Decides type and color.
    pub kind: LabelKind,
    /// The color of the letters; `None` takes that of `kind`.
    pub ink: Option<Srgba>,
    /// The lower, the more important.
    pub rank: f64,
    /// The size of its letters, of the usual size of its kind.
    pub size: f32,
    /// The shield that the text stands in, level on the line.
    pub shield: Option<RoadShield>,
    /// The label drawn instead where the name finds no place along the line.
    pub fallback: Option<PictureLabel>,
}

/// A text that belongs to something drawn on the ground, level, in bold type.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayText {
    /// What it says, on one line or several.
    pub text: String,
    /// The place that it belongs to, in pixels.
    pub at_px: Vec2,
    /// On which side of that place it is, of any length; zero for a text centered on it.
    pub toward_px: Vec2,
    /// The color of the letters; `None` for black.
    pub ink: Option<Srgba>,
    /// Whether the place is seen.
    pub visible: bool,
}

/// The place of a name along its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinePlacement {
    /// Beside the line, repeated at intervals.
    Repeated,
    /// Beside the line, once, near the middle of its longest part.
    Once,
    /// On the line at both ends of each part, the line broken by the name's halo.
    Ends,
    /// On the line, its letters spaced over most of it.
    Spread,
    /// On the line, where it runs to the right, so that the tops of the letters point to its left.
    Uphill,
}

/// The numbers and ticks on the contour lines of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourMarks {
    /// Lines that may carry their number.
    pub numbered: Vec<NumberedContour>,
    /// Short strokes from lines round hollows, downhill, in pixels.
    pub ticks: Vec<[Vec2; 2]>,
    /// The color of the lines; numbers have it at full strength, darkened where that is needed to read them.
    pub color: Srgba,
}

/// A contour line seen on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberedContour {
    /// The elevation.
    pub text: String,
    /// The elevation as a number of intervals between numbered lines above 0.
    pub level: i64,
    /// In pixels, the higher ground to the left as one looks along it, X right and Y down.
    pub path_px: Vec<Vec2>,
}

/// A name at a place on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureLabel {
    /// The name; on further lines, in smaller type, notes on it.
    pub text: String,
    /// The place on the ground: pixels from the picture's upper left corner, Y down.
    pub anchor_px: Vec2,
    /// The upper end of the leader line; `None`, or a point not above the anchor, leaves its length to the placement.
    pub top_px: Option<Vec2>,
    /// Meters from the eye to the place; among labels of a rank and kind the nearer are placed first.
    pub depth_m: f32,
    /// Whether the place is seen, not hidden behind terrain.
    pub visible: bool,
    /// Decides type and symbol, and importance among labels of the same rank.
    pub kind: LabelKind,
    /// The lower, the more important.
    pub rank: f64,
    /// The size of its letters, of the usual size of its kind.
    pub size: f32,
}

/// A military symbol at a place on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSymbol {
    /// The drawing.
    pub symbol: MilitarySymbol,
    /// The lines of text round it.
    pub texts: Vec<SymbolNote>,
    /// What the report calls it.
    pub name: String,
    /// Where it is, as a list of symbols says it.
    pub reference: Option<String>,
    /// The place on the ground, pixels.
    pub anchor_px: Vec2,
    /// The direction of its movement on the picture, of length 1.
    pub direction_px: Option<Vec2>,
    /// Meters from the eye to the place.
    pub depth_m: f32,
    /// Whether the place is seen, not hidden behind terrain.
    pub visible: bool,
    /// Whether the symbol may be drawn at its place, as on a map, instead of on a staff over it.
    pub is_on_map: bool,
    /// The lower, the more important.
    pub rank: f64,
    /// The height of the frame of a friendly unit.
    pub height: SymbolHeight,
}

/// A height on the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SymbolHeight {
    /// Pixels of a picture 1080 pixels high.
    Design(f32),
    /// Pixels of the picture.
    Pixels(f32),
}

impl SymbolHeight {
    /// In pixels of a sheet's picture.
    pub(crate) fn pixels(self, sheet: &Sheet) -> f32 {
        match self {
            Self::Design(height) => sheet.px(height),
            Self::Pixels(height) => height,
        }
    }
}

#[cfg(test)]
pub(super) mod samples {
    use super::*;

    /// A place at a pixel.
    pub fn label(text: &str, x: f32, y: f32) -> PictureLabel {
        let anchor_px = Vec2::new(x, y);
        let text = text.to_owned();
        PictureLabel {
            text,
            anchor_px,
            top_px: None,
            depth_m: 1000.0,
            visible: true,
            kind: LabelKind::Place,
            rank: 0.0,
            size: 1.0,
        }
    }
}

//! The sheet and the typesetter that every piece of furniture, chart and map is composed with.

use crate::annotate::nice::{Ticks, format_number};
use crate::annotate::sheet::Sheet;
use crate::annotate::text::{TextLine, TextStyle, Typesetter};

/// A sheet with a typesetter.
pub struct Composer {
    /// Sizes.
    pub sheet: Sheet,
    /// Sets lines of text.
    pub typesetter: Typesetter,
}

impl Composer {
    /// The composer for a picture of `width` × `height` pixels.
    pub fn new(width: u32, height: u32) -> Self {
        Self { sheet: Sheet::new(width, height), typesetter: Typesetter::new() }
    }

    /// Upright type of `design_px` design pixels.
    pub fn style(&self, design_px: f32, weight: f32) -> TextStyle {
        TextStyle::upright(self.sheet.type_px(design_px), weight)
    }

    /// See [`Typesetter::line`].
    pub fn line(&mut self, text: &str, style: TextStyle) -> TextLine {
        self.typesetter.line(text, style)
    }

    /// See [`Typesetter::fitted`].
    pub fn fitted(&mut self, text: &str, style: TextStyle, most_px: f32) -> Option<TextLine> {
        self.typesetter.fitted(text, style, most_px)
    }

    /// The values of `ticks` with their figures.
    pub fn figures(&mut self, ticks: &Ticks, style: TextStyle) -> Vec<(f64, TextLine)> {
        let figure = |&value: &f64| (value, self.line(&format_number(value, ticks.decimals), style));
        ticks.values.iter().map(figure).collect()
    }
}

/// The width of the widest of `figures`.
pub fn widest(figures: &[(f64, TextLine)]) -> f32 {
    figures.iter().map(|(_, figure)| figure.advance).fold(0.0, f32::max)
}

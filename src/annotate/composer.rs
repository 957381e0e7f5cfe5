//! The layout context of all furniture, charts and maps: the sheet and the fonts.

use parley::fontique::{Collection, CollectionOptions, SourceCache};
use parley::{FontContext, LayoutContext};

use crate::fonts::{FontCut, register_fonts};
use crate::nice::{Ticks, format_number};
use crate::sheet::Sheet;
use crate::text::{TextStyle, TypesetLine};
use sandtable_draw::font::FontFile;

/// Lays out text on a sheet; holds tables of the embedded fonts and scratch space between lines.
pub struct Composer {
    pub sheet: Sheet,
    pub(super) fonts: FontContext,
    pub(super) layouts: LayoutContext<()>,
}

impl Composer {
    /// The composer for a picture of `width` × `height` pixels, with the embedded fonts and no others.
    pub fn new(width: u32, height: u32) -> Self {
        Self::with_font(width, height, None)
    }

    /// The composer with the embedded fonts, and `font` for characters that they lack.
    pub fn with_font(width: u32, height: u32, font: Option<&FontFile>) -> Self {
        let options = CollectionOptions { shared: false, system_fonts: false };
        let mut collection = Collection::new(options);
        register_fonts(&mut collection, font);
        let fonts = FontContext { collection, source_cache: SourceCache::default() };
        Self { sheet: Sheet::new(width, height), fonts, layouts: LayoutContext::new() }
    }

    /// Type of `design_px` design pixels.
    pub fn style(&self, design_px: f32, cut: FontCut) -> TextStyle {
        TextStyle::new(self.sheet.type_px(design_px), cut)
    }

    pub fn figures(&mut self, ticks: &Ticks, style: TextStyle) -> Vec<(f64, TypesetLine)> {
        let figure = |&value: &f64| (value, self.line(&format_number(value, ticks.decimals), style));
        ticks.values.iter().map(figure).collect()
    }
}

/// The width of the widest of `lines`.
pub fn widest<'a>(lines: impl IntoIterator<Item = &'a TypesetLine>) -> f32 {
    lines.into_iter().map(|line| line.advance).fold(0.0, f32::max)
}

//! Typesetting: converts a line of text to one outline, in the fonts embedded in the program.
//!
//! `parley` orders and shapes the line (right-to-left scripts, ligatures, kerning), `skrifa` reads the outlines, and the
//! result is one path whose baseline starts at the origin. Characters that the embedded fonts lack come from the font
//! that the scene names. The machine's own fonts are never used: a picture must not depend on the machine. Characters
//! that no font has appear as boxes and are counted.

use glam::Vec2;
use parley::GlyphRun;
use parley::layout::{Layout, PositionedLayoutItem};
use parley::style::StyleProperty;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use tiny_skia::{Path, PathBuilder};

use crate::composer::Composer;
use crate::drawing::{Drawing, box_of};
use crate::fonts::{FontCut, is_joined};
use crate::halo::Halo;
use crate::pixel_box::PixelBox;
use sandtable_draw::color::Srgba;

/// Height of capitals and figures above the baseline, in ems of the embedded font.
pub const CAP_HEIGHT: f32 = 0.714;
/// Depth of letters below the baseline, in ems of the embedded font.
pub const DESCENT: f32 = 0.24;

/// Longer lines are cut before they are shaped, which bounds the time of shaping: no picture has room for more.
const MOST_CHARACTERS: usize = 300;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextStyle {
    /// Height of the em in pixels.
    pub size_px: f32,
    pub cut: FontCut,
    /// Space added between letters, in ems.
    pub tracking: f32,
}

impl TextStyle {
    /// Running text on a panel.
    pub const REGULAR: FontCut = FontCut::Regular;
    /// Headings, and text on the picture itself, where halos thin the letters.
    pub const MEDIUM: FontCut = FontCut::Medium;
    /// Titles, and names on the picture.
    pub const BOLD: FontCut = FontCut::Bold;

    pub const fn new(size_px: f32, cut: FontCut) -> Self {
        Self { size_px, cut, tracking: 0.0 }
    }

    /// Height of capitals above the baseline, in pixels.
    pub fn cap_px(&self) -> f32 {
        self.size_px * CAP_HEIGHT
    }

    /// Space between letters in pixels: the tracking, and a little more for small type, whose letters would otherwise run
    /// together.
    fn tracking_px(&self) -> f32 {
        /// Larger type needs no extra space, in pixels.
        const SMALL_PX: f32 = 13.0;
        let small = (SMALL_PX - self.size_px).max(0.0) * 0.005;
        (self.tracking + small) * self.size_px
    }
}

#[derive(Clone, Debug)]
pub struct TypesetLine {
    /// Outline of all letters, baseline from the origin to the right; `None` where nothing shows.
    pub outline: Option<Path>,
    /// Width along the baseline, in pixels.
    pub advance: f32,
    /// Characters that the fonts lack; each shows as a box.
    pub missing: usize,
    pub shortened: bool,
    pub style: TextStyle,
}

/// A letter with its accents, or letters that are one glyph.
#[derive(Clone, Debug)]
pub struct TypesetLetter {
    /// Its outline, from the middle of its advance on the baseline; `None` for a space.
    pub outline: Option<Path>,
    /// The middle of its advance, from the start of the line, in pixels.
    pub middle: f32,
    pub advance: f32,
}

/// A line of text as letters from left to right, to be set along a curve.
#[derive(Clone, Debug)]
pub struct TypesetLetters {
    pub letters: Vec<TypesetLetter>,
    /// Width along the baseline, in pixels.
    pub advance: f32,
    /// Characters that the fonts lack; each shows as a box.
    pub missing: usize,
    /// Whether letters touch each other, as in Arabic, so that no space may come between them.
    pub is_joined: bool,
}

impl Composer {
    /// `text` as one line. Line ends and other control characters become spaces; text is cut after 300 characters.
    pub fn line(&mut self, text: &str, style: TextStyle) -> TypesetLine {
        let shortened = text.chars().nth(MOST_CHARACTERS).is_some();
        let layout = self.shape(&printable(text), style);
        let mut outliner = Outliner { path: PathBuilder::new(), at: Vec2::ZERO };
        let (mut missing, mut advance) = (0, 0.0f32);
        for item in layout.lines().next().into_iter().flat_map(|line| line.items()) {
            if let PositionedLayoutItem::GlyphRun(run) = item {
                missing += draw_run(&run, &mut outliner);
                advance = advance.max(run.offset() + run.advance());
            }
        }
        TypesetLine { outline: outliner.path.finish(), advance, missing, shortened, style }
    }

    /// The letters of `text` on one line. Line ends and other control characters become spaces; text is cut after 300
    /// characters.
    pub fn letters(&mut self, text: &str, style: TextStyle) -> TypesetLetters {
        let layout = self.shape(&printable(text), style);
        let mut set =
            TypesetLetters { letters: Vec::new(), advance: 0.0, missing: 0, is_joined: is_joined(text) };
        for item in layout.lines().next().into_iter().flat_map(|line| line.items()) {
            if let PositionedLayoutItem::GlyphRun(run) = item {
                set.missing += add_letters(&run, &mut set.letters);
                set.advance = set.advance.max(run.offset() + run.advance());
            }
        }
        set
    }

    pub(super) fn shape(&mut self, text: &str, style: TextStyle) -> Layout<()> {
        let mut builder = self.layouts.ranged_builder(&mut self.fonts, text, 1.0, false);
        builder.push_default(StyleProperty::FontFamily(style.cut.families()));
        builder.push_default(StyleProperty::FontSize(style.size_px));
        // Space would part letters that are joined.
        let tracking = if is_joined(text) { 0.0 } else { style.tracking_px() };
        builder.push_default(StyleProperty::LetterSpacing(tracking));
        let mut layout = builder.build(text);
        layout.break_all_lines(None);
        layout
    }
}

impl TypesetLine {
    /// The smallest box around the letters with a halo of `halo` pixels, baseline from the origin;
    /// [`PixelBox::EMPTY`] where nothing shows.
    pub fn bounds(&self, halo: f32) -> PixelBox {
        self.outline.as_ref().map_or(PixelBox::EMPTY, |path| box_of(path).grown(halo))
    }

    fn outline_at(&self, at: Vec2) -> Option<Path> {
        self.outline.clone()?.transform(tiny_skia::Transform::from_translate(at.x, at.y))
    }
}

impl Drawing {
    pub fn write(&mut self, line: &TypesetLine, at: Vec2, color: Srgba) {
        if let Some(path) = line.outline_at(at) {
            self.fill(path, color);
        }
    }

    /// Writes a line on a halo reaching `reach` pixels around its letters.
    pub fn write_haloed(&mut self, line: &TypesetLine, at: Vec2, reach: f32, color: Srgba) {
        self.draw_halo(&[(line, at)], Halo::paper(reach));
        self.write(line, at, color);
    }

    /// Draws one halo under all of `lines`. Drawn before any line is written, it covers no neighbor's letters, and has one
    /// even tone where lines are close.
    pub fn draw_halo(&mut self, lines: &[(&TypesetLine, Vec2)], halo: Halo) {
        let mut all = PathBuilder::new();
        for path in lines.iter().filter_map(|(line, at)| line.outline_at(*at)) {
            all.push_path(&path);
        }
        if let Some(all) = all.finish() {
            self.stroke(&all, halo.reach_px * 2.0, halo.color);
        }
    }
}

/// The first characters of `text`, control characters as spaces.
fn printable(text: &str) -> String {
    text.chars().take(MOST_CHARACTERS).map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Adds the letters of `run` from left to right; returns the number of glyphs that the font lacks. A glyph without
/// advance, an accent, belongs to the letter on whose origin it stands: the one before it in a line from left to right,
/// the one after it in a line from right to left.
fn add_letters(run: &GlyphRun<'_, ()>, letters: &mut Vec<TypesetLetter>) -> usize {
    let font = run.run().font();
    let Ok(tables) = FontRef::from_index(font.data.data(), font.index) else { return 0 };
    let outlines = tables.outline_glyphs();
    let size = Size::new(run.run().font_size());
    let is_rtl = run.run().is_rtl();
    let glyphs: Vec<_> = run.glyphs().collect();
    let (mut missing, mut pen, mut next) = (0, run.offset(), 0);
    while next < glyphs.len() {
        let is_accent = |index: usize| glyphs.get(index).is_some_and(|glyph| glyph.advance.abs() < 1e-3);
        // The glyphs of one letter: one with an advance, and the accents before or after it.
        let mut end = next;
        if is_rtl {
            while is_accent(end) && end + 1 < glyphs.len() {
                end += 1;
            }
            end += 1;
        } else {
            end += 1;
            while is_accent(end) {
                end += 1;
            }
        }
        let advance: f32 = glyphs[next..end].iter().map(|glyph| glyph.advance).sum();
        let mut outliner = Outliner { path: PathBuilder::new(), at: Vec2::ZERO };
        let mut x = -0.5 * advance;
        for glyph in &glyphs[next..end] {
            missing += usize::from(glyph.id == 0);
            outliner.at = Vec2::new(x + glyph.x, glyph.y);
            if let Some(outline) = outlines.get(GlyphId::new(glyph.id)) {
                // As in `draw_run`: a broken outline leaves a gap.
                let _ = outline.draw(DrawSettings::unhinted(size, LocationRef::default()), &mut outliner);
            }
            x += glyph.advance;
        }
        letters.push(TypesetLetter { outline: outliner.path.finish(), middle: pen + 0.5 * advance, advance });
        pen += advance;
        next = end;
    }
    missing
}

/// Adds the outlines of `run`, relative to its baseline; returns the number of glyphs that the font lacks.
fn draw_run(run: &GlyphRun<'_, ()>, outliner: &mut Outliner) -> usize {
    let font = run.run().font();
    let Ok(tables) = FontRef::from_index(font.data.data(), font.index) else { return 0 };
    let outlines = tables.outline_glyphs();
    let size = Size::new(run.run().font_size());
    let mut missing = 0;
    for glyph in run.positioned_glyphs() {
        missing += usize::from(glyph.id == 0);
        outliner.at = Vec2::new(glyph.x, glyph.y - run.baseline());
        if let Some(outline) = outlines.get(GlyphId::new(glyph.id)) {
            // A glyph with a broken outline leaves a gap; the embedded fonts have none.
            let _ = outline.draw(DrawSettings::unhinted(size, LocationRef::default()), outliner);
        }
    }
    missing
}

/// Collects glyph outlines (Y up, from the glyph's origin) into one path (Y down, from the line's start).
struct Outliner {
    path: PathBuilder,
    at: Vec2,
}

impl Outliner {
    fn map(&self, x: f32, y: f32) -> Vec2 {
        self.at + Vec2::new(x, -y)
    }
}

impl OutlinePen for Outliner {
    fn move_to(&mut self, x: f32, y: f32) {
        let to = self.map(x, y);
        self.path.move_to(to.x, to.y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.map(x, y);
        self.path.line_to(to.x, to.y);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let (control, to) = (self.map(cx, cy), self.map(x, y));
        self.path.quad_to(control.x, control.y, to.x, to.y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let (first, second, to) = (self.map(ax, ay), self.map(bx, by), self.map(x, y));
        self.path.cubic_to(first.x, first.y, second.x, second.y, to.x, to.y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(text: &str) -> TypesetLine {
        Composer::new(100, 100).line(text, TextStyle::new(20.0, FontCut::Regular))
    }

    #[test]
    fn capitals_stand_on_the_baseline_as_high_as_the_constant_says() {
        let ink = box_of(&set("HEIH").outline.expect("letters"));
        assert!(ink.max.y.abs() < 0.01, "{ink:?}");
        assert!((ink.min.y + CAP_HEIGHT * 20.0).abs() < 0.05, "{ink:?}");
    }

    #[test]
    fn latin_greek_and_cyrillic_names_and_the_signs_of_maps_are_all_there() {
        for text in ["Žďár nad Sázavou", "Όλυμπος 2918 m", "Эльбрус", "−12.5 °C ×1.5 → ′ ″ ▲ …"]
        {
            assert_eq!(set(text).missing, 0, "{text}");
        }
    }

    #[test]
    fn characters_the_fonts_lack_are_counted_and_shown_as_boxes() {
        let line = set("富士山");
        assert_eq!(line.missing, 3);
        assert!(line.outline.is_some());
        assert_eq!(set("הר 3").missing, 2);
    }

    #[test]
    fn invisible_and_control_characters_are_neither_shown_nor_missing() {
        for text in ["", " ", "\u{200b}", "\u{200f}\u{2066}\u{2069}", "\t\r\n\u{7}", "\u{feff}"] {
            let line = set(text);
            assert_eq!((line.missing, line.outline.is_some()), (0, false), "{text:?}");
        }
    }

    #[test]
    fn a_line_end_inside_a_line_is_a_space() {
        assert!((set("a\nb").advance - set("a b").advance).abs() < 1e-3);
    }

    #[test]
    fn endless_text_is_cut() {
        let line = set(&"m".repeat(100_000));
        assert!(line.shortened && line.advance < 300.0 * 20.0);
    }

    #[test]
    fn the_letters_of_a_line_are_the_line() {
        for text in ["Clear Fork", "Žďa\u{301}r", "Όλυμπος 2918 m"] {
            let mut composer = Composer::new(100, 100);
            let style = TextStyle::new(20.0, FontCut::Italic);
            let line = composer.line(text, style);
            let letters = composer.letters(text, style);
            assert!((line.advance - letters.advance).abs() < 1e-3);
            let put = |letter: &TypesetLetter| {
                let shift = tiny_skia::Transform::from_translate(letter.middle, 0.0);
                Some(box_of(&letter.outline.clone()?.transform(shift)?))
            };
            let all = letters.letters.iter().filter_map(put).fold(PixelBox::EMPTY, PixelBox::union);
            let whole = box_of(&line.outline.expect("letters"));
            assert!((all.min - whole.min).length() + (all.max - whole.max).length() < 0.01, "{text}");
        }
    }

    #[test]
    fn figures_are_of_one_width_in_every_cut() {
        use FontCut::{Bold, Condensed, Italic, Medium, Regular};
        for cut in [Regular, Medium, Bold, Italic, Condensed] {
            let width = |text: &str| {
                let line = Composer::new(100, 100).line(text, TextStyle::new(20.0, cut));
                assert_eq!(line.missing, 0, "{cut:?}");
                line.advance
            };
            for figure in '0'..='9' {
                // A unit of the em, as rounding leaves it.
                assert!((width(&figure.to_string()) - width("0")).abs() < 0.021, "{cut:?} {figure}");
            }
        }
    }

    #[test]
    fn the_cuts_are_five_different_drawings_and_kern_their_letters() {
        let width = |text: &str, cut| Composer::new(9, 9).line(text, TextStyle::new(20.0, cut)).advance;
        let [light, medium, bold, condensed] =
            [FontCut::Regular, FontCut::Medium, FontCut::Bold, FontCut::Condensed]
                .map(|cut| width("Hamburg", cut));
        assert!(condensed < light && light < medium && medium < bold, "{condensed} {light} {medium} {bold}");
        for cut in [FontCut::Regular, FontCut::Italic, FontCut::Condensed] {
            assert!(width("To", cut) < width("T", cut) + width("o", cut) - 0.5, "{cut:?}");
        }
    }
}

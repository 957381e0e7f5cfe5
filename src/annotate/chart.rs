//! A chart's frame: title, axes with nice ticks and units, and the scale between meters and pixels.
//!
//! ```text
//!   title                                     note
//!   ┌──────────────────────────────────────────┐
//! h │                  plot                    │
//!   └──────────────────────────────────────────┘
//!   0        ticks along the line              5
//!   start            axis label              end
//! ```
//!
//! [`chart_profile`](crate::chart_profile) and [`chart_sight`](crate::chart_sight) draw the plot.

use glam::Vec2;

use crate::canvas::paint;
use crate::composer::{Composer, widest};
use crate::drawing::Drawing;
use crate::nice::{Ticks, format_trimmed};
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::sheet::{INK, PAPER, SOFT_INK, Sheet};
use crate::text::{TextStyle, TypesetLine};
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// The plot's background: a pale sky.
const SKY: Srgba = Srgba::opaque(0xee, 0xf2, 0xf3);
const GRID: Srgba = Srgba([0x1e, 0x23, 0x27, 0x1c]);
/// Distances from this one on are counted in kilometers.
const KILOMETERS_FROM_M: f64 = 5000.0;
/// The least range of heights, as a share of the line's length: level ground must not be stretched into mountains.
const LEAST_RELIEF: f64 = 1.0 / 400.0;
/// Space below the lowest and above the highest height, as a share of the relief: for labels and a strip of ground.
const SPACE: f64 = 0.16;
/// Height of the title and of the subtitle, in design pixels.
const TITLE_SIZES: [f32; 2] = [26.0, 17.0];

/// The texts around the plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartText {
    /// Upper left, large.
    pub title: String,
    /// Below the title: a sentence about the chart.
    pub subtitle: String,
    /// The quantity of the upward axis, with its unit.
    pub height_axis: String,
    /// The quantity of the axis along the line, without its unit.
    pub along_axis: String,
    /// The name of the line's start; below the axis.
    pub start: String,
    /// The name of its end.
    pub end: String,
}

/// The scale between meters and pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartFrame {
    /// Where things are plotted.
    pub plot: PixelBox,
    /// Meters along the line at the plot's right edge; 0 at its left.
    length_m: f64,
    /// Heights at the plot's lower and upper edge.
    heights_m: (f64, f64),
}

impl ChartFrame {
    /// The pixel position of a point `along_m` along the line and `height_m` high.
    pub fn at(&self, along_m: f64, height_m: f64) -> Vec2 {
        let size = self.plot.size();
        let right = along_m / self.length_m;
        let up = (height_m - self.heights_m.0) / (self.heights_m.1 - self.heights_m.0);
        Vec2::new(self.plot.min.x + right as f32 * size.x, self.plot.max.y - up as f32 * size.y)
    }

    /// The factor by which heights are stretched against distances.
    pub fn exaggeration(&self) -> f64 {
        let size = self.plot.size();
        let up = f64::from(size.y) / (self.heights_m.1 - self.heights_m.0);
        up / (f64::from(size.x) / self.length_m)
    }
}

/// A chart being painted.
pub struct Chart {
    /// Sizes and type.
    pub composer: Composer,
    /// The scale.
    pub frame: ChartFrame,
    /// Drawn below the plot.
    background: Drawing,
    /// The plot.
    pub plotted: Drawing,
}

impl Chart {
    /// Begins a chart of `size` pixels for a line `length_m` long and heights from `low_m` to `high_m`.
    ///
    /// A range that is not finite, and a line without length, are charted as one meter.
    pub fn new(
        (width, height): (u32, u32),
        text: &ChartText,
        length_m: f64,
        (low_m, high_m): (f64, f64),
    ) -> Self {
        let mut composer = Composer::new(width, height);
        let sheet = composer.sheet;
        let length_m = if length_m.is_finite() && length_m > 0.0 { length_m } else { 1.0 };
        let heights_m = height_range((low_m, high_m), length_m);
        let (top, bottom) = plot_rows(&sheet, text);
        let figures = height_figures(heights_m, bottom - top, &mut composer);
        let left =
            (margin(&sheet) + widest(figures.iter().map(|(_, figure)| figure)) + sheet.px(12.0)).round();
        let right = (sheet.size.x - margin(&sheet) - sheet.px(12.0)).round().max(left + 8.0);
        let plot = PixelBox { min: Vec2::new(left, top), max: Vec2::new(right, bottom) };
        let mut background = Drawing::default();
        background.rect(sheet.bounds(), PAPER);
        background.rect(plot, SKY);
        let frame = ChartFrame { plot, length_m, heights_m };
        let mut chart = Self { composer, frame, background, plotted: Drawing::default() };
        chart.draw_titles(text);
        chart.draw_height_axis(text, &figures);
        chart.draw_along_axis(text);
        chart
    }

    /// Writes `text` with its baseline starting at `at`, cut to `most_px`.
    fn write_fitted(&mut self, text: &str, style: TextStyle, at: Vec2, most_px: f32, color: Srgba) {
        if let Some(line) = self.composer.fitted(text, style, most_px) {
            self.background.write(&line, at, color);
        }
    }

    fn draw_titles(&mut self, text: &ChartText) {
        let (margin, plot) = (margin(&self.composer.sheet), self.frame.plot);
        let [title_size, subtitle_size] = TITLE_SIZES;
        let width = plot.max.x - margin;
        let style = self.composer.style(title_size, TextStyle::MEDIUM);
        let baseline = margin + style.cap_px();
        self.write_fitted(&text.title, style, Vec2::new(margin, baseline), width, INK);
        if !text.subtitle.is_empty() {
            let style = self.composer.style(subtitle_size, TextStyle::REGULAR);
            let at = Vec2::new(margin, baseline + (style.size_px * 1.6).round());
            self.write_fitted(&text.subtitle, style, at, width, SOFT_INK);
        }
        let stretched = format!("heights ×{}", format_trimmed(self.frame.exaggeration(), 1));
        let note = self.composer.line(&stretched, figure_style(&self.composer));
        let at = Vec2::new(plot.max.x - note.advance, plot.min.y - note.style.size_px * 0.95);
        self.background.write(&note, at.round(), SOFT_INK);
    }

    fn draw_height_axis(&mut self, text: &ChartText, figures: &[(f64, TypesetLine)]) {
        let (sheet, frame, style) = (self.composer.sheet, self.frame, figure_style(&self.composer));
        for (height_m, figure) in figures {
            let y = frame.at(0.0, *height_m).y.round();
            self.draw_grid_line(Vec2::new(frame.plot.min.x, y), Vec2::new(frame.plot.max.x, y));
            let x = frame.plot.min.x - sheet.px(8.0) - figure.advance;
            self.background.write(figure, Vec2::new(x, y + style.cap_px() * 0.5), INK);
        }
        let at = Vec2::new(margin(&sheet), frame.plot.min.y - style.size_px * 0.95).round();
        self.write_fitted(&text.height_axis, style, at, frame.plot.size().x * 0.7, SOFT_INK);
    }

    fn draw_along_axis(&mut self, text: &ChartText) {
        let (sheet, frame, style) = (self.composer.sheet, self.frame, figure_style(&self.composer));
        let PixelBox { min, max } = frame.plot;
        let (unit_m, unit) = if frame.length_m >= KILOMETERS_FROM_M { (1000.0, "km") } else { (1.0, "m") };
        let most = (frame.plot.size().x / (style.size_px * 7.0)) as usize;
        let ticks = Ticks::new(0.0, frame.length_m / unit_m, most.clamp(2, 12));
        let baseline = max.y + sheet.px(8.0) + style.cap_px();
        for (value, figure) in self.composer.figures(&ticks, style) {
            let x = frame.at(value * unit_m, 0.0).x.round();
            self.draw_grid_line(Vec2::new(x, min.y), Vec2::new(x, max.y + sheet.px(5.0)));
            self.background.write(&figure, Vec2::new(x - figure.advance * 0.5, baseline), INK);
        }
        let below = (baseline + style.size_px * 1.9).round();
        let label = self.composer.line(&format!("{} ({unit})", text.along_axis), style);
        let label_at = Vec2::new(frame.plot.center().x - label.advance * 0.5, below);
        self.background.write(&label, label_at, SOFT_INK);
        let width = (frame.plot.size().x - label.advance) * 0.5 - style.size_px * 2.0;
        self.write_fitted(&text.start, style, Vec2::new(min.x, below), width, INK);
        if let Some(end) = self.composer.fitted(&text.end, style, width) {
            self.background.write(&end, Vec2::new(max.x - end.advance, below), INK);
        }
    }

    fn draw_grid_line(&mut self, from: Vec2, to: Vec2) {
        // A line one pixel wide is crisp where its middle is a pixel's.
        let line = PixelSegment { from: from + 0.5, to: to + 0.5 };
        self.background.line(line, self.composer.sheet.hairline(), GRID);
    }

    /// Writes text beside a point, moved aside where it would leave the plot.
    pub fn label(&mut self, text: &str, at: Vec2, side: LabelSide, color: Srgba) {
        let style = self.composer.style(15.0, TextStyle::MEDIUM);
        let line = self.composer.line(text, style);
        let sheet = self.composer.sheet;
        let away = sheet.px(11.0);
        let plot = self.frame.plot.grown(-sheet.px(6.0));
        let most = (plot.max.x - line.advance).max(plot.min.x);
        let x = (at.x - line.advance * 0.5).clamp(plot.min.x, most);
        let y = match side {
            LabelSide::Above => at.y - away,
            LabelSide::WellAbove => at.y - away - style.size_px * 2.4,
            LabelSide::Below => at.y + away + style.cap_px(),
        };
        let least = plot.min.y + style.cap_px();
        let at = Vec2::new(x, y.clamp(least, plot.max.y.max(least))).round();
        self.plotted.write_haloed(&line, at, sheet.px(3.0), color);
    }

    /// Draws a tick across the plot's lower edge, where the line bends.
    pub fn tick_below(&mut self, along_m: f64) {
        let sheet = self.composer.sheet;
        let at = Vec2::new(self.frame.at(along_m, 0.0).x.round(), self.frame.plot.max.y);
        let down = Vec2::new(0.0, sheet.px(7.0));
        self.plotted.line(PixelSegment { from: at - down, to: at + down }, sheet.px(1.5).max(1.0), INK);
    }

    /// Draws a dot in a ring of paper.
    pub fn dot(&mut self, at: Vec2, color: Srgba) {
        self.plotted.disc(at, self.composer.sheet.px(6.5), PAPER);
        self.plotted.disc(at, self.composer.sheet.px(4.5), color);
    }

    /// Paints the chart.
    pub fn finish(mut self) -> Pixels {
        let sheet = self.composer.sheet;
        self.plotted.frame(self.frame.plot.grown(sheet.hairline()), sheet.hairline().round(), SOFT_INK);
        let mut pixels = Pixels::filled(sheet.size.x as u32, sheet.size.y as u32, PAPER);
        paint(&mut pixels, [&self.background, &self.plotted]);
        pixels
    }
}

/// The heights at the plot's edges.
fn height_range((low_m, high_m): (f64, f64), length_m: f64) -> (f64, f64) {
    let (low_m, high_m) =
        if low_m <= high_m && (high_m - low_m).is_finite() { (low_m, high_m) } else { (0.0, 1.0) };
    let least_m = (length_m * LEAST_RELIEF).max(1.0);
    let short_m = (least_m - (high_m - low_m)).max(0.0);
    let (low_m, high_m) = (low_m - short_m * 0.5, high_m + short_m * 0.5);
    let relief_m = high_m - low_m;
    (low_m - SPACE * relief_m, high_m + SPACE * relief_m)
}

fn margin(sheet: &Sheet) -> f32 {
    sheet.whole_px(30.0)
}

fn figure_style(composer: &Composer) -> TextStyle {
    composer.style(15.0, TextStyle::REGULAR)
}

fn height_figures(heights_m: (f64, f64), height_px: f32, composer: &mut Composer) -> Vec<(f64, TypesetLine)> {
    let style = figure_style(composer);
    let most = (height_px / (style.size_px * 3.2)) as usize;
    composer.figures(&Ticks::new(heights_m.0, heights_m.1, most.clamp(2, 9)), style)
}

/// The plot's upper and lower edge: above it titles and the height axis's label, below it figures and the line of
/// start, axis label and end.
fn plot_rows(sheet: &Sheet, text: &ChartText) -> (f32, f32) {
    let [title, subtitle] = TITLE_SIZES.map(|size| sheet.type_px(size));
    let figure = sheet.type_px(15.0);
    let titles = title * 1.25 + if text.subtitle.is_empty() { 0.0 } else { subtitle * 1.5 } + sheet.px(26.0);
    let top = (margin(sheet) + titles + figure * 1.5).round();
    (top, (sheet.size.y - margin(sheet) - figure * 3.6).round().max(top + 8.0))
}

/// The side of a point on which its label stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelSide {
    /// Above its point.
    Above,
    /// Above another label above its point.
    WellAbove,
    /// Below it.
    Below,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart_ground::ChartPoint;
    use crate::chart_profile::{ProfileChart, paint};
    use sandtable_raster::answer::Answer;

    fn chart(heights: &[f64]) -> ProfileChart {
        let point = |(index, &height): (usize, &f64)| ChartPoint {
            along_m: index as f64 * 100.0,
            ground: if height.is_nan() { Answer::NoData } else { Answer::Height(height) },
        };
        let text = ChartText { title: "Profile".into(), ..ChartText::default() };
        ProfileChart { text, points: heights.iter().enumerate().map(point).collect(), bends_m: vec![] }
    }

    #[test]
    fn heights_rise_upward_and_distances_to_the_right_within_the_plot() {
        let chart = Chart::new((800, 400), &ChartText::default(), 1000.0, (100.0, 300.0));
        let (low, high) = (chart.frame.at(0.0, 100.0), chart.frame.at(1000.0, 300.0));
        assert!(low.x == chart.frame.plot.min.x && high.x == chart.frame.plot.max.x);
        assert!(high.y < low.y && chart.frame.plot.contains(Vec2::new(low.x + 1.0, high.y)));
    }

    #[test]
    fn the_stretch_of_heights_is_that_of_the_scales() {
        let frame = Chart::new((800, 400), &ChartText::default(), 1000.0, (0.0, 100.0)).frame;
        let right = frame.at(1.0, 0.0).x - frame.at(0.0, 0.0).x;
        let up = frame.at(0.0, 0.0).y - frame.at(0.0, 1.0).y;
        assert!((frame.exaggeration() / f64::from(up / right) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn level_ground_is_not_stretched_into_mountains() {
        let frame = Chart::new((800, 400), &ChartText::default(), 10_000.0, (50.0, 50.001)).frame;
        assert!(frame.exaggeration() < 400.0);
    }

    #[test]
    fn ground_is_filled_sky_is_not_and_a_gap_is_neither() {
        let pixels = paint((800, 400), &chart(&[100.0, 100.0, f64::NAN, 100.0, 100.0]));
        let text = ChartText { title: "Profile".into(), ..ChartText::default() };
        let frame = Chart::new((800, 400), &text, 400.0, (100.0, 100.0)).frame;
        let color = |along_m: f64, up: f32| {
            let at = frame.at(along_m, 100.0) - Vec2::new(0.0, up);
            pixels.at(at.x as u32, at.y as u32)
        };
        let (ground, sky, gap) = (color(50.0, -20.0), color(50.0, 20.0), color(203.0, -20.0));
        assert!(ground != sky && gap != ground, "{ground:?} {sky:?} {gap:?}");
    }

    #[test]
    fn the_smallest_and_the_emptiest_charts_are_painted() {
        for size in [(16, 16), (40, 16), (16, 300)] {
            for heights in [&[][..], &[1.0], &[f64::NAN, f64::NAN], &[1e7, -1e7]] {
                assert_eq!(paint(size, &chart(heights)).width(), size.0);
            }
        }
    }
}

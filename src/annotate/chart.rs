//! A chart's frame: title, axes with round ticks and units, and the scale between meters and pixels.
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
//! What is drawn in the plot is up to [`chart_profile`](crate::annotate::chart_profile) and
//! [`chart_sight`](crate::annotate::chart_sight).

use glam::Vec2;

use crate::annotate::canvas::Canvas;
use crate::annotate::drawing::Drawing;
use crate::annotate::nice::{format_number, format_trimmed, ticks};
use crate::annotate::paragraph::fitted;
use crate::annotate::pixel_box::{PixelBox, PixelSegment};
use crate::annotate::sheet::{INK, PAPER, SOFT_INK, Sheet};
use crate::annotate::text::{CAP_HEIGHT, TextLine, TextStyle, Typesetter, halos, write};
use crate::draw::color::Srgba;
use crate::draw::pixels::Pixels;

/// The plot's ground, where there is nothing: a pale sky.
const SKY: Srgba = Srgba::opaque(0xee, 0xf2, 0xf3);
/// Lines at round heights and distances.
const GRID: Srgba = Srgba([0x1e, 0x23, 0x27, 0x1c]);
/// Distances from this one on are counted in kilometers.
const KILOMETERS_FROM_M: f64 = 5000.0;
/// Ground this level, as a share of the line's length, is not stretched to the plot's full height: noise is no mountain.
const LEAST_RELIEF: f64 = 1.0 / 400.0;
/// Room below the lowest and above the highest height, as shares of the relief: for labels, and for the ground to stand
/// on something.
const ROOM: (f64, f64) = (0.16, 0.16);

/// What stands around the plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartText {
    /// Upper left, large.
    pub title: String,
    /// Below the title: a sentence about what is seen.
    pub subtitle: String,
    /// What the upward axis counts, with its unit.
    pub height_axis: String,
    /// What the axis along the line counts, without its unit.
    pub along_axis: String,
    /// What the line starts at; below the axis.
    pub start: String,
    /// What it ends at.
    pub end: String,
}

/// Between meters and pixels.
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
    /// Where something `along_m` along the line and `height_m` high is.
    pub fn at(&self, along_m: f64, height_m: f64) -> Vec2 {
        let size = self.plot.size();
        let right = along_m / self.length_m;
        let up = (height_m - self.heights_m.0) / (self.heights_m.1 - self.heights_m.0);
        Vec2::new(self.plot.min.x + right as f32 * size.x, self.plot.max.y - up as f32 * size.y)
    }

    /// How many times heights are stretched against distances.
    pub fn exaggeration(&self) -> f64 {
        let size = self.plot.size();
        let up = f64::from(size.y) / (self.heights_m.1 - self.heights_m.0);
        up / (f64::from(size.x) / self.length_m)
    }
}

/// A chart being painted.
pub struct Chart {
    /// Sizes.
    pub sheet: Sheet,
    /// Type.
    pub setter: Typesetter,
    /// Where things are.
    pub frame: ChartFrame,
    /// What lies under what is plotted.
    pub below: Drawing,
    /// What is plotted.
    pub plotted: Drawing,
}

/// Begins a chart of `size` pixels for a line `length_m` long and heights from `low_m` to `high_m`.
///
/// What is not finite, or a line without length, is charted as a meter.
pub fn begin(size: (u32, u32), around: &ChartText, length_m: f64, (low_m, high_m): (f64, f64)) -> Chart {
    let sheet = Sheet::new(size.0, size.1);
    let mut setter = Typesetter::new();
    let length_m = if length_m.is_finite() && length_m > 0.0 { length_m } else { 1.0 };
    let heights_m = range((low_m, high_m), length_m);
    let plot = plot_box(&sheet, around, heights_m, &mut setter);
    let frame = ChartFrame { plot, length_m, heights_m };
    let mut below = Drawing::default();
    below.rect(sheet.bounds(), PAPER);
    below.rect(plot, SKY);
    let mut chart = Chart { sheet, setter, frame, below, plotted: Drawing::default() };
    chart.titles(around);
    chart.height_axis(around);
    chart.along_axis(around);
    chart
}

/// The heights at the plot's edges.
fn range((low_m, high_m): (f64, f64), length_m: f64) -> (f64, f64) {
    let (low_m, high_m) =
        if low_m <= high_m && (high_m - low_m).is_finite() { (low_m, high_m) } else { (0.0, 1.0) };
    let least_m = (length_m * LEAST_RELIEF).max(1.0);
    let short_m = (least_m - (high_m - low_m)).max(0.0);
    let (low_m, high_m) = (low_m - short_m * 0.5, high_m + short_m * 0.5);
    let relief_m = high_m - low_m;
    (low_m - ROOM.0 * relief_m, high_m + ROOM.1 * relief_m)
}

fn figures(sheet: &Sheet) -> TextStyle {
    TextStyle::upright(sheet.type_px(15.0), TextStyle::REGULAR)
}

fn height_ticks(sheet: &Sheet, heights_m: (f64, f64), height_px: f32) -> (Vec<f64>, usize) {
    let most = (height_px / (figures(sheet).size_px * 3.2)) as usize;
    ticks(heights_m.0, heights_m.1, most.clamp(2, 9))
}

fn plot_box(
    sheet: &Sheet,
    around: &ChartText,
    heights_m: (f64, f64),
    setter: &mut Typesetter,
) -> PixelBox {
    let figure_px = figures(sheet).size_px;
    let margin = sheet.whole_px(30.0);
    let titles = sheet.type_px(26.0) * 1.25
        + if around.subtitle.is_empty() { 0.0 } else { sheet.type_px(17.0) * 1.5 }
        + sheet.px(26.0);
    // Above the plot its height's label; below it figures and the line of start, axis label and end.
    let top = (margin + titles + figure_px * 1.5).round();
    let bottom = (sheet.size.y - margin - figure_px * 3.6).round().max(top + 8.0);
    let (heights, decimals) = height_ticks(sheet, heights_m, bottom - top);
    let widest = heights
        .iter()
        .map(|&height| setter.line(&format_number(height, decimals), figures(sheet)).advance)
        .fold(0.0, f32::max);
    let left = (margin + widest + sheet.px(12.0)).round();
    let right = (sheet.size.x - margin - sheet.px(12.0)).round().max(left + 8.0);
    PixelBox { min: Vec2::new(left, top), max: Vec2::new(right, bottom) }
}

impl Chart {
    fn titles(&mut self, around: &ChartText) {
        let (sheet, plot) = (self.sheet, self.frame.plot);
        let margin = sheet.whole_px(30.0);
        let title = TextStyle::upright(sheet.type_px(26.0), TextStyle::MEDIUM);
        let stretched = format!("heights ×{}", format_trimmed(self.frame.exaggeration(), 1));
        let note = self.setter.line(&stretched, figures(&sheet));
        let baseline = margin + title.size_px * CAP_HEIGHT;
        let room = plot.max.x - margin;
        if let Some(line) = fitted(&mut self.setter, &around.title, title, room) {
            write(&mut self.below, &[(&line, Vec2::new(margin, baseline))], INK);
        }
        if !around.subtitle.is_empty() {
            let face = TextStyle::upright(sheet.type_px(17.0), TextStyle::REGULAR);
            let at = Vec2::new(margin, baseline + (face.size_px * 1.6).round());
            if let Some(line) = fitted(&mut self.setter, &around.subtitle, face, room) {
                write(&mut self.below, &[(&line, at)], SOFT_INK);
            }
        }
        let at = Vec2::new(plot.max.x - note.advance, plot.min.y - note.style.size_px * 0.95);
        write(&mut self.below, &[(&note, at.round())], SOFT_INK);
    }

    fn height_axis(&mut self, around: &ChartText) {
        let (sheet, frame) = (self.sheet, self.frame);
        let face = figures(&sheet);
        let (heights, decimals) = height_ticks(&sheet, frame.heights_m, frame.plot.size().y);
        for height_m in heights {
            let y = frame.at(0.0, height_m).y.round();
            self.rule(Vec2::new(frame.plot.min.x, y), Vec2::new(frame.plot.max.x, y));
            let figure = self.setter.line(&format_number(height_m, decimals), face);
            let x = frame.plot.min.x - sheet.px(8.0) - figure.advance;
            let at = Vec2::new(x, y + face.size_px * CAP_HEIGHT * 0.5);
            write(&mut self.below, &[(&figure, at)], INK);
        }
        let room = frame.plot.size().x * 0.7;
        if let Some(label) = fitted(&mut self.setter, &around.height_axis, face, room) {
            let at = Vec2::new(sheet.whole_px(30.0), frame.plot.min.y - face.size_px * 0.95);
            write(&mut self.below, &[(&label, at.round())], SOFT_INK);
        }
    }

    fn along_axis(&mut self, around: &ChartText) {
        let (sheet, frame) = (self.sheet, self.frame);
        let face = figures(&sheet);
        let (unit_m, unit) = if frame.length_m >= KILOMETERS_FROM_M { (1000.0, "km") } else { (1.0, "m") };
        let most = (frame.plot.size().x / (face.size_px * 7.0)) as usize;
        let (marks, decimals) = ticks(0.0, frame.length_m / unit_m, most.clamp(2, 12));
        let baseline = frame.plot.max.y + sheet.px(8.0) + face.size_px * CAP_HEIGHT;
        for mark in marks {
            let x = frame.at(mark * unit_m, 0.0).x.round();
            self.rule(Vec2::new(x, frame.plot.min.y), Vec2::new(x, frame.plot.max.y + sheet.px(5.0)));
            let figure = self.setter.line(&format_number(mark, decimals), face);
            let at = Vec2::new(x - figure.advance * 0.5, baseline);
            write(&mut self.below, &[(&figure, at)], INK);
        }
        let below = (baseline + face.size_px * 1.9).round();
        let label = self.setter.line(&format!("{} ({unit})", around.along_axis), face);
        let middle = frame.plot.center().x;
        let label_at = Vec2::new(middle - label.advance * 0.5, below);
        write(&mut self.below, &[(&label, label_at)], SOFT_INK);
        let room = (frame.plot.size().x - label.advance) * 0.5 - face.size_px * 2.0;
        let left = frame.plot.min.x;
        if let Some(start) = fitted(&mut self.setter, &around.start, face, room) {
            write(&mut self.below, &[(&start, Vec2::new(left, below))], INK);
        }
        if let Some(end) = fitted(&mut self.setter, &around.end, face, room) {
            write(&mut self.below, &[(&end, Vec2::new(frame.plot.max.x - end.advance, below))], INK);
        }
    }

    fn rule(&mut self, from: Vec2, to: Vec2) {
        // A line one pixel wide is crisp where its middle is a pixel's.
        let half = Vec2::splat(0.5);
        self.below.line(PixelSegment { from: from + half, to: to + half }, self.sheet.hairline(), GRID);
    }

    /// Writes text beside a point, above it or below, moved aside where it would leave the plot.
    pub fn label(&mut self, text: &str, at: Vec2, side: LabelSide, color: Srgba) {
        let face = TextStyle::upright(self.sheet.type_px(15.0), TextStyle::MEDIUM);
        let line = self.setter.line(text, face);
        let away = self.sheet.px(11.0);
        let plot = self.frame.plot.grown(-self.sheet.px(6.0));
        let most = (plot.max.x - line.advance).max(plot.min.x);
        let x = (at.x - line.advance * 0.5).clamp(plot.min.x, most);
        let y = match side {
            LabelSide::Above => at.y - away,
            LabelSide::WellAbove => at.y - away - face.size_px * 2.4,
            LabelSide::Below => at.y + away + face.size_px * CAP_HEIGHT,
        };
        let least = plot.min.y + face.size_px * CAP_HEIGHT;
        let at = Vec2::new(x, y.clamp(least, plot.max.y.max(least))).round();
        self.write_haloed(&line, at, color);
    }

    fn write_haloed(&mut self, line: &TextLine, at: Vec2, color: Srgba) {
        let reach = self.sheet.px(3.0);
        halos(&mut self.plotted, &[(line, at)], reach);
        write(&mut self.plotted, &[(line, at)], color);
    }

    /// A mark below the plot's lower edge, where the line bends.
    pub fn tick_below(&mut self, along_m: f64) {
        let at = Vec2::new(self.frame.at(along_m, 0.0).x.round(), self.frame.plot.max.y);
        let down = Vec2::new(0.0, self.sheet.px(7.0));
        self.plotted.line(PixelSegment { from: at - down, to: at + down }, self.sheet.px(1.5).max(1.0), INK);
    }

    /// A dot in a ring of paper.
    pub fn dot(&mut self, at: Vec2, color: Srgba) {
        self.plotted.disc(at, self.sheet.px(6.5), PAPER);
        self.plotted.disc(at, self.sheet.px(4.5), color);
    }

    /// Paints the chart.
    pub fn finish(mut self) -> Pixels {
        let sheet = self.sheet;
        self.plotted.frame(self.frame.plot.grown(sheet.hairline()), sheet.hairline().round(), SOFT_INK);
        let mut pixels = Pixels::filled(sheet.size.x as u32, sheet.size.y as u32, PAPER);
        let mut canvas = Canvas::over(&mut pixels);
        canvas.draw(&self.below);
        canvas.draw(&self.plotted);
        canvas.finish();
        pixels
    }
}

/// Where a label stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelSide {
    /// Above its point.
    Above,
    /// Above what may stand above its point.
    WellAbove,
    /// Below it.
    Below,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::annotate::chart_ground::{ChartGround, ChartPoint};
    use crate::annotate::chart_profile::{ProfileChart, paint};

    fn chart(heights: &[f64]) -> ProfileChart {
        let point = |(index, &height): (usize, &f64)| ChartPoint {
            along_m: index as f64 * 100.0,
            ground: if height.is_nan() { ChartGround::NoData } else { ChartGround::Height(height) },
        };
        let around = ChartText { title: "Profile".into(), ..ChartText::default() };
        ProfileChart { text: around, points: heights.iter().enumerate().map(point).collect(), bends_m: vec![] }
    }

    #[test]
    fn heights_rise_upward_and_distances_to_the_right_within_the_plot() {
        let chart = begin((800, 400), &ChartText::default(), 1000.0, (100.0, 300.0));
        let (low, high) = (chart.frame.at(0.0, 100.0), chart.frame.at(1000.0, 300.0));
        assert!(low.x == chart.frame.plot.min.x && high.x == chart.frame.plot.max.x);
        assert!(high.y < low.y && chart.frame.plot.contains(Vec2::new(low.x + 1.0, high.y)));
    }

    #[test]
    fn the_stretch_of_heights_is_that_of_the_scales() {
        let frame = begin((800, 400), &ChartText::default(), 1000.0, (0.0, 100.0)).frame;
        let right = frame.at(1.0, 0.0).x - frame.at(0.0, 0.0).x;
        let up = frame.at(0.0, 0.0).y - frame.at(0.0, 1.0).y;
        assert!((frame.exaggeration() / f64::from(up / right) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn level_ground_is_not_stretched_into_mountains() {
        let frame = begin((800, 400), &ChartText::default(), 10_000.0, (50.0, 50.001)).frame;
        assert!(frame.exaggeration() < 400.0);
    }

    #[test]
    fn ground_is_filled_sky_is_not_and_a_gap_is_neither() {
        let pixels = paint((800, 400), &chart(&[100.0, 100.0, f64::NAN, 100.0, 100.0]));
        let frame = begin(
            (800, 400),
            &ChartText { title: "Profile".into(), ..ChartText::default() },
            400.0,
            (100.0, 100.0),
        )
        .frame;
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

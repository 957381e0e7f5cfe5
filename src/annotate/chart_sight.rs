//! The chart of a line of sight: the ground lowered by the Earth's curvature, its visible parts, the line, and what
//! blocks it.

use glam::Vec2;

use crate::chart::{Chart, ChartText, LabelSide};
use crate::chart_ground::{ChartPoint, fill, hatch_gaps, height_range, rim};
use crate::pixel_box::PixelSegment;
use crate::sheet::{INK, WATER_INK};
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_raster::answer::Answer;

/// Visible ground.
const LIT: Srgba = Srgba::opaque(0xe2, 0xd3, 0xa8);
/// Hidden ground.
const DARK: Srgba = Srgba::opaque(0x9c, 0x92, 0x82);
/// The line up to its end or the first obstacle.
const LINE: Srgba = WATER_INK;
/// The obstacle.
const BLOCK: Srgba = Srgba::opaque(0xb0, 0x35, 0x22);
/// Labels nearer to each other than this share of the plot's width are set one above the other.
const CROWDED: f32 = 0.15;
/// Design pixels of a dash and of the gap after it.
const DASH: (f32, f32) = (10.0, 7.0);

/// The content of the chart. All heights are lowered by the drop that curvature and refraction cause at their distance,
/// so that the line of sight is straight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SightChart {
    /// The texts around the plot.
    pub text: ChartText,
    /// The ground, in order from the observer.
    pub points: Vec<ChartPoint>,
    /// The parts of it that the observer sees: from and to, meters along the line.
    pub visible_m: Vec<(f64, f64)>,
    /// The height of the observer's eye, meters.
    pub eye_m: f64,
    /// The height of the target at the last point, meters.
    pub target_m: f64,
    /// The first point that blocks the line.
    pub blocker: Option<SightBlocker>,
    /// The observer's label.
    pub observer_label: String,
    /// The target's label.
    pub target_label: String,
}

/// A point of the ground that blocks a line of sight.
#[derive(Clone, Debug, PartialEq)]
pub struct SightBlocker {
    /// Meters along the line.
    pub along_m: f64,
    /// Its height, meters.
    pub height_m: f64,
    /// Its label.
    pub label: String,
}

/// A picture of the chart, `size` pixels wide and high. The same chart gives the same bytes on every machine.
pub fn paint(size: (u32, u32), sight: &SightChart) -> Pixels {
    let length_m = sight.points.last().map_or(0.0, |last| last.along_m);
    let (low, high) = height_range(&sight.points);
    let (low, high) = (low.min(sight.eye_m).min(sight.target_m), high.max(sight.eye_m).max(sight.target_m));
    let mut chart = Chart::new(size, &sight.text, length_m, (low, high));
    hatch_gaps(&mut chart, &sight.points);
    fill(&mut chart, &sight.points, DARK);
    for &(from_m, to_m) in &sight.visible_m {
        fill(&mut chart, &between(&sight.points, from_m, to_m), LIT);
    }
    rim(&mut chart, &sight.points);
    draw_line(&mut chart, sight, length_m);
    chart.finish()
}

/// The ground from `from_m` to `to_m`, cut exactly there.
fn between(points: &[ChartPoint], from_m: f64, to_m: f64) -> Vec<ChartPoint> {
    let mut part = Vec::new();
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        if b.along_m <= from_m || a.along_m >= to_m {
            continue;
        }
        let (Some(low), Some(high)) = (a.ground.height_m(), b.ground.height_m()) else { continue };
        let at = |along_m: f64| {
            let share = (along_m - a.along_m) / (b.along_m - a.along_m);
            ChartPoint { along_m, ground: Answer::Height(low + (high - low) * share) }
        };
        part.extend([at(a.along_m.max(from_m)), at(b.along_m.min(to_m))]);
    }
    part
}

fn draw_line(chart: &mut Chart, sight: &SightChart, length_m: f64) {
    let eye = chart.frame.at(0.0, sight.eye_m);
    let target = chart.frame.at(length_m, sight.target_m);
    let width = chart.composer.sheet.px(2.4).max(1.2);
    if let Some(SightBlocker { along_m, height_m, label }) = &sight.blocker {
        let line_m = sight.eye_m + (sight.target_m - sight.eye_m) * (along_m / length_m);
        let (on_line, top) = (chart.frame.at(*along_m, line_m), chart.frame.at(*along_m, *height_m));
        chart.plotted.line(PixelSegment { from: eye, to: on_line }, width, LINE);
        draw_dashes(chart, on_line, target, width);
        chart.dot(top, BLOCK);
        // Near an end its label would overlap the end's.
        let near = chart.frame.plot.size().x * CROWDED;
        let is_crowded = top.x - eye.x < near || target.x - top.x < near;
        let side = if is_crowded { LabelSide::WellAbove } else { LabelSide::Above };
        chart.label(label, top, side, BLOCK);
    } else {
        chart.plotted.line(PixelSegment { from: eye, to: target }, width, LINE);
    }
    for (along_m, at, label) in [(0.0, eye, &sight.observer_label), (length_m, target, &sight.target_label)] {
        let ground = sight.points.iter().find(|point| point.along_m == along_m);
        if let Some(height_m) = ground.and_then(|point| point.ground.height_m()) {
            let foot = chart.frame.at(along_m, height_m);
            chart.plotted.line(PixelSegment { from: foot, to: at }, width, INK);
        }
        chart.dot(at, LINE);
        chart.label(label, at, LabelSide::Above, LINE);
    }
}

fn draw_dashes(chart: &mut Chart, from: Vec2, to: Vec2, width: f32) {
    let (dash, gap) = (chart.composer.sheet.px(DASH.0), chart.composer.sheet.px(DASH.1));
    let length = from.distance(to);
    let along = (to - from).normalize_or_zero();
    let mut at = gap;
    while at < length {
        let end = (at + dash).min(length);
        chart.plotted.line(PixelSegment { from: from + along * at, to: from + along * end }, width, BLOCK);
        at += dash + gap;
    }
}

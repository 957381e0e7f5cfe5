//! The ground in a chart: filled from its line down to the plot's lower edge, and hatched where there is none.

use glam::Vec2;

use crate::chart::Chart;
use crate::drawing::{polygon, polyline};
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::sheet::SOFT_INK;
use crate::text::TextStyle;
use sandtable_draw::color::Srgba;
use sandtable_raster::answer::Answer;

/// The ground's line.
const RIM: Srgba = Srgba::opaque(0x4a, 0x3f, 0x30);
/// Hatching of gaps.
const HATCH: Srgba = Srgba([0x3c, 0x42, 0x47, 0x50]);
/// Under the hatching.
const UNKNOWN: Srgba = Srgba::opaque(0xf4, 0xf2, 0xec);
/// Design pixels between hatches.
const HATCH_STEP: f32 = 9.0;
/// From this many points per pixel on, the extremes of each pixel's column are drawn.
const POINTS_PER_PIXEL: f32 = 4.0;

/// The ground at a point of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartPoint {
    /// Meters along the line.
    pub along_m: f64,
    /// The ground there, its height as it is drawn.
    pub ground: Answer,
}

/// The lowest and highest height of `points`; (0, 1) where there is none.
pub fn height_range(points: &[ChartPoint]) -> (f64, f64) {
    let heights = points.iter().filter_map(|point| point.ground.height_m());
    let empty = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = heights.fold(empty, |(low, high), height| (low.min(height), high.max(height)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

/// Fills the ground beneath `points` with `color`.
pub fn fill(chart: &mut Chart, points: &[ChartPoint], color: Srgba) {
    let bottom = chart.frame.plot.max.y;
    for mut outline in lines(chart, points) {
        let (first, last) = (outline[0], outline[outline.len() - 1]);
        outline.extend([Vec2::new(last.x, bottom), Vec2::new(first.x, bottom)]);
        if let Some(path) = polygon(&outline) {
            chart.plotted.fill(path, color);
        }
    }
}

/// Draws the ground's line.
pub fn rim(chart: &mut Chart, points: &[ChartPoint]) {
    for line in lines(chart, points) {
        if let Some(path) = polyline(&line) {
            chart.plotted.stroke(&path, chart.composer.sheet.px(2.0).max(1.0), RIM);
        }
    }
}

/// The ground's line in pixels, one part for each run of two or more points with heights.
fn lines(chart: &Chart, points: &[ChartPoint]) -> Vec<Vec<Vec2>> {
    let pixel = |point: &ChartPoint| Some(chart.frame.at(point.along_m, point.ground.height_m()?));
    let has_height = |point: &ChartPoint| point.ground.height_m().is_some();
    let runs = points.chunk_by(|a, b| has_height(a) && has_height(b));
    let runs = runs.map(|run| run.iter().filter_map(pixel).collect::<Vec<_>>());
    runs.filter(|run| run.len() > 1).map(thinned).collect()
}

/// A line whose points share pixel columns, reduced to the first, lowest, highest and last point of each column.
fn thinned(line: Vec<Vec2>) -> Vec<Vec2> {
    let width = line[line.len() - 1].x - line[0].x;
    if (line.len() as f32) < POINTS_PER_PIXEL * width {
        return line;
    }
    line.chunk_by(|a, b| a.x.floor() == b.x.floor())
        .flat_map(|column| {
            let extreme =
                |order: fn(&&Vec2, &&Vec2) -> std::cmp::Ordering| column.iter().min_by(order).copied();
            let low = extreme(|a, b| a.y.total_cmp(&b.y));
            let high = extreme(|a, b| b.y.total_cmp(&a.y));
            [column.first().copied(), low, high, column.last().copied()].into_iter().flatten()
        })
        .collect()
}

/// Hatches the parts of the line without ground, and names the reason where it fits.
pub fn hatch_gaps(chart: &mut Chart, points: &[ChartPoint]) {
    for GroundGap { from_m, to_m, reason } in gaps(points) {
        let plot = chart.frame.plot;
        let (left, right) = (chart.frame.at(from_m, 0.0).x, chart.frame.at(to_m, 0.0).x);
        let area = PixelBox { min: Vec2::new(left, plot.min.y), max: Vec2::new(right, plot.max.y) };
        chart.plotted.rect(area, UNKNOWN);
        hatch(chart, area);
        name_gap(chart, area, reason);
    }
}

/// A part of the line without ground.
struct GroundGap {
    from_m: f64,
    to_m: f64,
    reason: &'static str,
}

fn gaps(points: &[ChartPoint]) -> Vec<GroundGap> {
    let mut gaps: Vec<GroundGap> = Vec::new();
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let reason = match (from.ground, to.ground) {
            (Answer::Height(_), Answer::Height(_)) => continue,
            (Answer::Outside, _) | (_, Answer::Outside) => "outside the model",
            _ => "no data",
        };
        match gaps.last_mut().filter(|gap| gap.to_m == from.along_m && gap.reason == reason) {
            Some(gap) => gap.to_m = to.along_m,
            None => gaps.push(GroundGap { from_m: from.along_m, to_m: to.along_m, reason }),
        }
    }
    gaps
}

/// Draws rising hatches, cut at the area's edges.
fn hatch(chart: &mut Chart, PixelBox { min, max }: PixelBox) {
    let sheet = chart.composer.sheet;
    let step = sheet.px(HATCH_STEP);
    // A hatch runs along x + y = sum, with sums that do not depend on the gap.
    let mut sum = ((min.x + min.y) / step).ceil() * step;
    while sum < max.x + max.y {
        let low = Vec2::new((sum - max.y).max(min.x), (sum - min.x).min(max.y));
        let high = Vec2::new((sum - min.y).min(max.x), (sum - max.x).max(min.y));
        chart.plotted.line(PixelSegment { from: low, to: high }, sheet.hairline(), HATCH);
        sum += step;
    }
}

fn name_gap(chart: &mut Chart, area: PixelBox, reason: &str) {
    let style = chart.composer.style(14.0, TextStyle::REGULAR);
    let line = chart.composer.line(reason, style);
    let padding = chart.composer.sheet.px(6.0);
    if line.advance + padding * 4.0 > area.size().x {
        return;
    }
    let at = (area.center() - Vec2::new(line.advance * 0.5, 0.0)).round();
    let half = Vec2::new(line.advance * 0.5 + padding, style.size_px * 0.5 + padding);
    let center = Vec2::new(area.center().x, at.y - style.size_px * 0.3);
    chart.plotted.rect(PixelBox::around(center, half), UNKNOWN);
    chart.plotted.write(&line, at, SOFT_INK);
}

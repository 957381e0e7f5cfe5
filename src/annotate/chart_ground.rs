//! The ground in a chart: filled from its line down to the plot's lower edge, and hatched where there is none.

use glam::Vec2;

use crate::annotate::chart::Chart;
use crate::annotate::drawing::{polygon, polyline};
use crate::annotate::pixel_box::{PixelBox, PixelSegment};
use crate::annotate::sheet::SOFT_INK;
use crate::annotate::text::{TextStyle, write};
use crate::draw::color::Srgba;

/// The ground's line.
const RIM: Srgba = Srgba::opaque(0x4a, 0x3f, 0x30);
/// Hatching where nothing is known.
const HATCH: Srgba = Srgba([0x3c, 0x42, 0x47, 0x50]);
/// Under the hatching.
const UNKNOWN: Srgba = Srgba::opaque(0xf4, 0xf2, 0xec);
/// Pixels between hatches, as designed.
const HATCH_STEP: f32 = 9.0;
/// More points than this many a pixel are drawn as the extremes of each pixel: they would all lie in one column.
const POINTS_A_PIXEL: f32 = 4.0;

/// The ground at a place along a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartPoint {
    /// Meters along the line.
    pub along_m: f64,
    /// What is there.
    pub ground: ChartGround,
}

/// What is known of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChartGround {
    /// Its height in meters.
    Height(f64),
    /// The model has no data there.
    NoData,
    /// The model does not reach there.
    Outside,
}

impl ChartGround {
    /// The height, where there is one.
    pub fn height_m(self) -> Option<f64> {
        match self {
            Self::Height(height_m) => Some(height_m),
            Self::NoData | Self::Outside => None,
        }
    }
}

/// The lowest and highest height of `points`; (0, 1) where there is none.
pub fn height_range(points: &[ChartPoint]) -> (f64, f64) {
    let heights = points.iter().filter_map(|point| point.ground.height_m());
    let empty = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = heights.fold(empty, |(low, high), height| (low.min(height), high.max(height)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

/// Fills the ground between two places along the line with `fill`.
pub fn fill(chart: &mut Chart, points: &[ChartPoint], fill: Srgba) {
    let floor = chart.frame.plot.max.y;
    for run in runs(points) {
        let line = thinned(chart, &run);
        let (Some(first), Some(last)) = (line.first().copied(), line.last().copied()) else { continue };
        let mut outline = line;
        outline.push(Vec2::new(last.x, floor));
        outline.push(Vec2::new(first.x, floor));
        if let Some(path) = polygon(&outline) {
            chart.plotted.fill(path, fill);
        }
    }
}

/// Draws the ground's line.
pub fn rim(chart: &mut Chart, points: &[ChartPoint]) {
    for run in runs(points) {
        let line = thinned(chart, &run);
        if let Some(path) = polyline(&line) {
            chart.plotted.stroke(&path, chart.sheet.px(2.0).max(1.0), RIM);
        }
    }
}

/// The points with heights, cut where there are none between.
fn runs(points: &[ChartPoint]) -> Vec<Vec<(f64, f64)>> {
    let mut runs = vec![Vec::new()];
    for point in points {
        match point.ground {
            ChartGround::Height(height_m) => {
                if let Some(run) = runs.last_mut() {
                    run.push((point.along_m, height_m));
                }
            }
            _ if runs.last().is_some_and(|run| !run.is_empty()) => runs.push(Vec::new()),
            _ => {}
        }
    }
    runs.retain(|run| run.len() > 1);
    runs
}

/// A run in pixels; where many points share a pixel's column, its first, lowest, highest and last.
fn thinned(chart: &Chart, run: &[(f64, f64)]) -> Vec<Vec2> {
    let line: Vec<Vec2> = run.iter().map(|&(along_m, height_m)| chart.frame.at(along_m, height_m)).collect();
    let (Some(first), Some(last)) = (line.first(), line.last()) else { return line };
    if (line.len() as f32) < POINTS_A_PIXEL * (last.x - first.x) {
        return line;
    }
    line.chunk_by(|a, b| a.x.floor() == b.x.floor())
        .flat_map(|column| {
            let place = |pick: fn(&&Vec2, &&Vec2) -> std::cmp::Ordering| column.iter().min_by(pick).copied();
            let low = place(|a, b| a.y.total_cmp(&b.y));
            let high = place(|a, b| b.y.total_cmp(&a.y));
            [column.first().copied(), low, high, column.last().copied()].into_iter().flatten()
        })
        .collect()
}

/// Hatches what of the line has no ground, and says why where there is room.
pub fn hatch_gaps(chart: &mut Chart, points: &[ChartPoint]) {
    for (from_m, to_m, why) in gaps(points) {
        let plot = chart.frame.plot;
        let (left, right) = (chart.frame.at(from_m, 0.0).x, chart.frame.at(to_m, 0.0).x);
        let area = PixelBox { min: Vec2::new(left, plot.min.y), max: Vec2::new(right, plot.max.y) };
        chart.plotted.rect(area, UNKNOWN);
        hatch(chart, area);
        name(chart, area, why);
    }
}

/// Stretches without ground: from and to in meters, and what their places say.
fn gaps(points: &[ChartPoint]) -> Vec<(f64, f64, &'static str)> {
    let mut gaps: Vec<(f64, f64, &'static str)> = Vec::new();
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let why = match (from.ground, to.ground) {
            (ChartGround::Height(_), ChartGround::Height(_)) => continue,
            (ChartGround::Outside, _) | (_, ChartGround::Outside) => "outside the model",
            _ => "no data",
        };
        match gaps.last_mut().filter(|gap| gap.1 == from.along_m && gap.2 == why) {
            Some(gap) => gap.1 = to.along_m,
            None => gaps.push((from.along_m, to.along_m, why)),
        }
    }
    gaps
}

/// Draws rising hatches, cut at the area's edges.
fn hatch(chart: &mut Chart, area: PixelBox) {
    let step = chart.sheet.px(HATCH_STEP);
    // A hatch runs along x + y = sum. Hatches stand in the same places whatever the gap.
    let least = area.min.x + area.min.y;
    let mut sum = (least / step).ceil() * step;
    while sum < area.max.x + area.max.y {
        let low = Vec2::new((sum - area.max.y).max(area.min.x), (sum - area.min.x).min(area.max.y));
        let high = Vec2::new((sum - area.min.y).min(area.max.x), (sum - area.max.x).max(area.min.y));
        chart.plotted.line(PixelSegment { from: low, to: high }, chart.sheet.hairline(), HATCH);
        sum += step;
    }
}

fn name(chart: &mut Chart, area: PixelBox, why: &str) {
    let face = TextStyle::upright(chart.sheet.type_px(14.0), TextStyle::REGULAR);
    let line = chart.setter.line(why, face);
    let padding = chart.sheet.px(6.0);
    if line.advance + padding * 4.0 > area.size().x {
        return;
    }
    let at = (area.center() - Vec2::new(line.advance * 0.5, 0.0)).round();
    let half = Vec2::new(line.advance * 0.5 + padding, face.size_px * 0.5 + padding);
    chart
        .plotted
        .rect(PixelBox::around(Vec2::new(area.center().x, at.y - face.size_px * 0.3), half), UNKNOWN);
    write(&mut chart.plotted, &[(&line, at)], SOFT_INK);
}

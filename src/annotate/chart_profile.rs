//! The chart of a profile: the ground along a line, with its lowest and highest point marked.

use crate::chart::{Chart, ChartText, LabelSide};
use crate::chart_ground::{ChartPoint, fill, hatch_gaps, height_range, rim};
use crate::nice::format_number;
use crate::sheet::INK;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// The ground in section.
const EARTH: Srgba = Srgba::opaque(0xc8, 0xb8, 0x96);

/// The content of the chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileChart {
    /// The texts around the plot.
    pub text: ChartText,
    /// The ground, in order along the line.
    pub points: Vec<ChartPoint>,
    /// The line's vertices between its ends, meters along it.
    pub bends_m: Vec<f64>,
}

/// A picture of the chart, `size` pixels wide and high. The same chart gives the same bytes on every machine.
pub fn paint(size: (u32, u32), profile: &ProfileChart) -> Pixels {
    let points = &profile.points;
    let length_m = points.last().map_or(0.0, |last| last.along_m);
    let mut chart = Chart::new(size, &profile.text, length_m, height_range(points));
    hatch_gaps(&mut chart, points);
    fill(&mut chart, points, EARTH);
    rim(&mut chart, points);
    profile.bends_m.iter().for_each(|&along_m| chart.tick_below(along_m));
    let heights = || points.iter().filter_map(|point| Some((point.along_m, point.ground.height_m()?)));
    // The first of several equally low or high.
    let lowest = heights().reduce(|best, next| if next.1 < best.1 { next } else { best });
    let highest = heights().reduce(|best, next| if next.1 > best.1 { next } else { best });
    for (extreme, side) in [(lowest, LabelSide::Below), (highest, LabelSide::Above)] {
        let Some((along_m, height_m)) = extreme else { continue };
        let at = chart.frame.at(along_m, height_m);
        chart.dot(at, INK);
        chart.label(&format!("{} m", format_number(height_m, 1)), at, side, INK);
    }
    chart.finish()
}

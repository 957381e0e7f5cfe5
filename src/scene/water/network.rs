//! The document's rivers as one network: which way each flows, how wide it is, what it meets.

use std::collections::BTreeMap;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::features::RiverTable;
use crate::description::words::Water;
use crate::draw::list::FeatureId;
use crate::earthworks::channel::flow;
use crate::earthworks::channel::flow::Flow;
use crate::geom::polyline::Polyline;
use crate::ribbon::junction::{Street, StreetSupport};
use crate::ribbon::stroke::{StrokeOptions, Widths};
use crate::ribbon::texture::{RibbonSurface, texture_length_m};
use crate::scene::FeatureKind;
use crate::scene::attributes::Attributes;
use crate::scene::builder::SceneBuilder;
use crate::scene::near;
use crate::scene::sources::Sources;
use crate::terrain::lattice::Lattice;

/// How far from the ground a centerline may run whose water still reaches it, in meters.
const REACH_M: f64 = 1000.0;

/// A river, downstream.
pub struct Stream {
    /// The centerline in world coordinates.
    pub line: Polyline,
    /// The water's width at each vertex in meters.
    pub widths_m: Vec<f64>,
    /// The width of the bank on either side in meters.
    pub bank_m: f64,
    /// Whether the ground is cut to it.
    pub water: Water,
    /// How deep the ground may be cut, in meters.
    pub max_cut_m: f64,
    /// The feature it is.
    pub feature: FeatureId,
    /// Its name; may be empty.
    pub name: String,
}

impl Stream {
    /// The widest that its water is, in meters.
    pub fn widest_m(&self) -> f64 {
        self.widths_m.iter().copied().fold(0.0, f64::max)
    }

    /// How its water is stroked.
    pub fn options(&self) -> StrokeOptions {
        let width_m = self.widest_m();
        let texture_length_m = texture_length_m(RibbonSurface::River, width_m);
        StrokeOptions { width_m, texture_length_m, ..StrokeOptions::default() }
    }

    /// It as lines that meet have it: all of one level and rank.
    pub fn street(&self) -> Street<'_> {
        Street {
            line: &self.line,
            widths: Widths::PerVertex(&self.widths_m),
            options: self.options(),
            bed: StreetSupport::Ground,
            level: 0,
            rank: 0,
        }
    }
}

/// The document's rivers that come near the ground, in the order of its tables.
///
/// # Errors
/// A source cannot be had.
pub fn collect(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &Lattice,
    collected: &mut SceneBuilder,
) -> Result<Vec<Stream>, Diagnostic> {
    let extent = lattice.extent();
    let mut drawn: Vec<(&RiverTable, Attributes, Polyline)> = Vec::new();
    let mut widths_m: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for river in &document.rivers {
        let lines = sources.lines(&river.source)?;
        let inline =
            river.widths.as_ref().and_then(|widths| lines.first().map(|line| (widths, line.shape.clone())));
        let given = river.name.as_deref();
        for (attributes, line) in
            near::lines(lines, (&extent, REACH_M), (FeatureKind::River, given), collected)
        {
            if let Some((widths, points)) = &inline {
                widths_m.insert(drawn.len(), kept(&line, points, widths));
            }
            drawn.push((river, attributes, line));
        }
    }
    let lines: Vec<&Polyline> = drawn.iter().map(|(_, _, line)| line).collect();
    let flows = flow::directions(lattice, &lines);
    let streams = drawn.into_iter().zip(flows).enumerate();
    let stream = |(index, ((river, attributes, line), flow))| {
        let stated = widths_m.remove(&index);
        stream(river, &attributes, (line, stated, flow), collected)
    };
    Ok(streams.map(stream).collect())
}

/// The widths of the vertices that a line kept of its points; it drops those that repeat the one before.
fn kept(line: &Polyline, points: &[glam::DVec2], widths_m: &[f64]) -> Vec<f64> {
    let mut given = points.iter().zip(widths_m);
    let mut width = |at: &glam::DVec2| given.find(|(point, _)| *point == at).map(|(_, &width_m)| width_m);
    line.points().iter().filter_map(&mut width).collect()
}

fn stream(
    river: &RiverTable,
    attributes: &Attributes,
    (line, stated, flow): (Polyline, Option<Vec<f64>>, Flow),
    collected: &mut SceneBuilder,
) -> Stream {
    let mut stated = stated.filter(|widths| widths.len() == line.points().len());
    let line = match flow {
        Flow::AsDrawn => line,
        Flow::Against => {
            stated.iter_mut().for_each(|widths| widths.reverse());
            line.reversed()
        }
    };
    let name = attributes.name(river.name.as_deref());
    let feature = collected.add(FeatureKind::River, name.clone());
    let counts = &mut collected.default_counts;
    let widths_m = stated.unwrap_or_else(|| {
        let width_m = attributes.number(&river.width, counts);
        let mouth_m = attributes.number_or(river.mouth_width.as_ref(), width_m, counts);
        let part = |station: &f64| station / line.length();
        line.stations().iter().map(|station| width_m + (mouth_m - width_m) * part(station)).collect()
    });
    let bank_m = attributes.number(&river.bank, counts);
    Stream { line, widths_m, bank_m, water: river.water, max_cut_m: river.max_cut, feature, name }
}

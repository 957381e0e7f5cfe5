//! The document's rivers as one network: which way each flows, how wide it is, of what order, what it meets.

use glam::DVec2;

use crate::attributes::Attributes;
use crate::builder::SceneBuilder;
use crate::feature::FeatureKind;
use crate::near;
use crate::scene_findings::FeatureTable;
use crate::sources::Sources;
use crate::water::order::{self, RiverSurroundings};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::RiverTable;
use sandtable_description::words::Water;
use sandtable_draw::list::FeatureId;
use sandtable_earthworks::alignment::{Alignment, Support, Width};
use sandtable_earthworks::channel::flow::{self, Flow};
use sandtable_geom::convex;
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;
use sandtable_ribbon::junction::Street;
use sandtable_ribbon::stroke::StrokeOptions;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_terrain::lattice::Lattice;

/// How far from the ground a centerline may run whose water still reaches it, in meters.
const REACH_M: f64 = 1000.0;

/// A river, downstream.
pub struct Stream {
    /// Its water, along its centerline.
    pub street: Street,
    /// The width of the bank on either side in meters.
    pub bank_m: f64,
    /// Whether the ground is cut to it.
    pub water: Water,
    /// How deep the ground may be cut, in meters.
    pub max_cut_m: f64,
    /// Its feature.
    pub feature: FeatureId,
    /// Its name; may be empty.
    pub name: String,
    /// Its order along its centerline; see [`order`].
    pub order: Profile,
    /// Whether it runs in a culvert.
    pub is_culvert: bool,
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
    let mut drawn: Vec<(&RiverTable, Attributes, Polyline, Option<Profile>)> = Vec::new();
    for river in &document.rivers {
        let lines = sources.lines(&river.source)?;
        let widths_m = lines.first().and_then(|line| near::widths_m(river.widths.as_deref(), &line.shape));
        let named =
            FeatureTable { kind: FeatureKind::River, name: river.name.as_deref(), source: &river.source };
        for (attributes, line) in near::lines(lines, &extent, REACH_M, &named, &mut collected.findings) {
            let widths = widths_m.as_ref();
            let widths = widths.and_then(|widths_m| Profile::new(line.stations().to_vec(), widths_m.clone()));
            drawn.push((river, attributes, line, widths));
        }
    }
    let lines: Vec<&Polyline> = drawn.iter().map(|(_, _, line, _)| line).collect();
    let flows = flow::directions(lattice, &lines);
    let directed = drawn.into_iter().zip(flows).map(|((river, attributes, line, widths), flow)| match flow {
        Flow::AsDrawn => (river, attributes, line, widths),
        Flow::Against => (river, attributes, line.reversed(), widths.map(|widths| widths.reversed())),
    });
    let directed: Vec<_> = directed.collect();
    let lines: Vec<&Polyline> = directed.iter().map(|(_, _, line, _)| line).collect();
    let orders = orders(&lines, lattice, collected);
    let stream = |((river, attributes, line, widths), order)| {
        stream(river, &attributes, DirectedLine { line, widths, order }, collected)
    };
    Ok(directed.into_iter().zip(orders).map(stream).collect())
}

/// How far from the border of the ground a source lies at least, in cells: nearer to it, a line is cut off rather than
/// begins.
const SOURCE_CELLS: f64 = 3.0;

/// The orders of lines drawn downstream among the lakes laid so far.
fn orders(lines: &[&Polyline], lattice: &Lattice, collected: &SceneBuilder) -> Vec<Profile> {
    let lakes = collected.ribbons.iter().enumerate();
    let lakes = lakes.filter(|(_, ribbon)| ribbon.surface == RibbonSurface::Lake);
    let of_lakes = lakes.flat_map(|(lake, ribbon)| ribbon.plan.corners().map(move |corners| (lake, corners)));
    let triangles: Vec<(usize, [DVec2; 3])> =
        of_lakes.map(|(lake, corners)| (lake, corners.map(|corner| corner.at))).collect();
    let rects: Vec<Rect> = triangles.iter().map(|(_, corners)| Rect::around(*corners)).collect();
    let tree = RectTree::new(&rects);
    let lake_at = |at: DVec2| {
        let mut found = tree.meeting(&Rect::around([at])).map(|index| &triangles[index]);
        found.find(|(_, corners)| convex::touches(corners, at)).map(|(lake, _)| *lake)
    };
    let inner = lattice.extent().grown(-SOURCE_CELLS * lattice.cell().max_element());
    let may_rise_at = |at: DVec2| inner.contains(at);
    order::orders(lines, &RiverSurroundings { lake_at: &lake_at, may_rise_at: &may_rise_at })
}

/// A river's centerline, downstream, and what is known along it.
struct DirectedLine {
    line: Polyline,
    widths: Option<Profile>,
    order: Profile,
}

fn stream(
    river: &RiverTable,
    attributes: &Attributes,
    DirectedLine { line, widths, order }: DirectedLine,
    collected: &mut SceneBuilder,
) -> Stream {
    let name = attributes.name(river.name.as_deref());
    let feature = collected.add(FeatureKind::River, name.clone(), attributes.origin(&river.source));
    let is_culvert = match &river.culvert {
        Some(expression) => attributes.holds(expression),
        None => ["tunnel", "culvert"].into_iter().any(|property| attributes.affirm(property)),
    };
    let counts = &mut collected.default_counts;
    let width = widths.map(Width::Varying).unwrap_or_else(|| {
        let width_m = attributes.number(&river.width, counts);
        let mouth_m = attributes.number_or(river.mouth_width.as_ref(), width_m, counts);
        let part = |station: &f64| station / line.length();
        let widths_m = line.stations().iter().map(|station| width_m + (mouth_m - width_m) * part(station));
        let widths = Profile::new(line.stations().to_vec(), widths_m.collect());
        widths.filter(|_| mouth_m != width_m).map_or(Width::Constant(width_m), Width::Varying)
    });
    let bank_m = attributes.number(&river.bank, counts);
    let width_m = width.widest_m();
    let alignment = Alignment { line, level: None, width, support: Support::Ground };
    let options = StrokeOptions::of(RibbonSurface::River, width_m);
    let street = Street { alignment, width_m, options, level: 0, surface: RibbonSurface::River };
    Stream { street, bank_m, water: river.water, max_cut_m: river.max_cut, feature, name, order, is_culvert }
}

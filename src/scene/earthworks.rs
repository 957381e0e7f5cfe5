//! Earthworks of the scene file: craters, trenches, tracks, level and raised ground.
//!
//! They come after lakes, rivers, roads, pads of buildings, trenches along lines and bridges, one after the other in the
//! order of the file, and before the pads of models. So one that a user adds while the scene is shown changes the ground
//! on the screen just as it changes that of the scene that is read again, unless a pad lies there.

use glam::DVec2;

use crate::attributes::{Attributes, DefaultCounts};
use crate::builder::SceneBuilder;
use crate::near::MERGE_M;
use crate::report::EarthworkRow;
use crate::sources::{Sourced, Sources};
use sandtable_base::limits::EARTHWORK_STEPS;
use sandtable_base::message::choice::Choice;
use sandtable_base::message::numbers::fixed;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::earthworks::EarthworkTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::EarthworkKind;
use sandtable_earthworks::brush::{Change, Crater, TireTrack, Trench, set_heights};
use sandtable_earthworks::earthwork::{CrownHeight, Earthwork, RaisedGround};
use sandtable_earthworks::held_posts::HeldPosts;
use sandtable_earthworks::level_ground::LevelGround;
use sandtable_earthworks::pad::Batters;
use sandtable_geom::polyline::Polyline;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::water_cover::{WaterCover, WaterRules, water_cover};

/// Sizes in meters where none are stated: a heavy bomb's crater, a trench to stand in, a truck's track, a bank.
const RADIUS_M: f64 = 10.0;
const TRENCH_DEPTH_M: f64 = 1.5;
const TRENCH_WIDTH_M: f64 = 1.5;
const TRACK_DEPTH_M: f64 = 0.15;
const TRACK_GAUGE_M: f64 = 2.0;
const RUT_M: f64 = 0.5;
const CROWN_HEIGHT_M: f64 = 3.0;
const CROWN_WIDTH_M: f64 = 4.0;

/// The depth of a simple crater below the old ground and the height of its rim, as shares of its radius (Pike 1977).
const CRATER_DEPTH: f64 = 0.32;
const CRATER_RIM: f64 = 0.07;

/// A trench's bottom as a share of its width.
const BOTTOM: f64 = 0.55;
/// The most of its width that a trench's bottom may be; what is left are its sides.
const MOST_BOTTOM: f64 = 0.99;

/// An earthwork in world space with its name, which may be empty.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedEarthwork {
    /// The name that the scene file or the feature's properties give.
    pub name: String,
    /// Its shape and place.
    pub work: Earthwork,
}

/// Changes the ground by the document's earthworks, beside the posts that `held` holds, and reports the earth moved.
/// Returns the rectangles of posts that changed, in order, with their heights before.
///
/// # Errors
/// A source cannot be had, or there is more to do than is allowed.
pub fn build(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    held: &HeldPosts,
    collected: &mut SceneBuilder,
) -> Result<Vec<Change>, Diagnostic> {
    let (mut cost, mut unseen, mut dug) = (0.0, 0, Vec::new());
    for table in &document.earthworks {
        let (mut count, mut still) = (0, 0);
        for NamedEarthwork { name, work } in of_table(table, sources, &mut collected.default_counts)? {
            cost += work.cost(lattice);
            if cost > EARTHWORK_STEPS.get() as f64 {
                return Err(too_much(document, table));
            }
            let changes = work.apply(lattice, held);
            count += 1;
            still += usize::from(changes.volumes.cut_m3 == 0.0 && changes.volumes.fill_m3 == 0.0);
            unseen += usize::from(!work.is_resolved(lattice.cell().max_element()));
            collected.report.earthworks.push(EarthworkRow {
                name,
                kind: table.kind.word(),
                area: changes.area_m2(lattice),
                cut: changes.volumes.cut_m3,
                fill: changes.volumes.fill_m3,
            });
            dug.extend(changes.pieces);
        }
        if still > 0 {
            let message = format!(
                "{still} of {count} {} moved no earth: off the elevation model, between its posts, or under water",
                works(count)
            );
            collected.findings.add(FindingCode::NoEarthMoved, table.source.span(), message);
        }
    }
    note(unseen, lattice, collected);
    Ok(dug)
}

/// The water that the elevations show without earthworks, on the ground that they left dry: a level pit is no lake.
pub fn water_beside(dug: &[Change], lattice: &Lattice, rules: &WaterRules) -> WaterCover {
    if dug.is_empty() {
        return water_cover(lattice, rules);
    }
    let mut before = lattice.clone();
    for Change { posts, before: heights } in dug.iter().rev() {
        set_heights(&mut before, *posts, heights);
    }
    let mut cover = water_cover(&before, rules);
    let is_other = |&post: &Post| before.height(post).to_bits() != lattice.height(post).to_bits();
    if !cover.is_water.is_empty() {
        for post in dug.iter().flat_map(|change| change.posts.posts()).filter(is_other) {
            cover.is_water[lattice.index(post)] = false;
        }
    }
    cover
}

fn note(unseen: usize, lattice: &Lattice, collected: &mut SceneBuilder) {
    let rows = &collected.report.earthworks;
    if !rows.is_empty() {
        let (cut, fill) = rows.iter().fold((0.0, 0.0), |(cut, fill), row| (cut + row.cut, fill + row.fill));
        let count = rows.len();
        let message =
            format!("{count} {}: {} m³ cut, {} m³ filled", works(count), fixed(cut, 0), fixed(fill, 0));
        collected.findings.add(FindingCode::EarthMoved, 0..0, message);
    }
    if unseen > 0 {
        let cell_m = lattice.cell().max_element();
        let message = format!(
            "{unseen} {} narrower than two cells of the elevation model, whose posts are {cell_m:.3} m apart: they show \
             as pits, or not at all",
            works(unseen)
        );
        collected.findings.add(FindingCode::TooFine, 0..0, message);
    }
}

/// The noun of so many.
fn works(count: usize) -> &'static str {
    if count == 1 { "earthwork" } else { "earthworks" }
}

fn too_much(document: &Document, table: &EarthworkTable) -> Diagnostic {
    let message = format!("up to this earthwork, moving the earth takes more than {EARTHWORK_STEPS} steps");
    document.error_at(table.source.span(), message).with_help(format!(
        "make it smaller, choose fewer features by `where`, simplify their lines, or {EARTHWORK_STEPS:#}"
    ))
}

/// The earthworks of a table, in the order of its source.
///
/// # Errors
/// The source cannot be had.
pub fn of_table(
    table: &EarthworkTable,
    sources: &Sources<'_>,
    counts: &mut DefaultCounts,
) -> Result<Vec<NamedEarthwork>, Diagnostic> {
    let source = &table.source;
    let name = |attributes: &Attributes| attributes.name(table.name.as_deref());
    let mut sizes = SizeReader { table, counts };
    let mut works = Vec::new();
    match *table.kind {
        EarthworkKind::Crater => {
            for Sourced { attributes, shape, .. } in sources.points(source)? {
                let work = Earthwork::Crater(sizes.crater(&attributes, shape));
                works.push(NamedEarthwork { name: name(&attributes), work });
            }
        }
        EarthworkKind::Level => {
            for Sourced { attributes, shape, .. } in sources.polygons(source)? {
                let rings = std::iter::once(shape.exterior).chain(shape.holes).collect();
                let level_m = attributes.value(table.level.as_ref());
                let batters = Batters { cut: table.cut_slope, fill: table.fill_slope };
                let work = Earthwork::Level(LevelGround { rings, level_m, batters });
                works.push(NamedEarthwork { name: name(&attributes), work });
            }
        }
        kind @ (EarthworkKind::Trench | EarthworkKind::Track | EarthworkKind::Raise) => {
            for Sourced { attributes, shape, .. } in sources.lines(source)? {
                let line = match Polyline::new(shape.clone(), MERGE_M) {
                    Some(line) => line.points().to_vec(),
                    None => shape.into_iter().take(1).collect(),
                };
                let work = match kind {
                    EarthworkKind::Raise => Earthwork::Raise(sizes.raised(&attributes, line)),
                    _ if line.len() < 2 => continue,
                    EarthworkKind::Trench => Earthwork::Trench(sizes.trench(&attributes, line)),
                    _ => Earthwork::Track(sizes.track(&attributes, line)),
                };
                works.push(NamedEarthwork { name: name(&attributes), work });
            }
        }
    }
    Ok(works)
}

/// Reads the sizes of one feature after the other.
struct SizeReader<'a> {
    table: &'a EarthworkTable,
    counts: &'a mut DefaultCounts,
}

impl SizeReader<'_> {
    fn crater(&mut self, of: &Attributes, center: DVec2) -> Crater {
        let Self { table, counts } = self;
        let radius_m = of.number_or(table.radius.as_ref(), RADIUS_M, counts);
        Crater {
            center,
            radius_m,
            depth_m: of.number_or(table.depth.as_ref(), CRATER_DEPTH * radius_m, counts),
            rim_m: of.number_or(table.rim.as_ref(), CRATER_RIM * radius_m, counts),
        }
    }

    fn trench(&mut self, of: &Attributes, line: Vec<DVec2>) -> Trench {
        let Self { table, counts } = self;
        let top_m = of.number_or(table.width.as_ref(), TRENCH_WIDTH_M, counts);
        let bottom_m = of.number_or(table.bottom.as_ref(), BOTTOM * top_m, counts).min(MOST_BOTTOM * top_m);
        let depth_m = of.number_or(table.depth.as_ref(), TRENCH_DEPTH_M, counts);
        Trench { line, bottom_m, top_m, depth_m }
    }

    fn track(&mut self, of: &Attributes, line: Vec<DVec2>) -> TireTrack {
        let Self { table, counts } = self;
        TireTrack {
            line,
            gauge_m: of.number_or(table.width.as_ref(), TRACK_GAUGE_M, counts),
            rut_m: of.number_or(table.rut.as_ref(), RUT_M, counts),
            depth_m: of.number_or(table.depth.as_ref(), TRACK_DEPTH_M, counts),
        }
    }

    fn raised(&mut self, of: &Attributes, line: Vec<DVec2>) -> RaisedGround {
        let Self { table, counts } = self;
        let crown = match of.value(table.level.as_ref()) {
            Some(level_m) => CrownHeight::Elevation(level_m),
            None => CrownHeight::AboveGround(of.number_or(table.height.as_ref(), CROWN_HEIGHT_M, counts)),
        };
        let width_m = of.number_or(table.width.as_ref(), CROWN_WIDTH_M, counts);
        RaisedGround { line, crown, width_m, run: table.fill_slope }
    }
}

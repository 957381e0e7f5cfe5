//! Buildings: footprints from the document, pads under those that want one, and their solids on the finished ground.
//!
//! Two passes, since the ground is not finished before the roads have moved it:
//!
//! ```text
//!  lay_out: footprints, pads leveled ─► (roads conform) ─► raise: bases from the ground as it is now, solids
//! ```

use glam::DVec2;

use crate::attributes::Attributes;
use crate::builder::SceneBuilder;
use crate::building_colors::color_named;
use crate::crossed_shapes::CrossedShapes;
use crate::feature::FeatureKind;
use crate::feature_meshes::{Coat, FeatureSolid, Solid};
use crate::report::BuildingPadRow;
use crate::scene_findings::SceneFindings;
use crate::sources::{Sourced, Sources};
use crate::vertical_scale::DrawnGround;
use sandtable_base::message::choice::Choice;
use sandtable_description::color::Color;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::BuildingTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::scalar::Scalar;
use sandtable_description::words::{BaseRule, RoofShape as RoofWord};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_earthworks::leveling;
use sandtable_geom::polygon;
use sandtable_structure::building::{BuildingLevels, Paint, STORY_M, check, raise as raised};
use sandtable_structure::building_footing::WallFooting;
use sandtable_structure::building_footprint::BuildingFootprint;
use sandtable_structure::draped_solid::DrapedSolid;
use sandtable_structure::eaves::eaves;
use sandtable_structure::roof::{UnitRoof, roof};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::pieces::GridRegion;
use sandtable_terrain::query::zone::zone;
use sandtable_terrain::volumes::Volumes;

/// The tallest that a property may say, meters; as `height` in a scene file.
const TALLEST_M: f64 = 1000.0;
/// The height of a building whose properties say neither height nor levels, in meters: one floor with its roof.
const HOUSE_M: f64 = 6.0;
/// Rise over run of a roof of 30 degrees.
const PITCH: f64 = 0.577_350_269;
/// The most of a building's height that is roof where nobody says how much, so that wide halls keep their walls.
const MOST_ROOF: f64 = 0.5;
/// How deep walls go below the lowest ground under them, meters.
const FOUNDATION_M: f64 = 1.0;

/// A building with its footprint, not raised yet.
pub struct Plot {
    table: usize,
    attributes: Attributes,
    parts: Vec<BuildingFootprint>,
    pad_m: Option<f64>,
    feature: FeatureId,
}

/// Counts of buildings that are not as stated.
#[derive(Default)]
struct BuildingTally {
    off: usize,
    empty: usize,
    mended: usize,
    pads_refused: usize,
    roofs_replaced: usize,
    raised_whole: usize,
}

impl BuildingTally {
    fn note(&self, document: &Document, findings: &mut SceneFindings) {
        // The tables share one tally: its place is that of the only one.
        let span = match &document.buildings[..] {
            [only] => only.source.span(),
            _ => 0..0,
        };
        let sentences = [
            (self.off, FindingCode::LeftOut, "left out: not wholly on the elevation model's data"),
            (self.empty, FindingCode::EmptyShape, "left out: the footprint encloses no area"),
            (self.mended, FindingCode::ShapeMended, "mended: the footprint crossed itself"),
            (
                self.pads_refused,
                FindingCode::PadRefused,
                "without its pad: the ground there is shaped for something else already",
            ),
            (
                self.roofs_replaced,
                FindingCode::RoofReplaced,
                "with another roof than asked for: the footprint does not take it",
            ),
            (
                self.raised_whole,
                FindingCode::DefaultTaken,
                "without a min_height, which is not below the height",
            ),
        ];
        for (count, code, sentence) in sentences.into_iter().filter(|(count, ..)| *count > 0) {
            let message = format!("{count} {} {sentence}", FeatureKind::Building.noun(count));
            findings.add(code, span.clone(), message);
        }
    }
}

/// The document's buildings with their footprints mended, and the ground leveled under those whose base is a pad.
///
/// # Errors
/// A source cannot be had.
pub fn lay_out(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<Vec<Plot>, Diagnostic> {
    let (mut plots, mut tally) = (Vec::new(), BuildingTally::default());
    for (table, building) in document.buildings.iter().enumerate() {
        let wants_pad = building.base == BaseRule::Pad;
        let mut crossed = CrossedShapes::default();
        for Sourced { attributes, shape, crossings } in sources.polygons(&building.source)? {
            let parts = BuildingFootprint::parts(&shape.exterior, &shape.holes);
            if parts.is_empty() {
                tally.empty += 1;
                continue;
            }
            let Some(ground) = GroundUnder::parts(lattice, &parts) else {
                tally.off += 1;
                continue;
            };
            tally.mended += usize::from(parts.len() > 1);
            let name = attributes.name(building.name.as_deref());
            crossed.add_polygon(&shape, crossings, || name.clone());
            let pad_m = wants_pad.then(|| pad(lattice, &parts, ground.mean_m, &name, collected)).flatten();
            tally.pads_refused += usize::from(wants_pad && pad_m.is_none());
            let feature = collected.add(FeatureKind::Building, name, attributes.origin(&building.source));
            plots.push(Plot { table, attributes, parts, pad_m, feature });
        }
        let outcome = "it is built in pieces that do not";
        crossed.report(("building", outcome), building.source.span(), sources.frame, &mut collected.findings);
    }
    tally.note(document, &mut collected.findings);
    Ok(plots)
}

/// Levels the ground under a building and returns its level; `None` where a lake or another pad shares that ground.
fn pad(
    lattice: &mut Lattice,
    parts: &[BuildingFootprint],
    mean_m: f64,
    name: &str,
    collected: &mut SceneBuilder,
) -> Option<f64> {
    if parts.iter().any(|part| is_taken(lattice, part)) {
        return None;
    }
    let mut volumes = Volumes::default();
    for part in parts {
        volumes += leveling::level(lattice, part.rings(), mean_m as f32);
    }
    let Volumes { cut_m3: cut, fill_m3: fill } = volumes;
    collected.report.building_pads.push(BuildingPadRow { name: name.to_owned(), level: mean_m, cut, fill });
    Some(f64::from(mean_m as f32))
}

/// Whether any post of the cells round a footprint is shaped for something already.
fn is_taken(lattice: &Lattice, footprint: &BuildingFootprint) -> bool {
    let bounds = polygon::bounds(footprint.exterior());
    let (low, high) = (lattice.grid_at(bounds.min).floor(), lattice.grid_at(bounds.max).floor() + 1.0);
    let around = PostRect::between(lattice, low, high);
    around.is_some_and(|around| around.posts().any(|post| lattice.is_pinned(post)))
}

/// The heights of the ground under a building, meters.
#[derive(Clone, Copy)]
struct GroundUnder {
    low_m: f64,
    mean_m: f64,
    high_m: f64,
}

impl GroundUnder {
    /// Over all of the finest triangles that the footprints meet; `None` where some have no data.
    fn parts(lattice: &Lattice, parts: &[BuildingFootprint]) -> Option<Self> {
        let mut under = Self { low_m: f64::INFINITY, mean_m: 0.0, high_m: f64::NEG_INFINITY };
        let (mut area_m2, mut sum) = (0.0, 0.0);
        for part in parts {
            let to_map = |ring: &Vec<DVec2>| ring.iter().map(|at| *at + lattice.origin()).collect();
            let rings: Vec<Vec<DVec2>> = part.rings().iter().map(to_map).collect();
            let found = zone(lattice, &GridRegion::new(lattice, &rings).ok()?);
            let heights = found.heights?;
            if found.no_data_m2 + found.outside_m2 > NO_DATA_SHARE * part.area_m2() {
                return None;
            }
            under.low_m = under.low_m.min(heights.min_m);
            under.high_m = under.high_m.max(heights.max_m);
            sum += heights.mean_m * found.area_m2;
            area_m2 += found.area_m2;
        }
        (area_m2 > 0.0).then(|| Self { mean_m: sum / area_m2, ..under })
    }
}

/// How much of a footprint may lie off the data: rounding.
const NO_DATA_SHARE: f64 = 1e-6;

/// Raises the buildings on the ground as it is now.
pub fn raise(document: &Document, plots: &[Plot], ground: DrawnGround<'_>, collected: &mut SceneBuilder) {
    let mut tally = BuildingTally::default();
    for plot in plots {
        let building = &document.buildings[plot.table];
        let Some(under) = GroundUnder::parts(ground.lattice, &plot.parts) else {
            tally.off += 1;
            continue;
        };
        let base_m = match (plot.pad_m, building.base) {
            (Some(level_m), _) => level_m,
            (None, BaseRule::Lowest) => under.low_m,
            (None, BaseRule::Highest) => under.high_m,
            (None, BaseRule::Mean | BaseRule::Pad) => under.mean_m,
        };
        let base_z = ground.scale.world_z(base_m);
        let foot_z = ground.scale.world_z(under.low_m.min(base_m)) - FOUNDATION_M;
        raise_parts(building, plot, (base_z, foot_z), collected, &mut tally);
    }
    tally.note(document, &mut collected.findings);
}

/// Raises the parts of one building, given the world Z of its base and of the foot of its walls.
fn raise_parts(
    building: &BuildingTable,
    plot: &Plot,
    (base_z, foot_z): (f64, f64),
    collected: &mut SceneBuilder,
    tally: &mut BuildingTally,
) {
    let (low_m, height_m) = heights(building, &plot.attributes, collected, tally);
    let wanted = wanted_roof(building, &plot.attributes);
    let mut replaced = false;
    for part in &plot.parts {
        let body = |wanted: RoofWord| {
            let made = roof(part, wanted);
            let roof_m = roof_height(building, &plot.attributes, &made, height_m - low_m);
            let top_z = base_z + height_m;
            let floor_z = base_z + low_m;
            let mut levels = BuildingLevels { foot_z, base_z, floor_z, eaves_z: top_z - roof_m, top_z };
            if low_m > 0.0 {
                levels = BuildingLevels { foot_z: floor_z, base_z: floor_z, ..levels };
            } else if base_z - foot_z <= FOUNDATION_M + 1e-6 {
                // On its lowest ground no foundation shows, and the plaster goes on down.
                levels.base_z = foot_z;
            }
            let paint = paint(building, &plot.attributes, part, &made);
            let mesh = raised(part, &made, levels, paint);
            // Faces over inward corners may be thinner than coordinates are exact: such a building is flat.
            let is_sound = made.shape != RoofWord::Hipped || part.is_convex() || check(&mesh).is_ok();
            is_sound.then_some((made, levels, paint, mesh))
        };
        let Some((made, levels, paint, mesh)) = body(wanted).or_else(|| body(RoofWord::Flat)) else {
            continue;
        };
        replaced |= made.shape != wanted;
        collected.solids.push(Solid { mesh, coat: Coat::Facade, feature: plot.feature });
        if let Some(mesh) = eaves(&made, levels, paint).filter(|mesh| check(mesh).is_ok()) {
            collected.solids.push(Solid { mesh, coat: Coat::Painted, feature: plot.feature });
        }
        if low_m == 0.0 {
            let color = if levels.base_z > foot_z { paint.foundation } else { paint.wall };
            let footing = WallFooting { rings: part.rings().to_vec(), foot_z: foot_z as f32, color };
            collected
                .uprights
                .push(FeatureSolid { upright: DrapedSolid::Footing(footing), feature: plot.feature });
        }
    }
    tally.roofs_replaced += usize::from(replaced);
}

/// A property as a number within its bounds.
fn property(attributes: &Attributes, names: &[&str], (low, high): (f64, f64)) -> Option<f64> {
    names
        .iter()
        .filter_map(|name| attributes.get(name)?.number())
        .find(|&number| number > low && number <= high)
}

/// How high above its base a building begins, 0 for nearly all, and how high it ends, meters.
fn heights(
    building: &BuildingTable,
    attributes: &Attributes,
    collected: &mut SceneBuilder,
    tally: &mut BuildingTally,
) -> (f64, f64) {
    let stories = |names: &[&str]| property(attributes, names, (0.0, TALLEST_M / STORY_M));
    let known = property(attributes, &["height"], (0.0, TALLEST_M))
        .or_else(|| stories(&["building:levels", "levels"]).map(|levels| levels * STORY_M))
        .unwrap_or(HOUSE_M);
    let height_m = attributes.number_or(building.height.as_ref(), known, &mut collected.default_counts);
    let low_m = property(attributes, &["min_height"], (0.0, TALLEST_M))
        .or_else(|| stories(&["building:min_level"]).map(|levels| levels * STORY_M))
        .unwrap_or(0.0);
    if low_m >= height_m {
        tally.raised_whole += 1;
        return (0.0, height_m);
    }
    (low_m, height_m)
}

/// The roof stated, else that of OpenStreetMap's property; half-hipped and the like count as what they are nearest to.
fn wanted_roof(building: &BuildingTable, attributes: &Attributes) -> RoofWord {
    let tagged = || match attributes.get("roof:shape") {
        Some(Scalar::Text(text)) => match text.as_str() {
            "half-hipped" | "mansard" | "side_hipped" => Some(RoofWord::Hipped),
            "gambrel" | "saltbox" | "round" => Some(RoofWord::Gabled),
            "dome" | "onion" | "cone" => Some(RoofWord::Pyramidal),
            other => RoofWord::from_word(other),
        },
        _ => None,
    };
    attributes.value(building.roof.as_ref()).or_else(tagged).unwrap_or_default()
}

/// How much of a building's height is roof, meters.
fn roof_height(building: &BuildingTable, attributes: &Attributes, made: &UnitRoof, height_m: f64) -> f64 {
    if made.run_m <= 0.0 {
        return 0.0;
    }
    let stated = attributes
        .value(building.roof_height.as_ref())
        .or_else(|| property(attributes, &["roof:height"], (0.0, TALLEST_M)));
    match stated {
        Some(roof_m) => roof_m.min(height_m),
        None => (made.run_m * PITCH).min(height_m * MOST_ROOF),
    }
}

fn paint(
    building: &BuildingTable,
    attributes: &Attributes,
    part: &BuildingFootprint,
    made: &UnitRoof,
) -> Paint {
    let by_place = Paint::by_place(part, made);
    let color = |stated: Option<Color>, names: [&str; 2]| {
        let tagged = || names.iter().find_map(|name| color_named(&attributes.get(name)?));
        stated.map(|color| Srgba(color.0)).or_else(tagged)
    };
    // Walls and roofs are solid, whatever the color's alpha says.
    let solid = |Srgba([red, green, blue, _]): Srgba| Srgba::opaque(red, green, blue);
    let wall = color(building.wall_color, ["building:colour", "building:color"]);
    let roof = color(building.roof_color, ["roof:colour", "roof:color"]);
    Paint { wall: wall.map_or(by_place.wall, solid), roof: roof.map_or(by_place.roof, solid), ..by_place }
}

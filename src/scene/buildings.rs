//! Buildings: footprints from the document, pads under those that want one, and their solids on the finished ground.
//!
//! Two passes, since the ground is not finished before the roads have moved it:
//!
//! ```text
//!  lay_out: footprints, pads leveled ─► (roads conform) ─► raise: bases from the ground as it is now, solids
//! ```

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use crate::attributes::Attributes;
use crate::builder::SceneBuilder;
use crate::building_colors::color_named;
use crate::building_parts::BuildingParts;
use crate::building_tags::{BuildingHeights, RoofWish, heights};
use crate::city_buildings::{self, CityPlots};
use crate::crossed_shapes::CrossedShapes;
use crate::feature::FeatureKind;
use crate::feature_meshes::{Coat, FeatureSolid, Solid};
use crate::report::BuildingPadRow;
use crate::scene_findings::SceneFindings;
use crate::sources::{Sourced, Sources};
use crate::vertical_scale::DrawnGround;
use sandtable_description::color::Color;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::BuildingTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::{BaseRule, RoofShape as RoofWord};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_earthworks::leveling;
use sandtable_geom::polygon;
use sandtable_structure::building::{BuildingLevels, Paint, check, raise as raised};
use sandtable_structure::building_footing::WallFooting;
use sandtable_structure::building_footprint::BuildingFootprint;
use sandtable_structure::draped_solid::DrapedSolid;
use sandtable_structure::eaves::eaves;
use sandtable_structure::roof::turned_roof;
use sandtable_structure::unit_roof::UnitRoof;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::pieces::GridRegion;
use sandtable_terrain::query::zone::zone;
use sandtable_terrain::volumes::Volumes;
use sandtable_vector::feature::Polygon;

/// How deep walls go below the lowest ground under them, meters.
pub(super) const FOUNDATION_M: f64 = 1.0;

/// A building with its footprint, not raised yet.
struct Plot {
    table: usize,
    attributes: Attributes,
    parts: Vec<BuildingFootprint>,
    /// The footprint of the whole building of which this is a part, on whose ground it stands.
    whole: Option<Arc<Vec<BuildingFootprint>>>,
    pad_m: Option<f64>,
    feature: FeatureId,
}

/// The buildings of a document, not raised yet.
#[derive(Default)]
pub struct BuildingPlots {
    /// Footprints that are raised to a height.
    footprints: Vec<Plot>,
    /// Surfaces of CityJSON.
    models: Vec<CityPlots>,
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
    in_parts: usize,
    beside_parts: usize,
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
            (
                self.in_parts,
                FindingCode::LeftOut,
                "left out: drawn by parts (building:part) in place of the whole",
            ),
            (
                self.beside_parts,
                FindingCode::LeftOut,
                "drawn beside parts (building:part), which do not cover the outline",
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
) -> Result<BuildingPlots, Diagnostic> {
    let mut models = Vec::new();
    let (mut plots, mut tally) = (Vec::new(), BuildingTally::default());
    for (table, building) in document.buildings.iter().enumerate() {
        if let Some(model) = sources.city_model(&building.source)? {
            models.push(city_buildings::lay_out(table, building, &model, sources, lattice, collected)?);
            continue;
        }
        city_buildings::refuse_keys(document, building)?;
        let mut crossed = CrossedShapes::default();
        let polygons = sources.polygons(&building.source)?;
        let by_parts = BuildingParts::find(&polygons);
        // Of buildings that are drawn by their parts.
        let outline = |index: usize| {
            let Polygon { exterior, holes } = &polygons[index].shape;
            BuildingFootprint::parts(exterior, holes)
        };
        let mut wholes: BTreeMap<usize, WholeBuilding> = BTreeMap::new();
        for (index, Sourced { attributes, shape, crossings }) in polygons.iter().enumerate() {
            if by_parts.is_replaced(index) {
                tally.in_parts += 1;
                continue;
            }
            tally.beside_parts += usize::from(by_parts.is_beside_parts(index));
            let parts = BuildingFootprint::parts(&shape.exterior, &shape.holes);
            if parts.is_empty() {
                tally.empty += 1;
                continue;
            }
            if GroundUnder::parts(lattice, &parts).is_none() {
                tally.off += 1;
                continue;
            }
            tally.mended += usize::from(parts.len() > 1);
            let name = attributes.name(building.name.as_deref());
            crossed.add_polygon(shape, *crossings, || name.clone());
            let whole = by_parts.replaced_outline_of(index);
            let mut level = |parts: &[BuildingFootprint]| {
                let ground =
                    GroundUnder::parts(lattice, parts).filter(|_| building.base == Some(BaseRule::Pad))?;
                let pad_m = pad(lattice, parts, ground.mean_m, &name, collected);
                tally.pads_refused += usize::from(pad_m.is_none());
                pad_m
            };
            let whole = match whole {
                Some(outer) => wholes
                    .entry(outer)
                    .or_insert_with(|| {
                        let parts = outline(outer);
                        WholeBuilding { pad_m: level(&parts), footprint: Arc::new(parts) }
                    })
                    .clone(),
                None => WholeBuilding { pad_m: level(&parts), footprint: Arc::default() },
            };
            let WholeBuilding { pad_m, footprint } = whole;
            let whole = Some(footprint).filter(|footprint| !footprint.is_empty());
            let feature = collected.add(FeatureKind::Building, name, attributes.origin(&building.source));
            plots.push(Plot { table, attributes: attributes.clone(), parts, whole, pad_m, feature });
        }
        let outcome = "it is built in pieces that do not";
        crossed.report(("building", outcome), building.source.span(), sources.frame, &mut collected.findings);
    }
    tally.note(document, &mut collected.findings);
    Ok(BuildingPlots { footprints: plots, models })
}

/// The outline of a building that is drawn by its parts; of another nothing but its pad.
#[derive(Clone)]
struct WholeBuilding {
    footprint: Arc<Vec<BuildingFootprint>>,
    pad_m: Option<f64>,
}

/// Levels the ground under a building and returns its level; `None` where a lake or another pad shares that ground.
pub(super) fn pad(
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
pub(super) struct GroundUnder {
    pub low_m: f64,
    pub mean_m: f64,
    pub high_m: f64,
}

impl GroundUnder {
    /// The height at which a building stands by a rule; without heights of its own on the lowest ground.
    pub(super) fn level_m(&self, rule: BaseRule) -> f64 {
        match rule {
            BaseRule::Lowest | BaseRule::Own => self.low_m,
            BaseRule::Highest => self.high_m,
            BaseRule::Mean | BaseRule::Pad => self.mean_m,
        }
    }

    /// Over all of the finest triangles that the footprints meet; `None` where some have no data.
    pub(super) fn parts(lattice: &Lattice, parts: &[BuildingFootprint]) -> Option<Self> {
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
pub fn raise(
    document: &Document,
    plots: &BuildingPlots,
    ground: DrawnGround<'_>,
    collected: &mut SceneBuilder,
) {
    for plots in &plots.models {
        city_buildings::raise(&document.buildings[plots.table], plots, ground, collected);
    }
    let mut tally = BuildingTally::default();
    for plot in &plots.footprints {
        let building = &document.buildings[plot.table];
        let Some(under) = GroundUnder::parts(ground.lattice, &plot.parts) else {
            tally.off += 1;
            continue;
        };
        // A part stands where its whole building does.
        let whole = plot.whole.as_ref().and_then(|whole| GroundUnder::parts(ground.lattice, whole));
        let base = whole.unwrap_or(under);
        let base_m = match (plot.pad_m, building.base) {
            (Some(level_m), _) => level_m,
            (None, rule) => base.level_m(rule.unwrap_or(BaseRule::Lowest)),
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
    let SceneBuilder { tag_notes, default_counts, .. } = collected;
    let BuildingHeights { low_m, top_m: height_m, is_raised_whole } =
        heights(building, &plot.attributes, tag_notes, default_counts);
    tally.raised_whole += usize::from(is_raised_whole);
    let wish = RoofWish::new(building, &plot.attributes, tag_notes);
    let mut replaced = false;
    for part in &plot.parts {
        let body = |wanted: RoofWord| {
            let made = turned_roof(part, wanted, wish.turn);
            let roof_m = wish.height_m(&made, height_m - low_m);
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
            let is_plain = match made.shape {
                RoofWord::Flat | RoofWord::Gabled | RoofWord::Pyramidal => true,
                RoofWord::Hipped => part.is_convex(),
                _ => false,
            };
            (is_plain || check(&mesh).is_ok()).then_some((made, levels, paint, mesh))
        };
        let Some((made, levels, paint, mesh)) = body(wish.shape).or_else(|| body(RoofWord::Flat)) else {
            continue;
        };
        replaced |= made.shape != wish.shape;
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

fn paint(
    building: &BuildingTable,
    attributes: &Attributes,
    part: &BuildingFootprint,
    made: &UnitRoof,
) -> Paint {
    let by_place = Paint::by_place(part, made);
    let [wall, roof] = stated_colors(building, attributes);
    Paint { wall: wall.unwrap_or(by_place.wall), roof: roof.unwrap_or(by_place.roof), ..by_place }
}

/// The colors of walls and roof by the table, else by the properties.
pub(super) fn stated_colors(building: &BuildingTable, attributes: &Attributes) -> [Option<Srgba>; 2] {
    let color = |stated: Option<Color>, names: [&str; 2]| {
        let tagged = || names.iter().find_map(|name| color_named(&attributes.get(name)?));
        // Walls and roofs are solid, whatever the color's alpha says.
        let solid = |Srgba([red, green, blue, _]): Srgba| Srgba::opaque(red, green, blue);
        stated.map(|color| Srgba(color.0)).or_else(tagged).map(solid)
    };
    [
        color(building.wall_color, ["building:colour", "building:color"]),
        color(building.roof_color, ["roof:colour", "roof:color"]),
    ]
}

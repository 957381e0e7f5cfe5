//! The sea by its coast: ground in it is level, and land beside it is dry.

use crate::builder::SceneBuilder;
use crate::sources::Sources;
use sandtable_base::message::numbers::{counted, fixed};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::{Document, TerrainTable};
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::CoastInside;
use sandtable_earthworks::coast::{self, CoastChanges, CoastError, Coasts, LEAST_LAND_M, SeaGround};
use sandtable_terrain::densify;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::water_cover::{WaterRules, water_cover};
use sandtable_vector::feature::Geometry;

/// The greatest distance between posts at a coast in meters, where the ground is small: what a pier takes.
const SPACING_M: f64 = 10.0;

/// Posts along the longer side of larger ground, where more would be finer than a picture.
const POSTS_ALONG: f64 = 1024.0;

/// Makes the ground follow the document's coasts. The lattice may get more posts.
///
/// # Errors
/// A source cannot be had, its lines have the land on their right, or its polygons hold the other of sea and land.
pub fn lay(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<(), Diagnostic> {
    let Some(first) = document.coasts.first() else { return Ok(()) };
    let coasts = coasts(document, sources)?;
    densify::bring_to(lattice, SPACING_M.max(lattice.extent().size().max_element() / POSTS_ALONG));
    let rules = water_rules(&document.terrain);
    // Lakes are no sea, but land that is as level as they are beside it is rare, and is raised by the least that serves.
    let cover = water_cover(lattice, &WaterRules { infers_level: true, ..rules });
    let sea = SeaGround {
        level_m: rules.sea_level_m.unwrap_or(0.0),
        holds_depths: rules.sea_level_m.is_some(),
        is_water: &cover.is_water,
    };
    let span = first.source.span();
    let changes = coast::follow(lattice, &coasts, sea).map_err(|error| {
        let help = match error {
            CoastError::SeaIsHigher(_) if coasts.lands.is_empty() => {
                "state `inside = \"land\"`, or name the polygons of the sea by `where`"
            }
            CoastError::SeaIsHigher(_) => {
                "state `inside = \"sea\"`, or name the polygons of the land by `where`"
            }
            CoastError::TooLong | CoastError::TooManyEdges => {
                "state an `extent`, or name those of the coast by `where`"
            }
            CoastError::LandOnTheRight(_) => "reverse the lines, or name those of the coast by `where`",
        };
        document.error_at(span.clone(), error).with_help(help)
    })?;
    if changes.sea_posts == 0 && changes.raised_posts == 0 {
        let message = "the coast lies off the elevation model";
        collected.findings.add(FindingCode::LeftOut, span, message);
        return Ok(());
    }
    collected.findings.add(FindingCode::CoastLaid, span, told(&changes, &coasts, sea.level_m));
    Ok(())
}

/// The lines and polygons of a document's coasts.
fn coasts(document: &Document, sources: &Sources<'_>) -> Result<Coasts, Diagnostic> {
    let mut coasts = Coasts::default();
    for table in &document.coasts {
        let polygons_of = match table.inside {
            CoastInside::Sea => &mut coasts.seas,
            CoastInside::Land => &mut coasts.lands,
        };
        for sourced in sources.lines_and_polygons(&table.source)? {
            match sourced.shape {
                Geometry::Lines(lines) => coasts.lines.extend(lines),
                Geometry::Polygons(polygons) => polygons_of.extend(polygons.into_iter().map(|polygon| {
                    std::iter::once(polygon.exterior).chain(polygon.holes).collect::<Vec<_>>()
                })),
                Geometry::Points(_) => (),
            }
        }
    }
    coasts.lines.iter_mut().for_each(Vec::dedup);
    Ok(coasts)
}

/// What the elevations of a document's ground show as water.
pub fn water_rules(terrain: &TerrainTable) -> WaterRules {
    WaterRules {
        infers_level: terrain.infer_water,
        sea_level_m: terrain.sea_level.map(|level_m| level_m as f32),
    }
}

fn told(changes: &CoastChanges, coasts: &Coasts, level_m: f32) -> String {
    let CoastChanges { volumes, raised_posts, highest_cut_m, .. } = changes;
    let land_m = f64::from(level_m) + f64::from(LEAST_LAND_M);
    let counts = [
        (coasts.lines.len(), ["coastline", "coastlines"]),
        (coasts.seas.len(), ["polygon of the sea", "polygons of the sea"]),
        (coasts.lands.len(), ["polygon of land", "polygons of land"]),
    ];
    let counts = counts.into_iter().filter(|(count, _)| *count > 0);
    let counts: Vec<String> = counts.map(|(count, [one, several])| counted(count, one, several)).collect();
    format!(
        "the sea ends at {}: {} m³ cut, at most {} m deep, and {} m³ filled; {} of land are raised to {} m",
        counts.join(" and "),
        fixed(volumes.cut_m3, 0),
        fixed(*highest_cut_m, 0),
        fixed(volumes.fill_m3, 0),
        counted(*raised_posts, "post", "posts"),
        fixed(land_m, 1),
    )
}

//! The sea by its coast: ground in it is level, and land beside it is dry.

use crate::builder::SceneBuilder;
use crate::sources::Sources;
use sandtable_base::message::numbers::{counted, fixed};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::{Document, TerrainTable};
use sandtable_description::finding_code::FindingCode;
use sandtable_earthworks::coast::{self, CoastChanges, LEAST_LAND_M, SeaGround};
use sandtable_terrain::densify;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::water_cover::{WaterRules, water_cover};

/// The greatest distance between posts at a coast in meters, where the ground is small: what a pier takes.
const SPACING_M: f64 = 10.0;

/// Posts along the longer side of larger ground, where more would be finer than a picture.
const POSTS_ALONG: f64 = 1024.0;

/// Makes the ground follow the document's coasts. The lattice may get more posts.
///
/// # Errors
/// A source cannot be had, or its lines have the land on their right.
pub fn lay(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<(), Diagnostic> {
    let Some(first) = document.coasts.first() else { return Ok(()) };
    let mut lines = Vec::new();
    for table in &document.coasts {
        lines.extend(sources.lines(&table.source)?.into_iter().map(|line| line.shape));
    }
    lines.iter_mut().for_each(Vec::dedup);
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
    let changes = coast::follow(lattice, &lines, sea).map_err(|error| {
        let help = "reverse the lines, or name those of the coast by `where`";
        document.error_at(span.clone(), error).with_help(help)
    })?;
    if changes.sea_posts == 0 {
        let message = "the coast lies off the elevation model";
        collected.findings.add(FindingCode::LeftOut, span, message);
        return Ok(());
    }
    collected.findings.add(FindingCode::CoastLaid, span, told(&changes, lines.len(), sea.level_m));
    Ok(())
}

/// What the elevations of a document's ground show as water.
pub fn water_rules(terrain: &TerrainTable) -> WaterRules {
    WaterRules {
        infers_level: terrain.infer_water,
        sea_level_m: terrain.sea_level.map(|level_m| level_m as f32),
    }
}

fn told(changes: &CoastChanges, lines: usize, level_m: f32) -> String {
    let CoastChanges { volumes, raised_posts, highest_cut_m, .. } = changes;
    let land_m = f64::from(level_m) + f64::from(LEAST_LAND_M);
    format!(
        "the sea ends at {}: {} m³ cut, at most {} m deep, and {} m³ filled; {} of land are raised to {} m",
        counted(lines, "coastline", "coastlines"),
        fixed(volumes.cut_m3, 0),
        fixed(*highest_cut_m, 0),
        fixed(volumes.fill_m3, 0),
        counted(*raised_posts, "post", "posts"),
        fixed(land_m, 1),
    )
}

//! Models: every file read once, every placement checked against the ground.
//!
//! ```text
//!  [[model]] at / instances ─► placements ─► footings: pads level the ground ─► report: gaps, volumes
//!  [[scatter]] ───────────────────────────────────────────────────────────────► placements by the thousand
//! ```
//!
//! A placement holds a model, a position in plan and how it meets the ground; each picture computes its height
//! ([`crate::placement`]).

pub mod footings;
pub mod library;
pub mod model_report;
pub mod placed_models;

use crate::builder::SceneBuilder;
use crate::models::placed_models::PlacedModels;
use crate::scatter;
use crate::scene_findings::SceneFindings;
use crate::sources::Sources;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::words::Footing;
use sandtable_terrain::lattice::Lattice;

/// Reads, places and scatters the document's models, and levels the ground under those on pads.
///
/// # Errors
/// A file or a source cannot be read, a model stands off the ground, or there are more than can be placed.
pub fn place<'a>(
    sources: &Sources<'a>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<PlacedModels<'a>, Diagnostic> {
    let document = sources.frame.document;
    let mut placed = PlacedModels::new(document.models.iter(), sources, lattice, collected)?;
    let volumes = footings::level_pads(&placed, sources.frame, lattice)?;
    model_report::add(&placed, &volumes, sources.frame, lattice, collected);
    scatter::strew(sources, lattice, &mut placed, collected)?;
    Ok(placed)
}

/// Levels the ground under models on pads; no other model is read.
///
/// # Errors
/// As for [`place`], for the models on pads.
pub fn level_pads(sources: &Sources<'_>, lattice: &mut Lattice) -> Result<(), Diagnostic> {
    let tables = sources.frame.document.models.iter().filter(|table| *table.footing == Footing::Pad);
    let placed = PlacedModels::new(
        tables,
        sources,
        lattice,
        &mut SceneBuilder::new(SceneFindings::new(sources.frame.document)),
    )?;
    footings::level_pads(&placed, sources.frame, lattice).map(drop)
}

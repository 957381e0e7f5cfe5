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

use crate::build_errors::BuildErrors;
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
/// `collected` keeps an error where a file or a source cannot be read, a model stands off the ground, or there are more than
/// can be placed.
pub fn place<'a>(
    sources: &Sources<'a>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> PlacedModels<'a> {
    let document = sources.frame.document;
    let mut placed = PlacedModels::new(document.models.iter(), sources, lattice, collected);
    let volumes = footings::level_pads(&placed, sources.frame, lattice);
    if let Some(volumes) = collected.errors.keep(volumes) {
        model_report::add(&placed, &volumes, sources.frame, lattice, collected);
    }
    let strewn = scatter::strew(sources, lattice, &mut placed, collected);
    collected.errors.keep(strewn);
    placed
}

/// Levels the ground under models on pads; no other model is read.
///
/// # Errors
/// The first that [`place`] keeps of the models on pads.
pub fn level_pads(sources: &Sources<'_>, lattice: &mut Lattice) -> Result<(), Diagnostic> {
    let tables = sources.frame.document.models.iter().filter(|table| *table.footing == Footing::Pad);
    let mut collected = SceneBuilder::new(SceneFindings::new(sources.frame.document));
    let placed = PlacedModels::new(tables, sources, lattice, &mut collected);
    collected.errors.finish().map_err(BuildErrors::into_first)?;
    footings::level_pads(&placed, sources.frame, lattice).map(drop)
}

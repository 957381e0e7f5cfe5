//! Pads: the ground leveled under models, and limits on the cost of footprints.

use std::collections::BTreeMap;

use crate::footprint::ModelFootprint;
use crate::models::placed_models::PlacedModels;
use crate::placed_model::{GroundFit, Placement};
use crate::placement::{outline, stand};
use crate::vertical_scale::VerticalScale;
use crate::world_frame::WorldFrame;
use sandtable_base::limits::LEVELED_CELLS;
use sandtable_base::limits::LEVELED_PADS;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::ModelPlacement;
use sandtable_description::words::{Clamp, Footing};
use sandtable_earthworks::pad;
use sandtable_earthworks::pad::Batters;
use sandtable_geom::polygon;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::lattice::{HIGHEST_M, Lattice};
use sandtable_terrain::support_surface::SupportSurface;
use sandtable_terrain::volumes::Volumes;

/// The margin of a pad around the footprint, as a part of the longer side.
const PAD_REACH: f32 = 0.1;

/// Levels the ground under every model on a pad, and returns the earth moved by the index of the placement.
///
/// A pad lies at the height of its model's anchor; that of a model at a stated elevation lies at the model's foot.
///
/// # Errors
/// More pads or larger footprints than there can be.
pub fn level_pads(
    placed: &PlacedModels<'_>,
    frame: &WorldFrame<'_>,
    lattice: &mut Lattice,
) -> Result<BTreeMap<usize, Volumes>, Diagnostic> {
    let (mut volumes, mut cells) = (BTreeMap::new(), 0);
    for group in &placed.groups {
        for index in group.placements.clone() {
            let placement = &placed.placements[index];
            let footprint = placed.library.footprint(placement.model);
            if !placement.needs_footprint() && placement.standing.footing == Footing::None {
                continue;
            }
            let reach = polygon::bounds(&outline(placement, &footprint.grown(PAD_REACH)));
            cells += FullResolution { lattice }.cell_count(&reach);
            if cells > LEVELED_CELLS.get() {
                return Err(too_large(frame.document, group.table));
            }
            if placement.standing.footing == Footing::Pad {
                if volumes.len() == LEVELED_PADS.count() {
                    return Err(too_many(frame.document, group.table));
                }
                if let Some(moved) = level(placement, footprint, frame.scale, lattice) {
                    volumes.insert(index, moved);
                }
            }
        }
    }
    Ok(volumes)
}

fn level(
    placement: &Placement,
    footprint: &ModelFootprint,
    scale: VerticalScale,
    lattice: &mut Lattice,
) -> Option<Volumes> {
    let upright = Placement { standing: GroundFit { tilt_rad: 0.0, ..placement.standing }, ..*placement };
    let finest = scale.ground(lattice);
    let found = stand(&upright, footprint, SupportSurface { displayed: &finest, ground: &finest })?;
    let level_z = match placement.clamp {
        Clamp::Absolute => f64::from(found.base(footprint)[0].z),
        Clamp::Ground | Clamp::Relative => found.anchor_z,
    };
    let highest = f64::from(HIGHEST_M);
    let level_m = scale.elevation_m(level_z).clamp(-highest, highest);
    let ring = outline(placement, &footprint.grown(PAD_REACH));
    Some(pad::build_pad(lattice, &ring, level_m, Batters::default()))
}

fn too_many(document: &Document, table: &ModelPlacement) -> Diagnostic {
    let place = table.footing.span().or(table.file.span()).unwrap_or_default();
    let message = format!("more than {LEVELED_PADS} models have the ground leveled for them");
    document
        .error_at(place, message)
        .with_help(format!("use footing = \"plinth\", which moves no earth, or {LEVELED_PADS:#}"))
}

fn too_large(document: &Document, table: &ModelPlacement) -> Diagnostic {
    let place = table.scale.span().or(table.file.span()).unwrap_or_default();
    let message = format!("up to this model, the footprints cover more than {LEVELED_CELLS} cells of ground");
    document
        .error_at(place, message)
        .with_help(format!(
            "check `scale`, the meters per unit of the model file: 0.001 for one in millimeters; or {LEVELED_CELLS:#}"
        ))
}

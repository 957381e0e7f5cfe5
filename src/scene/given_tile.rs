//! Elevation in memory with what a scene file states of it. Heights in memory are meters in a known place: keys that say how a
//! file's numbers become heights are refused rather than ignored.

use sandtable_base::message::suggest::quoted;
use sandtable_dem::hints::DemHints;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_raster::raster::Raster;

/// The elevation called `name`, with the system, the vertical unit and the value for no data that the document states; its vertical
/// datum is taken by whoever compares it with that of other tiles.
///
/// # Errors
/// The document states a key that has no effect on elevation in memory.
pub(super) fn given_tile(
    name: &str,
    raster: &Raster,
    hints: &DemHints<'_>,
    document: &Document,
) -> Result<Raster, Diagnostic> {
    if let Some((key, remedy)) = key_without_effect(document) {
        let message = format!("`{key}` has no effect on '{}', which is elevation in memory", quoted(name));
        let error = document.error(&document.terrain.dem, message).with_code(FindingCode::NoEffect);
        return Err(error.with_help(remedy));
    }
    let mut tile = raster.clone();
    if let Some(stated) = &hints.options.crs {
        tile.crs.iter().for_each(|own| (hints.overridden)(own));
        tile.crs = Some(stated.clone());
    }
    if let Some(meters) = hints.options.vertical_unit {
        (tile.meters_per_z, tile.states_z_unit) = (meters, true);
    }
    if let Some(nodata) = hints.options.nodata {
        tile.samples.clear(nodata);
    }
    Ok(tile)
}

/// The first key that a document states and that elevation in memory does not have, and what to do instead.
fn key_without_effect(document: &Document) -> Option<(&'static str, &'static str)> {
    let terrain = &document.terrain;
    let of_files = "leave it out: it says how a file is read";
    let of_values = "leave it out, and give the array in meters";
    let keys = [
        ("height_encoding", terrain.height_encoding.is_some(), of_values),
        ("height_offset", terrain.height_offset != 0.0, of_values),
        ("height_scale", terrain.height_scale.is_some(), of_values),
        ("raw", terrain.raw.is_some(), of_files),
        ("surface", terrain.surface.is_some(), of_files),
        (
            "cell",
            terrain.cell.is_some() && terrain.dem.len() == 1,
            "leave it out: its transform states the distance between its samples",
        ),
    ];
    keys.into_iter().find(|(_, is_stated, _)| *is_stated).map(|(key, _, remedy)| (key, remedy))
}

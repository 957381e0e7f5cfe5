//! Files that belong to all tiles: the description by which viewers find them, and the coarse levels of pictures.

use std::path::{Path, PathBuf};

use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::ShardPlan;
use crate::tiles::arguments::{TilePyramid, TilesArguments};
use crate::tiles::{colors, meshes};
use sandtable_files::disk;

/// Writes the description of tiles that are all there, and what belongs to several shards; returns the description's place,
/// which is in the folder of the tiles: `out` is refused.
///
/// # Errors
/// An argument is wrong, a result cannot be read, or a file cannot be written.
pub fn gather(
    plan: &ShardPlan,
    arguments: &TilesArguments,
    out: Option<&Path>,
) -> Result<PathBuf, ShardError> {
    arguments.fault().map_or(Ok(()), |fault| Err(plan.wrong_argument(fault)))?;
    let pyramid = arguments.pyramid();
    let name = match pyramid {
        TilePyramid::Meshes(_) => "layer.json",
        TilePyramid::Colors(_) => "tilejson.json",
    };
    if out.is_some() {
        let message = format!("tiles stay where they are, and `{name}` with them; leave out -o");
        return Err(PlanError::new(&plan.folder, PlanFault::Output(message)).into());
    }
    plan.verify_inputs()?;
    let description = match pyramid {
        TilePyramid::Meshes(_) => meshes::layer::layer(arguments),
        TilePyramid::Colors(pyramid) => {
            colors::gather::write_coarse_tiles(plan, &pyramid)?;
            colors::tilejson::tilejson(&pyramid)
        }
    };
    let path = plan.folder.join("tiles").join(name);
    disk::write(&path, format!("{description:#}\n").as_bytes())?;
    Ok(path)
}

//! The index of an atlas: its page and its items.

use std::path::Path;

use crate::atlas::arguments::AtlasArguments;
use crate::atlas::index::{IndexedSheet, page};
use crate::atlas::items::items;
use crate::atlas::work::EXTENSION;
use crate::error::ShardError;
use crate::plan::ShardPlan;
use crate::plan_path::relative;
use crate::record::{ShardState, result_path};
use sandtable_files::disk;
use sandtable_files::output_files::OutputFiles;

/// Writes the page and the items of an atlas whose sheets are in these states.
///
/// # Errors
/// A file cannot be read or written.
pub fn gather(
    plan: &ShardPlan,
    arguments: &AtlasArguments,
    states: &[ShardState],
    (page_path, items_path): (&Path, &Path),
) -> Result<(), ShardError> {
    let scene = arguments.open(&plan.folder)?;
    let title = scene.title.clone().unwrap_or_else(|| disk::file_stem(&arguments.scene));
    let folder = page_path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let sheet = |(id, &state): (usize, &ShardState)| {
        let href = relative(&result_path(plan, id, EXTENSION), folder);
        let href = href.to_string_lossy().replace('\\', "/");
        Ok(IndexedSheet { shard: plan.shard(id)?, state, href })
    };
    let sheets: Vec<IndexedSheet> =
        states.iter().enumerate().map(sheet).collect::<Result<_, ShardError>>()?;
    let items = format!("{:#}\n", items(&title, arguments.scale, &scene.crs, &sheets));
    let mut files = OutputFiles::default();
    files.write(items_path, items.as_bytes())?;
    files.write(page_path, page(&title, arguments.scale, &sheets).as_bytes())?;
    Ok(files.publish()?)
}

//! Cuts the posts of an analysis into tiles.

use std::path::Path;

use crate::analysis::arguments::{AnalysisPlan, OpenedAnalysis};
use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::{self, PlannedProduct};
use crate::shard::{Shard, ShardWindow};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_terrain::lattice::Post;
use sandtable_terrain::post_rect::PostRect;

/// The posts of a tile where no number of shards is stated: a second's work, and some hundred megabytes with what is computed.
const USUAL_POSTS: u64 = 1 << 22;

/// Plans an analysis whose dataset is opened, in about `shards` shards; writes the plan to `folder`, which is there, and returns
/// the number of its shards.
///
/// # Errors
/// The extent is wrong, there is no ground, or a file cannot be written.
pub fn plan(
    arguments: AnalysisPlan,
    opened: &OpenedAnalysis,
    shards: Option<u64>,
    folder: &Path,
) -> Result<usize, ShardError> {
    let posts = opened.parts.posts();
    // A place without ground is refused before anything is written.
    opened.parts.heights(&opened.queried.dataset)?;
    let count = posts.width() as u64 * posts.height() as u64;
    if count > RASTER_SAMPLES.get() {
        let (columns, rows) = (posts.width() as u64, posts.height() as u64);
        return Err(PlanError::new(&opened.queried.path, PlanFault::AnalysisPosts { columns, rows }).into());
    }
    let tiles = tiles(posts, shards.unwrap_or_else(|| count.div_ceil(USUAL_POSTS)));
    let shard = |(id, &tile): (usize, &PostRect)| {
        let Post { column, row } = tile.first;
        let (width, height) = (tile.width() as u32, tile.height() as u32);
        let name = format!("{width} x {height} posts from column {column} and row {row}");
        let window = ShardWindow::Grid([column, row, width, height]);
        Shard { halo: opened.parts.reach(), ..Shard::new(id, name, opened.parts.work(tile), window) }
    };
    let lines: Vec<Shard> = tiles.iter().enumerate().map(shard).collect();
    let inputs = arguments.dataset.inputs(&opened.queried.dataset, folder)?;
    plan::write(folder, PlannedProduct::Analysis(arguments), inputs, &lines)?;
    Ok(lines.len())
}

/// About `count` rectangles that share the posts, none with less than two a side, row by row from the south-west.
fn tiles(posts: PostRect, count: u64) -> Vec<PostRect> {
    let (width, height) = (posts.width() as u64, posts.height() as u64);
    // Squares: as many columns of them as the rectangle is wider than high.
    let wide = (count as f64 * width as f64 / height as f64).sqrt().round() as u64;
    let across = wide.clamp(1, width / 2);
    let down = count.div_ceil(across).clamp(1, height / 2);
    let ends = |first: u32, length: u64, parts: u64| {
        let at = move |part: u64| first + (length * part / parts) as u32;
        (0..parts).map(move |part| (at(part), at(part + 1) - 1))
    };
    let PostRect { first, .. } = posts;
    ends(first.row, height, down)
        .flat_map(|(south, north)| {
            ends(first.column, width, across).map(move |(west, east)| PostRect {
                first: Post { column: west, row: south },
                last: Post { column: east, row: north },
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(column: u32, row: u32, width: u32, height: u32) -> PostRect {
        let first = Post { column, row };
        PostRect { first, last: first.offset(width - 1, height - 1) }
    }

    #[test]
    fn tiles_share_all_posts_and_none_is_narrower_than_two() {
        for (posts, count) in [
            (rect(3, 5, 40, 30), 6),
            (rect(0, 0, 7, 900), 12),
            (rect(1, 1, 2, 2), 50),
            (rect(0, 0, 5, 3), u64::MAX),
            (rect(9, 0, 100, 2), 1),
        ] {
            let tiles = tiles(posts, count);
            let mut hits = vec![0; posts.width() * posts.height()];
            for tile in &tiles {
                assert!(tile.width() > 1 && tile.height() > 1, "{tile:?}");
                tile.posts().for_each(|post| hits[posts.index(post)] += 1);
            }
            assert!(hits.iter().all(|&hit| hit == 1), "{posts:?} in {count}");
        }
        assert_eq!(tiles(rect(0, 0, 40, 30), 12).len(), 12);
        assert_eq!(tiles(rect(0, 0, 4000, 4000), 1), [rect(0, 0, 4000, 4000)]);
    }
}

//! Cuts a table of observers into shards.

use std::path::Path;

use glam::DVec2;

use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::{self, PlannedProduct};
use crate::planned_dataset::QueriedDataset;
use crate::point_stream::PointStream;
use crate::shard::{Shard, ShardWindow};
use crate::viewsheds::arguments::ViewshedsArguments;
use sandtable_base::limits::{PLAN_OBSERVERS, RASTER_SAMPLES};
use sandtable_geom::crs::Crs;
use sandtable_geom::morton;
use sandtable_geom::rect::Rect;
use sandtable_query::dataset::{QueryError, transform};
use sandtable_query::ground::QueriedGround;
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::{Interpolation, Surface};

/// The posts that a shard looks at where no number of shards is stated: some seconds' work.
const USUAL_POSTS: u64 = 1 << 25;
/// How many times as many posts as its observers look at the rectangle of a shard may have: the rest is written for nothing.
const MOST_SPREAD: u64 = 4;
/// Posts around the range, for rounding.
const HALO: f64 = 1.0;

/// An observer, and the posts within its range.
#[derive(Clone, Copy, Debug)]
struct PlannedObserver {
    at: DVec2,
    posts: PostRect,
}

/// Plans the viewsheds of the observers that `arguments` name, on their dataset opened, in about `shards` shards; writes the
/// plan to `folder`, which is there, and returns the number of its shards.
///
/// # Errors
/// An observer has no ground, the elevation cannot be read, or a file cannot be written.
pub fn plan(
    arguments: ViewshedsArguments,
    queried: &QueriedDataset,
    shards: Option<u64>,
    folder: &Path,
) -> Result<usize, ShardError> {
    let table = folder.join(&arguments.points);
    let at = observers(&table, &queried.crs)?;
    check_ground(queried, &at)?;
    let ground = frame(queried, at[0])?;
    let observer = |&at: &DVec2| -> Result<PlannedObserver, ShardError> {
        let place = transform("the observer at", &queried.crs, &ground.crs, at)?;
        Ok(PlannedObserver { at, posts: posts_in_range(&ground.lattice, place, arguments.range_m()) })
    };
    let observers = along_curve(&at.iter().map(observer).collect::<Result<Vec<_>, _>>()?);
    check_region(&observers, &table)?;
    let all: u64 = observers.iter().map(|observer| posts(observer.posts)).sum();
    let most = shards.map_or(USUAL_POSTS, |shards| all.div_ceil(shards));
    let groups = grouped(&observers, most);
    let lines: Vec<Shard> = (0..).zip(&groups).map(|(id, group)| shard(id, group)).collect();
    let inputs = arguments.dataset.inputs(&queried.dataset, folder)?;
    plan::write(folder, PlannedProduct::Viewsheds(arguments), inputs, &lines)?;
    Ok(lines.len())
}

/// The positions of a table in `crs`, at least one.
fn observers(table: &Path, crs: &Crs) -> Result<Vec<DVec2>, ShardError> {
    let mut observers = Vec::new();
    PointStream::open(table, crs)?.each_batch(|positions| {
        observers.extend(positions.iter().map(|position| position.at));
        if observers.len() as u64 > PLAN_OBSERVERS.get() {
            return Err(PlanError::new(table, PlanFault::TooManyObservers).into());
        }
        Ok(())
    })?;
    if observers.is_empty() { Err(PlanError::new(table, PlanFault::NoPoints).into()) } else { Ok(observers) }
}

/// Checks that every observer stands on ground.
fn check_ground(queried: &QueriedDataset, at: &[DVec2]) -> Result<(), ShardError> {
    let heights = queried.dataset.heights(Surface::Ground, Interpolation::Planar, &queried.crs, at)?;
    match at.iter().zip(heights).find(|(_, answer)| answer.height_m().is_none()) {
        Some((&at, answer)) => {
            Err(QueryError::NoGround { what: "the observer at".into(), at, answer }.into())
        }
        None => Ok(()),
    }
}

/// The frame of the ground: its lattice may hold no more than the posts around `near`.
pub fn frame(queried: &QueriedDataset, near: DVec2) -> Result<QueriedGround, ShardError> {
    let reach = GroundReach { crs: &queried.crs, at: &[near], around_m: 0.0 };
    Ok(queried.dataset.ground(&reach)?)
}

/// The posts of the whole ground that an observer at map coordinates may look at.
fn posts_in_range(lattice: &Lattice, at: DVec2, range_m: f64) -> PostRect {
    let (grid, reach) = (lattice.grid_from_map(at), range_m / lattice.cell() + HALO);
    let last = DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1));
    let post = |grid: DVec2| Post::at_grid(grid.clamp(DVec2::ZERO, last));
    PostRect { first: post((grid - reach).floor()), last: post((grid + reach).ceil()) }
}

fn posts(rect: PostRect) -> u64 {
    rect.width() as u64 * rect.height() as u64
}

/// Observers in the order in which neighbors lie near each other.
fn along_curve(observers: &[PlannedObserver]) -> Vec<PlannedObserver> {
    let rect = |observer: &PlannedObserver| Rect { min: observer.at, max: observer.at };
    let ranks = morton::ranks(&observers.iter().map(rect).collect::<Vec<_>>());
    let mut order: Vec<(u32, PlannedObserver)> = ranks.into_iter().zip(observers.iter().copied()).collect();
    order.sort_by_key(|&(rank, _)| rank);
    order.into_iter().map(|(_, observer)| observer).collect()
}

/// The smallest rectangle that holds those of all observers.
fn region(observers: &[PlannedObserver]) -> PostRect {
    let start = observers[0].posts;
    observers.iter().fold(start, |all, observer| all.with(observer.posts.first).with(observer.posts.last))
}

/// Checks that what is gathered can be held.
fn check_region(observers: &[PlannedObserver], table: &Path) -> Result<(), ShardError> {
    let all = region(observers);
    if posts(all) <= RASTER_SAMPLES.get() {
        return Ok(());
    }
    let (columns, rows) = (all.width() as u64, all.height() as u64);
    Err(PlanError::new(table, PlanFault::Region { columns, rows }).into())
}

/// Observers in a row that together look at no more than `most` posts, or one.
fn grouped(observers: &[PlannedObserver], most: u64) -> Vec<Vec<PlannedObserver>> {
    let mut groups: Vec<Vec<PlannedObserver>> = Vec::new();
    // Of the last group: the posts that its observers look at, and the rectangle that holds them.
    let (mut looked_at, mut around) = (u64::MAX, observers[0].posts);
    for &observer in observers {
        let PostRect { first, last } = observer.posts;
        let all = looked_at.saturating_add(posts(observer.posts));
        let grown = around.with(first).with(last);
        match groups.last_mut() {
            Some(group) if all <= most && posts(grown) <= all.saturating_mul(MOST_SPREAD) => {
                group.push(observer);
                (looked_at, around) = (all, grown);
            }
            _ => {
                groups.push(vec![observer]);
                (looked_at, around) = (posts(observer.posts), observer.posts);
            }
        }
    }
    groups
}

fn shard(id: usize, group: &[PlannedObserver]) -> Shard {
    let around = region(group);
    let looked_at: u64 = group.iter().map(|observer| posts(observer.posts)).sum();
    let noun = if group.len() == 1 { "observer" } else { "observers" };
    let name = format!("{} {noun} at {}, {}", group.len(), group[0].at.x, group[0].at.y);
    let Post { column, row } = around.first;
    let window = ShardWindow::Grid([column, row, around.width() as u32, around.height() as u32]);
    let observers = group.iter().map(|observer| observer.at.to_array()).collect();
    Shard { observers: Some(observers), ..Shard::new(id, name, looked_at as f64, window) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn observer(column: u32, row: u32) -> PlannedObserver {
        let first = Post { column, row };
        let posts = PostRect { first, last: first.offset(9, 9) };
        PlannedObserver { at: first.grid(), posts }
    }

    #[test]
    fn neighbors_share_a_shard_up_to_its_work_and_its_spread() {
        let near: Vec<PlannedObserver> = (0..7).map(|index| observer(index, 0)).collect();
        let sizes = |groups: Vec<Vec<_>>| groups.iter().map(Vec::len).collect::<Vec<usize>>();
        assert_eq!(sizes(grouped(&near, 300)), [3, 3, 1]);
        assert_eq!(sizes(grouped(&near, 1)), [1; 7]);
        let apart = [observer(0, 0), observer(5, 5), observer(900, 900)];
        assert_eq!(sizes(grouped(&apart, 1_000_000)), [2, 1]);
    }
}

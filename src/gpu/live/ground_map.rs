//! A ground map on the device of which edits change rectangles.
//!
//! A changed post changes the coarser levels over it, from which far ground is read: of each level the few posts that
//! depend on it are made anew and sent, and nothing else.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::ground::{GroundTextures, PlacedLevel, levels};
use sandtable_draw::ground::{GroundMap, GroundMapError, GroundPost};
use sandtable_draw::ground_levels::{GroundLevel, PostCount, coarser_levels, coarser_post};
use sandtable_draw::list::DrawListError;
use sandtable_draw::patches::GroundMapPatch;

/// A map and its changes.
///
/// Changes are kept by rows: a copy of a large map would take longer than a frame, and so would its coarser levels, which
/// are therefore made with it, but for the first: its posts follow from few others.
#[derive(Debug, Default)]
pub struct EditedMap {
    map: Option<Arc<GroundMap>>,
    /// The rows of the map that were changed, as they are now.
    rows: BTreeMap<u32, Vec<GroundPost>>,
    /// The levels after the first coarser one.
    coarser: Vec<GroundLevel>,
}

/// What a change changes of a level.
#[derive(Clone, Debug, PartialEq)]
struct LevelChange {
    window: ChangedPosts,
    /// The posts of the window, row by row.
    posts: Vec<GroundPost>,
}

/// A rectangle of posts: its first column and row, and the ones after its last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ChangedPosts {
    from: [u32; 2],
    to: [u32; 2],
}

impl ChangedPosts {
    /// Those posts of the next coarser level, of size `coarser`, that depend on these.
    fn halved(self, coarser: PostCount) -> Self {
        let last = [coarser.columns, coarser.rows];
        let to = [0, 1].map(|axis| (self.to[axis] / 2 + 1).min(last[axis]));
        Self { from: self.from.map(|first| first / 2), to }
    }

    /// Its posts, row by row.
    fn posts(self) -> impl Iterator<Item = [u32; 2]> {
        let columns = self.from[0]..self.to[0];
        (self.from[1]..self.to[1]).flat_map(move |row| columns.clone().map(move |column| [column, row]))
    }
}

impl EditedMap {
    /// A map as it is loaded; takes a pass over its posts.
    pub fn new(map: Option<Arc<GroundMap>>) -> Self {
        let coarser = map.as_deref().map_or_else(Vec::new, |map| coarser_levels(map).skip(1).collect());
        Self { map, rows: BTreeMap::new(), coarser }
    }

    /// The map as it was loaded: its posts may have changed.
    pub fn map(&self) -> Option<&GroundMap> {
        self.map.as_deref()
    }

    /// Applies a change and sends it; returns the bytes sent.
    ///
    /// # Errors
    /// [`GpuError::List`] where it does not lie on the map.
    pub fn change(
        &mut self,
        gpu: &Gpu,
        textures: &GroundTextures,
        change: &GroundMapPatch,
    ) -> Result<u64, GpuError> {
        let Some(map) = &self.map else { return Ok(0) };
        let places = levels(PostCount::from_map(map));
        let changed = self.changed_levels(change)?;
        Ok(changed.iter().zip(places).map(|(change, place)| send(gpu, textures, place, change)).sum())
    }

    /// Takes over a change; returns what it changes of each level, the map itself first.
    fn changed_levels(&mut self, change: &GroundMapPatch) -> Result<Vec<LevelChange>, GpuError> {
        let Self { map: Some(map), rows, coarser } = self else { return Ok(Vec::new()) };
        let size = PostCount::from_map(map);
        let window = window(change, size)?;
        let loaded = |row: u32| &map.posts[row as usize * size.columns as usize..][..size.columns as usize];
        let [first, end] = [window.from[0] as usize, window.to[0] as usize];
        for (row, posts) in (window.from[1]..).zip(change.posts.chunks_exact(end - first)) {
            let own = rows.entry(row).or_insert_with(|| loaded(row).to_vec());
            own[first..end].copy_from_slice(posts);
        }
        let post = |[column, row]: [u32; 2]| {
            rows.get(&row).map_or_else(|| loaded(row), Vec::as_slice)[column as usize]
        };
        let mut changed = vec![LevelChange { window, posts: change.posts.clone() }];
        let Some(first_size) = size.halved() else { return Ok(changed) };
        let first_post = |at: [u32; 2]| coarser_post(size, post, at);
        let mut window = window.halved(first_size);
        changed.push(LevelChange { window, posts: window.posts().map(first_post).collect() });
        for index in 0..coarser.len() {
            let (finer, level) = coarser.split_at_mut(index);
            let Some(level) = level.first_mut() else { break };
            window = window.halved(level.size);
            let posts: Vec<GroundPost> = match finer.last() {
                None => window.posts().map(|at| coarser_post(first_size, first_post, at)).collect(),
                Some(finer) => {
                    let post = |at: [u32; 2]| finer.posts[index_of(finer.size, at)];
                    window.posts().map(|at| coarser_post(finer.size, post, at)).collect()
                }
            };
            window.posts().zip(&posts).for_each(|(at, &post)| level.posts[index_of(level.size, at)] = post);
            changed.push(LevelChange { window, posts });
        }
        Ok(changed)
    }
}

fn index_of(size: PostCount, [column, row]: [u32; 2]) -> usize {
    row as usize * size.columns as usize + column as usize
}

/// The posts that a change is of; it must be of some, and of the map's.
fn window(change: &GroundMapPatch, size: PostCount) -> Result<ChangedPosts, GpuError> {
    let GroundMapPatch { first, columns, posts } = change;
    let rows = posts.len() as u64 / u64::from((*columns).max(1));
    let is_whole = *columns > 0 && rows > 0 && rows * u64::from(*columns) == posts.len() as u64;
    let fits = u64::from(first[0]) + u64::from(*columns) <= u64::from(size.columns)
        && u64::from(first[1]) + rows <= u64::from(size.rows);
    if !(is_whole && fits) {
        let error = GroundMapError::PostCount(*columns, rows as u32, posts.len());
        return Err(GpuError::List(DrawListError::GroundMap(error)));
    }
    Ok(ChangedPosts { from: *first, to: [first[0] + columns, first[1] + rows as u32] })
}

/// Sends what has changed of a level.
fn send(gpu: &Gpu, textures: &GroundTextures, place: PlacedLevel, change: &LevelChange) -> u64 {
    let LevelChange { window, posts } = change;
    let rows = (window.from[1]..).zip(posts.chunks_exact((window.to[0] - window.from[0]) as usize));
    let sent = rows.map(|(row, posts)| {
        textures.write(gpu, place.first + row * place.size.columns + window.from[0], posts)
    });
    sent.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(columns: u32, rows: u32, height: impl Fn(u32) -> f32) -> GroundMap {
        let post = |index| GroundPost { height_m: height(index), ..GroundPost::default() };
        let posts = (0..columns * rows).map(post).collect();
        GroundMap { columns, rows, posts, ..GroundMap::level() }
    }

    #[test]
    fn the_posts_that_depend_on_a_change_are_all_that_differ_on_every_level() {
        let hilly = |index: u32| (index * 37 % 101) as f32;
        let before = map(37, 22, hilly);
        for changed in [0, 5, 36, 37 * 11 + 20, 37 * 21, 37 * 22 - 1] {
            let after = map(37, 22, |index| if index == changed { 500.0 } else { hilly(index) });
            let at = [changed % 37, changed / 37];
            let mut window = ChangedPosts { from: at, to: at.map(|place| place + 1) };
            for (old, new) in coarser_levels(&before).zip(coarser_levels(&after)) {
                window = window.halved(new.size);
                for (index, (old, new_post)) in (0..).zip(old.posts.iter().zip(&new.posts)) {
                    let [x, y] = [index % new.size.columns, index / new.size.columns];
                    let inside = (window.from[0]..window.to[0]).contains(&x)
                        && (window.from[1]..window.to[1]).contains(&y);
                    assert!(inside || old == new_post, "post {x}, {y} of {:?} after {at:?}", new.size);
                }
            }
        }
    }

    #[test]
    fn changes_make_the_levels_that_the_changed_map_has() {
        let mut map = map(37, 22, |index| (index * 37 % 101) as f32);
        let mut edited = EditedMap::new(Some(Arc::new(map.clone())));
        let mut known: Vec<Vec<GroundPost>> =
            std::iter::once(map.posts.clone()).chain(coarser_levels(&map).map(|level| level.posts)).collect();
        for (first, columns, rows) in [([5, 3], 4, 2), ([0, 0], 1, 1), ([36, 21], 1, 1), ([2, 4], 30, 17)] {
            let posts =
                (0..columns * rows).map(|at| GroundPost { height_m: 500.0 + at as f32, ..map.posts[0] });
            let change = GroundMapPatch { first, columns, posts: posts.collect() };
            let places = ChangedPosts { from: first, to: [first[0] + columns, first[1] + rows] }.posts();
            places.zip(&change.posts).for_each(|([x, y], &post)| map.posts[(y * 37 + x) as usize] = post);
            let sizes: Vec<PostCount> =
                std::iter::successors(Some(PostCount::from_map(&map)), |size| size.halved()).collect();
            let changed = edited.changed_levels(&change).expect("on the map");
            assert_eq!(changed.len(), sizes.len());
            for ((known, change), &size) in known.iter_mut().zip(&changed).zip(&sizes) {
                let places = change.window.posts().zip(&change.posts);
                places.for_each(|(at, &post)| known[index_of(size, at)] = post);
            }
            let anew =
                std::iter::once(map.posts.clone()).chain(coarser_levels(&map).map(|level| level.posts));
            assert!(known.iter().cloned().eq(anew), "after a change at {first:?}");
        }
    }

    #[test]
    fn a_change_beside_the_map_is_refused() {
        let size = PostCount { columns: 9, rows: 5 };
        let change = |first, columns, posts| GroundMapPatch {
            first,
            columns,
            posts: vec![GroundPost::default(); posts],
        };
        assert!(window(&change([7, 3], 2, 4), size).is_ok());
        for wrong in [change([8, 0], 2, 4), change([0, 4], 2, 4), change([0, 0], 2, 3), change([0, 0], 0, 4)]
        {
            assert!(window(&wrong, size).is_err(), "{wrong:?}");
        }
    }
}

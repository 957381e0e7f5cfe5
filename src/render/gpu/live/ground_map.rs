//! A ground map on the device of which edits change rectangles.
//!
//! A changed post changes the coarser levels over it, from which far ground is read: of each level the few posts that
//! depend on it are made anew and sent, and nothing else.

use std::sync::Arc;

use crate::draw::ground::{GroundMap, GroundMapError, GroundPost};
use crate::draw::ground_levels::{GroundLevel, PostCount, coarser_levels, coarser_post};
use crate::draw::list::DrawListError;
use crate::draw::patches::GroundMapPatch;
use crate::render::gpu::adapter::Gpu;
use crate::render::gpu::error::GpuError;
use crate::render::gpu::ground::{GroundTextures, levels};

/// A map and, from the first change on, its coarser levels.
#[derive(Debug, Default)]
pub struct EditedMap {
    map: Option<Arc<GroundMap>>,
    coarser: Vec<GroundLevel>,
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
}

impl EditedMap {
    pub fn new(map: Option<Arc<GroundMap>>) -> Self {
        Self { map, coarser: Vec::new() }
    }

    pub fn map(&self) -> Option<&GroundMap> {
        self.map.as_deref()
    }

    /// Takes over a change and sends it; returns the bytes sent.
    ///
    /// # Errors
    /// [`GpuError::List`] where it does not lie on the map.
    pub fn change(
        &mut self,
        gpu: &Gpu,
        textures: &GroundTextures,
        change: &GroundMapPatch,
    ) -> Result<u64, GpuError> {
        let Some(map) = &mut self.map else { return Ok(0) };
        let size = PostCount::from_map(map);
        let window = window(change, size)?;
        let own = Arc::make_mut(map);
        let width = (window.to[0] - window.from[0]) as usize;
        for (row, posts) in (window.from[1]..).zip(change.posts.chunks_exact(width)) {
            let start = row as usize * size.columns as usize + window.from[0] as usize;
            own.posts[start..start + width].copy_from_slice(posts);
        }
        if self.coarser.is_empty() {
            self.coarser = coarser_levels(own).collect();
        }
        let places = levels(size);
        let mut sent = send(gpu, textures, places[0].first, size, &own.posts, window);
        let mut window = window;
        for index in 0..self.coarser.len().min(places.len() - 1) {
            let (finer, coarser) = self.coarser.split_at_mut(index);
            let Some(level) = coarser.first_mut() else { break };
            let (finer_size, posts) =
                finer.last().map_or((size, &own.posts), |finer| (finer.size, &finer.posts));
            window = window.halved(level.size);
            for row in window.from[1]..window.to[1] {
                for column in window.from[0]..window.to[0] {
                    let at = row as usize * level.size.columns as usize + column as usize;
                    level.posts[at] = coarser_post(finer_size, posts, [column, row]);
                }
            }
            sent += send(gpu, textures, places[index + 1].first, level.size, &level.posts, window);
        }
        Ok(sent)
    }
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

/// Sends a rectangle of the posts of a level whose first post has the number `first`.
fn send(
    gpu: &Gpu,
    textures: &GroundTextures,
    first: u32,
    size: PostCount,
    posts: &[GroundPost],
    window: ChangedPosts,
) -> u64 {
    let rows = window.from[1]..window.to[1];
    let sent = rows.map(|row| {
        let start = row * size.columns + window.from[0];
        let end = row * size.columns + window.to[0];
        textures.write(gpu, first + start, &posts[start as usize..end as usize])
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

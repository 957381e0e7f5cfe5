//! The ground map of a walk after edits: heights and slopes of the posts that they moved.
//!
//! Shares of the sun and of the sky stay as they were: shadows that a crater casts are hardly longer than it is wide, and its
//! slopes are shaded by themselves.

use std::sync::{Arc, Mutex, PoisonError};

use sandtable_draw::ground::{GroundMap, GroundPost};
use sandtable_draw::patches::GroundMapPatch;
use sandtable_scene::vertical_scale::VerticalScale;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// The map that was loaded last, and what edits changed of it.
#[derive(Debug, Default)]
pub(super) struct ReliefMap {
    loaded: Mutex<Option<Arc<GroundMap>>>,
    /// All that was edited: maps that are loaded later are changed by it, too.
    edits: ReliefEdits,
    new: Vec<GroundMapPatch>,
}

/// The posts that edits changed, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct ReliefEdits {
    posts: Vec<PostRect>,
    /// How elevations are drawn; `None` before the first edit.
    scale: Option<VerticalScale>,
}

impl ReliefEdits {
    /// Applies the edits to a map.
    pub fn apply(&self, map: &mut Arc<GroundMap>, elevations: &Lattice) {
        let Some(scale) = self.scale else { return };
        let patches: Vec<GroundMapPatch> =
            self.posts.iter().filter_map(|&posts| patch(map, elevations, scale, posts)).collect();
        let own = Arc::make_mut(map);
        for GroundMapPatch { first: [column, row], columns, posts } in patches {
            for (at, posts) in posts.chunks_exact(columns as usize).enumerate() {
                let start = (row as usize + at) * own.columns as usize + column as usize;
                own.posts[start..start + posts.len()].copy_from_slice(posts);
            }
        }
    }
}

impl ReliefMap {
    /// The edits so far.
    pub fn edits(&self) -> &ReliefEdits {
        &self.edits
    }

    /// Keeps the map that is loaded, which the edits so far have changed.
    pub fn keep(&self, map: &Arc<GroundMap>) {
        *self.loaded.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(map));
    }

    /// Keeps the map that is loaded, which `known` have changed: what was edited since is new.
    pub fn take_over(&mut self, map: &Arc<GroundMap>, known: &ReliefEdits, elevations: &Lattice) {
        self.keep(map);
        self.new.clear();
        if let Some(scale) = self.edits.scale {
            let later = self.edits.posts.iter().skip(known.posts.len());
            self.new.extend(later.filter_map(|&posts| patch(map, elevations, scale, posts)));
        }
    }

    /// Notes that the elevations of posts have changed.
    pub fn edit(&mut self, elevations: &Lattice, scale: VerticalScale, posts: PostRect) {
        self.edits.scale = Some(scale);
        self.edits.posts.push(posts);
        let loaded = self.loaded.get_mut().unwrap_or_else(PoisonError::into_inner);
        self.new.extend(loaded.as_deref().and_then(|map| patch(map, elevations, scale, posts)));
    }

    /// The changes of the loaded map since the last call.
    pub fn take_new(&mut self) -> Vec<GroundMapPatch> {
        std::mem::take(&mut self.new)
    }
}

/// The posts of `map` whose height or slope depends on the elevations in a rectangle; `None` where there are none.
fn patch(
    map: &GroundMap,
    elevations: &Lattice,
    scale: VerticalScale,
    edited: PostRect,
) -> Option<GroundMapPatch> {
    // Every second, fourth, eighth … post.
    let step = (map.cell.x / elevations.cell().as_vec2().x).round().max(1.0) as u32;
    let PostRect { first, last } = edited.grown((1, 1), elevations);
    let (west, south) = (first.column.div_ceil(step), first.row.div_ceil(step));
    let (east, north) = ((last.column / step).min(map.columns - 1), (last.row / step).min(map.rows - 1));
    if west > east || south > north {
        return None;
    }
    let post = |column: u32, row: u32| {
        let at = Post { column: column * step, row: row * step };
        let before = map.posts[row as usize * map.columns as usize + column as usize];
        let height_m = elevations.height(at);
        if height_m.is_nan() {
            return before;
        }
        let slopes = elevations.shaded_slopes(at);
        GroundPost {
            height_m,
            slope_east: scale.world_z(slopes.x),
            slope_north: scale.world_z(slopes.y),
            ..before
        }
    };
    let posts = (south..=north).flat_map(|row| (west..=east).map(move |column| (column, row)));
    let posts = posts.map(|(column, row)| post(column, row)).collect();
    Some(GroundMapPatch { first: [west, south], columns: east - west + 1, posts })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn a_patch_has_the_slopes_of_the_edited_ground_and_nothing_else_changes() {
        let heights: Vec<f32> = (0..81).map(|at| (at % 9) as f32).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(2.0), 9, heights).expect("sound");
        let blank = GroundPost { sun_visibility: 0.25, ..GroundPost::default() };
        let map = GroundMap {
            cell: glam::Vec2::splat(2.0),
            columns: 9,
            rows: 9,
            posts: vec![blank; 81],
            ..GroundMap::level()
        };
        let mut relief = ReliefMap::default();
        let first = relief.edits().clone();
        relief.keep(&Arc::new(map.clone()));
        let edited = PostRect { first: Post { column: 3, row: 4 }, last: Post { column: 4, row: 4 } };
        relief.edit(&lattice, VerticalScale(3.0), edited);
        let new = relief.take_new();
        assert_eq!((new.len(), new[0].first, new[0].columns, new[0].posts.len()), (1, [2, 3], 4, 12));
        assert!(new[0].posts.iter().all(|post| post.slope_east == 1.5 && post.sun_visibility == 0.25));
        assert_eq!(relief.take_new(), []);
        let mut later = Arc::new(map.clone());
        relief.edits().apply(&mut later, &lattice);
        let changed = later.posts.iter().filter(|post| **post != blank).count();
        assert_eq!(changed, 12);
        assert_eq!(later.posts[4 * 9 + 3].height_m, 3.0);
        relief.take_over(&Arc::new(map), &first, &lattice);
        assert_eq!(relief.take_new(), new, "what was edited while the map was made is handed over after it");
    }
}

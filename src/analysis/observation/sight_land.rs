//! The land as sight has it: trees and buildings raise it where they stand.
//!
//! ```text
//!               ┌───────────┐ tops               What stands blocks sight as ground of its height would, by the one
//!               │   trees   │                    definition of sight over the triangles between the posts.
//!    eye o······│···········│······o target
//!   ────────────┴───────────┴────────────        A target under trees or a roof is at their edge where open ground
//!    |--30 m--|  |-30 m-|                        lies near, and else hidden; around an eye nothing is in its way.
//! ```
//!
//! **Under trees and roofs.** A target below the tops of what stands at its post is seen where the first open post to its
//! east, north, west or south is, as far as one lies within [`EDGE_M`] or is the next post: a wood shows its edge, and hides
//! its depth. A target above the tops is seen as over open ground of its own height.
//!
//! **Around an eye** trees and buildings within [`EDGE_M`], and at the posts of its cell, hide nothing: a post is placed where
//! it sees out of a wood or a house, at a gap smaller than elevation posts show. Farther trees are in its way.
//!
//! Without anything that stands, all is the ground's own answer to the last bit, and nothing is copied.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use super::lookout::{LookWindow, LookoutView};
use crate::error::AnalysisError;
use crate::land::Land;
use crate::place::{missing_ground, nearest_post};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::sight::line::{Sight, SightEnd, line_of_sight};
use sandtable_terrain::sight::viewshed::rises::required_rises;
use sandtable_terrain::sight::viewshed::{PostVisibility, SWEEP_UNITS, ViewshedOptions, viewshed_until};
use sandtable_terrain::stop_flag::StopFlag;

/// How far sight reaches into woods and houses from their edge, and out of them from an eye, meters. No manual has a number;
/// in leaf one sees some 20 to 50 m into a wood.
pub(crate) const EDGE_M: f64 = 30.0;

/// The land as sight has it; cheap to clone.
#[derive(Clone)]
pub(crate) struct SightLand {
    /// The ground, raised by what stands on it.
    tops: Arc<Lattice>,
    ground: Arc<Lattice>,
    /// The height of what stands at each post, meters; negative where it is in no eye's way, and no open ground either. `None`
    /// where nothing stands, or nothing is known of it.
    standing_m: Option<Arc<Vec<f32>>>,
}

impl SightLand {
    /// The land of an analysis.
    pub fn new(land: &Land) -> Self {
        let ground = land.ground.clone();
        let stands = |heights: &&Vec<f32>| heights.par_iter().any(|&height_m| height_m > 0.0);
        let Some(heights) = land.obstacles_m.as_ref().filter(stands) else {
            return Self { tops: ground.clone(), ground, standing_m: None };
        };
        let standing_m: Vec<f32> = heights.par_iter().map(|height_m| height_m.max(0.0)).collect();
        let mut tops = (*ground).clone();
        let last = ground.columns() - 1;
        for (row, standing_m) in (0..).zip(standing_m.chunks(ground.columns() as usize)) {
            let heights = tops.heights_mut(Post { column: 0, row }, last);
            heights.iter_mut().zip(standing_m).for_each(|(top, &height_m)| *top += height_m);
        }
        Self { tops: Arc::new(tops), ground, standing_m: Some(Arc::new(standing_m)) }
    }

    /// The land where nothing is in the way around these eyes, from whichever side.
    pub fn cleared_around(mut self, eyes: impl IntoIterator<Item = DVec2>) -> Self {
        for eye in eyes {
            let posts = self.in_the_way_around(eye);
            let Some(standing_m) = self.standing_m.as_mut().filter(|_| !posts.is_empty()) else { continue };
            let (standing_m, tops) = (Arc::make_mut(standing_m), Arc::make_mut(&mut self.tops));
            for post in posts {
                let height_m = &mut standing_m[self.ground.index(post)];
                *height_m = -*height_m;
                tops.heights_mut(post, post.column)[0] = self.ground.height(post);
            }
        }
        self
    }

    /// What sight goes over.
    pub fn tops(&self) -> &Arc<Lattice> {
        &self.tops
    }

    /// The height of what stands at a post, meters; negative where it is in no eye's way.
    #[inline]
    fn standing_m(&self, post: Post) -> f32 {
        self.standing_m.as_ref().map_or(0.0, |heights| heights[self.ground.index(post)])
    }

    /// The ends of lines to a target so high above the ground at a place: one that sees any of them sees it. None where it is
    /// deep under trees or a roof.
    pub fn target(&self, at: DVec2, above_m: f64) -> impl Iterator<Item = SightEnd> {
        let post = nearest_post(&self.ground, at).map(|index| self.ground.post_at(index));
        let under = post.filter(|&post| f64::from(self.standing_m(post)) > above_m);
        let edges = under.map(|post| self.edges(post, |post| self.standing_m(post)));
        let open = if under.is_none() { Some(self.end(at, above_m)) } else { None };
        let at_edge = move |post: Post| SightEnd { at: self.ground.map_position(post), above_m };
        open.into_iter().chain(edges.into_iter().flatten().flatten().map(at_edge))
    }

    /// An end of a line so high above the ground at a place, as the tops have it.
    fn end(&self, at: DVec2, above_m: f64) -> SightEnd {
        let height_m = |lattice: &Lattice| ground_height(lattice, Interpolation::Planar, at).height_m();
        let raised_m = match self.standing_m {
            Some(_) => {
                height_m(&self.tops).zip(height_m(&self.ground)).map_or(0.0, |(top, ground)| top - ground)
            }
            None => 0.0,
        };
        SightEnd { at, above_m: above_m - raised_m }
    }

    /// The first open post to the east, north, west and south of a post, as far as sight reaches from an edge.
    fn edges(&self, post: Post, standing_m: impl Fn(Post) -> f32) -> [Option<Post>; 4] {
        let (ground, Post { column, row }) = (&*self.ground, post);
        let steps = |cell_m: f64| ((EDGE_M / cell_m) as u32).max(1);
        let (across, along) = (steps(ground.cell().x), steps(ground.cell().y));
        let is_open = |post: &Post| standing_m(*post) == 0.0 && !ground.height(*post).is_nan();
        let (at_column, at_row) = (|column: u32| Post { column, row }, |row: u32| Post { column, row });
        let after = |own: u32, steps: u32, count: u32| {
            own + 1..own.saturating_add(steps.saturating_add(1)).min(count)
        };
        let before = |own: u32, steps: u32| (own.saturating_sub(steps)..own).rev();
        [
            after(column, across, ground.columns()).map(at_column).find(is_open),
            after(row, along, ground.rows()).map(at_row).find(is_open),
            before(column, across).map(at_column).find(is_open),
            before(row, along).map(at_row).find(is_open),
        ]
    }

    /// The posts at which something stands in the way of an eye next to it.
    fn in_the_way_around(&self, eye: DVec2) -> Vec<Post> {
        let around = EyeSurroundings::new(&self.ground, eye);
        let posts = self.standing_m.as_ref().and_then(|_| around.rect(&self.ground)).map(PostRect::posts);
        let is_in_way = |post: &Post| around.hold(*post) && self.standing_m(*post) > 0.0;
        posts.into_iter().flatten().filter(is_in_way).collect()
    }

    /// The units that one [look](SightLand::look_at) at targets of such a height says that it did.
    pub fn look_units(&self, target_above_m: f64) -> usize {
        if self.standing_m.is_some() && target_above_m > 0.0 { 2 * SWEEP_UNITS } else { SWEEP_UNITS }
    }

    /// What an observer sees; see the head of this file.
    ///
    /// # Errors
    /// The observer has no ground, or the analysis was stopped.
    pub fn look(
        &self,
        key: &'static str,
        options: &ViewshedOptions,
        stop: &StopFlag,
    ) -> Result<LookoutView, AnalysisError> {
        let window = LookWindow::whole(&self.ground, options.observer.at, options.range_m);
        self.look_at(key, (options, window), stop)
    }

    /// What an observer sees of the posts of a window.
    ///
    /// # Errors
    /// As for [`SightLand::look`].
    pub fn look_at(
        &self,
        key: &'static str,
        (options, window): (&ViewshedOptions, LookWindow),
        stop: &StopFlag,
    ) -> Result<LookoutView, AnalysisError> {
        let eye = EyeLand::new(self, options, window.held);
        let look = |options: &ViewshedOptions| -> Result<LookoutView, AnalysisError> {
            let view = eye.answer(key, viewshed_until(&eye.tops, options, stop))?;
            Ok(LookoutView { window, view })
        };
        let mut seen = look(options)?;
        if self.standing_m.is_none() {
            return Ok(seen);
        }
        let is_between = |post: Post| {
            let height_m = f64::from(eye.standing_m(post));
            height_m > 0.0 && height_m <= options.target_above_m
        };
        let over_tops = match options.target_above_m > 0.0 && eye.held.posts().any(is_between) {
            true => Some(look(&ViewshedOptions { target_above_m: 0.0, ..*options })?),
            false => {
                stop.did(self.look_units(options.target_above_m) - SWEEP_UNITS);
                None
            }
        };
        seen.view.posts = eye.targets_seen(&seen, over_tops.as_ref(), options, stop);
        if stop.is_stopped() { Err(AnalysisError::Stopped) } else { Ok(seen) }
    }

    /// How far targets on the held posts of a window must rise to be seen; among trees and houses a target
    /// rises above their tops.
    ///
    /// # Errors
    /// As for [`SightLand::look`].
    pub fn rises(
        &self,
        key: &'static str,
        (options, window): (&ViewshedOptions, LookWindow),
        stop: &StopFlag,
    ) -> Result<Vec<f32>, AnalysisError> {
        let eye = EyeLand::new(self, options, window.held);
        let mut rises_m = eye.answer(key, required_rises(&eye.tops, options, stop))?.rises_m;
        if self.standing_m.is_some() {
            let posts = rises_m.iter_mut().zip(eye.held.posts());
            posts.for_each(|(rise_m, post)| *rise_m += eye.standing_m(post).max(0.0));
        }
        Ok(rises_m)
    }
}

/// The ground around an eye, meters from it and posts of its cell.
#[derive(Clone, Copy)]
struct EyeSurroundings {
    grid: DVec2,
    cell: DVec2,
}

impl EyeSurroundings {
    fn new(ground: &Lattice, eye: DVec2) -> Self {
        Self { grid: ground.grid_from_map(eye), cell: ground.cell() }
    }

    /// Whether nothing at a post is in the eye's way.
    fn hold(self, post: Post) -> bool {
        let offset = post.grid() - self.grid;
        (offset * self.cell).length() <= EDGE_M || offset.abs().max_element() < 1.0
    }

    /// The rectangle around its posts; `None` off the land.
    fn rect(self, ground: &Lattice) -> Option<PostRect> {
        let reach = (DVec2::splat(EDGE_M) / self.cell).max(DVec2::ONE);
        PostRect::between(ground, self.grid - reach, self.grid + reach)
    }
}

/// The land that an eye looks over, with nothing in its way around it.
struct EyeLand<'a> {
    land: &'a SightLand,
    eye: DVec2,
    around: EyeSurroundings,
    /// The posts that decide.
    held: PostRect,
    /// The tops of those posts.
    tops: Cow<'a, Lattice>,
}

impl<'a> EyeLand<'a> {
    fn new(land: &'a SightLand, options: &ViewshedOptions, held: PostRect) -> Self {
        let (ground, eye) = (&*land.ground, options.observer.at);
        let mut tops = match held == ground.held() {
            true => Cow::Borrowed(&*land.tops),
            false => Cow::Owned(land.tops.holding_only(held)),
        };
        for post in land.in_the_way_around(eye).into_iter().filter(|&post| held.contains(post)) {
            tops.to_mut().heights_mut(post, post.column)[0] = ground.height(post);
        }
        Self { land, eye, around: EyeSurroundings::new(ground, eye), held, tops }
    }

    /// What was found, or why nothing was.
    fn answer<T, E>(&self, key: &'static str, found: Result<Option<T>, E>) -> Result<T, AnalysisError> {
        let at = self.eye;
        let place = |_| AnalysisError::Place { key, at, problem: missing_ground(&self.land.ground, at) };
        found.map_err(place)?.ok_or(AnalysisError::Stopped)
    }

    /// The height of what stands at a post, meters; negative where it is not in the eye's way.
    fn standing_m(&self, post: Post) -> f32 {
        match self.land.standing_m(post) {
            height_m if self.around.hold(post) => -height_m.abs(),
            height_m => height_m,
        }
    }

    /// The posts of a view where targets are as this land has them: `seen` is that of targets so high above the tops,
    /// `over_tops` that of the tops themselves.
    fn targets_seen(
        &self,
        seen: &LookoutView,
        over_tops: Option<&LookoutView>,
        options: &ViewshedOptions,
        stop: &StopFlag,
    ) -> Vec<PostVisibility> {
        let held = self.held;
        let is_in_sight =
            |view: &LookoutView, post: Post| view.view.posts[held.index(post)] == PostVisibility::Visible;
        let is_edge_seen = |post: Post| {
            let mut edges = self.land.edges(post, |post| self.standing_m(post)).into_iter().flatten();
            edges.any(|edge| held.contains(edge) && is_in_sight(seen, edge))
        };
        let is_line_clear = |post: Post, height_m: f32| {
            let above_m = options.target_above_m - f64::from(height_m);
            let target = SightEnd { at: self.land.ground.map_position(post), above_m };
            !stop.is_stopped()
                && line_of_sight(&self.tops, options.observer, target, options.curvature) == Sight::Clear
        };
        let mut posts = seen.view.posts.clone();
        posts.par_chunks_mut(held.width()).enumerate().for_each(|(row, posts)| {
            for (column, found) in posts.iter_mut().enumerate() {
                let post = held.first.offset(column as u32, row as u32);
                let height_m = self.standing_m(post);
                if height_m <= 0.0 || !matches!(found, PostVisibility::Visible | PostVisibility::Hidden) {
                    continue;
                }
                let is_seen = match f64::from(height_m) > options.target_above_m {
                    true => is_edge_seen(post),
                    // Not below the tops and not as high above them as was looked for: what both hide or show is decided.
                    false => {
                        over_tops.is_some_and(|view| is_in_sight(view, post))
                            || *found == PostVisibility::Visible && is_line_clear(post, height_m)
                    }
                };
                *found = if is_seen { PostVisibility::Visible } else { PostVisibility::Hidden };
            }
        });
        posts
    }
}

#[cfg(test)]
#[path = "sight_land_tests.rs"]
mod tests;

//! Analyses that are cut into parts: what makes the values of any posts of the ground of a dataset, and what all say together.
//!
//! ```text
//!  a part ──► its values: the bits of the whole     ┐
//!         └─► its tally: whole numbers              ├─► all tallies ──► the figures and tables of the whole
//!  …                                                ┘
//! ```

use std::sync::Arc;

use glam::DVec2;

use crate::analysis::{
    AnalyzeError, OtherGrounds, WrittenArgument, bare_posts, compared, extent, frame, of_extent, read,
};
use crate::dataset::Dataset;
use crate::ground::{GroundError, QueriedGround};
use crate::windowed_elevation::GroundReach;
use sandtable_analysis::arguments::AnalysisArguments;
use sandtable_analysis::extent::{BEYOND_NOTE, LandExtent, land_part, run_part};
use sandtable_analysis::land::Land;
use sandtable_analysis::outcome::{Outcome, OutcomeRaster, PostValues};
use sandtable_analysis::run::{lacking_note, tally_figures};
use sandtable_analysis::sight_parts::{
    is_of_sight, needed_for_sight, place_height, sight_places, sight_summary, sight_values, sight_work,
};
use sandtable_analysis::tally::FigureTally;
use sandtable_catalog::kind::{AnalysisKind, AnalysisReach};
use sandtable_geom::crs::Crs;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// An analysis of a kind that can be cut into parts.
pub struct PartedAnalysis {
    arguments: AnalysisArguments,
    extent: Option<LandExtent>,
    /// The ground with a few of its posts, or all.
    frame: QueriedGround,
    /// The posts of all parts together, counted in the whole ground.
    posts: PostRect,
    /// The land, where it is in memory.
    land: Option<Land>,
    /// Of a kind of sight whose land is in memory that of `posts`, beyond which it does not look.
    seen: Option<Land>,
}

/// What a part gives.
pub struct AnalyzedPart {
    /// The values of its posts.
    pub raster: OutcomeRaster,
    /// What figures are made of.
    pub tally: FigureTally,
    /// What it does not know, a sentence each.
    pub notes: Vec<String>,
}

impl PartedAnalysis {
    /// Prepares an analysis of a dataset; `land` is that of a scene, for a kind that uses what lies on its ground.
    ///
    /// # Errors
    /// [`AnalyzeError::Whole`], [`AnalyzeError::Unlimited`], and as [`bare_land`](crate::analysis::bare_land).
    pub fn new(
        dataset: &Dataset,
        land: Option<Land>,
        (kind, written): (&'static AnalysisKind, &[WrittenArgument]),
        crs: &Crs,
    ) -> Result<Self, AnalyzeError> {
        check_parts(kind, written)?;
        let frame = frame(dataset)?;
        let extent = extent(written, crs, &frame.crs)?;
        let arguments = read(kind, written, crs, &frame.crs)?;
        let posts = match &extent {
            None => PostRect::all(&frame.lattice),
            Some(extent) => extent.posts(&frame.lattice).map_err(of_extent)?,
        };
        let bare = || Land::bare(Arc::clone(&frame.lattice), frame.crs.clone());
        let land = land.or_else(|| frame.lattice.holds_all().then(bare));
        let mut parted = Self { arguments, extent, frame, posts, land, seen: None };
        if let Some(land) = parted.land.as_ref().filter(|_| is_of_sight(&parted.arguments)) {
            let seen = land_part(land, posts).map_err(GroundError::from)?;
            parted.seen = Some(Land { ground: parted.masked(Arc::clone(&seen.ground)), ..seen });
        }
        Ok(parted)
    }

    /// The frame of the ground: its lattice may hold a few posts alone.
    pub fn frame(&self) -> &QueriedGround {
        &self.frame
    }

    /// From how many posts around a part the land has an effect on its values; `None` where it is that toward the places that
    /// see it.
    pub fn reach(&self) -> Option<u32> {
        self.arguments.reach_posts(self.frame.lattice.cell())
    }

    /// The posts of all parts together, counted in the whole ground.
    pub fn posts(&self) -> PostRect {
        self.posts
    }

    /// What the values of all parts are and how pictures divide them, without the values: that of the smallest part.
    ///
    /// # Errors
    /// As [`PartedAnalysis::part`].
    pub fn empty_raster(&self, dataset: &Dataset, stop: &StopFlag) -> Result<OutcomeRaster, AnalyzeError> {
        let OutcomeRaster { name, unit, values, classes } = self.part(dataset, self.corner(), stop)?.raster;
        let values = match values {
            PostValues::Numbers(_) => PostValues::Numbers(Vec::new()),
            PostValues::Codes(_) => PostValues::Codes(Vec::new()),
        };
        Ok(OutcomeRaster { name, unit, values, classes })
    }

    /// The ground of all parts, of which few heights may be held.
    ///
    /// # Errors
    /// See [`AnalyzeError`].
    pub fn ground(&self, dataset: &Dataset) -> Result<Arc<Lattice>, AnalyzeError> {
        self.seen_ground(dataset, self.corner())
    }

    /// The four posts in the south-west.
    fn corner(&self) -> PostRect {
        PostRect { first: self.posts.first, last: self.posts.first.offset(1, 1) }
    }

    /// About how many posts are looked at for the values of a part.
    pub fn work(&self, posts: PostRect) -> f64 {
        let ground = &self.frame.lattice;
        match self.reach() {
            Some(reach) => {
                let around = posts.grown((reach, reach), ground);
                around.width() as f64 * around.height() as f64
            }
            None => sight_work(ground, &self.arguments, posts).max(1.0),
        }
    }

    /// The values at `posts`, counted in the whole ground: those of the analysis of all of it, to the last bit.
    ///
    /// # Errors
    /// See [`AnalyzeError`].
    ///
    /// # Panics
    /// Where the posts reach beyond the ground.
    pub fn part(
        &self,
        dataset: &Dataset,
        posts: PostRect,
        stop: &StopFlag,
    ) -> Result<AnalyzedPart, AnalyzeError> {
        let Some(reach) = self.reach() else { return self.seen_part(dataset, posts, stop) };
        let compared = |land: &Land| compared((dataset, OtherGrounds::Files), &self.arguments, land);
        let part = |land: &Land, posts: PostRect| {
            let placed = run_part(land, &self.arguments, (posts, self.extent.as_ref()), compared, stop)?;
            let Outcome { raster, tally, notes, .. } = placed.outcome;
            let raster = raster.unwrap_or_else(|| panic!("{} gives a raster", self.arguments.kind().name));
            Ok(AnalyzedPart { raster, tally, notes })
        };
        if let Some(land) = &self.land {
            return part(land, posts);
        }
        let needed = posts.grown((reach, reach), &self.frame.lattice);
        part(&bare_posts(dataset, &self.frame, needed)?, posts.counted_in(needed))
    }

    /// The values of a kind of sight. Of ground on disk as much is read as the lines of sight to the posts run over.
    fn seen_part(
        &self,
        dataset: &Dataset,
        posts: PostRect,
        stop: &StopFlag,
    ) -> Result<AnalyzedPart, AnalyzeError> {
        let own = posts.counted_in(self.posts);
        let needed = needed_for_sight(&self.frame.lattice, &self.arguments, (self.posts, posts));
        let bare;
        let land = match &self.seen {
            Some(seen) => seen,
            None => {
                // Where nobody looks, no height is needed; a lattice has one.
                let held = needed.unwrap_or(PostRect { last: posts.first, ..posts });
                bare = Land::bare(self.seen_ground(dataset, held)?, self.frame.crs.clone());
                &bare
            }
        };
        let seen = sight_values(land, &self.arguments, own, stop)?;
        let notes = lacking_note(land, self.arguments.kind()).into_iter().collect();
        Ok(AnalyzedPart { raster: seen.raster, tally: seen.tally, notes })
    }

    /// The ground of all parts of which these posts, counted in the whole ground, are held; read from disk.
    fn seen_ground(&self, dataset: &Dataset, held: PostRect) -> Result<Arc<Lattice>, AnalyzeError> {
        let frame = &self.frame;
        let corners = [held.first, held.last].map(|post| frame.lattice.map_position(post));
        let ground = dataset.ground(&GroundReach { crs: &frame.crs, at: &corners, around_m: 0.0 })?;
        let only = ground.lattice.holding_only(held).cut_to(self.posts).map_err(GroundError::from)?;
        Ok(self.masked(Arc::new(only)))
    }

    /// Ground of all parts without data outside an area.
    fn masked(&self, ground: Arc<Lattice>) -> Arc<Lattice> {
        match &self.extent {
            Some(extent) => extent.masked_ground(ground),
            None => ground,
        }
    }

    /// What the analysis gives besides its raster, from the tally of all parts: the figures, tables, features and notes of the
    /// whole.
    ///
    /// # Errors
    /// See [`AnalyzeError`].
    pub fn summary(&self, dataset: &Dataset, tally: &FigureTally) -> Result<Outcome, AnalyzeError> {
        let (arguments, ground) = (&self.arguments, &self.frame.lattice);
        let mut outcome = match self.reach() {
            Some(_) => Outcome {
                figures: tally_figures(arguments.kind(), tally, ground),
                tally: tally.clone(),
                ..Outcome::default()
            },
            None => sight_summary(ground, arguments, &self.heights(dataset)?, tally)?,
        };
        if self.extent.as_ref().is_some_and(|extent| extent.is_beyond(ground)) {
            outcome.notes.push(BEYOND_NOTE.into());
        }
        Ok(outcome)
    }

    /// The heights of the ground under the places that look.
    ///
    /// # Errors
    /// One has none.
    pub fn heights(&self, dataset: &Dataset) -> Result<Vec<f64>, AnalyzeError> {
        let arguments = &self.arguments;
        let height = |&at: &DVec2| {
            let ground = match &self.seen {
                Some(seen) => Arc::clone(&seen.ground),
                None => {
                    let frame = &self.frame.lattice;
                    let grid = frame.grid_from_map(at).clamp(DVec2::ZERO, frame.last_grid());
                    let around = PostRect::around((frame.columns(), frame.rows()), grid - 1.0, grid + 1.0);
                    let held = around
                        .intersection(self.posts)
                        .unwrap_or(PostRect { first: self.posts.first, last: self.posts.first });
                    self.seen_ground(dataset, held)?
                }
            };
            Ok::<f64, AnalyzeError>(place_height(&ground, arguments, at)?)
        };
        sight_places(arguments).iter().map(height).collect()
    }
}

/// Checks that a kind with these arguments can be cut into parts.
///
/// # Errors
/// [`AnalyzeError::Whole`] and [`AnalyzeError::Unlimited`].
pub fn check_parts(kind: &'static AnalysisKind, written: &[WrittenArgument]) -> Result<(), AnalyzeError> {
    match kind.reach {
        AnalysisReach::Whole => Err(AnalyzeError::Whole { kind: kind.name }),
        AnalysisReach::Around { range, .. } if !written.iter().any(|argument| argument.name == range) => {
            Err(AnalyzeError::Unlimited { kind: kind.name, key: range })
        }
        _ => Ok(()),
    }
}

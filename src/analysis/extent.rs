//! The part of the land that an analysis is limited to.
//!
//! A kind whose values depend on the land within a reach sees that much around the extent, so that its values there have the
//! bits of those on the whole land. For a kind that reaches everywhere the land ends at the extent.
//!
//! ```text
//!   land ──► extent grown by the reach ──► run ──► cut to the extent, no data outside an area
//!        └─► extent, no ground outside an area ──► run                    (a kind that reaches everywhere)
//! ```

use std::sync::Arc;

use glam::DVec2;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Outcome, OutcomeRaster, PostValues};
use crate::ring::AreaRow;
use crate::run::{raster_tally, run, tally_figures};
use sandtable_catalog::parameter::EXTENT;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{Lattice, LatticeError, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// The share of a cell by which a post may lie outside an extent and is in it: corners written in decimals name posts.
const SNAP: f64 = 1e-6;

/// What is said of an extent that reaches beyond the land.
pub const BEYOND_NOTE: &str = "`extent` reaches beyond the land; nothing is known there";

/// The part of the land that an analysis is limited to.
#[derive(Clone, Debug, PartialEq)]
pub struct LandExtent {
    /// In map coordinates of the land.
    bounds: Rect,
    /// The ring of an area in map coordinates of the land; `None` of a rectangle.
    ring: Option<Vec<DVec2>>,
}

/// What an analysis gives of the land or of an extent.
pub struct PlacedOutcome {
    /// The ground on whose posts the values of a raster are.
    pub ground: Arc<Lattice>,
    /// What the analysis gives.
    pub outcome: Outcome,
}

/// Runs an analysis on an extent of the land; on all of it without one. `compared` gives the ground to compare with on the
/// posts of a part of the land.
///
/// # Errors
/// As [`run`]; those of `compared`; [`AnalysisError::Argument`] of an extent off the land.
pub fn run_within<E: From<AnalysisError>>(
    land: &Land,
    arguments: &AnalysisArguments,
    extent: Option<&LandExtent>,
    compared: impl Fn(&Land) -> Result<Option<Arc<Lattice>>, E>,
    stop: &StopFlag,
) -> Result<PlacedOutcome, E> {
    let Some(extent) = extent else { return run_all(land, arguments, compared, stop) };
    let posts = extent.posts(&land.ground).map_err(wrong)?;
    let mut placed = if arguments.reach_posts(land.ground.cell()).is_some() {
        run_part(land, arguments, (posts, Some(extent)), compared, stop)?
    } else {
        let land = land_part(land, posts).map_err(no_lattice)?;
        run_all(&extent.masked(land).map_err(wrong)?, arguments, compared, stop)?
    };
    if extent.is_beyond(&land.ground) {
        placed.outcome.notes.push(BEYOND_NOTE.into());
    }
    Ok(placed)
}

/// Runs an analysis of a kind that can be parted on posts of the land with as much around them as their values need, and keeps
/// theirs, those in the extent.
///
/// # Errors
/// As [`run`], and those of `compared`.
pub fn run_part<E: From<AnalysisError>>(
    land: &Land,
    arguments: &AnalysisArguments,
    (posts, extent): (PostRect, Option<&LandExtent>),
    compared: impl Fn(&Land) -> Result<Option<Arc<Lattice>>, E>,
    stop: &StopFlag,
) -> Result<PlacedOutcome, E> {
    let needed = with_reach(posts, arguments, &land.ground);
    let placed = match needed == PostRect::all(&land.ground) {
        true => run_all(land, arguments, compared, stop)?,
        false => run_all(&land_part(land, needed).map_err(no_lattice)?, arguments, compared, stop)?,
    };
    let posts = posts.counted_in(needed);
    let ground = ground_part(&placed.ground, posts).map_err(no_lattice)?;
    let PlacedOutcome { ground: around, mut outcome } = placed;
    if let Some(raster) = outcome.raster.take() {
        let mut raster = raster_part(raster, &around, posts);
        extent.into_iter().for_each(|extent| extent.mask(&mut raster, &ground));
        outcome.tally = raster_tally(arguments.kind(), &raster);
        outcome.figures = tally_figures(arguments.kind(), &outcome.tally, &ground);
        outcome.raster = Some(raster);
    }
    Ok(PlacedOutcome { ground, outcome })
}

/// Posts with as much of the land around them as the values of an analysis need.
fn with_reach(posts: PostRect, arguments: &AnalysisArguments, land: &Lattice) -> PostRect {
    let reach = arguments.reach_posts(land.cell()).unwrap_or(0);
    posts.grown((reach, reach), land)
}

/// Runs an analysis on all of the land.
fn run_all<E: From<AnalysisError>>(
    land: &Land,
    arguments: &AnalysisArguments,
    compared: impl Fn(&Land) -> Result<Option<Arc<Lattice>>, E>,
    stop: &StopFlag,
) -> Result<PlacedOutcome, E> {
    let other = compared(land)?;
    let compared = other.map(|other| Land { other_ground: Some(other), ..land.clone() });
    let outcome = run(compared.as_ref().unwrap_or(land), arguments, stop)?;
    Ok(PlacedOutcome { ground: Arc::clone(&land.ground), outcome })
}

fn wrong(problem: String) -> AnalysisError {
    AnalysisError::argument(EXTENT.name, problem)
}

fn no_lattice(error: LatticeError) -> AnalysisError {
    wrong(error.to_string())
}

impl LandExtent {
    /// The smallest rectangle around positions, in map coordinates of the land.
    pub fn rectangle(around: impl IntoIterator<Item = DVec2>) -> Self {
        Self { bounds: Rect::around(around), ring: None }
    }

    /// An area within a ring of three positions or more, in map coordinates of the land.
    pub fn area(ring: Vec<DVec2>) -> Self {
        Self { bounds: Rect::around(ring.iter().copied()), ring: Some(ring) }
    }

    /// Its bounds, in map coordinates of the land.
    pub fn bounds(&self) -> Rect {
        self.bounds
    }

    /// The ring of an area, in map coordinates of the land; `None` of a rectangle.
    pub fn ring(&self) -> Option<&[DVec2]> {
        self.ring.as_deref()
    }

    /// The posts of the land within its bounds.
    ///
    /// # Errors
    /// It lies off the land, or holds fewer than two posts a side.
    pub fn posts(&self, land: &Lattice) -> Result<PostRect, String> {
        let (of_land, bounds) = (land.map_extent(), &self.bounds);
        if !of_land.meets(bounds) {
            let Rect { min, max } = of_land;
            return Err(format!(
                "{},{} to {},{} lies off the land, which reaches from {},{} to {},{}",
                bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y, min.x, min.y, max.x, max.y
            ));
        }
        let (low, high) = (land.grid_from_map(bounds.min) - SNAP, land.grid_from_map(bounds.max) + SNAP);
        let posts =
            PostRect::between(land, low, high).filter(|posts| posts.width() > 1 && posts.height() > 1);
        posts.ok_or_else(|| {
            let cell = land.cell();
            format!("holds fewer than two posts a side; they lie {} by {} m apart", cell.x, cell.y)
        })
    }

    /// The posts of the land that an analysis must know for the values within: those with its reach around them.
    ///
    /// # Errors
    /// As [`LandExtent::posts`].
    pub fn needed_posts(&self, arguments: &AnalysisArguments, land: &Lattice) -> Result<PostRect, String> {
        Ok(with_reach(self.posts(land)?, arguments, land))
    }

    /// Whether it reaches a cell or more beyond the land.
    pub fn is_beyond(&self, land: &Lattice) -> bool {
        let (low, high) = (land.grid_from_map(self.bounds.min), land.grid_from_map(self.bounds.max));
        low.cmple(DVec2::NEG_ONE).any() || high.cmpge(land.last_grid() + 1.0).any()
    }

    /// The land without ground outside the area; the whole of it where the extent is a rectangle.
    ///
    /// # Errors
    /// There is no ground inside.
    pub fn masked(&self, land: Land) -> Result<Land, String> {
        if self.ring.is_none() {
            return Ok(land);
        }
        let ground = self.masked_ground(Arc::clone(&land.ground));
        if ground.held_heights().iter().all(|height| height.is_nan()) {
            return Err("holds no post with an elevation".into());
        }
        Ok(Land { ground, ..land })
    }

    /// Ground without data outside the area, of which as much is held.
    pub fn masked_ground(&self, ground: Arc<Lattice>) -> Arc<Lattice> {
        let Some(ring) = &self.ring else { return ground };
        let mut masked = Lattice::clone(&ground);
        outside(ring, &ground, |index| {
            let post = ground.post_at(index);
            masked.heights_mut(post, post.column)[0] = f32::NAN;
        });
        Arc::new(masked)
    }

    /// Takes the values outside the area from a raster on the posts of `ground`.
    pub fn mask(&self, raster: &mut OutcomeRaster, ground: &Lattice) {
        let Some(ring) = &self.ring else { return };
        match &mut raster.values {
            PostValues::Numbers(values) => outside(ring, ground, |index| values[index] = f32::NAN),
            PostValues::Codes(codes) => outside(ring, ground, |index| codes[index] = PostValues::NO_CODE),
        }
    }
}

/// Calls `visit` with the index of each held post outside a ring.
fn outside(ring: &[DVec2], ground: &Lattice, mut visit: impl FnMut(usize)) {
    let held = ground.held();
    for row in held.first.row..=held.last.row {
        let start = Post { column: held.first.column, row };
        let inside = AreaRow::new(ring, ground.map_position(start).y);
        for column in held.first.column..=held.last.column {
            let post = Post { column, ..start };
            if !inside.holds(ground.map_position(post).x) {
                visit(ground.index(post));
            }
        }
    }
}

/// The posts of a lattice that holds all of its own, as a lattice.
///
/// # Errors
/// As [`Lattice::cut_to_held`].
pub fn ground_part(ground: &Arc<Lattice>, posts: PostRect) -> Result<Arc<Lattice>, LatticeError> {
    match posts == PostRect::all(ground) && ground.holds_all() {
        true => Ok(Arc::clone(ground)),
        false => Ok(Arc::new(ground.holding_only(posts).cut_to_held()?)),
    }
}

/// The land of these posts; lines that leave it stay whole, and there is no other ground.
///
/// # Errors
/// As [`Lattice::cut_to_held`].
pub fn land_part(land: &Land, posts: PostRect) -> Result<Land, LatticeError> {
    let columns = land.ground.columns() as usize;
    Ok(Land {
        ground: ground_part(&land.ground, posts)?,
        crs: land.crs.clone(),
        cover: land.cover.as_ref().map(|values| values_part(values, columns, posts)),
        roads: land.roads.clone(),
        water: land.water.as_ref().map(|values| values_part(values, columns, posts)),
        woods: land.woods.as_ref().map(|values| values_part(values, columns, posts)),
        obstacles_m: land.obstacles_m.as_ref().map(|values| values_part(values, columns, posts)),
        crossings: land.crossings.clone(),
        knows_crossings: land.knows_crossings,
        gaps: land.gaps.clone(),
        steps: land.steps.clone(),
        vehicles: land.vehicles.clone(),
        other_ground: None,
    })
}

/// The raster of these posts of `ground`.
fn raster_part(raster: OutcomeRaster, ground: &Lattice, posts: PostRect) -> OutcomeRaster {
    let columns = ground.columns() as usize;
    let values = match raster.values {
        PostValues::Numbers(values) => PostValues::Numbers(values_part(&values, columns, posts)),
        PostValues::Codes(codes) => PostValues::Codes(values_part(&codes, columns, posts)),
    };
    OutcomeRaster { values, ..raster }
}

/// The values of a rectangle of posts among those of rows of `columns`.
fn values_part<T: Copy>(values: &[T], columns: usize, posts: PostRect) -> Vec<T> {
    let row = |row: u32| {
        let first = row as usize * columns + posts.first.column as usize;
        &values[first..first + posts.width()]
    };
    (posts.first.row..=posts.last.row).map(row).collect::<Vec<_>>().concat()
}

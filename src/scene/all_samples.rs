//! All samples of an elevation model of which a scene holds only means: a lattice in the scene's system, read in parts.

use glam::DVec2;

use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::limits::memory::check_memory;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_raster::answer::Answer;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
use sandtable_raster::voids;
use sandtable_raster::warp::metric_windows::{MetricPlan, MetricWindows};
use sandtable_raster::windows::Windows;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::Interpolation;
use sandtable_terrain::query::windowed::{
    LatticePartError, lattice_part, post_heights, windowed_ground_heights,
};

/// Posts beside those that are asked for: those of the cells around them, and a few for rounding.
const HALO: f64 = 4.0;

/// Posts beside a part with voids that are read as well, so that voids on its border are known to end.
const VOID_MARGIN: u32 = 512;

/// Memory for a post of a part: its height, whether it is pinned and whether it is in sight.
const BYTES_PER_POST: usize = 8;

/// A part of more posts than are read at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct PartTooLarge {
    /// In a row.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
}

/// The highest of some posts.
#[derive(Clone, Copy, Debug)]
pub(super) struct HighestPost {
    /// Map coordinates.
    pub at: DVec2,
    /// Its height, meters.
    pub height_m: f32,
}

/// The samples, read where they are asked for.
pub(super) struct AllSamples {
    windows: Box<dyn Windows + Send>,
    plan: MetricPlan,
    frame: (DVec2, DVec2),
    /// Whether voids of the ground are filled.
    fills_voids: bool,
}

impl AllSamples {
    /// The samples of `windows`, for a scene whose ground lies in `crs`.
    ///
    /// # Errors
    /// They cannot be read, or brought to that system.
    pub fn new(
        mut windows: Box<dyn Windows + Send>,
        document: &Document,
        crs: &Crs,
    ) -> Result<Self, Diagnostic> {
        let dem = &document.terrain.dem;
        let has_place = windows.metadata().crs.is_some();
        let target = document.crs.as_ref().or(has_place.then_some(crs));
        let plan = MetricPlan::new(&mut windows, target).map_err(|error| document.error(dem, error))?;
        let frame = Lattice::frame(plan.header()).map_err(|error| document.error(dem, error))?;
        Ok(Self { windows, plan, frame, fills_voids: document.terrain.fill_voids != Some(false) })
    }

    /// The height of the ground at map coordinates, as a height query on the file answers.
    ///
    /// # Errors
    /// The samples cannot be read.
    pub fn height(&mut self, at: DVec2) -> Result<Answer, LatticePartError> {
        let mut metric = MetricWindows::new(&mut self.windows, &self.plan);
        let mut answer = [Answer::Outside];
        windowed_ground_heights(&mut metric, Interpolation::Planar, &[at], &mut answer)?;
        Ok(answer[0])
    }

    /// The highest post within a rectangle of map coordinates, the southernmost of equals; `None` without data.
    ///
    /// # Errors
    /// The samples cannot be read.
    pub fn highest(&mut self, rect: &Rect) -> Result<Option<HighestPost>, LatticePartError> {
        let (origin, cell) = self.frame;
        let (columns, rows) = self.plan.header().size();
        let far = DVec2::new(f64::from(columns - 1), f64::from(rows - 1));
        let [low, high] = [rect.min, rect.max].map(|at| (at - origin) / cell);
        let (low, high) = (low.ceil().max(DVec2::ZERO), high.floor().min(far));
        if !low.cmple(high).all() {
            return Ok(None);
        }
        let posts = PostRect { first: Post::at_grid(low), last: Post::at_grid(high) };
        let mut metric = MetricWindows::new(&mut self.windows, &self.plan);
        let heights = post_heights(&mut metric, posts)?;
        let mut highest: Option<HighestPost> = None;
        for (post, height_m) in posts.posts().zip(heights) {
            if height_m > highest.map_or(f32::NEG_INFINITY, |highest| highest.height_m) {
                highest = Some(HighestPost { at: origin + post.grid() * cell, height_m });
            }
        }
        Ok(highest)
    }

    /// The posts around a rectangle of map coordinates.
    ///
    /// # Errors
    /// They are more than a raster in memory has.
    pub fn posts_around(&self, rect: &Rect) -> Result<PostRect, PartTooLarge> {
        let (origin, cell) = self.frame;
        let header = self.plan.header();
        let (low, high) = ((rect.min - origin) / cell - HALO, (rect.max - origin) / cell + HALO);
        let posts = PostRect::around((header.width, header.height), low, high);
        let (columns, rows) = (posts.width(), posts.height());
        match columns as u64 * rows as u64 > RASTER_SAMPLES.get() {
            true => Err(PartTooLarge { columns, rows }),
            false => Ok(posts),
        }
    }

    /// The rectangle that posts span, map coordinates.
    pub fn map_rect(&self, posts: PostRect) -> Rect {
        let (origin, cell) = self.frame;
        let [min, max] = [posts.first, posts.last].map(|post| origin + post.grid() * cell);
        Rect { min, max }
    }

    /// The lattice of the whole ground of which `posts` are held at the least, with small voids filled where the scene has them
    /// filled.
    ///
    /// # Errors
    /// The samples cannot be read.
    pub fn part(&mut self, posts: PostRect) -> Result<Lattice, LatticePartError> {
        let size = self.plan.header().size();
        let bytes = (posts.width() * posts.height() * BYTES_PER_POST) as u64;
        check_memory(bytes, "the ground in sight", "look less far").map_err(DemErrorKind::from)?;
        let mut metric = MetricWindows::new(&mut self.windows, &self.plan);
        let part = lattice_part(&mut metric, posts)?;
        if !self.fills_voids || part.held_heights().iter().all(|height| height.is_finite()) {
            return Ok(part);
        }
        let margin = DVec2::splat(f64::from(VOID_MARGIN));
        let wider = PostRect::around(size, posts.first.grid() - margin, posts.last.grid() + margin);
        let heights = post_heights(&mut metric, wider)?;
        let raster = Raster::new(wider.width() as u32, Samples::F32(heights));
        let mut raster = raster.placed(north_up_nodes(DVec2::ZERO, self.frame.1));
        voids::fill(&mut raster);
        let Samples::F32(heights) = raster.samples else { return Ok(part) };
        Ok(Lattice::held_part(self.frame, size, wider, heights)?)
    }
}

//! Elevation that stays on disk: queries read the samples that they need.
//!
//! A height needs a few samples of a file that may hold a billion, a line of sight those under it, a viewshed those within
//! its range. Answers equal those on the raster in memory to the last bit.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use glam::{DVec2, U64Vec2};
use rayon::prelude::*;

use crate::ground::{GroundError, QueriedGround};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::limits::memory::check_memory;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_raster::answer::Answer;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;
use sandtable_raster::stats::Stats;
use sandtable_raster::warp::metric_windows::{MetricPlan, MetricWindows};
use sandtable_raster::windows::{RasterWindow, Windows};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::windowed::{
    lattice_part, post_heights, windowed_ground_heights, windowed_source_heights,
};
use sandtable_terrain::query::{Interpolation, Surface};

/// Posts around the positions of a query: those of the cells that these lie in, and a few for rounding.
const HALO: f64 = 4.0;

/// Elevation whose samples are read when a query needs them.
pub struct WindowedElevation {
    /// The raster without its samples.
    header: Arc<Raster>,
    source: Mutex<Box<dyn Windows + Send>>,
    /// How the ground in meters is made; planned at the first query for it.
    plan: OnceLock<Result<MetricPlan, Arc<GroundError>>>,
}

/// The positions that a query is about, and how far around them it looks.
#[derive(Clone, Copy)]
pub struct GroundReach<'a> {
    /// The system of the positions.
    pub crs: &'a Crs,
    /// The positions: between two neighbors, the ground under the straight line. None, and an infinite distance around them, for
    /// all of the ground.
    pub at: &'a [DVec2],
    /// Meters around them; may be infinite.
    pub around_m: f64,
}

impl WindowedElevation {
    /// The elevation of an opened file.
    pub fn new(source: Box<dyn Windows + Send>) -> Self {
        let header = Arc::new(source.metadata().without_samples());
        Self { header, source: Mutex::new(source), plan: OnceLock::new() }
    }

    /// The raster without its samples.
    pub fn header(&self) -> &Arc<Raster> {
        &self.header
    }

    /// The raster with all its samples.
    ///
    /// # Errors
    /// They cannot be read, or are more than a raster in memory has.
    pub fn read(&self) -> Result<Raster, DemErrorKind> {
        let (width, height) = (self.header.width, self.header.height);
        let window = RasterWindow::all((width, height));
        if window.samples() as u64 > RASTER_SAMPLES.get() {
            let size = U64Vec2::new(width.into(), height.into());
            return Err(DemErrorKind::TooLarge { size, most: &RASTER_SAMPLES });
        }
        let bytes = if self.header.samples.is_wide() { size_of::<f64>() } else { size_of::<f32>() };
        check_memory((window.samples() * bytes) as u64, "the raster", "read a part of it")?;
        Ok(Raster { samples: self.source().samples(window)?, ..self.header.without_samples() })
    }

    /// The lowest and the highest sample of the raster, which is read for them; NaN where none is valid.
    ///
    /// # Errors
    /// Samples cannot be read.
    pub fn range(&self) -> Result<(f64, f64), DemErrorKind> {
        Stats::range_of_windows(&mut **self.source())
    }

    /// The plan for the ground in meters.
    ///
    /// # Errors
    /// The raster has no ground, or cannot be read.
    pub fn plan(&self) -> Result<&MetricPlan, Arc<GroundError>> {
        let make = || {
            let plan = MetricPlan::new(&mut **self.source(), None)?;
            Lattice::frame(plan.header())?;
            Ok(plan)
        };
        let made = self.plan.get_or_init(|| make().map_err(|error: GroundError| Arc::new(error)));
        made.as_ref().map_err(Arc::clone)
    }

    /// Whether [`WindowedElevation::plan`] is known.
    pub fn is_planned(&self) -> bool {
        self.plan.get().is_some()
    }

    /// The system of the ground in meters.
    ///
    /// # Errors
    /// As [`WindowedElevation::plan`].
    pub fn ground_crs(&self) -> Result<Crs, Arc<GroundError>> {
        Ok(self.plan()?.header().crs.clone().unwrap_or_else(Crs::local))
    }

    /// The heights of the raster as read, as [`source_heights`](sandtable_terrain::query::source::source_heights) answers.
    ///
    /// # Errors
    /// Samples cannot be read.
    pub fn source_heights(
        &self,
        from: &Crs,
        interpolation: Interpolation,
        at: &[DVec2],
    ) -> Result<Vec<Answer>, DemErrorKind> {
        let mut answers = vec![Answer::Outside; at.len()];
        windowed_source_heights(&mut **self.source(), from, interpolation, at, &mut answers)?;
        Ok(answers)
    }

    /// The heights of another surface at positions in the ground's system. There are neither earthworks nor decks, and
    /// nothing is displayed.
    ///
    /// # Errors
    /// The raster has no ground, or cannot be read.
    pub fn ground_heights(
        &self,
        surface: Surface,
        interpolation: Interpolation,
        at: &[DVec2],
    ) -> Result<Vec<Answer>, Arc<GroundError>> {
        let plan = self.plan()?;
        let mut answers = vec![Answer::Outside; at.len()];
        if surface != Surface::Displayed {
            let mut source = self.source();
            let mut metric = MetricWindows::new(&mut **source, plan);
            windowed_ground_heights(&mut metric, interpolation, at, &mut answers)
                .map_err(|error| Arc::new(error.into()))?;
        }
        Ok(answers)
    }

    /// The ground as far as a query reaches.
    ///
    /// # Errors
    /// The raster has no ground, cannot be read, or the reach holds too many posts.
    pub fn ground(&self, reach: &GroundReach) -> Result<QueriedGround, Arc<GroundError>> {
        let (plan, crs) = (self.plan()?, self.ground_crs()?);
        let held = posts_within(plan.header(), &crs, reach).map_err(Arc::new)?;
        let lattice = self.ground_part(held)?;
        let vertical_datum = self.header.vertical_datum.clone();
        Ok(QueriedGround { lattice: Arc::new(lattice), crs, vertical_datum })
    }

    /// The ground with these posts in memory: that of [`MetricGround::from_raster`](crate::ground::MetricGround::from_raster)
    /// for the raster in memory, bit for bit.
    ///
    /// # Errors
    /// The raster has no ground, or cannot be read.
    ///
    /// # Panics
    /// Where the posts reach beyond the ground.
    pub fn ground_part(&self, held: PostRect) -> Result<Lattice, Arc<GroundError>> {
        let plan = self.plan()?;
        let mut source = self.source();
        let mut metric = MetricWindows::new(&mut **source, plan);
        lattice_part(&mut metric, held).map_err(|error| Arc::new(error.into()))
    }

    /// These posts as a lattice of their own, a part of the whole one.
    ///
    /// # Errors
    /// As [`WindowedElevation::ground_part`], and fewer than two columns or rows.
    ///
    /// # Panics
    /// Where the posts reach beyond the ground.
    pub fn ground_cut(&self, posts: PostRect) -> Result<Lattice, Arc<GroundError>> {
        let plan = self.plan()?;
        let mut source = self.source();
        let mut metric = MetricWindows::new(&mut **source, plan);
        let frame = Lattice::frame(plan.header()).map_err(|error| Arc::new(error.into()))?;
        let heights = post_heights(&mut metric, posts).map_err(|error| Arc::new(error.into()))?;
        let part = Lattice::part(frame, posts.first, posts.width() as u32, heights);
        part.map_err(|error| Arc::new(error.into()))
    }

    pub(crate) fn source(&self) -> MutexGuard<'_, Box<dyn Windows + Send>> {
        // A reader that panicked left whole blocks in its cache, and nothing else.
        self.source.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The posts of the ground within reach; those nearest to it where it lies beyond the border.
fn posts_within(ground: &Raster, crs: &Crs, reach: &GroundReach) -> Result<PostRect, GroundError> {
    let (origin, cell) = Lattice::frame(ground)?;
    // A position without a place in the ground's system is an error of the query itself.
    let to_ground = |&at: &DVec2| reach.crs.transform(crs, at).unwrap_or(DVec2::NAN);
    let on_ground = reach.at.par_iter().map(to_ground).filter(|at| at.is_finite()).collect::<Vec<_>>();
    let around = Rect::around(on_ground);
    let (low, high) = match around.is_empty() {
        // All of it, whatever the positions.
        true if reach.at.is_empty() && reach.around_m.is_infinite() => {
            (DVec2::ZERO, DVec2::new(ground.width.into(), ground.height.into()))
        }
        true => (DVec2::ZERO, DVec2::ONE),
        false => {
            let margin = HALO + reach.around_m / cell;
            ((around.min - origin) / cell - margin, (around.max - origin) / cell + margin)
        }
    };
    let held = PostRect::around((ground.width, ground.height), low, high);
    if held.width() as u64 * held.height() as u64 > RASTER_SAMPLES.get() {
        let (columns, rows) = (held.width(), held.height());
        return Err(GroundError::Reach { columns, rows });
    }
    Ok(held)
}

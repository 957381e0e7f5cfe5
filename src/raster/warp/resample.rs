//! The two ways of resampling a raster to square cells.
//!
//! *Bilinear* interpolates the source at the center of every cell. It is right where cells are about as large as the
//! source's, or smaller; where they are much larger it sees one sample of many. *Average* goes the other way round: the
//! value of a cell is the mean of the source's samples whose centers fall into it, holes left out.

use std::ops::Range;

use glam::{DVec2, U64Vec2};
use rayon::prelude::*;

use crate::cell_grid::{CellGrid, CellGridError};
use crate::raster::{Raster, SampleFloat, Samples};
use crate::sample::bilinear_at_grid;
use crate::warp::crs_transform::CrsTransform;
use crate::warp::data_extent::{data_extent, outline};
use crate::warp::error::WarpError;
use crate::warp::row_positions::{positions, positions_within};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_geom::rect::Rect;

/// Without a stated cell, the samples of the output per sample of the source: a raster turned by 45° needs 2.
const GROWTH: u64 = 8;

/// Positions that are computed before their samples are summed: some megabytes.
const POSITIONS_AT_ONCE: usize = 1 << 19;

/// A raster and the cells that it is resampled to.
pub(super) struct Resampler<'a> {
    source: &'a Raster,
    transform: &'a CrsTransform<'a>,
    cells: CellGrid,
}

impl<'a> Resampler<'a> {
    /// Resamples to cells around the valid samples, on multiples of the cell; by default as large as the source's at
    /// the center.
    pub fn around(
        source: &'a Raster,
        transform: &'a CrsTransform<'a>,
        cell: Option<f64>,
    ) -> Result<Self, WarpError> {
        let valid = data_extent(source).ok_or(WarpError::Empty)?;
        Self::around_valid(source, transform, cell, valid)
    }

    /// [`Resampler::around`] the valid samples, which lie in this rectangle of the source's grid; its samples are not used.
    pub fn around_valid(
        source: &'a Raster,
        transform: &'a CrsTransform<'a>,
        cell: Option<f64>,
        valid: Rect,
    ) -> Result<Self, WarpError> {
        transform.check_poles(source)?;
        let at = |grid: DVec2| transform.forward(source.map_from_grid.transform_point2(grid));
        let side = match cell {
            Some(cell) => cell,
            None => CellSize::new(valid.center(), &at)?.side,
        };
        let extent = Rect::around(outline(valid).map(at).collect::<Result<Vec<_>, _>>()?);
        let most = if cell.is_some() {
            RASTER_SAMPLES.get()
        } else {
            u64::from(source.width) * u64::from(source.height) * GROWTH + 1024
        };
        Self::new(source, transform, CellGrid::around(extent, side), most)
    }

    /// Resamples to cells over a raster with north up, from its own corner.
    pub fn over(source: &'a Raster, transform: &'a CrsTransform<'a>, cell: f64) -> Result<Self, WarpError> {
        Self::new(source, transform, CellGrid::within(source.extent(), cell), RASTER_SAMPLES.get())
    }

    fn new(
        source: &'a Raster,
        transform: &'a CrsTransform<'a>,
        cells: Result<CellGrid, CellGridError>,
        most: u64,
    ) -> Result<Self, WarpError> {
        let too_large = |width, height| {
            let system = transform.to.map_or("north up", Crs::name).into();
            WarpError::TooLarge { system, size: U64Vec2::new(width, height) }
        };
        let cells = cells.map_err(|error| match error {
            CellGridError::TooMany { columns, rows, .. } => too_large(columns as u64, rows as u64),
            CellGridError::Cell(_) | CellGridError::Empty(_) => too_large(0, 0),
        })?;
        let (width, height) = (u64::from(cells.width()), u64::from(cells.height()));
        if width * height > most {
            Err(too_large(width, height))
        } else {
            Ok(Self { source, transform, cells })
        }
    }

    /// Resamples to cells that were found before.
    pub fn to_cells(source: &'a Raster, transform: &'a CrsTransform<'a>, cells: CellGrid) -> Self {
        Self { source, transform, cells }
    }

    pub fn cell(&self) -> f64 {
        self.cells.cell()
    }

    /// The cells.
    pub fn cells(&self) -> CellGrid {
        self.cells
    }

    /// All of the output but its samples.
    pub fn header(&self) -> Raster {
        self.raster(Samples::F32(Vec::new()))
    }

    /// The source's values at the centers of the cells.
    pub fn bilinear(&self) -> Raster {
        self.raster(match self.source.samples {
            Samples::F32(_) => self.interpolated::<f32>(),
            Samples::F64(_) => self.interpolated::<f64>(),
        })
    }

    fn interpolated<T: SampleFloat>(&self) -> Samples {
        let rows = (0..self.cells.height()).into_par_iter().map(|row| {
            let value = |at: DVec2| bilinear_at_grid(self.source, at).parts().0;
            let positions = self.row_positions(row, 0..self.cells.width());
            positions.into_iter().map(|at| T::from_f64(value(at))).collect::<Vec<T>>()
        });
        T::into_samples(rows.flatten_iter().collect())
    }

    /// The positions of the centers of some cells of a row in the source's grid; NaN where they have no place.
    pub fn row_positions(&self, row: u32, columns: Range<u32>) -> Vec<DVec2> {
        let position = |column: usize| {
            let at = self.transform.back(self.cells.center(column as u32, row))?;
            Some(self.source.grid_from_map(at))
        };
        let columns = columns.start as usize..columns.end as usize;
        positions_within(self.cells.width() as usize, columns, &position)
    }

    /// The means of the source's samples in each cell.
    pub fn average(&self) -> Raster {
        let mut means = CellMeans::new(self);
        means.add_rows(0, &self.source.samples);
        means.raster(self.source.samples.is_wide())
    }

    /// Where the centers of a row of the source lie, in cells from the lattice's corner.
    fn cells_of_row(&self, row: usize) -> Vec<DVec2> {
        positions(self.source.width as usize, &|column| {
            let center = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
            let at = self.transform.forward(self.source.map_from_grid.transform_point2(center)).ok()?;
            Some((at - self.cells.corner()) * DVec2::new(1.0, -1.0) / self.cells.cell())
        })
    }

    fn index(&self, at: DVec2) -> Option<usize> {
        let (width, height) = (self.cells.width(), self.cells.height());
        let is_within = at.x >= 0.0 && at.y >= 0.0 && at.x < f64::from(width) && at.y < f64::from(height);
        is_within.then(|| at.y as usize * width as usize + at.x as usize)
    }

    /// The output with these samples.
    pub fn raster(&self, samples: Samples) -> Raster {
        Raster {
            width: self.cells.width(),
            height: self.cells.height(),
            samples,
            map_from_grid: self.cells.map_from_grid(),
            georeferenced: true,
            crs: self.transform.to.cloned(),
            ..self.source.without_samples()
        }
    }
}

/// Sums of the source's samples in each cell, whose rows are added in order.
pub(super) struct CellMeans<'a> {
    resampler: &'a Resampler<'a>,
    sums: Vec<f64>,
    counts: Vec<u32>,
}

impl<'a> CellMeans<'a> {
    /// No sample yet.
    pub fn new(resampler: &'a Resampler<'a>) -> Self {
        let cells = resampler.cells.width() as usize * resampler.cells.height() as usize;
        Self { resampler, sums: vec![0.0; cells], counts: vec![0; cells] }
    }

    /// Adds whole rows of the source, from row `first` on.
    pub fn add_rows(&mut self, first: usize, samples: &Samples) {
        let width = self.resampler.source.width as usize;
        let (rows, rows_at_once) = (samples.len() / width, (POSITIONS_AT_ONCE / width).max(1));
        for start in (0..rows).step_by(rows_at_once) {
            let at_once = start..rows.min(start + rows_at_once);
            let positions: Vec<Vec<DVec2>> =
                at_once.into_par_iter().map(|row| self.resampler.cells_of_row(first + row)).collect();
            // Summed in order: the same bits for every number of threads.
            for (index, at) in (start * width..).zip(positions.into_iter().flatten()) {
                let value = samples.get(index);
                if let Some(cell) = self.resampler.index(at).filter(|_| !value.is_nan()) {
                    self.sums[cell] += value;
                    self.counts[cell] += 1;
                }
            }
        }
    }

    /// The raster of the means, of 64 bits where it is wide.
    pub fn raster(self, is_wide: bool) -> Raster {
        let means = self.sums.into_iter().zip(self.counts).map(|(sum, count)| sum / f64::from(count));
        self.resampler.raster(match is_wide {
            false => Samples::F32(means.map(|mean| mean as f32).collect()),
            true => Samples::F64(means.collect()),
        })
    }
}

/// The size of a source cell in the output's system.
pub(super) struct CellSize {
    /// The side of a square of the same area.
    pub side: f64,
    /// The longer side.
    pub longest: f64,
}

impl CellSize {
    /// The size of the cell around the grid position `center`.
    pub fn new(center: DVec2, at: &impl Fn(DVec2) -> Result<DVec2, CrsError>) -> Result<Self, WarpError> {
        let half = DVec2::splat(0.5);
        let east = at(center + half * DVec2::X)? - at(center - half * DVec2::X)?;
        let south = at(center + half * DVec2::Y)? - at(center - half * DVec2::Y)?;
        Ok(Self { side: east.perp_dot(south).abs().sqrt(), longest: east.length().max(south.length()) })
    }
}

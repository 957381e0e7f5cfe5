//! The lattice that a raster is resampled to, and the two ways of filling it.
//!
//! *Bilinear* asks the source at the center of every cell. It is right where cells are about as large as the source's,
//! or smaller; where they are much larger it sees one sample of many. *Average* is the other way round: every sample
//! of the source falls into the cell that holds its center, and a cell's value is the mean of those that fell into it,
//! holes left out.

use glam::{DVec2, UVec2};
use rayon::prelude::*;

use crate::dem::error::MOST_SAMPLES;
use crate::dem::raster::{Raster, Samples, north_up};
use crate::dem::sample::bilinear_at_grid;
use crate::dem::valid::{outline, valid_grid};
use crate::dem::warp::WarpError;
use crate::dem::warp::line;
use crate::geom::crs::{Crs, CrsError};
use crate::geom::rect::Rect;

/// Where the cell is not chosen the output may have this many times the samples of the source: a raster turned by 45°
/// needs 2.
const GROWTH: u64 = 8;

/// Positions that are worked out before their samples are summed: some megabytes.
const POSITIONS_AT_ONCE: usize = 1 << 19;

/// How much of a cell, beyond a whole number of them, counts as rounding.
const SLIVER: f64 = 1e-6;

/// The way between a raster's system and another; the identity where there is none or they are the same.
pub(crate) struct CrsTransform<'a> {
    from: Option<&'a Crs>,
    to: Option<&'a Crs>,
    /// The longitudes that come out count on from these: those of the raster's center in either system.
    from_center: Option<f64>,
    to_center: Option<f64>,
}

impl<'a> CrsTransform<'a> {
    /// From the raster's system `from` to `to`.
    pub fn new(raster: &Raster, from: Option<&'a Crs>, to: Option<&'a Crs>) -> Self {
        let is_in_degrees = |crs: &&Crs| crs.is_geographic();
        let from_center = from.filter(is_in_degrees).map(|_| raster.center().x);
        let mut way = Self { from, to, from_center, to_center: None };
        let center = to.filter(is_in_degrees).and_then(|_| way.forward(raster.center()).ok());
        way.to_center = center.map(|center| center.x);
        way
    }

    /// From the raster's system.
    pub fn forward(&self, at: DVec2) -> Result<DVec2, CrsError> {
        match (self.from, self.to) {
            (Some(from), Some(to)) => from.transform(to, at).map(|at| counted_on(at, self.to_center)),
            _ => Ok(at),
        }
    }

    /// To the raster's system.
    pub fn back(&self, at: DVec2) -> Option<DVec2> {
        match (self.from, self.to) {
            (Some(from), Some(to)) => to.transform(from, at).ok().map(|at| counted_on(at, self.from_center)),
            _ => Some(at),
        }
    }
}

/// The position whose longitude is nearest to `center`: longitudes come within ±180°, rasters reach beyond.
fn counted_on(at: DVec2, center: Option<f64>) -> DVec2 {
    let turns = center.map_or(0.0, |center| ((center - at.x) / 360.0).round());
    if turns == 0.0 { at } else { DVec2::new(at.x + 360.0 * turns, at.y) }
}

/// The lattice of the output: north up, square cells.
pub(crate) struct WarpGrid {
    /// Outer north-west corner.
    corner: DVec2,
    /// Side of a cell in the units of the output's system.
    cell: f64,
    size: UVec2,
}

impl WarpGrid {
    /// Around the valid samples, on multiples of the cell; where none is given, of the size of the source's cells at
    /// the center.
    pub fn around(raster: &Raster, way: &CrsTransform, cell: Option<f64>) -> Result<Self, WarpError> {
        let valid = valid_grid(raster).ok_or(WarpError::Empty)?;
        check_poles(raster, way)?;
        let at = |grid: DVec2| way.forward(raster.map_from_grid.transform_point2(grid));
        let (own, _) = cell_sizes(valid.center(), &at)?;
        let side = cell.unwrap_or(own);
        let border = outline(valid).map(at).collect::<Result<Vec<_>, _>>()?;
        let around = Rect::around(border);
        let (low, high) = ((around.min / side).floor(), (around.max / side).ceil());
        let growth = if cell.is_some() { MOST_SAMPLES } else { raster.samples.len() as u64 * GROWTH + 1024 };
        Self::checked(DVec2::new(low.x, high.y) * side, side, high - low, growth, way)
    }

    /// Over a raster with north up, from its own corner.
    pub fn over(raster: &Raster, cell: f64) -> Result<Self, WarpError> {
        let Rect { min, max } = raster.extent();
        let size = ((max - min) / cell - SLIVER).ceil().max(DVec2::ONE);
        let way = CrsTransform { from: None, to: raster.crs.as_ref(), from_center: None, to_center: None };
        Self::checked(DVec2::new(min.x, max.y), cell, size, MOST_SAMPLES, &way)
    }

    fn checked(
        corner: DVec2,
        cell: f64,
        size: DVec2,
        most: u64,
        way: &CrsTransform,
    ) -> Result<Self, WarpError> {
        let [width, height] = [size.x as u64, size.y as u64];
        let limit = MOST_SAMPLES.min(most);
        if !cell.is_normal() || width == 0 || height == 0 || width.saturating_mul(height) > limit {
            let system = way.to.map_or("north up", Crs::name).into();
            return Err(WarpError::TooLarge { system, width, height });
        }
        Ok(Self { corner, cell, size: UVec2::new(width as u32, height as u32) })
    }

    /// Side of a cell.
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// The source's values at the centers of the cells.
    pub fn bilinear(&self, raster: &Raster, way: &CrsTransform) -> Raster {
        let samples = match &raster.samples {
            Samples::F32(_) => Samples::F32(self.filled(raster, way, |value| value as f32)),
            Samples::F64(_) => Samples::F64(self.filled(raster, way, |value| value)),
        };
        self.with(samples, raster, way)
    }

    fn filled<T: Send>(
        &self,
        raster: &Raster,
        way: &CrsTransform,
        narrow: impl Fn(f64) -> T + Sync,
    ) -> Vec<T> {
        let width = self.size.x as usize;
        let rows = (0..self.size.y).into_par_iter().map(|row| {
            let y = self.corner.y - (f64::from(row) + 0.5) * self.cell;
            let center = |column: usize| DVec2::new(self.corner.x + (column as f64 + 0.5) * self.cell, y);
            let mut positions = vec![DVec2::NAN; width];
            line::fill(&mut positions, &|column| way.back(center(column)).map(|at| raster.grid_from_map(at)));
            positions.into_iter().map(|at| narrow(bilinear_at_grid(raster, at).parts().0)).collect::<Vec<T>>()
        });
        rows.flatten_iter().collect()
    }

    /// The means of the source's samples in each cell.
    pub fn average(&self, raster: &Raster, way: &CrsTransform) -> Raster {
        let cells = self.size.x as usize * self.size.y as usize;
        let (mut sums, mut counts) = (vec![0f64; cells], vec![0u32; cells]);
        let width = raster.width as usize;
        let rows_at_once = (POSITIONS_AT_ONCE / width).max(1) as u32;
        for first in (0..raster.height).step_by(rows_at_once as usize) {
            let rows = first..raster.height.min(first + rows_at_once);
            let positions: Vec<Vec<DVec2>> =
                rows.clone().into_par_iter().map(|row| self.cells_of_row(raster, way, row)).collect();
            // Summed one after the other: the same bits for every number of threads.
            for (row, positions) in rows.zip(positions) {
                for (column, at) in positions.into_iter().enumerate() {
                    let value = raster.samples.get(row as usize * width + column);
                    if let Some(cell) = self.index(at).filter(|_| !value.is_nan()) {
                        sums[cell] += value;
                        counts[cell] += 1;
                    }
                }
            }
        }
        let means = sums.into_iter().zip(counts).map(|(sum, count)| sum / f64::from(count));
        let samples = match raster.samples {
            Samples::F32(_) => Samples::F32(means.map(|mean| mean as f32).collect()),
            Samples::F64(_) => Samples::F64(means.collect()),
        };
        self.with(samples, raster, way)
    }

    /// Where the centers of a row of the source lie in this lattice, in cells from its corner.
    fn cells_of_row(&self, raster: &Raster, way: &CrsTransform, row: u32) -> Vec<DVec2> {
        let mut positions = vec![DVec2::NAN; raster.width as usize];
        line::fill(&mut positions, &|column| {
            let center = DVec2::new(column as f64 + 0.5, f64::from(row) + 0.5);
            let at = way.forward(raster.map_from_grid.transform_point2(center)).ok()?;
            Some((at - self.corner) * DVec2::new(1.0, -1.0) / self.cell)
        });
        positions
    }

    fn index(&self, at: DVec2) -> Option<usize> {
        let size = self.size.as_dvec2();
        let is_within = at.x >= 0.0 && at.y >= 0.0 && at.x < size.x && at.y < size.y;
        is_within.then(|| at.y as usize * self.size.x as usize + at.x as usize)
    }

    fn with(&self, samples: Samples, raster: &Raster, way: &CrsTransform) -> Raster {
        Raster {
            driver: raster.driver,
            data_type: raster.data_type,
            width: self.size.x,
            height: self.size.y,
            samples,
            meters_per_z: raster.meters_per_z,
            map_from_grid: north_up(self.corner, DVec2::splat(self.cell)),
            georeferenced: true,
            crs: way.to.cloned(),
            nodata: raster.nodata,
            vertical_datum: raster.vertical_datum.clone(),
        }
    }
}

/// A raster over a pole has no border in degrees.
fn check_poles(raster: &Raster, way: &CrsTransform) -> Result<(), WarpError> {
    let (Some(from), Some(to)) = (way.from, way.to) else { return Ok(()) };
    if from.is_geographic() || !to.is_geographic() {
        return Ok(());
    }
    let size = DVec2::new(f64::from(raster.width), f64::from(raster.height));
    let holds = |latitude: f64| {
        let pole = to.transform(from, DVec2::new(0.0, latitude)).map(|at| raster.grid_from_map(at));
        // A projection that does not cover the pole may answer with anything: only what leads back counts.
        let leads_back = |at: DVec2| {
            let back = from.transform(to, raster.map_from_grid.transform_point2(at));
            back.is_ok_and(|back| (back.y - latitude).abs() < 1e-6)
        };
        pole.is_ok_and(|at| at.cmpge(DVec2::ZERO).all() && at.cmple(size).all() && leads_back(at))
    };
    if holds(90.0) || holds(-90.0) { Err(WarpError::Pole { system: to.name().into() }) } else { Ok(()) }
}

/// The side of a square as large as one source cell is at `center`, and the longer side of that cell.
pub(crate) fn cell_sizes(
    center: DVec2,
    at: &impl Fn(DVec2) -> Result<DVec2, CrsError>,
) -> Result<(f64, f64), WarpError> {
    let half = DVec2::splat(0.5);
    let east = at(center + half * DVec2::X)? - at(center - half * DVec2::X)?;
    let south = at(center + half * DVec2::Y)? - at(center - half * DVec2::Y)?;
    Ok((east.perp_dot(south).abs().sqrt(), east.length().max(south.length())))
}

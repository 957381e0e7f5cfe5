//! Grids of scattered points: the ground between points that were measured, at the center of every cell.
//!
//! ```text
//!   PointCloud ──► sites ──────────────┬──► hull ──► the cells between the points
//!   (any order,    (sorted, one per    │
//!    doubles)       position)          ├──► tin ──► linear   planes between three sites (breaklines hold)
//!                                      │      └───► natural  Sibson's natural neighbors
//!                                      └──► kd ───► weighted inverse distance, quadrants, nearest
//! ```
//!
//! Everything is computed from the sites in sorted order and cell by cell from a fixed start: the same points in any
//! order and on any number of threads give the same bits. Cells whose center lies outside the convex hull of the points
//! hold no data by default: there, every method guesses.

pub mod breaklines;
pub mod error;
mod hull;
mod kd;
mod linear;
pub mod method;
mod natural;
mod sites;
mod tin;
mod web;
mod weighted;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use sandtable_base::message::choice::{Choice, ChoiceWord, word};

use crate::gridding::breaklines::Crossings;
use crate::gridding::error::GridError;
use crate::gridding::hull::Hull;
use crate::gridding::kd::KdTree;
use crate::gridding::linear::CellCenters;
use crate::gridding::method::GriddingMethod;
use crate::gridding::natural::Naturals;
use crate::gridding::sites::Sites;
use crate::gridding::tin::Tin;
use crate::gridding::weighted::WeightedSites;
use crate::points::cloud::PointCloud;
use sandtable_raster::cell_grid::CellGrid;
use sandtable_raster::raster::{Raster, Samples};

/// The value of a cell outside the convex hull of the points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BeyondHull {
    /// No data.
    #[default]
    NoData,
    /// The height of the nearest point.
    Nearest,
}

impl Choice for BeyondHull {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::NoData, "nodata", "No data"),
        word(Self::Nearest, "nearest", "The height of the nearest point"),
    ];
}

/// A grid of points, and its report.
#[derive(Clone, Debug)]
pub struct Gridded {
    /// The grid, in 64 bits and the points' vertical unit.
    pub raster: Raster,
    /// Counts.
    pub report: GriddingReport,
}

/// The counts of a gridding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GriddingReport {
    /// Points, without the vertices of breaklines.
    pub points: usize,
    /// Points and vertices of breaklines with the x and y of an earlier one; a position takes the mean height.
    pub duplicates: usize,
    /// Breaklines.
    pub breaklines: usize,
    /// Crossings of breaklines away from their vertices.
    pub crossings: Crossings,
    /// Cells that hold a height.
    pub filled: usize,
}

/// Makes a grid of a cloud: a [`Raster`] of `cells`, NaN where there is no data, with the cloud's system, unit and
/// datum.
///
/// Breaklines are edges of triangles for [`GriddingMethod::Tin`]; the other methods take points along them, at most
/// half a cell apart.
///
/// # Errors
/// [`GridError`]: a point that is not finite, points that all lie on one line, a parameter out of range.
pub fn grid(
    cloud: &PointCloud,
    cells: &CellGrid,
    method: GriddingMethod,
    beyond: BeyondHull,
) -> Result<Gridded, GridError> {
    method.check()?;
    let (heights, mut report) = heights(cloud, cells, method, beyond)?;
    report.filled = heights.iter().filter(|height| !height.is_nan()).count();
    let raster = Raster {
        driver: "grid",
        meters_per_z: cloud.meters_per_z,
        states_z_unit: cloud.meters_per_z != 1.0,
        crs: cloud.crs.clone(),
        vertical_datum: cloud.vertical_datum.clone(),
        ..Raster::new(cells.width(), Samples::F64(heights)).placed(cells.map_from_grid())
    };
    Ok(Gridded { raster, report })
}

fn heights(
    cloud: &PointCloud,
    grid: &CellGrid,
    method: GriddingMethod,
    beyond: BeyondHull,
) -> Result<(Vec<f64>, GriddingReport), GridError> {
    let along: Vec<DVec3> = match method {
        GriddingMethod::Tin => cloud.breaklines.iter().flatten().copied().collect(),
        _ => cloud
            .breaklines
            .iter()
            .flat_map(|line| breaklines::points_along(line, grid.cell() * 0.5))
            .collect(),
    };
    let sites = Sites::new(&cloud.points, &along)?;
    let mut report = GriddingReport {
        points: cloud.points.len(),
        duplicates: sites.duplicates,
        breaklines: cloud.breaklines.len(),
        ..GriddingReport::default()
    };
    let cells = CellCenters::new(grid, sites.origin);
    let mut out = vec![f64::NAN; cells.len()];
    match method {
        GriddingMethod::Tin => {
            let (tin, crossings) = Tin::new(&sites, &cloud.breaklines)?;
            report.crossings = crossings;
            linear::fill(&tin, &cells, &mut out);
        }
        GriddingMethod::Natural => {
            let naturals = Naturals::new(&sites)?;
            naturals.fill(&Hull::new(&sites), &cells, &mut out);
        }
        GriddingMethod::InverseDistance { .. }
        | GriddingMethod::Quadrant { .. }
        | GriddingMethod::Nearest => {
            let hull = Hull::new(&sites);
            if hull.is_flat() && beyond == BeyondHull::NoData {
                return Err(GridError::Collinear(sites.len()));
            }
            WeightedSites::new(&sites, method).fill(&hull, &cells, &mut out);
        }
    }
    if beyond == BeyondHull::Nearest {
        fill_with_nearest(&sites, &cells, &mut out);
    }
    Ok((out, report))
}

/// Sets every cell without data to the height of the nearest site.
fn fill_with_nearest(sites: &Sites, cells: &CellCenters, out: &mut [f64]) {
    if !out.iter().any(|height| height.is_nan()) {
        return;
    }
    let tree = KdTree::new(&sites.at);
    out.par_chunks_mut(cells.x.len()).zip(&cells.y).for_each(|(row, &y)| {
        for (height, &x) in row.iter_mut().zip(&cells.x).filter(|(height, _)| height.is_nan()) {
            let nearest = tree.nearest(DVec2::new(x, y));
            *height = nearest.map_or(f64::NAN, |site| sites.z[site as usize]);
        }
    });
}

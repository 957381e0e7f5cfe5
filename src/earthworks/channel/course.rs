//! A channel's stations: where its line crosses the finest triangles, and the ground across the water there.
//!
//! ```text
//!     far bank ·                 raw   the lowest of middle and edges: water seeks the lowest ground that it covers
//!         edge ·┐                bank  the lower of the two banks, each the highest ground on its side
//!   ──────────o │ width   ──►
//!         edge ·┘
//!     far bank ·
//! ```

use std::ops::ControlFlow;

use glam::DVec2;

use crate::alignment::Alignment;
use crate::channel::river_cut::Channel;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::sight::crossings::crossings;

/// A channel with its stations, downstream.
pub(super) struct ChannelCourse<'a> {
    pub channel: &'a Channel,
    /// Every vertex, and every crossing with an edge of the finest triangles.
    pub stations: Vec<CourseStation>,
}

/// A place on a centerline.
#[derive(Clone, Copy, Debug)]
pub(super) struct CourseStation {
    /// Meters from the line's start.
    pub station_m: f64,
    /// Posts from the lattice's first.
    pub grid: DVec2,
    /// World coordinates.
    pub at: DVec2,
    /// Half the water's width.
    pub half_m: f64,
    /// Which vertex of the line it is.
    pub vertex: Option<usize>,
    /// The lowest ground across the water; NaN where there is none.
    pub raw_m: f64,
    /// How high water may stand before it flows over a bank.
    pub bank_m: f64,
    /// The level of the lake it lies in.
    pub lake_m: Option<f64>,
    /// The reach that it is of, once they are found; `None` where the channel climbs.
    pub reach: Option<usize>,
    /// The water's level, once it is found; NaN where there is no ground or the channel climbs.
    pub level_m: f64,
    /// The lowest that the level may be without a cut too deep here or on the rest of the reach.
    pub lowest_m: f64,
}

impl CourseStation {
    /// The distance from the centerline within which posts are set to the water's level: under the water, and as far
    /// again on either side as the water is wide, but no further than the corners of the cells it touches. So water as
    /// wide as cells are lies level on its whole width, and a brook on wide cells leaves the posts beside it alone.
    pub fn bed_m(&self, lattice: &Lattice) -> f64 {
        self.half_m + self.half_m.min(lattice.cell().length())
    }
}

impl<'a> ChannelCourse<'a> {
    /// Every two stations in a row that are of one reach.
    pub fn pairs(&self) -> impl Iterator<Item = [CourseStation; 2]> + '_ {
        let of_one_reach =
            |pair: &&[CourseStation]| pair[0].reach.is_some() && pair[0].reach == pair[1].reach;
        self.stations.windows(2).filter(of_one_reach).map(|pair| [pair[0], pair[1]])
    }

    /// The stations of a channel, levels not yet found.
    pub fn of(lattice: &Lattice, channel: &'a Channel) -> Self {
        let Alignment { line, width, .. } = &channel.alignment;
        let points = line.points();
        let mut course = Self { channel, stations: Vec::new() };
        for (index, pair) in points.windows(2).enumerate() {
            let across = (pair[1] - pair[0]).normalize_or_zero().perp();
            let [start_m, end_m] = [index, index + 1].map(|vertex| line.stations()[vertex]);
            let halves = [start_m, end_m].map(|station_m| width.at(station_m) / 2.0);
            let mut add = |part: f64, grid: DVec2, vertex: Option<usize>| {
                let place = StationPoint {
                    station_m: start_m + (end_m - start_m) * part,
                    at: pair[0].lerp(pair[1], part),
                    half_m: halves[0] + (halves[1] - halves[0]) * part,
                };
                course.stations.push(place.station(lattice, across, grid, vertex));
            };
            let [from, to] = [pair[0], pair[1]].map(|at| lattice.grid_at(at));
            add(0.0, from, Some(index));
            let _ = crossings(lattice, from, to, |crossing| {
                add(crossing.part, crossing.grid, None);
                ControlFlow::<()>::Continue(())
            });
            if index + 2 == points.len() {
                add(1.0, to, Some(index + 1));
            }
        }
        course
    }
}

/// Where a station lies.
struct StationPoint {
    station_m: f64,
    at: DVec2,
    half_m: f64,
}

impl StationPoint {
    fn station(self, lattice: &Lattice, across: DVec2, grid: DVec2, vertex: Option<usize>) -> CourseStation {
        let Self { station_m, at, half_m } = self;
        let ground = |aside_m: f64| height(lattice, at + across * aside_m);
        let middle = ground(0.0);
        let far_m = half_m + half_m.min(lattice.cell().length()) + lattice.cell().max_element();
        let side = |sign: f64| {
            let edge = ground(sign * half_m);
            // `max` and `min` leave out what is not a number: a bank without data holds nothing back, but nothing is
            // known against it either.
            (edge, edge.max(ground(sign * far_m)))
        };
        let ((left, left_bank), (right, right_bank)) = (side(1.0), side(-1.0));
        let lake_m = lake_at(lattice, grid);
        let raw_m = if middle.is_nan() { f64::NAN } else { middle.min(left).min(right) };
        CourseStation {
            station_m,
            grid,
            at,
            half_m,
            vertex,
            raw_m: lake_m.unwrap_or(raw_m),
            bank_m: left_bank.min(right_bank).max(raw_m),
            lake_m,
            reach: None,
            level_m: f64::NAN,
            lowest_m: f64::NEG_INFINITY,
        }
    }
}

/// The ground at a world position; NaN where there is none.
fn height(lattice: &Lattice, at: DVec2) -> f64 {
    let answer = ground_height(lattice, Interpolation::Planar, at + lattice.origin());
    answer.height_m().unwrap_or(f64::NAN)
}

/// The level of the lake at a grid position: there the cell's posts are pinned and level.
fn lake_at(lattice: &Lattice, grid: DVec2) -> Option<f64> {
    let (cell, _) = lattice.cell_at_grid(grid)?;
    let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(east, north)| cell.offset(east, north));
    let level = lattice.height(cell);
    let is_lake = corners.iter().all(|&post| lattice.is_pinned(post) && lattice.height(post) == level);
    is_lake.then_some(f64::from(level))
}

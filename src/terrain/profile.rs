//! The ground along a line, at every crossing with an edge of the finest triangles.
//!
//! Where the line leaves the model or comes back there is a station on the model's border; where it runs into a hole, the
//! last station with a height is the hole's rim. Between two neighboring stations with heights there is ground throughout.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::lattice::Lattice;
use crate::query::{Interpolation, ground_height};
use crate::sight::crossings::crossings;
use sandtable_raster::answer::Answer;

/// A position along a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileStation {
    /// Meters along the line from its start.
    pub station_m: f64,
    /// Map coordinates.
    pub at: DVec2,
    /// The height of the ground, or why there is none.
    pub ground: Answer,
}

/// The sampling of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// The interpolation between posts. Only the planar ground is straight between stations.
    pub interpolation: Interpolation,
    /// The distance, above 0, of additional stations counted from the line's start; `None` for none.
    pub step_m: Option<f64>,
}

impl Default for Sampling {
    /// The planar ground without additional stations.
    fn default() -> Self {
        Self { interpolation: Interpolation::Planar, step_m: None }
    }
}

/// The ground along `line` (map coordinates in meters, at least one vertex): its vertices and every crossing with an
/// edge of the finest triangles, in order. Between neighboring stations the planar ground is straight.
///
/// Costs three stations a cell. A vertex that is not finite has no ground, nor have its segments.
pub fn profile(lattice: &Lattice, line: &[DVec2]) -> Vec<ProfileStation> {
    sampled_profile(lattice, line, Sampling::default())
}

/// [`profile`] by another interpolation, at the same stations and at steps between them.
///
/// # Panics
/// Where the step is not above 0.
pub fn sampled_profile(lattice: &Lattice, line: &[DVec2], sampling: Sampling) -> Vec<ProfileStation> {
    assert!(sampling.step_m.is_none_or(|step_m| step_m > 0.0), "a step must be above 0: {sampling:?}");
    let mut profiler = Profiler { lattice, sampling, start_m: 0.0, stations: Vec::new() };
    for pair in line.windows(2) {
        profiler.add_segment(pair[0], pair[1]);
    }
    if let Some(&last) = line.last() {
        profiler.add_sample(profiler.start_m, last);
    }
    profiler.stations
}

struct Profiler<'a> {
    lattice: &'a Lattice,
    sampling: Sampling,
    /// The station of the next segment's start.
    start_m: f64,
    stations: Vec<ProfileStation>,
}

impl Profiler<'_> {
    fn add_sample(&mut self, station_m: f64, at: DVec2) {
        self.stations.push(ProfileStation { station_m, at, ground: self.ground(at) });
    }

    fn ground(&self, at: DVec2) -> Answer {
        ground_height(self.lattice, self.sampling.interpolation, at)
    }

    fn add_segment(&mut self, from: DVec2, to: DVec2) {
        self.add_sample(self.start_m, from);
        let length_m = from.distance(to);
        if !length_m.is_finite() {
            return;
        }
        let first = self.stations.len();
        self.add_crossings(from, to, length_m);
        self.add_steps(from, to, length_m);
        self.stations[first..].sort_by(|a, b| a.station_m.total_cmp(&b.station_m));
        self.start_m += length_m;
    }

    fn add_crossings(&mut self, from: DVec2, to: DVec2, length_m: f64) {
        let ends = [from, to].map(|at| self.lattice.grid_from_map(at));
        let _ = crossings(self.lattice, ends[0], ends[1], |crossing| {
            let at = from + (to - from) * crossing.part;
            let ground = match self.sampling.interpolation {
                Interpolation::Planar if crossing.height_m.is_nan() => Answer::NoData,
                Interpolation::Planar => Answer::Height(crossing.height_m),
                // Rounding may move a crossing with the border off the model.
                _ => self.ground(self.clamp_to_model(at)),
            };
            let station_m = self.start_m + length_m * crossing.part;
            self.stations.push(ProfileStation { station_m, at, ground });
            ControlFlow::<()>::Continue(())
        });
    }

    /// Adds the stations at multiples of the step that lie within the segment.
    fn add_steps(&mut self, from: DVec2, to: DVec2, length_m: f64) {
        let Some(step_m) = self.sampling.step_m else { return };
        let end_m = self.start_m + length_m;
        let mut count = (self.start_m / step_m).floor() + 1.0;
        while count * step_m < end_m {
            let station_m = count * step_m;
            self.add_sample(station_m, from + (to - from) * ((station_m - self.start_m) / length_m));
            count += 1.0;
        }
    }

    /// The nearest map position on the model.
    fn clamp_to_model(&self, at: DVec2) -> DVec2 {
        let (origin, extent) = (self.lattice.origin(), self.lattice.extent());
        origin + (at - origin).clamp(extent.min, extent.max)
    }
}

/// The lowest or the highest point of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// Meters along the line from its start; the first such point.
    pub station_m: f64,
    /// Map coordinates.
    pub at: DVec2,
    /// Meters.
    pub height_m: f64,
}

/// Lengths, climbs and extremes of a profile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProfileSummary {
    /// The line's length in plan, meters.
    pub length_m: f64,
    /// The length of its parts with ground, meters in plan.
    pub covered_m: f64,
    /// The length over the ground, up and down, where there is ground; meters.
    pub ground_length_m: f64,
    /// The sum of all climbs in meters.
    pub ascent_m: f64,
    /// The sum of all descents in meters; not negative.
    pub descent_m: f64,
    /// The lowest point; `None` where the line has no ground at all.
    pub lowest: Option<Extreme>,
    /// The highest point.
    pub highest: Option<Extreme>,
}

impl ProfileSummary {
    /// The summary of the stations of a profile, in order.
    pub fn from_stations(stations: &[ProfileStation]) -> Self {
        let length_m = stations.last().map_or(0.0, |last| last.station_m);
        let mut summary = Self { length_m, ..Self::default() };
        let mut before: Option<Extreme> = None;
        for &ProfileStation { station_m, at, ground } in stations {
            let here = ground.height_m().map(|height_m| Extreme { station_m, at, height_m });
            if let Some(here) = here {
                if let Some(before) = before {
                    summary.add_step(here.station_m - before.station_m, here.height_m - before.height_m);
                }
                let is_lower = summary.lowest.is_none_or(|lowest| here.height_m < lowest.height_m);
                let is_higher = summary.highest.is_none_or(|highest| here.height_m > highest.height_m);
                summary.lowest = if is_lower { Some(here) } else { summary.lowest };
                summary.highest = if is_higher { Some(here) } else { summary.highest };
            }
            before = here;
        }
        summary
    }

    fn add_step(&mut self, along_m: f64, up_m: f64) {
        self.covered_m += along_m;
        self.ground_length_m += libm::hypot(along_m, up_m);
        self.ascent_m += up_m.max(0.0);
        self.descent_m += (-up_m).max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peak() -> Lattice {
        let heights = (0..25).map(|index| if index == 12 { 8.0 } else { 0.0 }).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 5, heights).expect("sound")
    }

    #[test]
    fn a_profile_has_its_vertices_and_every_crossing_between() {
        let stations =
            profile(&peak(), &[DVec2::new(0.0, 20.0), DVec2::new(40.0, 20.0), DVec2::new(40.0, 0.0)]);
        let along: Vec<_> = stations.iter().map(|at| (at.station_m, at.ground.height_m())).collect();
        assert_eq!(
            along[..5],
            [0.0, 10.0, 20.0, 30.0, 40.0].map(|m| (m, Some(if m == 20.0 { 8.0 } else { 0.0 })))
        );
        assert_eq!(along.len(), 7);
    }

    #[test]
    fn a_line_from_outside_has_stations_where_it_meets_the_border() {
        let stations = profile(&peak(), &[DVec2::new(-30.0, 20.0), DVec2::new(70.0, 20.0)]);
        let along: Vec<_> = stations.iter().map(|at| (at.station_m, at.ground)).collect();
        assert_eq!(along.first(), Some(&(0.0, Answer::Outside)));
        assert_eq!(along[1..3], [(30.0, Answer::Height(0.0)), (40.0, Answer::Height(0.0))]);
        assert_eq!(along[5..], [(70.0, Answer::Height(0.0)), (100.0, Answer::Outside)]);
        let summary = ProfileSummary::from_stations(&stations);
        assert_eq!((summary.length_m, summary.covered_m), (100.0, 40.0));
        assert_eq!((summary.ascent_m, summary.descent_m), (8.0, 8.0));
    }

    #[test]
    fn over_a_hole_nothing_is_counted() {
        let heights = (0..25).map(|index| if index == 12 { f32::NAN } else { 1.0 }).collect();
        let holed = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 5, heights).expect("sound");
        let stations = profile(&holed, &[DVec2::new(0.0, 20.0), DVec2::new(40.0, 20.0)]);
        assert_eq!(stations[2].ground, Answer::NoData);
        assert_eq!(ProfileSummary::from_stations(&stations).covered_m, 20.0);
    }

    #[test]
    fn other_interpolations_keep_the_crossings_and_add_their_steps() {
        let sampling = Sampling { interpolation: Interpolation::Bilinear, step_m: Some(7.0) };
        let stations = sampled_profile(&peak(), &[DVec2::new(0.0, 15.0), DVec2::new(40.0, 15.0)], sampling);
        let along: Vec<f64> = stations.iter().map(|at| at.station_m).collect();
        assert_eq!(along, [0.0, 5.0, 7.0, 10.0, 14.0, 15.0, 20.0, 21.0, 25.0, 28.0, 30.0, 35.0, 35.0, 40.0]);
        assert!(
            stations.iter().all(|at| at.ground == ground_height(&peak(), Interpolation::Bilinear, at.at))
        );
    }

    #[test]
    fn a_vertex_that_is_not_finite_ends_only_its_own_segments() {
        let stations = profile(&peak(), &[DVec2::new(5.0, 5.0), DVec2::NAN, DVec2::new(15.0, 5.0)]);
        assert_eq!(stations.iter().filter(|at| at.ground == Answer::Outside).count(), 1);
        assert_eq!(stations.len(), 3);
        assert_eq!(profile(&peak(), &[]), []);
    }
}

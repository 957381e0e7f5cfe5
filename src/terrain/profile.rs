//! The ground along a line: every place where it bends, not only steps.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Answer, Interpolation, ground_height};
use crate::terrain::sight::crossings::crossings;

/// A place along a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Metres along the line from its start.
    pub station_m: f64,
    /// Map coordinates.
    pub at: DVec2,
    /// The height of the ground, or why there is none.
    pub ground: Answer,
}

/// The ground along `line` (map coordinates in metres, at least one vertex): its vertices and every crossing with an
/// edge of the finest triangles, in order. Between two stations in a row the planar ground is straight.
///
/// Costs three stations a cell.
pub fn profile(lattice: &Lattice, line: &[DVec2]) -> Vec<Station> {
    let mut stations = Vec::new();
    let mut walked_m = 0.0;
    for pair in line.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let length = from.distance(to);
        stations.push(station(lattice, walked_m, from));
        let grid = |at: DVec2| lattice.grid_at(at - lattice.origin());
        if lattice.cell_at(from - lattice.origin()).is_some()
            && lattice.cell_at(to - lattice.origin()).is_some()
        {
            let _ = crossings(lattice, grid(from), grid(to), |crossing| {
                let ground = if crossing.height_m.is_nan() {
                    Answer::NoData
                } else {
                    Answer::Height(crossing.height_m)
                };
                let at = from.lerp(to, crossing.part);
                stations.push(Station { station_m: walked_m + length * crossing.part, at, ground });
                ControlFlow::<()>::Continue(())
            });
        }
        walked_m += length;
    }
    stations.extend(line.last().map(|&last| station(lattice, walked_m, last)));
    stations
}

fn station(lattice: &Lattice, station_m: f64, at: DVec2) -> Station {
    Station { station_m, at, ground: ground_height(lattice, Interpolation::Planar, at) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_holds_its_vertices_and_every_break_between() {
        let heights = (0..25).map(|index| if index == 12 { 8.0 } else { 0.0 }).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 5, heights).expect("sound");
        let stations =
            profile(&lattice, &[DVec2::new(0.0, 20.0), DVec2::new(40.0, 20.0), DVec2::new(40.0, 0.0)]);
        let along: Vec<_> = stations.iter().map(|at| (at.station_m, at.ground.height_m())).collect();
        assert_eq!(
            along[..5],
            [0.0, 10.0, 20.0, 30.0, 40.0].map(|m| (m, Some(if m == 20.0 { 8.0 } else { 0.0 })))
        );
        assert_eq!(along.len(), 7);
    }
}

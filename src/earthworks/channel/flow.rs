//! The direction in which water flows along each line of a network.
//!
//! A line flows from its higher end to its lower, where the straight line nearest to the ground along it falls the same way.
//! Where they disagree the ground does not say: one end lies in a pit, on a bridge or in a lake, or the line is drawn over
//! hills beside its valley. And ends of a level stretch differ by the error of the elevation model alone. So lines that
//! share vertices are heard together: where most of their fall agrees with the way they were drawn, or runs against it, all
//! of them follow, but for those that fall the other way by more than such an error. Files of rivers are drawn downstream
//! as a rule, so most networks agree, and a line without evidence against it flows as drawn.

use std::collections::BTreeMap;

use glam::DVec2;

use sandtable_base::disjoint_sets::root;
use sandtable_geom::polyline::{Polyline, VertexKey, vertex_key};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};

/// The relative error of heights in meters (SRTM: Farr et al. 2007). A smaller fall is no evidence against neighbors.
const RELATIVE_ERROR_M: f64 = 10.0;

/// The share of a network's fall that must agree for all its lines to follow: three quarters on one side.
const AGREEMENT: f64 = 0.5;

/// The most steps in which a line is walked to find its fall: a step a cell, and wider on lines that would need more.
const MOST_STEPS: f64 = 100_000.0;

/// The direction in which water flows along a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// From its first vertex to its last.
    AsDrawn,
    /// From its last to its first.
    Against,
}

/// The way water flows along each of `lines`, in world coordinates; as drawn where the ground does not say.
pub fn directions(lattice: &Lattice, lines: &[&Polyline]) -> Vec<Flow> {
    let drops: Vec<f64> = lines.iter().map(|line| drop_m(lattice, line)).collect();
    let networks = networks(lines);
    let mut votes: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for (&network, &drop) in networks.iter().zip(&drops) {
        let (net, gross) = votes.entry(network).or_default();
        *net += drop;
        *gross += drop.abs();
    }
    let direction = |(network, &drop): (&usize, &f64)| {
        let (net, gross) = votes[network];
        let agrees = net.abs() >= AGREEMENT * gross;
        let decisive = if agrees && drop.abs() < RELATIVE_ERROR_M { net } else { drop };
        if decisive < 0.0 { Flow::Against } else { Flow::AsDrawn }
    };
    networks.iter().zip(&drops).map(direction).collect()
}

/// The fall of the ground along `line`: between its ends or by least squares, whichever is less; 0 where these
/// disagree.
fn drop_m(lattice: &Lattice, line: &Polyline) -> f64 {
    let steps = (line.length() / lattice.cell().min_element()).ceil().clamp(1.0, MOST_STEPS);
    let grounded = |step: u32| {
        let station_m = line.length() * f64::from(step) / steps;
        let map = line.at(station_m) + lattice.origin();
        let height_m = ground_height(lattice, Interpolation::Planar, map).height_m();
        height_m.map(|height_m| DVec2::new(station_m, height_m))
    };
    let ground: Vec<DVec2> = (0..=steps as u32).filter_map(grounded).collect();
    let [Some(first), Some(last)] = [ground.first(), ground.last()] else { return 0.0 };
    let middle = ground.iter().sum::<DVec2>() / ground.len() as f64;
    let (mut along, mut both) = (0.0, 0.0);
    for at in &ground {
        let off = *at - middle;
        (along, both) = (along + off.x * off.x, both + off.x * off.y);
    }
    let (ends_m, trend_m) = (first.y - last.y, -both / along.max(f64::MIN_POSITIVE) * (last.x - first.x));
    match (ends_m > 0.0, trend_m > 0.0) {
        (true, true) => ends_m.min(trend_m),
        (false, false) => ends_m.max(trend_m),
        _ => 0.0,
    }
}

/// A number for each line, the same for lines that hang together by shared vertices.
fn networks(lines: &[&Polyline]) -> Vec<usize> {
    let mut parents: Vec<usize> = (0..lines.len()).collect();
    let mut first_at: BTreeMap<VertexKey, usize> = BTreeMap::new();
    for (index, line) in lines.iter().enumerate() {
        for &at in line.points() {
            let other = *first_at.entry(vertex_key(at)).or_insert(index);
            let (a, b) = (root(&mut parents, index), root(&mut parents, other));
            parents[a.max(b)] = a.min(b);
        }
    }
    (0..lines.len()).map(|index| root(&mut parents, index)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ground that falls a tenth eastward, but for a level stretch with a bump from 400 m on.
    fn ground() -> Lattice {
        let height = |index: u32| {
            let x = f64::from(index % 81) * 10.0;
            if x < 400.0 { 100.0 - x / 10.0 } else { 60.0 + if x > 700.0 { 0.4 } else { 0.0 } }
        };
        let heights = (0..81 * 11).map(|index| height(index) as f32).collect();
        Lattice::new(DVec2::new(3e5, 4e6), DVec2::splat(10.0), 81, heights).expect("sound")
    }

    fn line(xs: &[f64]) -> Polyline {
        Polyline::new(xs.iter().map(|&x| DVec2::new(x, 45.0)), 0.0).expect("a line")
    }

    #[test]
    fn a_lone_line_flows_to_its_lower_end() {
        let (down, up) = (line(&[0.0, 300.0]), line(&[300.0, 0.0]));
        assert_eq!(directions(&ground(), &[&down]), [Flow::AsDrawn]);
        assert_eq!(directions(&ground(), &[&up]), [Flow::Against]);
    }

    #[test]
    fn a_level_stretch_follows_the_lines_it_hangs_together_with() {
        let (above, level) = (line(&[0.0, 450.0]), line(&[450.0, 780.0]));
        assert_eq!(directions(&ground(), &[&level]), [Flow::Against], "alone it flows as its bump has it");
        assert_eq!(directions(&ground(), &[&above, &level]), [Flow::AsDrawn; 2]);
        let (above, level) = (line(&[450.0, 0.0]), line(&[780.0, 450.0]));
        assert_eq!(directions(&ground(), &[&level, &above]), [Flow::Against; 2]);
    }

    #[test]
    fn a_pit_at_its_source_does_not_turn_a_river_round() {
        let mut heights = ground().heights().to_vec();
        (0..11).for_each(|row| heights[row * 81] = -50.0);
        let ground = Lattice::new(DVec2::new(3e5, 4e6), DVec2::splat(10.0), 81, heights).expect("sound");
        assert_eq!(directions(&ground, &[&line(&[0.0, 400.0])]), [Flow::AsDrawn]);
    }

    #[test]
    fn off_the_model_a_line_flows_as_drawn() {
        assert_eq!(directions(&ground(), &[&line(&[-900.0, -500.0])]), [Flow::AsDrawn]);
    }
}

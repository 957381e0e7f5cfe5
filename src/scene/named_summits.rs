//! The summits of the elevation model that features name, with their prominence.

use glam::Vec2;

use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::prominence::ProminentSummit;

/// How far from a name its summit is looked for: meters, and cells of coarser ground.
const SUMMIT_M: f64 = 150.0;
const SUMMIT_CELLS: f64 = 2.0;

/// How far from a name on `lattice` its summit is looked for, in meters.
pub fn summit_reach_m(lattice: &Lattice) -> f64 {
    SUMMIT_M.max(lattice.cell().max_element() * SUMMIT_CELLS)
}

/// The summits of a lattice, the most prominent first.
pub(super) struct NamedSummits<'a> {
    summits: &'a [ProminentSummit],
    reach_m: f32,
}

impl<'a> NamedSummits<'a> {
    /// Those of `lattice`, all of whose summits are handed in.
    pub fn new(lattice: &Lattice, summits: &'a [ProminentSummit]) -> Self {
        Self { summits, reach_m: summit_reach_m(lattice) as f32 }
    }

    /// The prominence of the summit that a name at a place in world space belongs to: of those in reach the most prominent.
    /// 0 where there is none.
    pub fn prominence_m(&self, at: Vec2) -> f64 {
        let own = self.summits.iter().find(|summit| summit.at.distance(at) <= self.reach_m);
        own.map_or(0.0, |summit| f64::from(summit.prominence_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use sandtable_terrain::prominence::summits;

    #[test]
    fn a_name_has_the_prominence_of_the_summit_near_it_and_0_on_a_slope() {
        let cone = |x: f32, y: f32, at: [f32; 2], height_m: f32| {
            height_m - 0.1 * Vec2::new(x, y).distance(Vec2::from(at))
        };
        let height = |index: usize| {
            let [x, y] = [index % 65, index / 65].map(|post| post as f32 * 50.0);
            cone(x, y, [1000.0, 1600.0], 300.0).max(cone(x, y, [2200.0, 1600.0], 220.0))
        };
        let heights = (0..65 * 65).map(height).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(50.0), 65, heights).expect("a lattice");
        let summits = summits(&lattice);
        let summits = NamedSummits::new(&lattice, &summits);
        let prominence_m = |x: f32, y: f32| summits.prominence_m(Vec2::new(x, y));
        // The saddle is where the cones meet: 1200 m apart and 80 m of height, 0.1 a meter.
        assert!((prominence_m(2150.0, 1650.0) - 20.0).abs() < 5.0, "{}", prominence_m(2150.0, 1650.0));
        assert!(prominence_m(1000.0, 1600.0) > 150.0);
        assert_eq!(prominence_m(1000.0, 800.0), 0.0);
    }
}

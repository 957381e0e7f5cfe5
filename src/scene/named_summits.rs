//! The summits of the elevation model that features name, with their prominence.

use glam::Vec2;

use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::prominence::{ProminentSummit, summits};

/// How far from a name its summit is looked for: meters, and cells of coarser ground.
const SUMMIT_M: f64 = 150.0;
const SUMMIT_CELLS: f64 = 2.0;

/// How far from a name on `lattice` its summit is looked for, in meters.
pub fn summit_reach_m(lattice: &Lattice) -> f64 {
    SUMMIT_M.max(lattice.cell().max_element() * SUMMIT_CELLS)
}

/// The summits of a lattice, the most prominent first.
pub(super) struct NamedSummits {
    summits: Vec<ProminentSummit>,
    reach_m: f32,
}

impl NamedSummits {
    pub fn new(lattice: &Lattice) -> Self {
        Self { summits: summits(lattice), reach_m: summit_reach_m(lattice) as f32 }
    }

    /// The prominence of the summit that a name at a place in world space belongs to: of those in reach the most prominent.
    /// 0 where there is none.
    pub fn prominence_m(&self, at: Vec2) -> Option<f64> {
        let own = self.summits.iter().find(|summit| summit.at.distance(at) <= self.reach_m);
        Some(own.map_or(0.0, |summit| f64::from(summit.prominence_m)))
    }
}

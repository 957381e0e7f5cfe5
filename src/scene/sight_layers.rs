//! Sight as a layer of the scene: viewsheds, lines of sight, and ranges. What they show is found by the same functions as
//! the commands' answers; see [`crate::seen_ground`].

use std::borrow::Cow;

use glam::DVec2;

use crate::seen_ground::{SceneSight, SceneViewshed};
use sandtable_description::words::{GraphicSide, RangeExtent};
use sandtable_draw::list::FeatureId;
use sandtable_geom::azimuth::heading;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::sight::line::{Sight, SightEnd, line_of_sight};
use sandtable_terrain::sight::viewshed::Sector;

/// The layers of sight of a scene.
#[derive(Default)]
pub struct SightLayers {
    /// What observers see.
    pub viewsheds: Vec<SceneViewshed>,
    /// Lines of sight.
    pub sights: Vec<SceneSight>,
    /// Rings and fans.
    pub ranges: Vec<SceneRange>,
}

/// Rings and fans about a place.
pub struct SceneRange {
    /// Its name on the picture; may be empty.
    pub name: String,
    /// World X and Y.
    pub at: DVec2,
    /// Rising distances in meters.
    pub distances_m: Vec<f64>,
    /// The sector.
    pub sector: Sector,
    /// The side that it belongs to.
    pub side: GraphicSide,
    /// Whether the ground within it is filled.
    pub fill: RangeExtent,
    /// What is in sight within it; for `fill = "seen"`.
    pub sight: SceneViewshed,
    /// The feature it is.
    pub feature: FeatureId,
    /// Whether the ground of each piece of each ring is in sight, where that was found beforehand.
    pub(super) found: Option<Vec<Vec<bool>>>,
}

/// Pieces of a whole ring whose sight is tried one by one.
const RING_PIECES: f64 = 180.0;

impl SceneRange {
    /// The azimuths of places round the sector, its borders among them.
    pub fn azimuths_deg(&self) -> Vec<f64> {
        let steps = (RING_PIECES * self.sector.width_deg / 360.0).ceil().max(1.0);
        let step_deg = self.sector.width_deg / steps;
        (0..=steps as u32).map(|step| self.sector.from_deg + f64::from(step) * step_deg).collect()
    }

    /// The places round the sector at a distance, world X and Y.
    pub fn ring(&self, radius_m: f64) -> Vec<DVec2> {
        self.azimuths_deg().into_iter().map(|azimuth| self.at + heading(azimuth) * radius_m).collect()
    }

    /// Whether the ground of each piece of each ring is in sight, on `lattice` unless it was found before; of a range that is not
    /// of what is seen, all is.
    pub fn pieces_seen(&self, lattice: &Lattice) -> Cow<'_, [Vec<bool>]> {
        match &self.found {
            Some(found) => Cow::Borrowed(found),
            None => Cow::Owned(self.seen_on(lattice, lattice.origin())),
        }
    }

    /// [`SceneRange::pieces_seen`] on ground in the frame of the map; `origin` is that of world space.
    pub(super) fn seen_on(&self, lattice: &Lattice, origin: DVec2) -> Vec<Vec<bool>> {
        let is_seen = |at: DVec2| {
            let Some(options) = self.sight.observers.first() else { return false };
            let target = SightEnd { at: at + origin, above_m: options.target_above_m };
            self.fill != RangeExtent::Seen
                || line_of_sight(lattice, options.observer, target, options.curvature) == Sight::Clear
        };
        let pieces = |radius_m: &f64| {
            self.ring(*radius_m).windows(2).map(|pair| is_seen(pair[0].midpoint(pair[1]))).collect()
        };
        self.distances_m.iter().map(pieces).collect()
    }
}

impl SightLayers {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.viewsheds.is_empty() && self.sights.is_empty() && self.ranges.is_empty()
    }
}

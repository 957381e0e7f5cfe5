//! Trenches: the banks of earth beside them, thrown up from what was dug out.

use glam::DVec2;

use crate::draw::color::Srgba;
use crate::structure::fence_band::{BandSection, FenceBand, Ruffle, SectionCorner};
use crate::structure::fence_track::Track;

const EARTH: Srgba = Srgba::opaque(150, 122, 88);
const CREST: Srgba = Srgba::opaque(168, 140, 104);

/// A parapet's width as a share of the trench's.
const PARAPET_WIDTH: f64 = 0.8;
/// Its height as a share of the trench's depth: what a trench of that depth yields, loosened by a quarter, piled on both
/// sides.
const PARAPET_HEIGHT: f64 = 0.35;
/// How far its surface wanders, and its color in steps of 255.
const RUFFLE: (f64, f32) = (0.12, 8.0);

/// From the outer foot of one parapet to that of the other, meters: all the ground that is bare earth.
pub fn bare_m(width_m: f64) -> f64 {
    width_m * (1.0 + 2.0 * PARAPET_WIDTH)
}

/// The parapets on either side of a trench of `width_m` along `points`, dug `depth_m` deep; their surface
/// wanders every `every_m`.
pub fn parapets(points: &[DVec2], (width_m, depth_m): (f64, f64), every_m: f64) -> [FenceBand; 2] {
    let half_m = width_m * (0.5 + PARAPET_WIDTH);
    let inner = 0.5 / (0.5 + PARAPET_WIDTH);
    [(-1.0, -inner), (inner, 1.0)].map(|feet| FenceBand {
        track: Track::new(points, half_m),
        section: bank(feet, depth_m * PARAPET_HEIGHT),
        ruffle: Some(Ruffle { share: RUFFLE.0, shade: RUFFLE.1, every_m }),
    })
}

fn bank(feet: (f64, f64), height_m: f64) -> BandSection {
    let corner = |share: f64, up_m: f64| SectionCorner { share, up_m };
    BandSection {
        feet,
        corners: vec![corner(0.0, 0.0), corner(0.35, height_m), corner(0.65, height_m), corner(1.0, 0.0)],
        colors: vec![EARTH, CREST, EARTH],
    }
}

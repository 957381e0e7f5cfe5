//! Hedges: a band that narrows to its top and is nowhere quite even.

use glam::DVec2;

use crate::draw::color::Srgba;
use crate::structure::fence_band::{BandSection, FenceBand, Ruffle, SectionCorner};
use crate::structure::fence_track::Track;

const LEAVES: Srgba = Srgba::opaque(84, 112, 62);
const SUNLIT: Srgba = Srgba::opaque(106, 134, 74);

/// How far its surface wanders, as a share of its size: more and it looks torn, less and it looks like a wall.
const RUFFLE: f64 = 0.16;
/// How much its green varies, in steps of 255.
const SHADE: f32 = 14.0;

/// A hedge along `points`; its surface wanders every `every_m`.
pub fn hedge(points: &[DVec2], (width_m, height_m): (f64, f64), every_m: f64) -> FenceBand {
    let corner = |share: f64, up: f64| SectionCorner { share, up_m: up * height_m };
    FenceBand {
        track: Track::new(points, width_m / 2.0),
        section: BandSection {
            feet: (-1.0, 1.0),
            corners: vec![
                corner(0.0, 0.0),
                corner(0.02, 0.6),
                corner(0.22, 0.96),
                corner(0.78, 0.96),
                corner(0.98, 0.6),
                corner(1.0, 0.0),
            ],
            colors: vec![LEAVES, LEAVES, SUNLIT, LEAVES, LEAVES],
        },
        ruffle: Some(Ruffle { share: RUFFLE, shade: SHADE, every_m }),
    }
}

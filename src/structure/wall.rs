//! Walls: a masonry band with a coping.

use glam::DVec2;

use crate::draw::color::Srgba;
use crate::structure::fence_band::{BandSection, FenceBand, Ruffle, SectionCorner};
use crate::structure::fence_track::Track;

const STONE: Srgba = Srgba::opaque(172, 162, 148);
const COPING: Srgba = Srgba::opaque(196, 188, 174);

/// Stones vary in color by as many steps of 255.
const STONE_SHADE: f32 = 9.0;

/// A wall along `points`; its color changes every `every_m`.
pub fn wall(points: &[DVec2], (width_m, height_m): (f64, f64), every_m: f64) -> FenceBand {
    let corner = |share: f64, up_m: f64| SectionCorner { share, up_m };
    FenceBand {
        track: Track::new(points, width_m / 2.0),
        section: BandSection {
            feet: (-1.0, 1.0),
            corners: vec![corner(0.0, 0.0), corner(0.0, height_m), corner(1.0, height_m), corner(1.0, 0.0)],
            colors: vec![STONE, COPING, STONE],
        },
        ruffle: Some(Ruffle { share: 0.0, shade: STONE_SHADE, every_m }),
    }
}

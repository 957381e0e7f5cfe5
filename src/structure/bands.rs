//! The bands that scenes have: walls, hedges, the banks of earth beside trenches, the rails of fences.

use crate::fence_band::{BandSection, FenceBand, Ruffle, SectionCorner};
use sandtable_draw::color::Srgba;
use sandtable_earthworks::alignment::Alignment;

const STONE: Srgba = Srgba::opaque(172, 162, 148);
const COPING: Srgba = Srgba::opaque(196, 188, 174);
const LEAVES: Srgba = Srgba::opaque(84, 112, 62);
const SUNLIT: Srgba = Srgba::opaque(106, 134, 74);
const EARTH: Srgba = Srgba::opaque(150, 122, 88);
const CREST: Srgba = Srgba::opaque(168, 140, 104);
const RAIL: Srgba = Srgba::opaque(176, 150, 114);

/// How far a hedge's surface wanders, as a share of its size: more and it looks torn, less and it looks like a wall.
const HEDGE_RUFFLE: f64 = 0.16;

/// A parapet's width as a share of the trench's.
const PARAPET_WIDTH: f64 = 0.8;
/// Its height as a share of the trench's depth: what a trench of that depth yields, loosened by a quarter, piled on both
/// sides.
const PARAPET_HEIGHT: f64 = 0.35;

/// Rails from the ground up as shares of the fence's height: where each begins and ends.
const RAILS: [[f64; 2]; 2] = [[0.36, 0.48], [0.76, 0.88]];
/// A rail's thickness as a share of the post's.
const RAIL_THICKNESS: f64 = 0.45;

/// The size of a band in meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandSize {
    /// Above the ground; of a trench its depth.
    pub height_m: f64,
    /// From one change of color or surface to the next.
    pub every_m: f64,
}

/// A section across the whole track; corners are pairs of a share of the width and meters up.
fn section(corners: &[[f64; 2]], colors: &[Srgba]) -> BandSection {
    let corner = |&[share, up_m]: &[f64; 2]| SectionCorner { share, up_m };
    BandSection { feet: (-1.0, 1.0), corners: corners.iter().map(corner).collect(), colors: colors.to_vec() }
}

/// A wall of masonry with a coping along an alignment; stones vary in color.
pub fn wall(alignment: &Alignment, size: BandSize) -> FenceBand {
    let up = size.height_m;
    FenceBand {
        alignment: alignment.clone(),
        section: section(&[[0.0, 0.0], [0.0, up], [1.0, up], [1.0, 0.0]], &[STONE, COPING, STONE]),
        ruffle: Some(Ruffle { share: 0.0, shade: 9.0, every_m: size.every_m }),
    }
}

/// A hedge along an alignment that narrows to its top and is nowhere quite even.
pub fn hedge(alignment: &Alignment, size: BandSize) -> FenceBand {
    let outline = [[0.0, 0.0], [0.02, 0.6], [0.22, 0.96], [0.78, 0.96], [0.98, 0.6], [1.0, 0.0]];
    let corners = outline.map(|[share, up]| [share, up * size.height_m]);
    FenceBand {
        alignment: alignment.clone(),
        section: section(&corners, &[LEAVES, LEAVES, SUNLIT, LEAVES, LEAVES]),
        ruffle: Some(Ruffle { share: HEDGE_RUFFLE, shade: 14.0, every_m: size.every_m }),
    }
}

/// The width in meters of all bare earth of a trench: from the outer foot of one parapet to that of the other.
pub fn bare_m(width_m: f64) -> f64 {
    width_m * (1.0 + 2.0 * PARAPET_WIDTH)
}

/// The banks of excavated earth on either side of a trench as wide as an alignment.
pub fn parapets(alignment: &Alignment, size: BandSize) -> [FenceBand; 2] {
    let width_m = 2.0 * (alignment.width.widest_m() * (0.5 + PARAPET_WIDTH));
    let track = Alignment::on_ground(alignment.line.clone(), width_m);
    let inner = 0.5 / (0.5 + PARAPET_WIDTH);
    let up = size.height_m * PARAPET_HEIGHT;
    let bank = section(&[[0.0, 0.0], [0.35, up], [0.65, up], [1.0, 0.0]], &[EARTH, CREST, EARTH]);
    [(-1.0, -inner), (inner, 1.0)].map(|feet| FenceBand {
        alignment: track.clone(),
        section: BandSection { feet, ..bank.clone() },
        ruffle: Some(Ruffle { share: 0.12, shade: 8.0, every_m: size.every_m }),
    })
}

/// The rails of a fence along an alignment as wide as its posts.
pub fn rails(alignment: &Alignment, height_m: f64) -> [FenceBand; 2] {
    let width_m = alignment.width.widest_m() * RAIL_THICKNESS;
    RAILS.map(|rail| {
        let [low, high] = rail.map(|share| share * height_m);
        FenceBand {
            alignment: Alignment::on_ground(alignment.line.clone(), width_m),
            section: section(&[[0.0, low], [0.0, high], [1.0, high], [1.0, low]], &[RAIL; 4]),
            ruffle: None,
        }
    })
}

//! The supports of a deck: piers, abutments, and the posts that end its parapets.
//!
//! ```text
//!      ═══════════════════        deck
//!        ╲_____________╱          head: as wide as the soffit
//!             │   │
//!             │   │               shaft: a chamfered rectangle that widens downward
//!  ▓▓▓▓▓▓▓▓▓▓╱▓▓▓▓▓╲▓▓▓▓▓▓▓▓
//!            ╵     ╵              founded below the ground
//! ```

use glam::{DVec2, Vec3};

use crate::bridge::{BridgeOptions, FOUNDED_M, GIRDER, GroundHeight, PARAPET_THICK_M, magnified};
use crate::deck::DeckSection;
use crate::faces::Faces;
use sandtable_draw::color::Srgba;

const CONCRETE: Srgba = Srgba::opaque(236, 231, 219);
const WEATHERED: Srgba = Srgba::opaque(214, 207, 193);

/// How much a shaft widens downward on each side, meters a meter.
const BATTER: f64 = 0.02;

/// The lowest pier that is worth building, in meters from the ground to the soffit.
const LOWEST_M: f64 = 0.5;

/// How far what carries the deck reaches into it, in meters, so that no slit shows.
const INTO_DECK_M: f64 = 0.1;

/// How wide a shaft is, as a part of the soffit.
const SHAFT: f64 = 0.5;

/// Adds a pier under a section; `false` where it would be lower than is worth building, or where there is no ground.
pub(crate) fn pier(
    section: &DeckSection,
    width_m: f64,
    options: &BridgeOptions,
    ground: &GroundHeight<'_>,
    faces: &mut Faces,
) -> bool {
    let across = (section.aside[0] - section.aside[1]).normalize_or(DVec2::X);
    let frame = PierFrame { at: section.at, across };
    let head = GIRDER * width_m / 2.0;
    let Some(ground_m) = lowest(ground, [0.0, head, -head].map(|aside| frame.at + across * aside)) else {
        return false;
    };
    let soffit = section.middle_m() - options.depth_m;
    let height = soffit - ground_m;
    if height < LOWEST_M {
        return false;
    }
    let (top, foot) = (soffit + INTO_DECK_M, ground_m - FOUNDED_M);
    let by = magnified(width_m);
    let along = (0.5 + 0.012 * height).clamp(0.5, 1.6) * by;
    let shaft = head * SHAFT;
    let flare = (head - shaft) * 0.7;
    let has_head = height > 2.0 * flare;
    let neck = if has_head { top - INTO_DECK_M - flare } else { top };
    let widened = BATTER * (neck - foot);
    let mut rings = vec![
        frame.ring((shaft + widened, along + widened), foot),
        frame.ring((if has_head { shaft } else { head * 0.8 }, along), neck),
    ];
    if has_head {
        let lip = flare * 0.25;
        rings.extend([frame.ring((head, along), top - lip), frame.ring((head, along), top)]);
    }
    faces.stack(&rings, CONCRETE);
    true
}

/// Adds the abutment under the sections: a block from within the deck to below the ground, whose sides are its wing walls.
pub(crate) fn abutment(
    under: &[DeckSection],
    width_m: f64,
    options: &BridgeOptions,
    ground: &GroundHeight<'_>,
    faces: &mut Faces,
) {
    let edges = under.iter().flat_map(|section| section.aside.map(|aside| section.at + aside));
    let Some(lowest_m) = lowest(ground, edges.chain(under.iter().map(|section| section.at))) else { return };
    // Inside the edge beams' faces, so that they stand out.
    let part = 1.0 + 0.6 * PARAPET_THICK_M * magnified(width_m) / (width_m / 2.0);
    let into = -0.3 * options.depth_m;
    let tops: Vec<[Vec3; 2]> =
        under.iter().map(|section| [0, 1].map(|side| section.point(side, part, into))).collect();
    let below = tops.iter().flatten().map(|corner| f64::from(corner.z)).fold(f64::INFINITY, f64::min) - 0.1;
    let foot = (lowest_m - FOUNDED_M).min(below) as f32;
    let rings: Vec<[Vec3; 4]> = tops
        .iter()
        .map(|&[left, right]| [left, right, right.truncate().extend(foot), left.truncate().extend(foot)])
        .collect();
    faces.stack(&rings, WEATHERED);
}

/// Adds the posts in which both parapets end.
pub(crate) fn end_posts(section: &DeckSection, width_m: f64, options: &BridgeOptions, faces: &mut Faces) {
    let by = magnified(width_m);
    let half = 0.5 * by;
    for side in 0..2 {
        let part = 1.0 + half / (width_m / 2.0);
        let across = section.aside[side].normalize_or(DVec2::X);
        let frame = PierFrame { at: section.at + section.aside[side] * part, across };
        let road = f64::from(section.point(side, part, 0.0).z);
        let rings =
            [-0.5 * options.depth_m - by, 1.6 * by].map(|above| frame.ring((half, half), road + above));
        faces.stack(&rings, WEATHERED);
    }
}

/// Where something upright stands, and which way it lies.
struct PierFrame {
    at: DVec2,
    across: DVec2,
}

impl PierFrame {
    /// A chamfered rectangle at height `z`, counter-clockwise from above: half its size across and along.
    fn ring(&self, (across, along): (f64, f64), z: f64) -> [Vec3; 8] {
        let chamfer = 0.3 * across.min(along);
        let (x, y) = (across - chamfer, along - chamfer);
        [
            (across, -y),
            (across, y),
            (x, along),
            (-x, along),
            (-across, y),
            (-across, -y),
            (-x, -along),
            (x, -along),
        ]
        .map(|(aside, ahead)| {
            let at = self.at + self.across * aside + self.across.perp() * ahead;
            at.as_vec2().extend(z as f32)
        })
    }
}

/// The lowest ground at the places; `None` where there is none at any.
pub(crate) fn lowest(ground: &GroundHeight<'_>, places: impl IntoIterator<Item = DVec2>) -> Option<f64> {
    places.into_iter().filter_map(ground).reduce(f64::min)
}

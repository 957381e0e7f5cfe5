//! Roads.

use crate::texture::shade::shade;
use sandtable_draw::color::Srgba;

/// A carriageway.
pub(super) const ASPHALT: [u8; 3] = [126, 116, 110];

/// A gravel road between its verges.
pub(super) const GRAVEL: [u8; 3] = [214, 194, 154];

/// Where wheels go.
pub(super) const WORN: [u8; 3] = [176, 148, 108];

/// Beside a carriageway.
pub(super) const SHOULDER: [u8; 3] = [186, 172, 142];

/// What is painted on a carriageway.
#[derive(Clone, Copy)]
pub(super) enum RoadMarkings {
    /// Nothing.
    None,
    /// Edge lines, and what there is in the middle.
    Edges { center: Option<Center> },
}

/// A center line.
#[derive(Clone, Copy)]
pub(super) enum Center {
    /// Unbroken.
    Solid,
    /// Broken, at this part of a dash and its gap.
    Dashed(f32),
}

pub(super) fn asphalt(u: f32, lines: RoadMarkings, grain: f32) -> Srgba {
    let from_edge = u.min(1.0 - u);
    let in_middle = (u - 0.5).abs() < 0.028;
    let painted = match lines {
        RoadMarkings::None => false,
        RoadMarkings::Edges { center } => {
            from_edge < 0.115
                || in_middle
                    && match center {
                        Some(Center::Solid) => true,
                        Some(Center::Dashed(v)) => v < 0.55,
                        None => false,
                    }
        }
    };
    if from_edge < 0.055 {
        shade([58, 54, 50], 0.0)
    } else if painted {
        shade([243, 238, 222], 0.0)
    } else {
        shade(ASPHALT, (grain - 0.5) * 14.0)
    }
}

pub(super) fn gravel(u: f32, grain: f32) -> Srgba {
    let from_edge = u.min(1.0 - u);
    if from_edge < 0.09 { shade([112, 92, 66], 0.0) } else { shade(GRAVEL, (grain - 0.5) * 34.0) }
}

pub(super) fn track(u: f32, grain: f32) -> Srgba {
    let wheel = ((u - 0.5).abs() - 0.27).abs() < 0.15;
    if wheel { shade(WORN, (grain - 0.5) * 30.0) } else { shade([122, 124, 82], (grain - 0.5) * 30.0) }
}

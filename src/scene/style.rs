//! How the ground looks: ramp and contours.

use crate::description::color::{Color, RampChoice};
use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::words::RampName;
use crate::draw::color::Srgba;
use crate::draw::ground::{ColorRamp, Contours};

/// The tints of an atlas, from the lowest ground to the highest. Their lightness rises steadily (L* 61 to 94), so that
/// tint never works against shade.
const ATLAS: [(f32, [u8; 3]); 7] = [
    (0.0, [122, 156, 116]),
    (0.18, [154, 180, 128]),
    (0.38, [192, 200, 146]),
    (0.56, [216, 208, 162]),
    (0.74, [226, 212, 180]),
    (0.90, [234, 225, 206]),
    (1.0, [243, 239, 231]),
];

/// The tints of a desert: sand, ochre, red rock, pale heights.
const DESERT: [(f32, [u8; 3]); 5] = [
    (0.0, [196, 178, 138]),
    (0.3, [222, 196, 146]),
    (0.6, [206, 150, 104]),
    (0.85, [170, 110, 84]),
    (1.0, [232, 214, 196]),
];

/// Neutral tints for overlays.
const GRAY: [(f32, [u8; 3]); 2] = [(0.0, [168, 168, 168]), (1.0, [236, 236, 236])];

/// The document's ramp over the ground's range of heights.
///
/// # Errors
/// Stops that do not rise.
pub fn ramp(document: &Document, range: (f32, f32)) -> Result<ColorRamp, Diagnostic> {
    let choice = &document.style.ramp;
    match &**choice {
        RampChoice::Named(RampName::Atlas) => Ok(stretched(&ATLAS, range)),
        RampChoice::Named(RampName::Desert) => Ok(stretched(&DESERT, range)),
        RampChoice::Named(RampName::Gray) => Ok(stretched(&GRAY, range)),
        RampChoice::Stops(stops) => {
            let stops =
                stops.iter().map(|&(height, Color(channels))| (height as f32, Srgba(channels))).collect();
            ColorRamp::new(stops).ok_or_else(|| document.error(choice, "the ramp's heights do not rise"))
        }
    }
}

/// The ramp of an atlas over a range of heights: the default.
pub fn atlas(range: (f32, f32)) -> ColorRamp {
    stretched(&ATLAS, range)
}

fn stretched(stops: &[(f32, [u8; 3])], (low, high): (f32, f32)) -> ColorRamp {
    // Level ground far from 0 still needs stops that an f32 can tell apart.
    let span = (high - low).max(1.0).max(low.abs() * 1e-4);
    let stops = stops.iter().map(|&(part, [r, g, b])| (low + span * part, Srgba::opaque(r, g, b))).collect();
    ColorRamp::new(stops).expect("the parts rise, and the span is wide enough for an f32 to tell them apart")
}

/// The document's contour lines.
pub fn contours(document: &Document) -> Option<Contours> {
    document.style.contours.as_ref().map(|contours| Contours {
        interval_m: contours.interval as f32,
        major_every: contours.major_every,
        color: contours.color.map_or(Srgba([112, 74, 40, 150]), |color| Srgba(color.0)),
        width_px: 1.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_named_ramp_fits_any_ground_that_a_lattice_takes() {
        for height in [0.0, -0.3, 8848.0, 9.99e6, -1e7] {
            for stops in [ATLAS.as_slice(), DESERT.as_slice(), GRAY.as_slice()] {
                stretched(stops, (height, height));
            }
        }
    }
}

//! Drawings that several entities share, by name, and those whose shape the frame decides: an icon that fills its frame
//! touches the frame's edge, wherever that is.

mod activity;
mod industry;
mod land;
mod public_places;
mod sea;

use crate::frame::FrameShape;

/// The drawing of a piece in a frame of a shape; `None` for a name that is none.
pub(super) fn piece(name: &str, shape: FrameShape) -> Option<&'static str> {
    let shared = SHARED.iter().flat_map(|table| *table).find(|row| row.0 == name);
    let framed = || FRAMED.iter().flat_map(|table| *table).find(|row| row.0 == name);
    shared.map(|row| row.1).or_else(|| framed().map(|row| row.1[column(shape)]))
}

/// The tables of pieces that are the same in every frame, and of those that the frame decides.
const SHARED: &[&[SharedPiece]] =
    &[&COMMON, land::SHARED, industry::SHARED, public_places::SHARED, activity::SHARED, sea::SHARED];
const FRAMED: &[&[FramedPiece]] = &[&FRAME_FILLING, land::FRAMED, activity::FRAMED];

/// Name and drawing.
type SharedPiece = (&'static str, &'static str);
/// Name and drawings: in a rectangle (circle, hexagon, arch), a diamond, a square and a quatrefoil.
type FramedPiece = (&'static str, [&'static str; 4]);

/// The same in every frame.
const COMMON: [SharedPiece; 11] = [
    ("track", "M75,80 L125,80 A125,100 20,20 -90 90 L75,120 A75,100 20,20 90 270 Z"),
    ("rotor", "fill M60,85 L100,99 L140,85 L140,115 L100,101 L60,115 Z"),
    ("unmanned", "fill M60,84 L100,103.5 L140,84 L140,92 L100,116.5 L60,92 Z"),
    ("missile", "M90,120 L90,92 A100,92 10,10 180 360 L110,120 M100,120 L100,82"),
    ("round", "M90,117 L90,91.5 A100,91.5 10,10 180 360 L110,117 M85,117 L115,117"),
    ("wheel", "circle 100,100 19; M100,81 L100,119 M83.5,91 L116.5,109 M116.5,91 L83.5,109"),
    ("arrow", "M85,75 L100,60 L115,75"),
    ("barrels", "M85,80 L85,120 M115,80 L115,120"),
    ("shield", "M85,140 A100,140 15,15 180 360 Z"),
    ("launcher", "M85,75 A100,75 15,15 180 360"),
    ("hull", "fill M88.5,79 L111.5,79 L111.5,98.5 L123.5,98.5 L100,122 L76.5,98.5 L88.5,98.5 Z"),
];

/// In a rectangle (or a circle), a diamond, a square and a quatrefoil.
const FRAME_FILLING: [FramedPiece; 11] = [
    (
        "infantry",
        [
            "M25,50 L175,150 M25,150 L175,50",
            "M60,70 L140,130 M60,130 L140,70",
            "M45,45 L155,155 M45,155 L155,45",
            "M50,65 L150,135 M50,135 L150,65",
        ],
    ),
    ("reconnaissance", ["M25,150 L175,50", "M60,130 L140,70", "M45,155 L155,45", "M50,135 L150,65"]),
    ("upright", ["M100,50 L100,150", "M100,28 L100,172", "M100,45 L100,155", "M100,31 L100,169"]),
    ("gun", ["M55,50 L55,150", "M55,75 L55,125", "M55,45 L55,155", "M55,65 L55,135"]),
    (
        "antitank",
        [
            "M25,150 L100,52 L175,150",
            "M60,132 L100,30 L140,132",
            "M45,150 L100,47 L155,150",
            "M55,135 L100,33 L145,135",
        ],
    ),
    (
        "dome",
        [
            "M25,150 A100,150 75,30 180 360",
            "M71,142 A100,142 29,22 180 360",
            "M45,150 A100,150 55,30 180 360",
            "M55,135 A100,135 45,15 180 360",
        ],
    ),
    ("supply", ["M25,120 L175,120", "M48,120 L152,120", "M45,120 L155,120", "M35,120 L165,120"]),
    ("staff-line", ["M25,80 L175,80", "M48,80 L152,80", "M45,80 L155,80", "M35,80 L165,80"]),
    (
        "cross",
        [
            "M25,100 L175,100 M100,50 L100,150",
            "M28,100 L172,100 M100,28 L100,172",
            "M45,100 L155,100 M100,45 L100,155",
            "M31,100 L169,100 M100,31 L100,169",
        ],
    ),
    (
        "signal",
        [
            "M25,50 L100,110 L100,90 L175,150",
            "M57,71 L100,110 L100,90 L143,129",
            "M45,45 L100,110 L100,90 L155,155",
            "M52,65 L100,110 L100,90 L148,135",
        ],
    ),
    (
        "assault",
        [
            "M25,120 L85,120 L100,135 L115,120 L175,120",
            "M48,120 L85,120 L100,135 L115,120 L152,120",
            "M45,120 L85,120 L100,135 L115,120 L155,120",
            "M35,120 L85,120 L100,135 L115,120 L165,120",
        ],
    ),
];

fn column(shape: FrameShape) -> usize {
    match shape {
        FrameShape::Diamond | FrameShape::Tent(_) => 1,
        FrameShape::Square | FrameShape::OpenBox(_) => 2,
        FrameShape::Quatrefoil | FrameShape::Trefoil(_) => 3,
        FrameShape::Rectangle | FrameShape::Circle | FrameShape::Hexagon | FrameShape::Arch(_) => 0,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_piece_has_a_name_of_its_own() {
        let shared = SHARED.iter().flat_map(|table| *table).map(|row| row.0);
        let framed = FRAMED.iter().flat_map(|table| *table).map(|row| row.0);
        let mut names = BTreeSet::new();
        for name in shared.chain(framed) {
            assert!(names.insert(name), "{name} is there twice");
        }
    }
}

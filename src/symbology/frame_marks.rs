//! What some frames have besides their outline: the bar of an installation, the corners of an activity, the dark top of a
//! thing in space, the dark corner of one in cyberspace.
//!
//! MIL-STD-2525D, 5.3.1; digit 23 of a code of MIL-STD-2525E gives a symbol the frame of another set.

use glam::Vec2;

use crate::code::SymbolCode;
use crate::drawing::{BLACK, PathStep, SymbolMark, path};
use crate::fields::SymbolSet;
use crate::frame::{FrameOpening, FrameShape, SymbolBox};

/// A mark at a frame's outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FrameAddition {
    InstallationBar,
    ActivityCorners,
    SpaceTop,
    CyberspaceCorner,
}

impl FrameAddition {
    /// What the frame of a code has, if anything.
    pub(super) fn of(code: &SymbolCode) -> Option<Self> {
        match (code.stated_frame(), code.set) {
            (1, _) | (0, SymbolSet::Space | SymbolSet::SpaceMissile | SymbolSet::SignalsSpace) => {
                Some(Self::SpaceTop)
            }
            (5, _) | (0, SymbolSet::LandInstallation) => Some(Self::InstallationBar),
            (8, _) | (0, SymbolSet::Activity) => Some(Self::ActivityCorners),
            (9, _) | (0, SymbolSet::Cyberspace) => Some(Self::CyberspaceCorner),
            _ => None,
        }
    }
}

/// What a kind of frame adds to its outline, and the box around it.
pub(super) fn frame_marks(code: &SymbolCode, shape: FrameShape) -> Option<(Vec<SymbolMark>, SymbolBox)> {
    let frame = shape.bounds();
    let black = |text: &str| SymbolMark::filled(path(text), BLACK);
    match FrameAddition::of(code)? {
        FrameAddition::InstallationBar => {
            // The bar sits on the frame, and sinks to it on a diamond's tip and a quatrefoil's lobe.
            let (top, bottom) = match shape {
                FrameShape::Diamond => (frame.min.y - 10.0, frame.min.y + 14.0),
                FrameShape::Quatrefoil => (frame.min.y - 10.0, frame.min.y + 2.0),
                _ => (frame.min.y - 10.0, frame.min.y),
            };
            let bar = SymbolBox::new(83.0, top, 117.0, bottom);
            let mut steps = match shape {
                FrameShape::Diamond => path("M85,43 L85,18 L115,18 L115,43 L100,28"),
                _ => path_of(&bar),
            };
            steps.push(PathStep::Close);
            Some((vec![SymbolMark::filled(steps, BLACK)], bar))
        }
        FrameAddition::ActivityCorners => {
            let corners = match shape {
                FrameShape::Diamond => [
                    "M100,28 L111,39 L100,50 L89,39 Z",
                    "M172,100 L161,111 L150,100 L161,89 Z",
                    "M100,172 L89,161 L100,150 L111,161 Z",
                    "M28,100 L39,89 L50,100 L39,111 Z",
                ],
                FrameShape::Square => [
                    "M45,45 L61,45 L61,61 L45,61 Z",
                    "M155,45 L155,61 L139,61 L139,45 Z",
                    "M155,155 L139,155 L139,139 L155,139 Z",
                    "M45,155 L45,139 L61,139 L61,155 Z",
                ],
                FrameShape::Quatrefoil => [
                    "M92,31 L108,31 L108,47 L92,47 Z",
                    "M169,92 L169,108 L153,108 L153,92 Z",
                    "M108,169 L92,169 L92,153 L108,153 Z",
                    "M31,108 L31,92 L47,92 L47,108 Z",
                ],
                _ => [
                    "M25,50 L41,50 L41,65 L25,65 Z",
                    "M175,50 L175,65 L159,65 L159,50 Z",
                    "M175,150 L159,150 L159,135 L175,135 Z",
                    "M25,150 L25,135 L41,135 L41,150 Z",
                ],
            };
            Some((corners.map(black).to_vec(), frame))
        }
        FrameAddition::SpaceTop => {
            let top = match shape {
                FrameShape::Arch(FrameOpening::Below) => {
                    "M68.5,50 C75,38.5 87,30 100,30 C113,30 125,38.5 131.5,50 Z"
                }
                FrameShape::Tent(FrameOpening::Below) => "M67,50 L100,20 L133,50 Z",
                FrameShape::OpenBox(FrameOpening::Below) => "M45,30 L155,30 L155,50 L45,50 Z",
                FrameShape::Trefoil(FrameOpening::Below) => "M63.3,50 A100,57.4 37.4,37.4 -168.6 -11.4 Z",
                _ => return None,
            };
            Some((vec![black(top)], frame))
        }
        FrameAddition::CyberspaceCorner => {
            let corner = match shape {
                FrameShape::Diamond => "M150,78 L172,100 L150,122 Z",
                FrameShape::Square => "M117,155 L155,117 L155,155 Z",
                FrameShape::Quatrefoil => {
                    "M150,66 C162,72 169.25,84 169.25,100 C169.25,116 162,128 150,134 Z"
                }
                _ => "M135,150 L175,110 L175,150 Z",
            };
            Some((vec![black(corner)], frame))
        }
    }
}

fn path_of(area: &SymbolBox) -> Vec<PathStep> {
    let (min, max) = (area.min, area.max);
    let corners = [Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)];
    [PathStep::Move(min)].into_iter().chain(corners.map(PathStep::Line)).collect()
}

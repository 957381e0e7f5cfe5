//! Frames: the shape that tells friend from foe and land from air, and its fill.
//!
//! MIL-STD-2525D, 5.3.1 and figure 13; colors of table V, light.

use glam::Vec2;

use crate::code::SymbolCode;
use crate::drawing::{PathStep, circle, path};
use crate::fields::{SymbolIdentity, SymbolSet};

/// Width of a frame's line.
pub(super) const FRAME_LINE: f32 = 4.0;

/// A rectangle in the symbol's box of 200 × 200 units, Y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymbolBox {
    /// The upper left corner.
    pub min: Vec2,
    /// The lower right corner.
    pub max: Vec2,
}

impl SymbolBox {
    pub(super) const fn new(left: f32, top: f32, right: f32, bottom: f32) -> Self {
        Self { min: Vec2::new(left, top), max: Vec2::new(right, bottom) }
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
}

/// The open side of a frame: below in the air, above under water.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameOpening {
    /// Air and space.
    Below,
    /// Subsurface.
    Above,
}

/// The shape of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameShape {
    /// A friendly unit, installation or activity.
    Rectangle,
    /// Friendly equipment, or a friend on the sea.
    Circle,
    /// A friendly dismounted individual.
    Hexagon,
    /// Hostile.
    Diamond,
    /// Neutral.
    Square,
    /// Unknown.
    Quatrefoil,
    /// A friend in the air or under water.
    Arch(FrameOpening),
    /// Hostile in the air or under water.
    Tent(FrameOpening),
    /// Neutral in the air or under water.
    OpenBox(FrameOpening),
    /// Unknown in the air or under water.
    Trefoil(FrameOpening),
}

/// The kinds of frames that the sets have.
enum FrameFamily {
    Unit,
    Equipment,
    Dismounted,
    Open(FrameOpening),
}

impl FrameShape {
    /// The frame of a code; `None` for sets without frames, such as control measures.
    pub fn of(code: &SymbolCode) -> Option<Self> {
        use FrameFamily::{Dismounted, Equipment, Open, Unit};
        let by_set = match code.set {
            SymbolSet::LandUnit
            | SymbolSet::LandCivilian
            | SymbolSet::LandInstallation
            | SymbolSet::Activity
            | SymbolSet::Cyberspace => Unit,
            SymbolSet::Unknown
            | SymbolSet::LandEquipment
            | SymbolSet::SeaSurface
            | SymbolSet::SignalsLand
            | SymbolSet::SignalsSurface => Equipment,
            SymbolSet::Dismounted => Dismounted,
            SymbolSet::Air
            | SymbolSet::AirMissile
            | SymbolSet::Space
            | SymbolSet::SpaceMissile
            | SymbolSet::SignalsSpace
            | SymbolSet::SignalsAir => Open(FrameOpening::Below),
            SymbolSet::Subsurface | SymbolSet::MineWarfare | SymbolSet::SignalsSubsurface => {
                Open(FrameOpening::Above)
            }
            SymbolSet::ControlMeasure
            | SymbolSet::Atmosphere
            | SymbolSet::Ocean
            | SymbolSet::MeteorologicalSpace => return None,
        };
        let family = match code.stated_frame() {
            1 | 2 => Open(FrameOpening::Below),
            3 | 5 | 8 | 9 => Unit,
            4 => Equipment,
            6 => Dismounted,
            7 => Open(FrameOpening::Above),
            _ => by_set,
        };
        let is_friend = matches!(code.identity, SymbolIdentity::Friend | SymbolIdentity::AssumedFriend)
            || code.is_joker_or_faker();
        Some(match (family, code.identity) {
            (Unit, _) if is_friend => Self::Rectangle,
            (Equipment, _) if is_friend => Self::Circle,
            (Dismounted, _) if is_friend => Self::Hexagon,
            (Open(opening), _) if is_friend => Self::Arch(opening),
            (Open(opening), SymbolIdentity::Suspect | SymbolIdentity::Hostile) => Self::Tent(opening),
            (Open(opening), SymbolIdentity::Neutral) => Self::OpenBox(opening),
            (Open(opening), _) => Self::Trefoil(opening),
            (_, SymbolIdentity::Suspect | SymbolIdentity::Hostile) => Self::Diamond,
            (_, SymbolIdentity::Neutral) => Self::Square,
            _ => Self::Quatrefoil,
        })
    }

    /// The box around the middle of the frame's line.
    pub fn bounds(self) -> SymbolBox {
        match self {
            Self::Rectangle => SymbolBox::new(25.0, 50.0, 175.0, 150.0),
            Self::Circle => SymbolBox::new(40.0, 40.0, 160.0, 160.0),
            Self::Hexagon | Self::Square => SymbolBox::new(45.0, 45.0, 155.0, 155.0),
            Self::Diamond => SymbolBox::new(28.0, 28.0, 172.0, 172.0),
            Self::Quatrefoil => SymbolBox::new(30.75, 30.75, 169.25, 169.25),
            Self::Arch(opening) | Self::OpenBox(opening) => {
                opened(SymbolBox::new(45.0, 30.0, 155.0, 150.0), opening)
            }
            Self::Tent(opening) => opened(SymbolBox::new(45.0, 20.0, 155.0, 150.0), opening),
            Self::Trefoil(opening) => opened(SymbolBox::new(25.0, 20.0, 175.0, 150.0), opening),
        }
    }

    /// The outline; that of an open frame is not closed.
    pub(super) fn outline(self) -> Vec<PathStep> {
        let (steps, opening) = match self {
            Self::Rectangle => (path("M25,50 L175,50 L175,150 L25,150 Z"), FrameOpening::Below),
            Self::Circle => (circle(Vec2::splat(100.0), 60.0), FrameOpening::Below),
            Self::Hexagon => {
                (path("M100,45 L155,70 L155,130 L100,155 L45,130 L45,70 Z"), FrameOpening::Below)
            }
            Self::Diamond => (path("M100,28 L172,100 L100,172 L28,100 Z"), FrameOpening::Below),
            Self::Square => (path("M45,45 L155,45 L155,155 L45,155 Z"), FrameOpening::Below),
            Self::Quatrefoil => (
                path(
                    "M63,63 C63,42 80,30.75 100,30.75 C120,30.75 137,42 137,63 C158,63 169.25,80 169.25,100 \
                     C169.25,120 158,137 137,137 C137,158 120,169.25 100,169.25 C80,169.25 63,158 63,137 \
                     C42,137 30.75,120 30.75,100 C30.75,80 42,63 63,63 Z",
                ),
                FrameOpening::Below,
            ),
            Self::Arch(opening) => (path("M45,150 C45,76 70,30 100,30 C130,30 155,76 155,150"), opening),
            Self::Tent(opening) => (path("M45,150 L45,70 L100,20 L155,70 L155,150"), opening),
            Self::OpenBox(opening) => (path("M45,150 L45,30 L155,30 L155,150"), opening),
            Self::Trefoil(opening) => (
                path(
                    "M65,150 A65,105 39.5,45 90 270 L65,60 A100,60 35,37.5 180 360 L135,60 A135,105 39.5,45 -90 90",
                ),
                opening,
            ),
        };
        match opening {
            FrameOpening::Below => steps,
            FrameOpening::Above => steps.into_iter().map(mirrored).collect(),
        }
    }
}

fn opened(area: SymbolBox, opening: FrameOpening) -> SymbolBox {
    match opening {
        FrameOpening::Below => area,
        FrameOpening::Above => SymbolBox {
            min: Vec2::new(area.min.x, 200.0 - area.max.y),
            max: Vec2::new(area.max.x, 200.0 - area.min.y),
        },
    }
}

fn mirrored(step: PathStep) -> PathStep {
    let flip = |at: Vec2| Vec2::new(at.x, 200.0 - at.y);
    match step {
        PathStep::Move(at) => PathStep::Move(flip(at)),
        PathStep::Line(at) => PathStep::Line(flip(at)),
        PathStep::Quad(control, end) => PathStep::Quad(flip(control), flip(end)),
        PathStep::Cubic(one, two, end) => PathStep::Cubic(flip(one), flip(two), flip(end)),
        PathStep::Close => PathStep::Close,
    }
}

const FRIEND: [u8; 3] = [128, 224, 255];
const HOSTILE: [u8; 3] = [255, 128, 128];
const NEUTRAL: [u8; 3] = [170, 255, 170];
const UNKNOWN: [u8; 3] = [255, 255, 128];
/// 2525E; in 2525D a suspect is as red as an enemy.
const SUSPECT: [u8; 3] = [255, 229, 153];
const CIVILIAN: [u8; 3] = [255, 161, 255];

/// The color inside the frame.
pub(super) fn fill(code: &SymbolCode) -> [u8; 3] {
    let has_suspects = code.version.has_changes_of_e();
    match code.identity {
        SymbolIdentity::Suspect if has_suspects && !code.is_joker_or_faker() => SUSPECT,
        SymbolIdentity::Suspect | SymbolIdentity::Hostile => HOSTILE,
        _ if is_civilian(code) => CIVILIAN,
        SymbolIdentity::Friend | SymbolIdentity::AssumedFriend => FRIEND,
        SymbolIdentity::Neutral => NEUTRAL,
        SymbolIdentity::Pending | SymbolIdentity::Unknown => UNKNOWN,
    }
}

fn is_civilian(code: &SymbolCode) -> bool {
    let group = code.entity / 10_000;
    match code.set {
        _ if code.stated_frame() != 0 => false,
        SymbolSet::LandCivilian => true,
        SymbolSet::Air | SymbolSet::Space | SymbolSet::Subsurface => group == 12,
        SymbolSet::LandEquipment => group == 16,
        SymbolSet::SeaSurface => group == 14,
        _ => false,
    }
}

/// How a frame is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FrameInk {
    /// A black line round a fill.
    Filled([u8; 3]),
    /// A line alone: mines have colors of their own inside.
    Line([u8; 3]),
    /// No frame: the track of one's own ship.
    None,
}

impl FrameInk {
    /// How the frame of a code is drawn.
    pub(super) fn of(code: &SymbolCode) -> Self {
        match (code.set, code.entity) {
            (SymbolSet::SeaSurface, 150_000) => Self::None,
            (SymbolSet::MineWarfare, _) => Self::Line(match code.identity {
                SymbolIdentity::Suspect if code.version.has_changes_of_e() => [255, 188, 1],
                SymbolIdentity::Suspect | SymbolIdentity::Hostile => [255, 0, 0],
                SymbolIdentity::Neutral => [0, 255, 0],
                SymbolIdentity::Friend | SymbolIdentity::AssumedFriend => [0, 255, 255],
                SymbolIdentity::Pending | SymbolIdentity::Unknown => [255, 255, 0],
            }),
            _ => Self::Filled(fill(code)),
        }
    }
}

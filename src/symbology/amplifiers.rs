//! Amplifiers around a frame: echelon, mobility, headquarters staff, task force, feint or dummy, condition.
//!
//! MIL-STD-2525D, 5.3.7, tables D-III (echelons) and IX (mobility).

use glam::Vec2;

use crate::drawing::{BLACK, PathStep, SymbolMark, SymbolPen, circle, path};
use crate::fields::{SymbolAmplifier, SymbolRole, SymbolStatus};
use crate::frame::{FRAME_LINE, FrameOpening, FrameShape, SymbolBox};

/// The height of the strip over a frame in which echelons of bars and crosses stand; dots take less.
const ECHELON_STRIP: f32 = 40.0;
const DOT_STRIP: f32 = 27.5;
/// Echelon marks stand this far over the frame, and are this high.
const ECHELON_GAP: f32 = 10.0;
const ECHELON_HEIGHT: f32 = 25.0;
/// Distance between crosses.
const CROSS_PITCH: f32 = 35.0;
/// The length of a headquarters staff below the frame.
const STAFF: f32 = 100.0;
/// A condition bar: its distance below, and its height.
const BAR_GAP: f32 = 5.0;
const BAR_HEIGHT: f32 = 25.0;

/// Marks, and the box that they take.
pub(super) struct Amplification {
    pub marks: Vec<SymbolMark>,
    pub bounds: SymbolBox,
}

impl Amplification {
    pub(super) fn new(frame: SymbolBox) -> Self {
        Self { marks: Vec::new(), bounds: frame }
    }

    fn stroke(&mut self, steps: Vec<PathStep>, width: f32) {
        self.marks.push(SymbolMark::stroke(steps, SymbolPen::black(width)));
    }

    fn draw(&mut self, text: &str, by: Vec2) {
        for statement in text.split(';') {
            let filled = statement.trim().strip_prefix("fill ");
            let steps = moved(path(filled.unwrap_or(statement)), by);
            match filled {
                Some(_) => self.marks.push(SymbolMark::filled(steps, BLACK)),
                None => self.stroke(steps, FRAME_LINE),
            }
        }
    }

    fn cover(&mut self, area: SymbolBox) {
        self.bounds = self.bounds.union(area);
    }

    /// The echelon over a frame. MIL-STD-2525D, table D-III.
    pub(super) fn echelon(&mut self, echelon: SymbolAmplifier, frame: SymbolBox) {
        let top = frame.min.y;
        let (low, high) = (top - ECHELON_GAP, top - ECHELON_GAP - ECHELON_HEIGHT);
        let mut strip = ECHELON_STRIP;
        let mut half_width: f32 = 20.0;
        let number = echelon.number();
        match number {
            11 => {
                self.stroke(circle(Vec2::new(100.0, top - 20.0), 15.0), FRAME_LINE);
                self.stroke(line(Vec2::new(80.0, top - 10.0), Vec2::new(120.0, top - 30.0)), FRAME_LINE);
            }
            12..=14 => {
                strip = DOT_STRIP;
                for at in spread(number - 11, 30.0) {
                    self.marks.push(SymbolMark::filled(circle(Vec2::new(at, top - 20.0), 9.5), BLACK));
                }
            }
            15..=17 => {
                for at in spread(number - 14, 20.0) {
                    self.stroke(line(Vec2::new(at, low), Vec2::new(at, high)), FRAME_LINE);
                }
            }
            18..=25 => {
                let count = if number == 18 { 1 } else { number - 19 };
                half_width = f32::from(count - 1) * CROSS_PITCH * 0.5 + ECHELON_HEIGHT * 0.5;
                for at in spread(count, CROSS_PITCH) {
                    let half = ECHELON_HEIGHT * 0.5;
                    self.stroke(line(Vec2::new(at - half, low), Vec2::new(at + half, high)), FRAME_LINE);
                    self.stroke(line(Vec2::new(at - half, high), Vec2::new(at + half, low)), FRAME_LINE);
                }
            }
            26 => {
                for at in spread(2, CROSS_PITCH) {
                    let (half, middle) = (ECHELON_HEIGHT * 0.5, (low + high) * 0.5);
                    self.stroke(line(Vec2::new(at, low), Vec2::new(at, high)), FRAME_LINE);
                    self.stroke(line(Vec2::new(at - half, middle), Vec2::new(at + half, middle)), FRAME_LINE);
                }
            }
            _ => return,
        }
        self.cover(SymbolBox::new(100.0 - half_width, top - strip, 100.0 + half_width, top));
    }

    /// The mobility below a frame. MIL-STD-2525D, table IX. Marks that rise at their ends hang lower under the flat bottom
    /// of a neutral frame.
    pub(super) fn mobility(&mut self, mobility: SymbolAmplifier, shape: FrameShape) {
        use SymbolAmplifier as Mobility;
        let is_flat = shape == FrameShape::Square;
        let (drawing, box_x, height, lower) = match mobility {
            Mobility::Wheeled => (WHEELED, [50.0, 150.0], 16.0, 0.0),
            Mobility::WheeledCrossCountry => (CROSS_COUNTRY, [50.0, 150.0], 16.0, 0.0),
            Mobility::Tracked => (TRACKED, [42.0, 168.0], 18.0, 0.0),
            Mobility::HalfTracked => (HALF_TRACKED, [50.0, 168.0], 16.0, 0.0),
            Mobility::Towed => (TOWED, [50.0, 150.0], 10.0, 8.0),
            Mobility::Rail => (RAIL, [50.0, 150.0], 16.0, 0.0),
            Mobility::PackAnimals => (PACK_ANIMALS, [80.0, 120.0], 20.0, 0.0),
            Mobility::OverSnow => (OVER_SNOW, [50.0, 150.0], 9.0, 18.0),
            Mobility::Sled => (SLED, [42.0, 168.0], 15.0, 18.0),
            Mobility::Barge => (BARGE, [50.0, 150.0], 10.0, 5.0),
            Mobility::Amphibious => (AMPHIBIOUS, [65.0, 135.0], 20.0, 0.0),
            Mobility::ShortTowedArray => (SHORT_ARRAY, [50.0, 150.0], 10.0, 8.0),
            Mobility::LongTowedArray => (LONG_ARRAY, [50.0, 150.0], 10.0, 8.0),
            _ => return,
        };
        let frame = shape.bounds();
        let by = if is_flat { lower } else { 0.0 };
        self.draw(drawing, Vec2::new(0.0, frame.max.y + by));
        self.cover(SymbolBox::new(box_x[0], frame.max.y, box_x[1], frame.max.y + height + by));
    }

    /// The marks of a leader or a deputy over a friendly individual.
    pub(super) fn leader(&mut self, amplifier: SymbolAmplifier, shape: FrameShape) {
        if !matches!(amplifier, SymbolAmplifier::Leader | SymbolAmplifier::DeputyLeader)
            || shape != FrameShape::Hexagon
        {
            return;
        }
        self.stroke(path("M45,60 L100,35 L155,60"), FRAME_LINE);
        self.cover(SymbolBox::new(45.0, 25.0, 155.0, 155.0));
    }

    /// Task force bracket and feint or dummy chevron over a frame, headquarters staff below it.
    pub(super) fn role(&mut self, role: SymbolRole, echelon: SymbolAmplifier, shape: FrameShape) {
        let frame = shape.bounds();
        let (top, middle) = (frame.min.y, Vec2::new(100.0, frame.min.y));
        if role.is_task_force() {
            // Wide enough for the echelon.
            let half = match echelon.number() {
                24 => 90.0,
                25 => 107.5,
                23 => 72.5,
                22 => 55.0,
                _ => 45.0,
            };
            let corners = [
                Vec2::new(-half, 0.0),
                Vec2::new(-half, -ECHELON_STRIP),
                Vec2::new(half, -ECHELON_STRIP),
                Vec2::new(half, 0.0),
            ];
            self.stroke(polyline(&corners.map(|at| middle + at)), FRAME_LINE);
            self.cover(SymbolBox::new(100.0 - half, top - ECHELON_STRIP, 100.0 + half, top));
        }
        if role.is_dummy() {
            // A right angle over the whole width.
            let half = (frame.max.x - frame.min.x) * 0.5;
            let corners = [Vec2::new(-half, 0.0), Vec2::new(0.0, -half), Vec2::new(half, 0.0)];
            let pen = SymbolPen { dash: Some([8.0, 8.0]), ..SymbolPen::black(FRAME_LINE) };
            self.marks.push(SymbolMark::stroke(polyline(&corners.map(|at| middle + at)), pen));
            self.cover(SymbolBox::new(frame.min.x, top - half, frame.max.x, top));
        }
        if role.is_headquarters() {
            let foot = staff_foot(shape);
            let from = match shape {
                FrameShape::Arch(FrameOpening::Below) | FrameShape::Tent(FrameOpening::Below) => frame.max.y,
                _ => 100.0,
            };
            self.stroke(line(Vec2::new(foot.x, from), foot), FRAME_LINE);
            self.cover(SymbolBox { min: Vec2::new(foot.x, from), max: foot });
        }
    }

    /// The condition bar, below all else.
    pub(super) fn condition(&mut self, status: SymbolStatus, frame: SymbolBox, bottom: f32) {
        let color = match status {
            SymbolStatus::Present | SymbolStatus::Planned => return,
            SymbolStatus::FullyCapable => [0, 255, 0],
            SymbolStatus::Damaged => [255, 255, 0],
            SymbolStatus::Destroyed => [255, 0, 0],
            SymbolStatus::FullToCapacity => [0, 180, 240],
        };
        let area = SymbolBox::new(frame.min.x, bottom + BAR_GAP, frame.max.x, bottom + BAR_GAP + BAR_HEIGHT);
        let (min, max) = (area.min, area.max);
        let mut steps = polyline(&[min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)]);
        steps.push(PathStep::Close);
        self.marks.push(SymbolMark::Shape {
            steps,
            fill: Some(color),
            stroke: Some(SymbolPen::black(FRAME_LINE)),
        });
        self.cover(area);
    }
}

/// The lower end of a headquarters staff, where the headquarters is.
pub(super) fn staff_foot(shape: FrameShape) -> Vec2 {
    let frame = shape.bounds();
    Vec2::new(frame.min.x, frame.max.y + STAFF)
}

/// Positions of `count` things round the middle.
fn spread(count: u8, pitch: f32) -> impl Iterator<Item = f32> {
    (0..count).map(move |index| 100.0 + (f32::from(index) - f32::from(count - 1) * 0.5) * pitch)
}

fn line(from: Vec2, to: Vec2) -> Vec<PathStep> {
    vec![PathStep::Move(from), PathStep::Line(to)]
}

fn polyline(points: &[Vec2]) -> Vec<PathStep> {
    let step =
        |(index, &at): (usize, &Vec2)| if index == 0 { PathStep::Move(at) } else { PathStep::Line(at) };
    points.iter().enumerate().map(step).collect()
}

fn moved(steps: Vec<PathStep>, by: Vec2) -> Vec<PathStep> {
    let step = |step| match step {
        PathStep::Move(at) => PathStep::Move(at + by),
        PathStep::Line(at) => PathStep::Line(at + by),
        PathStep::Quad(control, end) => PathStep::Quad(control + by, end + by),
        PathStep::Cubic(one, two, end) => PathStep::Cubic(one + by, two + by, end + by),
        PathStep::Close => PathStep::Close,
    };
    steps.into_iter().map(step).collect()
}

// Mobilities, Y from the frame's bottom.
const WHEELED: &str = "M58,1 L142,1; M66,8 A58,8 8,8 0 360 Z; M150,8 A142,8 8,8 0 360 Z";
const CROSS_COUNTRY: &str =
    "M58,1 L142,1; M66,8 A58,8 8,8 0 360 Z; M108,8 A100,8 8,8 0 360 Z; M150,8 A142,8 8,8 0 360 Z";
const TRACKED: &str = "M53,1 L153,1 A153,8.5 11.5,7.5 -90 90 L53,16 A53,8.5 11.5,7.5 90 270 Z";
const HALF_TRACKED: &str =
    "M66,8 A58,8 8,8 0 360 Z; M83,1 L153,1 A153,8.5 11.5,7.5 -90 90 L83,16 A83,8.5 11.5,7.5 90 270 Z";
const TOWED: &str = "M66,1 L134,1; M66,3 A58,3 8,8 0 360 Z; M150,3 A142,3 8,8 0 360 Z";
const RAIL: &str = "M58,1 L142,1; M66,8 A58,8 8,8 0 360 Z; M81,8 A73,8 8,8 0 360 Z; M135,8 A127,8 8,8 0 360 Z; \
                    M150,8 A142,8 8,8 0 360 Z";
const PACK_ANIMALS: &str = "M80,20 L90,0 L100,20 L110,0 L120,20";
const OVER_SNOW: &str = "M50,-9 L60,1 L150,1";
const SLED: &str = "M55,-12 A55,-4.5 11.5,7.5 -90 -270 L145,3 A145,-4.5 11.5,7.5 90 -90";
const BARGE: &str = "M50,1 L150,1 Q140,8 100,8 Q60,8 50,1 Z";
const AMPHIBIOUS: &str = "M65,10 A70,10 5,7 180 360 A80,10 5,7 180 0 A90,10 5,7 180 360 A100,10 5,7 180 0 \
                          A110,10 5,7 180 360 A120,10 5,7 180 0 A130,10 5,7 180 360";
const SHORT_ARRAY: &str = "M55,5 L145,5; fill M48.5,-1 L61.5,-1 L61.5,11 L48.5,11 Z; \
                           fill M138.5,-1 L151.5,-1 L151.5,11 L138.5,11 Z; fill M100,-1 L106,5 L100,11 L94,5 Z";
const LONG_ARRAY: &str = "M55,5 L145,5; fill M48.5,-1 L61.5,-1 L61.5,11 L48.5,11 Z; \
                          fill M138.5,-1 L151.5,-1 L151.5,11 L138.5,11 Z; fill M93.5,-1 L106.5,-1 L106.5,11 L93.5,11 Z; \
                          fill M75,-1 L81,5 L75,11 L69,5 Z; fill M125,-1 L131,5 L125,11 L119,5 Z";

//! Places the letters of a name along a line, each rotated to the direction of the line, unless the line bends too
//! sharply for them.

use glam::{DVec2, Vec2};

/// The limits within which a name along a line stays readable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LetterLimits {
    /// The greatest turn from a letter to the next, radians.
    pub most_turn: f32,
    /// The greatest turn of the whole name, radians.
    pub most_bend: f32,
    /// How far letters may lean back over the upright, as the cosine of their turn.
    pub most_lean: f32,
}

/// The limits of pictures. At 26° letters of normal type begin to collide; a name that bends by more than 103° no longer
/// reads as one word.
pub const LIMITS: LetterLimits = LetterLimits { most_turn: 0.45, most_bend: 1.8, most_lean: -0.15 };

/// A letter to be set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CourseLetter {
    /// The middle of its advance, from the middle of the name.
    pub middle: f32,
    /// How far on either side the line's direction under it is taken.
    pub reach: f32,
}

/// A letter's place: the middle of its advance on the baseline, and the direction of the baseline there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetLetter {
    /// The middle of its advance on the baseline.
    pub at: Vec2,
    /// The direction of the baseline there, of length 1.
    pub along: Vec2,
}

/// The place of a name along a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LetterCourse {
    /// The station of its middle.
    pub station: f32,
    /// Whether it reads against the line.
    pub is_reversed: bool,
    /// The height of the baseline above the line.
    pub baseline: f32,
    /// The limits on the bends of the name.
    pub limits: LetterLimits,
}

impl LetterCourse {
    /// The letters on the line whose places by station are `at`, downward on the picture, and how much the name bends in
    /// radians; `None` where it breaks its limits.
    pub fn set(
        &self,
        at: impl Fn(f32) -> DVec2,
        letters: impl ExactSizeIterator<Item = CourseLetter>,
    ) -> Option<(Vec<SetLetter>, f32)> {
        let side = if self.is_reversed { -1.0 } else { 1.0 };
        let mut set: Vec<SetLetter> = Vec::with_capacity(letters.len());
        let mut bend = 0.0;
        for CourseLetter { middle, reach } in letters {
            let middle = self.station + side * middle;
            let ahead = at(middle + side * reach) - at(middle - side * reach);
            let along = ahead.as_vec2().try_normalize().filter(|along| along.x > self.limits.most_lean)?;
            if let Some(before) = set.last() {
                let turn = libm::atan2f(before.along.perp_dot(along), before.along.dot(along)).abs();
                bend += turn;
                if turn > self.limits.most_turn || bend > self.limits.most_bend {
                    return None;
                }
            }
            let up = Vec2::new(along.y, -along.x);
            set.push(SetLetter { at: at(middle).as_vec2() + up * self.baseline, along });
        }
        Some((set, bend))
    }
}

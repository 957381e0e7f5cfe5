//! A name or a height on the picture, with its place on the ground.

use std::ops::Range;

use glam::Vec3;

use crate::label_course::LabelCourse;
use sandtable_description::words::{LabelKind, RoadShield};

/// A name on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLabel {
    /// What it says.
    pub text: String,
    /// The bytes of the scene file that state it; `0..0` for a spot height.
    pub stated: Range<usize>,
    /// The position on the ground, world space, displayed height.
    pub ground: Vec3,
    /// Where the leader line starts, at or above the ground.
    pub anchor: Vec3,
    /// What it follows on the ground.
    pub course: LabelCourse,
    /// The kind of thing that it names.
    pub kind: LabelKind,
    /// The lower, the more important; never NaN.
    pub rank: f64,
    /// The size of its letters, of the usual size of its kind.
    pub size: f32,
    /// The shield that it stands in.
    pub shield: Option<RoadShield>,
}

/// A height in whole meters, without a sign before 0.
pub fn whole_meters(height_m: f32) -> String {
    let rounded = height_m.round();
    format!("{:.0}", if rounded == 0.0 { 0.0 } else { rounded })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_height_is_written_as_minus_nothing() {
        let written = [-0.3, 0.0, 0.4, -0.6, 311.5].map(whole_meters);
        assert_eq!(written, ["0", "0", "0", "-1", "312"]);
    }
}

//! The draw rules: what each point of a graphic is (MIL-STD-2525D, appendix H; those of maneuver MIL-STD-2525E).

use crate::graphic::kind::{GraphicKind, GraphicShape};

/// Rules of symbol set 25 and the meanings of their points.
pub const POINT_MEANINGS: [(&str, &str); 60] = [
    ("LINE1", "the line, in order; of a direction of attack from its tip back; the enemy is on the left"),
    ("LINE2", "the line, in order, with its name at both ends"),
    ("LINE3", "1 the vertex, 2 the tip of the principal direction, 3 the other tip"),
    ("LINE4", "1 the start, 2 the end"),
    ("LINE5", "the line, in order; of a target its two ends"),
    ("LINE7", "the line, in order, with its texts on both sides of its middle"),
    ("LINE8", "the line, in order"),
    ("LINE9", "1 the tip, 2 the rear"),
    ("LINE10", "1 the tip, 2 the rear, 3 a place on the side of the bow"),
    ("LINE11", "1 and 2 the ends of one side, 3 and 4 those of the other"),
    ("LINE12", "1 and 2 the ends of the road's middle, 3 how far off both lines are"),
    ("LINE13", "the line, in order, with the notch behind point 1"),
    ("LINE14", "1 and 2 the ends of the lane"),
    ("LINE16", "1 and 2 the ends of one side, 3 and 4 those of the other"),
    ("LINE17", "1 and 2 the ends of one side, 3 how far off the other side is"),
    ("LINE18", "1 and 2 the tips"),
    ("LINE19", "1 and 2 the ends of the position"),
    ("LINE20", "1 the front, 2 the rear"),
    ("LINE21", "the route, in the direction of traffic"),
    ("LINE22", "1 and 2 the ends of the opening, 3 the middle of the back"),
    ("LINE23", "1 and 2 the ends of the line, 3 the rear of the middle arrow"),
    (
        "LINE24",
        "1 the tip, 2 the end of the straight part, 3 the end of the half circle (which withdraw may lack)",
    ),
    ("LINE25", "1 the tip, 2 the rear"),
    ("LINE26", "1 the middle, 2 and 3 the tips; of four points 1 and 4 are the tips, 2 and 3 the rears"),
    ("LINE27", "1 the middle of the circle, 2 a place on it, 3 the side of the bow, the last the tip"),
    ("LINE28", "1 the tip, 2 the rear"),
    ("LINE29", "1 the tip, 2 and 3 the ends of the bow"),
    ("LINE30", "1 the tip, 2 the rear, 3 how far aside the barbs reach"),
    ("LINE31", "1 the rear, 2 where the bow begins, 3 where it ends, 4 what is enveloped"),
    ("LINE32", "1 the rear, 2 the bend, 3 the tip"),
    ("LINE33", "1 the rear, 2 where the half circle begins, 3 where it ends"),
    (
        "POLYLINE1",
        "the middle of the lane, in order; the last how far off its sides are, unless `width` says it",
    ),
    (
        "AXIS1",
        "1 the tip, then the middle of the shaft back from it, the last a corner of the arrowhead; with `width` from start to tip and no last corner",
    ),
    (
        "AXIS2",
        "1 the tip, then the middle of the shaft back from it, the last a corner of the arrowhead; with `width` from start to tip and no last corner",
    ),
    ("AREA1", "the corners, in order"),
    ("AREA2", "the corners, in order"),
    ("AREA3", "the corners, in order"),
    ("AREA4", "the corners, in order"),
    ("AREA5", "1 and 2 the ends of the half circle, 3 the rear of the arrow"),
    ("AREA6", "1 the middle of the circle, 2 where it begins"),
    ("AREA7", "1 the tip, 2 and 3 the ends of the back line"),
    ("AREA8", "1 and 2 the ends of the back line, 3 and 4 the tips of the arrows from them"),
    ("AREA9", "the corners, in order"),
    ("AREA10", "3 to 6 corners, in order"),
    ("AREA11", "1 and 2 the ends of the bar, 3 the end of the stem"),
    ("AREA12", "1 and 2 the ends of the back line, 3 the tip of the longest arrow"),
    ("AREA13", "1 and 2 the ends of the half circle, which is on the right of the way between them"),
    ("AREA14", "1 the middle, the others a place on each circle"),
    ("AREA15", "1 the middle of the circle, 2 where it begins"),
    ("AREA16", "1 the middle of the circle, 2 where it begins"),
    ("AREA17", "1 and 2 the ends of the line, 3 the rear of the arrow"),
    ("AREA18", "1 the tip, 2 and 3 the ends of the half circle, 4 the rear"),
    ("AREA19", "1 the middle of the circle, 2 where it begins"),
    ("AREA20", "the corners, in order"),
    ("AREA21", "1 the start of both arrows, 2 and 3 their tips"),
    ("AREA23", "the corners, in order"),
    ("AREA24", "1 and 2 the ends of the bar, 3 the end of the stem"),
    ("AREA25", "1 and 2 the ends of the back line, 3 the tip of the longest arrow"),
    ("AREA26", "the corners of both rings, half of them each"),
    ("AREA27", "1 the tip, 2 where the half circle begins, 3 how far off the other side is"),
];

/// Rules of symbol set 25 whose graphics have numbers besides points.
pub const NUMBER_MEANINGS: [(&str, &str); 12] = [
    ("AREA22", "1 the middle; `distances` the radius"),
    ("ARC1", "1 the middle; `distances` the ranges, `azimuths` a left and a right one for each"),
    ("CIRCULAR1", "1 the middle; `distances` the radius"),
    ("CIRCULAR2", "1 the middle; `distances` the ranges"),
    ("CORRIDOR1", "the middle of the corridor, in order; `width` or `distances` its width"),
    ("ELLIPSE1", "1 the middle; `distances` the half axes, `azimuths` the direction of the first"),
    ("RECTANGULAR1", "1 and 2 the middles of two sides; `width` or `distances` the width between the others"),
    ("RECTANGULAR2", "1 the middle; `distances` length and width, `azimuths` the direction of the length"),
    ("RECTANGULAR3", "1 and 2 the middles of two sides; `width` or `distances` the width between the others"),
    ("POINT12", "1 and 2 the ends of the opening, 3 the middle of the back"),
    ("POINT17", "1 the middle; `distances` length and width, `azimuths` the direction of the length"),
    ("POINT18", "1 the radar; `distances` the near and the far range, `azimuths` the left and the right one"),
];

/// What the points of a kind are.
pub fn points_of(kind: &GraphicKind) -> &'static str {
    let rules = POINT_MEANINGS.iter().chain(&NUMBER_MEANINGS);
    let of_rule = |rule: &str| rules.clone().find(|(name, _)| *name == rule).map(|(_, meaning)| *meaning);
    match kind.shape {
        GraphicShape::Point => "1 the place",
        _ if kind.set != 25 && kind.is_area() => "the corners, in order",
        _ if kind.set != 25 => "the line, in order",
        _ => of_rule(kind.rule).unwrap_or("in the order of the draw rule"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphic::kind_table::GRAPHIC_KINDS;

    #[test]
    fn every_draw_rule_says_what_its_points_are() {
        for kind in GRAPHIC_KINDS {
            assert_ne!(points_of(kind), "in the order of the draw rule", "{}: {}", kind.word, kind.rule);
        }
        for (rule, _) in POINT_MEANINGS.iter().chain(&NUMBER_MEANINGS) {
            let is_used = GRAPHIC_KINDS.iter().any(|kind| kind.rule == *rule);
            assert!(is_used, "{rule} is the rule of a graphic");
        }
    }
}

//! Checks of a graphic's points before it is drawn.

use glam::DVec2;

use crate::graphic::axis::{center_line, head_m};
use crate::graphic::fields::GraphicFields;
use crate::graphic::kind::{GraphicKind, GraphicShape, MOST_POINTS};
use crate::graphic::rules::points_of;
use sandtable_geom::segment::crossing;

/// The length in meters below which a graphic cannot be distinguished from a point.
pub const SHORTEST_M: f64 = 1.0;

/// The most distances of a range fan.
pub const MOST_RANGES: usize = 32;

/// The parts of a graphic that are checked.
#[derive(Clone, Copy, Debug)]
pub struct PlacedGraphic<'a> {
    /// Its points in meters; of an area without repeating the first.
    pub points: &'a [DVec2],
    /// The stated width in meters.
    pub width_m: Option<f64>,
    /// Its texts and numbers.
    pub fields: &'a GraphicFields,
}

/// Why a graphic cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum GraphicError {
    #[error("{kind} has {found} points and needs {needed}")]
    PointCount { kind: &'static str, found: usize, needed: String, rule: &'static str },
    #[error("points {0} and {1} of the graphic are less than {SHORTEST_M} m apart")]
    SamePoints(usize, usize),
    #[error("the line crosses itself between points {} and {}, and {} and {}", .0 + 1, .0 + 2, .1 + 1, .1 + 2)]
    CrossesItself(usize, usize),
    #[error(
        "the last point gives the arrowhead its width, and lies beside point {before} and not beside point 1, the tip"
    )]
    AxisBackward { before: usize },
    #[error("the arrowhead is {length_m:.0} m long, and the first leg of the axis {leg_m:.0} m")]
    HeadTooLong { length_m: f64, leg_m: f64 },
    #[error("the last point gives the {what} no width")]
    NoWidth { what: &'static str },
    #[error("{kind} has no {what}")]
    Missing { kind: &'static str, what: &'static str },
    #[error("distances must rise, and {0} follows {1}")]
    FallingDistances(f64, f64),
    #[error("{found} azimuths do not make {needed} pairs, one for each distance")]
    AzimuthPairs { found: usize, needed: usize },
}

impl GraphicError {
    /// The remedy.
    pub fn help(&self) -> String {
        match self {
            Self::PointCount { rule, .. } => {
                format!("its points are: {rule} (scenes/SYMBOLS.md lists all rules)")
            }
            Self::AxisBackward { .. } => {
                "give the tip first, then the line back from it, then a corner of the arrowhead; or state `order = \"drawn\"` for \
                 a line from start to tip, or the `width` in place of the last point"
                    .into()
            }
            Self::SamePoints(..) => "remove one of them, or move it away".into(),
            Self::CrossesItself(..) => "give the points in the order in which they follow each other".into(),
            Self::HeadTooLong { .. } => {
                "move the last point nearer to the tip, or the second point away from it".into()
            }
            Self::NoWidth { .. } => "move it off the line, or state the `width`".into(),
            Self::Missing { what, .. } => format!("state its {what}"),
            Self::FallingDistances(..) => "sort them from the smallest to the largest".into(),
            Self::AzimuthPairs { .. } => {
                "give the left and the right azimuth of every distance, clockwise from north".into()
            }
        }
    }
}

/// Checks the points and numbers of a graphic.
///
/// # Errors
/// The first [`GraphicError`] found.
pub fn check(kind: &GraphicKind, graphic: &PlacedGraphic<'_>) -> Result<(), GraphicError> {
    let points = graphic.points;
    let [least, most] = kind.point_range(graphic.width_m.is_some());
    if !(least..=most).contains(&points.len()) {
        let needed = match (least, most) {
            (least, most) if least == most => least.to_string(),
            (least, most) if most + 1 >= MOST_POINTS => format!("at least {least}, and no more than {most}"),
            (least, most) => format!("{least} to {most}"),
        };
        let rule = points_of(kind);
        return Err(GraphicError::PointCount { kind: kind.word, found: points.len(), needed, rule });
    }
    if let Some(index) = points.windows(2).position(|pair| pair[0].distance(pair[1]) < SHORTEST_M) {
        return Err(GraphicError::SamePoints(index + 1, index + 2));
    }
    let center = match kind.shape {
        GraphicShape::Axis | GraphicShape::Wide => center_line(points, graphic.width_m),
        _ => points,
    };
    if matches!(
        kind.shape,
        GraphicShape::Line
            | GraphicShape::Area
            | GraphicShape::Axis
            | GraphicShape::Wide
            | GraphicShape::Corridor
    ) && let Some([one, other]) = self_crossing(center, kind.is_area())
    {
        return Err(GraphicError::CrossesItself(one, other));
    }
    check_width(kind, graphic)?;
    check_numbers(kind, graphic)
}

/// The first two legs of a line or ring that cross or touch without following each other.
fn self_crossing(points: &[DVec2], is_ring: bool) -> Option<[usize; 2]> {
    let count = points.len();
    let legs = if is_ring { count } else { count - 1 };
    let leg = |index: usize| (points[index], points[(index + 1) % count]);
    let follows = |one: usize, other: usize| other == one + 1 || (is_ring && one == 0 && other == legs - 1);
    (0..legs).find_map(|one| {
        (one + 1..legs)
            .find(|&other| !follows(one, other) && crossing(leg(one), leg(other)).is_some())
            .map(|other| [one, other])
    })
}

fn check_width(kind: &GraphicKind, graphic: &PlacedGraphic<'_>) -> Result<(), GraphicError> {
    let (points, width_m) = (graphic.points, graphic.width_m);
    match kind.shape {
        GraphicShape::Axis => {
            let center = center_line(points, width_m);
            let [tip, rear] = [center[0], center[center.len() - 1]];
            let corner = points[points.len() - 1];
            if width_m.is_none() && corner.distance(rear) < corner.distance(tip) {
                return Err(GraphicError::AxisBackward { before: center.len() });
            }
            let [length_m, half_m] = head_m(points, width_m);
            let leg_m = points[0].distance(points[1]);
            if half_m < SHORTEST_M || length_m <= 0.0 {
                return Err(GraphicError::NoWidth { what: "arrowhead" });
            }
            if length_m >= leg_m {
                return Err(GraphicError::HeadTooLong { length_m, leg_m });
            }
            Ok(())
        }
        GraphicShape::Wide if width_m.is_none() => {
            let last = points.len() - 1;
            let along = points[last - 1] - points[last - 2];
            let off_m = along.perp_dot(points[last] - points[last - 2]).abs() / along.length();
            if off_m < SHORTEST_M { Err(GraphicError::NoWidth { what: "lane" }) } else { Ok(()) }
        }
        GraphicShape::Corridor if width_m.is_none() && graphic.fields.distances_m.is_empty() => {
            Err(GraphicError::Missing { kind: kind.word, what: "`width`" })
        }
        _ => Ok(()),
    }
}

fn check_numbers(kind: &GraphicKind, graphic: &PlacedGraphic<'_>) -> Result<(), GraphicError> {
    let fields = graphic.fields;
    let needs_distance =
        matches!(kind.shape, GraphicShape::Circle | GraphicShape::Sector | GraphicShape::Ellipse);
    if needs_distance && fields.distances_m.is_empty() {
        return Err(GraphicError::Missing { kind: kind.word, what: "`distances`" });
    }
    if kind.shape == GraphicShape::Ellipse {
        return Ok(());
    }
    if let Some(pair) = fields.distances_m.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(GraphicError::FallingDistances(pair[1], pair[0]));
    }
    // The ground of a radar's search lies between two ranges and one pair of azimuths.
    let needed = if kind.rule == "POINT18" { 1 } else { fields.distances_m.len() };
    if kind.shape == GraphicShape::Sector && fields.azimuths_deg.len() != 2 * needed {
        return Err(GraphicError::AzimuthPairs { found: fields.azimuths_deg.len(), needed });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(word: &str, points: &[[f64; 2]], width_m: Option<f64>) -> Result<(), GraphicError> {
        let points: Vec<DVec2> = points.iter().map(|&at| DVec2::from(at)).collect();
        let fields = GraphicFields::default();
        let kind = GraphicKind::of_word(word).expect("a kind");
        check(kind, &PlacedGraphic { points: &points, width_m, fields: &fields })
    }

    #[test]
    fn too_few_too_many_and_too_near_points_are_named() {
        let error = checked("block", &[[0.0, 0.0], [100.0, 0.0]], None).expect_err("a T has three points");
        assert_eq!(error.to_string(), "block has 2 points and needs 3");
        assert!(
            error.help().contains("1 and 2 the ends of the bar, 3 the end of the stem"),
            "{}",
            error.help()
        );
        let error = checked("seize", &[[0.0, 0.0], [100.0, 0.0]], None).expect_err("three or four");
        assert_eq!(error.to_string(), "seize has 2 points and needs 3 to 4");
        let error = checked("phase_line", &[[0.0, 0.0], [100.0, 0.0], [100.5, 0.0]], None);
        assert_eq!(error, Err(GraphicError::SamePoints(2, 3)));
        assert_eq!(checked("phase_line", &[[0.0, 0.0], [100.0, 0.0]], None), Ok(()));
    }

    #[test]
    fn a_line_that_crosses_itself_is_refused_with_its_legs() {
        let bow = [[0.0, 0.0], [100.0, 100.0], [100.0, 0.0], [0.0, 100.0]];
        let error = checked("objective", &bow, None).expect_err("a bow tie");
        assert_eq!(error.to_string(), "the line crosses itself between points 1 and 2, and 3 and 4");
        assert!(checked("boundary", &bow, None).is_err());
        let square = [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]];
        assert_eq!(checked("objective", &square, None), Ok(()));
    }

    #[test]
    fn an_axis_has_a_head_shorter_than_its_first_leg() {
        let axis = [[1000.0, 0.0], [0.0, 0.0], [800.0, 200.0]];
        assert_eq!(checked("axis_main_attack", &axis, None), Ok(()));
        assert_eq!(checked("axis_main_attack", &axis[..2], Some(300.0)), Ok(()));
        let long = [[1000.0, 0.0], [900.0, 0.0], [0.0, 0.0], [850.0, 200.0]];
        assert!(matches!(checked("axis_main_attack", &long, None), Err(GraphicError::HeadTooLong { .. })));
        let backward = [[0.0, 0.0], [1000.0, 0.0], [800.0, 200.0]];
        let error = checked("axis_main_attack", &backward, None).expect_err("the tip comes first");
        assert!(error.to_string().contains("beside point 2 and not beside point 1, the tip"), "{error}");
        assert!(error.help().contains("tip first") && error.help().contains("order"), "{}", error.help());
        let thin = [[1000.0, 0.0], [0.0, 0.0], [800.0, 0.0]];
        assert!(matches!(checked("axis_main_attack", &thin, None), Err(GraphicError::NoWidth { .. })));
    }

    #[test]
    fn a_circle_needs_its_radius_and_a_sector_its_azimuths() {
        let error = checked("circular_target", &[[0.0, 0.0]], None).expect_err("no radius");
        assert_eq!(error.to_string(), "circular_target has no `distances`");
        let fields = GraphicFields { distances_m: vec![500.0, 1000.0], ..GraphicFields::default() };
        let kind = GraphicKind::of_word("range_fan_sector").expect("a kind");
        let graphic = PlacedGraphic { points: &[DVec2::ZERO], width_m: None, fields: &fields };
        assert!(matches!(check(kind, &graphic), Err(GraphicError::AzimuthPairs { found: 0, needed: 2 })));
    }
}

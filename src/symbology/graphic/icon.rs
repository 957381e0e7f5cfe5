//! Points of symbol set 25: icons that stand up on the picture about the place they mark, with their texts beside them.
//!
//! An icon is written in the language of [`crate::drawing`], in a box of 200 × 200 units whose middle (100, 100) is the place.
//! `dash` before a statement dashes it; `@name` is a part that several icons share.

use glam::{DVec2, Vec2};

use crate::drawing::{PathStep, SymbolMark, parse};
use crate::frame::FrameShape;
use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::fields::GraphicFields;
use crate::graphic::kind::GraphicKind;
use crate::graphic::letters::letter_lines;
use crate::graphic::plane::arrowhead;

/// Units of an icon's box in a text height: a box of three letters is as wide as three letters beside it.
const UNITS_PER_EM: f64 = 32.0;

/// The place of an icon in its box.
const ANCHOR: DVec2 = DVec2::splat(100.0);

/// Pieces of a curve.
const CURVE_STEPS: u32 = 8;

/// Parts that several icons share.
const PARTS: [(&str, &str); 18] = [
    // A box that ends in a point at the place.
    ("pointer", "M60,45 L140,45 M100,100 L60,45 L60,-60 L140,-60 L140,45 Z"),
    ("supply", "M60,30 L140,30 M60,45 L140,45 M100,100 L60,45 L60,-60 L140,-60 L140,45 Z"),
    // An event: a triangle below a radiant top.
    (
        "event",
        "M110,60 Q112,28 80,20 M90,60 Q88,28 120,20 M100,100 L40,-10 L160,-10 Z; fill circle 80,27.5 7.5; fill circle 120,27.5 7.5",
    ),
    ("circle", "circle 100,100 50"),
    ("dot", "fill circle 100,100 15"),
    ("cross", "M50,100 L150,100 M100,50 L100,150"),
    ("saltire", "M160,160 L40,40 M40,160 L160,40"),
    ("box", "M160,160 L40,160 L40,40 L160,40 Z"),
    ("fix", "M50,150 L150,50 M50,50 L150,150 M100,50 L100,150"),
    ("outpost", "M100,45 L147.6,127.5 L52.4,127.5 Z"),
    // Stations in the air, on and under the sea.
    ("aisle", "M140,165 L140,35 M60,35 L60,165"),
    ("sea", "M30,60 L170,60 M30,140 L170,140"),
    ("depth", "M30,140 L170,140; dash M30,60 L170,60"),
    ("buoy", "M100,60 L100,25 L110,35 L110,-10; circle 100,100 40"),
    ("contact", "M65,0 L135,0 M100,80 L100,0; fill M100,100 L55,80 L145,80 Z"),
    ("mine", "fill circle 100,100 29"),
    (
        "plane",
        "fill M100,81 L102.5,84 L103,98 L131,128 L131,132.5 L102.5,114 L102.5,138 L109,144 L109,148 L100,145 L91,148 L91,144 \
         L97.5,138 L97.5,114 L69,132.5 L69,128 L97,98 L97.5,84 Z",
    ),
    ("rotor", "fill M65,80 L135,120 L135,80 L65,120 Z"),
];

/// An amplifier of an icon: the letters of its field, its place in the box, and on which side of the place it is.
type IconText = (&'static str, [f64; 2], [f64; 2]);

const CENTER: [f64; 2] = [0.0, 0.0];
const RIGHT: [f64; 2] = [1.0, 0.0];
const LEFT: [f64; 2] = [-1.0, 0.0];
const ABOVE: [f64; 2] = [0.0, 1.0];
const BELOW: [f64; 2] = [0.0, -1.0];

/// The amplifiers of points in a box with a pointed foot (POINT1).
const POINTER_TEXTS: &[IconText] = &[
    ("H", [100.0, -68.0], ABOVE),
    ("T", [147.0, -30.0], RIGHT),
    ("N", [147.0, 45.0], RIGHT),
    ("T1", [100.0, 28.0], CENTER),
    ("W", [53.0, -30.0], LEFT),
    ("W1", [53.0, 10.0], LEFT),
];
/// Of supply points, whose foot is higher.
const SUPPLY_TEXTS: &[IconText] = &[
    ("H", [100.0, -68.0], ABOVE),
    ("T", [147.0, -30.0], RIGHT),
    ("N", [147.0, 45.0], RIGHT),
    ("T1", [100.0, 12.0], CENTER),
    ("W", [53.0, -30.0], LEFT),
    ("W1", [53.0, 10.0], LEFT),
];
/// Of CBRN events (POINT7).
const EVENT_TEXTS: &[IconText] = &[
    ("C", [100.0, -16.0], ABOVE),
    ("Y", [100.0, 112.0], BELOW),
    ("H", [165.0, 0.0], RIGHT),
    ("N", [150.0, 60.0], RIGHT),
    ("W", [35.0, 0.0], LEFT),
    ("T", [50.0, 60.0], LEFT),
];
/// Of points with a name inside.
const INNER_TEXTS: &[IconText] = &[("T", [100.0, 100.0], CENTER)];
/// Of air control points.
const LOWER_TEXTS: &[IconText] = &[("T", [100.0, 118.0], CENTER)];
/// Of targets.
const TARGET_TEXTS: &[IconText] = &[
    ("AP", [108.0, 72.0], RIGHT),
    ("T", [108.0, 72.0], RIGHT),
    ("H", [108.0, 130.0], RIGHT),
    ("X", [92.0, 130.0], LEFT),
];
/// Of known points and fire support stations, whose letters stand at their right.
const NAMED_TEXTS: &[IconText] =
    &[("T", [180.0, 100.0], RIGHT), ("W", [45.0, 85.0], LEFT), ("W1", [45.0, 115.0], LEFT)];
/// Of towers.
const TOWER_TEXTS: &[IconText] = &[("X", [118.0, 50.0], RIGHT)];
/// Of minefields.
const FIELD_TEXTS: &[IconText] =
    &[("H", [100.0, 58.0], ABOVE), ("W", [100.0, 142.0], BELOW), ("N", [180.0, 100.0], RIGHT)];
/// Of all others.
const SIDE_TEXTS: &[IconText] = &[
    ("T", [178.0, 80.0], RIGHT),
    ("H", [178.0, 115.0], RIGHT),
    ("X", [178.0, 115.0], RIGHT),
    ("N", [178.0, 150.0], RIGHT),
    ("W", [22.0, 80.0], LEFT),
    ("W1", [22.0, 115.0], LEFT),
];

fn texts_of(kind: &GraphicKind) -> &'static [IconText] {
    let begins = |part: &str| kind.icon.starts_with(part);
    match kind.code {
        "130500" | "130700" => INNER_TEXTS,
        "180100" | "180200" => LOWER_TEXTS,
        "160300" | "240601" | "240602" => TARGET_TEXTS,
        "240900" | "250600" => NAMED_TEXTS,
        "270701" => FIELD_TEXTS,
        "282001" | "282002" => TOWER_TEXTS,
        _ if begins("@pointer") => POINTER_TEXTS,
        _ if begins("@supply") => SUPPLY_TEXTS,
        _ if begins("@event") => EVENT_TEXTS,
        _ => SIDE_TEXTS,
    }
}

/// The box of an icon on the picture.
struct IconPaper {
    at: DVec2,
    right: DVec2,
    up: DVec2,
}

impl IconPaper {
    fn new(input: &GraphicInput<'_>) -> Self {
        let unit_m = input.em_m / UNITS_PER_EM;
        let right = -input.up.normalize_or(DVec2::Y).perp() * unit_m;
        Self { at: input.points[0], right, up: input.up * unit_m }
    }

    /// A place of the box, X right and Y down.
    fn place(&self, at: DVec2) -> DVec2 {
        let off = at - ANCHOR;
        self.at + self.right * off.x - self.up * off.y
    }

    fn way(&self, [x, y]: [f64; 2]) -> DVec2 {
        self.right.normalize_or_zero() * x + self.up.normalize_or_zero() * y
    }
}

/// Draws the icon of a kind at its point, and its texts beside it.
pub fn icon(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let paper = IconPaper::new(input);
    for (statement, is_dashed) in statements(kind.icon) {
        add(statement, is_dashed, &paper, drawing);
    }
    if let Some(direction_deg) = input.fields.direction_deg.filter(|_| kind.shows("Q")) {
        movement(direction_deg, input, drawing);
    }
    for &(letters, place, side) in texts_of(kind).iter().filter(|(letters, ..)| kind.shows(letters)) {
        let text = field_text(input.fields, letters);
        drawing.text_beside(text, paper.place(DVec2::from(place)), paper.way(side));
    }
}

/// The arrow of the direction in which an event moves, on the ground from its place.
fn movement(direction_deg: f64, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    /// The length of the arrow, and its head, in text heights.
    const ARROW_EM: [f64; 3] = [3.0, 0.8, 0.4];
    let angle = direction_deg.to_radians();
    let toward = DVec2::new(libm::sin(angle), libm::cos(angle));
    let [length, head, half] = ARROW_EM.map(|size| size * input.em_m);
    let tip = input.points[0] + toward * length;
    drawing.line([input.points[0], tip]);
    drawing.line(arrowhead(tip, toward, head, half));
}

/// The statements of an icon with those of its parts, and whether each is dashed.
pub(crate) fn statements(icon: &'static str) -> impl Iterator<Item = (&'static str, bool)> {
    let whole = icon.split(';').map(str::trim);
    let parts = whole
        .flat_map(|statement| statement.strip_prefix('@').and_then(part).unwrap_or(statement).split(';'));
    parts.map(str::trim).map(|statement| match statement.strip_prefix("dash ") {
        Some(rest) => (rest, true),
        None => (statement, false),
    })
}

fn part(name: &str) -> Option<&'static str> {
    PARTS.iter().find(|(part, _)| *part == name).map(|(_, drawing)| *drawing)
}

/// The text of a field by its letters.
fn field_text(fields: &GraphicFields, letters: &str) -> String {
    match letters {
        "T" => fields.designation.clone(),
        "T1" => fields.designation_2.clone(),
        "H" => fields.further.clone(),
        "N" => fields.hostile.clone(),
        "AP" => fields.target.clone(),
        "W" => fields.from.clone(),
        "W1" => fields.until.clone(),
        "C" => fields.quantity.clone(),
        "Y" => fields.location.clone(),
        "V" => fields.equipment.clone(),
        "X" => fields.heights.join("\u{2013}"),
        _ => String::new(),
    }
}

/// Adds one statement of an icon.
fn add(statement: &str, is_dashed: bool, paper: &IconPaper, drawing: &mut GraphicDrawing) {
    // The shape of a frame matters to no icon of this set: a test parses them all.
    for mark in parse(statement, FrameShape::Rectangle).unwrap_or_default() {
        match mark {
            SymbolMark::Text { text, center, size, .. } => {
                let center = center.as_dvec2();
                for line in letter_lines(&text, f64::from(size)) {
                    let flipped = line.into_iter().map(|at| paper.place(center + DVec2::new(at.x, -at.y)));
                    drawing.line(flipped.collect::<Vec<_>>());
                }
            }
            SymbolMark::Shape { steps, fill, .. } => {
                for line in flattened(&steps) {
                    let line: Vec<DVec2> = line.into_iter().map(|at| paper.place(at)).collect();
                    match (fill.is_some(), is_dashed) {
                        (true, _) => drawing.filled(opened(line)),
                        (false, true) => drawing.dashed(line),
                        (false, false) => drawing.line(line),
                    }
                }
            }
        }
    }
}

/// A closed line without its last point.
fn opened(mut line: Vec<DVec2>) -> Vec<DVec2> {
    if line.len() > 2 && line.first() == line.last() {
        line.pop();
    }
    line
}

/// The lines of a path; of a closed one the first point is repeated.
fn flattened(steps: &[PathStep]) -> Vec<Vec<DVec2>> {
    let (mut lines, mut line): (Vec<Vec<DVec2>>, Vec<DVec2>) = (Vec::new(), Vec::new());
    let curve = |line: &mut Vec<DVec2>, [a, b, end]: [Vec2; 3]| {
        let Some(&start) = line.last() else { return };
        let [a, b, end] = [a, b, end].map(Vec2::as_dvec2);
        line.extend((1..=CURVE_STEPS).map(|step| {
            let t = f64::from(step) / f64::from(CURVE_STEPS);
            let u = 1.0 - t;
            start * (u * u * u) + a * (3.0 * u * u * t) + b * (3.0 * u * t * t) + end * (t * t * t)
        }));
    };
    for &step in steps {
        match step {
            PathStep::Move(to) => {
                lines.push(std::mem::replace(&mut line, vec![to.as_dvec2()]));
            }
            PathStep::Line(to) => line.push(to.as_dvec2()),
            PathStep::Quad(control, end) => {
                let start = line.last().map_or(end, |at| at.as_vec2());
                let third = |from: Vec2| from + (control - from) * (2.0 / 3.0);
                curve(&mut line, [third(start), third(end), end]);
            }
            PathStep::Cubic(a, b, end) => curve(&mut line, [a, b, end]),
            PathStep::Close => line.extend(line.first().copied()),
        }
    }
    lines.push(line);
    lines.retain(|line| line.len() > 1);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphic::point_table::POINT_KINDS;

    #[test]
    fn every_statement_of_every_icon_is_a_drawing() {
        let parts = PARTS.iter().map(|(name, drawing)| (*name, *drawing));
        for (word, icon) in POINT_KINDS.iter().map(|kind| (kind.word, kind.icon)).chain(parts) {
            for statement in icon.split(';').map(str::trim) {
                let known = match statement.strip_prefix('@') {
                    Some(name) => part(name).is_some(),
                    None => {
                        let drawn = statement.strip_prefix("dash ").unwrap_or(statement);
                        parse(drawn, FrameShape::Rectangle).is_some()
                    }
                };
                assert!(known, "{word}: {statement}");
            }
        }
    }

    #[test]
    fn an_icon_stands_upright_with_its_foot_at_its_point() {
        let fields = GraphicFields { designation: "7".into(), ..GraphicFields::default() };
        let kind = GraphicKind::of_word("checkpoint").expect("a kind");
        let points = [DVec2::new(1000.0, 500.0)];
        let input =
            GraphicInput { points: &points, em_m: 32.0, up: DVec2::X * 2.0, width_m: None, fields: &fields };
        let drawing = kind.draw(&input);
        let lines = drawing.strokes.iter().flat_map(|stroke| &stroke.points);
        let foot = lines.clone().min_by(|a, b| a.x.total_cmp(&b.x)).expect("lines");
        assert!(foot.distance(points[0]) < 1e-9, "{foot}");
        let top = lines.map(|at| at.x).fold(0.0, f64::max);
        assert!((top - 1320.0).abs() < 1e-9, "as high as 160 units, twice: {top}");
        assert_eq!(drawing.texts[0].text, "7");
        assert!(drawing.texts[0].at.y < 500.0, "at the right of what is up");
    }

    /// Icons as another library draws them, without letters, in the same box; `tests/tools/points_oracle.mjs` makes it.
    const TABLE: &str = include_str!("../../../tests/symbology/points.txt");

    /// The lines of an icon without its letters, in its box.
    fn figure(icon: &'static str) -> Vec<Vec<DVec2>> {
        let parsed = |(statement, _)| parse(statement, FrameShape::Rectangle).unwrap_or_default();
        let marks = statements(icon).flat_map(parsed);
        let lines = marks.flat_map(|mark| match mark {
            SymbolMark::Shape { steps, .. } => flattened(&steps),
            SymbolMark::Text { .. } => Vec::new(),
        });
        lines.collect()
    }

    /// How far a place on `from` is off `to` at most.
    fn farthest(from: &[Vec<DVec2>], to: &[Vec<DVec2>]) -> f64 {
        let legs: Vec<(DVec2, DVec2)> = to
            .iter()
            .flat_map(|line| line.windows(2).map(|leg| (leg[0], leg[1])))
            .filter(|leg| leg.0 != leg.1)
            .collect();
        let places = from
            .iter()
            .flat_map(|line| line.windows(2))
            .flat_map(|leg| (0..=8).map(move |step| leg[0].lerp(leg[1], f64::from(step) / 8.0)));
        let off = |at: DVec2| {
            let squares = legs.iter().map(|&leg| sandtable_geom::segment::distance_squared(leg, at));
            squares.fold(f64::INFINITY, f64::min).sqrt()
        };
        places.map(off).fold(0.0, f64::max)
    }

    #[test]
    fn icons_lie_within_three_percent_of_their_box_on_those_of_another_library() {
        /// Of a box of 200 units.
        const MOST: f64 = 6.0;
        let (mut wrong, mut compared) = (Vec::new(), 0);
        for block in TABLE.split("point ").skip(1) {
            let mut lines = block.lines();
            let code = lines.next().expect("a code");
            let point = |pair: &str| {
                let (x, y) = pair.split_once(' ').expect("x and y");
                DVec2::new(x.parse().expect("a number"), y.parse().expect("a number"))
            };
            let theirs: Vec<Vec<DVec2>> = lines
                .filter_map(|line| line.strip_prefix("line "))
                .map(|line| line.split(',').map(point).collect())
                .collect();
            let kind = GraphicKind::of_code(25, code).expect("a kind");
            // Its fish leaves the box, and its minefield is empty until a modifier says which mines.
            if matches!(kind.word, "marine_life" | "static_minefield") {
                continue;
            }
            let ours = figure(kind.icon);
            let off = farthest(&ours, &theirs).max(farthest(&theirs, &ours));
            compared += 1;
            if off > MOST {
                wrong.push(format!("{code} {}: {off:.1}", kind.word));
            }
        }
        assert!(wrong.is_empty(), "{compared}: {wrong:#?}");
        assert!(compared > 250, "{compared}");
    }
}

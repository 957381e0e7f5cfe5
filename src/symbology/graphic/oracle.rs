//! Holds drawn graphics to those of an independent renderer, mil-sym-ts 2.10.4, whose lines
//! `tests/symbology/graphics.txt` records; `tests/tools/graphics_oracle.mjs` makes that table.

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput, GraphicStroke, StrokeDash};
use crate::graphic::fields::GraphicFields;
use crate::graphic::kind::GraphicKind;
use sandtable_geom::segment;

const TABLE: &str = include_str!("../../../tests/symbology/graphics.txt");

/// The text height of the recorded graphics: twelve pixels of ten meters.
const EM_M: f64 = 120.0;

/// Lines sampled this densely, meters.
const STEP_M: f64 = 10.0;

/// Lines that stand for one place: the renderer's rounding of it, meters.
const LEAST_M: f64 = 25.0;

/// Kinds whose teeth both renderers space as they choose: their number is compared, not their places.
fn tooth_count(kind: &GraphicKind) -> Option<ToothCount> {
    const BUMPS: &str = "forward_line_of_troops fortified_line fortified_area strong_point obstacle_line obstacle_belt \
        obstacle_zone obstacle_free_zone obstacle_restricted_zone encirclement ditch_under_construction upper_cold_front \
        upper_warm_front upper_occluded_front upper_stationary_front undercast_limit anchorage_line";
    const MARKS: &str = "cold_front cold_frontogenesis cold_frontolysis warm_front warm_frontogenesis warm_frontolysis \
        occluded_front occluded_frontolysis stationary_front stationary_frontogenesis stationary_frontolysis";
    const SHORT: &str = "wire single_fence double_apron_fence";
    let names = |list: &str| list.split_whitespace().any(|word| word == kind.word);
    match () {
        () if names(BUMPS) => Some(ToothCount::Bumps),
        () if names(MARKS) => Some(ToothCount::Marks),
        () if names(SHORT) => Some(ToothCount::ShortLines),
        () => None,
    }
}

#[derive(Clone, Copy, PartialEq)]
enum ToothCount {
    /// How often lines leave the one through the points.
    Bumps,
    /// Crosses of two short lines.
    ShortLines,
    /// Filled figures larger than a dot.
    Marks,
}

/// A recorded graphic.
struct Recorded {
    kind: &'static GraphicKind,
    points: Vec<DVec2>,
    lines: Vec<Vec<DVec2>>,
    rings: Vec<Vec<DVec2>>,
    texts: Vec<(DVec2, &'static str)>,
    /// The words of its texts where all fields are stated.
    all_words: Vec<&'static str>,
}

fn point(pair: &str) -> DVec2 {
    let mut numbers = pair.split_whitespace().map(|number| number.parse().expect("a number"));
    DVec2::new(numbers.next().expect("x"), numbers.next().expect("y"))
}

fn recorded() -> Vec<Recorded> {
    let mut found: Vec<Recorded> = Vec::new();
    for line in TABLE.lines().filter(|line| !line.starts_with('#')) {
        let (what, rest) = line.split_once(' ').expect("a word and values");
        if what == "graphic" {
            let words: Vec<&str> = rest.split(' ').collect();
            let kind = GraphicKind::of_code(words[0].parse().expect("a set"), words[1]);
            let kind = kind.unwrap_or_else(|| panic!("{rest} is drawn"));
            found.push(Recorded {
                kind,
                points: Vec::new(),
                lines: Vec::new(),
                rings: Vec::new(),
                texts: Vec::new(),
                all_words: Vec::new(),
            });
            continue;
        }
        let graphic = found.last_mut().expect("a graphic");
        match what {
            "points" => graphic.points = rest.split(',').map(point).collect(),
            "fields" => graphic.all_words = rest.split_whitespace().collect(),
            "text" => {
                let place = rest.match_indices(' ').nth(1).expect("x, y and a text").0;
                graphic.texts.push((point(&rest[..place]), &rest[place + 1..]));
            }
            "ring" => {
                let ring: Vec<DVec2> = rest.split(',').map(point).collect();
                graphic.rings.push(ring.clone());
                graphic.lines.push(ring);
            }
            _ => graphic.lines.push(rest.split(',').map(point).collect()),
        }
    }
    found
}

fn drawn(recorded: &Recorded) -> GraphicDrawing {
    drawn_with(recorded, GraphicFields { designation: "RED".into(), ..GraphicFields::default() })
}

/// The drawing of a recorded graphic with texts, and the numbers of its draw rule.
fn drawn_with(recorded: &Recorded, texts: GraphicFields) -> GraphicDrawing {
    let (distances_m, azimuths_deg) = match recorded.kind.rule {
        "CORRIDOR1" => (vec![800.0], vec![]),
        "RECTANGULAR1" | "RECTANGULAR3" => (vec![1200.0], vec![]),
        "RECTANGULAR2" => (vec![2400.0, 1200.0], vec![30.0]),
        "ELLIPSE1" => (vec![1500.0, 700.0], vec![60.0]),
        "POINT17" => (vec![600.0, 1500.0], vec![40.0]),
        "POINT18" => (vec![600.0, 1500.0], vec![40.0, 90.0]),
        "ARC1" => (vec![1000.0, 2000.0], vec![20.0, 90.0, 30.0, 80.0]),
        "CIRCULAR2" => (vec![500.0, 1000.0, 2000.0], vec![]),
        _ => (vec![1000.0], vec![]),
    };
    let fields = GraphicFields { distances_m, azimuths_deg, ..texts };
    let points = &recorded.points;
    let input = GraphicInput { points, em_m: EM_M, up: DVec2::Y, width_m: None, fields: &fields };
    recorded.kind.draw(&input)
}

fn length_m(line: &[DVec2]) -> f64 {
    line.windows(2).map(|leg| leg[0].distance(leg[1])).sum()
}

/// The greatest distance of a place on `from` from the lines `to`; places near `ignored` do not count.
fn farthest_m(from: &[Vec<DVec2>], to: &[Vec<DVec2>], ignored: &[DVec2]) -> f64 {
    let legs: Vec<(DVec2, DVec2)> = to
        .iter()
        .flat_map(|line| line.windows(2))
        .filter(|leg| leg[0] != leg[1])
        .map(|leg| (leg[0], leg[1]))
        .collect();
    let mut farthest: f64 = 0.0;
    for leg in from.iter().flat_map(|line| line.windows(2)) {
        let steps = (leg[0].distance(leg[1]) / STEP_M).ceil().max(1.0);
        for step in 0..=steps as u32 {
            let at = leg[0].lerp(leg[1], f64::from(step) / steps);
            if ignored.iter().any(|gap| gap.distance(at) < EM_M) {
                continue;
            }
            let square =
                legs.iter().map(|&leg| segment::distance_squared(leg, at)).fold(f64::INFINITY, f64::min);
            farthest = farthest.max(square.sqrt());
        }
    }
    farthest
}

fn strokes(drawing: &GraphicDrawing) -> Vec<Vec<DVec2>> {
    let lines = drawing.strokes.iter().filter(|stroke| !is_hatching(stroke));
    lines.map(|stroke| stroke.points.clone()).collect()
}

/// Hatching is a matter of the pen: the other renderer fills areas with a pattern.
fn is_hatching(stroke: &GraphicStroke) -> bool {
    stroke.dash == StrokeDash::Hatch && stroke.points.len() == 2
}

/// Filled figures that are longer around than a dot.
fn marks<'a>(rings: impl Iterator<Item = &'a [DVec2]>) -> usize {
    rings.filter(|ring| length_m(ring) > 2.2 * EM_M).count()
}

/// Teeth on lines: runs of places that are off the line through the graphic's points.
fn teeth(lines: &[Vec<DVec2>], recorded: &Recorded, count: ToothCount) -> usize {
    if count == ToothCount::ShortLines {
        return lines.iter().filter(|line| length_m(line) < 4.0 * EM_M).count() / 2;
    }
    let mut base = recorded.points.clone();
    if recorded.kind.is_area() {
        base.push(base[0]);
    }
    let legs: Vec<(DVec2, DVec2)> = base.windows(2).map(|leg| (leg[0], leg[1])).collect();
    let off_m = |at: DVec2| {
        legs.iter().map(|&leg| segment::distance_squared(leg, at)).fold(f64::INFINITY, f64::min).sqrt()
    };
    /// Places farther off belong to a tooth.
    const TOOTH_M: f64 = 40.0;
    let mut count = 0;
    for line in lines {
        let mut was_off = false;
        for leg in line.windows(2) {
            let steps = (leg[0].distance(leg[1]) / STEP_M).ceil().max(1.0);
            for step in 0..=steps as u32 {
                let is_off = off_m(leg[0].lerp(leg[1], f64::from(step) / steps)) > TOOTH_M;
                count += usize::from(is_off && !was_off);
                was_off = is_off;
            }
        }
    }
    count
}

#[test]
fn lines_without_teeth_lie_within_two_percent_of_the_graphic_of_another_renderer() {
    let (mut wrong, mut compared, mut worst) = (Vec::new(), 0, (0.0, ""));
    for recorded in recorded().iter().filter(|recorded| tooth_count(recorded.kind).is_none()) {
        let word = recorded.kind.word;
        if word == "leading_line" && recorded.lines.len() == 1 {
            // The other renderer leaves out its second half where it turns up.
            continue;
        }
        let drawing = drawn(recorded);
        let ours = strokes(&drawing);
        let gaps: Vec<DVec2> = drawing.texts.iter().map(|text| text.at).collect();
        // The length of a graphic is that of its lines in the other renderer.
        let length_m: f64 = recorded.lines.iter().map(|line| length_m(line)).sum();
        let off_m = farthest_m(&ours, &recorded.lines, &[]).max(farthest_m(&recorded.lines, &ours, &gaps));
        let share = off_m / length_m;
        compared += 1;
        if share > worst.0 {
            worst = (share, word);
        }
        if share > 0.02 && off_m > LEAST_M {
            wrong.push(format!("{} {word}: {off_m:.0} m of {length_m:.0} m", recorded.kind.code));
        }
    }
    println!("{compared} graphics, worst {:.2} % ({})", 100.0 * worst.0, worst.1);
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(compared >= 1220, "{compared}");
}

#[test]
fn lines_with_teeth_have_as_many_as_those_of_another_renderer_but_one() {
    let (mut wrong, mut compared) = (Vec::new(), 0);
    for recorded in recorded() {
        let Some(how) = tooth_count(recorded.kind) else { continue };
        let word = recorded.kind.word;
        let drawing = drawn(&recorded);
        let [ours, theirs] = if how == ToothCount::Marks {
            let fills = drawing.fills.iter().map(|fill| fill.ring.as_slice());
            [marks(fills), marks(recorded.rings.iter().map(Vec::as_slice))]
        } else {
            [strokes(&drawing), recorded.lines.clone()].map(|lines| teeth(&lines, &recorded, how))
        };
        compared += 1;
        // The other renderer leaves the last pair out of an occluded front's last leg, and where the marks of an upper front
        // touch it counts several as one.
        let theirs = if word == "occluded_front" { theirs + 2 } else { theirs };
        if matches!(word, "upper_occluded_front" | "upper_stationary_front") {
            continue;
        }
        if ours.abs_diff(theirs) > 1 {
            wrong.push(format!("{word}: {ours} for {theirs}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(compared >= 75, "{compared}");
}

#[test]
fn graphics_show_the_letters_that_those_of_another_renderer_show() {
    let (mut wrong, mut compared) = (Vec::new(), 0);
    for recorded in recorded() {
        let drawing = drawn(&recorded);
        let ours: Vec<&str> =
            drawing.texts.iter().flat_map(|text| text.text.split([' ', '-', '\n'])).collect();
        for (_, text) in &recorded.texts {
            // Titles of numbers are a matter of wording; 2525E writes BL for the B of a bridgehead line.
            const TITLES: [&str; 5] = [":", "RG", "ALT", "GRID", "EFF"];
            let is_azimuth = recorded.kind.rule == "ARC1";
            let is_titled = is_azimuth || TITLES.iter().any(|title| text.contains(title));
            let words = text.split([' ', '-']).filter(|word| !word.is_empty() && !is_titled && *word != "B");
            for word in words {
                compared += 1;
                if !ours.contains(&word) {
                    wrong.push(format!(
                        "{} {}: {word} of {text}; ours {ours:?}",
                        recorded.kind.code, recorded.kind.word
                    ));
                }
            }
        }
    }
    wrong.dedup();
    assert!(wrong.is_empty(), "{compared}: {wrong:#?}");
    assert!(compared > 500, "{compared}");
}

#[test]
fn graphics_show_the_fields_that_those_of_another_renderer_show() {
    let (mut wrong, mut compared) = (Vec::new(), 0);
    for recorded in recorded().iter().filter(|recorded| !recorded.all_words.is_empty()) {
        let texts = GraphicFields {
            designation: "FT".into(),
            designation_2: "FT1".into(),
            further: "FH".into(),
            hostile: "ENY".into(),
            from: "FW".into(),
            until: "FW1".into(),
            target: "FAP".into(),
            country: "FAS".into(),
            equipment: "FV".into(),
            ..GraphicFields::default()
        };
        let drawing = drawn_with(recorded, texts);
        let separators = [' ', '\n', '(', ')', '\u{2013}'];
        let ours: Vec<&str> = drawing.texts.iter().flat_map(|text| text.text.split(separators)).collect();
        let theirs = recorded.all_words.iter().flat_map(|word| word.split(separators));
        for word in theirs.filter(|word| word.starts_with('F') && word.len() < 5 || *word == "ENY") {
            const NAMES: [&str; 10] =
                ["FLOT", "FEBA", "FCL", "FFA", "FSA", "FPF", "FSCL", "FREE", "FARP", "FEZ"];
            if NAMES.contains(&word) {
                continue;
            }
            compared += 1;
            if !ours.contains(&word) {
                wrong.push(format!("{} {}: {word}; ours {ours:?}", recorded.kind.code, recorded.kind.word));
            }
        }
    }
    wrong.dedup();
    assert!(wrong.is_empty(), "{compared}: {wrong:#?}");
    assert!(compared > 300, "{compared}");
}

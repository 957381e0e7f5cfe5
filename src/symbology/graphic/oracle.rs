//! Holds drawn graphics to those of an independent renderer, mil-sym-ts 2.10.4, whose lines
//! `tests/symbology/graphics.txt` records; `tests/tools/graphics_oracle.mjs` makes that table.

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::fields::GraphicFields;
use crate::graphic::kind::GraphicKind;
use sandtable_geom::segment;

const TABLE: &str = include_str!("../../../tests/symbology/graphics.txt");

/// The text height of the recorded graphics: twelve pixels of ten meters.
const EM_M: f64 = 120.0;

/// Lines sampled this densely, meters.
const STEP_M: f64 = 10.0;

/// Kinds whose teeth both renderers space as they choose: their number is compared, not their places.
const TOOTHED: [(&str, ToothCount); 11] = [
    ("forward_line_of_troops", ToothCount::Bumps),
    ("fortified_line", ToothCount::Bumps),
    ("fortified_area", ToothCount::Bumps),
    ("strong_point", ToothCount::Bumps),
    ("obstacle_line", ToothCount::Bumps),
    ("obstacle_belt", ToothCount::Bumps),
    ("obstacle_free_zone", ToothCount::Bumps),
    ("ditch_under_construction", ToothCount::Bumps),
    ("wire", ToothCount::ShortLines),
    ("single_fence", ToothCount::ShortLines),
    ("double_apron_fence", ToothCount::ShortLines),
];

#[derive(Clone, Copy, PartialEq)]
enum ToothCount {
    /// How often lines leave the one through the points.
    Bumps,
    /// Crosses of two short lines.
    ShortLines,
}

/// A recorded graphic.
struct Recorded {
    kind: &'static GraphicKind,
    points: Vec<DVec2>,
    lines: Vec<Vec<DVec2>>,
}

fn recorded() -> Vec<Recorded> {
    let points = |text: &str| -> Vec<DVec2> {
        let point = |pair: &str| {
            let numbers: Vec<f64> =
                pair.split_whitespace().map(|number| number.parse().expect("a number")).collect();
            DVec2::new(numbers[0], numbers[1])
        };
        text.split(',').map(point).collect()
    };
    let mut found: Vec<Recorded> = Vec::new();
    for line in TABLE.lines().filter(|line| !line.starts_with('#')) {
        let (what, rest) = line.split_once(' ').expect("a word and values");
        match what {
            "graphic" => {
                let word = rest.split(' ').next().expect("a word");
                let kind = GraphicKind::of_word(word).unwrap_or_else(|| panic!("{word} is drawn"));
                found.push(Recorded { kind, points: Vec::new(), lines: Vec::new() });
            }
            "points" => found.last_mut().expect("a graphic").points = points(rest),
            _ => found.last_mut().expect("a graphic").lines.push(points(rest)),
        }
    }
    found
}

fn drawn(recorded: &Recorded) -> GraphicDrawing {
    let distances_m = match recorded.kind.word {
        "air_corridor" => vec![800.0],
        "range_fan_circular" => vec![500.0, 1000.0, 2000.0],
        _ => vec![1000.0],
    };
    let fields = GraphicFields { distances_m, ..GraphicFields::default() };
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
    drawing.strokes.iter().map(|stroke| stroke.points.clone()).collect()
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
    for recorded in recorded() {
        let word = recorded.kind.word;
        if TOOTHED.iter().any(|(toothed, _)| *toothed == word) {
            continue;
        }
        let drawing = drawn(&recorded);
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
        println!("{word:32} {off_m:6.0} m of {length_m:6.0} m: {:.2} %", 100.0 * share);
        if share > 0.02 {
            wrong.push(format!("{word}: {off_m:.0} m of {length_m:.0} m"));
        }
    }
    println!("{compared} graphics, worst {:.2} % ({})", 100.0 * worst.0, worst.1);
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(compared >= 55, "{compared}");
}

#[test]
fn lines_with_teeth_have_as_many_as_those_of_another_renderer_but_one() {
    let mut wrong = Vec::new();
    for recorded in recorded() {
        let Some(&(word, how)) = TOOTHED.iter().find(|(word, _)| *word == recorded.kind.word) else {
            continue;
        };
        let ours = teeth(&strokes(&drawn(&recorded)), &recorded, how);
        let theirs = teeth(&recorded.lines, &recorded, how);
        println!("{word:32} {ours} teeth, {theirs} in the table");
        if ours.abs_diff(theirs) > 1 {
            wrong.push(format!("{word}: {ours} for {theirs}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

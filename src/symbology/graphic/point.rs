//! Points of symbol set 25: figures that stand up on the picture, their foot or their middle at the point.

use glam::DVec2;

use crate::graphic::drawing::{GraphicDrawing, GraphicInput};
use crate::graphic::kind::GraphicKind;
use crate::graphic::plane::turned;

/// The paper on which a point is drawn: right and up in text heights.
struct PointPaper {
    at: DVec2,
    right: DVec2,
    up: DVec2,
}

impl PointPaper {
    fn new(input: &GraphicInput<'_>) -> Self {
        let up = input.up * input.em_m;
        Self { at: input.points[0], right: -input.up.normalize_or(DVec2::Y).perp() * input.em_m, up }
    }

    fn place(&self, [x, y]: [f64; 2]) -> DVec2 {
        self.at + self.right * x + self.up * y
    }

    fn places<const N: usize>(&self, places: [[f64; 2]; N]) -> [DVec2; N] {
        places.map(|place| self.place(place))
    }

    fn circle(&self, [x, y]: [f64; 2], radius: f64) -> Vec<DVec2> {
        let corner = |step: u32| {
            let on_circle = turned(DVec2::X, f64::from(step) * std::f64::consts::TAU / 32.0);
            self.place([x + on_circle.x * radius, y + on_circle.y * radius])
        };
        (0..32).map(corner).collect()
    }
}

/// A box that ends in a point at the place it marks, with the letters of its kind and its name (POINT1).
pub fn flagged(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let paper = PointPaper::new(input);
    drawing.ring(paper.places([[0.0, 0.0], [1.5, 1.3], [1.5, 4.6], [-1.5, 4.6], [-1.5, 1.3]]));
    drawing.text(kind.label, paper.place([0.0, 3.7]));
    drawing.text(input.fields.designation.clone(), paper.place([0.0, 2.2]));
    let right = paper.right.normalize_or_zero();
    drawing.text_beside(input.fields.times(), paper.place([1.8, 3.0]), right);
    drawing.text_beside(input.fields.hostile.clone(), paper.place([1.8, 1.6]), right);
}

/// A coordinating point: a crossed circle.
pub fn coordinating(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let paper = PointPaper::new(input);
    drawing.ring(paper.circle([0.0, 0.0], 1.3));
    drawing.line(paper.places([[-0.92, -0.92], [0.92, 0.92]]));
    drawing.line(paper.places([[-0.92, 0.92], [0.92, -0.92]]));
}

/// A contact point: a square with its number.
pub fn contact_point(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let paper = PointPaper::new(input);
    drawing.ring(paper.places([[-1.2, -1.2], [1.2, -1.2], [1.2, 1.2], [-1.2, 1.2]]));
    drawing.text(input.fields.designation.clone(), input.points[0]);
}

/// A decision point: a star with its number.
pub fn decision(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let paper = PointPaper::new(input);
    let corner = |step: u32| {
        let radius = if step.is_multiple_of(2) { 2.2 } else { 1.1 };
        let way = turned(DVec2::Y, f64::from(step) * std::f64::consts::PI / 5.0) * radius;
        paper.place([way.x, way.y])
    };
    drawing.ring((0..10).map(corner).collect::<Vec<_>>());
    drawing.text(input.fields.designation.clone(), input.points[0]);
}

/// A waypoint, an air control point: a circle with a name.
pub fn circled(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let paper = PointPaper::new(input);
    drawing.ring(paper.circle([0.0, 0.0], 1.6));
    drawing.text(input.fields.labeled(kind.label), input.points[0]);
}

/// A target reference point, a point target: a cross with its number beside it.
pub fn crossed(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let paper = PointPaper::new(input);
    drawing.line(paper.places([[-1.3, 0.0], [1.3, 0.0]]));
    drawing.line(paper.places([[0.0, -1.3], [0.0, 1.3]]));
    let fields = input.fields;
    let name = if fields.target.is_empty() { &fields.designation } else { &fields.target };
    drawing.text_beside(name.clone(), paper.place([0.5, 0.8]), paper.right.normalize_or_zero());
}

/// An observation post: a triangle with the letter of its kind.
pub fn outpost(kind: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let paper = PointPaper::new(input);
    drawing.ring(paper.places([[-1.4, -0.9], [1.4, -0.9], [0.0, 1.6]]));
    drawing.text(kind.label, paper.place([0.0, -0.1]));
    let right = paper.right.normalize_or_zero();
    drawing.text_beside(input.fields.designation.clone(), paper.place([1.7, 0.0]), right);
}

/// Key terrain: a circle with K.
pub fn key_terrain(_: &GraphicKind, input: &GraphicInput<'_>, drawing: &mut GraphicDrawing) {
    let paper = PointPaper::new(input);
    drawing.ring(paper.circle([0.0, 0.0], 1.2));
    drawing.text("K", input.points[0]);
}

//! A fir, 9 m high: a trunk and six skirts of branches, each turned against the one below.

use super::shape::{Paint, Shape};

const BARK: usize = 0;
const LOWER: usize = 1;
const UPPER: usize = 2;

pub fn build() -> Shape {
    let mut tree = Shape::new(vec![
        Paint::plain("bark", [92, 70, 52]),
        Paint::plain("needles", [52, 90, 54]),
        Paint::plain("young needles", [74, 118, 66]),
    ]);
    tree.object("trunk");
    tree.cone(BARK, 7, [0.28, -0.4], [0.2, 2.2], 0.0, 1);
    tree.object("branches");
    let skirts = [
        [2.1, 1.1, 3.4],
        [1.85, 2.3, 4.7],
        [1.55, 3.6, 5.9],
        [1.25, 4.9, 7.0],
        [0.92, 6.1, 8.0],
        [0.6, 7.2, 9.0],
    ];
    for (place, [radius, low, high]) in skirts.into_iter().enumerate() {
        let paint = if place < 3 { LOWER } else { UPPER };
        let turn = place as f32 * 0.37;
        tree.cone(paint, 9, [radius, low], [0.0, high], turn, 1);
        // The underside, seen from the ground.
        tree.cone(LOWER, 9, [0.0001, low + 0.35], [radius, low], turn, 2);
    }
    tree
}

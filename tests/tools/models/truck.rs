//! An army truck, 7 × 2.4 m: cab and bonnet in front, a canvas-covered bed behind, six wheels.

use glam::Vec3;

use super::shape::{Axis, Object, Paint, Shape};

const BODY: usize = 0;
const CANVAS: usize = 1;
const GLASS: usize = 2;
const TIRE: usize = 3;
const STEEL: usize = 4;
const LAMP: usize = 5;

/// Where the six wheels stand: the middle of each.
pub fn wheels() -> Vec<(&'static str, [f32; 3])> {
    [-2.35, 1.55, 2.75]
        .into_iter()
        .flat_map(|y| [-1.0, 1.0].map(|side| ("wheel", [0.98 * side, y, 0.5])))
        .collect()
}

pub fn build() -> Shape {
    let mut truck = Shape::new(vec![
        Paint::plain("olive", [88, 94, 62]),
        Paint::plain("tarpaulin", [122, 120, 88]),
        Paint::plain("glass", [70, 86, 96]),
        Paint::plain("tire", [38, 38, 38]),
        Paint::plain("steel", [72, 74, 70]),
        Paint::plain("lamp", [236, 228, 190]),
    ]);
    chassis(&mut truck);
    cab(&mut truck);
    bed(&mut truck);
    truck.objects.push(wheel());
    truck
}

fn chassis(truck: &mut Shape) {
    truck.object("chassis");
    for x in [-0.5, 0.5] {
        truck.block(STEEL, [x - 0.1, -3.4, 0.55], [x + 0.1, 3.45, 0.8]);
    }
    for y in [-2.35, 1.55, 2.75] {
        truck.block(STEEL, [-0.95, y - 0.09, 0.41], [0.95, y + 0.09, 0.59]);
    }
    truck.block(STEEL, [-1.15, -3.55, 0.5], [1.15, -3.4, 0.8]);
}

fn cab(truck: &mut Shape) {
    truck.object("cab");
    // Bonnet, sloping to the front; then the cab with a raked screen.
    truck.prism(BODY, Axis::X, &[[-3.4, 0.8], [-1.9, 0.8], [-1.9, 1.65], [-3.3, 1.5]], -0.75, 0.75);
    for side in [-1.0, 1.0] {
        let (inner, outer): (f32, f32) = (0.75 * side, 1.18 * side);
        let (low, high) = (inner.min(outer), inner.max(outer));
        truck.prism(
            BODY,
            Axis::X,
            &[
                [-3.1, 0.9],
                [-2.95, 1.0],
                [-1.75, 1.0],
                [-1.6, 0.8],
                [-1.6, 1.1],
                [-1.8, 1.2],
                [-2.9, 1.2],
                [-3.1, 1.1],
            ],
            low,
            high,
        );
        truck.block(LAMP, [0.95 * side - 0.12, -3.16, 1.12], [0.95 * side + 0.12, -3.04, 1.36]);
    }
    truck.block(STEEL, [-0.6, -3.42, 0.9], [0.6, -3.36, 1.42]);
    truck.prism(
        BODY,
        Axis::X,
        &[[-1.9, 0.8], [-0.55, 0.8], [-0.55, 2.4], [-1.6, 2.4], [-1.9, 1.65]],
        -1.12,
        1.12,
    );
    let screen = |x: f32, part: f32| Vec3::new(x, -1.9 + 0.3 * part - 0.02, 1.65 + 0.75 * part);
    for x in [-0.53, 0.53] {
        truck.polygon(
            GLASS,
            &[screen(x - 0.45, 0.14), screen(x + 0.45, 0.14), screen(x + 0.45, 0.86), screen(x - 0.45, 0.86)],
        );
    }
    for side in [-1.0, 1.0] {
        let at = |y: f32, z: f32| Vec3::new(1.135 * side, y, z);
        let mut pane = [at(-1.6, 1.65), at(-0.75, 1.65), at(-0.75, 2.25), at(-1.5, 2.25)];
        if side < 0.0 {
            pane.reverse();
        }
        truck.polygon(GLASS, &pane);
        truck.block(STEEL, [1.0 * side - 0.15, -1.65, 0.6], [1.0 * side + 0.15, -0.7, 0.72]);
    }
}

fn bed(truck: &mut Shape) {
    truck.object("bed");
    truck.block(BODY, [-1.2, -0.4, 1.0], [1.2, 3.5, 1.65]);
    truck.block(STEEL, [-1.1, -0.35, 0.8], [1.1, 3.45, 1.0]);
    for y in [-0.2, 1.0, 2.2, 3.3] {
        for side in [-1.0, 1.0] {
            truck.block(STEEL, [1.22 * side - 0.03, y - 0.05, 1.0], [1.22 * side + 0.03, y + 0.05, 1.65]);
        }
    }
    // The tarpaulin over its hoops.
    let half = [[1.16, 1.65], [1.16, 2.45], [1.0, 2.8], [0.6, 3.0]];
    let mut outline = half.to_vec();
    outline.extend(half.iter().rev().map(|&[x, z]| [-x, z]));
    truck.prism(CANVAS, Axis::Y, &outline, -0.35, 3.45);
    truck.block(TIRE, [-0.9, 3.44, 1.75], [0.9, 3.47, 2.7]);
}

/// A wheel about the origin, its axle along X.
fn wheel() -> Object {
    let mut shape = Shape::new(Vec::new());
    shape.object("wheel");
    let sides = 14;
    let rim = |radius: f32| -> Vec<[f32; 2]> {
        (0..sides)
            .map(|side| {
                let (sin, cos) = libm::sincosf(side as f32 / sides as f32 * std::f32::consts::TAU);
                [cos * radius, sin * radius]
            })
            .collect()
    };
    shape.prism(TIRE, Axis::X, &rim(0.5), -0.17, 0.17);
    shape.prism(STEEL, Axis::X, &rim(0.26), -0.19, 0.19);
    shape.objects.remove(0)
}

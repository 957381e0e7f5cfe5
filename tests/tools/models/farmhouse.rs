//! A half-timbered farmhouse, 12 × 8 m: brick walls, red roof, a porch and a chimney; its ridge runs along X.

use glam::Vec3;
use image::{Rgb, RgbImage};

use super::shape::{Axis, Paint, Shape, noise};

const WALLS: usize = 0;
const TIMBER: usize = 1;
const ROOF: usize = 2;
const PLASTER: usize = 3;
const GLASS: usize = 4;
const DOOR: usize = 5;
const STONE: usize = 6;

const HALF_LENGTH_M: f32 = 6.0;
const HALF_WIDTH_M: f32 = 4.0;
const EAVES_M: f32 = 3.2;
const RIDGE_M: f32 = 7.0;

/// Bricks, 16 courses of four to two meters.
pub fn walls() -> RgbImage {
    RgbImage::from_fn(64, 64, |x, y| {
        let course = y / 8;
        let shifted = (x + course % 2 * 8) % 64;
        if y % 8 == 7 || shifted % 16 == 15 {
            return Rgb([196, 182, 164]);
        }
        let shade = 1.0 + 0.16 * noise(shifted / 16, course) + 0.05 * noise(x + 977, y);
        Rgb([172.0, 98.0, 74.0].map(|channel: f32| (channel * shade).clamp(0.0, 255.0) as u8))
    })
}

pub fn build() -> Shape {
    let bricks =
        Paint { texture: Some(("farmhouse_walls.png", walls())), ..Paint::plain("bricks", [255, 255, 255]) };
    let mut house = Shape::new(vec![
        bricks,
        Paint::plain("timber", [74, 54, 40]),
        Paint::plain("tiles", [172, 62, 44]),
        Paint::plain("plaster", [226, 214, 190]),
        Paint::plain("glass", [66, 84, 98]),
        Paint::plain("door", [58, 92, 70]),
        Paint::plain("stone", [134, 128, 120]),
    ]);
    house.texture_m = 2.0;
    body(&mut house);
    frame(&mut house);
    roof(&mut house);
    openings(&mut house);
    porch(&mut house);
    chimney(&mut house);
    house
}

fn body(house: &mut Shape) {
    house.object("walls");
    let (x, y) = (HALF_LENGTH_M, HALF_WIDTH_M);
    house.block(STONE, [-x - 0.08, -y - 0.08, -0.6], [x + 0.08, y + 0.08, 0.35]);
    for side in [-1.0, 1.0] {
        let along = |at: f32, height: f32| Vec3::new(at * side, -y * -side, height);
        house.polygon(WALLS, &[along(x, 0.35), along(-x, 0.35), along(-x, EAVES_M), along(x, EAVES_M)]);
        let across = |at: f32, height: f32| Vec3::new(x * side, at * side, height);
        house.polygon(WALLS, &[across(-y, 0.35), across(y, 0.35), across(y, EAVES_M), across(-y, EAVES_M)]);
        house.polygon(PLASTER, &[across(-y, EAVES_M), across(y, EAVES_M), across(0.0, RIDGE_M)]);
    }
}

/// Timbers that stand a hand's breadth out of the walls.
fn frame(house: &mut Shape) {
    house.object("frame");
    let (x, y) = (HALF_LENGTH_M, HALF_WIDTH_M);
    for side in [-1.0, 1.0] {
        for end in [-1.0, 1.0] {
            let (cx, cy) = (x * side, y * end);
            house.block(TIMBER, [cx - 0.14, cy - 0.14, 0.35], [cx + 0.14, cy + 0.14, EAVES_M]);
        }
        house.beam(TIMBER, [-x, y * side, EAVES_M - 0.1], [x, y * side, EAVES_M - 0.1], 0.22);
        let face = x * side;
        house.beam(TIMBER, [face, -y, EAVES_M], [face, y, EAVES_M], 0.22);
        house.beam(TIMBER, [face, 0.0, EAVES_M], [face, 0.0, RIDGE_M - 0.2], 0.2);
        house.beam(TIMBER, [face, -2.0, EAVES_M], [face, -2.0, 5.0], 0.18);
        house.beam(TIMBER, [face, 2.0, EAVES_M], [face, 2.0, 5.0], 0.18);
        house.beam(TIMBER, [face, -2.1, 4.95], [face, 2.1, 4.95], 0.19);
        house.beam(TIMBER, [face, -2.0, EAVES_M], [face, 0.0, 4.9], 0.15);
        house.beam(TIMBER, [face, 2.0, EAVES_M], [face, 0.0, 4.9], 0.15);
    }
}

fn roof(house: &mut Shape) {
    house.object("roof");
    let (reach, over) = (HALF_LENGTH_M + 0.5, 0.55);
    let slope = (RIDGE_M - EAVES_M) / HALF_WIDTH_M;
    let (edge, low) = (HALF_WIDTH_M + over, EAVES_M - over * slope);
    let thick = 0.22;
    for side in [-1.0, 1.0] {
        let outline =
            [[0.0, RIDGE_M], [edge * side, low], [edge * side, low + thick], [0.0, RIDGE_M + thick]];
        let outline = if side > 0.0 {
            [outline[1], outline[2], outline[3], outline[0]]
        } else {
            [outline[0], outline[3], outline[2], outline[1]]
        };
        house.prism(ROOF, Axis::X, &outline, -reach, reach);
    }
    house.block(
        ROOF,
        [-reach - 0.03, -0.16, RIDGE_M + thick - 0.12],
        [reach + 0.03, 0.16, RIDGE_M + thick + 0.08],
    );
}

fn openings(house: &mut Shape) {
    house.object("openings");
    for side in [-1.0, 1.0] {
        let out = |depth: f32| {
            let (near, far) = (HALF_WIDTH_M * side, (HALF_WIDTH_M + depth) * side);
            (near.min(far), near.max(far))
        };
        for middle in [-4.2, -1.9, 1.9, 4.2] {
            let (near, far) = out(0.10);
            house.block(PLASTER, [middle - 0.62, near, 1.15], [middle + 0.62, far, 2.5]);
            let (near, far) = out(0.13);
            house.block(GLASS, [middle - 0.5, near, 1.27], [middle - 0.04, far, 2.38]);
            house.block(GLASS, [middle + 0.04, near, 1.27], [middle + 0.5, far, 2.38]);
            for shutter in [-0.92, 0.92] {
                let at = middle + shutter;
                house.block(DOOR, [at - 0.28, near, 1.1], [at + 0.28, far, 2.55]);
            }
        }
        let face = HALF_LENGTH_M * side;
        let (near, far) = (face.min(face + 0.1 * side), face.max(face + 0.1 * side));
        for middle in [-2.2, 2.2] {
            house.block(PLASTER, [near, middle - 0.6, 1.15], [far, middle + 0.6, 2.5]);
            let (near, far) = (face.min(face + 0.13 * side), face.max(face + 0.13 * side));
            house.block(GLASS, [near, middle - 0.48, 1.27], [far, middle + 0.48, 2.38]);
        }
    }
}

/// The front door under its own small roof.
fn porch(house: &mut Shape) {
    house.object("porch");
    let front = -HALF_WIDTH_M;
    house.block(TIMBER, [-0.8, front - 0.1, 0.3], [0.8, front, 2.6]);
    house.block(DOOR, [-0.62, front - 0.14, 0.35], [0.62, front, 2.42]);
    house.block(STONE, [-1.2, front - 1.5, -0.3], [1.2, front, 0.3]);
    house.block(STONE, [-0.9, front - 1.9, -0.3], [0.9, front - 1.5, 0.15]);
    for x in [-1.05, 1.05] {
        house.block(TIMBER, [x - 0.09, front - 1.4, 0.3], [x + 0.09, front - 1.22, 2.75]);
    }
    house.prism(
        ROOF,
        Axis::Y,
        &[[-1.45, 2.6], [1.45, 2.6], [1.45, 2.75], [0.0, 3.75], [-1.45, 2.75]],
        front - 1.7,
        front + 0.6,
    );
}

fn chimney(house: &mut Shape) {
    house.object("chimney");
    house.block(WALLS, [2.6, 0.5, 5.0], [3.5, 1.4, 8.0]);
    house.block(STONE, [2.5, 0.4, 8.0], [3.6, 1.5, 8.2]);
    house.block(TIMBER, [2.8, 0.7, 8.2], [3.3, 1.2, 8.45]);
}

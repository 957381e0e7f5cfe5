//! An army ridge tent, 4.4 × 6 m: walls and roof of canvas with an open front, poles and guy ropes.

use glam::Vec3;
use image::{Rgb, RgbImage};

use super::shape::{Paint, Shape, noise};

const CANVAS: usize = 0;
const POLE: usize = 1;
const ROPE: usize = 2;
const GROUND: usize = 3;

const HALF_WIDTH_M: f32 = 2.2;
const HALF_LENGTH_M: f32 = 3.0;
const WALL_M: f32 = 1.1;
const RIDGE_M: f32 = 2.9;

/// Canvas: a weave, a seam each meter, and stains.
fn canvas() -> RgbImage {
    RgbImage::from_fn(64, 64, |x, y| {
        let weave = if (x + y) % 2 == 0 { 1.03 } else { 0.97 };
        let seam = if x % 32 == 0 || y % 64 == 0 { 0.78 } else { 1.0 };
        let stain = 1.0 + 0.045 * noise(x / 12 + 31, y / 12) + 0.04 * noise(x, y);
        Rgb([138.0, 136.0, 98.0].map(|channel: f32| (channel * weave * seam * stain).clamp(0.0, 255.0) as u8))
    })
}

pub fn build() -> Shape {
    let cloth = Paint {
        texture: Some(("canvas", canvas())),
        two_sided: true,
        ..Paint::plain("canvas", [255, 255, 255])
    };
    let mut tent = Shape::new(vec![
        cloth,
        Paint::plain("pole", [148, 118, 78]),
        Paint::plain("rope", [206, 196, 166]),
        Paint::plain("ground sheet", [86, 88, 70]),
    ]);
    canvases(&mut tent);
    poles(&mut tent);
    tent
}

fn canvases(tent: &mut Shape) {
    tent.object("canvas");
    let (w, l) = (HALF_WIDTH_M, HALF_LENGTH_M);
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    for side in [-1.0, 1.0] {
        let mut wall =
            [at(w * side, -l, 0.0), at(w * side, l, 0.0), at(w * side, l, WALL_M), at(w * side, -l, WALL_M)];
        let (edge, low) = (w + 0.25, WALL_M - 0.2);
        let mut roof =
            [at(edge * side, -l, low), at(edge * side, l, low), at(0.0, l, RIDGE_M), at(0.0, -l, RIDGE_M)];
        // Door flaps, folded back.
        let mut flap = [
            at(w * side, -l, 0.0),
            at(w * side, -l, WALL_M),
            at(0.06 * side, -l, RIDGE_M - 0.06),
            at(0.95 * side, -l - 0.35, 0.0),
        ];
        if side < 0.0 {
            wall.reverse();
            roof.reverse();
        } else {
            flap.reverse();
        }
        tent.polygon(CANVAS, &wall);
        tent.polygon(CANVAS, &roof);
        let [a, b, c, d] = flap;
        tent.polygon(CANVAS, &[a, b, d]);
        tent.polygon(CANVAS, &[b, c, d]);
    }
    tent.polygon(
        CANVAS,
        &[at(w, l, 0.0), at(-w, l, 0.0), at(-w, l, WALL_M), at(0.0, l, RIDGE_M), at(w, l, WALL_M)],
    );
    tent.polygon(GROUND, &[at(-w, -l, 0.03), at(w, -l, 0.03), at(w, l, 0.03), at(-w, l, 0.03)]);
}

fn poles(tent: &mut Shape) {
    tent.object("poles and ropes");
    for end in [-1.0, 1.0] {
        let y = (HALF_LENGTH_M - 0.05) * end;
        tent.beam(POLE, [0.0, y, 0.0], [0.0, y, RIDGE_M + 0.25], 0.09);
        tent.beam(ROPE, [0.0, y, RIDGE_M + 0.05], [0.0, y + 2.2 * end, 0.0], 0.035);
        tent.beam(POLE, [0.0, y + 2.2 * end, 0.0], [0.0, y + 2.28 * end, 0.3], 0.07);
    }
    tent.beam(POLE, [0.0, -HALF_LENGTH_M, RIDGE_M - 0.06], [0.0, HALF_LENGTH_M, RIDGE_M - 0.06], 0.07);
    for side in [-1.0, 1.0] {
        for y in [-2.9, 0.0, 2.9] {
            let (edge, peg) = ((HALF_WIDTH_M + 0.2) * side, (HALF_WIDTH_M + 1.6) * side);
            tent.beam(ROPE, [edge, y, WALL_M - 0.12], [peg, y, 0.0], 0.035);
            tent.beam(POLE, [peg, y, 0.0], [peg + 0.06 * side, y, 0.25], 0.06);
        }
    }
}

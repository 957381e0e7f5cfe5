//! A timber watchtower, 11.6 m high: splayed legs with braces, a boarded platform, a shingled roof.

use glam::Vec3;

use super::shape::{Paint, Shape};

const TIMBER: usize = 0;
const PLANKS: usize = 1;
const SHINGLES: usize = 2;
const DARK: usize = 3;
const FLOOR_M: f32 = 7.0;

pub fn build() -> Shape {
    let mut tower = Shape::new(vec![
        Paint::plain("timber", [112, 80, 50]),
        Paint::plain("planks", [168, 128, 82]),
        Paint::plain("shingles", [104, 62, 46]),
        Paint::plain("tarred", [62, 48, 38]),
    ]);
    legs(&mut tower);
    platform(&mut tower);
    roof(&mut tower);
    ladder(&mut tower);
    tower
}

/// Half the distance of the legs at a height.
fn spread(height: f32) -> f32 {
    2.3 - 0.7 * height / FLOOR_M
}

fn legs(tower: &mut Shape) {
    tower.object("legs");
    let corner = |which: usize, height: f32| {
        let [x, y] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][which % 4];
        [x * spread(height), y * spread(height), height]
    };
    for leg in 0..4 {
        tower.beam(TIMBER, corner(leg, 0.0), corner(leg, FLOOR_M), 0.32);
        for ring in [2.4, 4.7] {
            tower.beam(TIMBER, corner(leg, ring), corner(leg + 1, ring), 0.2);
        }
        for (low, high) in [(0.3, 2.3), (2.5, 4.6), (4.8, 6.8)] {
            tower.beam(TIMBER, corner(leg, low), corner(leg + 1, high), 0.14);
            tower.beam(TIMBER, corner(leg, high), corner(leg + 1, low), 0.13);
        }
        let [x, y, _] = corner(leg, 0.0);
        tower.block(DARK, [x - 0.3, y - 0.3, -0.4], [x + 0.3, y + 0.3, 0.12]);
    }
}

fn platform(tower: &mut Shape) {
    tower.object("platform");
    for y in [-1.75, 0.0, 1.75] {
        tower.block(TIMBER, [-2.4, y - 0.12, FLOOR_M - 0.24], [2.4, y + 0.12, FLOOR_M]);
    }
    tower.block(PLANKS, [-2.4, -2.4, FLOOR_M], [2.4, 2.4, FLOOR_M + 0.14]);
    let (low, high) = (FLOOR_M + 0.14, FLOOR_M + 1.2);
    for side in [-1.0, 1.0] {
        let wall = |from: f32, to: f32| (from.min(to), from.max(to));
        let (outer, inner) = wall(side * 2.36, side * 2.24);
        for board in 0..4 {
            let bottom = low + board as f32 * (high - low) / 4.0;
            let top = bottom + (high - low) / 4.0 - 0.04;
            tower.block(PLANKS, [outer, -2.2, bottom], [inner, 2.2, top]);
            if side > 0.0 {
                tower.block(PLANKS, [-2.2, outer, bottom], [2.2, inner, top]);
            } else {
                // The front has a gap for the ladder.
                tower.block(PLANKS, [-2.2, outer, bottom], [-0.45, inner, top]);
                tower.block(PLANKS, [0.45, outer, bottom], [2.2, inner, top]);
            }
        }
        for end in [-1.0, 1.0] {
            let (x, y) = (side * 2.2, end * 2.2);
            tower.block(TIMBER, [x - 0.12, y - 0.12, low], [x + 0.12, y + 0.12, FLOOR_M + 2.75]);
        }
        tower.block(TIMBER, [side * 2.3 - 0.12, -2.42, high], [side * 2.3 + 0.12, 2.42, high + 0.1]);
        tower.block(TIMBER, [-2.1, 2.18, high], [2.1, 2.42, high + 0.1]);
    }
}

fn roof(tower: &mut Shape) {
    tower.object("roof");
    let eaves = FLOOR_M + 2.7;
    for side in [-1.0, 1.0] {
        tower.beam(TIMBER, [-2.5, side * 2.2, eaves], [2.5, side * 2.2, eaves], 0.2);
        tower.beam(TIMBER, [side * 2.2, -2.5, eaves], [side * 2.2, 2.5, eaves], 0.2);
    }
    let top = Vec3::new(0.0, 0.0, FLOOR_M + 4.6);
    let corner = |which: usize, reach: f32, height: f32| {
        let [x, y] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][which % 4];
        Vec3::new(x * reach, y * reach, height)
    };
    for side in 0..4 {
        let (low, high) = (eaves - 0.1, eaves + 0.7);
        let lower = [corner(side, 3.0, low), corner(side + 1, 3.0, low)];
        let upper = [corner(side, 1.9, high), corner(side + 1, 1.9, high)];
        tower.polygon(SHINGLES, &[lower[0], lower[1], upper[1], upper[0]]);
        tower.polygon(SHINGLES, &[upper[0], upper[1], top]);
        tower.polygon(DARK, &[lower[1], lower[0], corner(side, 0.0, low)]);
    }
    tower.beam(TIMBER, [0.0, 0.0, FLOOR_M + 4.4], [0.0, 0.0, FLOOR_M + 5.4], 0.1);
}

fn ladder(tower: &mut Shape) {
    tower.object("ladder");
    let (foot, head) = (-3.6, -2.42);
    for x in [-0.32, 0.32] {
        tower.beam(PLANKS, [x, foot, 0.0], [x, head, FLOOR_M + 0.9], 0.09);
    }
    for rung in 0..18 {
        let height = 0.4 + rung as f32 * 0.4;
        let y = foot + (head - foot) * height / (FLOOR_M + 0.9);
        tower.block(PLANKS, [-0.3, y - 0.03, height - 0.03], [0.3, y + 0.03, height + 0.03]);
    }
}

//! A stone bridge, 40 m long along Y and 6.8 m wide: three arches under a road that rises 3.2 m.
//!
//! z = 0 is the road at its ends; the foundations reach 4 m down into the river bed.

use glam::Vec3;

use super::shape::{Paint, Shape};

const STONE: usize = 0;
const RING: usize = 1;
const ROAD: usize = 2;
const SHADED: usize = 3;

const HALF_LENGTH_M: f32 = 20.0;
const HALF_WIDTH_M: f32 = 3.4;
const FOOT_M: f32 = -4.0;
/// Where the arches begin.
const SPRING_M: f32 = -2.2;
/// Middle, half span and crown of each arch.
const ARCHES: [[f32; 3]; 3] = [[-12.6, 3.6, 1.0], [0.0, 7.0, 2.3], [12.6, 3.6, 1.0]];
/// Pieces of an arch.
const PIECES: usize = 14;

pub fn build() -> Shape {
    let mut bridge = Shape::new(vec![
        Paint::plain("stone", [158, 148, 132]),
        Paint::plain("arch stones", [190, 180, 160]),
        Paint::plain("road", [146, 132, 112]),
        Paint::plain("wet stone", [112, 106, 96]),
    ]);
    masonry(&mut bridge);
    bridge.object("arch rings");
    for arch in ARCHES {
        ring(&mut bridge, arch);
    }
    piers(&mut bridge);
    parapets(&mut bridge);
    bridge
}

fn road(y: f32) -> f32 {
    let part = y / HALF_LENGTH_M;
    3.2 * (1.0 - part * part)
}

/// A point of an arch's underside, `turn` in 0..=1 from its southern foot, `out` meters outside it.
fn arch_at([middle, half, crown]: [f32; 3], turn: f32, out: f32) -> (f32, f32) {
    let (sin, cos) = libm::sincosf(turn * std::f32::consts::PI);
    (middle - cos * (half + out), SPRING_M + sin * (crown - SPRING_M + out))
}

/// Stations along the bridge with the underside there, `None` where it stands on the ground.
fn stations() -> Vec<(f32, Option<f32>)> {
    let mut stations = vec![(-HALF_LENGTH_M, None)];
    for arch in ARCHES {
        let (start, _) = arch_at(arch, 0.0, 0.0);
        stations.push((start, None));
        for piece in 0..=PIECES {
            let (y, z) = arch_at(arch, piece as f32 / PIECES as f32, 0.0);
            stations.push((y, Some(z)));
        }
        let (end, _) = arch_at(arch, 1.0, 0.0);
        stations.push((end, None));
    }
    stations.push((HALF_LENGTH_M, None));
    stations
}

fn masonry(bridge: &mut Shape) {
    bridge.object("masonry");
    let w = HALF_WIDTH_M;
    let stations = stations();
    for pair in stations.windows(2) {
        let [(y0, under0), (y1, under1)] = [pair[0], pair[1]];
        if y1 - y0 < 1e-4 {
            // The side of a pier under the spring of an arch.
            let low = [Vec3::new(-w, y0, FOOT_M), Vec3::new(w, y0, FOOT_M)];
            let high = [Vec3::new(-w, y0, SPRING_M), Vec3::new(w, y0, SPRING_M)];
            if under0.is_none() {
                bridge.polygon(SHADED, &[low[1], low[0], high[0], high[1]]);
            } else {
                bridge.polygon(SHADED, &[low[0], low[1], high[1], high[0]]);
            }
            continue;
        }
        let (z0, z1) = (under0.unwrap_or(FOOT_M), under1.unwrap_or(FOOT_M));
        let (top0, top1) = (road(y0), road(y1));
        bridge.polygon(
            STONE,
            &[Vec3::new(w, y0, z0), Vec3::new(w, y1, z1), Vec3::new(w, y1, top1), Vec3::new(w, y0, top0)],
        );
        bridge.polygon(
            STONE,
            &[Vec3::new(-w, y1, z1), Vec3::new(-w, y0, z0), Vec3::new(-w, y0, top0), Vec3::new(-w, y1, top1)],
        );
        if under0.is_some() {
            let soffit =
                [Vec3::new(-w, y0, z0), Vec3::new(-w, y1, z1), Vec3::new(w, y1, z1), Vec3::new(w, y0, z0)];
            bridge.smooth_polygon(SHADED, 1, &soffit);
        }
        let deck = [
            Vec3::new(-w, y0, top0),
            Vec3::new(w, y0, top0),
            Vec3::new(w, y1, top1),
            Vec3::new(-w, y1, top1),
        ];
        bridge.smooth_polygon(ROAD, 2, &deck);
    }
    for end in [-1.0, 1.0] {
        let at = |x: f32, z: f32| Vec3::new(x * end, HALF_LENGTH_M * end, z);
        bridge.polygon(STONE, &[at(w, FOOT_M), at(-w, FOOT_M), at(-w, 0.0), at(w, 0.0)]);
    }
}

/// The arch stones: a band that stands 12 cm out of each side wall.
fn ring(bridge: &mut Shape, arch: [f32; 3]) {
    let (wall, out, deep) = (HALF_WIDTH_M, HALF_WIDTH_M + 0.12, 0.55);
    for piece in 0..PIECES {
        let turn = |step: usize| (piece + step) as f32 / PIECES as f32;
        let [(y0, z0), (y1, z1)] = [arch_at(arch, turn(0), 0.0), arch_at(arch, turn(1), 0.0)];
        let [(v0, w0), (v1, w1)] = [arch_at(arch, turn(0), deep), arch_at(arch, turn(1), deep)];
        for side in [-1.0, 1.0] {
            let at = |x: f32, y: f32, z: f32| Vec3::new(x * side, y, z);
            let mut face = [at(out, y0, z0), at(out, y1, z1), at(out, v1, w1), at(out, v0, w0)];
            let mut under = [at(wall, y0, z0), at(wall, y1, z1), at(out, y1, z1), at(out, y0, z0)];
            let mut over = [at(wall, v1, w1), at(wall, v0, w0), at(out, v0, w0), at(out, v1, w1)];
            // Written for the eastern side; the western one is its mirror image.
            if side < 0.0 {
                face.reverse();
                under.reverse();
                over.reverse();
            }
            bridge.polygon(RING, &face);
            bridge.polygon(RING, &under);
            bridge.polygon(RING, &over);
        }
    }
}

/// Piers with cutwaters that part the river.
fn piers(bridge: &mut Shape) {
    bridge.object("cutwaters");
    let (south, _) = arch_at(ARCHES[0], 1.0, 0.0);
    let (north, _) = arch_at(ARCHES[1], 0.0, 0.0);
    for (from, to) in [(south, north), (-north, -south)] {
        let (middle, top) = ((from + to) * 0.5, 0.4);
        for side in [-1.0, 1.0] {
            let (wall, tip) = (HALF_WIDTH_M * side, (HALF_WIDTH_M + 1.5) * side);
            let nose = |z: f32| Vec3::new(tip, middle, z);
            let flank = |end: f32, z: f32| Vec3::new(wall, if end * side < 0.0 { from } else { to }, z);
            let peak = Vec3::new(wall, middle, top + 0.9);
            bridge.polygon(STONE, &[flank(-1.0, FOOT_M), nose(FOOT_M), nose(top), flank(-1.0, top)]);
            bridge.polygon(STONE, &[nose(FOOT_M), flank(1.0, FOOT_M), flank(1.0, top), nose(top)]);
            bridge.polygon(RING, &[flank(-1.0, top), nose(top), peak]);
            bridge.polygon(RING, &[nose(top), flank(1.0, top), peak]);
        }
    }
}

fn parapets(bridge: &mut Shape) {
    bridge.object("parapets");
    let (steps, high) = (20, 1.0);
    for side in [-1.0, 1.0] {
        let (inner, outer) = (HALF_WIDTH_M - 0.4, HALF_WIDTH_M + 0.1);
        for step in 0..steps {
            let y = |at: usize| HALF_LENGTH_M * (2.0 * at as f32 / steps as f32 - 1.0);
            let (y0, y1) = (y(step), y(step + 1));
            let corner = |x: f32, y: f32, up: f32| Vec3::new(x * side, y, road(y) + up);
            let quads = [
                (
                    STONE,
                    [
                        corner(outer, y0, -0.25),
                        corner(outer, y1, -0.25),
                        corner(outer, y1, high),
                        corner(outer, y0, high),
                    ],
                ),
                (
                    STONE,
                    [
                        corner(inner, y1, 0.0),
                        corner(inner, y0, 0.0),
                        corner(inner, y0, high),
                        corner(inner, y1, high),
                    ],
                ),
                (
                    RING,
                    [
                        corner(inner, y0, high),
                        corner(outer, y0, high),
                        corner(outer, y1, high),
                        corner(inner, y1, high),
                    ],
                ),
                (
                    STONE,
                    [
                        corner(outer, y1, -0.25),
                        corner(outer, y0, -0.25),
                        corner(HALF_WIDTH_M, y0, -0.25),
                        corner(HALF_WIDTH_M, y1, -0.25),
                    ],
                ),
            ];
            for (paint, mut quad) in quads {
                if side < 0.0 {
                    quad.reverse();
                }
                bridge.polygon(paint, &quad);
            }
        }
        for end in [-1.0, 1.0] {
            let (x, y) = ((HALF_WIDTH_M - 0.15) * side, (HALF_LENGTH_M - 0.35) * end);
            bridge.block(RING, [x - 0.4, y - 0.4, -0.5], [x + 0.4, y + 0.4, 1.5]);
        }
    }
}

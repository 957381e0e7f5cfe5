//! Polygons with materials, and the few solids that models are put together from.

use std::io::Cursor;

use glam::{Vec2, Vec3};
use image::RgbImage;

/// A surface.
#[derive(Clone)]
pub struct Paint {
    pub name: &'static str,
    /// Color as seen (sRGB).
    pub color: [u8; 3],
    /// A texture that is multiplied with the color: its file name and picture.
    pub texture: Option<(&'static str, RgbImage)>,
    pub two_sided: bool,
}

impl Paint {
    pub fn plain(name: &'static str, color: [u8; 3]) -> Self {
        Self { name, color, texture: None, two_sided: false }
    }
}

/// A flat polygon, counter-clockwise from outside.
#[derive(Clone)]
pub struct Face {
    pub paint: usize,
    /// 0 is flat; faces of one number are smooth where they meet.
    pub smoothing: u32,
    pub corners: Vec<(Vec3, Vec2)>,
}

/// Faces with a name.
#[derive(Clone)]
pub struct Object {
    pub name: &'static str,
    pub faces: Vec<Face>,
}

/// A model.
pub struct Shape {
    pub paints: Vec<Paint>,
    pub objects: Vec<Object>,
    /// Meters that one repetition of a texture covers.
    pub texture_m: f32,
}

impl Shape {
    pub fn new(paints: Vec<Paint>) -> Self {
        Self { paints, objects: Vec::new(), texture_m: 2.0 }
    }

    /// Begins a new object; what follows goes into it.
    pub fn object(&mut self, name: &'static str) {
        self.objects.push(Object { name, faces: Vec::new() });
    }

    /// A flat polygon with texture coordinates along its own plane: U level, V up the slope.
    pub fn polygon(&mut self, paint: usize, corners: &[Vec3]) {
        self.smooth_polygon(paint, 0, corners);
    }

    pub fn smooth_polygon(&mut self, paint: usize, smoothing: u32, corners: &[Vec3]) {
        let normal: Vec3 =
            (0..corners.len()).map(|at| corners[at].cross(corners[(at + 1) % corners.len()])).sum();
        let along = Vec3::Z.cross(normal).try_normalize().unwrap_or(Vec3::X);
        let up = normal.cross(along).normalize();
        let uv = |at: Vec3| Vec2::new(at.dot(along), at.dot(up)) / self.texture_m;
        let corners = corners.iter().map(|&at| (at, uv(at))).collect();
        let object = self.objects.last_mut().expect("an object has begun");
        object.faces.push(Face { paint, smoothing, corners });
    }

    /// A box along the axes.
    pub fn block(&mut self, paint: usize, min: [f32; 3], max: [f32; 3]) {
        let middle = (Vec3::from(min) + Vec3::from(max)) * 0.5;
        let half = (Vec3::from(max) - Vec3::from(min)) * 0.5;
        self.brick(paint, middle, [Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z]);
    }

    /// A box given by its middle and three half edges, right-handed.
    pub fn brick(&mut self, paint: usize, middle: Vec3, [x, y, z]: [Vec3; 3]) {
        for (out, across, up) in [(x, y, z), (y, z, x), (z, x, y)] {
            for side in [1.0, -1.0] {
                let (out, across) = (out * side, across * side);
                self.polygon(
                    paint,
                    &[
                        middle + out - across - up,
                        middle + out + across - up,
                        middle + out + across + up,
                        middle + out - across + up,
                    ],
                );
            }
        }
    }

    /// A square beam from `from` to `to`, `thick` meters a side.
    pub fn beam(&mut self, paint: usize, from: [f32; 3], to: [f32; 3], thick: f32) {
        let (from, to) = (Vec3::from(from), Vec3::from(to));
        let along = (to - from) * 0.5;
        let side = along.cross(if along.x.abs() + along.y.abs() < 0.1 { Vec3::X } else { Vec3::Z });
        let side = side.normalize() * (thick * 0.5);
        let up = along.cross(side).normalize() * (thick * 0.5);
        self.brick(paint, (from + to) * 0.5, [along, side, up]);
    }

    /// A polygon in the plane across X or Y, pushed along that axis from `from` to `to`.
    pub fn prism(&mut self, paint: usize, axis: Axis, outline: &[[f32; 2]], from: f32, to: f32) {
        let place = |[across, up]: [f32; 2], along: f32| match axis {
            Axis::X => Vec3::new(along, across, up),
            // Mirrored against X, so that outlines run counter-clockwise in both.
            Axis::Y => Vec3::new(-across, along, up),
        };
        let near: Vec<Vec3> = outline.iter().rev().map(|&at| place(at, from)).collect();
        let far: Vec<Vec3> = outline.iter().map(|&at| place(at, to)).collect();
        self.polygon(paint, &near);
        self.polygon(paint, &far);
        for (at, &corner) in outline.iter().enumerate() {
            let next = outline[(at + 1) % outline.len()];
            self.polygon(
                paint,
                &[place(corner, from), place(next, from), place(next, to), place(corner, to)],
            );
        }
    }

    /// An upright cone or a piece of one, `sides` round, open below; closed on top where `top` is 0.
    pub fn cone(
        &mut self,
        paint: usize,
        sides: usize,
        [bottom, low]: [f32; 2],
        [top, high]: [f32; 2],
        turn: f32,
        smoothing: u32,
    ) {
        let at = |side: usize, radius: f32, height: f32| {
            let (sin, cos) = libm::sincosf((side as f32 / sides as f32 + turn) * std::f32::consts::TAU);
            Vec3::new(cos * radius, sin * radius, height)
        };
        for side in 0..sides {
            let base = [at(side, bottom, low), at(side + 1, bottom, low)];
            if top == 0.0 {
                self.smooth_polygon(paint, smoothing, &[base[0], base[1], Vec3::Z * high]);
            } else {
                self.smooth_polygon(
                    paint,
                    smoothing,
                    &[base[0], base[1], at(side + 1, top, high), at(side, top, high)],
                );
            }
        }
    }
}

/// What a prism runs along.
#[derive(Clone, Copy)]
pub enum Axis {
    X,
    Y,
}

/// A picture as a PNG file.
pub fn png(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes all");
    bytes.into_inner()
}

/// Noise in −1..=1 from whole numbers (Thomas Wang's 32-bit mix, 1997).
pub fn noise(x: u32, y: u32) -> f32 {
    let mut bits = x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B);
    bits = (bits ^ 61) ^ (bits >> 16);
    bits = bits.wrapping_mul(9);
    bits ^= bits >> 4;
    bits = bits.wrapping_mul(0x27D4_EB2D);
    bits ^= bits >> 15;
    (bits & 0xFFFF) as f32 / 32_767.5 - 1.0
}

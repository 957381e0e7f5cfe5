//! The contour lines of a finished picture, for looks that draw them over it.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::cpu::RenderQuality;
use crate::cpu::ground_shade::GroundShader;
use crate::cpu::hit::FacePoint;
use crate::picture::Rendering;
use sandtable_draw::list::{DrawList, FeatureId};
use sandtable_view::camera::Camera;

/// How much of each pixel of bare ground a contour line covers, 0 to 1, row by row: the lines that the ground of `list` is
/// drawn with on `picture`, which `camera` sees. Empty where that ground has none.
pub fn contour_cover(list: &DrawList, camera: &Camera, picture: &Rendering) -> Vec<f32> {
    let Some(outer) = list.ground.as_deref().filter(|map| map.contours.is_some()) else { return Vec::new() };
    let shader = |map| GroundShader::new(map, list.lighting.to_sun);
    let insets = list.insets.iter().rev().map(|inset| LinedGround {
        corners: inset.corners(),
        origin: inset.origin,
        shader: shader(&inset.map),
    });
    let whole = LinedGround {
        corners: [Vec2::NEG_INFINITY, Vec2::INFINITY],
        origin: Vec2::ZERO,
        shader: shader(outer),
    };
    let grounds: Vec<LinedGround<'_>> = insets.chain([whole]).collect();
    let (width, height) = (picture.pixels.width() as usize, picture.pixels.height() as usize);
    let seen = ContourView { camera, picture, width, height };
    let cover = |index: usize| {
        let Some(hit) = seen.hit(index % width, index / width) else { return 0.0 };
        let ground = grounds.iter().find(|ground| ground.holds(hit.world.truncate()));
        ground.map_or(0.0, |ground| ground.cover(hit))
    };
    (0..width * height).into_par_iter().map(cover).collect()
}

/// A ground map with its place in the world space of the list.
struct LinedGround<'a> {
    corners: [Vec2; 2],
    origin: Vec2,
    shader: GroundShader<'a>,
}

impl LinedGround<'_> {
    fn holds(&self, at: Vec2) -> bool {
        let [min, max] = self.corners;
        min.cmple(at).all() && at.cmple(max).all()
    }

    fn cover(&self, hit: FacePoint) -> f32 {
        let hit = FacePoint { world: hit.world - self.origin.extend(0.0), ..hit };
        let point = self.shader.read(&hit, RenderQuality::default().anisotropy);
        self.shader.contour_cover(&point, &hit)
    }
}

/// The ground that a picture shows.
struct ContourView<'a> {
    camera: &'a Camera,
    picture: &'a Rendering,
    width: usize,
    height: usize,
}

impl ContourView<'_> {
    /// The bare ground at a pixel, in world space; `None` where the picture shows something else.
    fn world(&self, column: usize, row: usize) -> Option<Vec3> {
        if column >= self.width || row >= self.height {
            return None;
        }
        let index = row * self.width + column;
        let depth_m = self.picture.depth_m[index];
        let is_ground = self.picture.features[index] == FeatureId::GROUND && depth_m.is_finite();
        let center = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
        is_ground.then(|| self.camera.point_at(center, depth_m))
    }

    /// The ground at a pixel with what the pixel spans of it: from it to its neighbors, the nearer of two, so that it ends
    /// where another hill begins.
    fn hit(&self, column: usize, row: usize) -> Option<FacePoint> {
        let world = self.world(column, row)?;
        let span = |after: Option<Vec3>, before: Option<Vec3>| match (after, before) {
            (Some(after), Some(before)) => {
                let (ahead, behind) = (after - world, world - before);
                if ahead.length_squared() <= behind.length_squared() { ahead } else { behind }
            }
            (Some(after), None) => after - world,
            (None, Some(before)) => world - before,
            (None, None) => Vec3::ZERO,
        };
        let left = column.checked_sub(1).and_then(|column| self.world(column, row));
        let above = row.checked_sub(1).and_then(|row| self.world(column, row));
        Some(FacePoint {
            world,
            distance_m: world.distance(self.camera.eye()),
            right: span(self.world(column + 1, row), left),
            down: span(self.world(column, row + 1), above),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::contour_ground::lift_level_ground;
    use sandtable_draw::ground::{ColorRamp, Contours, GroundMap, GroundPost};
    use sandtable_draw::ground_levels::PostCount;
    use sandtable_draw::pixels::Pixels;
    use sandtable_view::axes::DirectionAxes;
    use sandtable_view::camera::ParallelFrame;
    use std::sync::Arc;

    /// The lines of a plan of ground of 40 × 40 cells of 1 m, ten pixels each, at every tenth meter.
    fn lines(height: impl Fn(f32, f32) -> f32) -> Vec<Vec<f32>> {
        let size = PostCount { columns: 41, rows: 41 };
        let contours =
            Contours { interval_m: 10.0, major_every: 5, color: Srgba::WHITE, width_px: 1.0, lit: None };
        let post = |index: u32| GroundPost {
            height_m: height((index % 41) as f32, (index / 41) as f32),
            ..GroundPost::default()
        };
        let mut posts: Vec<GroundPost> = (0..41 * 41).map(post).collect();
        lift_level_ground(&mut posts, size, &contours, 0.0);
        let map = GroundMap {
            columns: 41,
            rows: 41,
            posts,
            ramp: ColorRamp::new(vec![(0.0, Srgba::WHITE)]).expect("one stop"),
            contours: Some(contours),
            ..GroundMap::level()
        };
        let list = DrawList { ground: Some(Arc::new(map)), ..DrawList::default() };
        let frame = ParallelFrame { half_m: Vec2::splat(20.0), dpi: 96.0 };
        let axes = DirectionAxes::new(0.0, std::f32::consts::FRAC_PI_2);
        let eye = Vec3::new(20.0, 20.0, 500.0);
        let camera = Camera::parallel(eye, &axes, frame, (400, 400), (1.0, 1000.0)).expect("sound");
        let picture = Rendering {
            pixels: Pixels::filled(400, 400, Srgba::WHITE),
            depth_m: vec![400.0; 160_000],
            features: vec![FeatureId::GROUND; 160_000],
        };
        let cover = contour_cover(&list, &camera, &picture);
        cover.chunks(400).map(<[f32]>::to_vec).collect()
    }

    /// How much ink there is on each ray from the middle of the picture, outward.
    fn weights(lines: &[Vec<f32>]) -> Vec<f32> {
        let ray = |turn: i32| {
            let along = Vec2::from_angle(turn as f32 * 0.02);
            // Steps of a quarter of a pixel.
            let at = |step: i32| Vec2::splat(200.0) + along * (step as f32 * 0.25);
            (0..760).map(at).map(|at| lines[at.y as usize][at.x as usize] * 0.25).sum::<f32>()
        };
        (0..314).map(ray).collect()
    }

    fn cone(x: f32, y: f32) -> f32 {
        (x - 20.0).hypot(y - 20.0)
    }

    #[test]
    fn level_ground_round_a_hill_has_no_line_at_its_own_height() {
        // A hill of 4 m on a plain at 100 m: no line is left.
        let hill = lines(|x, y| 100.0 + (4.0 - 0.5 * cone(x, y)).max(0.0));
        assert!(hill.iter().flatten().all(|cover| *cover == 0.0));
    }

    #[test]
    fn one_line_of_even_weight_goes_round_a_hollow_in_a_plain_and_round_a_table() {
        for sign in [1.0f32, -1.0] {
            // Down by 4 m inside, or outside.
            let ground = lines(|x, y| 100.0 - ((10.0 - cone(x, y)) * 2.0 * sign).clamp(0.0, 4.0));
            let weights = weights(&ground);
            let (least, most) = weights
                .iter()
                .fold((f32::MAX, 0.0f32), |(least, most), &own| (least.min(own), most.max(own)));
            assert!(least > 1.2 && most < 3.6, "{sign}: {least} to {most} pixels of ink on a ray");
        }
    }
}

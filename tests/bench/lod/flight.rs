//! The flight that all sections share: a circle over the first 513² posts, posts 10 m apart.
//!
//! Radius 0.3 of the block's side, 30 cells above the smoothed ground, 60° × 47°, 8° down; `speed` cells a frame.

use glam::{DVec2, Vec2, Vec3};
use sandtable_terrain::lattice::Lattice;
use sandtable_view::camera::Camera;
use sandtable_view::flight::{CircularFlight, GroundClearance};

/// Meters between posts.
pub const CELL_M: f32 = 10.0;

/// The first `frames` cameras of the flight over a square ground of heights in meters, row by row.
pub fn cameras(heights: &[f32], speed: f32, frames: usize) -> Vec<Camera> {
    let n = side(heights);
    let block = (n.min(513) - 1) as f32;
    let circle = CircularFlight {
        center: Vec2::splat(block * 0.5 * CELL_M),
        radius_m: block * 0.3 * CELL_M,
        step_m: speed * CELL_M,
        clearance: GroundClearance { height_m: 30.0 * CELL_M, smoothing_m: 2.0 * CELL_M },
    };
    let stations = circle.stations(frames, &|at| bilinear(heights, n, at / CELL_M));
    let camera = |station: &sandtable_view::flight::FlightStation| station.camera(1.0, 60_000.0);
    stations.iter().map(|station| camera(station).expect("the flight looks ahead")).collect()
}

/// The ground as the product holds it.
pub fn lattice(heights: &[f32]) -> Lattice {
    let cell = DVec2::splat(f64::from(CELL_M));
    Lattice::new(DVec2::ZERO, cell, side(heights) as u32, heights.to_vec()).expect("a ground without holes")
}

/// Posts along a side of a square ground.
pub fn side(heights: &[f32]) -> usize {
    heights.len().isqrt()
}

/// The left, right, bottom, top, near and far planes of a camera, normals inward and of unit length, lengths in
/// cells.
pub fn planes(camera: &Camera) -> [[f32; 4]; 6] {
    let (forward, right, up, tan) = (camera.forward(), camera.right(), camera.up(), camera.tan_half_fov());
    let eye = camera.eye() / CELL_M;
    let (near, far) = camera.planes();
    let plane = |normal: Vec3, beyond: f32| {
        let normal = normal.normalize();
        [normal.x, normal.y, normal.z, beyond - normal.dot(eye)]
    };
    [
        plane(right + forward * tan.x, 0.0),
        plane(-right + forward * tan.x, 0.0),
        plane(up + forward * tan.y, 0.0),
        plane(-up + forward * tan.y, 0.0),
        plane(forward, -near / CELL_M),
        plane(-forward, far / CELL_M),
    ]
}

fn bilinear(heights: &[f32], n: usize, at: Vec2) -> f32 {
    let (column, row) = ((at.x as usize).min(n - 2), (at.y as usize).min(n - 2));
    let (east, north) = (at.x - column as f32, at.y - row as f32);
    let first = row * n + column;
    let along = |first: usize| heights[first] + east * (heights[first + 1] - heights[first]);
    along(first) + north * (along(first + n) - along(first))
}

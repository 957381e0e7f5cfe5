//! Midpoint errors and extracted meshes against those of other people's programs, on the same ground.

#[path = "../bench/common/fields.rs"]
mod fields;

use glam::DVec2;

use sandtable_roam::errors::ErrorMap;
use sandtable_roam::extract::{Extract, extract};
use sandtable_roam::layout::PatchLayout;
use sandtable_terrain::lattice::Lattice;

const SIZE: usize = 257;

/// The corners of a triangle by column and row, in order of size.
type Corners = [(usize, usize); 3];

fn sorted(triangles: impl Iterator<Item = Corners>) -> Vec<Corners> {
    let mut triangles: Vec<Corners> = triangles
        .map(|mut corners| {
            corners.sort_unstable();
            corners
        })
        .collect();
    triangles.sort_unstable();
    triangles
}

fn ours(heights: &[f32], tolerance_m: f32) -> Vec<Corners> {
    let lattice =
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), SIZE as u32, heights.to_vec()).expect("sound ground");
    let layout = PatchLayout::new(SIZE as u32, SIZE as u32, SIZE as u32 - 1).expect("one patch");
    let mut mesh = Extract::default();
    extract(&layout, &ErrorMap::midpoint(&lattice, &layout), tolerance_m, &mut mesh);
    let place = |corner: u32| {
        let post = mesh.vertices()[corner as usize] as usize;
        (post % SIZE, post / SIZE)
    };
    sorted(mesh.triangles().iter().map(|triangle| triangle.map(place)))
}

/// By the crate that computes in f64, as the first of these programs does.
fn by_martini(heights: &[f32], tolerance_m: f32) -> Vec<Corners> {
    let mut martini = martini::Martini::new(SIZE as u32);
    let tile = martini.create_terrain(|x, y| f64::from(heights[y * SIZE + x]));
    let same = &mut |(u, v)| (u, v, 0.0);
    let (vertices, corners, _) = tile.construct_mesh(&mut martini, f64::from(tolerance_m), same);
    let scale = (SIZE - 1) as f32;
    let place = |corner: u32| {
        let vertex = &vertices[3 * corner as usize..];
        ((vertex[0] * scale).round() as usize, ((1.0 - vertex[1]) * scale).round() as usize)
    };
    sorted(corners.as_chunks::<3>().0.iter().map(|triangle| triangle.map(place)))
}

/// By the crate that computes in f32, and so differs where an error is a rounding away from the tolerance.
fn count_by_martini_rtin(heights: &[f32], tolerance_m: f32) -> usize {
    let martini = martini_rtin::Martini::with_capacity(SIZE);
    let columns = (0..SIZE).map(|x| (0..SIZE).map(|y| heights[y * SIZE + x]).collect()).collect();
    martini.create_tile(columns).get_mesh(tolerance_m).1.len() / 3
}

#[test]
fn the_mesh_of_a_fractal_is_martini_s_triangle_by_triangle() {
    let heights = fields::fractal(SIZE);
    for tolerance_m in [0.25, 1.0, 5.0, 20.0, 2000.0] {
        let (ours, theirs) = (ours(&heights, tolerance_m), by_martini(&heights, tolerance_m));
        assert!(ours == theirs, "{} triangles, theirs {} at {tolerance_m} m", ours.len(), theirs.len());
        let rounded = count_by_martini_rtin(&heights, tolerance_m);
        let apart = ours.len().abs_diff(rounded);
        assert!(apart * 1000 <= ours.len(), "{} triangles, in f32 {rounded} at {tolerance_m} m", ours.len());
    }
}

#[test]
fn larger_fractals_begin_with_the_smaller_ones() {
    let (small, large) = (fields::fractal(33), fields::fractal(65));
    for (row, from) in small.chunks_exact(33).zip(large.chunks_exact(65)) {
        assert_eq!(row, &from[..33]);
    }
}

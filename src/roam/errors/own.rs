//! The error of one vertex alone, not yet raised to those of its children.
//!
//! Where heights change, only these are measured again: see `edit`.

use rayon::prelude::*;

use crate::roam::bintree::Triangle;
use crate::roam::errors::exact::triangle_error;
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;
use crate::terrain::lattice::Lattice;

/// The midpoint error of a vertex of the layout alone, metres: `|z − mean of the ends of its hypotenuse|` (the papers'
/// δ). Infinite where some of the three posts have no data, 0 where none has any and for patch corners.
pub fn midpoint_error_at(lattice: &Lattice, layout: &Layout, vertex: Vertex) -> f32 {
    if layout.is_corner(vertex) {
        return 0.0;
    }
    let height = |vertex| lattice.height(layout.post(vertex));
    let [from, to] = vertex.hypotenuse().map(height);
    midpoint_error(height(vertex), from, to)
}

/// The midpoint error of every vertex alone, in the order of [`Layout::index`].
pub fn midpoint_errors(lattice: &Lattice, layout: &Layout) -> Vec<f32> {
    measured(layout, |vertex| midpoint_error_at(lattice, layout, vertex))
}

/// The midpoint error at height `z` between two ends; see [`midpoint_error_at`].
pub fn midpoint_error(z: f32, from: f32, to: f32) -> f32 {
    let off = (f64::from(z) - (f64::from(from) + f64::from(to)) / 2.0).abs() as f32;
    if !off.is_nan() {
        off
    } else if z.is_nan() && from.is_nan() && to.is_nan() {
        0.0
    } else {
        f32::INFINITY
    }
}

/// The exact error of a vertex of the layout alone: the largest of the two triangles it splits, see
/// [`triangle_error`]; 0 for patch corners.
pub fn exact_error_at(lattice: &Lattice, layout: &Layout, vertex: Vertex) -> f32 {
    if layout.is_corner(vertex) {
        return 0.0;
    }
    split_triangles(layout, vertex)
        .map(|triangle| triangle_error(lattice, layout, &triangle))
        .fold(0.0, f32::max)
}

/// The exact error of every vertex alone, in the order of [`Layout::index`].
pub fn exact_errors(lattice: &Lattice, layout: &Layout) -> Vec<f32> {
    measured(layout, |vertex| exact_error_at(lattice, layout, vertex))
}

/// What `measure` says of every vertex; in parallel, the same for any number of threads.
fn measured(layout: &Layout, measure: impl Fn(Vertex) -> f32 + Sync) -> Vec<f32> {
    let mut errors = vec![0.0; layout.vertex_count()];
    errors.par_chunks_mut(layout.columns()).enumerate().for_each(|(y, row)| {
        for (x, error) in row.iter_mut().enumerate() {
            *error = measure(Vertex::new(x as i32, y as i32));
        }
    });
    errors
}

/// The triangles that a vertex, no patch corner, splits: two, or one at the border. Counter-clockwise.
pub fn split_triangles(layout: &Layout, vertex: Vertex) -> impl Iterator<Item = Triangle> + use<> {
    let [from, to] = vertex.hypotenuse();
    let layout = *layout;
    vertex.parents().into_iter().filter(move |&apex| layout.contains(apex)).map(move |apex| {
        let turn = (from.x - apex.x) * (to.y - apex.y) - (from.y - apex.y) * (to.x - apex.x);
        let (left, right) = if turn > 0 { (from, to) } else { (to, from) };
        Triangle { apex, left, right }
    })
}

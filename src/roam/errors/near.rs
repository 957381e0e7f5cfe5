//! The exact errors of the vertices with the smallest steps, in closed form.
//!
//! Nearly all vertices of a terrain split triangles of a few posts: as rows and spans they would cost more than
//! their posts. Where a post is the middle of two corners its distance from the plane is the mean of its
//! differences to both, which needs no gradient at all.

use crate::roam::errors::scan::larger;
use crate::roam::graph::{Kind, Vertex};

/// The largest step that is treated here.
pub const LARGEST_STEP: i32 = 2;

/// The error of a vertex with a step of at most [`LARGEST_STEP`], both of whose triangles are on the lattice, all
/// their posts with data. `heights` are the lattice's, `columns` to a row.
#[inline(always)]
pub fn error(heights: &[f32], columns: usize, vertex: Vertex) -> f32 {
    let rises = || {
        let [from, to] = vertex.hypotenuse();
        (to.x > from.x) == (to.y > from.y)
    };
    match (vertex.step(), vertex.kind()) {
        (1, Kind::EastEdge) => {
            let [row] = rows::<1, 3>(heights, columns, vertex);
            off_middle(row[1], row[0], row[2])
        }
        (1, Kind::NorthEdge) => {
            let [[south], [middle], [north]] = rows::<3, 1>(heights, columns, vertex);
            off_middle(middle, south, north)
        }
        (1, Kind::Center) => center_of_step_one(rows(heights, columns, vertex), rises()),
        (_, Kind::EastEdge) => edge_of_step_two(rows(heights, columns, vertex)),
        (_, Kind::NorthEdge) => edge_of_step_two(transposed(rows(heights, columns, vertex))),
        (_, Kind::Center) => center_of_step_two(rows(heights, columns, vertex), rises()),
    }
}

/// The `ROWS` × `COLUMNS` posts around a vertex, from the south-west.
#[inline(always)]
fn rows<const ROWS: usize, const COLUMNS: usize>(
    heights: &[f32],
    columns: usize,
    vertex: Vertex,
) -> [[f32; COLUMNS]; ROWS] {
    let (west, south) = (vertex.x as usize - COLUMNS / 2, vertex.y as usize - ROWS / 2);
    let posts = &heights[south * columns + west..][..(ROWS - 1) * columns + COLUMNS];
    std::array::from_fn(|row| *posts[row * columns..].first_chunk().expect("a row of the posts"))
}

#[inline(always)]
fn transposed(posts: [[f32; 5]; 5]) -> [[f32; 5]; 5] {
    std::array::from_fn(|row| std::array::from_fn(|column| posts[column][row]))
}

/// How far a post is off the middle of two others.
#[inline(always)]
fn off_middle(post: f32, one: f32, other: f32) -> f32 {
    (((post - one) + (post - other)) * 0.5).abs()
}

/// Twice how far a post is off the middle of two others.
#[inline(always)]
fn twice_off_middle(post: f32, one: f32, other: f32) -> f32 {
    ((post - one) + (post - other)).abs()
}

#[inline(always)]
fn center_of_step_one(p: [[f32; 3]; 3], rises: bool) -> f32 {
    let (from, to) = if rises { (p[0][0], p[2][2]) } else { (p[0][2], p[2][0]) };
    let south = twice_off_middle(p[0][1], p[0][0], p[0][2]);
    let north = twice_off_middle(p[2][1], p[2][0], p[2][2]);
    let west = twice_off_middle(p[1][0], p[0][0], p[2][0]);
    let east = twice_off_middle(p[1][2], p[0][2], p[2][2]);
    let middle = twice_off_middle(p[1][1], from, to);
    0.5 * larger(middle, larger(larger(south, north), larger(west, east)))
}

/// The vertex is the middle of an edge that runs along the rows of `p`; of these, the posts in the diamond count.
#[inline(always)]
fn edge_of_step_two(p: [[f32; 5]; 5]) -> f32 {
    let at = p[2][2];
    let (from, to) = (p[2][0] - at, p[2][4] - at);
    let (below, above) = (p[0][2] - at, p[4][2] - at);
    let middle = (from + to) * 0.5;
    let off = |post: f32, one: f32, other: f32| ((post - at) - (one + other) * 0.5).abs();
    let along = larger(off(p[2][1], from, middle), off(p[2][3], middle, to));
    let across = larger(off(p[1][2], below, middle), off(p[3][2], above, middle));
    let south = larger(off(p[1][1], below, from), off(p[1][3], below, to));
    let north = larger(off(p[3][1], above, from), off(p[3][3], above, to));
    larger(middle.abs(), larger(larger(along, across), larger(south, north)))
}

#[inline(always)]
fn center_of_step_two(p: [[f32; 5]; 5], rises: bool) -> f32 {
    // Turned so that the hypotenuse joins the first and the last corner.
    let p = if rises { p } else { [4, 3, 2, 1, 0].map(|row| p[row]) };
    let at = p[2][2];
    let [near, aside, over, far] = [p[0][0], p[0][4], p[4][0], p[4][4]].map(|corner| corner - at);
    let below = ((aside - near) * 0.25, (far - aside) * 0.25);
    let above = ((far - over) * 0.25, (over - near) * 0.25);
    let mut worst = 0f32;
    for row in 0..5 {
        for column in 0..5 {
            let (right, up) = if column >= row { below } else { above };
            let plane = near + (right * column as f32 + up * row as f32);
            worst = larger(worst, ((p[row][column] - at) - plane).abs());
        }
    }
    worst
}

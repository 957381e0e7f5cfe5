//! The vertical distances of a mesh over the lattice's posts from the ground, measured at every post.
//!
//! This checks the promise of an error bound, so it shares nothing with what made the mesh except the lattice: it takes the
//! triangles as they are written, in f64. Distances are held for some rows at a time: the largest of a post is known when all
//! triangles that meet its row were looked at. `part_bound` does the same for ground that is in memory part by part.

use std::cmp::Reverse;

use glam::{DVec2, DVec3};

use crate::errors::rows::RowSpans;
use sandtable_mesh::trimesh::TriMesh;
use sandtable_terrain::lattice::{Lattice, Post};

/// Vertical distances between a mesh and the ground, meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The largest.
    pub max_m: f64,
    /// The mean.
    pub mean_m: f64,
    /// The root of the mean square.
    pub rms_m: f64,
    /// Where the largest is, the first in order of rows; `None` where the mesh is empty.
    pub worst: Option<Post>,
    /// Posts with data in a triangle.
    pub measured: usize,
    /// Posts with data in none.
    pub left_out: usize,
}

/// Why a mesh cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BoundError {
    /// A vertex is not on a post of the lattice.
    #[error("vertex {0} of the mesh stands on no post")]
    OffPosts(usize),
    /// A triangle covers a post that has no data.
    #[error("triangle {triangle} of the mesh covers column {column}, row {row}, which has no data")]
    OverHole {
        /// The triangle.
        triangle: usize,
        /// Counted eastward.
        column: u32,
        /// Counted northward.
        row: u32,
    },
}

/// Measures `mesh`, whose vertices are posts of `lattice` at [`Lattice::position`]. A post in several triangles counts with
/// the largest of its distances.
///
/// # Errors
/// See [`BoundError`].
pub fn measure(lattice: &Lattice, mesh: &TriMesh) -> Result<Deviation, BoundError> {
    let posts: Vec<Post> = (0..mesh.positions.len())
        .map(|vertex| post_of(lattice, mesh, vertex).ok_or(BoundError::OffPosts(vertex)))
        .collect::<Result<_, _>>()?;
    let corners_of = |triangle: u32| mesh.triangles[triangle as usize].map(|id| posts[id.index()]);
    let rows_of = |triangle: u32| {
        let rows = corners_of(triangle).map(|post| post.row);
        (rows[0].min(rows[1]).min(rows[2]), rows[0].max(rows[1]).max(rows[2]))
    };
    let mut waiting: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    waiting.sort_by_key(|&triangle| Reverse(rows_of(triangle).0));
    // The first triangle over a hole, and the post there.
    let mut over_hole: Option<(u32, Post)> = None;
    let (mut sums, mut met) = (DeviationSums::default(), Vec::new());
    for band in RowBand::all(lattice) {
        while let Some(triangle) = waiting.pop_if(|triangle| rows_of(*triangle).0 <= band.last) {
            met.push(triangle);
        }
        let mut distances = vec![f64::NAN; band.posts(lattice)];
        for &triangle in &met {
            let corner_posts = corners_of(triangle);
            let corners = mesh.triangles[triangle as usize].map(|id| mesh.positions[id.index()].as_dvec3());
            for span in RowSpans::new(corner_posts).within(band.first, band.last) {
                for post in (span.first..=span.last).map(|column| Post { column, row: span.row }) {
                    let distance = distance(lattice, &corners, &corner_posts, post);
                    if distance.is_nan() && over_hole.is_none_or(|(first, _)| triangle < first) {
                        over_hole = Some((triangle, post));
                    }
                    let slot = &mut distances[lattice.index(post) - band.start(lattice)];
                    *slot = slot.max(distance);
                }
            }
        }
        met.retain(|&triangle| rows_of(triangle).1 > band.last);
        let start = band.start(lattice);
        for (index, &distance) in distances.iter().enumerate() {
            let height = lattice.held_heights()[start + index];
            if !height.is_nan() {
                sums.add(lattice.post_at(start + index), distance);
            }
        }
    }
    match over_hole {
        Some((triangle, Post { column, row })) => {
            Err(BoundError::OverHole { triangle: triangle as usize, column, row })
        }
        None => Ok(sums.deviation()),
    }
}

/// Posts whose distances are held at a time: 32 MiB.
pub(crate) const BAND_POSTS: u32 = 1 << 22;

/// Some rows of posts.
struct RowBand {
    first: u32,
    last: u32,
}

impl RowBand {
    /// All rows of a lattice in bands, from the south.
    fn all(lattice: &Lattice) -> impl Iterator<Item = Self> {
        let (rows, at_once) = (lattice.rows(), (BAND_POSTS / lattice.columns()).max(1));
        (0..rows)
            .step_by(at_once as usize)
            .map(move |first| Self { first, last: (first + (at_once - 1).min(rows - 1 - first)) })
    }

    /// The index of its first post.
    fn start(&self, lattice: &Lattice) -> usize {
        lattice.index(Post { column: 0, row: self.first })
    }

    /// How many posts it has.
    fn posts(&self, lattice: &Lattice) -> usize {
        (self.last - self.first + 1) as usize * lattice.columns() as usize
    }
}

fn post_of(lattice: &Lattice, mesh: &TriMesh, vertex: usize) -> Option<Post> {
    let at = mesh.positions[vertex].truncate();
    let grid = (at.as_dvec2() / lattice.cell()).round();
    let is_inside = grid.cmpge(DVec2::ZERO).all() && grid.cmple(lattice.last_grid()).all();
    let post = Post::at_grid(grid);
    (is_inside && lattice.position(post) == at).then_some(post)
}

/// The distance of a post from the plane of a triangle; from the corner itself where it is one.
pub(crate) fn distance(lattice: &Lattice, corners: &[DVec3; 3], posts: &[Post; 3], post: Post) -> f64 {
    let height = f64::from(lattice.height(post));
    if let Some(corner) = posts.iter().position(|&corner| corner == post) {
        return (height - corners[corner].z).abs();
    }
    let [a, b, c] = *corners;
    let (ab, ac, at) = (b - a, c - a, lattice.position(post).as_dvec2() - a.truncate());
    let doubled_area = ab.truncate().perp_dot(ac.truncate());
    let (toward_b, toward_c) = (at.perp_dot(ac.truncate()), ab.truncate().perp_dot(at));
    (height - (a.z + (toward_b * ab.z + toward_c * ac.z) / doubled_area)).abs()
}

/// What a deviation is made of.
#[derive(Default)]
pub(crate) struct DeviationSums {
    worst: Option<Post>,
    max_m: f64,
    sum: f64,
    squares: f64,
    measured: usize,
    with_data: usize,
}

impl DeviationSums {
    /// Adds the distance of a post with data, NaN where no triangle covers it. The order of the posts is free.
    pub(crate) fn add(&mut self, post: Post, distance: f64) {
        self.with_data += 1;
        if distance.is_nan() {
            return;
        }
        let is_before = |worst: Post| (post.row, post.column) < (worst.row, worst.column);
        if self.worst.is_none_or(|worst| distance > self.max_m || distance == self.max_m && is_before(worst))
        {
            (self.worst, self.max_m) = (Some(post), distance);
        }
        self.sum += distance;
        self.squares += distance * distance;
        self.measured += 1;
    }

    /// What they come to.
    pub(crate) fn deviation(self) -> Deviation {
        let Self { worst, max_m, sum, squares, measured, with_data } = self;
        let count = measured.max(1) as f64;
        let rms_m = (squares / count).sqrt();
        Deviation { max_m, mean_m: sum / count, rms_m, worst, measured, left_out: with_data - measured }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, Vec3};
    use sandtable_mesh::sink::{MeshSink, VertexId};

    fn square() -> (Lattice, TriMesh) {
        let heights = vec![0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, -1.0, 0.0];
        let lattice = Lattice::new(DVec2::ZERO, DVec2::new(10.0, 20.0), 3, heights).expect("sound");
        let mut mesh = TriMesh::default();
        for (x, y) in [(0.0, 0.0), (20.0, 0.0), (20.0, 40.0), (0.0, 40.0)] {
            mesh.vertex(Vec3::new(x, y, 0.0));
        }
        mesh.triangle([0, 1, 2].map(VertexId));
        (lattice, mesh)
    }

    #[test]
    fn every_post_of_a_triangle_counts_and_those_of_none_are_told() {
        let (lattice, mut mesh) = square();
        let half = measure(&lattice, &mesh).expect("on posts");
        assert_eq!((half.max_m, half.measured, half.left_out), (3.0, 6, 3));
        assert_eq!(half.worst, Some(Post { column: 1, row: 1 }));
        mesh.triangle([0, 2, 3].map(VertexId));
        let whole = measure(&lattice, &mesh).expect("on posts");
        assert_eq!((whole.measured, whole.left_out), (9, 0));
        assert!(
            (whole.mean_m - 4.0 / 9.0).abs() < 1e-12 && (whole.rms_m - (10f64 / 9.0).sqrt()).abs() < 1e-12
        );
    }

    #[test]
    fn a_mesh_beside_the_posts_or_over_a_hole_is_refused() {
        let (mut lattice, mut mesh) = square();
        lattice.pin(Post { column: 1, row: 1 }, f32::NAN);
        let over = BoundError::OverHole { triangle: 0, column: 1, row: 1 };
        assert_eq!(measure(&lattice, &mesh), Err(over));
        mesh.positions[1].x += 1.0;
        assert_eq!(measure(&lattice, &mesh), Err(BoundError::OffPosts(1)));
    }
}

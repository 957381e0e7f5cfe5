//! The height contract: what a height query means, the same for the library, the command line and the HTTP service.
//!
//! A query names a [`Surface`], an [`Interpolation`] and a map position. The answer is a height **in meters**, without
//! vertical exaggeration, or the reason why there is none: an [`Answer`], or a number and a
//! [`Status`](sandtable_raster::answer::Status) side by side. A hole is never answered by a bare number.
//!
//! **Surfaces.**
//!
//! | surface | what it is | its grid |
//! |---|---|---|
//! | source | the raster as read; vertical units other than meters are converted in the answer | the raster's own, rotated ones too |
//! | ground | the lattice in meters after earthworks: what is measured, built on and exported | posts, north up |
//! | displayed | the triangles drawn now, whatever the camera and the level of detail | the drawn triangles |
//! | scene | the higher of the ground and the decks over it ([`deck::Deck`]): what one stands on | the ground's, and the decks' triangles |
//!
//! Source and ground never depend on what is drawn; displayed is always planar, whatever the interpolation.
//!
//! **Interpolations.** Within a cell, with the position `(x, y)` in 0..=1 from its south-west corner and the corner
//! heights `sw, se, nw, ne`:
//!
//! ```text
//!  nw ─────── ne
//!  │           │      x east, y north; the diagonal of the cell north-east of post (column, row)
//!  │ (x, y)    │      joins the corners whose coordinates are both even or both odd
//!  sw ─────── se
//! ```
//!
//! | interpolation | formula | continuity | no-data corners |
//! |---|---|---|---|
//! | planar | rising diagonal, `x ≥ y`: `(1−x)·sw + (x−y)·se + y·ne`, and likewise on the other three triangles | continuous, bends at edges and diagonals | no answer where the triangle has one with a weight |
//! | bilinear | `s + (n − s)·y` with `s = sw + (se − sw)·x`, `n = nw + (ne − nw)·x`; the source's as GDAL, [`sandtable_raster::sample`] | continuous, bends at cell edges | left out, weights renormalized |
//! | nearest | the nearest post: a constant cell around each post | steps halfway between posts | no answer |
//! | cubic | Keys 1981 with a = −1/2 over 4 × 4 posts; parabolas continue them beyond the border | continuous, and its slopes | where one of the sixteen has none, bilinear |
//! | distance-weighted | `Σ hᵢ/dᵢ ÷ Σ 1/dᵢ` over the four corners, `d` in meters; at a corner, its height | continuous within a cell, steps across its edges | left out, weights renormalized |
//!
//! At a post all five answer that post's own height. None but the cubic overshoots: but for rounding, an answer lies between
//! the lowest and the highest corner with a weight. The cubic may lie beyond its sixteen posts by 9/32 of what they differ,
//! and runs through the posts of the ground: where that was made finer for narrow works, through the finer ones. The cubic
//! source is GDAL's (`gdalwarp -r cubic` to a finer grid, version 3.6.2): at 3,000 random places each of the elevation of the
//! demo, in degrees, and of a model in UTM the two differ by at most 1.5e-9 m.
//!
//! **Where the model ends.** The ground, and the source's planar and distance-weighted surfaces, end at the outer posts,
//! which belong to them. The source's nearest, bilinear and cubic reach half a sample further, to the outer edge of the outer
//! samples, as GDAL counts pixels. Beyond, the answer is [`Answer::Outside`]; so it is for a position that is not finite,
//! or that cannot be transformed to the surface's coordinate system.
//!
//! **Cost.** A query looks up one cell and its corners, whatever the size of the model. A batch is spread over all
//! threads, allocates nothing per point and equals single queries to the last bit ([`batch`]). Edits are published as
//! whole snapshots ([`service`]).
//!
//! Beside heights: the gradient at a point ([`gradient`]), statistics within a polygon ([`zone`]), and the volumes cut and
//! filled between two snapshots ([`change`]).

pub mod batch;
pub mod cell;
pub mod change;
pub mod choice;
mod cubic;
pub mod deck;
pub mod gradient;
pub mod pieces;
pub mod service;
pub mod source;
pub mod source_raster;
pub mod tiles;
pub mod windowed;
pub mod zone;

use glam::{DVec2, UVec2};

use crate::cell_triangle::Diagonal;
use crate::lattice::{Lattice, Post};
use crate::query::cell::interpolate;
use crate::query::cubic::cubic;
use sandtable_raster::answer::Answer;

/// The surface of a height query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// The raster as read, in its own grid.
    Source,
    /// The lattice after earthworks.
    Ground,
    /// The triangles of the current level of detail; always planar, whatever the interpolation.
    Displayed,
    /// The higher of the ground and the decks over it: what one stands on.
    Scene,
}

/// The interpolation of heights between posts; see the module's table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// On the finest triangles.
    Planar,
    /// Between four posts, as GDAL does.
    #[default]
    Bilinear,
    /// The nearest post's height.
    Nearest,
    /// Through sixteen posts by cubic convolution: smooth, and not between the posts' heights everywhere.
    Cubic,
    /// The four posts around, weighted by inverse distance.
    DistanceWeighted4,
}

/// The height of the ground lattice at a map position.
pub fn ground_height(lattice: &Lattice, interpolation: Interpolation, at: DVec2) -> Answer {
    let Some((cell, part)) = lattice.cell_at(at - lattice.origin()) else {
        return Answer::Outside;
    };
    if interpolation == Interpolation::Cubic {
        let size = UVec2::new(lattice.columns(), lattice.rows());
        let post = |column, row| f64::from(lattice.height(Post { column, row }));
        let height = cubic(cell.grid() + part, size, post);
        if !height.is_nan() {
            return Answer::Height(height);
        }
    }
    let corners = lattice.corner_heights(cell).map(f64::from);
    interpolate(interpolation, corners, part, Diagonal::of_cell(cell), lattice.cell())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Interpolation; 5] = [
        Interpolation::Planar,
        Interpolation::Bilinear,
        Interpolation::Cubic,
        Interpolation::Nearest,
        Interpolation::DistanceWeighted4,
    ];

    fn lattice(height: impl Fn(u32, u32) -> f32) -> Lattice {
        let heights = (0..36).map(|index| height(index % 6, index / 6)).collect();
        Lattice::new(DVec2::new(1000.0, 2000.0), DVec2::new(10.0, 20.0), 6, heights).expect("sound")
    }

    fn at(x: f64, y: f64) -> DVec2 {
        DVec2::new(1000.0 + x, 2000.0 + y)
    }

    #[test]
    fn every_interpolation_returns_the_post_at_a_post() {
        let ground = lattice(|column, row| (column * 7 + row * row) as f32);
        for interpolation in ALL {
            let answer = ground_height(&ground, interpolation, at(30.0, 80.0));
            assert_eq!(answer, Answer::Height(3.0 * 7.0 + 16.0), "{interpolation:?}");
        }
    }

    #[test]
    fn planar_and_bilinear_are_exact_on_a_plane() {
        let ground = lattice(|column, row| column as f32 * 2.0 - row as f32 * 3.0);
        for (x, y) in [(3.0, 4.0), (12.5, 77.0), (49.9, 99.9), (0.0, 0.1), (50.0, 100.0)] {
            let exact = x / 10.0 * 2.0 - y / 20.0 * 3.0;
            for interpolation in [Interpolation::Planar, Interpolation::Bilinear, Interpolation::Cubic] {
                let height = ground_height(&ground, interpolation, at(x, y)).height_m().expect("inside");
                assert!((height - exact).abs() < 1e-9, "{interpolation:?} at {x}, {y}");
            }
        }
    }

    #[test]
    fn the_planar_surface_follows_the_diagonals_of_the_bintree() {
        let peak = lattice(|column, row| if (column, row) == (1, 1) { 8.0 } else { 0.0 });
        let on_diagonal = ground_height(&peak, Interpolation::Planar, at(5.0, 10.0));
        assert_eq!(on_diagonal, Answer::Height(4.0), "the diagonal joins (0, 0) and (1, 1)");
        let beside = lattice(|column, row| if (column, row) == (1, 0) { 8.0 } else { 0.0 });
        assert_eq!(ground_height(&beside, Interpolation::Planar, at(5.0, 10.0)), Answer::Height(0.0));
    }

    #[test]
    fn a_hole_is_not_the_edge_of_the_model() {
        let holed = lattice(|column, _| if column == 2 { f32::NAN } else { 1.0 });
        assert_eq!(ground_height(&holed, Interpolation::Planar, at(15.0, 30.0)), Answer::NoData);
        assert_eq!(ground_height(&holed, Interpolation::Bilinear, at(15.0, 30.0)), Answer::Height(1.0));
        assert_eq!(ground_height(&holed, Interpolation::Cubic, at(35.0, 30.0)), Answer::Height(1.0));
        assert_eq!(ground_height(&holed, Interpolation::Cubic, at(20.0, 40.0)), Answer::NoData);
        assert_eq!(ground_height(&holed, Interpolation::Cubic, at(-1.0, 30.0)), Answer::Outside);
        assert_eq!(ground_height(&holed, Interpolation::Nearest, at(20.0, 40.0)), Answer::NoData);
        assert_eq!(ground_height(&holed, Interpolation::Planar, at(-1.0, 30.0)), Answer::Outside);
    }
}

//! The height query service: one contract for the library, the command line and every room above.
//!
//! A question names a surface, an interpolation and a map position; the answer is a height or the reason why
//! there is none. Within a cell, with the position `(x, y)` in 0..=1 from its south-west corner and the corner
//! heights `sw, se, nw, ne`:
//!
//! | interpolation | formula | continuity | no-data corners |
//! |---|---|---|---|
//! | planar | the plane of the finest bintree triangle that holds the point | continuous | no answer where the triangle has one |
//! | bilinear | `(1−x)(1−y)·sw + x(1−y)·se + (1−x)y·nw + xy·ne`, as GDAL | continuous | left out, weights renormalised |
//! | nearest | the corner nearest to the point: a constant round each post | steps | no answer |
//! | distance-weighted | `Σ hᵢ/dᵢ ÷ Σ 1/dᵢ` over the four corners, `d` in metres | continuous within a cell | left out, weights renormalised |
//!
//! A query costs one look-up of a cell and its corners, whatever the size of the model; a batch is spread over
//! all threads and allocates nothing per point.

pub mod service;

use glam::DVec2;

use crate::dem::raster::Raster;
use crate::dem::sample::{self, Sampled};
use crate::terrain::lattice::Lattice;

/// Which surface a height is asked of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// The raster as read, in its own grid.
    Source,
    /// The lattice after earthworks.
    Ground,
    /// The triangles drawn now; always planar, whatever the interpolation.
    Displayed,
    /// The ground, and the decks over it where there are any: what one stands on.
    Scene,
}

/// How a height between posts is found; see the module's table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// On the finest triangles.
    Planar,
    /// Between four posts, as GDAL does.
    #[default]
    Bilinear,
    /// The nearest post's.
    Nearest,
    /// The four posts around, weighted by nearness.
    DistanceWeighted4,
}

/// A height, or why there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// Metres, without vertical exaggeration.
    Height(f64),
    /// The position lies on the model, where it holds no data.
    NoData,
    /// The position lies outside the model.
    Outside,
}

impl Answer {
    /// The height in metres, where there is one.
    pub fn height_m(self) -> Option<f64> {
        match self {
            Self::Height(height) => Some(height),
            Self::NoData | Self::Outside => None,
        }
    }

    /// `Ok`, `NoData` or `Outside`.
    pub fn status(self) -> &'static str {
        match self {
            Self::Height(_) => "Ok",
            Self::NoData => "NoData",
            Self::Outside => "Outside",
        }
    }
}

/// The height of the ground lattice at a map position.
pub fn ground_height(lattice: &Lattice, interpolation: Interpolation, at: DVec2) -> Answer {
    let Some((cell, part)) = lattice.cell_at(at - lattice.origin()) else {
        return Answer::Outside;
    };
    let corners = lattice.corner_heights(cell).map(f64::from);
    let diagonal = Diagonal::of_cell(u64::from(cell.column), u64::from(cell.row));
    interpolate(interpolation, corners, part, diagonal, lattice.cell())
}

/// The height of a raster at a position in its own coordinates.
///
/// Nearest and bilinear reach half a sample beyond the outer samples, as GDAL counts pixels; planar and
/// distance-weighted end at the outer samples.
pub fn raster_height(raster: &Raster, interpolation: Interpolation, at: DVec2) -> Answer {
    let answer = |sampled: Sampled| match sampled {
        Sampled::Ok(height) => Answer::Height(height),
        Sampled::NoData => Answer::NoData,
        Sampled::Outside => Answer::Outside,
    };
    match interpolation {
        Interpolation::Nearest => answer(sample::nearest(raster, at)),
        Interpolation::Bilinear => answer(sample::bilinear(raster, at)),
        Interpolation::Planar | Interpolation::DistanceWeighted4 => {
            between_samples(raster, interpolation, at)
        }
    }
}

/// Planar and distance-weighted heights of a raster, on the grid of its sample centres.
fn between_samples(raster: &Raster, interpolation: Interpolation, at: DVec2) -> Answer {
    let grid = raster.grid_from_map(at) - 0.5;
    let last = DVec2::new(f64::from(raster.width) - 1.0, f64::from(raster.height) - 1.0);
    if !(grid.cmpge(DVec2::ZERO).all() && grid.cmple(last).all()) || last.min_element() < 1.0 {
        return Answer::Outside;
    }
    let first = grid.floor().min(last - 1.0);
    let (column, row) = (first.x as u32, first.y as u32);
    let corners = [(0, 1), (1, 1), (0, 0), (1, 0)].map(|(x, y)| raster.at(column + x, row + y));
    let part = DVec2::new(grid.x - first.x, 1.0 - (grid.y - first.y));
    let from_south = u64::from(raster.height) - 2 - u64::from(row);
    let matrix = raster.map_from_grid.matrix2;
    let cell = DVec2::new(matrix.x_axis.length(), matrix.y_axis.length());
    interpolate(interpolation, corners, part, Diagonal::of_cell(u64::from(column), from_south), cell)
}

/// Which corners of a cell its diagonal joins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonal {
    /// South-west to north-east.
    Rising,
    /// North-west to south-east.
    Falling,
}

impl Diagonal {
    /// The diagonal of the cell north-east of post (`column`, `row`): it joins the corners whose coordinates
    /// are both even or both odd.
    pub fn of_cell(column: u64, row: u64) -> Self {
        if column % 2 == row % 2 { Self::Rising } else { Self::Falling }
    }
}

fn interpolate(
    interpolation: Interpolation,
    corners: [f64; 4],
    part: DVec2,
    diagonal: Diagonal,
    cell: DVec2,
) -> Answer {
    let weights = match interpolation {
        Interpolation::Planar => planar_weights(part, diagonal),
        Interpolation::Bilinear => bilinear_weights(part),
        Interpolation::Nearest => bilinear_weights((part + 0.5).floor()),
        Interpolation::DistanceWeighted4 => inverse_distance_weights(part, cell),
    };
    let fills_gaps = matches!(interpolation, Interpolation::Bilinear | Interpolation::DistanceWeighted4);
    let (mut sum, mut total) = (0.0, 0.0);
    for (weight, height) in weights.into_iter().zip(corners).filter(|&(weight, _)| weight > 0.0) {
        if !height.is_nan() {
            sum += weight * height;
            total += weight;
        } else if !fills_gaps {
            return Answer::NoData;
        }
    }
    if total == 0.0 { Answer::NoData } else { Answer::Height(if fills_gaps { sum / total } else { sum }) }
}

/// Weights of south-west, south-east, north-west and north-east.
fn bilinear_weights(part: DVec2) -> [f64; 4] {
    let DVec2 { x, y } = part;
    [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
}

fn planar_weights(part: DVec2, diagonal: Diagonal) -> [f64; 4] {
    let DVec2 { x, y } = part;
    match diagonal {
        Diagonal::Rising if x >= y => [1.0 - x, x - y, 0.0, y],
        Diagonal::Rising => [1.0 - y, 0.0, y - x, x],
        Diagonal::Falling if x + y <= 1.0 => [1.0 - x - y, x, y, 0.0],
        Diagonal::Falling => [0.0, 1.0 - y, 1.0 - x, x + y - 1.0],
    }
}

fn inverse_distance_weights(part: DVec2, cell: DVec2) -> [f64; 4] {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
    let distances = corners.map(|corner| ((part - corner) * cell).length());
    match distances.iter().position(|&distance| distance == 0.0) {
        Some(on_post) => std::array::from_fn(|corner| f64::from(u8::from(corner == on_post))),
        None => distances.map(f64::recip),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Interpolation; 4] = [
        Interpolation::Planar,
        Interpolation::Bilinear,
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
            for interpolation in [Interpolation::Planar, Interpolation::Bilinear] {
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
    fn a_hole_is_not_the_edge_of_the_world() {
        let holed = lattice(|column, _| if column == 2 { f32::NAN } else { 1.0 });
        assert_eq!(ground_height(&holed, Interpolation::Planar, at(15.0, 30.0)), Answer::NoData);
        assert_eq!(ground_height(&holed, Interpolation::Bilinear, at(15.0, 30.0)), Answer::Height(1.0));
        assert_eq!(ground_height(&holed, Interpolation::Nearest, at(20.0, 40.0)), Answer::NoData);
        assert_eq!(ground_height(&holed, Interpolation::Planar, at(-1.0, 30.0)), Answer::Outside);
    }
}

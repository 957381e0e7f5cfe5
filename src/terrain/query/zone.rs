//! Elevation statistics within a polygon, exact: integrals of the planar ground, not means of posts.
//!
//! Over a triangle of area `A` with corner heights `a, b, c` the plane's integral is `A (a + b + c)/3`, that of its square
//! `A (a² + b² + c² + ab + bc + ca)/6`. The volume between the plane and a level is that of a prism cut where the plane
//! meets the level.

use glam::DVec2;

use crate::lattice::Lattice;
use crate::query::pieces::{GridRegion, PieceExtent, TrianglePiece};
use crate::volumes::Volumes;

/// Areas and heights within a polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// Square meters of plan with data.
    pub area_m2: f64,
    /// Square meters of plan on the model without data.
    pub no_data_m2: f64,
    /// Square meters of plan beyond the model.
    pub outside_m2: f64,
    /// The heights over the area with data; `None` where there is none.
    pub heights: Option<ZoneHeights>,
}

/// Heights over an area, meters, weighted by plan area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZoneHeights {
    /// The lowest, inside or on the border.
    pub min_m: f64,
    /// The highest, inside or on the border.
    pub max_m: f64,
    /// The mean.
    pub mean_m: f64,
    /// The standard deviation, at least 0.
    pub std_m: f64,
}

/// Sums over a band, heights counted from the reference.
#[derive(Clone, Copy)]
struct BandSums {
    cells: f64,
    no_data_cells: f64,
    sum: f64,
    squares: f64,
    low: f64,
    high: f64,
}

impl Default for BandSums {
    fn default() -> Self {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { cells: 0.0, no_data_cells: 0.0, sum: 0.0, squares: 0.0, low, high }
    }
}

/// The statistics of the planar ground within `region`.
///
/// # Panics
/// Where the region is one of a larger lattice.
pub fn zone(lattice: &Lattice, region: &GridRegion) -> Zone {
    // Counted from a height nearby, squares keep their digits.
    let reference = lattice.heights().iter().copied().find(|height| !height.is_nan()).map_or(0.0, f64::from);
    let bands = region.fold(|sums: &mut BandSums, piece| {
        let corners = lattice.corner_heights(piece.cell).map(|height| f64::from(height) - reference);
        sums.add(region, piece, corners);
    });
    let total = bands.into_iter().fold(BandSums::default(), BandSums::merged);
    let heights = (total.cells > 0.0).then(|| {
        let mean = total.sum / total.cells;
        let variance = (total.squares / total.cells - mean * mean).max(0.0);
        ZoneHeights {
            min_m: total.low + reference,
            max_m: total.high + reference,
            mean_m: mean + reference,
            std_m: variance.sqrt(),
        }
    });
    let area_m2 = |cells: f64| cells.max(0.0) * lattice.cell_m2();
    Zone {
        area_m2: area_m2(total.cells),
        no_data_m2: area_m2(total.no_data_cells),
        outside_m2: area_m2(region.area_cells() - total.cells - total.no_data_cells),
        heights,
    }
}

/// The earth moved when the ground within `region` is brought to `level_m`: cut from above it, filled below it. Ground
/// without data counts as level.
///
/// # Panics
/// Where the region is one of a larger lattice.
pub fn volumes_to_level(lattice: &Lattice, region: &GridRegion, level_m: f64) -> Volumes {
    let bands = region.fold(|cells: &mut Volumes, piece| {
        let rises = lattice.corner_heights(piece.cell).map(|height| level_m - f64::from(height));
        if piece.has_data(rises) {
            add_rises(cells, piece, rises);
        }
    });
    bands.into_iter().map(|cells| cells * lattice.cell_m2()).sum()
}

/// Adds the earth moved, in cells times meters, where a piece's cell corners rise by `rises`.
pub(in crate::query) fn add_rises(cells: &mut Volumes, piece: TrianglePiece<'_>, rises: [f64; 4]) {
    for (corners, area) in piece.fan() {
        let (fill, cut) = above_and_below(corners.map(|at| piece.triangle.height(rises, at)));
        *cells += Volumes { cut_m3: cut, fill_m3: fill } * area;
    }
}

/// The volumes between the plane through three heights and the level 0, above and below it, over a triangle of area 1.
fn above_and_below(mut heights: [f64; 3]) -> (f64, f64) {
    heights.sort_by(f64::total_cmp);
    let [low, middle, high] = heights;
    let mean = (low + middle + high) / 3.0;
    if low >= 0.0 {
        (mean, 0.0)
    } else if high <= 0.0 {
        (0.0, -mean)
    } else if middle <= 0.0 {
        // One corner above: a pyramid, whose base is cut off where two sides meet the level.
        let above = high * (high / (high - low)) * (high / (high - middle)) / 3.0;
        (above, above - mean)
    } else {
        let below = low * (low / (low - high)) * (low / (low - middle)) / -3.0;
        (mean + below, below)
    }
}

impl BandSums {
    fn add(&mut self, region: &GridRegion, piece: TrianglePiece<'_>, corners: [f64; 4]) {
        if !piece.has_data(corners) {
            self.no_data_cells += piece.area_cells();
            return;
        }
        let height = |at: DVec2| piece.triangle.height(corners, at);
        for (triangle, area) in piece.fan() {
            let [a, b, c] = triangle.map(height);
            self.cells += area;
            self.sum += area * (a + b + c) / 3.0;
            self.squares += area * (a * a + b * b + c * c + a * b + b * c + c * a) / 6.0;
        }
        for &at in piece.ring {
            let height = height(at);
            if (height < self.low || height > self.high) && is_in_region(region, piece, at) {
                self.low = self.low.min(height);
                self.high = self.high.max(height);
            }
        }
    }

    fn merged(self, other: Self) -> Self {
        Self {
            cells: self.cells + other.cells,
            no_data_cells: self.no_data_cells + other.no_data_cells,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

/// Whether a vertex of a piece lies in the region. Where a clipped ring runs back along lines of posts, posts beyond the
/// region may be vertices; all other vertices are the polygon's own, or crossings of its border.
fn is_in_region(region: &GridRegion, piece: TrianglePiece<'_>, at: DVec2) -> bool {
    piece.extent == PieceExtent::Whole
        || !piece.triangle.corners().contains(&at)
        || region.contains(piece.cell.grid() + at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(side: u32, cell: DVec2, height: impl Fn(DVec2) -> f64) -> Lattice {
        let at = |index: u32| DVec2::new(f64::from(index % side), f64::from(index / side)) * cell;
        let heights = (0..side * side).map(|index| height(at(index)) as f32).collect();
        Lattice::new(DVec2::ZERO, cell, side, heights).expect("sound")
    }

    fn ring(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().copied().map(DVec2::from).collect()
    }

    fn circle(center: DVec2, radius: f64, count: u32) -> Vec<DVec2> {
        let angle = |index: u32| f64::from(index) * std::f64::consts::TAU / f64::from(count);
        let vertex = |index| center + DVec2::new(libm::cos(angle(index)), libm::sin(angle(index))) * radius;
        (0..count).map(vertex).collect()
    }

    #[test]
    fn on_a_plane_a_triangles_statistics_are_those_of_geometry() {
        let ground = lattice(65, DVec2::new(4.0, 2.0), |at| 1000.0 + 0.5 * at.x - 0.25 * at.y);
        let triangle = ring(&[(10.3, 11.7), (201.9, 33.1), (88.8, 120.4)]);
        let plane = |at: DVec2| 1000.0 + 0.5 * at.x - 0.25 * at.y;
        let [a, b, c] = [0, 1, 2].map(|index| plane(triangle[index]));
        let area = (triangle[1] - triangle[0]).perp_dot(triangle[2] - triangle[0]) / 2.0;
        let found = zone(&ground, &GridRegion::new(&ground, &[triangle]).expect("sound"));
        let heights = found.heights.expect("data");
        let mean = (a + b + c) / 3.0;
        let variance = (a * a + b * b + c * c - a * b - b * c - c * a) / 18.0;
        assert!((found.area_m2 - area).abs() < 1e-7);
        assert!((heights.mean_m - mean).abs() < 1e-9 && (heights.std_m - variance.sqrt()).abs() < 1e-8);
        assert!((heights.min_m - a.min(b).min(c)).abs() < 1e-9);
        assert!((heights.max_m - a.max(b).max(c)).abs() < 1e-9);
        assert_eq!((found.no_data_m2, found.outside_m2 < 1e-7), (0.0, true));
    }

    #[test]
    fn the_volume_of_a_cone_is_a_third_of_its_base_times_its_height() {
        let top = DVec2::splat(300.0);
        let ground = lattice(1201, DVec2::splat(0.5), |at| 100.0 - 0.4 * at.distance(top));
        let base = circle(top, 250.0, 2000);
        let region = GridRegion::new(&ground, &[base]).expect("sound");
        let exact = std::f64::consts::PI * 250.0 * 250.0 * 100.0 / 3.0;
        let volumes = volumes_to_level(&ground, &region, 0.0);
        assert!((volumes.cut_m3 / exact - 1.0).abs() < 1e-5, "{} for {exact}", volumes.cut_m3);
        assert!(volumes.fill_m3 < 1.0);
        let heights = zone(&ground, &region).heights.expect("data");
        assert!((heights.mean_m - 100.0 / 3.0).abs() < 1e-3 && (heights.max_m - 100.0).abs() < 1e-6);
    }

    #[test]
    fn over_whole_waves_a_sinusoid_has_its_mean_deviation_and_volumes() {
        let wave = std::f64::consts::TAU / 200.0;
        let ground = lattice(401, DVec2::ONE, |at| 10.0 * libm::sin(at.x * wave));
        let heights = zone(&ground, &GridRegion::whole(&ground)).heights.expect("data");
        assert!(heights.mean_m.abs() < 1e-6, "{heights:?}");
        assert!((heights.std_m - 10.0 / 2f64.sqrt()).abs() < 2e-3, "{heights:?}");
        assert_eq!((heights.min_m, heights.max_m), (-10.0, 10.0));
        let volumes = volumes_to_level(&ground, &GridRegion::whole(&ground), 0.0);
        assert!((volumes.cut_m3 - volumes.fill_m3).abs() < 1.0);
        let exact = 10.0 * 2.0 / wave * 2.0 * 400.0;
        assert!((volumes.cut_m3 / exact - 1.0).abs() < 2e-4, "{volumes:?} for {exact}");
    }

    #[test]
    fn areas_without_data_and_beyond_the_model_are_separate() {
        let ground =
            lattice(11, DVec2::splat(10.0), |at| if at == DVec2::splat(50.0) { f64::NAN } else { 7.0 });
        let over = ring(&[(-50.0, 0.0), (100.0, 0.0), (100.0, 100.0), (-50.0, 100.0)]);
        let found = zone(&ground, &GridRegion::new(&ground, &[over]).expect("sound"));
        // The post (5, 5) has both coordinates odd: eight triangles of half a cell meet there.
        assert_eq!((found.area_m2, found.no_data_m2, found.outside_m2), (9600.0, 400.0, 5000.0));
        let heights = found.heights.expect("data");
        assert_eq!([heights.min_m, heights.max_m, heights.mean_m, heights.std_m], [7.0, 7.0, 7.0, 0.0]);
        let away = ring(&[(500.0, 500.0), (510.0, 500.0), (500.0, 510.0)]);
        let found = zone(&ground, &GridRegion::new(&ground, &[away]).expect("sound"));
        assert_eq!((found.heights, found.outside_m2), (None, 50.0));
    }

    #[test]
    fn a_peak_beside_the_polygon_does_not_count() {
        let ground = lattice(9, DVec2::ONE, |at| if at == DVec2::splat(4.0) { 100.0 } else { at.x });
        // An L round the peak: clipped, its ring runs along lines of posts.
        let angle = ring(&[(0.5, 0.5), (7.5, 0.5), (7.5, 2.5), (2.5, 2.5), (2.5, 7.5), (0.5, 7.5)]);
        let heights =
            zone(&ground, &GridRegion::new(&ground, &[angle]).expect("sound")).heights.expect("data");
        assert!((heights.min_m - 0.5).abs() < 1e-12 && (heights.max_m - 7.5).abs() < 1e-12, "{heights:?}");
    }

    #[test]
    fn volumes_on_both_sides_of_a_level_differ_by_the_mean() {
        for heights in
            [[-1.0, 2.0, 5.0], [-4.0, -1.0, 2.0], [3.0, 1.0, 2.0], [-3.0, 0.0, 0.0], [0.0, 0.0, 6.0]]
        {
            let (above, below) = above_and_below(heights);
            let mean = heights.iter().sum::<f64>() / 3.0;
            assert!((above - below - mean).abs() < 1e-12 && above >= 0.0 && below >= 0.0, "{heights:?}");
        }
        let (above, _) = above_and_below([-1.0, -1.0, 1.0]);
        assert!((above - 1.0 / 12.0).abs() < 1e-15, "a pyramid on a quarter of the area, 1 high");
    }
}

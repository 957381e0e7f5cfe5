//! Heights of the raster as read, in its own grid.
//!
//! Nearest and bilinear are GDAL's ([`sandtable_raster::sample`]); they and the cubic reach half a sample beyond the centers of the
//! outer samples, whose heights they hold there. Planar and distance-weighted use the grid of sample centers and end at the outer ones. Heights in another unit
//! are converted to meters.

use glam::{DVec2, UVec2};

use crate::cell_triangle::Diagonal;
use crate::lattice::Post;
use crate::query::Interpolation;
use crate::query::batch::{self, HeightSlices};
use crate::query::cell::interpolate;
use crate::query::cubic::cubic;
use sandtable_geom::crs::Crs;
use sandtable_raster::answer::Answer;
use sandtable_raster::raster::Raster;
use sandtable_raster::sample::{self, SampleGrid};

/// Positions that are transformed to the raster's system at a time, on the stack.
const TRANSFORMED: usize = 512;

/// The height of a raster at a position in its own coordinates, in meters.
pub fn raster_height(raster: &impl SampleGrid, interpolation: Interpolation, at: DVec2) -> Answer {
    let answer = match interpolation {
        Interpolation::Nearest => sample::nearest(raster, at),
        Interpolation::Bilinear => sample::bilinear(raster, at),
        Interpolation::Cubic => cubic_between_samples(raster, at),
        Interpolation::Planar | Interpolation::DistanceWeighted4 => {
            between_samples(raster, interpolation, at)
        }
    };
    match answer {
        Answer::Height(height) => Answer::Height(height * raster.whole().meters_per_z),
        none => none,
    }
}

/// The height of a raster as read at a position in coordinates of `from`, in meters.
///
/// A raster without a system lies in `from`. A position that cannot be transformed to the raster's system lies
/// [`Answer::Outside`].
pub fn source_height(source: &Raster, from: &Crs, interpolation: Interpolation, at: DVec2) -> Answer {
    raster_height(source, interpolation, SourceTransform::new(source, from).position(at))
}

/// [`source_height`] at many positions, in order, spread over all threads.
///
/// # Panics
/// Where `out` is not as long as `at`.
pub fn source_heights(
    source: &Raster,
    from: &Crs,
    interpolation: Interpolation,
    at: &[DVec2],
    out: &mut [Answer],
) {
    batch::answers(at, out, |at, out| source_task(source, from, interpolation, at, out));
}

/// [`source_heights`] as heights and statuses in slices of their own.
///
/// # Panics
/// Where the slices are not as long as `at`.
pub fn source_heights_apart(
    source: &Raster,
    from: &Crs,
    interpolation: Interpolation,
    at: &[DVec2],
    out: HeightSlices<'_>,
) {
    out.check_len(at.len());
    batch::spread(at, out, |at, out| source_task(source, from, interpolation, at, out));
}

/// [`source_height`] at many positions, on this thread.
pub(in crate::query) fn source_task(
    source: &Raster,
    from: &Crs,
    interpolation: Interpolation,
    at: &[DVec2],
    mut out: HeightSlices<'_>,
) {
    let transform = SourceTransform::new(source, from);
    if interpolation != Interpolation::Bilinear {
        out.fill(at, |at| raster_height(source, interpolation, transform.position(at)));
    } else if transform.is_identity() {
        batch::bilinear_raster(source, at, out);
    } else {
        let mut transformed = [DVec2::NAN; TRANSFORMED];
        for (at, out) in at.chunks(TRANSFORMED).zip(out.chunks_mut(TRANSFORMED)) {
            let transformed = &mut transformed[..at.len()];
            transformed.iter_mut().zip(at).for_each(|(to, &at)| *to = transform.position(at));
            batch::bilinear_raster(source, transformed, out);
        }
    }
}

/// The transform from one system's positions to a raster's own.
pub struct SourceTransform<'a> {
    from: &'a Crs,
    /// The raster's system, where it is another.
    to: Option<&'a Crs>,
    /// West and east of a raster in degrees.
    degrees: Option<(f64, f64)>,
}

impl<'a> SourceTransform<'a> {
    /// The transform to the system of `source`, whose samples are not used.
    pub fn new(source: &'a Raster, from: &'a Crs) -> Self {
        let own = source.crs.as_ref();
        let degrees = own.filter(|own| own.is_geographic()).map(|_| source.extent());
        Self {
            from,
            to: own.filter(|&own| own != from),
            degrees: degrees.map(|extent| (extent.min.x, extent.max.x)),
        }
    }

    /// Whether every position stays as it is.
    fn is_identity(&self) -> bool {
        self.to.is_none() && self.degrees.is_none()
    }

    /// A position in the raster's own coordinates; NaN where it cannot be transformed.
    pub fn position(&self, at: DVec2) -> DVec2 {
        let at = match self.to {
            Some(to) => self.from.transform(to, at).unwrap_or(DVec2::NAN),
            None => at,
        };
        match self.degrees {
            // A raster across the date line continues longitudes beyond 180°; positions may restart at −180°.
            Some((west, east)) if !(west..=east).contains(&at.x) => {
                let turns = (((west + east) / 2.0 - at.x) / 360.0).round();
                at + DVec2::X * (360.0 * turns)
            }
            _ => at,
        }
    }
}

/// The cubic height of a raster, in its vertical unit; bilinear where one of its samples has no data.
fn cubic_between_samples(grid: &impl SampleGrid, at: DVec2) -> Answer {
    let (raster, bilinear) = (grid.whole(), sample::bilinear(grid, at));
    if bilinear == Answer::Outside {
        return bilinear;
    }
    let size = UVec2::new(raster.width, raster.height);
    let from_first = (raster.grid_from_map(at) - 0.5).clamp(DVec2::ZERO, (size - 1).as_dvec2());
    // Rounding in map coordinates must not mix a neighbor, or a hole, into an exact value.
    let center = from_first.round();
    let is_on = (from_first - center).abs().cmple(DVec2::splat(sample::ON_CENTER));
    let height = cubic(DVec2::select(is_on, center, from_first), size, |column, row| grid.value(column, row));
    if height.is_nan() { bilinear } else { Answer::Height(height) }
}

/// Planar and distance-weighted heights of a raster, on the grid of its sample centers, in its vertical unit.
fn between_samples(samples: &impl SampleGrid, interpolation: Interpolation, at: DVec2) -> Answer {
    let raster = samples.whole();
    let grid = raster.grid_from_map(at) - 0.5;
    let last = DVec2::new(f64::from(raster.width) - 1.0, f64::from(raster.height) - 1.0);
    if !(grid.cmpge(DVec2::ZERO).all() && grid.cmple(last).all()) || last.min_element() < 1.0 {
        return Answer::Outside;
    }
    let first = grid.floor().min(last - 1.0);
    let (column, row) = (first.x as u32, first.y as u32);
    let corners = [(0, 1), (1, 1), (0, 0), (1, 0)].map(|(x, y)| samples.value(column + x, row + y));
    let part = DVec2::new(grid.x - first.x, 1.0 - (grid.y - first.y));
    // Rows count from the south in a lattice.
    let diagonal = Diagonal::of_cell(Post { column, row: raster.height - 2 - row });
    interpolate(interpolation, corners, part, diagonal, raster.spacing())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_dem::hints::DemOptions;
    use sandtable_dem::read;

    fn read_grid(text: &str, crs: Option<Crs>) -> Raster {
        let hints = DemOptions { crs, ..DemOptions::default() }.into();
        read::read("a.asc", text.as_bytes(), &hints).expect("sound")
    }

    #[test]
    fn the_source_across_the_date_line_answers_on_both_sides() {
        let text = "ncols 4\nnrows 2\nxllcorner 179.8\nyllcorner -16.1\ncellsize 0.1\n1 2 3 4\n1 2 3 4\n";
        let source = read_grid(text, Some(Crs::wgs84()));
        let utm = Crs::from_epsg(32701).expect("a zone");
        for (longitude, height) in [(179.85, 1.0), (179.95, 2.0), (-179.95, 3.0), (180.15, 4.0)] {
            let at = Crs::wgs84().transform(&utm, DVec2::new(longitude, -16.0)).expect("inside");
            let answer = source_height(&source, &utm, Interpolation::Nearest, at);
            assert_eq!(answer, Answer::Height(height));
        }
    }

    #[test]
    fn the_cubic_source_keeps_a_parabola_and_holds_its_outer_samples() {
        // Columns 10 m apart at x = 5, 15 and so on hold the squares of 0 to 5; the middle of the last row is a hole.
        let squares = "0 1 4 9 16 25\n";
        let hole = "0 1 -9999 -9999 16 25\n";
        let head = "ncols 6\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
        let source = read_grid(&format!("{head}{}{hole}", squares.repeat(4)), None);
        let at = |x: f64, y: f64| raster_height(&source, Interpolation::Cubic, DVec2::new(x, y));
        for column in [0.0f64, 0.3, 1.5, 2.25, 4.9, 5.0] {
            let height = at(5.0 + 10.0 * column, 33.0).height_m().expect("inside");
            assert!((height - column * column).abs() < 1e-9, "{column}: {height}");
        }
        assert_eq!([at(0.0, 50.0), at(60.0, 33.0)], [Answer::Height(0.0), Answer::Height(25.0)]);
        let bilinear = |x, y| raster_height(&source, Interpolation::Bilinear, DVec2::new(x, y));
        assert_eq!(at(20.0, 17.0), bilinear(20.0, 17.0), "beside a hole");
        assert_eq!([at(30.0, 2.0), at(61.0, 33.0)], [Answer::NoData, Answer::Outside]);
    }

    #[test]
    fn heights_in_feet_are_converted_to_meters() {
        let text = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n100 100\n100 100\n";
        let mut source = read_grid(text, None);
        source.meters_per_z = 0.3048;
        for interpolation in [
            Interpolation::Planar,
            Interpolation::Bilinear,
            Interpolation::Cubic,
            Interpolation::Nearest,
            Interpolation::DistanceWeighted4,
        ] {
            let answer = raster_height(&source, interpolation, DVec2::splat(10.0));
            assert_eq!(answer, Answer::Height(100.0 * 0.3048), "{interpolation:?}");
        }
    }
}

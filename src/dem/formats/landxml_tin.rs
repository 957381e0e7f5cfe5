//! Triangles of a surface, sampled at the centers of cells.

use glam::{DVec2, DVec3};

use sandtable_raster::cell_grid::CellGrid;

/// The most cells that are looked at, over all triangles: seconds.
const MOST_STEPS: u64 = 1 << 31;

/// How far beyond its sides a triangle counts, as a part of its weights: rounding.
const SLACK: f64 = 1e-9;

/// Points and the triangles between them.
#[derive(Default)]
pub(super) struct LandTin {
    /// Easting, northing, elevation.
    pub points: Vec<DVec3>,
    pub faces: Vec<[u32; 3]>,
}

/// Why triangles are not sampled.
#[derive(Debug)]
pub(super) enum TinFault {
    /// They overlap so often that it would take minutes.
    TooMuchWork,
}

impl LandTin {
    /// The corners of all triangles.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.faces.iter().flatten().map(|&number| self.points[number as usize])
    }

    /// The elevation at the center of every cell, row by row from the north; NaN where no triangle is. Where triangles
    /// overlap the first counts.
    pub fn sampled(&self, cells: &CellGrid) -> Result<Vec<f64>, TinFault> {
        let (width, height) = (cells.width() as usize, cells.height() as usize);
        let mut values = vec![f64::NAN; width * height];
        let mut steps = 0_u64;
        for face in &self.faces {
            let corners = face.map(|number| self.points[number as usize]);
            let Some(plane) = FacePlane::of(corners) else { continue };
            let low = corners.map(|at| at.y).into_iter().fold(f64::INFINITY, f64::min);
            let high = corners.map(|at| at.y).into_iter().fold(f64::NEG_INFINITY, f64::max);
            // Rows run south.
            let row_of = |y: f64| (cells.corner().y - y) / cells.cell();
            let rows = clamped(row_of(high) - 1.0, height)..clamped(row_of(low) + 1.0, height);
            for row in rows {
                let y = cells.center(0, row as u32).y;
                let Some([west, east]) = span(corners, y) else { continue };
                let column_of = |x: f64| (x - cells.corner().x) / cells.cell();
                let columns = clamped(column_of(west) - 1.0, width)..clamped(column_of(east) + 1.0, width);
                steps += 1 + columns.len() as u64;
                if steps > MOST_STEPS {
                    return Err(TinFault::TooMuchWork);
                }
                for column in columns {
                    let value = &mut values[row * width + column];
                    if value.is_nan() {
                        *value = plane.at(DVec2::new(cells.center(column as u32, 0).x, y));
                    }
                }
            }
        }
        Ok(values)
    }
}

fn clamped(place: f64, count: usize) -> usize {
    place.max(0.0).min(count as f64) as usize
}

/// The west and the east end of a triangle on the line of a northing, with a cell's slack at flat ends.
fn span(corners: [DVec3; 3], y: f64) -> Option<[f64; 2]> {
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(from, to)| (corners[from], corners[to])) {
        let (low, high) = (from.y.min(to.y), from.y.max(to.y));
        if y < low || y > high {
            continue;
        }
        let rise = to.y - from.y;
        let crossed =
            if rise == 0.0 { [from.x, to.x] } else { [from.x + (to.x - from.x) * ((y - from.y) / rise); 2] };
        for x in crossed {
            ends = [ends[0].min(x), ends[1].max(x)];
        }
    }
    (ends[0] <= ends[1]).then_some(ends)
}

/// A triangle as weights of its corners.
struct FacePlane {
    corners: [DVec3; 3],
    doubled_area: f64,
}

impl FacePlane {
    /// `None` of a triangle without area in plan.
    fn of(corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(DVec3::truncate);
        let doubled_area = (b - a).perp_dot(c - a);
        (doubled_area != 0.0 && doubled_area.is_finite()).then_some(Self { corners, doubled_area })
    }

    /// The elevation at a place; NaN outside.
    fn at(&self, place: DVec2) -> f64 {
        let [a, b, c] = self.corners.map(|corner| corner.truncate() - place);
        let weights = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)].map(|area| area / self.doubled_area);
        if weights.iter().any(|weight| *weight < -SLACK) {
            return f64::NAN;
        }
        weights.iter().zip(self.corners).map(|(weight, corner)| weight * corner.z).sum()
    }
}

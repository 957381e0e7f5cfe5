//! The georeference of a GeoTIFF: by a tie point and a scale, a matrix, or control points.

use glam::{DAffine2, DMat2, DVec2};

use sandtable_raster::error::DemErrorKind;
use sandtable_raster::georef::{affine, checked};
use sandtable_raster::raster::north_up;

/// How far, in samples, a tie point may lie from the map that is fitted through all of them.
const TIE_TOLERANCE: f64 = 1e-3;

/// The tags that place a TIFF; empty where absent.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlaceTags {
    /// ModelPixelScale.
    pub scale: Vec<f64>,
    /// ModelTiepoint.
    pub ties: Vec<f64>,
    /// ModelTransformation.
    pub matrix: Vec<f64>,
    /// Whether positions are those of samples' centers (PixelIsPoint).
    pub is_point: bool,
}

impl PlaceTags {
    /// Grid position to map coordinates; `None` where the tags state no place.
    ///
    /// As in GDAL the sign of a scale is ignored: rows run south. Tie points without a scale give the affine map
    /// through all of them.
    pub fn map_from_grid(&self) -> Result<Option<DAffine2>, DemErrorKind> {
        let area = if let (&[x, y, ..], true) = (&self.scale[..], self.ties.len() >= 6) {
            let cell = DVec2::new(x, y.abs());
            let tie = Tie::from(&self.ties[..6]);
            north_up(DVec2::new(tie.map.x - tie.grid.x * cell.x, tie.map.y + tie.grid.y * cell.y), cell)
        } else if let [a, b, _, c, d, e, _, f, ..] = self.matrix[..] {
            affine([c, a, b, f, d, e])
        } else if self.ties.len() >= 18 {
            fit(&self.ties.chunks_exact(6).map(Tie::from).collect::<Vec<_>>())?
        } else {
            return Ok(None);
        };
        let half = if self.is_point { 0.5 } else { 0.0 };
        checked(area * DAffine2::from_translation(DVec2::splat(-half))).map(Some)
    }
}

#[derive(Clone, Copy)]
struct Tie {
    grid: DVec2,
    map: DVec2,
}

impl From<&[f64]> for Tie {
    fn from(numbers: &[f64]) -> Self {
        let at = |index: usize| numbers.get(index).copied().unwrap_or(f64::NAN);
        Self { grid: DVec2::new(at(0), at(1)), map: DVec2::new(at(3), at(4)) }
    }
}

/// The affine map through all ties by least squares, refused where it misses one.
fn fit(ties: &[Tie]) -> Result<DAffine2, DemErrorKind> {
    let count = ties.len() as f64;
    let mean = |position: fn(&Tie) -> DVec2| ties.iter().map(position).sum::<DVec2>() / count;
    let (grid_mean, map_mean) = (mean(|tie| tie.grid), mean(|tie| tie.map));
    let (mut square, mut cross) = (DMat2::ZERO, DMat2::ZERO);
    for tie in ties {
        let (grid, map) = (tie.grid - grid_mean, tie.map - map_mean);
        square += DMat2::from_cols(grid * grid.x, grid * grid.y);
        cross += DMat2::from_cols(map * grid.x, map * grid.y);
    }
    let axes = cross * square.inverse();
    let fitted = DAffine2 { matrix2: axes, translation: map_mean - axes * grid_mean };
    let off = |tie: &Tie| (axes.inverse() * (tie.map - fitted.transform_point2(tie.grid))).length();
    // A NaN is kept, and refused.
    let worst = ties.iter().map(off).fold(0.0, |worst: f64, off| if off <= worst { worst } else { off });
    if worst <= TIE_TOLERANCE {
        return Ok(fitted);
    }
    Err(DemErrorKind::Georeference {
        reason: format!("no straight map goes through its {} control points", ties.len()),
        remedy: "rectify it first, for example with: gdalwarp FILE out.tif",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_raster_reaches_half_a_sample_further_out() {
        let area = PlaceTags {
            scale: vec![2.0, -2.0, 0.0],
            ties: vec![1.0, 1.0, 0.0, 100.0, 50.0, 0.0],
            ..PlaceTags::default()
        };
        let place = area.map_from_grid().expect("fine").expect("stated");
        assert_eq!(place.transform_point2(DVec2::ZERO), DVec2::new(98.0, 52.0));
        let point = PlaceTags { is_point: true, ..area };
        let place = point.map_from_grid().expect("fine").expect("stated");
        assert_eq!(place.transform_point2(DVec2::ZERO), DVec2::new(97.0, 53.0));
    }

    #[test]
    fn tie_points_on_a_straight_map_are_read_and_others_refused() {
        let tie = |column: f64, row: f64| [column, row, 0.0, 10.0 * column + 7.0, 5.0 - 10.0 * row, 0.0];
        let mut ties = [tie(0.0, 0.0), tie(9.0, 1.0), tie(3.0, 8.0), tie(5.0, 5.0)].concat();
        let tags = |ties: &[f64]| PlaceTags { ties: ties.to_vec(), ..PlaceTags::default() };
        let place = tags(&ties).map_from_grid().expect("straight").expect("stated");
        assert!(place.transform_point2(DVec2::new(2.0, 3.0)).distance(DVec2::new(27.0, -25.0)) < 1e-9);
        ties[3] += 1.0;
        assert!(tags(&ties).map_from_grid().is_err());
        assert!(tags(&[0.0; 18]).map_from_grid().is_err());
        assert!(tags(&[f64::NAN; 24]).map_from_grid().is_err());
    }
}

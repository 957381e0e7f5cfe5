//! Where a raster lies: from TIFF tags, a world file beside it, or a stated cell.

use glam::{DAffine2, DMat2, DVec2};

use crate::dem::error::DemErrorKind;
use crate::dem::raster::north_up;
use crate::dem::read::DemFile;

/// How far, in samples, a tie point may lie from the map that is fitted through all of them.
const TIE_TOLERANCE: f64 = 1e-3;

/// The remedy where control points need more than an affine map.
const WARP_FIRST: &str = "rectify it first, for example with: gdalwarp FILE out.tif";

/// A raster's place, and whether anybody stated it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RasterPlace {
    /// Grid position to map coordinates.
    pub map_from_grid: DAffine2,
    /// Whether the file, a companion or the caller stated it.
    pub stated: bool,
}

/// The tags of a TIFF that place it; empty where absent.
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
    /// The place that the tags state; `None` where they state none.
    ///
    /// As in GDAL a scale's sign is not looked at: rows run south. Tie points without a scale give the affine
    /// map through all of them.
    pub fn place(&self) -> Result<Option<DAffine2>, DemErrorKind> {
        let found = if let (&[x, y, ..], true) = (&self.scale[..], self.ties.len() >= 6) {
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
        checked(found * DAffine2::from_translation(DVec2::splat(-half))).map(Some)
    }
}

/// The place of a file that does not hold one: by a world file with one of `extensions`, or by the hinted
/// cell, or else with samples 1 apart and nothing stated.
pub(crate) fn beside(
    source: &DemFile,
    height: u32,
    extensions: &[&str],
) -> Result<RasterPlace, DemErrorKind> {
    if let Some(text) = extensions.iter().find_map(|extension| source.companion(extension)) {
        return Ok(RasterPlace { map_from_grid: world_file(&String::from_utf8_lossy(&text))?, stated: true });
    }
    let cell = source.cell()?;
    let size = DVec2::splat(cell.unwrap_or(1.0));
    let corner = DVec2::new(-0.5, f64::from(height) - 0.5) * size;
    Ok(RasterPlace { map_from_grid: north_up(corner, size), stated: cell.is_some() })
}

/// The six numbers of a world file: x per column, y per column, x per row, y per row, and the center of the
/// first sample.
fn world_file(text: &str) -> Result<DAffine2, DemErrorKind> {
    let numbers: Vec<f64> =
        text.split_ascii_whitespace().map_while(|word| word.replace(',', ".").parse().ok()).collect();
    let [a, d, b, e, c, f] = numbers[..] else {
        return Err(DemErrorKind::Georeference {
            reason: format!("the world file beside it holds {} numbers, not six", numbers.len()),
            remedy: "write it again, or remove it",
        });
    };
    checked(affine([c, a, b, f, d, e]) * DAffine2::from_translation(DVec2::splat(-0.5)))
}

/// GDAL's six numbers as a transform.
fn affine([x, x_column, x_row, y, y_column, y_row]: [f64; 6]) -> DAffine2 {
    let axes = DMat2::from_cols(DVec2::new(x_column, y_column), DVec2::new(x_row, y_row));
    DAffine2 { matrix2: axes, translation: DVec2::new(x, y) }
}

/// The transform, if it is finite and can be inverted.
fn checked(map_from_grid: DAffine2) -> Result<DAffine2, DemErrorKind> {
    let determinant = map_from_grid.matrix2.determinant();
    if map_from_grid.is_finite() && determinant.is_normal() && map_from_grid.matrix2.inverse().is_finite() {
        return Ok(map_from_grid);
    }
    Err(DemErrorKind::Georeference {
        reason: "its cells have no area or its corner is not finite".into(),
        remedy: "write the georeference again, for example with: gdal_edit.py -a_ullr",
    })
}

/// A grid position and where it lies on the map.
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

/// The affine map through all ties by least squares, refused where it does not meet them.
fn fit(ties: &[Tie]) -> Result<DAffine2, DemErrorKind> {
    let count = ties.len() as f64;
    let mean = |of: fn(&Tie) -> DVec2| ties.iter().map(of).sum::<DVec2>() / count;
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
    let worst = ties.iter().map(off).fold(0.0, |worst: f64, off| if off <= worst { worst } else { off });
    if worst <= TIE_TOLERANCE {
        return Ok(fitted);
    }
    Err(DemErrorKind::Georeference {
        reason: format!("no straight map goes through its {} control points", ties.len()),
        remedy: WARP_FIRST,
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
        let place = area.place().expect("fine").expect("stated");
        assert_eq!(place.transform_point2(DVec2::ZERO), DVec2::new(98.0, 52.0));
        let point = PlaceTags { is_point: true, ..area };
        let place = point.place().expect("fine").expect("stated");
        assert_eq!(place.transform_point2(DVec2::ZERO), DVec2::new(97.0, 53.0));
    }

    #[test]
    fn tie_points_on_a_straight_map_are_read_and_others_refused() {
        let tie = |column: f64, row: f64| [column, row, 0.0, 10.0 * column + 7.0, 5.0 - 10.0 * row, 0.0];
        let mut ties = [tie(0.0, 0.0), tie(9.0, 1.0), tie(3.0, 8.0), tie(5.0, 5.0)].concat();
        let tags = |ties: &[f64]| PlaceTags { ties: ties.to_vec(), ..PlaceTags::default() };
        let place = tags(&ties).place().expect("straight").expect("stated");
        assert!(place.transform_point2(DVec2::new(2.0, 3.0)).distance(DVec2::new(27.0, -25.0)) < 1e-9);
        ties[3] += 1.0;
        assert!(tags(&ties).place().is_err());
        assert!(tags(&[0.0; 18]).place().is_err());
        assert!(tags(&[f64::NAN; 24]).place().is_err());
    }

    #[test]
    fn a_world_file_states_the_center_of_the_first_sample() {
        let place = world_file("2,0\n0\n0\n-2\n101\n199\n").expect("six numbers");
        assert_eq!(place.transform_point2(DVec2::ZERO), DVec2::new(100.0, 200.0));
        assert!(world_file("1 2 3").is_err());
        assert!(world_file("0 0 0 0 0 0").is_err());
    }
}

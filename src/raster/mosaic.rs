//! Joins the tiles of one raster.
//!
//! Tiles of one raster have one coordinate system, one vertical unit and one grid: their cells are alike and their
//! samples coincide, within a thousandth of a cell. Other tiles are refused by name, never resampled.
//!
//! Where tiles share samples (SRTM tiles share their border rows and columns), **the first tile with a value wins**;
//! the others are compared with it, and how many differ and by how much is reported. Samples of the mosaic's rectangle
//! that no tile covers are gaps: no data, and counted. Longitudes may continue across ±180°: the mosaic starts east of
//! the widest gap.

use glam::{DVec2, I64Vec2, U64Vec2};

use crate::raster::{Raster, SampleFloat, Samples};
use crate::units::FOOT_M;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::limits::TILE_SAMPLES;
use sandtable_base::message::numbers::counted;
use sandtable_geom::crs::Crs;

/// The greatest distance, in cells, of a tile's samples from the nodes of the first tile's grid.
pub const ALIGNMENT: f64 = 1e-3;

/// Tiles joined to one raster, with statistics of their overlaps and gaps.
#[derive(Clone, Debug)]
pub struct Mosaic {
    /// The smallest rectangle around all tiles.
    pub raster: Raster,
    /// The number of tiles.
    pub tiles: usize,
    /// Values of a tile where an earlier one holds a value already.
    pub overlaps: u64,
    /// How many of those differ from the earlier one, which was kept.
    pub differing: u64,
    /// The greatest difference among them, in the vertical unit; 0 where none differs.
    pub greatest_difference: f64,
    /// How many of those have the ratio of a foot to a meter, within 1 %.
    pub in_feet: u64,
    /// Samples that no tile covers.
    pub gaps: u64,
    /// How many tiles state no vertical datum where others do.
    pub without_datum: usize,
}

impl Mosaic {
    /// The counts in one line, for the user.
    pub fn note(&self) -> String {
        let mut note = format!(
            "{} joined; {} shared",
            counted(self.tiles, "tile", "tiles"),
            counted(self.overlaps, "sample is", "samples are")
        );
        if self.differing > 0 {
            note.push_str(&format!(
                ", {}, by up to {} (the first tile's were kept)",
                counted(self.differing, "of them differs", "of them differ"),
                self.greatest_difference
            ));
        }
        if self.gaps > 0 {
            note.push_str(&format!("; {} in no tile", counted(self.gaps, "sample lies", "samples lie")));
        }
        if let Some(datum) = self.raster.vertical_datum.as_ref().filter(|_| self.without_datum > 0) {
            note.push_str(&format!(
                "; {} of them state no vertical datum and are taken to be above {datum}, as the others state",
                self.without_datum
            ));
        }
        note
    }
}

/// The reason why tiles do not form one raster.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum MosaicError {
    #[error("there is no elevation file to join")]
    Empty,
    #[error("{0} does not state where it lies, so it cannot be joined")]
    NoPlace(String),
    #[error(
        "{first} and {other} are not tiles of one raster: their {what} are {} and {}; bring them to one, for example with: sandtable dem convert",
        .found[0], .found[1]
    )]
    Differ { first: String, other: String, what: &'static str, found: [String; 2] },
    #[error(
        "{first} and {other} are not tiles of one raster: the second's samples lie ({:.4}, {:.4}) cells off the first's; bring them to one grid, for example with: gdalwarp -tap",
        .off.x, .off.y
    )]
    Misaligned {
        first: String,
        other: String,
        /// In cells, from −0.5 to 0.5.
        off: DVec2,
    },
    /// The tiles hold more samples together than are joined; those up to the tile that is too many.
    #[error(
        "the tiles hold {0} samples, more than the {TILE_SAMPLES} that are joined; join fewer, or {TILE_SAMPLES:#}"
    )]
    TooMany(u64),
    #[error(
        "the tiles span {} x {} samples, more than the {RASTER_SAMPLES} of a raster; join fewer, or {RASTER_SAMPLES:#}", .0.x, .0.y
    )]
    TooLarge(U64Vec2),
}

/// Tiles of one raster, in the order in which they win.
#[derive(Clone, Debug, Default)]
pub struct Tiles {
    names: Vec<String>,
    rasters: Vec<Raster>,
    samples: u64,
}

impl Tiles {
    /// Adds a tile; messages call it `name`.
    ///
    /// # Errors
    /// [`MosaicError::TooMany`].
    pub fn push(&mut self, name: impl Into<String>, tile: Raster) -> Result<(), MosaicError> {
        self.samples += u64::from(tile.width) * u64::from(tile.height);
        self.names.push(name.into());
        self.rasters.push(tile);
        if self.samples > TILE_SAMPLES.get() { Err(MosaicError::TooMany(self.samples)) } else { Ok(()) }
    }

    /// Joins the tiles.
    ///
    /// One tile is returned as it is. The mosaic's format, stored type and no-data value are the first tile's; its
    /// samples take 64 bits where any tile's do.
    ///
    /// # Errors
    /// [`MosaicError`]; nothing is allocated before all tiles were compared.
    pub fn join(mut self) -> Result<Mosaic, MosaicError> {
        if self.rasters.len() < 2 {
            let raster = self.rasters.pop().ok_or(MosaicError::Empty)?;
            return Ok(Mosaic {
                raster,
                tiles: 1,
                overlaps: 0,
                differing: 0,
                greatest_difference: 0.0,
                in_feet: 0,
                gaps: 0,
                without_datum: 0,
            });
        }
        let corners = self.corners()?;
        let frame = MosaicFrame::around(&self.rasters, &corners, RASTER_SAMPLES.get())?;
        Ok(if self.rasters.iter().any(|tile| matches!(tile.samples, Samples::F64(_))) {
            join::<f64>(&self.rasters, &corners, frame)
        } else {
            join::<f32>(&self.rasters, &corners, frame)
        })
    }

    /// Tiles whose samples are not in memory, with their names.
    pub(crate) fn of_headers(tiles: Vec<(String, Raster)>) -> Self {
        let (names, rasters) = tiles.into_iter().unzip();
        Self { names, rasters, samples: 0 }
    }

    /// The tiles with their names.
    pub(crate) fn into_named(self) -> Vec<(String, Raster)> {
        self.names.into_iter().zip(self.rasters).collect()
    }

    /// The mosaic of tiles whose samples are not in memory, without its own, and the place of each tile's first sample in it:
    /// columns and rows. It may hold `most` samples.
    ///
    /// # Errors
    /// [`MosaicError`].
    pub(crate) fn placed(&self, most: u64) -> Result<(Raster, Vec<U64Vec2>), MosaicError> {
        let corners = self.corners()?;
        let frame = MosaicFrame::around(&self.rasters, &corners, most)?;
        let is_wide = self.rasters.iter().any(|tile| tile.samples.is_wide());
        let header = header(&self.rasters, frame, Samples::absent(0, is_wide));
        Ok((header, corners.into_iter().map(|corner| (corner - frame.min).as_u64vec2()).collect()))
    }

    /// Where each tile's first sample lies in the first tile's grid, after all were compared.
    fn corners(&self) -> Result<Vec<I64Vec2>, MosaicError> {
        for index in 0..self.rasters.len() {
            self.compare_with_first(index)?;
        }
        let turns = turns(&self.rasters);
        turns.into_iter().enumerate().map(|(index, turn)| self.corner(index, turn)).collect()
    }

    /// Checks that a tile is of the same kind as the first; places are compared apart.
    fn compare_with_first(&self, index: usize) -> Result<(), MosaicError> {
        let (first, tile) = (&self.rasters[0], &self.rasters[index]);
        if !tile.georeferenced {
            return Err(MosaicError::NoPlace(self.names[index].clone()));
        }
        let differ = |what, found: [String; 2]| {
            let (first, other) = (self.names[0].clone(), self.names[index].clone());
            Err(MosaicError::Differ { first, other, what, found })
        };
        if first.crs != tile.crs {
            let name =
                |raster: &Raster| raster.crs.as_ref().map_or("none stated".into(), |crs| crs.name().into());
            return differ("coordinate systems", [name(first), name(tile)]);
        }
        if first.meters_per_z != tile.meters_per_z {
            return differ(
                "vertical units",
                [first, tile].map(|raster| format!("{} m", raster.meters_per_z)),
            );
        }
        let stated = self.rasters.iter().position(|raster| raster.vertical_datum.is_some());
        let stated = stated.map_or(0, |stated| stated.min(index));
        if let (Some(one), Some(two)) = (&self.rasters[stated].vertical_datum, &tile.vertical_datum)
            && one != two
        {
            let (first, other) = (self.names[stated].clone(), self.names[index].clone());
            let (what, found) = ("vertical datums", [one.clone(), two.clone()]);
            return Err(MosaicError::Differ { first, other, what, found });
        }
        // The axes of both grids must agree over the longest side.
        let axes = first.map_from_grid.matrix2 - tile.map_from_grid.matrix2;
        let longest = f64::from(first.width.max(first.height).max(tile.width).max(tile.height));
        let apart = DVec2::new(axes.x_axis.length(), axes.y_axis.length()) * longest;
        if apart.cmpgt(first.spacing() * ALIGNMENT).any() {
            return differ("cells", [first, tile].map(cells));
        }
        Ok(())
    }

    /// Where the tile's first sample lies in the first tile's grid, with `turn` added to its x.
    fn corner(&self, index: usize, turn: f64) -> Result<I64Vec2, MosaicError> {
        let corner = self.rasters[index].map_from_grid.translation;
        let at = self.rasters[0].grid_from_map(corner + DVec2::new(turn, 0.0));
        let off = at - at.round();
        if off.abs().max_element() > ALIGNMENT {
            let (first, other) = (self.names[0].clone(), self.names[index].clone());
            return Err(MosaicError::Misaligned { first, other, off });
        }
        if at.abs().max_element() > f64::from(u32::MAX) {
            return Err(MosaicError::TooLarge((at.abs() + 1.0).as_u64vec2()));
        }
        Ok(at.round().as_i64vec2())
    }
}

fn cells(raster: &Raster) -> String {
    let [_, a, b, _, c, d] = raster.geotransform();
    if b == 0.0 && c == 0.0 { format!("{a} by {d}") } else { format!("({a}, {c}) by ({b}, {d})") }
}

/// The offset of each tile's x: multiples of 360° where longitudes continue across ±180°.
fn turns(tiles: &[Raster]) -> Vec<f64> {
    let mut turns = vec![0.0; tiles.len()];
    if !tiles[0].crs.as_ref().is_some_and(Crs::is_geographic) {
        return turns;
    }
    let west = |index: usize| tiles[index].extent().min.x;
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    order.sort_by(|&a, &b| west(a).total_cmp(&west(b)));
    // The mosaic starts after the widest step between neighbors; after the step across ±180° where none is wider.
    let mut widest = west(order[0]) + 360.0 - west(order[order.len() - 1]);
    let mut start = 0;
    for at in 1..order.len() {
        let step = west(order[at]) - west(order[at - 1]);
        if step > widest + 1e-9 {
            (widest, start) = (step, at);
        }
    }
    for &tile in &order[..start] {
        turns[tile] = 360.0;
    }
    turns
}

/// The rectangle around all tiles, in the first tile's grid.
#[derive(Clone, Copy)]
struct MosaicFrame {
    min: I64Vec2,
    width: usize,
    height: usize,
}

impl MosaicFrame {
    /// Of at most `most` samples.
    fn around(tiles: &[Raster], corners: &[I64Vec2], most: u64) -> Result<Self, MosaicError> {
        let size = |tile: &Raster| I64Vec2::new(tile.width.into(), tile.height.into());
        let ends = tiles.iter().zip(corners).map(|(tile, corner)| *corner + size(tile));
        let min = corners.iter().copied().fold(I64Vec2::MAX, I64Vec2::min);
        let max = ends.fold(I64Vec2::MIN, I64Vec2::max);
        let size = (max - min).as_u64vec2();
        match size.x.checked_mul(size.y) {
            Some(samples) if samples <= most && size.max_element() <= u32::MAX.into() => {
                Ok(Self { min, width: size.x as usize, height: size.y as usize })
            }
            _ => Err(MosaicError::TooLarge(size)),
        }
    }
}

/// The mosaic with these samples.
fn header(tiles: &[Raster], frame: MosaicFrame, samples: Samples) -> Raster {
    let first = &tiles[0];
    let mut map_from_grid = first.map_from_grid;
    map_from_grid.translation = map_from_grid.transform_point2(frame.min.as_dvec2());
    Raster {
        width: frame.width as u32,
        height: frame.height as u32,
        samples,
        map_from_grid,
        vertical_datum: tiles.iter().find_map(|tile| tile.vertical_datum.clone()),
        ..first.without_samples()
    }
}

fn join<T: SampleFloat>(tiles: &[Raster], corners: &[I64Vec2], frame: MosaicFrame) -> Mosaic {
    let mut values = vec![T::NODATA; frame.width * frame.height];
    let mut covered = vec![0u64; values.len().div_ceil(64)];
    let (mut overlaps, mut differing, mut greatest_difference, mut in_feet) = (0, 0, 0.0f64, 0);
    for (tile, corner) in tiles.iter().zip(corners) {
        let at = *corner - frame.min;
        let width = tile.width as usize;
        for (index, value) in tile.samples.iter().enumerate() {
            let place = (at.y as usize + index / width) * frame.width + at.x as usize + index % width;
            covered[place / 64] |= 1 << (place % 64);
            let earlier: f64 = values[place].into();
            if value.is_nan() {
                continue;
            }
            if earlier.is_nan() {
                values[place] = T::from_f64(value);
                continue;
            }
            overlaps += 1;
            if earlier != value {
                differing += 1;
                greatest_difference = greatest_difference.max((earlier - value).abs());
                in_feet += u64::from(is_foot_to_meter(earlier, value));
            }
        }
    }
    let kept: u64 = covered.iter().map(|word| u64::from(word.count_ones())).sum();
    let gaps = values.len() as u64 - kept;
    let raster = header(tiles, frame, T::into_samples(values));
    let without_datum = match raster.vertical_datum {
        Some(_) => tiles.iter().filter(|tile| tile.vertical_datum.is_none()).count(),
        None => 0,
    };
    let tiles = tiles.len();
    Mosaic { raster, tiles, overlaps, differing, greatest_difference, in_feet, gaps, without_datum }
}

/// Whether one of two heights is the other in feet, within 1 %.
fn is_foot_to_meter(one: f64, other: f64) -> bool {
    let is_near = |ratio: f64| (ratio - FOOT_M).abs() < 0.01 * FOOT_M;
    is_near(one / other) || is_near(other / one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    fn mosaic(rasters: impl IntoIterator<Item = Raster>) -> Result<Mosaic, MosaicError> {
        let mut tiles = Tiles::default();
        for (raster, number) in rasters.into_iter().zip(1..) {
            tiles.push(format!("tile {number}"), raster)?;
        }
        tiles.join()
    }

    /// A raster of `small`'s grid, its first sample `column`, `row` from that of a raster two rows high.
    fn tile(column: f64, row: f64, width: u32, height: u32, values: Vec<f32>) -> Raster {
        let mut tile = small(width, height, values);
        tile.map_from_grid.translation = DVec2::new(1000.0 + 10.0 * column, 2020.0 - 10.0 * row);
        tile
    }

    fn degrees(west: f64, values: Vec<f32>) -> Raster {
        let mut tile = tile(0.0, 0.0, 2, 1, values);
        tile.crs = Some(Crs::wgs84());
        tile.map_from_grid.matrix2 *= 0.1;
        tile.map_from_grid.translation = DVec2::new(west, 50.0);
        tile
    }

    #[test]
    fn the_first_value_wins_and_what_differs_is_counted() {
        let hole = f32::NAN;
        let one = tile(0.0, 0.0, 2, 2, vec![1.0, 2.0, 3.0, hole]);
        let two = tile(1.0, 0.0, 2, 2, vec![2.0, 4.0, 5.0, 6.0]);
        let three = tile(1.0, 0.0, 1, 2, vec![2.5, 9.0]);
        let mosaic = mosaic([one, two, three]).expect("of one raster");
        assert_eq!(mosaic.raster.samples, Samples::F32(vec![1.0, 2.0, 4.0, 3.0, 5.0, 6.0]));
        assert_eq!((mosaic.overlaps, mosaic.differing, mosaic.gaps), (3, 2, 0));
        assert_eq!(mosaic.greatest_difference, 4.0);
        assert!(mosaic.note().contains("2 of them differ, by up to 4"), "{}", mosaic.note());
    }

    #[test]
    fn what_no_tile_covers_is_a_gap_and_the_corner_is_the_outermost() {
        let mosaic =
            mosaic([tile(0.0, 0.0, 1, 1, vec![1.0]), tile(-2.0, -1.0, 1, 1, vec![2.0])]).expect("fine");
        assert_eq!((mosaic.raster.width, mosaic.raster.height, mosaic.gaps), (3, 2, 4));
        assert_eq!([mosaic.raster.at(0, 0), mosaic.raster.at(2, 1)], [2.0, 1.0]);
        assert_eq!(mosaic.raster.map_from_grid.translation, DVec2::new(980.0, 2030.0));
    }

    #[test]
    fn tiles_of_different_rasters_are_refused_with_both_names() {
        let one = || tile(0.0, 0.0, 2, 2, vec![0.0; 4]);
        let refused = |other: Raster| mosaic([one(), other]).expect_err("refused").to_string();
        let shifted = refused(tile(2.25, 0.0, 2, 2, vec![0.0; 4]));
        assert!(
            shifted.contains("tile 1 and tile 2") && shifted.contains("(0.2500, 0.0000) cells"),
            "{shifted}"
        );
        let mut coarse = tile(2.0, 0.0, 2, 2, vec![0.0; 4]);
        coarse.map_from_grid.matrix2 *= 2.0;
        assert!(refused(coarse).contains("cells are 10 by -10 and 20 by -20"));
        let in_feet = Raster { meters_per_z: 0.3048, ..one() };
        assert!(refused(in_feet).contains("vertical units are 1 m and 0.3048 m"));
        let named = Raster { crs: Some(Crs::wgs84()), ..one() };
        assert!(refused(named).contains("coordinate systems are none stated and EPSG:4326"));
        assert!(refused(Raster { georeferenced: false, ..one() }).contains("tile 2 does not state where"));
        let far = refused(tile(1e7, 1e7, 2, 2, vec![0.0; 4]));
        assert!(far.contains("10000002 x 10000002"), "{far}");
        assert!(refused(tile(1e300, 0.0, 2, 2, vec![0.0; 4])).contains("samples"));
        assert_eq!(mosaic([]).expect_err("none"), MosaicError::Empty);
    }

    #[test]
    fn two_datums_are_refused_and_one_that_not_all_state_is_told() {
        let datum = |name: Option<&str>| Raster {
            vertical_datum: name.map(str::to_owned),
            ..tile(0.0, 0.0, 1, 1, vec![0.0])
        };
        assert!(mosaic([datum(Some("NAVD88")), datum(Some("NGVD29"))]).is_err());
        let error = mosaic([datum(None), datum(Some("NAVD88")), datum(Some("NGVD29"))]).expect_err("two");
        assert!(error.to_string().starts_with("tile 2 and tile 3"), "{error}");
        for tiles in [[Some("NAVD88"), None], [None, Some("NAVD88")]] {
            let joined = mosaic(tiles.map(datum)).expect("nothing contradicts");
            assert_eq!(joined.raster.vertical_datum.as_deref(), Some("NAVD88"));
            assert!(joined.note().contains("1 of them state no vertical datum"), "{}", joined.note());
        }
        let joined = mosaic([datum(None), datum(None)]).expect("nothing contradicts");
        assert!(joined.raster.vertical_datum.is_none() && !joined.note().contains("datum"));
    }

    #[test]
    fn longitudes_continue_across_the_date_line() {
        for order in [[178.0, -180.0], [-180.0, 178.0]] {
            let tiles = order.map(|west| degrees(west, vec![west as f32, 0.0]));
            let mosaic = mosaic(tiles).expect("neighbors");
            assert_eq!((mosaic.raster.width, mosaic.gaps), (4, 0), "{order:?}");
            assert_eq!([mosaic.raster.at(0, 0), mosaic.raster.at(2, 0)], [178.0, -180.0]);
            assert!((mosaic.raster.extent().size().x - 4.0).abs() < 1e-9);
        }
        let whole: Vec<Raster> =
            (0..180).map(|at| degrees(f64::from(at) * 2.0 - 180.0, vec![0.0; 2])).collect();
        let globe = mosaic(whole).expect("a globe");
        assert!((globe.raster.map_from_grid.translation.x + 180.0).abs() < 1e-9);
    }
}

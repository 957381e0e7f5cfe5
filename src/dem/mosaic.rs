//! Several tiles of one raster, joined.
//!
//! Tiles of one raster have one coordinate system, one vertical unit and one grid: their cells are alike and their
//! samples fall on one another's, within a thousandth of a cell. What is not so is refused by name, never resampled.
//!
//! Where tiles share samples (SRTM tiles share their border rows and columns), **the first tile with a value wins**;
//! the others are compared with it, and how many differ and by how much is told. Samples of the mosaic's rectangle
//! that no tile covers are gaps: no data, and counted. Longitudes may go on across ±180°: the mosaic starts east of
//! the widest stretch without tiles.

use glam::{DVec2, I64Vec2};

use crate::dem::error::MOST_SAMPLES;
use crate::dem::raster::{Raster, Samples};
use crate::geom::crs::Crs;

/// How far, in cells, a tile's samples may lie from the places of the first tile's grid.
pub const ALIGNMENT: f64 = 1e-3;

/// The most samples of all tiles together: twice a raster's, since tiles overlap.
const MOST_OF_ALL: u64 = 2 * MOST_SAMPLES;

/// Tiles joined to one raster, and what was found in joining.
#[derive(Clone, Debug)]
pub struct Mosaic {
    /// The whole: the smallest rectangle around all tiles.
    pub raster: Raster,
    /// How many tiles it was made of.
    pub tiles: usize,
    /// Values that a tile holds where an earlier one holds one already.
    pub overlaps: u64,
    /// How many of those differ from the earlier one, which was kept.
    pub differing: u64,
    /// The greatest difference among them, in the vertical unit; 0 where none differs.
    pub greatest_difference: f64,
    /// Samples that no tile covers.
    pub gaps: u64,
}

impl Mosaic {
    fn of_one(raster: Raster) -> Self {
        Self { raster, tiles: 1, overlaps: 0, differing: 0, greatest_difference: 0.0, gaps: 0 }
    }

    /// What a user should know of the joining, in one line.
    pub fn note(&self) -> String {
        let mut note = format!("{} tiles joined; {} samples are shared", self.tiles, self.overlaps);
        if self.differing > 0 {
            note.push_str(&format!(
                ", {} of them differ, by up to {} (the first tile's were kept)",
                self.differing, self.greatest_difference
            ));
        }
        if self.gaps > 0 {
            note.push_str(&format!("; {} samples lie in no tile", self.gaps));
        }
        note
    }
}

/// Why tiles are not those of one raster. Tiles are named by their index.
#[derive(Clone, Debug, PartialEq)]
pub enum MosaicError {
    /// There is no tile.
    Empty,
    /// A tile without a place.
    NoPlace(usize),
    /// Two tiles that are not alike.
    Differ {
        /// The first tile.
        first: usize,
        /// The one that differs from it.
        other: usize,
        /// In what.
        what: &'static str,
        /// What the first has and what the other has.
        found: [String; 2],
    },
    /// Two tiles whose samples fall between each other's.
    Misaligned {
        /// The first tile.
        first: usize,
        /// The one that is shifted against it.
        other: usize,
        /// By how many cells, from −0.5 to 0.5.
        off: DVec2,
    },
    /// The tiles hold more samples together than are taken.
    TooMany {
        /// How many the tiles up to the one too many hold.
        samples: u64,
    },
    /// The rectangle around all tiles has more samples than are taken.
    TooLarge {
        /// Samples per row.
        width: u64,
        /// Rows.
        height: u64,
    },
}

impl MosaicError {
    /// The error with the tiles' names, in their order.
    pub fn named(&self, names: &[String]) -> String {
        self.say(|tile| names.get(tile).cloned().unwrap_or_else(|| format!("tile {}", tile + 1)))
    }

    fn say(&self, name: impl Fn(usize) -> String) -> String {
        match self {
            Self::Empty => "there is no elevation file to join".into(),
            Self::NoPlace(tile) => {
                format!("{} does not say where it lies, so it cannot be joined", name(*tile))
            }
            Self::Differ { first, other, what, found: [one, two] } => format!(
                "{} and {} are not tiles of one raster: their {what} are {one} and {two}; bring them to one, for \
                 example with: sandtable dem convert",
                name(*first),
                name(*other)
            ),
            Self::Misaligned { first, other, off } => format!(
                "{} and {} are not tiles of one raster: the second's samples lie ({:.4}, {:.4}) cells off the \
                 first's; bring them to one grid, for example with: gdalwarp -tap",
                name(*first),
                name(*other),
                off.x,
                off.y
            ),
            Self::TooMany { samples } => {
                format!(
                    "the tiles hold {samples} samples, more than the {MOST_OF_ALL} that are taken; join fewer"
                )
            }
            Self::TooLarge { width, height } => format!(
                "the tiles span {width} x {height} samples, more than the {MOST_SAMPLES} that are taken; join fewer"
            ),
        }
    }
}

impl std::fmt::Display for MosaicError {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.say(|tile| format!("tile {}", tile + 1)))
    }
}

impl std::error::Error for MosaicError {}

/// Whether the tiles read so far are no more than can be joined; for asking before the next is read.
///
/// # Errors
/// [`MosaicError::TooMany`].
pub fn check_total(tiles: &[Raster]) -> Result<(), MosaicError> {
    let samples = tiles.iter().map(|tile| tile.samples.len() as u64).sum();
    if samples > MOST_OF_ALL { Err(MosaicError::TooMany { samples }) } else { Ok(()) }
}

/// Joins `tiles`, given in the order in which they win.
///
/// One tile is returned as it is. The mosaic's format, stored type and no-data value are the first tile's; its
/// samples take 64 bits where any tile's do.
///
/// # Errors
/// [`MosaicError`]; nothing is allocated before all tiles were found alike.
pub fn mosaic(tiles: Vec<Raster>) -> Result<Mosaic, MosaicError> {
    let tiles = match <[Raster; 1]>::try_from(tiles) {
        Ok([raster]) => return Ok(Mosaic::of_one(raster)),
        Err(tiles) => tiles,
    };
    let first = tiles.first().ok_or(MosaicError::Empty)?;
    for (index, tile) in tiles.iter().enumerate() {
        alike(first, tile, index)?;
    }
    let turns = turns(&tiles);
    let corners = tiles.iter().zip(&turns).enumerate();
    let corners: Vec<I64Vec2> =
        corners.map(|(index, (tile, turn))| corner(first, tile, *turn, index)).collect::<Result<_, _>>()?;
    let frame = MosaicFrame::around(&tiles, &corners)?;
    Ok(if tiles.iter().any(|tile| matches!(tile.samples, Samples::F64(_))) {
        join(&tiles, &corners, frame, f64::NAN, |value| value, Samples::F64)
    } else {
        join(&tiles, &corners, frame, f32::NAN, |value| value as f32, Samples::F32)
    })
}

/// Whether `tile` is of the same kind as the first; its place is judged apart.
fn alike(first: &Raster, tile: &Raster, other: usize) -> Result<(), MosaicError> {
    if !first.georeferenced || !tile.georeferenced {
        return Err(MosaicError::NoPlace(if first.georeferenced { other } else { 0 }));
    }
    let differ = |what, one: String, two: String| {
        Err(MosaicError::Differ { first: 0, other, what, found: [one, two] })
    };
    let crs =
        |raster: &Raster| raster.crs.as_ref().map_or("none stated".to_owned(), |crs| crs.name().to_owned());
    if first.crs != tile.crs {
        return differ("coordinate systems", crs(first), crs(tile));
    }
    if first.meters_per_z != tile.meters_per_z {
        return differ(
            "vertical units",
            format!("{} m", first.meters_per_z),
            format!("{} m", tile.meters_per_z),
        );
    }
    if let (Some(one), Some(two)) = (&first.vertical_datum, &tile.vertical_datum)
        && one != two
    {
        return differ("vertical datums", one.clone(), two.clone());
    }
    // Over the longer of their sides the grids may not run apart.
    let axes = first.map_from_grid.matrix2 - tile.map_from_grid.matrix2;
    let longest = f64::from(first.width.max(first.height).max(tile.width).max(tile.height));
    let apart = DVec2::new(axes.x_axis.length(), axes.y_axis.length()) * longest;
    if apart.cmpgt(first.spacing() * ALIGNMENT).any() {
        let cells = |raster: &Raster| {
            let [_, a, b, _, c, d] = raster.geotransform();
            if b == 0.0 && c == 0.0 { format!("{a} by {d}") } else { format!("({a}, {c}) by ({b}, {d})") }
        };
        return differ("cells", cells(first), cells(tile));
    }
    Ok(())
}

/// What is added to each tile's x: whole turns of 360° where longitudes go on across ±180°.
fn turns(tiles: &[Raster]) -> Vec<f64> {
    let mut turns = vec![0.0; tiles.len()];
    if !tiles[0].crs.as_ref().is_some_and(Crs::is_geographic) {
        return turns;
    }
    let west = |index: usize| tiles[index].extent().min.x;
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    order.sort_by(|&a, &b| west(a).total_cmp(&west(b)));
    // The mosaic starts behind the widest step between neighbors; behind the step across ±180° where none is wider.
    let across = west(order[0]) + 360.0 - west(order[order.len() - 1]);
    let mut widest = (across, 0);
    for at in 1..order.len() {
        let step = west(order[at]) - west(order[at - 1]);
        if step > widest.0 + 1e-9 {
            widest = (step, at);
        }
    }
    for &tile in &order[..widest.1] {
        turns[tile] = 360.0;
    }
    turns
}

/// Where the tile's first sample stands in the first tile's grid.
fn corner(first: &Raster, tile: &Raster, turn: f64, other: usize) -> Result<I64Vec2, MosaicError> {
    let at = first.grid_from_map(tile.map_from_grid.translation + DVec2::new(turn, 0.0));
    let off = at - at.round();
    if off.abs().max_element() > ALIGNMENT {
        return Err(MosaicError::Misaligned { first: 0, other, off });
    }
    if at.abs().max_element() > MOST_SAMPLES as f64 {
        let size = at.abs() + 1.0;
        return Err(MosaicError::TooLarge { width: size.x as u64, height: size.y as u64 });
    }
    Ok(at.round().as_i64vec2())
}

/// The rectangle around all tiles, in the first tile's grid.
#[derive(Clone, Copy)]
struct MosaicFrame {
    min: I64Vec2,
    width: usize,
    height: usize,
}

impl MosaicFrame {
    fn around(tiles: &[Raster], corners: &[I64Vec2]) -> Result<Self, MosaicError> {
        let ends = tiles.iter().zip(corners).map(|(tile, corner)| *corner + size(tile));
        let min = corners.iter().copied().fold(I64Vec2::MAX, I64Vec2::min);
        let max = ends.fold(I64Vec2::MIN, I64Vec2::max);
        let (width, height) = ((max.x - min.x) as u64, (max.y - min.y) as u64);
        match width.checked_mul(height) {
            Some(samples) if samples <= MOST_SAMPLES => {
                Ok(Self { min, width: width as usize, height: height as usize })
            }
            _ => Err(MosaicError::TooLarge { width, height }),
        }
    }
}

fn size(tile: &Raster) -> I64Vec2 {
    I64Vec2::new(i64::from(tile.width), i64::from(tile.height))
}

fn join<T: Copy + Into<f64>>(
    tiles: &[Raster],
    corners: &[I64Vec2],
    frame: MosaicFrame,
    hole: T,
    narrow: impl Fn(f64) -> T,
    wrap: impl Fn(Vec<T>) -> Samples,
) -> Mosaic {
    let mut values = vec![hole; frame.width * frame.height];
    let mut covered = vec![0u64; values.len().div_ceil(64)];
    let (mut overlaps, mut differing, mut greatest_difference) = (0, 0, 0.0f64);
    for (tile, corner) in tiles.iter().zip(corners) {
        let at = *corner - frame.min;
        let width = tile.width as usize;
        for (index, value) in tile.samples.iter().enumerate() {
            let place = (at.y as usize + index / width) * frame.width + at.x as usize + index % width;
            covered[place / 64] |= 1 << (place % 64);
            let there: f64 = values[place].into();
            if value.is_nan() {
                continue;
            }
            if there.is_nan() {
                values[place] = narrow(value);
                continue;
            }
            overlaps += 1;
            if there != value {
                differing += 1;
                greatest_difference = greatest_difference.max((there - value).abs());
            }
        }
    }
    let kept: u64 = covered.iter().map(|word| u64::from(word.count_ones())).sum();
    let gaps = values.len() as u64 - kept;
    let first = &tiles[0];
    let mut map_from_grid = first.map_from_grid;
    map_from_grid.translation = map_from_grid.transform_point2(frame.min.as_dvec2());
    let one_datum = tiles.iter().all(|tile| tile.vertical_datum == first.vertical_datum);
    let raster = Raster {
        driver: first.driver,
        data_type: first.data_type,
        width: frame.width as u32,
        height: frame.height as u32,
        samples: wrap(values),
        meters_per_z: first.meters_per_z,
        map_from_grid,
        georeferenced: true,
        crs: first.crs.clone(),
        nodata: first.nodata,
        vertical_datum: first.vertical_datum.clone().filter(|_| one_datum),
    };
    Mosaic { raster, tiles: tiles.len(), overlaps, differing, greatest_difference, gaps }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::raster::tests::small;

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
        let mosaic = mosaic(vec![one, two, three]).expect("of one raster");
        assert_eq!(mosaic.raster.samples, Samples::F32(vec![1.0, 2.0, 4.0, 3.0, 5.0, 6.0]));
        assert_eq!((mosaic.overlaps, mosaic.differing, mosaic.gaps), (3, 2, 0));
        assert_eq!(mosaic.greatest_difference, 4.0);
        assert!(mosaic.note().contains("2 of them differ, by up to 4"), "{}", mosaic.note());
    }

    #[test]
    fn what_no_tile_covers_is_a_gap_and_the_corner_is_the_outermost() {
        let mosaic =
            mosaic(vec![tile(0.0, 0.0, 1, 1, vec![1.0]), tile(-2.0, -1.0, 1, 1, vec![2.0])]).expect("fine");
        assert_eq!((mosaic.raster.width, mosaic.raster.height, mosaic.gaps), (3, 2, 4));
        assert_eq!([mosaic.raster.at(0, 0), mosaic.raster.at(2, 1)], [2.0, 1.0]);
        assert_eq!(mosaic.raster.map_from_grid.translation, DVec2::new(980.0, 2030.0));
    }

    #[test]
    fn tiles_of_different_rasters_are_refused_with_both_names() {
        let one = || tile(0.0, 0.0, 2, 2, vec![0.0; 4]);
        let names = ["a.tif".to_owned(), "b.tif".to_owned()];
        let refused = |other: Raster| mosaic(vec![one(), other]).expect_err("refused").named(&names);
        let shifted = refused(tile(2.25, 0.0, 2, 2, vec![0.0; 4]));
        assert!(
            shifted.contains("a.tif and b.tif") && shifted.contains("(0.2500, 0.0000) cells"),
            "{shifted}"
        );
        let mut coarse = tile(2.0, 0.0, 2, 2, vec![0.0; 4]);
        coarse.map_from_grid.matrix2 *= 2.0;
        assert!(refused(coarse).contains("cells are 10 by -10 and 20 by -20"));
        let in_feet = Raster { meters_per_z: 0.3048, ..one() };
        assert!(refused(in_feet).contains("vertical units are 1 m and 0.3048 m"));
        let named = Raster { crs: Some(Crs::wgs84()), ..one() };
        assert!(refused(named).contains("coordinate systems are none stated and EPSG:4326"));
        assert!(refused(Raster { georeferenced: false, ..one() }).contains("b.tif does not say where"));
        let far = refused(tile(1e7, 1e7, 2, 2, vec![0.0; 4]));
        assert!(far.contains("10000002 x 10000002"), "{far}");
        assert!(refused(tile(1e300, 0.0, 2, 2, vec![0.0; 4])).contains("samples"));
        assert_eq!(mosaic(Vec::new()).expect_err("none"), MosaicError::Empty);
    }

    #[test]
    fn two_datums_are_refused_and_one_that_not_all_state_is_not_claimed() {
        let datum = |name: Option<&str>| Raster {
            vertical_datum: name.map(str::to_owned),
            ..tile(0.0, 0.0, 1, 1, vec![0.0])
        };
        assert!(mosaic(vec![datum(Some("NAVD88")), datum(Some("NGVD29"))]).is_err());
        let joined = mosaic(vec![datum(Some("NAVD88")), datum(None)]).expect("nothing contradicts");
        assert_eq!(joined.raster.vertical_datum, None);
    }

    #[test]
    fn longitudes_go_on_across_the_date_line() {
        for order in [[178.0, -180.0], [-180.0, 178.0]] {
            let tiles = order.map(|west| degrees(west, vec![west as f32, 0.0]));
            let mosaic = mosaic(tiles.into()).expect("neighbors");
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

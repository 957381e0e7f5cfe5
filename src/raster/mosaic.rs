//! Joins the tiles of one raster.
//!
//! Tiles of one raster have one coordinate system, one vertical unit and one grid: their cells are alike and their
//! samples coincide, within a thousandth of a cell. Tiles of larger cells that nest in the finest ones' are
//! brought to their grid (`nested_tile`), and fill what these leave. Other tiles are refused by name, unless the caller
//! states the cell that all are resampled to.
//!
//! Where tiles share samples (SRTM tiles share their border rows and columns), **the first tile with a value wins**;
//! the others are compared with it, and how many differ and by how much is reported. Samples of the mosaic's rectangle
//! that no tile covers are gaps: no data, and counted. Longitudes may continue across ±180°: the mosaic starts east of
//! the widest gap.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, I64Vec2, U64Vec2};

use crate::joined_samples::{MosaicFrame, PlacedTile, join};
use crate::nested_tile::Refinement;
use crate::raster::{Raster, Samples};
use crate::warp::error::WarpError;
use crate::windows::{RasterWindow, Windows};
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
    /// How many tiles had other cells: a note of the raster says how they were brought to its own.
    pub of_other_cells: usize,
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
        "{first} and {other} are not tiles of one raster: their cells are {} and {}, which do not nest; state the cell that both are resampled to: `cell` under [terrain], or --cell of sandtable dem convert",
        .found[0], .found[1]
    )]
    Cells { first: String, other: String, found: [String; 2] },
    #[error(
        "{first} and {other} are not tiles of one raster: the second's samples lie ({:.4}, {:.4}) cells off the first's; state the cell that both are resampled to: `cell` under [terrain], or --cell of sandtable dem convert",
        .off.x, .off.y
    )]
    Misaligned {
        first: String,
        other: String,
        /// In cells, from −0.5 to 0.5.
        off: DVec2,
    },
    #[error("{name} cannot be resampled to cells of {cell}")]
    Resample { name: String, cell: f64, source: Box<WarpError> },
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
                of_other_cells: 0,
            });
        }
        let nested = self.nested();
        let headers = self.in_one_grid(&nested);
        let corners = headers.corners()?;
        let frame = MosaicFrame::around(&headers.rasters, &corners, RASTER_SAMPLES.get())?;
        let placed = nested.iter().zip(&headers.rasters).zip(&corners);
        let tiles: Vec<PlacedTile<'_>> = placed
            .map(|((nested, header), corner)| PlacedTile {
                raster: &self.rasters[nested.index],
                refinement: nested.refinement,
                size: header.size(),
                at: *corner - frame.min,
            })
            .collect();
        let header = header(&headers.rasters, frame, Samples::F32(Vec::new()));
        let mut mosaic = if self.rasters.iter().any(|tile| matches!(tile.samples, Samples::F64(_))) {
            join::<f64>(&tiles, frame, header)
        } else {
            join::<f32>(&tiles, frame, header)
        };
        mosaic.raster.notes = headers.notes(&nested);
        Ok(mosaic)
    }

    /// Why the tiles are not of one grid, where their cells neither are alike nor nest, or their samples lie off each other's.
    pub(crate) fn misfit(&self) -> Option<MosaicError> {
        let tiles = Some(self).filter(|tiles| tiles.rasters.len() > 1)?;
        let fault = tiles.in_one_grid(&tiles.nested()).corners().err();
        fault.filter(|fault| matches!(fault, MosaicError::Cells { .. } | MosaicError::Misaligned { .. }))
    }

    /// The first tile.
    pub(crate) fn first(&self) -> Option<&Raster> {
        self.rasters.first()
    }

    /// The tiles with their names.
    pub(crate) fn into_named(self) -> Vec<(String, Raster)> {
        self.names.into_iter().zip(self.rasters).collect()
    }

    /// The tiles in the order in which they win, with what brings them to the finest one's grid: those of its cells, then
    /// those of larger ones that nest.
    pub(crate) fn nested(&self) -> Vec<NestedTile> {
        let area = |tile: &Raster| tile.spacing().element_product();
        let finest = self.rasters.iter().min_by(|a, b| area(a).total_cmp(&area(b)));
        let refinement = |tile: &Raster| Refinement::new(tile, finest?);
        let tiles = self.rasters.iter().enumerate();
        let mut nested: Vec<NestedTile> =
            tiles.map(|(index, tile)| NestedTile { index, refinement: refinement(tile) }).collect();
        nested.sort_by_key(|tile| {
            tile.refinement.map_or(1, |finer| finer.times[0].saturating_mul(finer.times[1]))
        });
        nested
    }

    /// The tiles in order, in the finest one's grid, without their samples.
    fn in_one_grid(&self, nested: &[NestedTile]) -> Self {
        let header = |tile: &NestedTile| {
            let own = &self.rasters[tile.index];
            tile.refinement.map_or_else(|| own.without_samples(), |finer| finer.header(own))
        };
        let names = nested.iter().map(|tile| self.names[tile.index].clone()).collect();
        Self { names, rasters: nested.iter().map(header).collect(), samples: 0 }
    }

    /// The notes of all tiles, each once, with the name of the tile or the number of those that it is true of; and one on
    /// those of larger cells.
    fn notes(&self, nested: &[NestedTile]) -> Vec<String> {
        let mut all: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        for (index, tile) in self.rasters.iter().enumerate() {
            for note in &tile.notes {
                all.entry(note).or_insert((index, 0)).1 += 1;
            }
        }
        let mut all: Vec<(&str, (usize, usize))> = all.into_iter().collect();
        all.sort_by_key(|(_, (first, _))| *first);
        let told = all.into_iter().map(|(note, (first, count))| match count {
            1 => format!("{}: {note}", self.names[first]),
            _ => format!("{} and {} more tiles: {note}", self.names[first], count - 1),
        });
        told.chain(self.note_on_cells(nested)).collect()
    }

    fn note_on_cells(&self, nested: &[NestedTile]) -> Option<String> {
        let all: BTreeSet<[u32; 2]> = nested.iter().filter_map(|tile| Some(tile.refinement?.times)).collect();
        let larger = nested.iter().filter(|tile| tile.refinement.is_some()).count();
        let times = |[x, y]: [u32; 2]| if x == y { format!("{x}") } else { format!("{x} by {y}") };
        let times: Vec<String> = all.into_iter().map(times).collect();
        (larger > 0).then(|| {
            format!(
                "{larger} of {} tiles have cells {} times as large as the finest, {}: they are interpolated between their \
                 samples, and count where no finer tile has a value",
                nested.len(),
                times.join(" or "),
                cells(&self.rasters[0])
            )
        })
    }

    /// Tiles whose samples are not in memory, with their names.
    pub(crate) fn of_headers(tiles: Vec<(String, Raster)>) -> Self {
        let (names, rasters) = tiles.into_iter().unzip();
        Self { names, rasters, samples: 0 }
    }

    /// The mosaic of tiles whose samples are not in memory, without its own, and its tiles in the order in which they win. It
    /// may hold `most` samples.
    ///
    /// # Errors
    /// [`MosaicError`].
    pub(crate) fn placed(&self, most: u64) -> Result<(Raster, Vec<PlacedHeader>), MosaicError> {
        let nested = self.nested();
        let headers = self.in_one_grid(&nested);
        let corners = headers.corners()?;
        let frame = MosaicFrame::around(&headers.rasters, &corners, most)?;
        let is_wide = headers.rasters.iter().any(|tile| tile.samples.is_wide());
        let header = header(&headers.rasters, frame, Samples::absent(0, is_wide));
        let placed = |((tile, name), (header, corner)): ((&NestedTile, &String), (&Raster, &I64Vec2))| {
            let at = (*corner - frame.min).as_uvec2();
            let (width, height) = header.size();
            let window = RasterWindow { column: at.x, row: at.y, width, height };
            let size = self.rasters[tile.index].size();
            PlacedHeader { index: tile.index, name: name.clone(), refinement: tile.refinement, size, window }
        };
        let tiles = nested.iter().zip(&headers.names).zip(headers.rasters.iter().zip(&corners));
        let tiles = tiles.map(placed).collect();
        Ok((Raster { notes: headers.notes(&nested), ..header }, tiles))
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
            let (first_name, other) = (self.names[0].clone(), self.names[index].clone());
            return Err(MosaicError::Cells { first: first_name, other, found: [first, tile].map(cells) });
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

/// A tile by its number, and what brings it to the finest one's grid; `None` where it is in that.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NestedTile {
    index: usize,
    refinement: Option<Refinement>,
}

/// A tile whose samples are not in memory, in a mosaic.
#[derive(Clone, Debug)]
pub(crate) struct PlacedHeader {
    /// Its number.
    pub index: usize,
    pub name: String,
    pub refinement: Option<Refinement>,
    /// Its own columns and rows.
    pub size: (u32, u32),
    /// Its place in the mosaic.
    pub window: RasterWindow,
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
        coarse.map_from_grid.matrix2 *= 1.5;
        assert!(refused(coarse).contains("cells are 10 by -10 and 15 by -15, which do not nest"));
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

    /// A tile of cells twice as large; its corner lies as that of [`tile`].
    fn coarse(column: f64, row: f64, width: u32, height: u32, values: Vec<f32>) -> Raster {
        let mut tile = tile(column, row, width, height, values);
        tile.map_from_grid.matrix2 *= 2.0;
        tile
    }

    #[test]
    fn tiles_of_larger_cells_fill_what_the_finest_leave() {
        let hole = f32::NAN;
        let fine = || tile(0.0, 0.0, 2, 2, vec![1.0, 2.0, 3.0, hole]);
        let wide = || coarse(0.0, 0.0, 2, 1, vec![10.0, 30.0]);
        for tiles in [[fine(), wide()], [wide(), fine()]] {
            let joined = mosaic(tiles).expect("they nest");
            let wanted = vec![1.0, 2.0, 25.0, 30.0, 3.0, 15.0, 25.0, 30.0];
            assert_eq!((joined.raster.width, &joined.raster.samples), (4, &Samples::F32(wanted)));
            assert_eq!((joined.tiles, joined.overlaps, joined.differing, joined.gaps), (2, 0, 0, 0));
            assert!(
                joined.raster.notes[0].starts_with("1 of 2 tiles have cells 2 times as large"),
                "{joined:?}"
            );
        }
        // Nodes: the large cells' centers lie on centers of the small ones.
        let nodes = mosaic([fine(), coarse(1.5, -0.5, 2, 2, vec![5.0, 7.0, 9.0, 11.0])]).expect("they nest");
        assert_eq!((nodes.raster.width, nodes.raster.height), (5, 3));
        let row = [2u32, 3, 4].map(|column| nodes.raster.at(column, 0));
        assert_eq!(row, [5.0, 6.0, 7.0]);
    }

    #[test]
    fn notes_of_tiles_are_told_once_with_the_tile_or_the_number_of_tiles() {
        let noted = |column: f64, notes: &[&str]| Raster {
            notes: notes.iter().map(|note| (*note).to_owned()).collect(),
            ..tile(column, 0.0, 1, 1, vec![0.0])
        };
        let joined =
            mosaic([noted(0.0, &["b"]), noted(1.0, &["b", "a"]), noted(2.0, &["b"])]).expect("tiles");
        assert_eq!(joined.raster.notes, ["tile 1 and 2 more tiles: b", "tile 2: a"]);
        assert_eq!(mosaic([noted(0.0, &["b"])]).expect("one").raster.notes, ["b"]);
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

//! GeoPackage rasters of elevation: tiles of a 2D gridded coverage (OGC 17-066r1, *Tiled Gridded Coverage Data*, 2018).
//!
//! ```text
//! gpkg_contents                        name, bounds of the data
//! gpkg_tile_matrix_set, _tile_matrix   where tiles lie, for each zoom level: columns, rows, size and pixel of tiles
//! gpkg_2d_gridded_coverage_ancillary   integer (PNG of 16 bits) or float (TIFF), scale, offset, value for no data
//! gpkg_2d_gridded_tile_ancillary       scale and offset of each tile
//! NAME                                 zoom level, column, row, bytes of the tile
//! ```
//!
//! A height is (value · scale of the tile + offset of the tile) · scale + offset. As in GDAL, the finest level is read, within
//! the bounds that the contents state, and heights of integers whose precision is 1, the default, are rounded to it. Tiles
//! that are missing are no data. The database is a stranger's: `sandtable-database` opens it within limits.

use std::ops::Range;

use glam::{DVec2, U64Vec2};
use rusqlite::{Connection, ErrorCode, OptionalExtension, Row};

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, Recognition, any_size};
use crate::formats::gpkg_tiles::read_tiles;
use sandtable_database::{open, quoted};
use sandtable_geom::crs::Crs;
use sandtable_geom::length_unit::length_of_name;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::raster::{Raster, Samples, north_up};

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "GeoPackage",
    extensions: &[],
    shared_extensions: &["gpkg"],
    recognition: Recognition::Content { matches: has_coverage, start: "'SQLite format 3'" },
    reader: read,
    windows: None,
    most_bytes: any_size,
    writer: None,
    windows_writer: None,
};

const COVERAGES: &str = "gpkg_2d_gridded_coverage_ancillary";

/// The most bytes of a tile that one byte is unpacked to: deflate's.
const EXPANSION: u64 = 1032;

/// The precision by which heights are rounded.
pub(super) const WHOLE: f64 = 1.0;

fn has_coverage(bytes: &[u8]) -> bool {
    bytes.starts_with(b"SQLite format 3\0")
        && bytes.windows(COVERAGES.len()).any(|window| window == COVERAGES.as_bytes())
}

/// A coverage, and how its values become heights.
pub(super) struct GpkgCoverage {
    pub name: String,
    pub is_float: bool,
    pub scale: f64,
    pub offset: f64,
    pub precision: f64,
    pub nodata: Option<f64>,
    pub encoding: Option<String>,
    pub unit: Option<String>,
    pub srs_id: i64,
}

/// The tiles of a level.
pub(super) struct GpkgMatrix {
    pub zoom: i64,
    /// The outer north-west corner of the first tile.
    pub corner: DVec2,
    pub pixel: DVec2,
    pub tiles: U64Vec2,
    /// Columns and rows of a tile.
    pub tile: U64Vec2,
    /// Bounds of the data: west, south, east and north.
    pub bounds: [Option<f64>; 4],
}

/// The part of a level that holds data, in pixels.
pub(super) struct GpkgWindow {
    pub columns: Range<u64>,
    pub rows: Range<u64>,
}

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let database = open(file.bytes).map_err(refused("its tables"))?;
    let coverage = coverage(&database)?;
    let matrix = GpkgMatrix::finest(&database, &coverage)?;
    let window = matrix.window();
    let size = size(&database, file, &coverage, &matrix, &window)?;
    let integer = integer_type(&database, &coverage)?;
    // What neither is stored as a float nor is a whole number needs 64 bits.
    let is_wide = !coverage.is_float && coverage.precision != WHOLE && integer.is_none();
    let mut samples = Samples::absent((size.0 as usize) * (size.1 as usize), is_wide);
    read_tiles(&database, &coverage, &matrix, &window, &mut samples)?;
    let start = DVec2::new(window.columns.start as f64, -(window.rows.start as f64));
    let meters_per_z = match &coverage.unit {
        None => 1.0,
        Some(unit) => length_of_name(unit).ok_or_else(|| {
            FORMAT.unsupported(format!("heights in the unit '{unit}'"), "convert it to meters")
        })?,
    };
    Ok(Raster {
        driver: "GPKG",
        data_type: integer.unwrap_or("Float32"),
        meters_per_z,
        nodata: coverage.nodata,
        crs: file.crs_or(|| crs(&database, coverage.srs_id))?,
        ..Raster::new(size.0, samples).placed(north_up(matrix.corner + start * matrix.pixel, matrix.pixel))
    })
}

/// An error of SQLite, at a place of the file.
pub(super) fn refused(place: &str) -> impl FnOnce(rusqlite::Error) -> DemErrorKind + '_ {
    move |error| match error.sqlite_error_code() {
        Some(ErrorCode::OperationInterrupted) => {
            FORMAT.broken(format!("reading {place} takes more steps than any real file"))
        }
        Some(ErrorCode::NotADatabase) => FORMAT.broken("it is not an SQLite database that can be read"),
        _ => FORMAT.broken(format!("{place}: {error}")),
    }
}

/// The only coverage.
fn coverage(database: &Connection) -> Result<GpkgCoverage, DemErrorKind> {
    let refused = |error| refused("its coverages")(error);
    let of = |row: &Row<'_>| {
        Ok(GpkgCoverage {
            name: row.get(0)?,
            is_float: row.get::<_, String>(1)?.eq_ignore_ascii_case("float"),
            scale: row.get::<_, Option<f64>>(2)?.unwrap_or(1.0),
            offset: row.get::<_, Option<f64>>(3)?.unwrap_or(0.0),
            precision: row.get::<_, Option<f64>>(4)?.unwrap_or(WHOLE),
            nodata: row.get(5)?,
            encoding: row.get(6)?,
            unit: row.get(7)?,
            srs_id: row.get::<_, Option<i64>>(8)?.unwrap_or(-1),
        })
    };
    let query = "SELECT a.tile_matrix_set_name, a.datatype, a.scale, a.offset, a.precision, a.data_null, \
                 a.grid_cell_encoding, a.uom, s.srs_id FROM gpkg_2d_gridded_coverage_ancillary a \
                 LEFT JOIN gpkg_tile_matrix_set s ON s.table_name = a.tile_matrix_set_name ORDER BY a.id LIMIT 100";
    let mut statement = database.prepare(query).map_err(refused)?;
    let found = statement.query_map([], of).and_then(Iterator::collect::<rusqlite::Result<Vec<_>>>);
    let mut found = found.map_err(refused)?;
    let names: Vec<&str> = found.iter().map(|coverage| coverage.name.as_str()).collect();
    if names.len() > 1 {
        let what = format!("{} coverages: {}", names.len(), names.join(", "));
        return Err(FORMAT.unsupported(what, "make a file of one: gdal_translate GPKG:FILE:NAME out.tif"));
    }
    let coverage = found.pop().ok_or_else(|| {
        FORMAT.unsupported("no tiles of heights, only pictures", "give one with a 2D gridded coverage")
    })?;
    if coverage.encoding.as_deref() == Some("grid-value-is-corner") {
        let remedy = "convert it, for example with: gdal_translate FILE out.tif, and mind the half cell";
        return Err(FORMAT.unsupported("heights at the corners of cells", remedy));
    }
    if !coverage.scale.is_finite() || !coverage.offset.is_finite() {
        let (scale, offset) = (coverage.scale, coverage.offset);
        return Err(FORMAT.broken(format!("its scale is {scale} and its offset {offset}")));
    }
    Ok(coverage)
}

impl GpkgMatrix {
    /// The finest level that has tiles.
    fn finest(database: &Connection, coverage: &GpkgCoverage) -> Result<Self, DemErrorKind> {
        let query = format!(
            "SELECT m.zoom_level, s.min_x, s.max_y, m.pixel_x_size, m.pixel_y_size, m.matrix_width, m.matrix_height, \
             m.tile_width, m.tile_height, c.min_x, c.min_y, c.max_x, c.max_y FROM gpkg_tile_matrix m \
             JOIN gpkg_tile_matrix_set s ON s.table_name = m.table_name \
             LEFT JOIN gpkg_contents c ON c.table_name = m.table_name \
             WHERE m.table_name = ?1 AND m.zoom_level = (SELECT max(zoom_level) FROM {})",
            quoted(&coverage.name)
        );
        let of = |row: &Row<'_>| {
            let count =
                |at: usize| Ok::<_, rusqlite::Error>(u64::try_from(row.get::<_, i64>(at)?).unwrap_or(0));
            Ok(Self {
                zoom: row.get(0)?,
                corner: DVec2::new(row.get(1)?, row.get(2)?),
                pixel: DVec2::new(row.get(3)?, row.get(4)?),
                tiles: U64Vec2::new(count(5)?, count(6)?),
                tile: U64Vec2::new(count(7)?, count(8)?),
                bounds: [row.get(9)?, row.get(10)?, row.get(11)?, row.get(12)?],
            })
        };
        let found = database.query_row(&query, [&coverage.name], of).optional();
        let matrix = found.map_err(refused("its tile matrix"))?;
        let matrix = matrix.ok_or_else(|| FORMAT.broken("no level of its tile matrix has tiles"))?;
        let is_sound =
            matrix.corner.is_finite() && matrix.pixel.is_finite() && matrix.pixel.min_element() > 0.0;
        if !is_sound {
            return Err(DemErrorKind::Georeference {
                reason: format!("its tiles start at {} and have pixels of {}", matrix.corner, matrix.pixel),
                remedy: "write it again",
            });
        }
        const MOST: u64 = u32::MAX as u64;
        if matrix.tiles.max_element().max(matrix.tile.max_element()) > MOST || matrix.tile.min_element() == 0
        {
            return Err(FORMAT.broken(format!("it has {} tiles of {} pixels", matrix.tiles, matrix.tile)));
        }
        Ok(matrix)
    }

    /// The pixels within the bounds of the data; all where these are not stated.
    fn window(&self) -> GpkgWindow {
        let span = |low: Option<f64>, high: Option<f64>, corner: f64, pixel: f64, all: u64| {
            let at = |edge: f64| ((edge - corner) / pixel).round();
            match low.zip(high).map(|(low, high)| (at(low), at(high))) {
                Some((low, high)) if low < high && high > 0.0 && low < all as f64 => {
                    (low.max(0.0) as u64)..(high.min(all as f64) as u64)
                }
                _ => 0..all,
            }
        };
        let all = self.tiles * self.tile;
        let [west, south, east, north] = self.bounds;
        // Rows run south.
        let (north, south) = (north.map(|north| -north), south.map(|south| -south));
        GpkgWindow {
            columns: span(west, east, self.corner.x, self.pixel.x, all.x),
            rows: span(north, south, -self.corner.y, self.pixel.y, all.y),
        }
    }
}

/// The type of heights that are integers, as GDAL has it; `None` for others, and where a tile has a scale or an offset.
fn integer_type(
    database: &Connection,
    coverage: &GpkgCoverage,
) -> Result<Option<&'static str>, DemErrorKind> {
    let integer = match (coverage.is_float, coverage.scale, coverage.offset) {
        (false, 1.0, 0.0) => "UInt16",
        (false, 1.0, -32768.0) => "Int16",
        _ => return Ok(None),
    };
    let query = "SELECT count(*) FROM gpkg_2d_gridded_tile_ancillary WHERE tpudt_name = ?1 AND (scale <> 1 OR offset <> 0)";
    let scaled: i64 = database
        .query_row(query, [&coverage.name], |row| row.get(0))
        .map_err(refused("its table gpkg_2d_gridded_tile_ancillary"))?;
    Ok((scaled == 0).then_some(integer))
}

/// Columns and rows of the window, which the file can hold.
fn size(
    database: &Connection,
    file: &DemFile,
    coverage: &GpkgCoverage,
    matrix: &GpkgMatrix,
    window: &GpkgWindow,
) -> Result<(u32, u32), DemErrorKind> {
    let query = format!("SELECT count(*) FROM {} WHERE zoom_level = ?1", quoted(&coverage.name));
    let tiles: i64 =
        database.query_row(&query, [matrix.zoom], |row| row.get(0)).map_err(refused("its tiles"))?;
    let columns = window.columns.end - window.columns.start;
    let rows = window.rows.end - window.rows.start;
    let held = u64::try_from(tiles).unwrap_or(0).saturating_mul(matrix.tile.x.saturating_mul(matrix.tile.y));
    let bytes = if coverage.is_float { 4 } else { 2 };
    let claim = SizeClaim::new(columns, rows, bytes);
    let absent = columns.saturating_mul(rows).saturating_sub(held);
    let size = SizeClaim { expansion: EXPANSION, absent, ..claim }.check(file.bytes.len())?;
    Ok((size.x, size.y))
}

/// The system by its EPSG code, else by its definition; `None` where it is undefined.
fn crs(database: &Connection, srs_id: i64) -> Result<Option<Crs>, DemErrorKind> {
    // The standard calls −1 and 0 undefined.
    if srs_id <= 0 {
        return Ok(None);
    }
    let query = "SELECT organization, organization_coordsys_id, definition FROM gpkg_spatial_ref_sys WHERE srs_id = ?1";
    let of = |row: &Row<'_>| {
        let organization: Option<String> = row.get(0)?;
        let code: Option<i64> = row.get(1)?;
        let is_epsg = organization.is_some_and(|name| name.eq_ignore_ascii_case("epsg"));
        Ok((code.filter(|_| is_epsg), row.get::<_, Option<String>>(2)?))
    };
    let row = database.query_row(query, [srs_id], of).optional();
    let Some((code, definition)) = row.map_err(refused("its table gpkg_spatial_ref_sys"))? else {
        return Ok(None);
    };
    let known = code.and_then(|code| u32::try_from(code).ok()).map(Crs::from_epsg);
    match (known, definition) {
        (Some(Ok(crs)), _) => Ok(Some(crs)),
        (_, Some(definition)) if definition != "undefined" => Ok(Some(Crs::parse(&definition)?)),
        (Some(Err(error)), _) => Err(error.into()),
        _ => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem_format::DemFormat;
    use crate::hints::DemHints;
    use crate::read;
    use crate::write::write;

    const TABLES: &str = "
        CREATE TABLE gpkg_spatial_ref_sys (srs_id INTEGER PRIMARY KEY, organization TEXT,
            organization_coordsys_id INTEGER, definition TEXT);
        INSERT INTO gpkg_spatial_ref_sys VALUES (32612, 'EPSG', 32612, 'undefined');
        CREATE TABLE gpkg_contents (table_name TEXT, min_x, min_y, max_x, max_y);
        CREATE TABLE gpkg_tile_matrix_set (table_name TEXT, srs_id INTEGER, min_x, min_y, max_x, max_y);
        INSERT INTO gpkg_tile_matrix_set VALUES ('a \"b\"', 32612, 1000, 1000, 1080, 2000);
        CREATE TABLE gpkg_tile_matrix (table_name TEXT, zoom_level INTEGER, matrix_width INTEGER, matrix_height INTEGER,
            tile_width INTEGER, tile_height INTEGER, pixel_x_size REAL, pixel_y_size REAL);
        INSERT INTO gpkg_tile_matrix VALUES ('a \"b\"', 0, 1, 1, 3, 2, 20, 20), ('a \"b\"', 1, 2, 1, 3, 2, 10, 10),
            ('a \"b\"', 2, 4, 2, 3, 2, 5, 5);
        CREATE TABLE gpkg_2d_gridded_coverage_ancillary (id INTEGER PRIMARY KEY, tile_matrix_set_name TEXT,
            datatype TEXT, scale REAL, offset REAL, precision REAL, data_null REAL, grid_cell_encoding TEXT, uom TEXT);
        CREATE TABLE gpkg_2d_gridded_tile_ancillary (id INTEGER PRIMARY KEY, tpudt_name TEXT, tpudt_id INTEGER,
            scale REAL, offset REAL);
        CREATE TABLE \"a \"\"b\"\"\" (id INTEGER PRIMARY KEY, zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER,
            tile_data BLOB);";

    fn png_tile(values: [u16; 6]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut bytes, 3, 2);
        encoder.set_color(::png::ColorType::Grayscale);
        encoder.set_depth(::png::BitDepth::Sixteen);
        let mut writer = encoder.write_header().expect("memory");
        writer.write_image_data(&values.map(u16::to_be_bytes).concat()).expect("memory");
        writer.finish().expect("memory");
        bytes
    }

    fn tiff_tile(values: [f32; 6]) -> Vec<u8> {
        let raster = Raster::new(3, Samples::F32(values.to_vec()));
        write(&raster, DemFormat::to_write("tif").expect("written"), "a.tif").expect("a raster").bytes
    }

    fn database(statements: &str, tiles: &[(i64, &[u8])]) -> Vec<u8> {
        let mut connection = Connection::open_in_memory().expect("memory");
        connection.execute_batch(TABLES).expect("sound SQL");
        connection.execute_batch(statements).expect("sound SQL");
        for (column, bytes) in tiles {
            let insert = "INSERT INTO \"a \"\"b\"\"\" (zoom_level, tile_column, tile_row, tile_data) VALUES (1, ?1, 0, ?2)";
            connection.execute(insert, (column, bytes)).expect("sound SQL");
        }
        connection.serialize("main").expect("memory").to_vec()
    }

    fn raster(bytes: &[u8]) -> Result<Raster, String> {
        read::read("a.gpkg", bytes, &DemHints::default()).map_err(|error| error.to_string())
    }

    const INTEGERS: &str = "INSERT INTO gpkg_2d_gridded_coverage_ancillary VALUES
        (1, 'a \"b\"', 'integer', 2, -100, 0.1, 65535, 'grid-value-is-area', 'ft');
        INSERT INTO gpkg_2d_gridded_tile_ancillary VALUES (1, 'a \"b\"', 2, 0.5, 10);";

    const FLOATS: &str = "INSERT INTO gpkg_2d_gridded_coverage_ancillary VALUES
        (1, 'a \"b\"', 'float', 1, 0, 1, -9999, 'grid-value-is-center', NULL);";

    #[test]
    fn integers_become_heights_by_two_scales_and_offsets() {
        let (one, other) = (png_tile([1, 2, 65535, 4, 5, 6]), png_tile([10, 20, 30, 40, 50, 60]));
        let raster = raster(&database(INTEGERS, &[(0, &one), (1, &other)])).expect("sound");
        assert_eq!((raster.width, raster.height, raster.meters_per_z), (6, 2, 0.3048));
        assert_eq!(raster.geotransform(), [1000.0, 10.0, 0.0, 2000.0, 0.0, -10.0]);
        assert_eq!(raster.crs.as_ref().and_then(Crs::epsg), Some(32612));
        // The second tile has a scale of its own.
        assert_eq!(
            [raster.at(0, 0), raster.at(1, 1), raster.at(3, 0), raster.at(5, 1)],
            [-98.0, -90.0, -70.0, -20.0]
        );
        assert!(raster.at(2, 0).is_nan());
        assert_eq!((raster.driver, raster.data_type), ("GPKG", "Float32"));
    }

    #[test]
    fn floats_are_read_within_the_bounds_of_the_data_and_missing_tiles_are_no_data() {
        let bounds = "INSERT INTO gpkg_contents VALUES ('a \"b\"', 1010, 1980, 1050, 1990);";
        let tile = tiff_tile([1.5, -9999.0, 2.5, 3.5, 4.5, 5.5]);
        let bytes = database(&(FLOATS.to_owned() + bounds), &[(0, &tile)]);
        let raster = raster(&bytes).expect("sound");
        assert_eq!((raster.width, raster.height), (4, 1));
        assert_eq!(raster.geotransform(), [1010.0, 10.0, 0.0, 1990.0, 0.0, -10.0]);
        assert_eq!([raster.at(0, 0), raster.at(1, 0)], [4.5, 5.5]);
        assert!(raster.at(2, 0).is_nan() && raster.at(3, 0).is_nan());
        assert_eq!(read::format_by_head("a.gpkg", &bytes, &DemHints::default()), Some("GeoPackage"));
    }

    #[test]
    fn what_is_no_coverage_is_refused_with_the_reason() {
        let tile = tiff_tile([1.0; 6]);
        let refused = |statements: &str, tiles: &[(i64, &[u8])]| {
            raster(&database(statements, tiles)).expect_err("refused")
        };
        assert!(refused("", &[]).contains("only pictures"));
        assert!(refused(FLOATS, &[]).contains("no level"));
        assert!(refused(FLOATS, &[(0, b"GIF89a")]).contains("tile 0, 0 of level 1"));
        assert!(refused(INTEGERS, &[(0, &tile)]).contains("tile 0, 0 of level 1"));
        let two = FLOATS.replace("(1, ", "(2, ").replace("'a \"b\"'", "'c'");
        assert!(refused(&format!("{FLOATS}{two}"), &[]).contains("2 coverages: a \"b\", c"));
        let corner = FLOATS.replace("grid-value-is-center", "grid-value-is-corner");
        assert!(refused(&corner, &[(0, &tile)]).contains("corners of cells"));
        let small = "UPDATE gpkg_tile_matrix SET tile_width = 4;";
        assert!(refused(&format!("{FLOATS}{small}"), &[(0, &tile)]).contains("3 x 2 pixels, not 4 x 2"));
        let vast = "UPDATE gpkg_tile_matrix SET matrix_width = 4000000000, matrix_height = 4000000000;";
        assert!(refused(&format!("{FLOATS}{vast}"), &[(0, &tile)]).contains("12000000000 x 8000000000"));
        let mut features = Connection::open_in_memory().expect("memory");
        features.execute_batch("CREATE TABLE gpkg_geometry_columns (a)").expect("sound SQL");
        let features = features.serialize("main").expect("memory").to_vec();
        assert!(raster(&features).expect_err("features").contains("no GeoPackage of elevation"));
        assert_eq!(read::format_by_head("a.gpkg", &features, &DemHints::default()), None);
    }

    #[test]
    fn a_file_cut_anywhere_or_with_bytes_turned_is_read_or_refused() {
        let (one, other) = (png_tile([1, 2, 65535, 4, 5, 6]), png_tile([10, 20, 30, 40, 50, 60]));
        let bytes = database(INTEGERS, &[(0, &one), (1, &other)]);
        for at in (0..bytes.len()).step_by(31) {
            let _ = raster(&bytes[..at]);
            let mut turned = bytes.clone();
            turned[at] ^= 0xff;
            if let Ok(raster) = raster(&turned) {
                assert_eq!(raster.samples.len(), raster.width as usize * raster.height as usize);
            }
        }
    }
}

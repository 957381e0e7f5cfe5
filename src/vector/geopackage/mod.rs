//! GeoPackage 1.0 to 1.4 (OGC 12-128): tables and views of features in an SQLite database.
//!
//! `gpkg_geometry_columns` lists the tables with shapes, `gpkg_spatial_ref_sys` their coordinate systems. A shape is a
//! header and well-known binary ([`wkb`]):
//!
//! ```text
//! 'G' 'P' version flags  srs:i32  envelope: 0, 4, 6 or 8 numbers  WKB
//!                 └ 1: byte order, 2–4: envelope, 5: empty, 6: extended
//! ```
//!
//! `sandtable-database` opens the file within limits.

use rusqlite::types::ValueRef;
use rusqlite::{Connection, ErrorCode, Row};
use serde_json::{Number, Value};

use crate::builder::{FeatureParts, LayerBuilder};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::wkb::{self, WkbError};
use sandtable_base::bytes::ByteCursor;
use sandtable_database::{open, quoted};
use sandtable_geom::crs::Crs;

const FORMAT: &str = "GeoPackage";

struct GpkgTable {
    name: String,
    geometry_column: String,
    srs_id: i64,
}

/// A column of a table. SQLite keeps booleans as 1 and 0.
struct GpkgColumn {
    name: String,
    is_boolean: bool,
}

/// Reads the requested layer, or the only one.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let connection = open(bytes).map_err(|error| refused("its tables", error))?;
    let mut tables = tables(&connection)?;
    if tables.is_empty() && hints.layer.is_none() {
        return Err(VectorError::Unsupported {
            format: FORMAT,
            content: "no features, only rasters or tables".into(),
            remedy: "give one with a layer of features",
        });
    }
    let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    let chosen = hints.choose_layer(&names)?;
    let table = tables.swap_remove(chosen);
    let own = crs_of(&connection, table.srs_id, hints);
    let crs = hints.crs.cloned().map_or(own, Ok)?;
    let mut layer = LayerBuilder::new(crs);
    read_features(&connection, &table, &mut layer)?;
    layer.finish()
}

fn refused(place: &str, error: rusqlite::Error) -> VectorError {
    match error.sqlite_error_code() {
        Some(ErrorCode::OperationInterrupted) => {
            VectorError::broken(FORMAT, place, "reading it takes more steps than any real file")
        }
        Some(ErrorCode::NotADatabase) => {
            VectorError::broken(FORMAT, place, "it is not an SQLite database that can be read")
        }
        _ => VectorError::broken(FORMAT, place, error),
    }
}

/// Returns every table and view with shapes, in the order that they were registered.
fn tables(connection: &Connection) -> Result<Vec<GpkgTable>, VectorError> {
    let table = |row: &Row<'_>| {
        Ok(GpkgTable {
            name: row.get(0)?,
            geometry_column: row.get(1)?,
            srs_id: row.get::<_, Option<i64>>(2)?.unwrap_or(-1),
        })
    };
    let query = "SELECT table_name, column_name, srs_id FROM gpkg_geometry_columns ORDER BY rowid";
    let tables = connection
        .prepare(query)
        .and_then(|mut statement| statement.query_map([], table)?.collect::<rusqlite::Result<Vec<_>>>());
    tables.map_err(|error| match error.sqlite_error_code() {
        Some(ErrorCode::Unknown) => VectorError::Unsupported {
            format: "SQLite database",
            content: "no table gpkg_geometry_columns, which a GeoPackage has".into(),
            remedy: "convert it: ogr2ogr -f GPKG new.gpkg old.sqlite",
        },
        _ => refused("its table gpkg_geometry_columns", error),
    })
}

/// Returns the coordinate system `srs_id`: that of its EPSG code, else that of its definition.
fn crs_of(connection: &Connection, srs_id: i64, hints: &VectorHints) -> Result<Crs, VectorError> {
    let undefined = || VectorError::NoCrs { format: FORMAT, reason: "leaves it undefined" };
    // The standard calls −1 and 0 undefined.
    if srs_id <= 0 {
        return Err(undefined());
    }
    let query = "SELECT organization, organization_coordsys_id, definition FROM gpkg_spatial_ref_sys WHERE srs_id = ?1";
    let row = connection.query_row(query, [srs_id], |row| {
        let organization: Option<String> = row.get(0)?;
        let code: Option<i64> = row.get(1)?;
        let is_epsg = organization.is_some_and(|name| name.eq_ignore_ascii_case("epsg"));
        Ok((code.filter(|_| is_epsg), row.get::<_, Option<String>>(2)?))
    });
    match row {
        Ok((code, definition)) => {
            let code = code.and_then(|code| u32::try_from(code).ok());
            hints.crs_or(code, definition.as_deref())?.ok_or_else(undefined)
        }
        Err(rusqlite::Error::QueryReturnedNoRows) => Err(undefined()),
        Err(error) => Err(refused("its table gpkg_spatial_ref_sys", error)),
    }
}

fn read_features(
    connection: &Connection,
    table: &GpkgTable,
    layer: &mut LayerBuilder,
) -> Result<(), VectorError> {
    let place = format!("its layer '{}'", shorten(&table.name));
    let refused = |error: rusqlite::Error| refused(&place, error);
    let columns = columns(connection, &table.name).map_err(refused)?;
    let is_geometry = |column: &GpkgColumn| column.name.eq_ignore_ascii_case(&table.geometry_column);
    let Some(geometry) = columns.iter().position(is_geometry) else {
        let reason = format!("it has no column '{}'", table.geometry_column);
        return Err(VectorError::broken(FORMAT, place, reason));
    };
    let names: Vec<String> = columns.iter().map(|column| quoted(&column.name)).collect();
    let query = format!("SELECT {} FROM {}", names.join(", "), quoted(&table.name));
    let mut statement = connection.prepare(&query).map_err(refused)?;
    let mut rows = statement.query([]).map_err(refused)?;
    while let Some(row) = rows.next().map_err(refused)? {
        let mut parts = FeatureParts::default();
        if let ValueRef::Blob(blob) = row.get_ref(geometry).map_err(refused)?
            && let Err(error) = read_shape(blob, &mut parts)
        {
            let feature = format!("feature {}", layer.feature_count() + 1);
            let error = match error {
                WkbError::Unsupported(kind) => VectorError::curves(FORMAT, kind),
                WkbError::Broken | WkbError::TooDeep => {
                    VectorError::broken(FORMAT, format!("{place}, {feature}"), error)
                }
            };
            layer.add_broken(feature, error);
            continue;
        }
        let mut properties = Properties::new();
        for (index, column) in columns.iter().enumerate().filter(|&(index, _)| index != geometry) {
            let value = value(row.get_ref(index).map_err(refused)?, column);
            properties.insert(column.name.clone(), value);
        }
        layer.add(parts, properties);
    }
    Ok(())
}

/// Returns the columns of a table or view. The pragma is queried because the names that a statement reports may not be
/// text, on which `rusqlite` panics.
fn columns(connection: &Connection, table: &str) -> rusqlite::Result<Vec<GpkgColumn>> {
    let mut statement = connection.prepare("SELECT name, upper(type) FROM pragma_table_info(?1)")?;
    let column = |row: &Row<'_>| {
        let is_boolean = row.get::<_, Option<String>>(1)?.as_deref() == Some("BOOLEAN");
        Ok(GpkgColumn { name: row.get(0)?, is_boolean })
    };
    statement.query_map([table], column)?.collect()
}

fn value(value: ValueRef<'_>, column: &GpkgColumn) -> Value {
    match value {
        ValueRef::Integer(number) if column.is_boolean => Value::Bool(number != 0),
        ValueRef::Integer(number) => number.into(),
        ValueRef::Real(number) => Number::from_f64(number).map_or(Value::Null, Value::Number),
        ValueRef::Text(text) => String::from_utf8_lossy(text).into(),
        ValueRef::Null | ValueRef::Blob(_) => Value::Null,
    }
}

/// Adds the shape behind a GeoPackage's header to `parts`.
fn read_shape(blob: &[u8], parts: &mut FeatureParts) -> Result<(), WkbError> {
    let mut cursor = ByteCursor::new(blob);
    let Some([b'G', b'P', _version, flags, ..]) = cursor.array::<8>() else { return Err(WkbError::Broken) };
    if flags & 0x20 != 0 {
        return Err(WkbError::Unsupported("of an extension (ExtendedGeoPackageBinary)"));
    }
    let envelope_numbers = match (flags >> 1) & 7 {
        0 => 0,
        1 => 4,
        2 | 3 => 6,
        4 => 8,
        _ => return Err(WkbError::Broken),
    };
    cursor.take(8 * envelope_numbers).ok_or(WkbError::Broken)?;
    let is_empty = flags & 0x10 != 0;
    if is_empty { Ok(()) } else { wkb::read(cursor.rest(), parts) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const TABLES: &str = "
        CREATE TABLE gpkg_spatial_ref_sys (srs_id INTEGER PRIMARY KEY, organization TEXT,
            organization_coordsys_id INTEGER, definition TEXT);
        INSERT INTO gpkg_spatial_ref_sys VALUES (4326, 'EPSG', 4326, 'undefined'),
            (100001, 'NONE', 1, '+proj=tmerc +lat_0=0 +lon_0=9 +x_0=500000 +ellps=GRS80 +towgs84=0,0,0 +units=m');
        CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT, srs_id INTEGER);
        CREATE TABLE \"my roads\" (fid INTEGER PRIMARY KEY, geom BLOB, name TEXT, lanes INTEGER, width REAL,
            bridge BOOLEAN, built DATE, photo BLOB);";

    /// The bytes of a database made by `statements`.
    fn database(statements: &str) -> Vec<u8> {
        let mut connection = Connection::open_in_memory().expect("memory");
        connection.execute_batch(TABLES).expect("sound SQL");
        connection.execute_batch(statements).expect("sound SQL");
        connection.serialize("main").expect("memory").to_vec()
    }

    /// The header and the WKB of a line from (1, 2) at 7 to (3, 4) at 8, as SQL writes bytes.
    fn line() -> String {
        let mut bytes = b"GP\0\x01\xe6\x10\0\0\x01\xea\x03\0\0\x02\0\0\0".to_vec();
        bytes.extend([1f64, 2.0, 7.0, 3.0, 4.0, 8.0].iter().flat_map(|number| number.to_le_bytes()));
        let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        format!("x'{digits}'")
    }

    fn roads(system: i64) -> String {
        let line = line();
        format!(
            "INSERT INTO gpkg_geometry_columns VALUES ('my roads', 'geom', {system});
             INSERT INTO \"my roads\" VALUES (1, {line}, 'Main', 2, 7.5, 1, '2020-01-31', x'00'),
                (2, NULL, NULL, NULL, NULL, NULL, NULL, NULL);"
        )
    }

    fn layer(bytes: &[u8], name: &str) -> Result<VectorLayer, VectorError> {
        read(bytes, &VectorHints { layer: Some(name), ..VectorHints::default() })
    }

    #[test]
    fn values_keep_their_kind_and_shapes_their_elevations() {
        let layer = read(&database(&roads(4326)), &VectorHints::default()).expect("sound");
        let [road] = &layer.features[..] else { panic!("one has a shape") };
        assert_eq!(road.elevations, Some(vec![7.0, 8.0]));
        let expected = json!({"fid": 1, "name": "Main", "lanes": 2, "width": 7.5, "bridge": true,
            "built": "2020-01-31", "photo": null});
        assert_eq!(json!(road.properties), expected);
        assert_eq!(layer.notes, ["left out: 1 feature without a usable geometry (feature 2)"]);
        assert_eq!(layer.crs.epsg(), Some(4326));
    }

    #[test]
    fn a_shape_that_is_broken_or_curved_is_left_out_and_reported() {
        let curve = "x'47500001e61000000108000000020000000000000000000000'";
        let more = format!(
            "INSERT INTO \"my roads\" (fid, geom) VALUES (3, x'475000'), (4, {curve}), (5, {});",
            line()
        );
        let layer = read(&database(&(roads(4326) + &more)), &VectorHints::default()).expect("two are sound");
        assert_eq!(layer.features.len(), 2);
        let [fault] = &layer.faults[..] else { panic!("one sentence: {:?}", layer.faults) };
        for part in
            ["2 records", "feature 3: a shape is cut short", "feature 4: shapes of the type CircularString"]
        {
            assert!(fault.contains(part), "{fault}");
        }
    }

    #[test]
    fn systems_may_have_a_definition_only_and_undefined_ones_must_be_stated() {
        let own = read(&database(&roads(100_001)), &VectorHints::default()).expect("sound");
        assert!(own.crs.is_metric() && own.crs.epsg().is_none());
        for undefined in [-1, 0, 7] {
            let bytes = database(&roads(undefined));
            let error = read(&bytes, &VectorHints::default()).expect_err("undefined").to_string();
            assert!(error.contains("with the key 'crs'"), "{error}");
            assert!(
                read(&bytes, &VectorHints { crs: Some(&Crs::local()), ..VectorHints::default() }).is_ok()
            );
        }
    }

    #[test]
    fn views_are_layers_and_one_that_never_ends_is_stopped() {
        let views = "CREATE VIEW named AS SELECT * FROM \"my roads\" WHERE name IS NOT NULL;
            CREATE VIEW endless AS WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n)
                SELECT x'00' AS geom FROM n WHERE x < 0;
            INSERT INTO gpkg_geometry_columns VALUES ('named', 'geom', 4326), ('endless', 'geom', 4326);";
        let bytes = database(&(roads(4326) + views));
        assert_eq!(layer(&bytes, "named").expect("sound").features.len(), 1);
        let error = layer(&bytes, "endless").expect_err("endless").to_string();
        assert!(error.contains("more steps"), "{error}");
        let error = read(&bytes, &VectorHints::default()).expect_err("three layers").to_string();
        assert!(error.contains("3 layers; choose one with 'layer': my roads, named, endless"), "{error}");
    }

    #[test]
    fn another_database_is_refused_with_the_reason() {
        let mut connection = Connection::open_in_memory().expect("memory");
        connection.execute_batch("CREATE TABLE a (b)").expect("sound SQL");
        let bytes = connection.serialize("main").expect("memory").to_vec();
        let error = read(&bytes, &VectorHints::default()).expect_err("no tables").to_string();
        assert!(error.contains("gpkg_geometry_columns"), "{error}");
        assert!(read(b"SQLite format 3\0", &VectorHints::default()).is_err());
    }

    #[test]
    fn a_file_cut_anywhere_or_with_bytes_turned_is_read_or_refused() {
        let bytes = database(&roads(4326));
        for at in (0..bytes.len()).step_by(37) {
            let _ = read(&bytes[..at], &VectorHints::default());
            let mut turned = bytes.clone();
            turned[at] ^= 0xff;
            let _ = read(&turned, &VectorHints::default());
        }
    }
}

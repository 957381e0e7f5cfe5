//! GeoPackage 1.0 to 1.4 (OGC 12-128): tables and views of features in an SQLite database.
//!
//! `gpkg_geometry_columns` says which tables have shapes, `gpkg_spatial_ref_sys` what their systems are. A shape is
//! a header and well-known binary ([`wkb`]):
//!
//! ```text
//! 'G' 'P' version flags  srs:i32  envelope: 0, 4, 6 or 8 numbers  WKB
//!                 └ 1: byte order, 2–4: envelope, 5: empty, 6: extended
//! ```
//!
//! The database is a program of its maker's as much as data: views are queries, and they may run for ever. It is
//! opened from memory, read only, without extensions or functions that do anything but compute, with limits on
//! the length of values and statements, and stopped after so many steps as no honest file takes.

use std::io::Read;
use std::ops::Range;

use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, ErrorCode, Row};
use serde_json::{Number, Value};

use crate::geom::crs::Crs;
use crate::vector::collect::{Collector, FeatureParts, Properties};
use crate::vector::cursor::ByteCursor;
use crate::vector::error::VectorError;
use crate::vector::feature::VectorLayer;
use crate::vector::wkb::{self, WkbError};

const FORMAT: &str = "GeoPackage";
/// Steps of SQLite's machine between looks at how many there were.
const STEPS_BETWEEN: i32 = 100_000;
/// Steps that any file may take: a second or two.
const FREE_STEPS: u64 = 100_000_000;
/// Steps for each byte of the file: reading one takes less than one.
const STEPS_PER_BYTE: u64 = 10;

/// Whether `bytes` are an SQLite database.
pub(super) fn is_sqlite(bytes: &[u8]) -> bool {
    bytes.starts_with(b"SQLite format 3\0")
}

/// One table or view of features.
struct GpkgTable {
    name: String,
    geometry: String,
    system: i64,
}

/// All features of the layer `wanted`, or of the only one.
///
/// # Errors
/// [`VectorError`].
pub(super) fn read(
    bytes: &[u8],
    stated: Option<&Crs>,
    wanted: Option<&str>,
) -> Result<VectorLayer, VectorError> {
    let connection = open(bytes).map_err(|error| refusal("its tables", &error))?;
    let table = choose(tables(&connection)?, wanted)?;
    let crs = match stated {
        Some(crs) => crs.clone(),
        None => system(&connection, table.system)?,
    };
    let mut collector = Collector::new(crs);
    features(&connection, &table, &mut collector)?;
    Ok(collector.finish())
}

/// The database, disarmed.
fn open(bytes: &[u8]) -> rusqlite::Result<Connection> {
    let mut connection = Connection::open_in_memory()?;
    let longest = i32::try_from(bytes.len()).unwrap_or(i32::MAX);
    let limits = [
        (Limit::SQLITE_LIMIT_LENGTH, longest.max(1 << 20)),
        (Limit::SQLITE_LIMIT_SQL_LENGTH, 1 << 20),
        (Limit::SQLITE_LIMIT_EXPR_DEPTH, 100),
        (Limit::SQLITE_LIMIT_COMPOUND_SELECT, 50),
        (Limit::SQLITE_LIMIT_ATTACHED, 0),
        (Limit::SQLITE_LIMIT_TRIGGER_DEPTH, 1),
        (Limit::SQLITE_LIMIT_WORKER_THREADS, 0),
    ];
    connection.deserialize_read_exact("main", without_log(bytes), bytes.len(), true)?;
    for (limit, value) in limits {
        connection.set_limit(limit, value)?;
    }
    let most = FREE_STEPS.saturating_add(STEPS_PER_BYTE.saturating_mul(bytes.len() as u64));
    let mut left = most / STEPS_BETWEEN.unsigned_abs() as u64;
    let is_enough = move || {
        left = left.saturating_sub(1);
        left == 0
    };
    connection.progress_handler(STEPS_BETWEEN, Some(is_enough))?;
    connection
        .execute_batch("PRAGMA trusted_schema = OFF; PRAGMA query_only = ON; PRAGMA cell_size_check = ON;")?;
    Ok(connection)
}

/// The database as one that keeps no write-ahead log (database file format, section 1.3: bytes 18 and 19), since
/// there is no file beside it that the log could lie in. What a program left in such a file is not seen.
fn without_log(bytes: &[u8]) -> impl Read {
    const VERSIONS: Range<usize> = 18..20;
    const NO_LOG: [u8; 2] = [1, 1];
    let before = &bytes[..bytes.len().min(VERSIONS.start)];
    let after = bytes.get(VERSIONS.end..).unwrap_or_default();
    before.chain(&NO_LOG[..]).chain(after)
}

fn refusal(place: &str, error: &rusqlite::Error) -> VectorError {
    let reason = match error.sqlite_error_code() {
        Some(ErrorCode::OperationInterrupted) => {
            String::from("reading it takes more steps than any honest file")
        }
        Some(ErrorCode::NotADatabase) => String::from("it is no SQLite database that can be read"),
        _ => error.to_string().chars().take(200).collect(),
    };
    VectorError::broken(FORMAT, place, reason)
}

/// Every table and view with shapes, in the order that they were registered.
fn tables(connection: &Connection) -> Result<Vec<GpkgTable>, VectorError> {
    let query = "SELECT table_name, column_name, srs_id FROM gpkg_geometry_columns ORDER BY rowid";
    let all = (|| {
        let mut statement = connection.prepare(query)?;
        let table = |row: &Row<'_>| {
            Ok(GpkgTable {
                name: row.get(0)?,
                geometry: row.get(1)?,
                system: row.get::<_, Option<i64>>(2)?.unwrap_or(-1),
            })
        };
        statement.query_map([], table)?.collect::<rusqlite::Result<Vec<_>>>()
    })();
    all.map_err(|error| match error.sqlite_error_code() {
        Some(ErrorCode::Unknown) => VectorError::Unsupported {
            format: "SQLite database",
            what: "no table gpkg_geometry_columns, as a GeoPackage has it".into(),
            remedy: "convert it: ogr2ogr -f GPKG new.gpkg old.sqlite".into(),
        },
        _ => refusal("its table gpkg_geometry_columns", &error),
    })
}

fn choose(mut tables: Vec<GpkgTable>, wanted: Option<&str>) -> Result<GpkgTable, VectorError> {
    let at = match wanted {
        Some(wanted) => tables.iter().position(|table| table.name == wanted),
        None => (tables.len() == 1).then_some(0),
    };
    let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    match (at, wanted) {
        (Some(at), _) => Ok(tables.swap_remove(at)),
        (None, Some(wanted)) => Err(VectorError::no_such_layer(wanted, &names)),
        (None, None) if names.is_empty() => Err(VectorError::Unsupported {
            format: FORMAT,
            what: "no features, only rasters or tables".into(),
            remedy: "give one with a layer of features".into(),
        }),
        (None, None) => Err(VectorError::which_layer(&names)),
    }
}

/// The system with the number `id`: by its authority's code or, where that is not known, its definition.
fn system(connection: &Connection, id: i64) -> Result<Crs, VectorError> {
    // −1 and 0 are "undefined" by the standard's own words.
    let unknown = VectorError::NoCrs { format: FORMAT, wanting: "leaves it undefined" };
    if id <= 0 {
        return Err(unknown);
    }
    let query = "SELECT organization, organization_coordsys_id, definition FROM gpkg_spatial_ref_sys WHERE srs_id = ?1";
    let row = connection.query_row(query, [id], |row| {
        Ok((
            row.get::<_, Option<String>>(0)?,
            row.get::<_, Option<i64>>(1)?,
            row.get::<_, Option<String>>(2)?,
        ))
    });
    let (organization, code, definition) = match row {
        Ok(row) => row,
        Err(rusqlite::Error::QueryReturnedNoRows) => return Err(unknown),
        Err(error) => return Err(refusal("its table gpkg_spatial_ref_sys", &error)),
    };
    let is_epsg = organization.is_some_and(|name| name.eq_ignore_ascii_case("epsg"));
    let code = code.filter(|_| is_epsg).and_then(|code| u32::try_from(code).ok());
    match (code.map(Crs::from_epsg), definition) {
        (Some(Ok(crs)), _) => Ok(crs),
        (_, Some(definition)) => Crs::parse(&definition).map_err(VectorError::Crs),
        (Some(Err(error)), None) => Err(VectorError::Crs(error)),
        (None, None) => Err(unknown),
    }
}

fn features(
    connection: &Connection,
    table: &GpkgTable,
    collector: &mut Collector,
) -> Result<(), VectorError> {
    let place = format!("its layer '{}'", table.name.chars().take(60).collect::<String>());
    let refused = |error: rusqlite::Error| refusal(&place, &error);
    let columns = columns(connection, &table.name).map_err(refused)?;
    let Some(geometry) = columns.iter().position(|column| column.name.eq_ignore_ascii_case(&table.geometry))
    else {
        return Err(VectorError::broken(FORMAT, place, format!("it has no column '{}'", table.geometry)));
    };
    let named: Vec<String> = columns.iter().map(|column| quoted(&column.name)).collect();
    let query = format!("SELECT {} FROM {}", named.join(", "), quoted(&table.name));
    let mut statement = connection.prepare(&query).map_err(refused)?;
    let mut rows = statement.query([]).map_err(refused)?;
    while let Some(row) = rows.next().map_err(refused)? {
        let mut parts = FeatureParts::default();
        if let ValueRef::Blob(blob) = row.get_ref(geometry).map_err(refused)? {
            shape(blob, &mut parts).map_err(|error| not_read(error, &place, collector.seen() + 1))?;
        }
        let mut properties = Properties::new();
        for (index, column) in columns.iter().enumerate().filter(|&(index, _)| index != geometry) {
            let value = value(row.get_ref(index).map_err(refused)?, column.kind);
            properties.insert(column.name.clone(), value);
        }
        collector.add(parts, properties)?;
    }
    Ok(())
}

fn not_read(error: WkbError, place: &str, feature: usize) -> VectorError {
    match error {
        WkbError::Broken => VectorError::broken(
            FORMAT,
            format!("{place}, feature {feature}"),
            "its shape is cut short or forged",
        ),
        WkbError::Unsupported(kind) => VectorError::Unsupported {
            format: FORMAT,
            what: format!("shapes of the type {kind}"),
            remedy: "convert them, for example with: ogr2ogr -nlt CONVERT_TO_LINEAR".into(),
        },
    }
}

/// A name as SQL quotes it.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// A column of a layer.
struct GpkgColumn {
    name: String,
    kind: GpkgColumnKind,
}

/// What a column's numbers mean.
#[derive(Clone, Copy, PartialEq, Eq)]
enum GpkgColumnKind {
    /// Declared to hold true and false, which SQLite keeps as 1 and 0.
    Boolean,
    /// Themselves.
    Other,
}

/// The columns of a table or view. Asked for by a query, since a statement's own names may be no text, which
/// `rusqlite` takes for a mistake of the program's.
fn columns(connection: &Connection, table: &str) -> rusqlite::Result<Vec<GpkgColumn>> {
    let mut statement = connection.prepare("SELECT name, upper(type) FROM pragma_table_info(?1)")?;
    let column = |row: &Row<'_>| {
        let is_boolean = row.get::<_, Option<String>>(1)?.as_deref() == Some("BOOLEAN");
        Ok(GpkgColumn {
            name: row.get(0)?,
            kind: if is_boolean { GpkgColumnKind::Boolean } else { GpkgColumnKind::Other },
        })
    };
    statement.query_map([table], column)?.collect()
}

fn value(value: ValueRef<'_>, kind: GpkgColumnKind) -> Value {
    match value {
        ValueRef::Integer(number) if kind == GpkgColumnKind::Boolean => Value::Bool(number != 0),
        ValueRef::Integer(number) => number.into(),
        ValueRef::Real(number) => Number::from_f64(number).map_or(Value::Null, Value::Number),
        ValueRef::Text(text) => String::from_utf8_lossy(text).into(),
        ValueRef::Null | ValueRef::Blob(_) => Value::Null,
    }
}

/// Adds the shape behind a GeoPackage's header.
fn shape(blob: &[u8], parts: &mut FeatureParts) -> Result<(), WkbError> {
    let mut cursor = ByteCursor::new(blob);
    let header: [u8; 8] =
        cursor.array().filter(|header: &[u8; 8]| header.starts_with(b"GP")).ok_or(WkbError::Broken)?;
    let flags = header[3];
    if flags & 0x20 != 0 {
        return Err(WkbError::Unsupported("of an extension (ExtendedGeoPackageBinary)"));
    }
    let numbers = match (flags >> 1) & 7 {
        0 => 0,
        1 => 4,
        2 | 3 => 6,
        4 => 8,
        _ => return Err(WkbError::Broken),
    };
    cursor.take(8 * numbers).ok_or(WkbError::Broken)?;
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

    #[test]
    fn values_keep_their_kind_and_shapes_their_elevations() {
        let layer = read(&database(&roads(4326)), None, None).expect("sound");
        let [road] = &layer.features[..] else { panic!("one has a shape") };
        assert_eq!(road.elevations, Some(vec![7.0, 8.0]));
        let expected = json!({"fid": 1, "name": "Main", "lanes": 2, "width": 7.5, "bridge": true,
            "built": "2020-01-31", "photo": null});
        assert_eq!(json!(road.properties), expected);
        assert_eq!(layer.notes, ["left out: 1 features without a usable geometry"]);
        assert_eq!(layer.crs.epsg(), Some(4326));
    }

    #[test]
    fn systems_are_known_by_their_definition_too_and_undefined_ones_must_be_stated() {
        let own = read(&database(&roads(100_001)), None, None).expect("sound");
        assert!(own.crs.is_metric() && own.crs.epsg().is_none());
        for undefined in [-1, 0, 7] {
            let bytes = database(&roads(undefined));
            let error = read(&bytes, None, None).expect_err("undefined").to_string();
            assert!(error.contains("with the key 'crs'"), "{error}");
            assert!(read(&bytes, Some(&Crs::local()), None).is_ok());
        }
    }

    #[test]
    fn views_are_layers_and_one_that_never_ends_is_stopped() {
        let views = "CREATE VIEW named AS SELECT * FROM \"my roads\" WHERE name IS NOT NULL;
            CREATE VIEW endless AS WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n)
                SELECT x'00' AS geom FROM n WHERE x < 0;
            INSERT INTO gpkg_geometry_columns VALUES ('named', 'geom', 4326), ('endless', 'geom', 4326);";
        let bytes = database(&(roads(4326) + views));
        assert_eq!(read(&bytes, None, Some("named")).expect("sound").features.len(), 1);
        let error = read(&bytes, None, Some("endless")).expect_err("endless").to_string();
        assert!(error.contains("more steps"), "{error}");
        let error = read(&bytes, None, None).expect_err("three layers").to_string();
        assert!(error.contains("3 layers; say which with 'layer': my roads, named, endless"), "{error}");
    }

    #[test]
    fn a_database_that_is_no_geopackage_is_told_so() {
        let mut connection = Connection::open_in_memory().expect("memory");
        connection.execute_batch("CREATE TABLE a (b)").expect("sound SQL");
        let bytes = connection.serialize("main").expect("memory").to_vec();
        let error = read(&bytes, None, None).expect_err("no tables").to_string();
        assert!(error.contains("gpkg_geometry_columns"), "{error}");
        assert!(read(b"SQLite format 3\0", None, None).is_err());
    }

    #[test]
    fn a_file_cut_anywhere_or_with_bytes_turned_is_read_or_refused() {
        let bytes = database(&roads(4326));
        for at in (0..bytes.len()).step_by(37) {
            let _ = read(&bytes[..at], None, None);
            let mut turned = bytes.clone();
            turned[at] ^= 0xff;
            let _ = read(&turned, None, None);
        }
    }
}

//! Features as an OGC GeoPackage 1.3: a table a layer, and styles in the table that QGIS reads (`layer_styles`).

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rusqlite::types::Value as SqlValue;
use rusqlite::{Connection, params, params_from_iter};
use serde_json::Value;

use super::qgis_style::{CodePicture, qml};
use super::{
    ExportFeature, ExportKind, ExportLayer, ExportShape, ExportedFeatures, FeatureExportError, MadeFile,
    counted,
};
use sandtable_database::quoted;
use sandtable_geom::crs::Crs;
use sandtable_geom::wkt_writer;
use sandtable_scene::military::SceneSymbol;

/// All tables say they changed then: the same scene gives the same bytes.
const MOMENT: &str = "2000-01-01T00:00:00.000Z";
/// The number of a system without a code.
const OWN_SYSTEM: i32 = 100_000;
/// `GPKG`, and version 1.3.
const APPLICATION_ID: i32 = 0x4750_4b47;
const USER_VERSION: i32 = 10_300;

const WGS84: &str = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563,AUTHORITY[\"EPSG\",\"7030\"]],AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0,AUTHORITY[\"EPSG\",\"8901\"]],UNIT[\"degree\",0.0174532925199433,AUTHORITY[\"EPSG\",\"9122\"]],AUTHORITY[\"EPSG\",\"4326\"]]";

const TABLES: &str = "
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
  description TEXT DEFAULT '', last_change DATETIME NOT NULL, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
  srs_id INTEGER, CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name), CONSTRAINT uk_gc_table_name UNIQUE (table_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id));
CREATE TABLE layer_styles (id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, f_table_catalog TEXT, f_table_schema TEXT,
  f_table_name TEXT, f_geometry_column TEXT, styleName TEXT, styleQML TEXT, styleSLD TEXT, useAsDefault BOOLEAN,
  description TEXT, owner TEXT, ui TEXT, update_time DATETIME);
";

/// The file.
///
/// # Errors
/// [`FeatureExportError::Empty`], or what the database says.
pub(super) fn file(
    layers: &[ExportLayer],
    crs: &Crs,
    symbols: &[SceneSymbol],
) -> Result<MadeFile, FeatureExportError> {
    if layers.is_empty() {
        return Err(FeatureExportError::Empty("a .gpkg"));
    }
    let bytes =
        database(layers, crs, symbols).map_err(|error| FeatureExportError::Make(error.to_string()))?;
    Ok(MadeFile { bytes, told: ExportedFeatures { layers: counted(layers), notes: Vec::new() } })
}

fn database(layers: &[ExportLayer], crs: &Crs, symbols: &[SceneSymbol]) -> rusqlite::Result<Vec<u8>> {
    let mut database = Connection::open_in_memory()?;
    database.pragma_update(None, "application_id", APPLICATION_ID)?;
    database.pragma_update(None, "user_version", USER_VERSION)?;
    database.execute_batch("BEGIN")?;
    database.execute_batch(TABLES)?;
    let srs_id = add_systems(&database, crs)?;
    for layer in layers {
        add_layer(&database, layer, srs_id)?;
        let pictures = if layer.name == "symbols" { pictures(layer, symbols) } else { Vec::new() };
        database.execute(
            "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, f_geometry_column, styleName, styleQML,
             styleSLD, useAsDefault, description, owner, ui, update_time) VALUES ('', '', ?1, 'geom', ?1, ?2, '', 1, '', '', NULL, ?3)",
            params![layer.name, qml(layer, &pictures), MOMENT],
        )?;
    }
    database.execute(
        "INSERT INTO gpkg_contents (table_name, data_type, identifier, last_change) VALUES ('layer_styles', 'attributes', 'layer_styles', ?1)",
        [MOMENT],
    )?;
    database.execute_batch("COMMIT")?;
    Ok(database.serialize("main")?.to_vec())
}

/// Adds the systems that every file has, and that of the features; returns its number.
fn add_systems(database: &Connection, crs: &Crs) -> rusqlite::Result<i32> {
    let mut add =
        database.prepare("INSERT OR IGNORE INTO gpkg_spatial_ref_sys VALUES (?1, ?2, ?3, ?4, ?5, NULL)")?;
    add.execute(params!["Undefined Cartesian", -1, "NONE", -1, "undefined"])?;
    add.execute(params!["Undefined geographic", 0, "NONE", 0, "undefined"])?;
    add.execute(params!["WGS 84", 4326, "EPSG", 4326, WGS84])?;
    let definition = wkt_writer::write(crs).unwrap_or_else(|| "undefined".to_owned());
    match crs.epsg() {
        Some(code) => {
            add.execute(params![crs.name(), code, "EPSG", code, definition])?;
            Ok(i32::try_from(code).unwrap_or(-1))
        }
        None if crs.proj_text().is_empty() => Ok(-1),
        None => {
            add.execute(params![crs.name(), OWN_SYSTEM, "NONE", OWN_SYSTEM, definition])?;
            Ok(OWN_SYSTEM)
        }
    }
}

/// The type of a column: the narrowest that holds all its values.
fn column_type<'a>(values: impl Iterator<Item = &'a Value>) -> &'static str {
    let mut kind = "INTEGER";
    for value in values {
        match value {
            Value::Number(number) if number.is_i64() || number.is_u64() => {}
            Value::Number(_) if kind != "TEXT" => kind = "REAL",
            Value::Bool(_) => {}
            _ => kind = "TEXT",
        }
    }
    kind
}

fn add_layer(database: &Connection, layer: &ExportLayer, srs_id: i32) -> rusqlite::Result<()> {
    let names: BTreeSet<&String> =
        layer.features.iter().flat_map(|feature| feature.properties.keys()).collect();
    let columns: BTreeMap<&String, &str> = names
        .into_iter()
        .map(|name| {
            (name, column_type(layer.features.iter().filter_map(|feature| feature.properties.get(name))))
        })
        .collect();
    let type_name = match layer.kind {
        ExportKind::Points => "POINT",
        ExportKind::Lines => "LINESTRING",
        ExportKind::Polygons => "POLYGON",
    };
    let has_z = layer.features.iter().all(|feature| feature.shape.vertices().all(|at| at.z.is_finite()));
    let declared: String = columns.iter().map(|(name, kind)| format!(", {} {kind}", quoted(name))).collect();
    let table = quoted(layer.name);
    database.execute_batch(&format!(
        "CREATE TABLE {table} (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom {type_name}{declared})"
    ))?;
    let vertices = || layer.features.iter().flat_map(|feature| feature.shape.vertices());
    let low = vertices().fold(DVec3::INFINITY, |low, at| low.min(*at));
    let high = vertices().fold(DVec3::NEG_INFINITY, |high, at| high.max(*at));
    database.execute(
        "INSERT INTO gpkg_contents VALUES (?1, 'features', ?1, '', ?2, ?3, ?4, ?5, ?6, ?7)",
        params![layer.name, MOMENT, low.x, low.y, high.x, high.y, srs_id],
    )?;
    database.execute(
        "INSERT INTO gpkg_geometry_columns VALUES (?1, 'geom', ?2, ?3, ?4, 0)",
        params![layer.name, type_name, srs_id, i32::from(has_z)],
    )?;
    let listed: String = columns.keys().map(|name| format!(", {}", quoted(name))).collect();
    let marks: String = (0..columns.len()).map(|index| format!(", ?{}", index + 2)).collect();
    let mut insert = database.prepare(&format!("INSERT INTO {table} (geom{listed}) VALUES (?1{marks})"))?;
    for feature in &layer.features {
        let values = columns.iter().map(|(name, kind)| sql_value(feature, name, kind));
        let geometry = SqlValue::Blob(geometry(&feature.shape, srs_id, has_z));
        insert.execute(params_from_iter(std::iter::once(geometry).chain(values)))?;
    }
    Ok(())
}

fn sql_value(feature: &ExportFeature, name: &str, kind: &str) -> SqlValue {
    match (feature.properties.get(name), kind) {
        (None | Some(Value::Null), _) => SqlValue::Null,
        (Some(Value::Number(number)), "INTEGER") => number.as_i64().map_or(SqlValue::Null, SqlValue::Integer),
        (Some(Value::Number(number)), "REAL") => number.as_f64().map_or(SqlValue::Null, SqlValue::Real),
        (Some(Value::Bool(value)), "INTEGER") => SqlValue::Integer(i64::from(*value)),
        (Some(Value::String(text)), _) => SqlValue::Text(text.clone()),
        (Some(other), _) => SqlValue::Text(other.to_string()),
    }
}

/// A geometry: the header of GeoPackage (clause 2.1.3.1.1) without an envelope, then WKB of ISO, little-endian.
fn geometry(shape: &ExportShape, srs_id: i32, has_z: bool) -> Vec<u8> {
    let mut bytes = vec![b'G', b'P', 0, 1];
    bytes.extend(srs_id.to_le_bytes());
    let mut wkb = Wkb { bytes, has_z };
    match shape {
        ExportShape::Point(at) => {
            wkb.start(1);
            wkb.position(at);
        }
        ExportShape::Line(line) => {
            wkb.start(2);
            wkb.positions(line.iter(), line.len());
        }
        ExportShape::Polygon(rings) => {
            wkb.start(3);
            wkb.count(rings.len());
            for ring in rings {
                wkb.positions(ring.iter().chain(ring.first()), ring.len() + usize::from(!ring.is_empty()));
            }
        }
    }
    wkb.bytes
}

struct Wkb {
    bytes: Vec<u8>,
    has_z: bool,
}

impl Wkb {
    fn start(&mut self, kind: u32) {
        self.bytes.push(1);
        self.bytes.extend((kind + if self.has_z { 1000 } else { 0 }).to_le_bytes());
    }

    fn count(&mut self, count: usize) {
        self.bytes.extend((count as u32).to_le_bytes());
    }

    fn positions<'a>(&mut self, positions: impl Iterator<Item = &'a DVec3>, count: usize) {
        self.count(count);
        positions.for_each(|at| self.position(at));
    }

    fn position(&mut self, at: &DVec3) {
        let coordinates = [at.x, at.y, at.z];
        let count = if self.has_z { 3 } else { 2 };
        coordinates[..count].iter().for_each(|number| self.bytes.extend(number.to_le_bytes()));
    }
}

/// A picture for each code of the layer, without texts, which labels say.
fn pictures(layer: &ExportLayer, symbols: &[SceneSymbol]) -> Vec<CodePicture> {
    let mut pictures: BTreeMap<String, CodePicture> = BTreeMap::new();
    for symbol in layer.features.iter().filter_map(|feature| symbols.get(feature.symbol?)) {
        let code = symbol.code.digits();
        pictures.entry(code.clone()).or_insert_with(|| {
            let bounds = symbol.symbol.bounds;
            let margin = sandtable_symbology::svg::MARGIN;
            let size = (bounds.max - bounds.min + 2.0 * margin) / 100.0;
            let anchor = (symbol.symbol.anchor - (bounds.min + bounds.max) * 0.5) / 100.0;
            CodePicture {
                code,
                svg: symbol.symbol.svg(100.0),
                size: size.to_array(),
                anchor: anchor.to_array(),
            }
        });
    }
    pictures.into_values().collect()
}

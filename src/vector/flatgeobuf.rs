//! FlatGeobuf 3: features as FlatBuffers one after another.
//!
//! ```text
//! 66 67 62 03 66 67 62 xx │ header │ index: 40 bytes a node, where there is one │ features
//!                           └── each: length:u32, a FlatBuffer of that many bytes ──┘
//! ```
//!
//! The layout of headers and features is the `flatgeobuf` crate's, and so is the verification of every buffer
//! before it is looked into. Its reader is not used: it allocates what a header promises. A verified buffer
//! may still point many times at the same numbers, so there may be no more vertices than the file has room for.

use flatgeobuf::{Column, ColumnType, Crs as HeaderCrs, Feature, Geometry, GeometryType, Header};
use glam::DVec3;
use serde_json::{Number, Value};

use crate::geom::crs::Crs;
use crate::vector::collect::{Collector, FeatureParts, Properties, position};
use crate::vector::cursor::ByteCursor;
use crate::vector::error::VectorError;
use crate::vector::feature::VectorLayer;

const FORMAT: &str = "FlatGeobuf file";
const NODE_BYTES: u64 = 40;

/// Whether `bytes` are FlatGeobuf, of any version.
pub(super) fn is_flatgeobuf(bytes: &[u8]) -> bool {
    bytes.starts_with(b"fgb\x03") || (bytes.starts_with(b"fgb") && bytes.get(4..7) == Some(b"fgb"))
}

/// All features of a FlatGeobuf file.
///
/// # Errors
/// [`VectorError`]: another version, buffers that are broken, shapes with curves, no system where none is `stated`.
pub(super) fn read(bytes: &[u8], stated: Option<&Crs>) -> Result<VectorLayer, VectorError> {
    let broken = |reason: &str| VectorError::broken(FORMAT, "its header", reason);
    if bytes.get(3) != Some(&3) {
        return Err(broken("it is not of version 3"));
    }
    let mut cursor = ByteCursor::new(&bytes[bytes.len().min(8)..]);
    let buffer = sized(&mut cursor).ok_or_else(|| broken("it is longer than the file"))?;
    let header =
        flatgeobuf::size_prefixed_root_as_header(buffer).map_err(|error| broken(&error.to_string()))?;
    let crs = match stated {
        Some(crs) => crs.clone(),
        None => system(header.crs())?,
    };
    let index =
        index_bytes(&header, bytes.len()).ok_or_else(|| broken("it promises more than the file holds"))?;
    cursor.take(index).ok_or_else(|| VectorError::broken(FORMAT, "its index", "the file ends within it"))?;
    let mut shapes = Shapes { of_layer: header.geometry_type(), vertices_left: bytes.len() / 16 };
    let mut collector = Collector::new(crs);
    let promised = header.features_count();
    while !cursor.rest().is_empty() && (promised == 0 || (collector.seen() as u64) < promised) {
        let broken =
            |seen: usize, reason: &str| VectorError::broken(FORMAT, format!("feature {}", seen + 1), reason);
        let seen = collector.seen();
        let buffer = sized(&mut cursor).ok_or_else(|| broken(seen, "it reaches past the end of the file"))?;
        let feature = flatgeobuf::size_prefixed_root_as_feature(buffer)
            .map_err(|error| broken(seen, &error.to_string().replace('\n', " ")))?;
        let mut parts = FeatureParts::default();
        if let Some(geometry) = feature.geometry() {
            shapes.add(&mut parts, &geometry, shapes.of_layer).map_err(|wrong| match wrong {
                Wrong::Curves(kind) => curves(kind),
                Wrong::Counts => broken(seen, "its rings or its elevations do not fit its vertices"),
            })?;
        }
        let properties = properties(&header, &feature);
        collector.add(parts, properties.ok_or_else(|| broken(seen, "its properties are broken"))?)?;
    }
    if (collector.seen() as u64) < promised {
        let reason = format!("there are {} features of {promised} promised", collector.seen());
        return Err(VectorError::broken(FORMAT, "its end", reason));
    }
    Ok(collector.finish())
}

/// The next buffer with its length before it.
fn sized<'a>(cursor: &mut ByteCursor<'a>) -> Option<&'a [u8]> {
    /// What the smallest buffer needs; less makes the verifier stumble.
    const LEAST: u32 = 8;
    let from_here = *cursor;
    let length = cursor.u32_le().filter(|&length| length >= LEAST)? as usize;
    cursor.take(length)?;
    from_here.rest().get(..4 + length)
}

/// The bytes that the index takes: a node for every feature and for every full or last group of nodes.
fn index_bytes(header: &Header<'_>, file: usize) -> Option<usize> {
    let (count, node_size) = (header.features_count(), u64::from(header.index_node_size()));
    if count == 0 || node_size == 0 {
        return Some(0);
    }
    if node_size < 2 || count > file as u64 / NODE_BYTES {
        return None;
    }
    let (mut nodes, mut level) = (count, count);
    while level > 1 {
        level = level.div_ceil(node_size);
        nodes += level;
    }
    // A single feature still has a root above it.
    if count == 1 {
        nodes += 1;
    }
    usize::try_from(nodes * NODE_BYTES).ok()
}

fn system(crs: Option<HeaderCrs<'_>>) -> Result<Crs, VectorError> {
    let unknown = VectorError::NoCrs { format: FORMAT, wanting: "names no coordinate system" };
    let Some(crs) = crs else { return Err(unknown) };
    let is_epsg = crs.org().is_none_or(|org| org.eq_ignore_ascii_case("epsg"));
    let by_code = u32::try_from(crs.code()).ok().filter(|&code| code > 0 && is_epsg).map(Crs::from_epsg);
    match (by_code, crs.wkt()) {
        (Some(Ok(crs)), _) => Ok(crs),
        (_, Some(wkt)) => Crs::parse(wkt).map_err(VectorError::Crs),
        (Some(Err(error)), None) => Err(VectorError::Crs(error)),
        (None, None) => Err(unknown),
    }
}

/// Why a shape was not taken.
enum Wrong {
    Curves(GeometryType),
    Counts,
}

fn curves(kind: GeometryType) -> VectorError {
    let kind = kind.variant_name().unwrap_or("unknown");
    VectorError::Unsupported {
        format: FORMAT,
        what: format!("shapes of the type {kind}"),
        remedy: "convert them, for example with: ogr2ogr -nlt CONVERT_TO_LINEAR".into(),
    }
}

struct Shapes {
    /// The type that shapes have that do not say their own.
    of_layer: GeometryType,
    vertices_left: usize,
}

impl Shapes {
    fn add(
        &mut self,
        parts: &mut FeatureParts,
        geometry: &Geometry<'_>,
        of_parent: GeometryType,
    ) -> Result<(), Wrong> {
        let kind = match geometry.type_() {
            GeometryType::Unknown => of_parent,
            kind => kind,
        };
        match kind {
            GeometryType::Point | GeometryType::MultiPoint => {
                self.vertices(geometry)?.into_iter().for_each(|at| parts.point(at));
            }
            GeometryType::LineString | GeometryType::MultiLineString => {
                self.lists(geometry)?.into_iter().for_each(|line| parts.line(line));
            }
            GeometryType::Polygon | GeometryType::Triangle => {
                let rings = self.lists(geometry)?;
                if !rings.is_empty() {
                    parts.polygon(rings);
                }
            }
            GeometryType::MultiPolygon => self.add_all(parts, geometry, GeometryType::Polygon)?,
            GeometryType::TIN => self.add_all(parts, geometry, GeometryType::Triangle)?,
            GeometryType::PolyhedralSurface => self.add_all(parts, geometry, GeometryType::Polygon)?,
            GeometryType::GeometryCollection => self.add_all(parts, geometry, GeometryType::Unknown)?,
            other => return Err(Wrong::Curves(other)),
        }
        Ok(())
    }

    fn add_all(
        &mut self,
        parts: &mut FeatureParts,
        geometry: &Geometry<'_>,
        kind: GeometryType,
    ) -> Result<(), Wrong> {
        for part in geometry.parts().iter().flatten() {
            self.vertices_left = self.vertices_left.checked_sub(1).ok_or(Wrong::Counts)?;
            self.add(parts, &part, kind)?;
        }
        Ok(())
    }

    fn vertices(&mut self, geometry: &Geometry<'_>) -> Result<Vec<DVec3>, Wrong> {
        let Some(numbers) = geometry.xy() else { return Ok(Vec::new()) };
        let count = numbers.len() / 2;
        self.vertices_left = self.vertices_left.checked_sub(count).ok_or(Wrong::Counts)?;
        let elevations = geometry.z().filter(|elevations| !elevations.is_empty());
        if elevations.is_some_and(|elevations| elevations.len() != count) {
            return Err(Wrong::Counts);
        }
        let elevation = |index| elevations.map(|elevations| elevations.get(index));
        let vertex = |index| position(numbers.get(2 * index), numbers.get(2 * index + 1), elevation(index));
        Ok((0..count).map(vertex).collect())
    }

    /// The vertices by line or ring; all are one where it does not say where each ends.
    fn lists(&mut self, geometry: &Geometry<'_>) -> Result<Vec<Vec<DVec3>>, Wrong> {
        let vertices = self.vertices(geometry)?;
        let Some(ends) = geometry.ends().filter(|ends| !ends.is_empty()) else {
            return Ok(if vertices.is_empty() { Vec::new() } else { vec![vertices] });
        };
        let mut start = 0;
        let mut list = |end: u32| {
            let list = vertices.get(start..end as usize).ok_or(Wrong::Counts)?.to_vec();
            start = end as usize;
            Ok(list)
        };
        ends.iter().map(&mut list).collect()
    }
}

/// A feature's properties: pairs of a column's index and a value; `None` where they are broken.
fn properties(header: &Header<'_>, feature: &Feature<'_>) -> Option<Properties> {
    let mut properties = Properties::new();
    let Some(bytes) = feature.properties() else { return Some(properties) };
    let columns = feature.columns().or_else(|| header.columns());
    let mut cursor = ByteCursor::new(bytes.bytes());
    while !cursor.rest().is_empty() {
        let index = usize::from(cursor.array().map(u16::from_le_bytes)?);
        let column = columns.filter(|columns| index < columns.len())?.get(index);
        let value = value(&mut cursor, &column)?;
        properties.insert(column.name().to_owned(), value);
    }
    Some(properties)
}

fn value(cursor: &mut ByteCursor<'_>, column: &Column<'_>) -> Option<Value> {
    let number = |number: f64| Number::from_f64(number).map_or(Value::Null, Value::Number);
    Some(match column.type_() {
        ColumnType::Byte => cursor.array().map(i8::from_le_bytes)?.into(),
        ColumnType::UByte => cursor.byte()?.into(),
        ColumnType::Bool => Value::Bool(cursor.byte()? != 0),
        ColumnType::Short => cursor.array().map(i16::from_le_bytes)?.into(),
        ColumnType::UShort => cursor.array().map(u16::from_le_bytes)?.into(),
        ColumnType::Int => cursor.array().map(i32::from_le_bytes)?.into(),
        ColumnType::UInt => cursor.u32_le()?.into(),
        ColumnType::Long => cursor.array().map(i64::from_le_bytes)?.into(),
        ColumnType::ULong => cursor.array().map(u64::from_le_bytes)?.into(),
        ColumnType::Float => number(f64::from(cursor.array().map(f32::from_le_bytes)?)),
        ColumnType::Double => number(cursor.f64_le()?),
        kind => {
            let length = cursor.u32_le()? as usize;
            let bytes = cursor.take(length)?;
            match kind {
                ColumnType::Binary => Value::Null,
                ColumnType::Json => serde_json::from_slice(bytes).ok()?,
                _ => std::str::from_utf8(bytes).ok()?.into(),
            }
        }
    })
}

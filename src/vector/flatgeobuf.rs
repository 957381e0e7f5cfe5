//! FlatGeobuf 3: features as FlatBuffers one after another.
//!
//! ```text
//! 66 67 62 03 66 67 62 xx │ header │ index: 40 bytes a node, where there is one │ features
//!                           └── each: length:u32, a FlatBuffer of that many bytes ──┘
//! ```
//!
//! The `flatgeobuf` crate defines headers and features and verifies every buffer before it is read. Its file reader is
//! not used: it allocates what a header promises, and drops Z where shapes become those of `geo`. A verified buffer may
//! still refer to the same numbers many times, so the vertices are counted against the size of the file.

use flatgeobuf::{Column, ColumnType, Feature, Geometry, GeometryType, Header};
use serde_json::{Number, Value};

use crate::builder::{FeatureParts, LayerBuilder, Vertices, position};
use crate::error::VectorError;
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use sandtable_base::bytes::ByteCursor;
use sandtable_geom::crs::Crs;

const FORMAT: &str = "FlatGeobuf file";
/// Bytes of a node of the index.
const NODE_BYTES: u64 = 40;

pub(super) fn is_flatgeobuf(bytes: &[u8]) -> bool {
    bytes.starts_with(b"fgb\x03") || (bytes.starts_with(b"fgb") && bytes.get(4..7) == Some(b"fgb"))
}

/// Reads all features; those that are broken or have curves are left out and reported.
///
/// # Errors
/// [`VectorError`]: another version, a file cut short, features of which none is sound, no coordinate system.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let broken_header = |reason: &'static str| VectorError::broken(FORMAT, "its header", reason);
    if bytes.get(3) != Some(&3) {
        return Err(broken_header("it is not of version 3"));
    }
    let mut cursor = ByteCursor::new(bytes.get(8..).unwrap_or_default());
    let buffer = next_buffer(&mut cursor).ok_or_else(|| broken_header("it is longer than the file"))?;
    let header = flatgeobuf::size_prefixed_root_as_header(buffer)
        .map_err(|error| VectorError::broken(FORMAT, "its header", error))?;
    let mut layer = LayerBuilder::new(crs_of(&header, hints)?);
    let index = index_bytes(&header, bytes.len());
    let index = index.ok_or_else(|| broken_header("it promises more than the file holds"))?;
    cursor.take(index).ok_or_else(|| VectorError::broken(FORMAT, "its index", "the file ends within it"))?;
    let mut reader = FgbReader { header, vertices_left: bytes.len() / 16 };
    let promised = usize::try_from(header.features_count()).unwrap_or(usize::MAX);
    while !cursor.is_empty() && (promised == 0 || layer.feature_count() < promised) {
        reader.read_feature(&mut cursor, &mut layer)?;
    }
    if layer.feature_count() < promised {
        let reason = format!("it has {} features of {promised} promised", layer.feature_count());
        return Err(VectorError::broken(FORMAT, "its end", reason));
    }
    layer.finish()
}

/// Reads a buffer with its length before it.
fn next_buffer<'a>(cursor: &mut ByteCursor<'a>) -> Option<&'a [u8]> {
    /// Bytes of the smallest buffer; on less the verifier panics.
    const MIN_BYTES: usize = 8;
    let start = cursor.rest();
    let length = cursor.u32_le()? as usize;
    cursor.take(length).filter(|_| length >= MIN_BYTES)?;
    start.get(..4 + length)
}

/// Returns the bytes of the index: a node for every feature, and for every group of nodes up to the root.
fn index_bytes(header: &Header<'_>, file_bytes: usize) -> Option<usize> {
    let (count, node_size) = (header.features_count(), u64::from(header.index_node_size()));
    if count == 0 || node_size == 0 {
        return Some(0);
    }
    if node_size < 2 || count > file_bytes as u64 / NODE_BYTES {
        return None;
    }
    let (mut nodes, mut level) = (count, count);
    while level > 1 {
        level = level.div_ceil(node_size);
        nodes += level;
    }
    // A single feature still has a root above it.
    let nodes = if count == 1 { 2 } else { nodes };
    usize::try_from(nodes * NODE_BYTES).ok()
}

fn crs_of(header: &Header<'_>, hints: &VectorHints) -> Result<Crs, VectorError> {
    let crs = header.crs();
    let code = crs.filter(|crs| crs.org().is_none_or(|name| name.eq_ignore_ascii_case("epsg")));
    let code = code.and_then(|crs| u32::try_from(crs.code()).ok()).filter(|&code| code > 0);
    let crs = hints.crs_or(code, crs.and_then(|crs| crs.wkt()))?;
    crs.ok_or(VectorError::NoCrs { format: FORMAT, reason: "names no coordinate system" })
}

/// Why a shape cannot be read.
enum FgbShapeError {
    Curves(GeometryType),
    Counts,
}

struct FgbReader<'a> {
    header: Header<'a>,
    vertices_left: usize,
}

impl FgbReader<'_> {
    /// Reads the next feature into `layer`.
    ///
    /// # Errors
    /// It reaches past the end of the file.
    fn read_feature(
        &mut self,
        cursor: &mut ByteCursor<'_>,
        layer: &mut LayerBuilder,
    ) -> Result<(), VectorError> {
        let place = format!("feature {}", layer.feature_count() + 1);
        let buffer = next_buffer(cursor).ok_or_else(|| {
            VectorError::broken(FORMAT, &place, "it is too short, or reaches past the end of the file")
        })?;
        match self.feature(buffer, &place) {
            Ok((parts, properties)) => layer.add(parts, properties),
            Err(error) => layer.add_broken(place, error),
        }
        Ok(())
    }

    /// Reads the feature in a buffer that has its length before it.
    fn feature(&mut self, buffer: &[u8], place: &str) -> Result<(FeatureParts, Properties), VectorError> {
        let broken = |reason: &'static str| VectorError::broken(FORMAT, place, reason);
        let feature = flatgeobuf::size_prefixed_root_as_feature(buffer)
            .map_err(|error| VectorError::broken(FORMAT, place, error))?;
        let mut parts = FeatureParts::default();
        if let Some(geometry) = feature.geometry() {
            // Shapes that do not state their type have that of the layer.
            self.add_shape(&mut parts, &geometry, self.header.geometry_type()).map_err(
                |error| match error {
                    FgbShapeError::Curves(kind) => {
                        VectorError::curves(FORMAT, kind.variant_name().unwrap_or("unknown"))
                    }
                    FgbShapeError::Counts => broken("its rings or its elevations do not fit its vertices"),
                },
            )?;
        }
        let properties = properties(&self.header, &feature);
        Ok((parts, properties.ok_or_else(|| broken("its properties are broken"))?))
    }

    fn add_shape(
        &mut self,
        parts: &mut FeatureParts,
        geometry: &Geometry<'_>,
        default_kind: GeometryType,
    ) -> Result<(), FgbShapeError> {
        let kind = match geometry.type_() {
            GeometryType::Unknown => default_kind,
            kind => kind,
        };
        let kind_of_parts = match kind {
            GeometryType::Point | GeometryType::MultiPoint => {
                parts.add_points(self.vertices(geometry)?);
                return Ok(());
            }
            GeometryType::LineString | GeometryType::MultiLineString => {
                self.lines(geometry)?.into_iter().for_each(|line| parts.add_line(line));
                return Ok(());
            }
            GeometryType::Polygon | GeometryType::Triangle => {
                let rings = self.lines(geometry)?;
                if !rings.is_empty() {
                    parts.add_polygon(rings);
                }
                return Ok(());
            }
            GeometryType::MultiPolygon | GeometryType::PolyhedralSurface => GeometryType::Polygon,
            GeometryType::TIN => GeometryType::Triangle,
            GeometryType::GeometryCollection => GeometryType::Unknown,
            other => return Err(FgbShapeError::Curves(other)),
        };
        for part in geometry.parts().iter().flatten() {
            self.vertices_left = self.vertices_left.checked_sub(1).ok_or(FgbShapeError::Counts)?;
            self.add_shape(parts, &part, kind_of_parts)?;
        }
        Ok(())
    }

    fn vertices(&mut self, geometry: &Geometry<'_>) -> Result<Vertices, FgbShapeError> {
        let Some(numbers) = geometry.xy() else { return Ok(Vertices::new()) };
        let count = numbers.len() / 2;
        self.vertices_left = self.vertices_left.checked_sub(count).ok_or(FgbShapeError::Counts)?;
        let elevations = geometry.z().filter(|elevations| !elevations.is_empty());
        if elevations.is_some_and(|elevations| elevations.len() != count) {
            return Err(FgbShapeError::Counts);
        }
        let elevation = |index| elevations.map(|elevations| elevations.get(index));
        let vertex = |index| position(numbers.get(2 * index), numbers.get(2 * index + 1), elevation(index));
        Ok((0..count).map(vertex).collect())
    }

    /// Returns the vertices by line or ring; without `ends` they are one.
    fn lines(&mut self, geometry: &Geometry<'_>) -> Result<Vec<Vertices>, FgbShapeError> {
        let vertices = self.vertices(geometry)?;
        let Some(ends) = geometry.ends().filter(|ends| !ends.is_empty()) else {
            return Ok(if vertices.is_empty() { Vec::new() } else { vec![vertices] });
        };
        let mut start = 0;
        let line = |end: u32| {
            let line = vertices.get(start..end as usize).ok_or(FgbShapeError::Counts)?.to_vec();
            start = end as usize;
            Ok(line)
        };
        ends.iter().map(line).collect()
    }
}

/// Reads a feature's properties, pairs of a column's index and a value; `None` where they are broken.
fn properties(header: &Header<'_>, feature: &Feature<'_>) -> Option<Properties> {
    let mut properties = Properties::new();
    let Some(bytes) = feature.properties() else { return Some(properties) };
    let columns = feature.columns().or_else(|| header.columns());
    let mut cursor = ByteCursor::new(bytes.bytes());
    while !cursor.is_empty() {
        let index = usize::from(cursor.array().map(u16::from_le_bytes)?);
        let column = columns.filter(|columns| index < columns.len())?.get(index);
        properties.insert(column.name().to_owned(), value(&mut cursor, &column)?);
    }
    Some(properties)
}

fn value(cursor: &mut ByteCursor<'_>, column: &Column<'_>) -> Option<Value> {
    let number = |number: f64| Number::from_f64(number).map_or(Value::Null, Value::Number);
    Some(match column.type_() {
        ColumnType::Byte => cursor.array().map(i8::from_le_bytes)?.into(),
        ColumnType::UByte => cursor.u8()?.into(),
        ColumnType::Bool => Value::Bool(cursor.u8()? != 0),
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
                ColumnType::Json => serde_json::from_slice(bytes).unwrap_or(Value::Null),
                _ => String::from_utf8_lossy(bytes).into(),
            }
        }
    })
}

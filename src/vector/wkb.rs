//! Well-known binary, the shapes of GeoPackages and of tables in memory (ISO 13249-3:2016 with Z and M, and the flags of PostGIS's EWKB).
//!
//! ```text
//! byte order:u8  type:u32  [count:u32]  then
//! point: x y [z] [m] │ line: positions │ polygon: rings, each count:u32 and positions │ collection: shapes
//! ```
//!
//! Counts are compared with the bytes that are left before anything is allocated. Measures (m) are not kept.
//!
//! Written by hand. `wkb` 0.9 keeps three bits of the type: a triangle becomes a point and a curve polygon a line.
//! `geozero` 0.15 overflows the stack on nested collections and reads either ISO's types or EWKB's flags. They build
//! seven and four more crates to save some 60 lines.

use crate::builder::{FeatureParts, Vertices, position};
use sandtable_base::bytes::{ByteCursor, ByteOrder};
use sandtable_base::limits::GEOMETRY_DEPTH;

/// EWKB's flags in the type.
const HAS_Z: u32 = 0x8000_0000;
const HAS_M: u32 = 0x4000_0000;
const HAS_SRID: u32 = 0x2000_0000;

/// Why a shape cannot be read.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum WkbError {
    /// It ends too early or contradicts itself.
    #[error("a shape is cut short or forged")]
    Broken,
    /// It is a collection of collections.
    #[error("a shape holds collections more than {GEOMETRY_DEPTH} deep; {GEOMETRY_DEPTH:#}")]
    TooDeep,
    /// Its type, named here, is not read.
    #[error("a shape is of the type {0}")]
    Unsupported(&'static str),
}

/// The byte order and the dimensions of a position.
#[derive(Clone, Copy)]
struct WkbLayout {
    order: ByteOrder,
    has_z: bool,
    /// Bytes of a position.
    stride: usize,
}

/// Adds the shape that `bytes` start with to `parts`.
pub(crate) fn read(bytes: &[u8], parts: &mut FeatureParts) -> Result<(), WkbError> {
    read_shape(&mut ByteCursor::new(bytes), parts, 0)
}

fn read_shape(cursor: &mut ByteCursor<'_>, parts: &mut FeatureParts, depth: usize) -> Result<(), WkbError> {
    /// Least bytes of a ring, its count, and of a shape, its byte order and type.
    const MIN_RING_BYTES: usize = 4;
    const MIN_SHAPE_BYTES: usize = 5;
    if depth > GEOMETRY_DEPTH.count() {
        return Err(WkbError::TooDeep);
    }
    let (kind, layout) = read_header(cursor)?;
    match kind {
        // An empty point is written as NaN.
        1 => {
            let mut points = read_positions(cursor, layout, 1)?;
            points.retain(|position| !position.x.is_nan());
            parts.add_points(points);
        }
        2 => {
            let line = read_line(cursor, layout)?;
            if !line.is_empty() {
                parts.add_line(line);
            }
        }
        3 | 17 => {
            let count = read_count(cursor, layout, MIN_RING_BYTES)?;
            let rings = (0..count).map(|_| read_line(cursor, layout)).collect::<Result<Vec<_>, _>>()?;
            if !rings.is_empty() {
                parts.add_polygon(rings);
            }
        }
        4..=7 | 15 | 16 => {
            for _ in 0..read_count(cursor, layout, MIN_SHAPE_BYTES)? {
                read_shape(cursor, parts, depth + 1)?;
            }
        }
        8 => return Err(WkbError::Unsupported("CircularString")),
        9 => return Err(WkbError::Unsupported("CompoundCurve")),
        10 => return Err(WkbError::Unsupported("CurvePolygon")),
        11 => return Err(WkbError::Unsupported("MultiCurve")),
        12 => return Err(WkbError::Unsupported("MultiSurface")),
        _ => return Err(WkbError::Broken),
    }
    Ok(())
}

/// Reads the type of a shape, without its dimensions, and its layout.
fn read_header(cursor: &mut ByteCursor<'_>) -> Result<(u32, WkbLayout), WkbError> {
    let order = match cursor.u8() {
        Some(0) => ByteOrder::Big,
        Some(1) => ByteOrder::Little,
        _ => return Err(WkbError::Broken),
    };
    let mut layout = WkbLayout { order, has_z: false, stride: 16 };
    let stated = read_u32(cursor, layout)?;
    if stated & HAS_SRID != 0 {
        read_u32(cursor, layout)?;
    }
    let code = stated & !(HAS_Z | HAS_M | HAS_SRID);
    if code >= 4000 {
        return Err(WkbError::Broken);
    }
    let has_m = stated & HAS_M != 0 || matches!(code / 1000, 2 | 3);
    layout.has_z = stated & HAS_Z != 0 || matches!(code / 1000, 1 | 3);
    layout.stride += 8 * (usize::from(layout.has_z) + usize::from(has_m));
    Ok((code % 1000, layout))
}

fn read_u32(cursor: &mut ByteCursor<'_>, layout: WkbLayout) -> Result<u32, WkbError> {
    cursor.array().map(|bytes| layout.order.u32(bytes)).ok_or(WkbError::Broken)
}

/// Reads a count of items that take at least `min_bytes` each.
fn read_count(cursor: &mut ByteCursor<'_>, layout: WkbLayout, min_bytes: usize) -> Result<usize, WkbError> {
    let count = read_u32(cursor, layout)? as usize;
    let fits = count.checked_mul(min_bytes).is_some_and(|bytes| bytes <= cursor.rest().len());
    if fits { Ok(count) } else { Err(WkbError::Broken) }
}

fn read_line(cursor: &mut ByteCursor<'_>, layout: WkbLayout) -> Result<Vertices, WkbError> {
    let count = read_count(cursor, layout, layout.stride)?;
    read_positions(cursor, layout, count)
}

fn read_positions(
    cursor: &mut ByteCursor<'_>,
    layout: WkbLayout,
    count: usize,
) -> Result<Vertices, WkbError> {
    let bytes = cursor.take(count * layout.stride).ok_or(WkbError::Broken)?;
    let number = |bytes: [u8; 8]| layout.order.f64(bytes);
    let vertex = |bytes: &[u8]| {
        let (numbers, _) = bytes.as_chunks::<8>();
        position(number(numbers[0]), number(numbers[1]), layout.has_z.then(|| number(numbers[2])))
    };
    Ok(bytes.chunks_exact(layout.stride).map(vertex).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::LayerBuilder;
    use crate::feature::{Feature, Geometry, Properties};
    use glam::DVec2;
    use sandtable_geom::crs::Crs;

    fn features(bytes: &[u8]) -> Result<Vec<Feature>, WkbError> {
        let mut parts = FeatureParts::default();
        read(bytes, &mut parts)?;
        let mut builder = LayerBuilder::new(Crs::local());
        builder.add(parts, Properties::new());
        Ok(builder.finish().expect("meters").features)
    }

    fn line(kind: u32, numbers: &[f64], count: u32) -> Vec<u8> {
        let mut bytes = vec![1];
        bytes.extend([kind.to_le_bytes(), count.to_le_bytes()].concat());
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    #[test]
    fn z_and_m_are_stated_by_thousands_or_by_flags() {
        let flat = Geometry::Lines(vec![vec![DVec2::new(1.0, 2.0), DVec2::new(3.0, 4.0)]]);
        let wide = [1.0, 2.0, 8.0, 3.0, 4.0, 9.0];
        for (kind, elevations) in
            [(1002, Some(vec![8.0, 9.0])), (HAS_Z | 2, Some(vec![8.0, 9.0])), (2002, None), (HAS_M | 2, None)]
        {
            let read = features(&line(kind, &wide, 2)).expect("sound");
            assert_eq!((&read[0].geometry, &read[0].elevations), (&flat, &elevations), "{kind:x}");
        }
        let deep = [1.0, 2.0, 8.0, 0.0, 3.0, 4.0, 9.0, 0.0];
        assert_eq!(features(&line(3002, &deep, 2)).expect("sound")[0].elevations, Some(vec![8.0, 9.0]));
    }

    #[test]
    fn big_endian_points_and_collections_are_read() {
        let mut point = vec![0, 0, 0, 0, 1];
        point.extend([7f64, 8.0].iter().flat_map(|number| number.to_be_bytes()));
        let mut collection = vec![0, 0, 0, 0, 7, 0, 0, 0, 2];
        collection.extend(&point);
        collection.extend(line(2, &[1.0, 2.0, 3.0, 4.0], 2));
        let read = features(&collection).expect("sound");
        assert_eq!(read.len(), 2);
        assert_eq!(read[0].points(), [DVec2::new(7.0, 8.0)]);
    }

    #[test]
    fn forged_counts_and_depths_are_refused() {
        for count in [3, u32::MAX] {
            assert_eq!(features(&line(2, &[1.0, 2.0, 3.0, 4.0], count)), Err(WkbError::Broken));
        }
        let nested = [1u8, 7, 0, 0, 0, 1, 0, 0, 0].repeat(100_000);
        assert_eq!(features(&nested), Err(WkbError::TooDeep));
        assert_eq!(features(&line(10, &[], 0)), Err(WkbError::Unsupported("CurvePolygon")));
    }

    #[test]
    fn a_shape_cut_anywhere_is_refused() {
        let shape = line(1002, &[1.0, 2.0, 8.0, 3.0, 4.0, 9.0], 2);
        for end in 0..shape.len() {
            assert_eq!(features(&shape[..end]), Err(WkbError::Broken), "{end}");
        }
    }
}

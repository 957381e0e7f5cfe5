//! Well-known binary: the shapes in a GeoPackage (ISO 13249-3:2016 with Z and M, and the flags of PostGIS's EWKB).
//!
//! ```text
//! byte order:u8  type:u32  [count:u32]  then
//! point: x y [z] [m] │ line: positions │ polygon: rings, each count:u32 and positions │ collection: shapes
//! ```
//!
//! Every count is held against the bytes that are left before anything is allocated for it, and collections lie
//! at most [`MOST_DEPTH`] deep. Measures (m) are not kept.

use glam::DVec3;

use crate::vector::collect::{FeatureParts, position};
use crate::vector::cursor::ByteCursor;

/// A multipolygon in a collection is three deep; more than a handful is nobody's data.
const MOST_DEPTH: usize = 16;
/// EWKB's flags in the type.
const HAS_Z: u32 = 0x8000_0000;
const HAS_M: u32 = 0x4000_0000;
const HAS_SRID: u32 = 0x2000_0000;

/// Why a shape cannot be read.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum WkbError {
    /// It ends too early, or contradicts itself.
    Broken,
    /// A type that is not read, by its name.
    Unsupported(&'static str),
}

/// The order of bytes and what a position holds.
#[derive(Clone, Copy)]
struct WkbLayout {
    little_endian: bool,
    has_z: bool,
    has_m: bool,
}

impl WkbLayout {
    fn position_bytes(self) -> usize {
        8 * (2 + usize::from(self.has_z) + usize::from(self.has_m))
    }
}

/// Adds the shape that `bytes` are to `parts`; what follows it is not looked at.
///
/// # Errors
/// [`WkbError`].
pub(crate) fn read(bytes: &[u8], parts: &mut FeatureParts) -> Result<(), WkbError> {
    shape(&mut ByteCursor::new(bytes), parts, 0)
}

fn shape(cursor: &mut ByteCursor<'_>, parts: &mut FeatureParts, depth: usize) -> Result<(), WkbError> {
    if depth > MOST_DEPTH {
        return Err(WkbError::Broken);
    }
    let little_endian = match cursor.byte() {
        Some(0) => false,
        Some(1) => true,
        _ => return Err(WkbError::Broken),
    };
    let mut layout = WkbLayout { little_endian, has_z: false, has_m: false };
    let stated = number(cursor, layout)?;
    if stated & HAS_SRID != 0 {
        number(cursor, layout)?;
    }
    let code = stated & !(HAS_Z | HAS_M | HAS_SRID);
    layout.has_z = stated & HAS_Z != 0 || matches!(code / 1000, 1 | 3);
    layout.has_m = stated & HAS_M != 0 || matches!(code / 1000, 2 | 3);
    if code >= 4000 {
        return Err(WkbError::Broken);
    }
    match code % 1000 {
        1 => {
            let at = positions(cursor, layout, 1)?;
            // An empty point is written as one of NaN.
            at.into_iter().filter(|at| !at.x.is_nan()).for_each(|at| parts.point(at));
        }
        2 => {
            let line = counted_positions(cursor, layout)?;
            if !line.is_empty() {
                parts.line(line);
            }
        }
        3 | 17 => {
            // A ring is at least its count.
            let count = count(cursor, layout, 4)?;
            let rings =
                (0..count).map(|_| counted_positions(cursor, layout)).collect::<Result<Vec<_>, _>>()?;
            if !rings.is_empty() {
                parts.polygon(rings);
            }
        }
        4..=7 | 15 | 16 => {
            // A shape is at least its byte order and its type.
            for _ in 0..count(cursor, layout, 5)? {
                shape(cursor, parts, depth + 1)?;
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

fn number(cursor: &mut ByteCursor<'_>, layout: WkbLayout) -> Result<u32, WkbError> {
    let bytes = cursor.array().ok_or(WkbError::Broken)?;
    Ok(if layout.little_endian { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
}

/// A count of things that take at least `least_bytes` each.
fn count(cursor: &mut ByteCursor<'_>, layout: WkbLayout, least_bytes: usize) -> Result<usize, WkbError> {
    let count = number(cursor, layout)? as usize;
    let fits = count.checked_mul(least_bytes).is_some_and(|bytes| bytes <= cursor.rest().len());
    if fits { Ok(count) } else { Err(WkbError::Broken) }
}

fn counted_positions(cursor: &mut ByteCursor<'_>, layout: WkbLayout) -> Result<Vec<DVec3>, WkbError> {
    let count = count(cursor, layout, layout.position_bytes())?;
    positions(cursor, layout, count)
}

fn positions(cursor: &mut ByteCursor<'_>, layout: WkbLayout, count: usize) -> Result<Vec<DVec3>, WkbError> {
    let size = layout.position_bytes();
    let bytes = cursor.take(count * size).ok_or(WkbError::Broken)?;
    let number = |bytes: [u8; 8]| {
        if layout.little_endian { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) }
    };
    let one = |bytes: &[u8]| {
        let (numbers, _) = bytes.as_chunks::<8>();
        position(number(numbers[0]), number(numbers[1]), layout.has_z.then(|| number(numbers[2])))
    };
    Ok(bytes.chunks_exact(size).map(one).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::crs::Crs;
    use crate::vector::collect::{Collector, Properties};
    use crate::vector::feature::{Feature, Geometry};
    use glam::DVec2;

    fn features(bytes: &[u8]) -> Result<Vec<Feature>, WkbError> {
        let mut parts = FeatureParts::default();
        read(bytes, &mut parts)?;
        let mut collector = Collector::new(Crs::local());
        collector.add(parts, Properties::new()).expect("meters");
        Ok(collector.finish().features)
    }

    fn line(kind: u32, numbers: &[f64], count: u32) -> Vec<u8> {
        let mut bytes = vec![1];
        bytes.extend([kind.to_le_bytes(), count.to_le_bytes()].concat());
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    #[test]
    fn z_and_m_are_told_by_thousands_and_by_flags() {
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
        assert_eq!(features(&nested), Err(WkbError::Broken));
        assert_eq!(features(&line(10, &[], 0)), Err(WkbError::Unsupported("CurvePolygon")));
    }

    #[test]
    fn a_shape_cut_anywhere_is_refused() {
        let whole = line(1002, &[1.0, 2.0, 8.0, 3.0, 4.0, 9.0], 2);
        for end in 0..whole.len() {
            assert_eq!(features(&whole[..end]), Err(WkbError::Broken), "{end}");
        }
    }
}

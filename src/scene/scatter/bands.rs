//! A polygon in bands: for each row of squares the edges that reach into it, so that whether a place lies inside takes
//! a look at a few edges and not at all of them.

use std::ops::RangeInclusive;

use glam::DVec2;

use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;

/// The rings of a polygon, cut into rows of squares.
pub struct Bands {
    side_m: f64,
    first_row: i64,
    columns: RangeInclusive<i64>,
    rows: Vec<Vec<(DVec2, DVec2)>>,
}

impl Bands {
    /// A polygon in rows of squares of `side_m`, as far as it lies within `extent`; both in map coordinates. `None` where
    /// it would take more than `most` rows or pieces of edges.
    pub fn new<'a>(
        rings: impl Iterator<Item = &'a [DVec2]> + Clone,
        side_m: f64,
        extent: &Rect,
        most: usize,
    ) -> Option<Self> {
        let square = |at: f64| (at / side_m).floor() as i64;
        let reach = Rect::around(rings.clone().flatten().copied());
        let (low, high) = (reach.min.max(extent.min), reach.max.min(extent.max));
        let columns = square(low.x)..=square(high.x);
        let (first_row, last_row) = (square(low.y), square(high.y));
        if !low.cmple(high).all() {
            return Some(Self { side_m, first_row: 0, columns: 0..=0, rows: Vec::new() });
        }
        let count = usize::try_from(last_row.saturating_sub(first_row)).ok()?.checked_add(1)?;
        if count > most {
            return None;
        }
        let mut rows: Vec<Vec<(DVec2, DVec2)>> = vec![Vec::new(); count];
        let mut pieces = 0;
        for (from, to) in rings.flat_map(polygon::edges) {
            let (low, high) =
                (square(from.y.min(to.y)).max(first_row), square(from.y.max(to.y)).min(last_row));
            pieces += usize::try_from(high - low + 1).unwrap_or(0);
            if pieces > most {
                return None;
            }
            (low..=high).for_each(|row| rows[(row - first_row) as usize].push((from, to)));
        }
        Some(Self { side_m, first_row, columns, rows })
    }

    /// Its rows.
    pub fn rows(&self) -> std::ops::Range<i64> {
        self.first_row..self.first_row + self.rows.len() as i64
    }

    /// The columns of the squares of a row between which all of it lies; empty where nothing of it does.
    pub fn columns(&self, row: i64) -> RangeInclusive<i64> {
        let (low, high) = (row as f64 * self.side_m, (row + 1) as f64 * self.side_m);
        let ends = self.edges(row).iter().flat_map(|&(from, to)| {
            [low, high].map(|y| {
                let part = if from.y == to.y { f64::NAN } else { (y - from.y) / (to.y - from.y) };
                if part.is_nan() { [from.x, to.x] } else { [from.lerp(to, part.clamp(0.0, 1.0)).x; 2] }
            })
        });
        let (west, east) = ends
            .flatten()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(west, east), x| (west.min(x), east.max(x)));
        if west > east {
            return RangeInclusive::new(1, 0);
        }
        let square = |at: f64| (at / self.side_m).floor() as i64;
        square(west).max(*self.columns.start())..=square(east).min(*self.columns.end())
    }

    /// Whether a place in a row lies inside, by the even-odd rule over all rings.
    pub fn contains(&self, row: i64, at: DVec2) -> bool {
        polygon::is_within(self.edges(row).iter().copied(), at)
    }

    fn edges(&self, row: i64) -> &[(DVec2, DVec2)] {
        let index = usize::try_from(row - self.first_row).ok();
        index.and_then(|index| self.rows.get(index)).map_or(&[], Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_place_is_inside_where_the_polygon_says_so_and_within_the_columns_of_its_row(
            outer in prop::collection::vec((0.0..100.0, 0.0..100.0), 3..12),
            hole in prop::collection::vec((30.0..60.0, 30.0..60.0), 3..6),
            places in prop::collection::vec((0.0..100.0, 0.0..100.0), 1..40),
        ) {
            let ring = |points: &[(f64, f64)]| points.iter().map(|&at| DVec2::from(at)).collect::<Vec<_>>();
            let rings = [ring(&outer), ring(&hole)];
            let extent = Rect { min: DVec2::ZERO, max: DVec2::splat(100.0) };
            let bands = Bands::new(rings.iter().map(Vec::as_slice), 7.0, &extent, 1000).expect("few");
            for at in ring(&places) {
                let inside = polygon::contains(rings.iter().map(Vec::as_slice), at);
                let row = (at.y / 7.0).floor() as i64;
                prop_assert_eq!(bands.contains(row, at), inside);
                prop_assert!(!inside || bands.columns(row).contains(&((at.x / 7.0).floor() as i64)));
            }
        }
    }

    #[test]
    fn beside_the_extent_there_is_nothing_and_too_much_is_refused() {
        let ring = [DVec2::ZERO, DVec2::new(1e9, 0.0), DVec2::new(1e9, 1e9)];
        let extent = Rect { min: DVec2::splat(2e9), max: DVec2::splat(3e9) };
        let nothing = Bands::new(std::iter::once(&ring[..]), 1.0, &extent, 1000).expect("nothing");
        assert!(nothing.rows().is_empty());
        let all = Rect { min: DVec2::ZERO, max: DVec2::splat(1e9) };
        assert!(Bands::new(std::iter::once(&ring[..]), 1.0, &all, 1000).is_none());
    }
}

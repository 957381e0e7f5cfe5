//! Rings of positions: areas of parameters.

use glam::DVec2;

use sandtable_geom::polygon::crossings;

/// Which part of a row of posts lies in the area of a parameter; all of it where none is stated.
pub(crate) struct AreaRow(Option<Vec<f64>>);

impl AreaRow {
    /// The row of positions at `y`, in map coordinates.
    pub(crate) fn new(area: &[DVec2], y: f64) -> Self {
        Self((!area.is_empty()).then(|| crossings([area], y)))
    }

    /// Whether the position at `x` lies in the area.
    pub(crate) fn holds(&self, x: f64) -> bool {
        let Self(crossings) = self;
        crossings.as_ref().is_none_or(|all| all.partition_point(|&crossing| crossing <= x) % 2 == 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_geom::polygon::contains;

    #[test]
    fn rows_of_an_area_hold_the_positions_that_lie_in_it() {
        // A bow tie over corners that lie on rows and columns of positions.
        let ring =
            [(0.0, 0.0), (8.0, 6.0), (8.0, 0.0), (3.0, 3.5), (0.0, 6.0)].map(|(x, y)| DVec2::new(x, y));
        for row in -1..15 {
            let y = f64::from(row) * 0.5;
            let of_row = AreaRow::new(&ring, y);
            for column in -2..20 {
                let x = f64::from(column) * 0.5;
                assert_eq!(of_row.holds(x), contains([&ring[..]], DVec2::new(x, y)), "{x} {y}");
                assert!(AreaRow::new(&[], y).holds(x));
            }
        }
    }
}

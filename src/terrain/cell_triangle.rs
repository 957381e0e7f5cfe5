//! The finest triangles of the ground: two in each cell, on both sides of its diagonal.
//!
//! Positions in a cell run 0..=1 east and north from its south-west corner; corners are in the order south-west,
//! south-east, north-west, north-east.

use glam::DVec2;

use crate::lattice::Post;

/// The corners of a cell that its diagonal joins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonal {
    /// South-west to north-east.
    Rising,
    /// North-west to south-east.
    Falling,
}

impl Diagonal {
    /// The diagonal of the cell north-east of a post: it joins the corners whose coordinates are both even or both odd.
    pub fn of_cell(cell: Post) -> Self {
        if cell.column % 2 == cell.row % 2 { Self::Rising } else { Self::Falling }
    }
}

/// One of the two triangles of a cell, named after the corner with its right angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellTriangle {
    /// South-east of a rising diagonal.
    SouthEast,
    /// North-west of a rising diagonal.
    NorthWest,
    /// South-west of a falling diagonal.
    SouthWest,
    /// North-east of a falling diagonal.
    NorthEast,
}

impl CellTriangle {
    /// The triangles of a cell.
    pub fn of_cell(cell: Post) -> [Self; 2] {
        match Diagonal::of_cell(cell) {
            Diagonal::Rising => [Self::SouthEast, Self::NorthWest],
            Diagonal::Falling => [Self::SouthWest, Self::NorthEast],
        }
    }

    /// The triangle of a cell that holds a position in it; on the diagonal the southern one.
    pub fn holding(diagonal: Diagonal, DVec2 { x, y }: DVec2) -> Self {
        match diagonal {
            Diagonal::Rising if x >= y => Self::SouthEast,
            Diagonal::Rising => Self::NorthWest,
            Diagonal::Falling if x + y <= 1.0 => Self::SouthWest,
            Diagonal::Falling => Self::NorthEast,
        }
    }

    /// Which of the cell's corners are its own, counter-clockwise.
    pub fn corner_indices(self) -> [usize; 3] {
        match self {
            Self::SouthEast => [0, 1, 3],
            Self::NorthWest => [0, 3, 2],
            Self::SouthWest => [0, 1, 2],
            Self::NorthEast => [1, 3, 2],
        }
    }

    /// Its corners in the cell, counter-clockwise.
    pub fn corners(self) -> [DVec2; 3] {
        self.corner_indices().map(|corner| [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE][corner])
    }

    /// The rise of its plane per cell eastward and northward, from the cell's corner heights; NaN where one of its own
    /// corners is.
    pub fn slope(self, [sw, se, nw, ne]: [f64; 4]) -> DVec2 {
        match self {
            Self::SouthEast => DVec2::new(se - sw, ne - se),
            Self::NorthWest => DVec2::new(ne - nw, nw - sw),
            Self::SouthWest => DVec2::new(se - sw, nw - sw),
            Self::NorthEast => DVec2::new(ne - nw, ne - se),
        }
    }

    /// The height of its plane at a position in the cell, from the cell's corner heights; NaN where one of its own
    /// corners is. At a corner of its own it is that corner's height.
    pub fn height(self, corners: [f64; 4], at: DVec2) -> f64 {
        let (slope, [sw, .., ne]) = (self.slope(corners), corners);
        match self {
            Self::NorthEast => ne - slope.x * (1.0 - at.x) - slope.y * (1.0 - at.y),
            _ => sw + slope.x * at.x + slope.y * at.y,
        }
    }

    /// The signed distance of a position in the cell from the diagonal, along an axis of the cell: positive on this triangle's
    /// side.
    pub fn side(self, at: DVec2) -> f64 {
        match self {
            Self::SouthEast => at.x - at.y,
            Self::NorthWest => at.y - at.x,
            Self::SouthWest => 1.0 - at.x - at.y,
            Self::NorthEast => at.x + at.y - 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangles_plane_goes_through_its_corners() {
        let corners = [3.0, 5.0, 11.0, 20.0];
        for cell in [Post { column: 2, row: 4 }, Post { column: 2, row: 5 }] {
            for triangle in CellTriangle::of_cell(cell) {
                for (index, at) in triangle.corner_indices().into_iter().zip(triangle.corners()) {
                    assert_eq!(triangle.height(corners, at), corners[index], "{triangle:?} at {at}");
                }
                let middle = triangle.corners().iter().sum::<DVec2>() / 3.0;
                assert_eq!(CellTriangle::holding(Diagonal::of_cell(cell), middle), triangle);
                assert!(triangle.side(middle) > 0.0);
            }
        }
    }
}

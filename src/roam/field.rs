//! Rows of vertices with their heights and positions, for loops over many: the values of
//! [`PatchedGround`] without a search for the post of each.

use glam::DVec2;

use crate::graph::Vertex;
use crate::patched_ground::PatchedGround;
use sandtable_terrain::lattice::Post;

/// The rows of a ground.
#[derive(Clone, Copy, Debug)]
pub struct HeightField<'a> {
    heights: &'a [f32],
    width: usize,
    last_row: usize,
    first: Post,
    cell: DVec2,
}

/// A row of vertices of a layout.
#[derive(Clone, Copy, Debug)]
pub struct FieldRow<'a> {
    heights: &'a [f32],
    /// World Y of the row, meters.
    pub y: f64,
    first: u32,
    cell: f64,
}

impl<'a> HeightField<'a> {
    /// The field of `ground`.
    pub fn new(ground: PatchedGround<'a>) -> Self {
        let last = ground.layout.post(Vertex::new(i32::MAX, i32::MAX));
        Self {
            heights: ground.lattice.heights(),
            width: ground.lattice.columns() as usize,
            last_row: last.row as usize,
            first: ground.lattice.first(),
            cell: ground.lattice.cell(),
        }
    }

    /// The row of vertices `y`.
    #[inline]
    pub fn row(&self, y: usize) -> FieldRow<'a> {
        let row = y.min(self.last_row);
        FieldRow {
            heights: &self.heights[row * self.width..][..self.width],
            y: coordinate(row as u32 + self.first.row, self.cell.y),
            first: self.first.column,
            cell: self.cell.x,
        }
    }
}

impl FieldRow<'_> {
    /// The height of the post of the vertex in column `x`, meters; NaN without data.
    #[inline]
    pub fn height(&self, x: usize) -> f32 {
        self.heights[x.min(self.heights.len() - 1)]
    }

    /// World X of the vertex in column `x`, meters.
    #[inline]
    pub fn x(&self, x: usize) -> f64 {
        coordinate(x.min(self.heights.len() - 1) as u32 + self.first, self.cell)
    }

    /// World Z of the vertex in column `x`, meters; 0 without data.
    #[inline]
    pub fn z(&self, x: usize) -> f64 {
        let height = self.height(x);
        if height.is_nan() { 0.0 } else { f64::from(height) }
    }
}

/// Rounded to f32, as the ground is drawn. A post's number fits an i32, whose conversion is one instruction.
#[inline]
fn coordinate(post: u32, cell: f64) -> f64 {
    f64::from((f64::from(post as i32) * cell) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::PatchLayout;
    use glam::DVec3;
    use sandtable_terrain::lattice::Lattice;

    #[test]
    fn a_field_has_the_places_of_its_ground() {
        let mut heights: Vec<f32> = (0..21 * 13).map(|index| index as f32 * 0.37).collect();
        heights[40] = f32::NAN;
        let first = Post { column: 7, row: 1_000_003 };
        let lattice = Lattice::part((DVec2::ZERO, DVec2::new(0.3, 30.7)), first, 21, heights).expect("sound");
        let layout = PatchLayout::new(21, 13, 16).expect("sound");
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let field = HeightField::new(ground);
        for (x, y) in (0..33).flat_map(|x| (0..17).map(move |y| (x, y))) {
            let vertex = Vertex::new(x, y);
            let row = field.row(y as usize);
            let place = DVec3::new(row.x(x as usize), row.y, row.z(x as usize));
            assert_eq!(place, ground.position(vertex).as_dvec3());
            let height = lattice.height(layout.post(vertex));
            assert_eq!(row.height(x as usize).to_bits(), height.to_bits());
        }
    }
}

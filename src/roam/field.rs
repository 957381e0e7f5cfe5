//! Vertices with their heights and places, for loops that look at many: the same values as [`Ground`]'s, read by
//! coordinates without a check of each.

use glam::{DVec2, DVec3};

use crate::roam::graph::Vertex;
use crate::roam::ground::Ground;
use crate::roam::layout::Layout;

/// A ground laid open.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    heights: &'a [f32],
    width: usize,
    last: Vertex,
    cell: DVec2,
    exaggeration: f32,
    layout: &'a Layout,
}

impl<'a> Field<'a> {
    /// The field of `ground`.
    pub fn of(ground: Ground<'a>) -> Self {
        let last = ground.layout.post(Vertex::new(i32::MAX, i32::MAX));
        Self {
            heights: ground.lattice.heights(),
            width: ground.lattice.columns() as usize,
            last: Vertex::new(last.column as i32, last.row as i32),
            cell: ground.lattice.cell(),
            exaggeration: ground.exaggeration,
            layout: ground.layout,
        }
    }

    /// The layout.
    pub fn layout(&self) -> &'a Layout {
        self.layout
    }

    /// The height of the post that a vertex of the layout stands for, metres; NaN without data.
    #[inline]
    pub fn height(&self, vertex: Vertex) -> f32 {
        let (x, y) = (vertex.x.min(self.last.x), vertex.y.min(self.last.y));
        self.heights[y as usize * self.width + x as usize]
    }

    /// [`Ground::position`].
    #[inline]
    pub fn position(&self, vertex: Vertex) -> DVec3 {
        let (x, y) = (vertex.x.min(self.last.x), vertex.y.min(self.last.y));
        let height = self.heights[y as usize * self.width + x as usize];
        let z = if height.is_nan() { 0.0 } else { height * self.exaggeration };
        let plan = [f64::from(x) * self.cell.x, f64::from(y) * self.cell.y].map(|at| f64::from(at as f32));
        DVec3::new(plan[0], plan[1], f64::from(z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::lattice::Lattice;

    #[test]
    fn a_field_has_the_places_of_its_ground() {
        let mut heights: Vec<f32> = (0..21 * 13).map(|index| index as f32 * 0.37).collect();
        heights[40] = f32::NAN;
        let lattice = Lattice::new(DVec2::ZERO, DVec2::new(0.3, 30.7), 21, heights).expect("sound");
        let layout = Layout::new(21, 13, 16).expect("sound");
        let ground = Ground { lattice: &lattice, layout: &layout, exaggeration: 1.3 };
        let field = Field::of(ground);
        for (x, y) in (0..33).flat_map(|x| (0..17).map(move |y| (x, y))) {
            let vertex = Vertex::new(x, y);
            assert_eq!(field.position(vertex), ground.position(vertex).as_dvec3());
            let height = lattice.height(layout.post(vertex));
            assert_eq!(field.height(vertex).to_bits(), height.to_bits());
        }
    }
}

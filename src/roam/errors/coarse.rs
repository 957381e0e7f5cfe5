//! The exact errors of ground that one picture shows: all but those of the smallest step are held, a quarter of an
//! [`ErrorMap`](crate::errors::ErrorMap); the others, of which a picture of large ground wants few or none, are measured when they
//! are read.

use crate::errors::exact::{own_error, raised_errors};
use crate::errors::near;
use crate::errors::scan::larger;
use crate::graph::{Vertex, VertexKind};
use crate::layout::PatchLayout;
use sandtable_terrain::lattice::Lattice;

/// The errors of all vertices, bit for bit those of [`ErrorMap::exact`](crate::errors::ErrorMap::exact).
#[derive(Debug)]
pub struct CoarseErrors<'a> {
    lattice: &'a Lattice,
    layout: &'a PatchLayout,
    /// Those of vertices in even columns and rows.
    errors: Vec<f32>,
}

impl<'a> CoarseErrors<'a> {
    /// Measures `lattice`; in parallel, the same for any number of threads.
    pub fn new(lattice: &'a Lattice, layout: &'a PatchLayout) -> Self {
        Self { lattice, layout, errors: raised_errors(lattice, layout, 2) }
    }

    /// The error at a vertex of the layout: meters, or infinite.
    pub fn at(&self, vertex: Vertex) -> f32 {
        let Vertex { x, y } = vertex;
        if (x | y) & 1 == 0 {
            let columns = self.layout.columns() / 2 + 1;
            return self.errors[y as usize / 2 * columns + x as usize / 2];
        }
        if self.is_plain_around(vertex) {
            // The children of a center are the middles of its triangles' sides: its own error is theirs, too, bit for bit where
            // they split two triangles as it does.
            return near::error(self.lattice.heights(), self.lattice.columns() as usize, vertex);
        }
        let own = |vertex: Vertex| own_error(self.lattice, self.layout, vertex);
        match vertex.kind() {
            VertexKind::Center => {
                let children = [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(dx, dy)| own(vertex.moved(dx, dy)));
                children.into_iter().fold(own(vertex), larger)
            }
            VertexKind::EastEdge | VertexKind::NorthEdge => own(vertex),
        }
    }

    /// Whether the vertex is a post with eight around it, all of them with data, none pinned and none on the border.
    fn is_plain_around(&self, Vertex { x, y }: Vertex) -> bool {
        let (columns, rows) = (self.lattice.columns() as usize, self.lattice.rows() as usize);
        let (x, y) = (x as usize, y as usize);
        let is_inside = |at: usize, count: usize| at >= 2 && at + 2 < count;
        if self.lattice.has_pins() || !is_inside(x, columns) || !is_inside(y, rows) {
            return false;
        }
        let row = |row: usize| &self.lattice.heights()[row * columns + x - 1..][..3];
        [y - 1, y, y + 1].into_iter().all(|y| row(y).iter().all(|height| !height.is_nan()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::errors::ErrorMap;
    use glam::DVec2;
    use sandtable_terrain::lattice::Post;

    #[test]
    fn errors_are_those_of_the_map_with_all_of_them() {
        for (columns, rows, patch) in [(70, 300, 64), (131, 90, 32), (40, 33, 4), (30, 37, 2), (90, 200, 128)]
        {
            for spots in [0, 3] {
                let height = |at: u32| {
                    let (x, y) = ((at % columns) as f32, (at / columns) as f32);
                    libm::sinf(x * 0.7) * 5.0 + libm::cosf(y * 0.45 + x * 0.2) * 9.0
                };
                let heights = (0..columns * rows).map(height).collect();
                let mut lattice =
                    Lattice::new(DVec2::ZERO, DVec2::splat(10.0), columns, heights).expect("sound");
                for spot in 0..spots {
                    let post = Post { column: (spot * 17 + 5) % columns, row: (spot * 29 + 8) % rows };
                    lattice.pin(post, if spot == 1 { f32::NAN } else { lattice.height(post) });
                }
                let layout = PatchLayout::new(columns, rows, patch).expect("sound");
                let (all, coarse) =
                    (ErrorMap::exact(&lattice, &layout), CoarseErrors::new(&lattice, &layout));
                for (index, error) in all.values().iter().enumerate() {
                    let (x, y) = (index % layout.columns(), index / layout.columns());
                    let vertex = Vertex::new(x as i32, y as i32);
                    assert_eq!(
                        coarse.at(vertex).to_bits(),
                        error.to_bits(),
                        "{vertex:?}, {columns} × {rows}"
                    );
                }
            }
        }
    }
}

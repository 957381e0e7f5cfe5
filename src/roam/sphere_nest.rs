//! The radii that hold the spheres of children, for the vertices of a row: four at a time where there are as many.

use crate::errors::scan::larger;
use crate::field::{FieldRow, HeightField};
use crate::levels::{ChildPlaces, StridedColumns, both_sides};
use sandtable_base::vectorized::vectorized;

/// Spheres grow by this share from child to parent, so that rounding of f32 radii and f64 distances can never let a child's
/// sphere reach out of its parent's. Smaller than any error that shows, a thousand times the rounding.
pub const MARGIN: f64 = 1e-6;

/// Vertices measured at once.
const LANES: usize = 4;

/// The positions of a row of vertices and of the rows of their children.
pub struct SphereNest<'a> {
    here: FieldRow<'a>,
    beside: [FieldRow<'a>; 2],
    places: ChildPlaces,
}

/// The radii of the spheres of a row of vertices, and those of the rows of their children south and north.
pub type RadiusRows<'a> = [&'a [f32]; 3];

/// A child of each of several vertices: its offset from the vertex, and the radius of its sphere, meters.
#[derive(Clone, Copy)]
struct Children<const N: usize> {
    x: [f64; N],
    y: f64,
    z: [f64; N],
    radius: [f64; N],
}

impl<'a> SphereNest<'a> {
    /// The nest of the row of vertices `y`, whose children are in the rows `beside`, or in its own too.
    pub fn new(field: &HeightField<'a>, y: usize, beside: [usize; 2], places: ChildPlaces) -> Self {
        Self { here: field.row(y), beside: beside.map(|y| field.row(y)), places }
    }

    /// Sets `held` to the radii about the vertices in some columns that hold the spheres of their children; those of radius
    /// 0 need no room.
    pub fn measure(&self, columns: StridedColumns, radii: RadiusRows<'_>, held: &mut Vec<f32>) {
        held.clear();
        vectorized(
            #[inline(always)]
            || self.measure_lanes(columns, radii, held),
        );
    }

    /// Grows the radii of the vertices in some columns of `row` until they hold the spheres of their children.
    pub fn grow(&self, columns: StridedColumns, row: &mut [f32], [south, north]: [&[f32]; 2]) {
        let mut held = Vec::with_capacity(columns.count);
        self.measure(columns, [row, south, north], &mut held);
        columns.iter().zip(held).for_each(|(x, held)| row[x] = larger(row[x], held));
    }

    #[inline(always)]
    fn measure_lanes(&self, columns: StridedColumns, radii: RadiusRows<'_>, held: &mut Vec<f32>) {
        let mut index = 0;
        while index + LANES <= columns.count {
            let at: [usize; LANES] = std::array::from_fn(|lane| columns.at(index + lane));
            held.extend_from_slice(&holding(self.children(at, radii)));
            index += LANES;
        }
        held.extend(
            (index..columns.count).map(|index| holding(self.children([columns.at(index)], radii))[0]),
        );
    }

    #[inline(always)]
    fn children<const N: usize>(
        &self,
        at: [usize; N],
        [here, south, north]: RadiusRows<'_>,
    ) -> [Children<N>; 4] {
        let [below, above] = &self.beside;
        match self.places {
            ChildPlaces::Aslant(reach) => {
                let sides = at.map(|x| both_sides(x, reach, here.len()));
                let (west, east) = (sides.map(|[west, _]| west), sides.map(|[_, east]| east));
                [
                    self.child(at, below, west, south),
                    self.child(at, below, east, south),
                    self.child(at, above, west, north),
                    self.child(at, above, east, north),
                ]
            }
            ChildPlaces::Along(reach) => [
                self.child(at, &self.here, at.map(|x| x - reach), here),
                self.child(at, &self.here, at.map(|x| x + reach), here),
                self.child(at, below, at, south),
                self.child(at, above, at, north),
            ],
        }
    }

    /// The children in the columns `there` of a row.
    #[inline(always)]
    fn child<const N: usize>(
        &self,
        at: [usize; N],
        row: &FieldRow<'_>,
        there: [usize; N],
        radii: &[f32],
    ) -> Children<N> {
        Children {
            x: std::array::from_fn(|lane| self.here.x(at[lane]) - self.here.x(there[lane])),
            y: self.here.y - row.y,
            z: std::array::from_fn(|lane| self.here.z(at[lane]) - row.z(there[lane])),
            radius: there.map(|x| f64::from(radii[x])),
        }
    }
}

/// The radii that hold the spheres of vertices' children: for each vertex the largest of what its children need, which is
/// rounded at the end, as the largest of the rounded ones is the same.
#[inline(always)]
fn holding<const N: usize>(children: [Children<N>; 4]) -> [f32; N] {
    let mut held = [0.0; N];
    for Children { x, y, z, radius } in children {
        // Loops of one step each, over all vertices: so they are vectorized.
        let squares: [f64; N] = std::array::from_fn(|lane| x[lane] * x[lane] + y * y + z[lane] * z[lane]);
        let distances = squares.map(f64::sqrt);
        let needed: [f64; N] = std::array::from_fn(|lane| (distances[lane] + radius[lane]) * (1.0 + MARGIN));
        for lane in 0..N {
            let needed = if radius[lane] == 0.0 { 0.0 } else { needed[lane] };
            held[lane] = if needed > held[lane] { needed } else { held[lane] };
        }
    }
    held.map(|held| held as f32)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;
    use crate::layout::PatchLayout;
    use crate::patched_ground::PatchedGround;
    use sandtable_terrain::lattice::Lattice;

    proptest! {
        #[test]
        fn several_vertices_at_once_get_the_bits_of_each_alone(
            heights in proptest::collection::vec(prop_oneof![9 => -500f32..3000.0, 1 => Just(f32::NAN)], 33 * 9),
            radii in proptest::collection::vec(
                prop_oneof![8 => 0f32..9000.0, 1 => Just(0f32), 1 => Just(f32::INFINITY)],
                33 * 9
            ),
            is_center: bool,
        ) {
            let lattice = Lattice::new(DVec2::ZERO, DVec2::new(30.7, 24.1), 33, heights).expect("sound");
            let layout = PatchLayout::new(33, 9, 8).expect("sound");
            let field = HeightField::new(PatchedGround { lattice: &lattice, layout: &layout });
            let (places, y) = if is_center { (ChildPlaces::Along(1), 3) } else { (ChildPlaces::Aslant(1), 4) };
            let nest = SphereNest::new(&field, y, [y - 1, y + 1], places);
            let rows = [y, y - 1, y + 1].map(|y| &radii[y * 33..][..33]);
            let columns = StridedColumns::until(usize::from(is_center), 33, u32::from(is_center));
            let mut held = Vec::new();
            nest.measure(columns, rows, &mut held);
            prop_assert_eq!(held.len(), columns.count);
            for (x, held) in columns.iter().zip(held) {
                let mut alone = Vec::new();
                nest.measure(StridedColumns { first: x, count: 1, ..columns }, rows, &mut alone);
                prop_assert_eq!(alone[0].to_bits(), held.to_bits());
            }
        }
    }
}

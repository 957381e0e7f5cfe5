//! Every post of the ground: the reference for the other meshes.

use crate::bintree::Triangle;
use crate::graph::Vertex;
use crate::layout::PatchLayout;

/// Calls `emit` with the two finest triangles of every cell of the lattice in the patches whose south-west corners are
/// listed, counter-clockwise from the right angle; row by row within a patch.
pub fn triangles(
    layout: &PatchLayout,
    patches: impl IntoIterator<Item = Vertex>,
    mut emit: impl FnMut([Vertex; 3]),
) {
    for corner in patches {
        let far = layout.post(corner.moved(layout.patch(), layout.patch()));
        for y in corner.y..far.row as i32 {
            for x in corner.x..far.column as i32 {
                // A cell is a patch of one: its diagonal alternates in the same way.
                Triangle::roots(Vertex::new(x, y), 1).iter().for_each(|half| emit(half.corners()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::active::ActiveSet;
    use crate::emit::bintree;
    use crate::emit::examples::{lattice, mesh_of, sorted};
    use proptest::prelude::*;
    use sandtable_mesh::check;

    proptest! {
        #[test]
        fn the_full_mesh_covers_the_ground_but_for_its_holes(
            columns in 2u32..40, rows in 2u32..40, holes in proptest::collection::vec(0usize..1600, 0..4),
        ) {
            let layout = PatchLayout::new(columns, rows, 16).expect("sound");
            let lattice = lattice(columns, rows, &holes);
            let mesh = mesh_of(&lattice, &layout, |place| triangles(&layout, layout.patches(), place));
            let checked = check::check(&mesh);
            prop_assert!(checked.is_ok(), "{:?}", checked);
            if holes.is_empty() {
                let area = lattice.extent().size().x * lattice.extent().size().y;
                prop_assert_eq!(check::check_with_area(&mesh, area).err(), None);
                prop_assert_eq!(mesh.triangles.len() as u32, 2 * (columns - 1) * (rows - 1));
            }
        }
    }

    #[test]
    fn the_full_mesh_is_the_bintree_with_every_vertex_active() {
        let layout = PatchLayout::new(33, 17, 16).expect("sound");
        let mut active = ActiveSet::new(layout);
        (0..33)
            .flat_map(|x| (0..17).map(move |y| Vertex::new(x, y)))
            .for_each(|vertex| active.activate(vertex));
        let full = sorted(|emit| triangles(&layout, layout.patches(), emit));
        assert_eq!(full, sorted(|emit| bintree::triangles(&active, layout.patches(), emit)));
    }
}

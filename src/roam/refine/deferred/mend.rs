//! Edits of a terrain in memory, followed vertex by vertex: no patch is read and compared as a whole.

use crate::roam::block::BlockError;
use crate::roam::dynamic::{DynamicTerrain, Edit};
use crate::roam::graph::Vertex;
use crate::roam::refine::deferred::Deferred;

impl Deferred<DynamicTerrain> {
    /// Takes over an edit of the source. The next update applies it; [`Deferred::edit`] with the edit's patches does the same
    /// in more time.
    ///
    /// # Errors
    /// A patch cannot be read.
    pub fn mend(&mut self, edit: &Edit) -> Result<(), BlockError> {
        self.settled = false;
        let mut reset = Vec::new();
        let layout = self.layout;
        let are_beside = |a: &Vertex, b: &Vertex| layout.patches_at(*a) == layout.patches_at(*b);
        for run in edit.vertices[..edit.placed].chunk_by(are_beside) {
            let [(west, south), (east, north)] = layout.patches_at(run[0]);
            for corner in layout.patches_within((west, south), (east, north)) {
                self.renew(corner, run, &mut reset);
            }
        }
        for &corner in &edit.patches {
            let patch = &mut self.patches[self.layout.patch_index(corner)];
            patch.due = 0;
            if let Some(mesh) = patch.mesh {
                self.miss_renewed(mesh);
            }
        }
        self.edit(&reset)
    }

    /// Gives vertices of the patch with south-west corner `corner` the heights and the radii that they have in the source.
    /// Adds the patch to `reset` where it gained or lost data.
    fn renew(&mut self, corner: Vertex, vertices: &[Vertex], reset: &mut Vec<Vertex>) {
        let Some(mesh) = self.patches[self.layout.patch_index(corner)].mesh else { return };
        let (ground, side) = (self.source.ground(), self.layout.patch());
        let (layout, heights, radii) = (ground.layout, ground.lattice, self.source.spheres().values());
        let mesh = &mut self.meshes[mesh as usize];
        let numbers = self.topologies[mesh.parity].numbers();
        for &vertex in vertices {
            let at = (vertex.y - corner.y) * (side + 1) + vertex.x - corner.x;
            let now = [heights.height(layout.post(vertex)), radii[layout.index(vertex)]];
            if !mesh.renew(numbers[at as usize], now) {
                reset.push(corner);
            }
        }
    }
}

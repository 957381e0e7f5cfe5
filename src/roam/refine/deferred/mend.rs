//! Edits of a terrain in memory, followed vertex by vertex: no patch is read and compared as a whole.

use crate::roam::block::{BlockError, BlockSource};
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
        for &vertex in &edit.vertices[..edit.placed] {
            self.renew(vertex, &mut reset);
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

    /// Gives a vertex the height and the radius that it has in the source, in all meshes that it belongs to. Adds the patches
    /// that gained or lost data to `reset`.
    #[inline]
    fn renew(&mut self, vertex: Vertex, reset: &mut Vec<Vertex>) {
        let (ground, side) = (self.source.ground(), self.layout.patch());
        let z = ground.lattice.height(ground.layout.post(vertex));
        let radius = self.source.spheres().at(ground.layout, vertex);
        let [(west, south), (east, north)] = self.layout.patches_at(vertex);
        for y in south..=north {
            for x in west..=east {
                let corner = Vertex::new(x * side, y * side);
                let Some(mesh) = self.patches[self.layout.patch_index(corner)].mesh else { continue };
                let mesh = &mut self.meshes[mesh as usize];
                let at = (vertex.y - corner.y) * (side + 1) + vertex.x - corner.x;
                let number = self.topologies[mesh.parity].numbers()[at as usize];
                if !mesh.renew(number, [z, radius]) {
                    reset.push(corner);
                }
            }
        }
    }
}

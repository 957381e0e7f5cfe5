//! Edits of a terrain in memory, followed vertex by vertex: no patch is read and compared as a whole.

use crate::block::BlockError;
use crate::dynamic::{DynamicTerrain, Edit};
use crate::field::HeightField;
use crate::graph::Vertex;
use crate::refine::deferred::Deferred;
use crate::refine::deferred::patch::RenewedVertex;

impl Deferred<DynamicTerrain> {
    /// Applies an edit of the source. The next update applies it; [`Deferred::edit`] with the edit's patches does the same in
    /// more time.
    ///
    /// # Errors
    /// A patch cannot be read.
    pub fn mend(&mut self, edit: &Edit) -> Result<(), BlockError> {
        self.settled = false;
        let mut reset = Vec::new();
        let layout = self.layout;
        for (span, run) in layout.runs(&edit.vertices[..edit.placed]) {
            for corner in layout.patches_within(span.first, span.last) {
                self.renew(corner, run, &mut reset);
            }
        }
        for &corner in &edit.patches {
            if let Some(mesh) = self.edited_mesh(corner) {
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
        let (field, radii) = (HeightField::new(ground), self.source.spheres());
        let mesh = &mut self.meshes[mesh as usize];
        let numbers = self.topologies[mesh.parity].numbers();
        let mut mesh = mesh.vertices();
        for row in vertices.chunk_by(|a, b| a.y == b.y) {
            let y = row[0].y;
            let (heights, radii) = (field.row(y as usize), radii.row(ground.layout, y as usize));
            let first = ((y - corner.y) * (side + 1)) as usize;
            for vertex in row {
                let (x, at) = (vertex.x as usize, first + (vertex.x - corner.x) as usize);
                let vertex =
                    RenewedVertex { number: numbers[at], at, z: heights.height(x), radius: radii[x] };
                if !mesh.renew(vertex) {
                    return reset.push(corner);
                }
            }
        }
    }
}

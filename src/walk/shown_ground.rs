//! The ground as a walk shows it, as one mesh: for what needs all of it at once, such as shadows, on another thread.

use std::sync::Arc;

use glam::Mat4;

use crate::Walk;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId, MaterialId};
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_terrain::lattice::Lattice;

/// The triangles of the patches in view. While it is kept, the next edit copies the heights.
pub struct ShownGround {
    lattice: Arc<Lattice>,
    layout: PatchLayout,
    patches: Vec<(Vertex, Vec<[u16; 3]>)>,
}

impl Walk {
    /// The ground as the last update shows it.
    pub fn shown_ground(&self) -> ShownGround {
        let corners = self.mesh.visible().iter();
        ShownGround {
            lattice: Arc::clone(self.lattice()),
            layout: *self.mesh.source().ground().layout,
            patches: corners.map(|&corner| (corner, self.mesh.local_triangles(corner))).collect(),
        }
    }
}

impl ShownGround {
    /// `list`, whose first material is that of the ground, with this ground before all else.
    pub fn with_list(&self, list: &DrawList) -> DrawList {
        let mut list = list.clone();
        let mesh = self.mesh();
        let triangles = 0..mesh.triangles.len() as u32;
        let item = DrawItem {
            mesh: list.add_mesh(mesh),
            triangles,
            material: MaterialId(0),
            world_from_mesh: Mat4::IDENTITY,
            layer: DepthLayer::Ground,
            feature: FeatureId::GROUND,
        };
        list.items.insert(0, item);
        list
    }

    fn mesh(&self) -> DrawMesh {
        let ground = PatchedGround { lattice: &self.lattice, layout: &self.layout };
        let side = self.layout.patch();
        let mut mesh = DrawMesh::default();
        for (corner, triangles) in &self.patches {
            let mut ids: Vec<Option<VertexId>> = vec![None; ((side + 1) * (side + 1)) as usize];
            for corners in triangles {
                let ids = corners.map(|at| {
                    *ids[usize::from(at)].get_or_insert_with(|| {
                        let (x, y) = (i32::from(at) % (side + 1), i32::from(at) / (side + 1));
                        let position = ground.position(corner.moved(x, y)).to_array();
                        let normal = [0.0, 0.0, 1.0];
                        mesh.vertex(DrawVertex { position, normal, uv: [0.0; 2], color: Srgba::WHITE })
                    })
                });
                mesh.triangle(ids);
            }
        }
        mesh
    }
}

//! Converts grid vertices to world space: the positions of a triangle's corners, and whether it is drawn.

use glam::Vec3;

use crate::graph::Vertex;
use crate::patched_ground::PatchedGround;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_terrain::lattice::Post;

/// The posts of a triangle of vertices of the layout; `None` where it is not drawn: it has no area, as beyond the border, or
/// a corner without data.
#[inline]
pub fn drawn_posts(ground: PatchedGround<'_>, corners: [Vertex; 3]) -> Option<[Post; 3]> {
    let [apex, entry, exit] = corners;
    let posts = [ground.layout.post(apex), ground.layout.post(entry), ground.layout.post(exit)];
    let has_data = posts.iter().all(|&post| !ground.lattice.height(post).is_nan());
    (has_data && doubled_area(posts) != 0).then_some(posts)
}

/// Twice a triangle's signed area in cells.
#[inline]
pub(crate) fn doubled_area(posts: [Post; 3]) -> i64 {
    let at = |post: Post| (i64::from(post.column), i64::from(post.row));
    let (a, b, c) = (at(posts[0]), at(posts[1]), at(posts[2]));
    (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)
}

/// The world position of a post with data, meters.
#[inline]
pub fn position(ground: PatchedGround<'_>, post: Post) -> Vec3 {
    ground.lattice.position(post).extend(ground.lattice.height(post))
}

/// A closure that writes an emitter's drawn triangles to `sink`, with one vertex a post.
pub fn placing<'a>(ground: PatchedGround<'a>, sink: &'a mut impl MeshSink<Vec3>) -> impl FnMut([Vertex; 3]) {
    /// No vertex yet: 0, so that fresh memory need not be written; ids are stored one higher.
    const NOT_PLACED: u32 = 0;
    let mut ids = vec![NOT_PLACED; ground.lattice.heights().len()];
    move |corners| {
        if let Some(posts) = drawn_posts(ground, corners) {
            let corners = posts.map(|post| {
                let slot = &mut ids[ground.lattice.index(post)];
                if *slot == NOT_PLACED {
                    *slot = sink.vertex(position(ground, post)).0 + 1;
                }
                VertexId(*slot - 1)
            });
            sink.triangle(corners);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::PatchLayout;
    use glam::DVec2;
    use sandtable_mesh::trimesh::TriMesh;
    use sandtable_terrain::lattice::Lattice;

    #[test]
    fn only_triangles_with_area_and_data_are_placed_and_share_their_vertices() {
        let mut heights = vec![1.0; 4 * 3];
        heights[11] = f32::NAN;
        let lattice = Lattice::new(DVec2::ZERO, DVec2::new(2.0, 3.0), 4, heights).expect("sound");
        let layout = PatchLayout::new(4, 3, 4).expect("sound");
        let mut mesh = TriMesh::default();
        let mut place = placing(PatchedGround { lattice: &lattice, layout: &layout }, &mut mesh);
        let triangle = |points: [(i32, i32); 3]| points.map(|(x, y)| Vertex::new(x, y));
        place(triangle([(0, 0), (4, 0), (0, 2)]));
        place(triangle([(4, 0), (3, 1), (0, 2)]));
        place(triangle([(3, 0), (4, 0), (4, 1)]));
        place(triangle([(2, 1), (3, 1), (3, 2)]));
        drop(place);
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 2));
        assert_eq!(mesh.positions[1], Vec3::new(6.0, 0.0, 1.0));
    }
}

//! 001: the restricted quadtree on the same graph.

use sandtable::roam::active::ActiveSet;
use sandtable::roam::graph::{Kind, Vertex};
use sandtable::roam::layout::Layout;

#[test]
fn paper_001_blocks_of_32_cells_cover_a_terrain_that_is_not_square() {
    let layout = Layout::new(4097, 2049, 32).expect("sound");
    assert_eq!((layout.patch_count(), layout.columns(), layout.rows()), (128 * 64, 4097, 2049));
}

#[test]
fn paper_001_an_edge_vertex_depends_on_the_centres_at_its_sides_a_centre_on_two_corners_of_its_diagonal() {
    for (x, y) in (1..64).flat_map(|x| (1..64).map(move |y| (x, y))) {
        let vertex = Vertex::new(x, y);
        let (step, [one, other]) = (vertex.step(), vertex.parents());
        if step == 32 {
            continue;
        }
        match vertex.kind() {
            Kind::Center => {
                let [from, to] = vertex.hypotenuse();
                assert_eq!(one.middle(other), vertex, "two corners of one diagonal");
                let (across, along) = ((other.x - one.x, other.y - one.y), (to.x - from.x, to.y - from.y));
                assert_eq!(across.0 * along.0 + across.1 * along.1, 0, "perpendicular to the other");
                // The parent square's centre is the one end of the hypotenuse that is a centre itself.
                let side = 4 * step;
                let parent = Vertex::new(x / side * side + side / 2, y / side * side + side / 2);
                let (dx, dy) = (parent.x - x, parent.y - y);
                assert_eq!(across.0 * dx + across.1 * dy, 0, "{vertex:?}: the line to the parent's centre");
            }
            _ => {
                let centers = [one, other].map(|parent| (parent.kind(), parent.step()));
                assert_eq!(centers, [(Kind::Center, step); 2], "{vertex:?}");
            }
        }
    }
}

#[test]
fn paper_001_restrictions_are_applied_until_nothing_more_is_activated() {
    let mut active = ActiveSet::new(Layout::new(129, 65, 32).expect("sound"));
    for (x, y) in [(1, 1), (77, 33), (128, 64), (63, 20)] {
        active.activate(Vertex::new(x, y));
        active.check().expect("every dependency is active");
    }
}

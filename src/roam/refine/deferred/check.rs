//! The invariants of a patch that is up to date.

use crate::refine::deferred::patch::{EyeStation, PatchMesh};
use crate::refine::deferred::topology::{NONE, Topology, triangle};

impl PatchMesh {
    /// Checks that every active vertex has its parents active and counts its active children, that a vertex is active
    /// exactly where the eye is inside its sphere, that all vertices that could change next wait in the wheel, and that the
    /// index list shows the leaves of the bintree, each once.
    ///
    /// # Panics
    /// Where they do not.
    pub fn check(&self, topology: &Topology, station: &EyeStation) {
        for vertex in (0..topology.nodes().len() as u16).filter(|&vertex| !Topology::is_corner(vertex)) {
            self.check_vertex(topology, station, vertex);
        }
        self.check_indices(topology);
    }

    fn check_vertex(&self, topology: &Topology, station: &EyeStation, vertex: u16) {
        let node = &topology.nodes()[vertex as usize];
        let at = topology.places()[vertex as usize];
        let (active, may_split) = (self.is_active(vertex), self.may_split(vertex));
        let inside_m = station.inside_m(self.sphere(topology, vertex));
        let ready = |parent: u16| parent == NONE || self.is_active(parent);
        assert_eq!(may_split, ready(node.ring[1]) && ready(node.ring[3]), "the parents of {at:?} by count");
        assert_eq!(active, inside_m > 0.0 && may_split, "{at:?} is active, against its sphere and parents");
        // A vertex on the border is also a child of a middle in the next patch, and splits nothing there.
        let is_active = |&child: &u16| child != NONE && self.is_active(child);
        let children = node.children.iter().filter(|child| is_active(child)).count();
        assert_eq!(children, self.active_children(vertex), "the active children of {at:?} by count");
        let may_change = if active { children == 0 } else { may_split };
        assert!(
            !may_change || self.is_waiting(vertex) || !inside_m.is_finite(),
            "{at:?} could change next but does not wait"
        );
        let has_triangles = (0..4).any(|side| self.is_shown(topology, triangle(vertex, side)));
        assert!(active || !has_triangles, "{at:?} is not active but has triangles");
    }

    fn is_shown(&self, topology: &Topology, triangle: u32) -> bool {
        self.slot(triangle).is_some_and(|slot| self.indices()[slot] == topology.corners(triangle))
    }

    /// The leaves are walked from the roots and looked up in the list.
    fn check_indices(&self, topology: &Topology) {
        let mut stack: Vec<u32> = topology.roots().iter().map(|root| triangle(root[0], 0)).collect();
        let mut shown = 0;
        while let Some(at) = stack.pop() {
            let corners = topology.corners(at);
            let middle = topology.middle(at);
            if middle != NONE && self.is_active(middle) {
                let side = usize::from(topology.nodes()[middle as usize].ring[3] == corners[0]);
                stack.extend([triangle(middle, 2 * side), triangle(middle, 2 * side + 1)]);
            } else if self.is_shown(topology, at) {
                shown += 1;
            } else {
                let is_missing = self.slot(at).is_none() && self.is_missing(topology, corners);
                assert!(is_missing, "the leaf {corners:?} is not in the index list");
            }
        }
        assert_eq!(shown, self.indices().len(), "leaves, and triangles in the index list");
    }
}

//! What must hold of a patch whenever it is up to date.

use crate::roam::refine::deferred::patch::{EyeStation, PatchMesh};
use crate::roam::refine::deferred::topology::{NONE, Topology, TopologyNode, triangle};

impl PatchMesh {
    /// Whether every active vertex has its parents active and counts its active children; a vertex is active exactly
    /// where the eye is inside its sphere; what could change next waits in the wheel, no longer than it may; and the
    /// index list shows the leaves of the bintree, each once.
    ///
    /// # Errors
    /// A sentence naming the first flaw.
    pub fn check(&self, topology: &Topology, station: &EyeStation) -> Result<(), String> {
        for (vertex, node) in topology.nodes().iter().enumerate() {
            if !Topology::is_corner(vertex as u16) {
                self.check_vertex(topology, station, vertex as u16, node)?;
            }
        }
        self.check_indices(topology)
    }

    fn check_vertex(
        &self,
        topology: &Topology,
        station: &EyeStation,
        vertex: u16,
        node: &TopologyNode,
    ) -> Result<(), String> {
        let flaw = |what: &str| Err(format!("vertex {:?} {what}", topology.places()[vertex as usize]));
        let active = self.is_active(vertex);
        let inside = station.inside_m(self.sphere(topology, vertex)) > 0.0;
        let ready = |parent: u16| parent == NONE || self.is_active(parent);
        if self.may_split(vertex) != (ready(node.ring[1]) && ready(node.ring[3])) {
            return flaw("counts its active parents wrongly");
        }
        if active && !self.may_split(vertex) {
            return flaw("is active without a parent");
        }
        if active != (inside && self.may_split(vertex)) {
            return flaw("is not as the eye's place asks");
        }
        // A vertex on the border is also a child of a middle in the next patch, and splits nothing there.
        let is_active = |&child: &u16| child != NONE && self.is_active(child);
        let children = node.children.iter().filter(|child| is_active(child)).count();
        if children != self.active_children(vertex) {
            return flaw("counts its active children wrongly");
        }
        let may_change = if active { children == 0 } else { self.may_split(vertex) };
        if may_change
            && !self.is_waiting(vertex)
            && station.inside_m(self.sphere(topology, vertex)).is_finite()
        {
            return flaw("could change next but is not waited for");
        }
        let leaves = (0..4).filter(|&side| self.is_leaf(topology, vertex, side)).count();
        if !active && leaves > 0 {
            return flaw("is not active but has triangles");
        }
        Ok(())
    }

    fn is_leaf(&self, topology: &Topology, vertex: u16, side: usize) -> bool {
        self.slot(triangle(vertex, side)).is_some_and(|slot| {
            let corners = self.indices()[slot];
            corners == topology.corners(triangle(vertex, side))
        })
    }

    /// The leaves are walked from the roots and looked up in the list.
    fn check_indices(&self, topology: &Topology) -> Result<(), String> {
        let mut stack: Vec<u32> = topology.roots().iter().map(|root| triangle(root[0], 0)).collect();
        let mut shown = 0;
        while let Some(at) = stack.pop() {
            let corners = topology.corners(at);
            let middle = topology.middle(at);
            if middle != NONE && self.is_active(middle) {
                let node = &topology.nodes()[middle as usize];
                let side = usize::from(node.ring[3] == corners[0]);
                stack.extend([triangle(middle, 2 * side), triangle(middle, 2 * side + 1)]);
                continue;
            }
            match self.slot(at) {
                Some(slot) if self.indices()[slot] == corners => shown += 1,
                None if self.is_missing(topology, corners) => {}
                _ => return Err(format!("the leaf {corners:?} is not in the index list")),
            }
        }
        if shown == self.indices().len() {
            Ok(())
        } else {
            Err(format!("the index list has {} triangles, the patch {shown}", self.indices().len()))
        }
    }
}

//! Claims of five papers, one test a claim and one file a paper: patches with forced splits and merges (Lin, Wan, Zhou
//! and Tan), the restricted quadtree, outdoor terrain rendering, the constrained nested error criterion (Yu and Zhang),
//! the digital terrain model (Zhang, Wang and Wu).

mod dtm;
mod nested;
mod outdoor;
mod patches;
mod quadtree;
mod world;

use sandtable_roam::active::ActiveSet;
use sandtable_roam::bintree::Triangle;
use world::{World, camera, same};

/// The leaves of all patches.
fn leaves(active: &ActiveSet) -> Vec<Triangle> {
    let layout = active.layout();
    let mut stack: Vec<Triangle> =
        layout.patches().flat_map(|corner| Triangle::roots(corner, layout.patch())).collect();
    let mut leaves = Vec::new();
    while let Some(triangle) = stack.pop() {
        if !triangle.is_finest() && active.is_active(triangle.split_vertex()) {
            stack.extend(triangle.split());
        } else {
            leaves.push(triangle);
        }
    }
    leaves
}

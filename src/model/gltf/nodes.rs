//! Where every node of the scene stands.

use ::gltf::json::Root;
use ::gltf::json::scene::Node;
use glam::{Mat4, Quat, Vec3};

use crate::model::error::ModelError;

/// The nodes of the scene and their places.
pub(super) struct NodeTransforms {
    /// Nodes of the scene, parents before children.
    pub order: Vec<usize>,
    /// The place of each node of the document in the scene, in glTF's axes; the identity outside it.
    pub world_from_node: Vec<Mat4>,
}

/// Walks the default scene; where none is named the first, and where there is none every node without a
/// parent.
///
/// # Errors
/// [`ModelError::Gltf`] where nodes do not form trees.
pub(super) fn standing(root: &Root) -> Result<NodeTransforms, ModelError> {
    let is_child = check_trees(root)?;
    let scene = root.scene.map_or(0, |scene| scene.value());
    let mut open: Vec<(usize, Mat4)> = match root.scenes.get(scene) {
        Some(scene) => scene.nodes.iter().rev().map(|node| (node.value(), Mat4::IDENTITY)).collect(),
        None => {
            let roots = (0..root.nodes.len()).rev().filter(|&node| !is_child[node]);
            roots.map(|node| (node, Mat4::IDENTITY)).collect()
        }
    };
    let mut standing =
        NodeTransforms { order: Vec::new(), world_from_node: vec![Mat4::IDENTITY; root.nodes.len()] };
    let mut done = vec![false; root.nodes.len()];
    while let Some((index, world_from_parent)) = open.pop() {
        if std::mem::replace(&mut done[index], true) {
            continue;
        }
        let node = &root.nodes[index];
        let world_from_node = world_from_parent * parent_from_node(node);
        standing.order.push(index);
        standing.world_from_node[index] = world_from_node;
        open.extend(children(node).rev().map(|child| (child, world_from_node)));
    }
    Ok(standing)
}

fn children(node: &Node) -> impl DoubleEndedIterator<Item = usize> + '_ {
    node.children.iter().flatten().map(|child| child.value())
}

/// Whether each node is some node's child.
fn check_trees(root: &Root) -> Result<Vec<bool>, ModelError> {
    let mut parent = vec![None; root.nodes.len()];
    for (index, node) in root.nodes.iter().enumerate() {
        for child in children(node) {
            if let Some(other) = parent[child].replace(index) {
                let reason = format!("it is a child of nodes {other} and {index}; a node has one parent");
                return Err(ModelError::gltf(format!("nodes[{child}]"), reason));
            }
        }
    }
    let mut reached = vec![usize::MAX; root.nodes.len()];
    for start in 0..root.nodes.len() {
        let mut next = Some(start);
        while let Some(index) = next {
            if reached[index] == start {
                return Err(ModelError::gltf(format!("nodes[{index}]"), "it is among its own ancestors"));
            }
            if reached[index] != usize::MAX {
                break;
            }
            reached[index] = start;
            next = parent[index];
        }
    }
    Ok(parent.into_iter().map(|parent| parent.is_some()).collect())
}

fn parent_from_node(node: &Node) -> Mat4 {
    if let Some(matrix) = &node.matrix {
        return Mat4::from_cols_array(matrix);
    }
    let rotation = node.rotation.map_or(Quat::IDENTITY, |rotation| Quat::from_array(rotation.0));
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { Quat::IDENTITY };
    Mat4::from_scale_rotation_translation(
        node.scale.map_or(Vec3::ONE, Vec3::from),
        rotation,
        node.translation.map_or(Vec3::ZERO, Vec3::from),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(nodes: &str) -> Result<Vec<f32>, ModelError> {
        let json = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}]}}"#);
        let root: Root = serde_json::from_str(&json).expect("sound JSON");
        let standing = standing(&root)?;
        Ok(standing.order.iter().map(|&node| standing.world_from_node[node].w_axis.x).collect())
    }

    #[test]
    fn children_stand_on_their_parents() {
        let nodes = r#"{"translation":[1,0,0]},{"children":[0],"scale":[2,2,2],"translation":[10,0,0]}"#;
        assert_eq!(walk(nodes), Ok(vec![10.0, 12.0]));
    }

    #[test]
    fn circles_and_shared_children_are_refused() {
        assert!(walk(r#"{"children":[1]},{"children":[0]}"#).is_err());
        assert!(walk(r#"{"children":[0]}"#).is_err());
        assert!(walk(r#"{"children":[2]},{"children":[2]},{}"#).is_err());
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_nodes_is_walked_without_recursion() {
        let links: Vec<String> = (1..100_000).map(|child| format!(r#"{{"children":[{child}]}}"#)).collect();
        assert_eq!(walk(&(links.join(",") + ",{}")).map(|places| places.len()), Ok(100_000));
    }
}

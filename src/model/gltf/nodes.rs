//! The nodes of the scene and their transforms.

use ::gltf::Document;
use ::gltf::scene::{Node, Transform};
use glam::{Mat4, Quat, Vec3};

use crate::error::ModelError;

pub(super) struct SceneNodes {
    /// Nodes of the scene, parents before children.
    pub order: Vec<usize>,
    /// For each node of the document its transform to the scene, in glTF's axes; the identity outside the scene.
    pub world_from_node: Vec<Mat4>,
}

impl SceneNodes {
    /// Walks the default scene; where none is named the first, and without scenes every node that has no parent.
    pub(super) fn new(document: &Document) -> Result<Self, ModelError> {
        let nodes: Vec<Node<'_>> = document.nodes().collect();
        let parents = checked_parents(&nodes)?;
        let roots: Vec<usize> = match document.default_scene().or_else(|| document.scenes().next()) {
            Some(scene) => scene.nodes().map(|node| node.index()).collect(),
            None => (0..nodes.len()).filter(|&node| parents[node].is_none()).collect(),
        };
        let mut open: Vec<(usize, Mat4)> =
            roots.into_iter().rev().map(|node| (node, Mat4::IDENTITY)).collect();
        let mut order = Vec::new();
        let mut world_from_node = vec![Mat4::IDENTITY; nodes.len()];
        let mut done = vec![false; nodes.len()];
        while let Some((index, world_from_parent)) = open.pop() {
            if std::mem::replace(&mut done[index], true) {
                continue;
            }
            world_from_node[index] = world_from_parent * parent_from_node(&nodes[index]);
            order.push(index);
            let children: Vec<usize> = nodes[index].children().map(|child| child.index()).collect();
            open.extend(children.into_iter().rev().map(|child| (child, world_from_node[index])));
        }
        Ok(Self { order, world_from_node })
    }
}

/// The parent of each node.
fn checked_parents(nodes: &[Node<'_>]) -> Result<Vec<Option<usize>>, ModelError> {
    let error = |node: usize, reason: String| Err(ModelError::gltf(format!("nodes[{node}]"), reason));
    let mut parents = vec![None; nodes.len()];
    for node in nodes {
        for child in node.children().map(|child| child.index()) {
            if let Some(other) = parents[child].replace(node.index()) {
                let parents = [other, node.index()];
                return error(child, format!("it is a child of nodes {parents:?}; a node has one parent"));
            }
        }
    }
    let mut reached_from = vec![usize::MAX; nodes.len()];
    for start in 0..nodes.len() {
        let mut next = Some(start);
        while let Some(index) = next {
            if reached_from[index] == start {
                return error(index, "it is its own ancestor".into());
            }
            if reached_from[index] != usize::MAX {
                break;
            }
            reached_from[index] = start;
            next = parents[index];
        }
    }
    Ok(parents)
}

fn parent_from_node(node: &Node<'_>) -> Mat4 {
    match node.transform() {
        Transform::Matrix { matrix } => Mat4::from_cols_array_2d(&matrix),
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = Quat::from_array(rotation);
            let rotation =
                if rotation.length_squared() > 0.0 { rotation.normalize() } else { Quat::IDENTITY };
            Mat4::from_scale_rotation_translation(Vec3::from(scale), rotation, translation.into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::container::GltfFile;

    fn places(nodes: &str) -> Result<Vec<f32>, ModelError> {
        let json = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}]}}"#);
        let nodes = SceneNodes::new(&GltfFile::open(json.as_bytes())?.document)?;
        Ok(nodes.order.iter().map(|&node| nodes.world_from_node[node].w_axis.x).collect())
    }

    #[test]
    fn children_move_with_their_parents() {
        let nodes = r#"{"translation":[1,0,0]},{"children":[0],"scale":[2,2,2],"translation":[10,0,0]}"#;
        assert_eq!(places(nodes).expect("sound"), [10.0, 12.0]);
    }

    #[test]
    fn cycles_and_shared_children_are_refused() {
        assert!(places(r#"{"children":[1]},{"children":[0]}"#).is_err());
        assert!(places(r#"{"children":[0]}"#).is_err());
        assert!(places(r#"{"children":[2]},{"children":[2]},{}"#).is_err());
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_nodes_is_walked_without_recursion() {
        let links: Vec<String> = (1..100_000).map(|child| format!(r#"{{"children":[{child}]}}"#)).collect();
        assert_eq!(places(&(links.join(",") + ",{}")).expect("sound").len(), 100_000);
    }
}

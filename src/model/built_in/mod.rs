//! Models that need no file: trees, a shrub and a rock, made by formula, life-size in meters.
//!
//! A sand table needs woods more often than anything else, and a wood is seen from far away by the thousand: so each is
//! some hundred triangles of vertex colors, with light and shade between the boughs painted in, and no texture. The
//! origin is at the ground under the middle; a little of each reaches below it, so that nothing floats on a slope.
//!
//! ```text
//!   conifer          broadleaf        shrub        rock
//!      ▲               ▟██▙
//!     ▟█▙             ▟████▙
//!    ▟███▙            ▀█▜▛█▀         ▄▟█▙▄        ▄▄▖
//!      ┃ 18 m           ┃ 14 m       ▀▀▀▀▀ 2 m   ▐██▙ 1.5 m
//! ```
//!
//! The same numbers come out on every machine: all arithmetic is that of f32 and of `libm`.

mod blob;
mod broadleaf;
mod conifer;
mod rock;
mod shrub;
mod trunk;

use crate::draw::list::{DrawMesh, MaterialId};
use crate::draw::material::Material;
use crate::model::{Census, Model, ModelPart};

/// The names of all built-in models.
pub const NAMES: [&str; 4] = ["conifer", "broadleaf", "shrub", "rock"];

/// The built-in model of this name; `None` where there is none.
pub fn by_name(name: &str) -> Option<Model> {
    let mesh = match name {
        "conifer" => conifer::mesh(),
        "broadleaf" => broadleaf::mesh(),
        "shrub" => shrub::mesh(),
        "rock" => rock::mesh(),
        _ => return None,
    };
    Some(model(name, mesh))
}

/// A model of one mesh that shows the colors of its vertices.
fn model(name: &str, mesh: DrawMesh) -> Model {
    let census =
        Census { meshes: 1, vertices: mesh.vertices.len(), faces: mesh.triangles.len(), materials: 1 };
    Model {
        parts: vec![ModelPart { name: name.to_owned(), mesh, material: MaterialId(0) }],
        materials: vec![Material { name: name.to_owned(), ..Material::default() }],
        census,
        ..Model::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn models() -> impl Iterator<Item = (&'static str, Model)> {
        NAMES.into_iter().map(|name| (name, by_name(name).expect("it has a model")))
    }

    #[test]
    fn every_name_has_a_model_of_its_height_and_no_other_name_has() {
        for ((name, model), height) in models().zip([18.0, 14.0, 2.0, 1.5]) {
            let (min, max) = model.bounds().expect("not empty");
            assert!((max.z - height).abs() < height * 0.1, "{name} is {} m high", max.z);
            assert!(min.z < 0.0 && min.z > -height * 0.2, "{name} reaches {} m into the ground", -min.z);
            assert!((60..=220).contains(&model.triangle_count()), "{name}: {}", model.triangle_count());
        }
        assert!(by_name("palm").is_none() && by_name("").is_none());
    }

    #[test]
    fn normals_are_unit_and_look_the_way_that_their_triangles_face() {
        for (name, model) in models() {
            let mesh = &model.parts[0].mesh;
            for ids in &mesh.triangles {
                let corners = ids.map(|id| &mesh.vertices[id.index()]);
                let [a, b, c] = corners.map(|corner| Vec3::from(corner.position));
                let face =
                    (b - a).cross(c - a).try_normalize().unwrap_or_else(|| panic!("{name}: {a} {b} {c}"));
                for corner in corners {
                    let normal = Vec3::from(corner.normal);
                    assert!((normal.length() - 1.0).abs() < 1e-4, "{name}: {normal}");
                    assert!(normal.dot(face) > -0.35, "{name}: {normal} on a face to {face}");
                }
            }
        }
    }
}

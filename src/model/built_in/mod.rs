//! Models that need no file: trees, a shrub and a rock, computed by formula, life-size in meters.
//!
//! Woods are the most frequent need of a terrain scene, and they are seen from afar by the thousand: so each model has
//! some hundred triangles with vertex colors, light and shade between the boughs included, and no texture. The origin is on
//! the ground under the center; a little of each model is below, so that nothing floats on a slope.
//!
//! ```text
//!   conifer          broadleaf        shrub        rock         and walnut 13 m, beech 18 m,
//!      ▲               ▟██▙                                     poplar 20 m, pine 16 m
//!     ▟█▙             ▟████▙
//!    ▟███▙            ▀█▜▛█▀         ▄▟█▙▄        ▄▄▖
//!      ┃ 18 m           ┃ 14 m       ▀▀▀▀▀ 2 m   ▐██▙ 1.5 m
//! ```
//!
//! No two trees of a wood are alike: where many are scattered, a broadleaved one and a conifer take one of several
//! [`forms`] each, and every plant one of several tints.
//!
//! The numbers are the same on every machine: all arithmetic is that of f32 and `libm`.

mod conifer;
mod lump;
mod lumpy;
mod trunk;
mod vertex;

use crate::{Census, Model, ModelPart};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, MaterialId};
use sandtable_draw::material::Material;

/// The names of all built-in models.
pub const NAMES: [&str; 8] = ["conifer", "broadleaf", "shrub", "rock", "walnut", "beech", "poplar", "pine"];

/// What the colors of a plant are multiplied with, by where it stands: fresh, yellowish, bluish, dull and dark leaves.
const TINTS: [Srgba; 6] = [
    Srgba::WHITE,
    Srgba::opaque(252, 246, 214),
    Srgba::opaque(228, 240, 224),
    Srgba::opaque(216, 232, 232),
    Srgba::opaque(242, 236, 212),
    Srgba::opaque(214, 226, 204),
];

/// The built-in model of this name; `None` where there is none.
pub fn by_name(name: &str) -> Option<Model> {
    let mesh = match name {
        "conifer" => conifer::mesh(),
        "broadleaf" => lumpy::broadleaf(),
        "shrub" => lumpy::shrub(),
        "rock" => lumpy::rock(),
        "walnut" => lumpy::walnut(),
        "beech" => lumpy::beech(),
        "poplar" => lumpy::poplar(),
        "pine" => lumpy::pine(),
        _ => return None,
    };
    let tints = if name == "rock" { Vec::new() } else { TINTS.to_vec() };
    Some(Model { tints, ..model(name, mesh) })
}

/// The models that scattered ones of this name are, one as often as the other: crowns of several forms where the name
/// says no more than broadleaved tree or conifer, else the one model.
pub fn forms(name: &str) -> Vec<&str> {
    match name {
        "broadleaf" => vec![name, "walnut", "beech"],
        // Spruces are the rule; here and there stands a pine.
        "conifer" => vec![name, name, name, "pine"],
        _ => vec![name],
    }
}

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
    use sandtable_geom::aabb::Aabb;

    fn models() -> impl Iterator<Item = (&'static str, Model)> {
        NAMES.into_iter().map(|name| (name, by_name(name).expect("it has a model")))
    }

    #[test]
    fn every_name_has_a_model_of_its_height_and_no_other_name_has() {
        for ((name, model), height) in models().zip([18.0, 14.0, 2.0, 1.5, 13.0, 18.0, 20.0, 16.0]) {
            let Aabb { min, max } = model.bounds().expect("not empty");
            assert!((max.z - height).abs() < height * 0.1, "{name} is {} m high", max.z);
            assert!(min.z < 0.0 && min.z > -height * 0.2, "{name} reaches {} m into the ground", -min.z);
            assert!((60..=220).contains(&model.triangle_count()), "{name}: {}", model.triangle_count());
        }
        assert!(by_name("palm").is_none() && by_name("").is_none());
    }

    #[test]
    fn every_form_is_a_model_and_trees_that_are_not_named_have_several() {
        for name in NAMES {
            let forms = forms(name);
            assert!(forms.contains(&name) && forms.iter().all(|form| NAMES.contains(form)), "{forms:?}");
        }
        assert!(forms("broadleaf").len() > 2 && forms("conifer").contains(&"pine"));
        assert_eq!(forms("house.obj"), ["house.obj"]);
    }

    #[test]
    fn normals_are_unit_and_on_the_side_that_their_triangles_face() {
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

//! Solids with fixed heights.

use std::collections::BTreeMap;

use crate::add_mesh;
use sandtable_draw::list::{DepthLayer, DrawList};
use sandtable_draw::material::Material;
use sandtable_ribbon::texture::texture;
use sandtable_scene::facade::facade;
use sandtable_scene::feature_meshes::Coat;
use sandtable_scene::scene_model::SceneModel;

/// Adds all solids.
pub(super) fn add(list: &mut DrawList, scene: &SceneModel) {
    let mut materials = BTreeMap::new();
    for solid in &scene.solids {
        let material = *materials.entry(solid.coat).or_insert_with(|| {
            let material = match solid.coat {
                Coat::Painted => Material { name: "painted".into(), ..Material::default() },
                Coat::Facade => Material {
                    name: "facade".into(),
                    texture: Some(list.add_texture(facade())),
                    ..Material::default()
                },
                Coat::Sheet => Material { name: "sheet".into(), two_sided: true, ..Material::default() },
                Coat::Picture(number) => Material {
                    name: format!("picture {number}"),
                    texture: scene
                        .pictures
                        .get(number as usize)
                        .map(|pixels| list.add_texture(pixels.clone())),
                    two_sided: true,
                    ..Material::default()
                },
                Coat::Surface(surface) => Material {
                    name: format!("{surface:?} of a solid").to_lowercase(),
                    texture: Some(list.add_texture(texture(surface))),
                    ..Material::default()
                },
            };
            list.add_material(material)
        });
        add_mesh(list, solid.mesh.clone(), material, DepthLayer::Solid, solid.feature);
    }
}

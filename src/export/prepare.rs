//! A draw list made ready for programs that know neither ground maps nor layers.

use glam::Vec3;
use rayon::prelude::*;

use crate::draw::color::Srgba;
use crate::draw::ground::GroundMap;
use crate::draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh};
use crate::draw::material::{Albedo, AlphaMode, Material, NormalSource};
use crate::export::bake::{Baked, bake};
use crate::export::inlay::inlaid;

/// How far above the ground, in meters, lies what lets the ground through: it cannot take the ground's place, and in
/// the same plane the two would flicker.
const LIFT_M: f32 = 0.05;

/// The same picture with a texture in place of the ground map, a ground that ends where something lies on it, and
/// normals at every vertex. What holds no triangle then is left out.
pub fn prepare(mut list: DrawList) -> DrawList {
    let baked = list.ground.as_deref().map(bake);
    let meshes: Vec<Option<DrawMesh>> = {
        let draped = draped(&list);
        list.items.par_iter().map(|item| own_mesh(&list, item, baked.as_ref(), &draped)).collect()
    };
    if let Some(baked) = baked {
        let texture = Some(list.add_texture(baked.pixels));
        for material in list.materials.iter_mut().filter(|material| material.albedo == Albedo::GroundMap) {
            let (albedo, base_color) = (Albedo::Surface, Srgba::WHITE);
            *material = Material { texture, albedo, base_color, ..std::mem::take(material) };
        }
    }
    let items = std::mem::take(&mut list.items);
    for (item, own) in items.into_iter().zip(meshes) {
        match own {
            Some(own) => {
                // Whatever the list held for this item alone is not written, and need not be kept.
                list.meshes[item.mesh.0 as usize] = DrawMesh::default();
                let triangles = 0..own.triangles.len() as u32;
                let mesh = list.add_mesh(own);
                list.items.push(DrawItem { mesh, triangles, ..item });
            }
            None => list.items.push(item),
        }
    }
    list.items.retain(|item| !item.triangles.is_empty());
    list.ground = None;
    list
}

/// What lies on the ground and hides it.
fn draped(list: &DrawList) -> Vec<&DrawMesh> {
    let hides = |item: &&DrawItem| matches!(item.layer, DepthLayer::Draped(_)) && !is_translucent(list, item);
    list.items.iter().filter(hides).map(|item| &list.meshes[item.mesh.0 as usize]).collect()
}

fn is_translucent(list: &DrawList, item: &DrawItem) -> bool {
    list.materials[item.material.0 as usize].alpha == AlphaMode::Blend
}

/// The item's mesh where it needs one of its own; `None` where the list's will do.
fn own_mesh(
    list: &DrawList,
    item: &DrawItem,
    baked: Option<&Baked>,
    draped: &[&DrawMesh],
) -> Option<DrawMesh> {
    let mesh = &list.meshes[item.mesh.0 as usize];
    let material = &list.materials[item.material.0 as usize];
    let mut own = match item.layer {
        DepthLayer::Ground => inlaid(mesh, draped.iter().copied()),
        DepthLayer::Draped(_) => mesh.clone(),
        DepthLayer::Solid => return None,
    };
    if let (Albedo::GroundMap, Some(baked)) = (material.albedo, baked) {
        for vertex in &mut own.vertices {
            vertex.uv = baked.uv(Vec3::from(vertex.position).truncate()).to_array();
        }
    }
    if let (NormalSource::Ground, Some(map)) = (material.normals, list.ground.as_deref()) {
        take_normals(&mut own, map);
    }
    if matches!(item.layer, DepthLayer::Draped(_)) && is_translucent(list, item) {
        own.vertices.iter_mut().for_each(|vertex| vertex.position[2] += LIFT_M);
    }
    Some(own)
}

fn take_normals(mesh: &mut DrawMesh, map: &GroundMap) {
    for vertex in &mut mesh.vertices {
        vertex.normal = map.sample(Vec3::from(vertex.position).truncate()).normal().to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use crate::draw::ground::{ColorRamp, GroundPost};
    use crate::draw::list::{DrawVertex, FeatureId};
    use crate::mesh::sink::MeshSink;
    use glam::{Mat4, Vec2};

    fn square(low: f32, high: f32) -> DrawMesh {
        let mut mesh = DrawMesh::default();
        let ids = [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| {
            let position = [x, y, x * 0.5];
            mesh.vertex(DrawVertex { position, normal: [0.0, 0.0, 1.0], uv: [0.0; 2], color: Srgba::WHITE })
        });
        mesh.triangle([ids[0], ids[1], ids[2]]);
        mesh.triangle([ids[0], ids[2], ids[3]]);
        mesh
    }

    fn list(alpha: AlphaMode) -> DrawList {
        let post = |index: u32| GroundPost {
            height_m: (index % 3) as f32 * 5.0,
            slope_east: 0.5,
            ..GroundPost::default()
        };
        let map = GroundMap {
            origin: Vec2::ZERO,
            cell: Vec2::splat(10.0),
            columns: 3,
            rows: 3,
            posts: (0..9).map(post).collect(),
            ramp: ColorRamp::new(vec![(0.0, Srgba::WHITE)]).expect("one stop"),
            contours: None,
        };
        let mut list = DrawList { ground: Some(Arc::new(map)), ..DrawList::default() };
        let ground =
            Material { albedo: Albedo::GroundMap, normals: NormalSource::Ground, ..Material::default() };
        let road = Material { alpha, normals: NormalSource::Ground, ..Material::default() };
        let materials = [list.add_material(ground), list.add_material(road)];
        for (mesh, material, layer) in [
            (square(0.0, 20.0), materials[0], DepthLayer::Ground),
            (square(5.0, 9.0), materials[1], DepthLayer::Draped(3)),
        ] {
            let mesh = list.add_mesh(mesh);
            let (world_from_mesh, feature) = (Mat4::IDENTITY, FeatureId::GROUND);
            list.items.push(DrawItem { mesh, triangles: 0..2, material, world_from_mesh, layer, feature });
        }
        list
    }

    fn area(list: &DrawList, item: usize) -> f32 {
        let mesh = &list.meshes[list.items[item].mesh.0 as usize];
        let at = |id: crate::mesh::sink::VertexId| Vec3::from(mesh.vertices[id.index()].position).truncate();
        mesh.triangles.iter().map(|&[a, b, c]| (at(b) - at(a)).perp_dot(at(c) - at(a)) / 2.0).sum()
    }

    #[test]
    fn the_ground_ends_where_a_road_lies_and_shows_its_map_and_its_slope() {
        let ready = prepare(list(AlphaMode::Opaque));
        assert!((area(&ready, 0) - 384.0).abs() < 1e-2, "{}", area(&ready, 0));
        assert_eq!(ready.materials[0].albedo, Albedo::Surface);
        assert!(ready.materials[0].texture.is_some() && ready.check().is_ok());
        let normal = Vec3::new(-0.5, 0.0, 1.0).normalize();
        for item in &ready.items {
            for vertex in &ready.meshes[item.mesh.0 as usize].vertices {
                assert!((Vec3::from(vertex.normal) - normal).length() < 1e-5);
            }
        }
    }

    #[test]
    fn what_lets_the_ground_through_lies_a_little_above_it() {
        let ready = prepare(list(AlphaMode::Blend));
        assert!((area(&ready, 0) - 400.0).abs() < 1e-2);
        let road = &ready.meshes[ready.items[1].mesh.0 as usize];
        assert!((road.vertices[0].position[2] - (2.5 + LIFT_M)).abs() < 1e-5);
    }
}

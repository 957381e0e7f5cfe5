//! Makes a draw list ready for programs that have neither ground maps nor depth layers.

use glam::Vec3;
use rayon::prelude::*;

use crate::bake::{BakedGround, bake};
use crate::inlay::cut_out;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh};
use sandtable_draw::material::{Albedo, AlphaMode, NormalSource};
use sandtable_terrain::stop_flag::StopFlag;

/// The height above the ground, in meters, of translucent drapes: they cannot replace the ground, and in its plane they
/// would flicker. Arbitrary, but too small to see.
const LIFT_M: f32 = 0.05;

/// The draw list of the same picture with a texture in place of the ground map, a ground that is cut out under opaque
/// drapes, and normals at every vertex. Items without triangles are dropped. `watch` says how many items are ready.
pub fn prepare(mut list: DrawList, watch: &StopFlag) -> DrawList {
    let baked = list.ground.as_deref().map(bake);
    let meshes: Vec<Option<DrawMesh>> = {
        let drapes = opaque_drapes(&list);
        watch.stretch(0.0..1.0, list.items.len());
        let prepared = |item: &DrawItem| {
            let mesh = prepared_mesh(&list, item, baked.as_ref(), &drapes);
            watch.did(1);
            mesh
        };
        list.items.par_iter().map(prepared).collect()
    };
    if let Some(baked) = baked {
        let texture = Some(list.add_texture(baked.pixels));
        for material in &mut list.materials {
            material.normals = NormalSource::Vertex;
            if material.albedo == Albedo::GroundMap {
                (material.albedo, material.texture) = (Albedo::Surface, texture);
                material.base_color = Srgba::WHITE;
            }
        }
    }
    let items = std::mem::take(&mut list.items);
    for (item, mesh) in items.into_iter().zip(meshes) {
        match mesh {
            Some(mesh) => {
                // The mesh it replaces is not written; freeing it bounds the memory.
                list.meshes[item.mesh.0 as usize] = DrawMesh::default();
                let triangles = 0..mesh.triangles.len() as u32;
                let mesh = list.add_mesh(mesh);
                list.items.push(DrawItem { mesh, triangles, ..item });
            }
            None => list.items.push(item),
        }
    }
    list.items.retain(|item| !item.triangles.is_empty());
    list.ground = None;
    list
}

/// The drapes that hide the ground.
fn opaque_drapes(list: &DrawList) -> Vec<&DrawMesh> {
    let is_opaque =
        |item: &&DrawItem| matches!(item.layer, DepthLayer::Draped(_)) && !is_translucent(list, item);
    list.items.iter().filter(is_opaque).map(|item| &list.meshes[item.mesh.0 as usize]).collect()
}

fn is_translucent(list: &DrawList, item: &DrawItem) -> bool {
    list.materials[item.material.0 as usize].alpha == AlphaMode::Blend
}

/// The item's mesh where it differs from the list's.
fn prepared_mesh(
    list: &DrawList,
    item: &DrawItem,
    baked: Option<&BakedGround>,
    drapes: &[&DrawMesh],
) -> Option<DrawMesh> {
    let mesh = &list.meshes[item.mesh.0 as usize];
    let material = &list.materials[item.material.0 as usize];
    let mut prepared = match item.layer {
        DepthLayer::Ground => cut_out(mesh, drapes.iter().copied()),
        DepthLayer::Draped(_) => mesh.clone(),
        DepthLayer::Solid => return None,
    };
    let is_lifted = matches!(item.layer, DepthLayer::Draped(_)) && is_translucent(list, item);
    for vertex in &mut prepared.vertices {
        let at = Vec3::from(vertex.position).truncate();
        if let (Albedo::GroundMap, Some(baked)) = (material.albedo, baked) {
            vertex.uv = baked.uv(at).to_array();
        }
        if let (NormalSource::Ground, Some(map)) = (material.normals, list.ground.as_deref()) {
            vertex.normal = map.sample(at).normal().to_array();
        }
        if is_lifted {
            vertex.position[2] += LIFT_M;
        }
    }
    Some(prepared)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use glam::{Mat4, Vec2};
    use sandtable_draw::ground::{GroundMap, GroundPost};
    use sandtable_draw::list::{DrawVertex, FeatureId};
    use sandtable_draw::material::Material;
    use sandtable_mesh::sink::MeshSink;

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
            cell: Vec2::splat(10.0),
            columns: 3,
            rows: 3,
            posts: (0..9).map(post).collect(),
            ..GroundMap::level()
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
        let at =
            |id: sandtable_mesh::sink::VertexId| Vec3::from(mesh.vertices[id.index()].position).truncate();
        mesh.triangles.iter().map(|&[a, b, c]| (at(b) - at(a)).perp_dot(at(c) - at(a)) / 2.0).sum()
    }

    #[test]
    fn the_ground_is_cut_out_under_a_road_and_keeps_its_map_and_its_slope() {
        let ready = prepare(list(AlphaMode::Opaque), &StopFlag::default());
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
    fn translucent_drapes_lie_a_little_above_the_ground() {
        let ready = prepare(list(AlphaMode::Blend), &StopFlag::default());
        assert!((area(&ready, 0) - 400.0).abs() < 1e-2);
        let road = &ready.meshes[ready.items[1].mesh.0 as usize];
        assert!((road.vertices[0].position[2] - (2.5 + LIFT_M)).abs() < 1e-5);
    }
}

//! The project's own models: as committed they are what their program writes, and they read as they should.

#[path = "../tools/models/mod.rs"]
mod models;

use std::path::PathBuf;

use glam::Vec3;
use sandtable_geom::aabb::Aabb;
use sandtable_model::error::CompanionError;
use sandtable_model::read::read;
use sandtable_model::{Census, Companions, Model};

fn folder() -> PathBuf {
    concat!(env!("SANDTABLE_ROOT"), "assets/models").into()
}

struct Assets;

impl Companions for Assets {
    fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
        Ok(std::fs::read(folder().join(name))?)
    }
}

fn asset(name: &str) -> Model {
    let bytes = Assets.load(name).expect("the asset is there");
    read(name, &bytes, &Assets).expect("the asset can be read")
}

#[test]
fn committed_models_are_what_their_program_writes() {
    for (name, bytes) in models::files() {
        let there = Assets.load(name).expect("the asset is there");
        assert!(there == bytes, "{name} differs; cargo run --example make-models writes it anew");
    }
}

#[test]
fn every_model_reads_with_its_census() {
    let census = |meshes, vertices, faces, materials| Census { meshes, vertices, faces, materials };
    for (name, expected) in [
        ("watchtower.3ds", census(4, 941, 1180, 4)),
        ("farmhouse.obj", census(6, 664, 499, 7)),
        ("bridge.glb", census(8, 2552, 1272, 4)),
        ("tent.glb", census(4, 493, 245, 4)),
        ("firtree.obj", census(2, 116, 115, 3)),
        ("truck.3ds", census(4, 314, 488, 6)),
    ] {
        let model = asset(name);
        assert_eq!(model.census, expected, "{name}");
        assert_eq!(model.notes, Vec::<String>::new(), "{name}");
    }
}

#[test]
fn every_model_stands_on_the_ground_in_meters() {
    for (name, low, high) in [
        ("watchtower.3ds", Vec3::new(-3.0, -3.7, -0.5), Vec3::new(3.0, 3.0, 12.5)),
        ("farmhouse.obj", Vec3::new(-6.6, -6.0, -0.7), Vec3::new(6.6, 4.6, 8.5)),
        ("bridge.glb", Vec3::new(-5.0, -20.1, -4.1), Vec3::new(5.0, 20.1, 4.3)),
        ("tent.glb", Vec3::new(-4.0, -5.4, -0.1), Vec3::new(4.0, 5.4, 3.2)),
        ("firtree.obj", Vec3::new(-2.2, -2.2, -0.5), Vec3::new(2.2, 2.2, 9.1)),
        ("truck.3ds", Vec3::new(-1.3, -3.6, 0.0), Vec3::new(1.3, 3.6, 3.1)),
    ] {
        let Aabb { min, max } = asset(name).bounds().expect("it has vertices");
        assert!(min.cmpge(low).all() && max.cmple(high).all(), "{name}: {min} to {max}");
        assert!(
            (min - low).max_element() < 0.35 && (high - max).max_element() < 0.35,
            "{name}: {min} to {max}"
        );
    }
}

#[test]
fn the_nodes_of_the_truck_set_six_wheels() {
    let truck = asset("truck.3ds");
    assert_eq!(truck.triangle_count(), 1008);
    let wheels = truck.parts.iter().filter(|part| part.name == "wheel");
    assert_eq!(wheels.count(), 12, "a tire and a hub each");
}

#[test]
fn colors_survive_all_three_formats() {
    let color = |name: &str, material: &str| {
        let model = asset(name);
        model.materials.iter().find(|each| each.name == material).expect("the material is there").base_color
    };
    assert_eq!(color("watchtower.3ds", "planks").0, [168, 128, 82, 255]);
    assert_eq!(color("farmhouse.obj", "tiles").0, [172, 62, 44, 255]);
    assert_eq!(color("bridge.glb", "stone").0, [158, 148, 132, 255]);
}

#[test]
fn textures_come_from_beside_the_model_and_from_within() {
    for name in ["farmhouse.obj", "tent.glb"] {
        let model = asset(name);
        assert_eq!((model.textures.len(), model.textures[0].width()), (1, 64), "{name}");
        assert_eq!(model.materials[0].texture.map(|id| id.0), Some(0), "{name}");
    }
}

/// A solid's triangles, seen from far outside, show their fronts: the volume they enclose is positive.
#[test]
fn surfaces_face_outward() {
    for name in ["watchtower.3ds", "farmhouse.obj", "bridge.glb", "firtree.obj", "truck.3ds"] {
        let mut volume = 0.0;
        for part in asset(name).parts {
            let at = |id: sandtable_mesh::sink::VertexId| Vec3::from(part.mesh.vertices[id.index()].position);
            let corners = part.mesh.triangles.iter().map(|triangle| triangle.map(at));
            volume += corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum::<f32>();
        }
        assert!(volume > 1.0, "{name}: {volume} cubic meters");
    }
}

//! Makes a [`Model`] from the objects, materials and nodes of a 3DS file.
//!
//! Vertices are stored in the editor's world. They go to their object's axes (the inverse of the mesh matrix, mirrored
//! along X where that matrix mirrors: 3D Studio stores mirrored objects so), from there relative to the node's pivot,
//! and out through the node. An object without a node stays as stored.

use std::collections::BTreeMap;

use glam::{Mat4, Vec2, Vec3};

use crate::error::ModelError;
use crate::material::{MappedMaterial, unnamed_material};
use crate::normals::{Smoothing, corner_normals};
use crate::part::{ModelCorner, PartBuilder, TriangleBudget};
use crate::texture::Textures;
use crate::{Census, Companions, Model};
use sandtable_base::message::numbers::counted;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::MaterialId;
use sandtable_draw::material::Material;

use super::ThreeDsFile;
use super::keyframer::world_from_nodes;
use super::material::{MapChunk, MaterialChunk};
use super::mesh::TriObject;

#[derive(Clone, Copy, Debug)]
struct MapUvTransform {
    scale: Vec2,
    offset: Vec2,
    /// Cosine and sine of the rotation about the middle of the unit square.
    rotation: Vec2,
}

impl MapUvTransform {
    const IDENTITY: Self = Self { scale: Vec2::ONE, offset: Vec2::ZERO, rotation: Vec2::X };

    fn new(map: &MapChunk) -> Self {
        let (sin, cos) = libm::sincosf(map.rotation_rad);
        Self { scale: map.scale, offset: map.offset, rotation: Vec2::new(cos, sin) }
    }

    /// From V upward to V downward.
    fn apply(self, uv: Vec2) -> Vec2 {
        let uv = uv * self.scale + self.offset;
        // Coordinates rotate against the picture.
        let rotated = || Vec2::new(self.rotation.x, -self.rotation.y).rotate(uv - 0.5) + 0.5;
        let uv = if self.rotation == Vec2::X { uv } else { rotated() };
        Vec2::new(uv.x, 1.0 - uv.y)
    }
}

#[derive(Debug, Default)]
struct Palette<'a> {
    by_name: BTreeMap<&'a str, usize>,
    uv_transforms: Vec<MapUvTransform>,
}

pub(super) fn assemble(file: &ThreeDsFile, companions: &dyn Companions) -> Result<Model, ModelError> {
    let mut textures = Textures::new(companions);
    let mut model = Model { census: census(file), ..Model::default() };
    let mut palette = Palette::default();
    for (index, stored) in file.materials.iter().enumerate() {
        model.materials.push(translate(stored, &mut textures));
        let map = stored.map.as_ref().or(stored.opacity_map.as_ref());
        palette.uv_transforms.push(map.map_or(MapUvTransform::IDENTITY, MapUvTransform::new));
        palette.by_name.entry(&stored.name).or_insert(index);
    }
    let mut budget = TriangleBudget::default();
    let mut dropped = 0;
    for placed in placed_objects(file) {
        budget.take(placed.object.faces.len().max(placed.object.positions.len()))?;
        dropped += placed.add_to(&mut model, &palette);
    }
    if dropped > 0 {
        model.notes.push(format!(
            "{} a vertex that is missing or not finite",
            counted(dropped, "face has", "faces have")
        ));
    }
    textures.move_to(&mut model);
    Ok(model)
}

fn census(file: &ThreeDsFile) -> Census {
    Census {
        meshes: file.objects.iter().filter(|object| !object.faces.is_empty()).count(),
        vertices: file.objects.iter().map(|object| object.positions.len()).sum(),
        faces: file.objects.iter().map(|object| object.faces.len()).sum(),
        materials: file.materials.len(),
    }
}

fn translate(stored: &MaterialChunk, textures: &mut Textures<'_>) -> Material {
    let file = |map: &Option<MapChunk>| map.as_ref().map(|map| map.file.clone());
    let name = &stored.name;
    if stored.map.as_ref().is_some_and(|map| map.is_decal) {
        textures.note(format!(
            "the picture of material '{name}' is a decal: beyond its borders its own border goes on, not the material's color"
        ));
    }
    if let (Some(map), Some(mask)) = (&stored.map, &stored.opacity_map)
        && (map.scale, map.offset, map.rotation_rad) != (mask.scale, mask.offset, mask.rotation_rad)
    {
        textures.note(format!(
            "the opacity map of material '{name}' lies like its color map, not in its own place"
        ));
    }
    let mapped = MappedMaterial {
        name: stored.name.clone(),
        color: stored.diffuse,
        // 3D Studio paints the map over the diffuse color.
        color_under_map: Srgba::WHITE,
        alpha: 255 - (stored.transparency * 255.0 + 0.5) as u8,
        map: file(&stored.map),
        opacity_map: file(&stored.opacity_map),
        two_sided: stored.two_sided,
    };
    mapped.load(textures)
}

struct PlacedObject<'a> {
    object: &'a TriObject,
    world_from_stored: Mat4,
}

/// Every object in every place that a node gives it.
fn placed_objects(file: &ThreeDsFile) -> Vec<PlacedObject<'_>> {
    let mut by_name = BTreeMap::new();
    for (index, object) in file.objects.iter().enumerate() {
        by_name.entry(object.name.as_str()).or_insert(index);
    }
    let mut has_node = vec![false; file.objects.len()];
    let mut placed = Vec::new();
    for (node, world_from_node) in file.nodes.iter().zip(world_from_nodes(&file.nodes)) {
        if let Some(&index) = by_name.get(node.object.as_str()) {
            has_node[index] = true;
            let object = &file.objects[index];
            let node_from_stored = Mat4::from_translation(-node.pivot) * object_from_stored(object);
            placed.push(PlacedObject { object, world_from_stored: world_from_node * node_from_stored });
        }
    }
    let loose = file.objects.iter().zip(has_node).filter(|&(_, has_node)| !has_node);
    placed.extend(loose.map(|(object, _)| PlacedObject { object, world_from_stored: Mat4::IDENTITY }));
    placed
}

fn object_from_stored(object: &TriObject) -> Mat4 {
    let determinant = object.world_from_object.determinant();
    if !determinant.is_finite() || determinant == 0.0 {
        return Mat4::IDENTITY;
    }
    let mirror = if determinant < 0.0 { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
    Mat4::from_scale(mirror) * object.world_from_object.inverse()
}

impl PlacedObject<'_> {
    /// Adds the object's parts to the model; returns how many faces could not be drawn.
    fn add_to(&self, model: &mut Model, palette: &Palette<'_>) -> usize {
        let Self { object, world_from_stored } = self;
        let positions: Vec<Vec3> =
            object.positions.iter().map(|&position| world_from_stored.transform_point3(position)).collect();
        let is_drawable = |id: &u16| positions.get(usize::from(*id)).is_some_and(|at| at.is_finite());
        let drawn: Vec<usize> =
            (0..object.faces.len()).filter(|&face| object.faces[face].iter().all(is_drawable)).collect();
        let mirrors = world_from_stored.determinant() < 0.0;
        let triangle = |&face: &usize| {
            let [a, b, c] = object.faces[face].map(u32::from);
            if mirrors { [a, c, b] } else { [a, b, c] }
        };
        let triangles: Vec<[u32; 3]> = drawn.iter().map(triangle).collect();
        let group = |&face: &usize| object.smoothing.get(face).copied().unwrap_or(0);
        let groups: Vec<u32> = drawn.iter().map(group).collect();
        let smoothing =
            if object.smoothing.is_empty() { Smoothing::Flat } else { Smoothing::Groups(&groups) };
        let normals = corner_normals(&positions, &triangles, smoothing);
        let materials = face_materials(object, palette, model);
        let mut parts = PartBuilder::new(&object.name);
        for ((&face, ids), normals) in drawn.iter().zip(&triangles).zip(&normals) {
            let material = materials[face];
            let uv_transform = palette.uv_transforms.get(material.0 as usize);
            let uv_transform = uv_transform.copied().unwrap_or(MapUvTransform::IDENTITY);
            let corner = |place: usize| {
                let id = ids[place] as usize;
                let uv = object.uvs.get(id).filter(|uv| uv.is_finite());
                let uv = uv.map_or(Vec2::ZERO, |&uv| uv_transform.apply(uv));
                ModelCorner { position: positions[id], normal: normals[place], uv, color: Srgba::WHITE }
            };
            parts.triangle(material, [corner(0), corner(1), corner(2)]);
        }
        model.parts.extend(parts.finish());
        object.faces.len() - drawn.len()
    }
}

/// The material of every face. Faces without one share a default, which is added where it is needed.
fn face_materials(object: &TriObject, palette: &Palette<'_>, model: &mut Model) -> Vec<MaterialId> {
    let mut ids: Vec<Option<MaterialId>> = vec![None; object.faces.len()];
    for group in &object.groups {
        let name = &group.material;
        let Some(&material) = palette.by_name.get(name.as_str()) else {
            model.notes.push(format!("material '{name}' is used by '{}' but not defined", object.name));
            continue;
        };
        for &face in &group.faces {
            if let Some(id) = ids.get_mut(usize::from(face)) {
                *id = Some(MaterialId(material as u32));
            }
        }
    }
    let default = ids.iter().any(Option::is_none).then(|| default_material(model));
    ids.into_iter().map(|id| id.or(default).unwrap_or(MaterialId(0))).collect()
}

fn default_material(model: &mut Model) -> MaterialId {
    const NAME: &str = "(no material)";
    let known = model.materials.iter().position(|material| material.name == NAME);
    let index = known.unwrap_or_else(|| {
        model.materials.push(unnamed_material(NAME));
        model.materials.len() - 1
    });
    MaterialId(index as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::MapFile;

    #[test]
    fn a_map_turned_by_a_right_angle_shows_its_lower_left_corner_at_the_lower_right() {
        let map = MapChunk {
            file: MapFile::default(),
            is_decal: false,
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            rotation_rad: std::f32::consts::FRAC_PI_2,
        };
        let lower_left = MapUvTransform::IDENTITY.apply(Vec2::ZERO);
        assert!(MapUvTransform::new(&map).apply(Vec2::X).abs_diff_eq(lower_left, 1e-6));
    }

    #[test]
    fn an_unturned_map_keeps_every_bit_of_common_coordinates() {
        for uv in [Vec2::ZERO, Vec2::new(0.25, 0.75), Vec2::ONE] {
            assert_eq!(MapUvTransform::IDENTITY.apply(uv), Vec2::new(uv.x, 1.0 - uv.y));
        }
    }
}

//! A 3DS file's objects, materials and nodes to a [`Model`].
//!
//! The way of a vertex, stored in the editor's world: into its object's own axes (the inverse of the mesh
//! matrix; mirrored along X where that matrix mirrors, which is how 3D Studio stores mirrored objects),
//! relative to its node's pivot, and out through the node. An object without a node stays as stored.

use std::collections::BTreeMap;

use glam::{Mat4, Vec2, Vec3};

use crate::draw::color::Srgba;
use crate::draw::list::MaterialId;
use crate::draw::material::{AlphaMode, Material};
use crate::model::error::ModelError;
use crate::model::normals::{Smoothing, corner_normals};
use crate::model::part::{Budget, ModelCorner, PartBuilder};
use crate::model::texture::Textures;
use crate::model::{Census, Companions, Model};

use super::ThreeDsFile;
use super::keyframer::world_from_nodes;
use super::material::{Map, MaterialChunk};
use super::mesh::TriObject;

/// How texture coordinates of a material are changed before use.
#[derive(Clone, Copy, Debug)]
struct MapUvTransform {
    scale: Vec2,
    offset: Vec2,
    /// Cosine and sine of the picture's turn about the middle of the square of coordinates.
    turn: Vec2,
}

impl MapUvTransform {
    const NONE: Self = Self { scale: Vec2::ONE, offset: Vec2::ZERO, turn: Vec2::X };

    fn of(map: &Map) -> Self {
        let (sin, cos) = libm::sincosf(map.turn_rad);
        Self { scale: map.scale, offset: map.offset, turn: Vec2::new(cos, sin) }
    }

    /// From V upward to V downward.
    fn apply(self, uv: Vec2) -> Vec2 {
        let uv = uv * self.scale + self.offset;
        let from_middle = uv - 0.5;
        // Where the picture turns one way, places on it are found by turning the other.
        let turned = || Vec2::new(self.turn.x, -self.turn.y).rotate(from_middle) + 0.5;
        let uv = if self.turn == Vec2::X { uv } else { turned() };
        Vec2::new(uv.x, 1.0 - uv.y)
    }
}

/// What faces need to know of the file's materials.
#[derive(Debug, Default)]
struct Palette<'a> {
    by_name: BTreeMap<&'a str, usize>,
    changes: Vec<MapUvTransform>,
}

/// The model of a parsed file.
pub(super) fn assemble(file: ThreeDsFile, companions: &dyn Companions) -> Result<Model, ModelError> {
    let mut textures = Textures::new(companions);
    let mut model = Model { census: census(&file), ..Model::default() };
    let mut palette = Palette::default();
    for (index, described) in file.materials.iter().enumerate() {
        let (material, change) = translate(described, &mut textures);
        model.materials.push(material);
        palette.changes.push(change);
        palette.by_name.entry(&described.name).or_insert(index);
    }
    let mut budget = Budget::default();
    let mut dropped = 0;
    for (object, world_from_stored) in placed(&file) {
        budget.take(object.faces.len().max(object.positions.len()))?;
        dropped += draw(object, world_from_stored, &palette, &mut model);
    }
    if dropped > 0 {
        model.notes.push(format!("{dropped} faces name a vertex that is not there or not finite"));
    }
    let (pixels, notes) = textures.finish();
    model.textures = pixels;
    model.notes.extend(notes);
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

fn translate(described: &MaterialChunk, textures: &mut Textures<'_>) -> (Material, MapUvTransform) {
    let [painted, mask] = [&described.map, &described.opacity_map]
        .map(|map| map.as_ref().and_then(|map| textures.by_name(&map.file)));
    // 3D Studio paints the map over the diffuse color.
    let mut base_color = if painted.is_some() { Srgba::WHITE } else { described.diffuse };
    let texture = mask.map_or(painted, |mask| textures.masked(painted, mask));
    base_color.0[3] = 255 - (described.transparency * 255.0 + 0.5) as u8;
    let alpha = match texture {
        _ if base_color.0[3] < 255 => AlphaMode::Blend,
        Some(id) if textures.is_cut_out(id) => AlphaMode::Mask(0.5),
        _ => AlphaMode::Opaque,
    };
    let material = Material {
        name: described.name.clone(),
        base_color,
        texture,
        alpha,
        two_sided: described.two_sided,
        ..Material::default()
    };
    let laid = described.map.as_ref().or(described.opacity_map.as_ref());
    let change = laid.map_or(MapUvTransform::NONE, MapUvTransform::of);
    (material, change)
}

/// Every object with every place it stands in.
fn placed(file: &ThreeDsFile) -> Vec<(&TriObject, Mat4)> {
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
            let node_from_stored = Mat4::from_translation(-node.pivot) * own_from_stored(object);
            placed.push((object, world_from_node * node_from_stored));
        }
    }
    let loose = file.objects.iter().zip(has_node).filter(|&(_, has_node)| !has_node);
    placed.extend(loose.map(|(object, _)| (object, Mat4::IDENTITY)));
    placed
}

fn own_from_stored(object: &TriObject) -> Mat4 {
    let determinant = object.world_from_own.determinant();
    if !determinant.is_finite() || determinant == 0.0 {
        return Mat4::IDENTITY;
    }
    let mirrored = if determinant < 0.0 { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
    Mat4::from_scale(mirrored) * object.world_from_own.inverse()
}

/// Adds an object's parts to the model; returns how many faces could not be drawn.
fn draw(object: &TriObject, world_from_stored: Mat4, palette: &Palette<'_>, model: &mut Model) -> usize {
    let positions: Vec<Vec3> =
        object.positions.iter().map(|&position| world_from_stored.transform_point3(position)).collect();
    let drawn: Vec<usize> = (0..object.faces.len())
        .filter(|&face| {
            object.faces[face]
                .iter()
                .all(|&id| positions.get(usize::from(id)).is_some_and(|position| position.is_finite()))
        })
        .collect();
    let mirrors = world_from_stored.determinant() < 0.0;
    let triangles: Vec<[u32; 3]> = drawn
        .iter()
        .map(|&face| {
            let [a, b, c] = object.faces[face].map(u32::from);
            if mirrors { [a, c, b] } else { [a, b, c] }
        })
        .collect();
    let normals = corner_normals_of(object, &drawn, &positions, &triangles);
    let materials = materials_of(object, palette, model);
    let mut parts = PartBuilder::new(&object.name);
    for ((&face, ids), normals) in drawn.iter().zip(&triangles).zip(&normals) {
        let material = materials[face];
        let change = palette.changes.get(material.0 as usize).copied().unwrap_or(MapUvTransform::NONE);
        let corner = |corner: usize| {
            let id = ids[corner] as usize;
            let uv =
                object.uvs.get(id).filter(|uv| uv.is_finite()).map_or(Vec2::ZERO, |&uv| change.apply(uv));
            ModelCorner { position: positions[id], normal: normals[corner], uv, color: Srgba::WHITE }
        };
        parts.triangle(material, [corner(0), corner(1), corner(2)]);
    }
    model.parts.extend(parts.finish());
    object.faces.len() - drawn.len()
}

fn corner_normals_of(
    object: &TriObject,
    drawn: &[usize],
    positions: &[Vec3],
    triangles: &[[u32; 3]],
) -> Vec<[Vec3; 3]> {
    let masks: Vec<u32> =
        drawn.iter().map(|&face| object.smoothing.get(face).copied().unwrap_or(0)).collect();
    let smoothing = if object.smoothing.is_empty() { Smoothing::Flat } else { Smoothing::Groups(&masks) };
    corner_normals(positions, triangles, smoothing)
}

/// The material of every face; faces without one share a default that is added where needed.
fn materials_of(object: &TriObject, palette: &Palette<'_>, model: &mut Model) -> Vec<MaterialId> {
    let mut ids: Vec<Option<MaterialId>> = vec![None; object.faces.len()];
    for (name, faces) in &object.groups {
        let Some(&material) = palette.by_name.get(name.as_str()) else {
            model.notes.push(format!("material '{name}' is used by '{}' but not defined", object.name));
            continue;
        };
        for &face in faces {
            if let Some(id) = ids.get_mut(usize::from(face)) {
                *id = Some(MaterialId(material as u32));
            }
        }
    }
    let default = ids.iter().any(Option::is_none).then(|| default_material(model));
    ids.into_iter().map(|id| id.or(default).unwrap_or(MaterialId(0))).collect()
}

/// What is drawn where a file names no material: light gray, both sides.
fn default_material(model: &mut Model) -> MaterialId {
    let name = "(no material)";
    let index = model.materials.iter().position(|material| material.name == name).unwrap_or_else(|| {
        model.materials.push(Material {
            name: name.into(),
            base_color: Srgba::opaque(190, 190, 190),
            two_sided: true,
            ..Material::default()
        });
        model.materials.len() - 1
    });
    MaterialId(index as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_turned_by_a_right_angle_shows_its_lower_left_corner_at_the_lower_right() {
        let map = Map {
            file: String::new(),
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            turn_rad: std::f32::consts::FRAC_PI_2,
        };
        let lower_left = MapUvTransform::NONE.apply(Vec2::ZERO);
        assert!(MapUvTransform::of(&map).apply(Vec2::X).abs_diff_eq(lower_left, 1e-6));
    }

    #[test]
    fn an_unturned_map_keeps_every_bit_of_common_coordinates() {
        for uv in [Vec2::ZERO, Vec2::new(0.25, 0.75), Vec2::ONE] {
            assert_eq!(MapUvTransform::NONE.apply(uv), Vec2::new(uv.x, 1.0 - uv.y));
        }
    }
}

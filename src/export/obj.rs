//! A draw list as Wavefront OBJ with its material library and textures.
//!
//! Coordinates are meters, X east, Y north, Z up. Every item is an object with vertices of its own: the format has no
//! instances.

use std::collections::BTreeSet;
use std::io::{self, Write};

use glam::{Mat3, Vec2, Vec3};

use crate::SceneExport;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawItem, DrawList, DrawVertex, MaterialId};
use sandtable_draw::material::{AlphaMode, TextureId};
use sandtable_files::png::encode_png;
use sandtable_mesh::sink::VertexId;
use sandtable_mesh::write::obj::{ObjObject, ObjWriter, word};

/// A file that an OBJ file needs beside it.
#[derive(Clone, Debug)]
pub struct ObjCompanion {
    /// Its name, without a folder.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// The textures and the material library of the OBJ file called `stem`, in the order in which they are to be written.
pub fn companions(list: &DrawList, stem: &str) -> Vec<ObjCompanion> {
    let texture = |id: TextureId| ObjCompanion {
        name: texture_name(stem, id),
        bytes: encode_png(&list.textures[id.0 as usize]),
    };
    let library = ObjCompanion { name: library_name(stem), bytes: library(list, stem).into_bytes() };
    textures(list).into_iter().map(texture).chain([library]).collect()
}

fn library_name(stem: &str) -> String {
    format!("{stem}.mtl")
}

fn texture_name(stem: &str, id: TextureId) -> String {
    format!("{stem}_{}.png", id.0)
}

fn material_name(list: &DrawList, MaterialId(id): MaterialId) -> String {
    format!("{}_{id}", word(&list.materials[id as usize].name))
}

fn materials(list: &DrawList) -> BTreeSet<MaterialId> {
    list.items.iter().map(|item| item.material).collect()
}

fn textures(list: &DrawList) -> BTreeSet<TextureId> {
    let texture = |id: MaterialId| list.materials[id.0 as usize].texture;
    let has_pixels = |id: &TextureId| !list.textures[id.0 as usize].data().is_empty();
    materials(list).into_iter().filter_map(texture).filter(has_pixels).collect()
}

fn library(list: &DrawList, stem: &str) -> String {
    let textures = textures(list);
    let mut text = String::new();
    for id in materials(list) {
        let material = &list.materials[id.0 as usize];
        let Vec3 { x: red, y: green, z: blue } = srgb(material.base_color);
        text += &format!("newmtl {}\nKa 0 0 0\nKd {red} {green} {blue}\nKs 0 0 0\n", material_name(list, id));
        if material.alpha != AlphaMode::Opaque {
            text += &format!("d {}\n", material.base_color.alpha());
        }
        if let Some(texture) = material.texture.filter(|texture| textures.contains(texture)) {
            let name = texture_name(stem, texture);
            text += &format!("map_Kd {name}\n");
            if material.alpha != AlphaMode::Opaque {
                text += &format!("map_d {name}\n");
            }
        }
        text.push('\n');
    }
    text
}

/// The channels in 0..=1.
fn srgb(color: Srgba) -> Vec3 {
    let [red, green, blue, _] = color.0.map(|channel| f32::from(channel) / 255.0);
    Vec3::new(red, green, blue)
}

/// Writes the OBJ file called `stem`.
///
/// # Errors
/// `out` cannot be written.
pub fn write(export: &SceneExport<'_>, stem: &str, out: &mut impl Write) -> io::Result<()> {
    let mut writer = ObjWriter::new(out, export.remarks, Some(&library_name(stem)))?;
    let objects = export.list.items.iter().map(|item| object(export, item));
    objects.filter(|object| !object.triangles.is_empty()).try_for_each(|object| writer.object(&object))
}

/// The vertices that `item` uses, in world space, and its triangles.
fn object(export: &SceneExport<'_>, item: &DrawItem) -> ObjObject<'static> {
    let mesh = export.mesh(item);
    let mut ids: Vec<Option<VertexId>> = vec![None; mesh.vertices.len()];
    export.triangles(item).flatten().for_each(|id| ids[id.index()] = Some(VertexId(0)));
    ids.iter_mut().flatten().enumerate().for_each(|(place, id)| *id = VertexId::new(place));
    let used = mesh.vertices.iter().zip(&ids).filter_map(|(vertex, id)| id.map(|_| vertex));
    let new_id = |id: VertexId| ids[id.index()].expect("every corner is used");
    let turn = Mat3::from_mat4(item.world_from_mesh);
    let is_colored = used.clone().any(|vertex| vertex.color != Srgba::WHITE);
    let is_textured = export.material(item).texture.is_some();
    let position = |vertex: &DrawVertex| item.world_from_mesh.transform_point3(vertex.position.into());
    let normal = |vertex: &DrawVertex| (turn * Vec3::from(vertex.normal)).normalize_or(Vec3::Z);
    let color = |vertex: &DrawVertex| is_colored.then(|| srgb(vertex.color));
    let uv = |vertex: &DrawVertex| is_textured.then(|| Vec2::new(vertex.uv[0], 1.0 - vertex.uv[1]));
    ObjObject {
        name: (export.name_of)(item.feature),
        material: Some(material_name(export.list, item.material)),
        positions: used.clone().map(position).collect(),
        colors: used.clone().filter_map(color).collect(),
        normals: used.clone().map(normal).collect(),
        uvs: used.filter_map(uv).collect(),
        triangles: export.triangles(item).map(|corners| corners.map(new_id)).collect(),
    }
}

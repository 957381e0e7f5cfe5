//! Wavefront OBJ with its material library and textures: the files that every modeling program reads.
//!
//! Coordinates are meters, X east, Y north, Z up, as [`crate::mesh::write`] has them; a remark at the top says so. Every
//! item is an object with vertices of its own, so that what the list shares is written as often as it is shown.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

use glam::{Mat3, Vec3};

use crate::draw::color::Srgba;
use crate::draw::list::{DrawItem, DrawList, FeatureId, MaterialId};
use crate::draw::material::{AlphaMode, TextureId};
use crate::export::png;

/// The files that belong to an OBJ, by name, in the order in which they are to be written.
pub fn companions(list: &DrawList, stem: &str) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = textures(list)
        .into_iter()
        .filter_map(|id| Some((texture_name(stem, id), png::encode(&list.textures[id.0 as usize])?)))
        .collect();
    files.push((library_name(stem), library(list, stem).into_bytes()));
    files
}

fn library_name(stem: &str) -> String {
    format!("{stem}.mtl")
}

fn texture_name(stem: &str, id: TextureId) -> String {
    format!("{stem}_{}.png", id.0)
}

fn materials(list: &DrawList) -> BTreeSet<MaterialId> {
    list.items.iter().map(|item| item.material).collect()
}

fn textures(list: &DrawList) -> BTreeSet<TextureId> {
    let texture = |id: MaterialId| list.materials[id.0 as usize].texture;
    let is_picture = |id: &TextureId| !list.textures[id.0 as usize].data().is_empty();
    materials(list).into_iter().filter_map(texture).filter(is_picture).collect()
}

fn library(list: &DrawList, stem: &str) -> String {
    let pictures = textures(list);
    let mut text = String::new();
    for id in materials(list) {
        let material = &list.materials[id.0 as usize];
        let [red, green, blue] = material.base_color.0.map(|channel| f32::from(channel) / 255.0)[..3] else {
            continue;
        };
        text += &format!("newmtl {}\nKa 0 0 0\nKd {red} {green} {blue}\nKs 0 0 0\n", material_name(list, id));
        if material.alpha != AlphaMode::Opaque {
            text += &format!("d {}\n", material.base_color.alpha());
        }
        if let Some(texture) = material.texture.filter(|texture| pictures.contains(texture)) {
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

/// Unlike names for unlike materials, without what would end a word.
fn material_name(list: &DrawList, MaterialId(id): MaterialId) -> String {
    format!("{}_{id}", word(&list.materials[id as usize].name))
}

fn word(name: &str) -> String {
    name.chars().map(|at| if at.is_alphanumeric() || "-.".contains(at) { at } else { '_' }).collect()
}

/// Writes a prepared list ([`crate::export::prepare`]) that uses the companions called after `stem`.
///
/// # Errors
/// `out` cannot be written.
pub fn write(
    list: &DrawList,
    (stem, name): (&str, &dyn Fn(FeatureId) -> String),
    remarks: &[String],
    out: &mut impl Write,
) -> io::Result<()> {
    for line in remarks {
        writeln!(out, "# {}", line.replace(char::is_control, "?"))?;
    }
    writeln!(out, "mtllib {}", library_name(stem))?;
    let mut written = ObjCounts::default();
    for item in &list.items {
        written.item(list, item, &name(item.feature), out)?;
    }
    Ok(())
}

/// How many lines of each kind there are.
#[derive(Default)]
struct ObjCounts {
    vertices: usize,
    textured: usize,
    named: BTreeMap<String, usize>,
}

impl ObjCounts {
    fn item(&mut self, list: &DrawList, item: &DrawItem, name: &str, out: &mut impl Write) -> io::Result<()> {
        let mesh = &list.meshes[item.mesh.0 as usize];
        let triangles = &mesh.triangles[item.triangles.start as usize..item.triangles.end as usize];
        let used: BTreeSet<usize> = triangles.iter().flatten().map(|id| id.index()).collect();
        let place: BTreeMap<usize, usize> =
            used.iter().enumerate().map(|(place, &index)| (index, place + 1)).collect();
        let is_textured = list.materials[item.material.0 as usize].texture.is_some();
        let is_colored = used.iter().any(|&index| mesh.vertices[index].color != Srgba::WHITE);
        let turn = Mat3::from_mat4(item.world_from_mesh);
        writeln!(out, "o {}", self.object(name))?;
        for &index in &used {
            let vertex = &mesh.vertices[index];
            let at = item.world_from_mesh.transform_point3(Vec3::from(vertex.position));
            write!(out, "v {} {} {}", at.x, at.y, at.z)?;
            if is_colored {
                let [red, green, blue, _] = vertex.color.0.map(|channel| f32::from(channel) / 255.0);
                write!(out, " {red} {green} {blue}")?;
            }
            writeln!(out)?;
        }
        for &index in &used {
            let normal = (turn * Vec3::from(mesh.vertices[index].normal)).normalize_or(Vec3::Z);
            writeln!(out, "vn {} {} {}", normal.x, normal.y, normal.z)?;
        }
        if is_textured {
            for &index in &used {
                // V runs upward in OBJ.
                let [u, v] = mesh.vertices[index].uv;
                writeln!(out, "vt {u} {}", 1.0 - v)?;
            }
        }
        writeln!(out, "usemtl {}", material_name(list, item.material))?;
        for corners in triangles {
            let [a, b, c] = corners.map(|id| self.corner(place[&id.index()], is_textured));
            writeln!(out, "f {a} {b} {c}")?;
        }
        self.vertices += used.len();
        self.textured += if is_textured { used.len() } else { 0 };
        Ok(())
    }

    fn corner(&self, place: usize, is_textured: bool) -> String {
        let vertex = self.vertices + place;
        if is_textured {
            format!("{vertex}/{}/{vertex}", self.textured + place)
        } else {
            format!("{vertex}//{vertex}")
        }
    }

    /// A name that no object had before.
    fn object(&mut self, name: &str) -> String {
        let name = if name.is_empty() { "unnamed".to_owned() } else { word(name) };
        let count = self.named.entry(name.clone()).or_default();
        *count += 1;
        if *count == 1 { name } else { format!("{name}.{count}") }
    }
}

//! A draw list as Wavefront OBJ with its material library and textures.
//!
//! Coordinates are meters, X east, Y north, Z up. Every item is an object with vertices of its own: the format has no
//! instances.
//!
//! MTL has a word for textures that end at their borders, but none for those that are mirrored there. Such a texture is
//! written together with its mirror image, over which coordinates run half as fast.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::{self, Write};

use glam::{Mat3, Vec2, Vec3};

use crate::SceneExport;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawItem, DrawList, DrawVertex, MaterialId};
use sandtable_draw::material::{AlphaMode, Material, TextureId, TextureWrap};
use sandtable_draw::pixels::Pixels;
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
    let texture = |texture: ObjTexture| ObjCompanion {
        name: texture.file_name(stem),
        bytes: encode_png(&texture.pixels(&list.textures[texture.id.0 as usize])),
    };
    let library = ObjCompanion { name: library_name(stem), bytes: library(list, stem).into_bytes() };
    textures(list).into_iter().map(texture).chain([library]).collect()
}

fn library_name(stem: &str) -> String {
    format!("{stem}.mtl")
}

fn material_name(list: &DrawList, MaterialId(id): MaterialId) -> String {
    format!("{}_{id}", word(&list.materials[id as usize].name))
}

fn materials(list: &DrawList) -> BTreeSet<MaterialId> {
    list.items.iter().map(|item| item.material).collect()
}

fn textures(list: &DrawList) -> BTreeSet<ObjTexture> {
    let texture = |id: MaterialId| ObjTexture::of(list, &list.materials[id.0 as usize]);
    materials(list).into_iter().filter_map(texture).collect()
}

/// A texture file: of a texture as it is, or with its mirror image beside it, below it, or both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ObjTexture {
    id: TextureId,
    /// Along U and along V.
    mirrored: [bool; 2],
}

impl ObjTexture {
    /// The texture of a material; `None` where it has none, or one without pixels.
    fn of(list: &DrawList, material: &Material) -> Option<Self> {
        let id = material.texture.filter(|id| !list.textures[id.0 as usize].data().is_empty())?;
        Some(Self { id, mirrored: material.texture_wrap.map(|wrap| wrap == TextureWrap::Mirror) })
    }

    fn file_name(self, stem: &str) -> String {
        let kind = match self.mirrored {
            [false, false] => "",
            [true, false] => "_mirrored_u",
            [false, true] => "_mirrored_v",
            [true, true] => "_mirrored",
        };
        format!("{stem}_{}{kind}.png", self.id.0)
    }

    fn pixels(self, pixels: &Pixels) -> Cow<'_, Pixels> {
        if self.mirrored == [false, false] {
            return Cow::Borrowed(pixels);
        }
        let sides = [pixels.width(), pixels.height()];
        let [width, height] =
            [0, 1].map(|axis| if self.mirrored[axis] { sides[axis] * 2 } else { sides[axis] });
        let place = |at: u32, side: u32| if at < side { at } else { 2 * side - 1 - at };
        Cow::Owned(Pixels::from_fn(width, height, |x, y| pixels.at(place(x, sides[0]), place(y, sides[1]))))
    }

    /// Coordinates over the file from those over the texture; V runs downward in both.
    fn uv(self, uv: [f32; 2]) -> Vec2 {
        let along = |axis: usize| if self.mirrored[axis] { uv[axis] * 0.5 } else { uv[axis] };
        Vec2::new(along(0), along(1))
    }
}

/// The materials whose textures end at their borders along one axis alone, which the format cannot say, by their names.
pub fn half_clamped(list: &DrawList) -> Vec<String> {
    let is_half_clamped = |id: &MaterialId| {
        let material = &list.materials[id.0 as usize];
        let clamped = material.texture_wrap.map(|wrap| wrap == TextureWrap::Clamp);
        ObjTexture::of(list, material).is_some() && clamped[0] != clamped[1]
    };
    let half = materials(list).into_iter().filter(is_half_clamped);
    half.map(|id| material_name(list, id)).collect()
}

fn library(list: &DrawList, stem: &str) -> String {
    let mut text = String::new();
    for id in materials(list) {
        let material = &list.materials[id.0 as usize];
        let Vec3 { x: red, y: green, z: blue } = srgb(material.base_color);
        text += &format!("newmtl {}\nKa 0 0 0\nKd {red} {green} {blue}\nKs 0 0 0\n", material_name(list, id));
        if material.alpha != AlphaMode::Opaque {
            text += &format!("d {}\n", material.base_color.alpha());
        }
        if let Some(texture) = ObjTexture::of(list, material) {
            let name = texture.file_name(stem);
            let options = if material.texture_wrap == [TextureWrap::Clamp; 2] { "-clamp on " } else { "" };
            text += &format!("map_Kd {options}{name}\n");
            if material.alpha != AlphaMode::Opaque {
                text += &format!("map_d {options}{name}\n");
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
    let texture = ObjTexture::of(export.list, export.material(item));
    let position = |vertex: &DrawVertex| item.world_from_mesh.transform_point3(vertex.position.into());
    let normal = |vertex: &DrawVertex| (turn * Vec3::from(vertex.normal)).normalize_or(Vec3::Z);
    let color = |vertex: &DrawVertex| is_colored.then(|| srgb(vertex.color));
    let uv = |vertex: &DrawVertex| {
        let at = texture?.uv(vertex.uv);
        Some(Vec2::new(at.x, 1.0 - at.y))
    };
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Mat4;
    use sandtable_draw::list::{DepthLayer, DrawMesh, FeatureId};
    use sandtable_mesh::sink::MeshSink;

    /// A triangle with a texture of two pixels, black and white, that goes on as stated.
    fn list(texture_wrap: [TextureWrap; 2]) -> DrawList {
        let mut list = DrawList::default();
        let pixels = Pixels::from_fn(2, 1, |x, _| if x == 0 { Srgba::opaque(0, 0, 0) } else { Srgba::WHITE });
        let texture = Some(list.add_texture(pixels));
        let material =
            list.add_material(Material { name: "wall".into(), texture, texture_wrap, ..Material::default() });
        let mut mesh = DrawMesh::default();
        let corners = [[0.0, 0.0], [1.5, 0.0], [0.0, 1.0]].map(|uv| {
            let (position, normal) = ([uv[0], uv[1], 0.0], [0.0, 0.0, 1.0]);
            mesh.vertex(DrawVertex { position, normal, uv, color: Srgba::WHITE })
        });
        mesh.triangle(corners);
        let (mesh, world_from_mesh) = (list.add_mesh(mesh), Mat4::IDENTITY);
        let (layer, feature) = (DepthLayer::Solid, FeatureId::GROUND);
        list.items.push(DrawItem { mesh, triangles: 0..1, material, world_from_mesh, layer, feature });
        list
    }

    #[test]
    fn a_mirrored_texture_is_written_with_its_mirror_image() {
        let list = list([TextureWrap::Mirror, TextureWrap::Repeat]);
        let texture = ObjTexture::of(&list, &list.materials[0]).expect("a texture");
        let pixels = texture.pixels(&list.textures[0]);
        let row: Vec<u8> = (0..pixels.width()).map(|x| pixels.at(x, 0).0[0]).collect();
        assert_eq!((row, pixels.height()), (vec![0, 255, 255, 0], 1));
        assert_eq!(texture.uv([1.5, 1.0]), Vec2::new(0.75, 1.0));
        assert!(library(&list, "out").contains("map_Kd out_0_mirrored_u.png\n"), "{}", library(&list, "out"));
        assert!(half_clamped(&list).is_empty());
    }

    #[test]
    fn a_texture_that_ends_at_its_borders_is_clamped_and_half_a_clamp_is_named() {
        let clamped = list([TextureWrap::Clamp; 2]);
        assert!(library(&clamped, "out").contains("map_Kd -clamp on out_0.png\n"));
        assert!(half_clamped(&clamped).is_empty());
        let half = list([TextureWrap::Clamp, TextureWrap::Repeat]);
        assert!(library(&half, "out").contains("map_Kd out_0.png\n"));
        assert_eq!(half_clamped(&half), ["wall_0"]);
    }
}

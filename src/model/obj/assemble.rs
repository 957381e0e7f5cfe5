//! A checked OBJ file and its libraries to a [`Model`].

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use crate::draw::color::Srgba;
use crate::draw::list::MaterialId;
use crate::draw::material::{AlphaMode, Material};
use crate::model::error::ModelError;
use crate::model::normals::{CREASE_COS, Smoothing, corner_normals};
use crate::model::part::{Budget, ModelCorner, PartBuilder};
use crate::model::texture::{Textures, load_any};
use crate::model::triangulate::triangulate;
use crate::model::{Census, Companions, Model};

use super::mtl::{self, Stated};
use super::plain::{ObjFace, Plain};
use super::text;

/// The model of a checked file.
pub(super) fn assemble(plain: &Plain, companions: &dyn Companions) -> Result<Model, ModelError> {
    let mut model = Model::default();
    let stated = libraries(plain, companions, &mut model.notes);
    let used = materials(plain, &stated, companions, &mut model);
    let options = tobj::LoadOptions::default();
    let no_library = |_: &std::path::Path| Ok(Default::default());
    let (objects, _) = tobj::load_obj_buf(&mut plain.text.as_bytes(), &options, no_library)
        .map_err(|error| ModelError::obj(1, error.to_string()))?;
    let mut faces = plain.faces.iter();
    let mut budget = Budget::default();
    let mut left_out = plain.stated_faces - plain.faces.len();
    let mut meshes = 0;
    for object in &objects {
        let polygons = polygons(&object.mesh, &mut faces);
        meshes += usize::from(!polygons.is_empty());
        let shape = ObjShape::new(&object.mesh, polygons, plain.says_smoothing);
        budget.take(shape.triangles.len())?;
        left_out += shape.left_out;
        let mut parts = PartBuilder::new(&object.name);
        shape.draw(&used, &mut parts);
        model.parts.extend(parts.finish());
    }
    model.census = Census {
        meshes,
        vertices: plain.vertices,
        faces: plain.stated_faces,
        materials: model.materials.len(),
    };
    note_what_is_missing(plain, left_out, &mut model);
    Ok(model)
}

fn note_what_is_missing(plain: &Plain, left_out: usize, model: &mut Model) {
    if left_out > 0 {
        model.notes.push(format!("{left_out} faces have fewer than three corners or one that is not finite"));
    }
    if plain.points_and_lines > 0 {
        model.notes.push(format!("{} points and lines are not drawn", plain.points_and_lines));
    }
}

/// Materials of all libraries; the first of a name counts.
fn libraries(plain: &Plain, companions: &dyn Companions, notes: &mut Vec<String>) -> Vec<Stated> {
    let mut known = std::collections::BTreeSet::new();
    let mut materials = Vec::new();
    for library in &plain.libraries {
        // A name may hold spaces, or spaces may part several names.
        let whole = load_any(companions, library).map(|bytes| vec![bytes]);
        let found = whole.or_else(|reason| {
            let each: Vec<_> =
                library.split_whitespace().filter_map(|name| load_any(companions, name).ok()).collect();
            if each.is_empty() { Err(reason) } else { Ok(each) }
        });
        match found {
            Ok(files) => {
                let stated = files.iter().flat_map(|bytes| mtl::parse(&text::decode(bytes)));
                materials.extend(stated.filter(|material| known.insert(material.name.clone())));
            }
            Err(reason) => notes.push(format!("material library '{library}' is missing: {reason}")),
        }
    }
    materials
}

/// Fills the model's materials and textures; returns the material of each of [`Plain::materials`], and last
/// that of faces without one.
fn materials(
    plain: &Plain,
    stated: &[Stated],
    companions: &dyn Companions,
    model: &mut Model,
) -> Vec<MaterialId> {
    let mut textures = Textures::new(companions);
    model.materials = stated.iter().map(|material| translate(material, &mut textures)).collect();
    let (pixels, notes) = textures.finish();
    model.textures = pixels;
    model.notes.extend(notes);
    let by_name: BTreeMap<&str, usize> =
        stated.iter().enumerate().map(|(index, material)| (material.name.as_str(), index)).collect();
    let plain_gray = |name: &str| Material {
        name: name.into(),
        base_color: Srgba::opaque(190, 190, 190),
        two_sided: true,
        ..Material::default()
    };
    let mut add = |name: &str| {
        model.materials.push(plain_gray(name));
        model.materials.len() - 1
    };
    let mut used = Vec::new();
    for name in &plain.materials {
        let index = by_name.get(name.as_str()).copied().unwrap_or_else(|| {
            model.notes.push(format!("material '{name}' is used but not defined"));
            add(name)
        });
        used.push(MaterialId(index as u32));
    }
    if plain.faces.iter().any(|face| face.material.is_none()) {
        used.push(MaterialId(add("(no material)") as u32));
    }
    used
}

fn translate(stated: &Stated, textures: &mut Textures<'_>) -> Material {
    let [painted, mask] =
        [&stated.map, &stated.opacity_map].map(|file| file.as_ref().and_then(|file| textures.by_name(file)));
    let texture = mask.map_or(painted, |mask| textures.masked(painted, mask));
    // Exporters write black under a texture, which would blacken it.
    let black = stated.diffuse.iter().all(|&channel| channel <= 0.0);
    let diffuse = if painted.is_some() && black { [1.0; 3] } else { stated.diffuse };
    let mut base_color = color_of(diffuse);
    base_color.0[3] = (stated.opacity * 255.0 + 0.5) as u8;
    let alpha = match texture {
        _ if base_color.0[3] < 255 => AlphaMode::Blend,
        Some(id) if textures.is_cut_out(id) => AlphaMode::Mask(0.5),
        _ => AlphaMode::Opaque,
    };
    // The format knows no sides, and its files are modeled for viewers that draw both.
    Material { name: stated.name.clone(), base_color, texture, alpha, two_sided: true, ..Material::default() }
}

fn color_of(channels: [f32; 3]) -> Srgba {
    let [red, green, blue] = channels.map(|channel| (channel * 255.0 + 0.5) as u8);
    Srgba::opaque(red, green, blue)
}

/// A face as a range of the object's indices.
#[derive(Clone, Copy, Debug)]
struct FaceRange {
    first: usize,
    corners: usize,
    face: ObjFace,
}

fn polygons<'a>(mesh: &tobj::Mesh, faces: &mut impl Iterator<Item = &'a ObjFace>) -> Vec<FaceRange> {
    let triangles_only = mesh.indices.len() / 3;
    let count = if mesh.face_arities.is_empty() { triangles_only } else { mesh.face_arities.len() };
    let arities = (0..count).map(|index| mesh.face_arities.get(index).map_or(3, |&arity| arity as usize));
    let mut first = 0;
    arities
        .zip(faces)
        .map(|(corners, &face)| {
            first += corners;
            FaceRange { first: first - corners, corners, face }
        })
        .collect()
}

/// An object cut into triangles, Z up.
struct ObjShape<'a> {
    mesh: &'a tobj::Mesh,
    positions: Vec<Vec3>,
    /// Positions in `mesh.indices`, with the face.
    triangles: Vec<([usize; 3], ObjFace)>,
    normals: Vec<[Vec3; 3]>,
    left_out: usize,
}

impl<'a> ObjShape<'a> {
    fn new(mesh: &'a tobj::Mesh, polygons: Vec<FaceRange>, says_smoothing: bool) -> Self {
        let positions: Vec<Vec3> = vectors(&mesh.positions).collect();
        let mut shape = Self { mesh, positions, triangles: Vec::new(), normals: Vec::new(), left_out: 0 };
        for polygon in polygons {
            let range = polygon.first..polygon.first + polygon.corners;
            let corners: Vec<Vec3> =
                mesh.indices[range].iter().map(|&id| shape.positions[id as usize]).collect();
            if corners.iter().any(|corner| !corner.is_finite()) {
                shape.left_out += 1;
                continue;
            }
            let cut = triangulate(&corners).into_iter();
            shape
                .triangles
                .extend(cut.map(|triangle| (triangle.map(|corner| polygon.first + corner), polygon.face)));
        }
        shape.normals = shape.computed_normals(says_smoothing);
        shape
    }

    fn computed_normals(&self, says_smoothing: bool) -> Vec<[Vec3; 3]> {
        if self.triangles.iter().all(|(_, face)| face.has_normals) {
            return vec![[Vec3::Z; 3]; self.triangles.len()];
        }
        let ids: Vec<[u32; 3]> = self
            .triangles
            .iter()
            .map(|(triangle, _)| triangle.map(|corner| self.mesh.indices[corner]))
            .collect();
        let groups: Vec<u32> = self.triangles.iter().map(|(_, face)| face.smoothing).collect();
        let smoothing =
            if says_smoothing { Smoothing::Numbers(&groups) } else { Smoothing::Crease(CREASE_COS) };
        corner_normals(&self.positions, &ids, smoothing)
    }

    fn draw(&self, used: &[MaterialId], parts: &mut PartBuilder) {
        let stored_normals: Vec<Vec3> = vectors(&self.mesh.normals).collect();
        for ((triangle, face), computed) in self.triangles.iter().zip(&self.normals) {
            let material = face.material.map_or(used.last(), |index| used.get(index as usize));
            let corner = |which: usize| {
                let place = triangle[which];
                let id = self.mesh.indices[place] as usize;
                let stored = self.mesh.normal_indices.get(place).filter(|_| face.has_normals);
                let normal = stored
                    .and_then(|&index| stored_normals.get(index as usize)?.try_normalize())
                    .unwrap_or(computed[which]);
                let uv = self.mesh.texcoord_indices.get(place).filter(|_| face.has_uvs);
                ModelCorner {
                    position: self.positions[id],
                    normal,
                    uv: uv.map_or(Vec2::ZERO, |&index| self.uv(index as usize)),
                    color: self.color(id),
                }
            };
            parts.triangle(material.copied().unwrap_or(MaterialId(0)), [corner(0), corner(1), corner(2)]);
        }
    }

    /// From V upward to V downward.
    fn uv(&self, index: usize) -> Vec2 {
        let uv = self.mesh.texcoords.get(index * 2..index * 2 + 2).map_or(Vec2::ZERO, Vec2::from_slice);
        if uv.is_finite() { Vec2::new(uv.x, 1.0 - uv.y) } else { Vec2::ZERO }
    }

    fn color(&self, id: usize) -> Srgba {
        self.mesh
            .vertex_color
            .get(id * 3..id * 3 + 3)
            .map_or(Srgba::WHITE, |channels| color_of([channels[0], channels[1], channels[2]]))
    }
}

/// Triples of numbers, Y up, as vectors, Z up.
fn vectors(flat: &[f32]) -> impl Iterator<Item = Vec3> {
    flat.chunks_exact(3).map(|xyz| Vec3::new(xyz[0], -xyz[2], xyz[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::obj::read;

    struct Library(&'static str);

    impl Companions for Library {
        fn load(&self, name: &str) -> Result<Vec<u8>, String> {
            if name == "my lib.mtl" { Ok(self.0.into()) } else { Err(format!("no {name}")) }
        }
    }

    const SQUARE: &str = "mtllib my lib.mtl\nv 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\n";

    #[test]
    fn y_up_becomes_z_up_and_the_front_faces_minus_y() {
        let model = read(format!("{SQUARE}f 1 2 3 4").as_bytes(), &Library("")).expect("a sound file");
        assert_eq!(model.bounds(), Some((Vec3::ZERO, Vec3::new(1.0, 0.0, 2.0))));
        assert_eq!(model.parts[0].mesh.vertices[0].normal, [0.0, -1.0, 0.0]);
        assert_eq!((model.census.faces, model.parts[0].mesh.triangles.len()), (1, 2));
    }

    #[test]
    fn materials_are_found_and_missed_by_name() {
        let library = Library("newmtl red\nKd 1 0 0\nd 0.5\n");
        let text = format!("{SQUARE}usemtl red\nf 1 2 3\nusemtl lost\nf 1 3 4");
        let model = read(text.as_bytes(), &library).expect("a sound file");
        assert_eq!(
            (model.materials[0].base_color, model.materials[0].alpha),
            (Srgba([255, 0, 0, 128]), AlphaMode::Blend)
        );
        assert_eq!(model.parts.iter().map(|part| part.material.0).collect::<Vec<_>>(), [0, 1]);
        assert_eq!(model.notes, ["material 'lost' is used but not defined"]);
    }

    #[test]
    fn faces_without_normals_beside_faces_with_them_get_their_own() {
        let text = format!("{SQUARE}vn 1 0 0\nf 1//1 2//1 3//1\nf 1 3 4");
        let model = read(text.as_bytes(), &Library("")).expect("a sound file");
        let normals: Vec<_> = model.parts[0].mesh.vertices.iter().map(|vertex| vertex.normal).collect();
        assert!(normals[..3].iter().all(|normal| *normal == [1.0, 0.0, 0.0]));
        assert!(normals[3..].iter().all(|normal| *normal == [0.0, -1.0, 0.0]));
    }
}

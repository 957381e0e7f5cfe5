//! Makes a [`Model`] from an OBJ file that `tobj` read and its libraries.

use std::collections::{BTreeMap, BTreeSet};

use glam::{Vec2, Vec3};

use crate::error::{CompanionError, ModelError};
use crate::material::unnamed_material;
use crate::normals::{CREASE_COS, Smoothing, corner_normals};
use crate::part::{ModelCorner, PartBuilder, TriangleBudget};
use crate::texture::{Textures, load_any};
use crate::triangulate::triangulate;
use crate::{Census, Companions, Model};
use sandtable_base::message::chain::error_text;
use sandtable_base::message::numbers::counted;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::MaterialId;

use super::map_options::MtlUvTransform;
use super::mtl::{self, MtlMaterial};
use super::sound::{ObjFace, ObjFile, unmarked};
use super::text;

pub(super) fn assemble(file: &ObjFile, companions: &dyn Companions) -> Result<Model, ModelError> {
    let mut model = Model::default();
    let defined = load_libraries(file, companions, &mut model.notes);
    let materials = FaceMaterials::new(file, &defined, companions, &mut model);
    let mut budget = TriangleBudget::default();
    let mut dropped = file.short_faces;
    for (object, faces) in file.objects.iter().zip(&file.faces) {
        let triangles = ObjTriangles::new(&object.mesh, faces, file.has_smoothing);
        budget.take(triangles.indices.len())?;
        dropped += triangles.dropped_faces;
        let mut parts = PartBuilder::new(unmarked(&object.name));
        triangles.add_to(&mut parts, &materials);
        model.parts.extend(parts.finish());
    }
    model.census = Census {
        meshes: file.faces.len(),
        vertices: file.vertices,
        faces: file.short_faces + file.faces.iter().map(Vec::len).sum::<usize>(),
        materials: model.materials.len(),
    };
    if dropped > 0 {
        model.notes.push(format!(
            "{} fewer than three corners or one that is not finite",
            counted(dropped, "face has", "faces have")
        ));
    }
    if file.points_and_lines > 0 {
        let drawn = counted(file.points_and_lines, "point or line is", "points and lines are");
        model.notes.push(format!("{drawn} not drawn"));
    }
    Ok(model)
}

/// The materials of all libraries; the first of a name counts.
fn load_libraries(file: &ObjFile, companions: &dyn Companions, notes: &mut Vec<String>) -> Vec<MtlMaterial> {
    let mut names = BTreeSet::new();
    let mut materials = Vec::new();
    for library in &file.libraries {
        match load_library(library, companions) {
            Ok(parsed) => {
                let is_first = |material: &MtlMaterial| names.insert(material.mapped.name.clone());
                materials.extend(parsed.into_iter().filter(is_first));
            }
            Err(error) => {
                notes.push(format!("material library '{library}' is missing: {}", error_text(&*error)));
            }
        }
    }
    materials
}

/// The materials in the files of an `mtllib` statement: one whose name has spaces, or several.
fn load_library(library: &str, companions: &dyn Companions) -> Result<Vec<MtlMaterial>, CompanionError> {
    let files = load_any(companions, library).map(|bytes| vec![bytes]).or_else(|error| {
        let names = library.split_whitespace();
        let files: Vec<_> = names.filter_map(|name| load_any(companions, name).ok()).collect();
        if files.is_empty() { Err(error) } else { Ok(files) }
    })?;
    let mut materials = Vec::new();
    for bytes in files {
        materials.extend(mtl::parse(&text::decode(&bytes))?);
    }
    Ok(materials)
}

struct FaceMaterials {
    /// Those of [`ObjFile::materials`].
    named: Vec<MaterialId>,
    /// That of faces before the first `usemtl`.
    unnamed: MaterialId,
    /// What the maps of each material do to texture coordinates; of those that libraries define.
    uvs: Vec<MtlUvTransform>,
}

impl FaceMaterials {
    fn new(file: &ObjFile, defined: &[MtlMaterial], companions: &dyn Companions, model: &mut Model) -> Self {
        let mut textures = Textures::new(companions);
        model.materials = defined.iter().map(|material| material.mapped.load(&mut textures)).collect();
        model.notes.extend(defined.iter().flat_map(|material| material.notes.iter().cloned()));
        textures.move_to(model);
        let named = defined.iter().enumerate();
        let by_name: BTreeMap<&str, usize> =
            named.map(|(index, material)| (material.mapped.name.as_str(), index)).collect();
        let mut named = Vec::new();
        for name in &file.materials {
            let index = by_name.get(name.as_str()).copied().unwrap_or_else(|| {
                model.notes.push(format!("material '{name}' is used but not defined"));
                model.materials.push(unnamed_material(name));
                model.materials.len() - 1
            });
            named.push(MaterialId(index as u32));
        }
        let unnamed = MaterialId(model.materials.len() as u32);
        if file.faces.iter().flatten().any(|face| face.material.is_none()) {
            model.materials.push(unnamed_material("(no material)"));
        }
        Self { named, unnamed, uvs: defined.iter().map(|material| material.uv).collect() }
    }

    fn uv_transform(&self, material: MaterialId) -> MtlUvTransform {
        self.uvs.get(material.0 as usize).copied().unwrap_or_default()
    }

    fn of(&self, face: &ObjFace) -> MaterialId {
        face.material.map_or(self.unnamed, |index| self.named[index as usize])
    }
}

struct ObjTriangles<'a> {
    /// The mesh's vertices, Z up, V downward; their normals are as stored.
    corners: Vec<ModelCorner>,
    /// Triples of indices into `corners`, with the face.
    indices: Vec<([u32; 3], &'a ObjFace)>,
    /// Normals of the corners of each triangle, for faces without their own.
    normals: Vec<[Vec3; 3]>,
    dropped_faces: usize,
}

impl<'a> ObjTriangles<'a> {
    fn new(mesh: &tobj::Mesh, faces: &'a [ObjFace], has_smoothing: bool) -> Self {
        let positions: Vec<Vec3> = z_up(&mesh.positions).collect();
        let others = mesh.texcoords.as_chunks().0.iter().zip(mesh.vertex_color.as_chunks().0);
        let corners = positions.iter().zip(z_up(&mesh.normals)).zip(others);
        let corners = corners.map(|((&position, normal), (&uv, &color))| ModelCorner {
            position,
            normal,
            uv: downward(uv.into()),
            color: color_from_channels(color),
        });
        let mut triangles =
            Self { corners: corners.collect(), indices: Vec::new(), normals: Vec::new(), dropped_faces: 0 };
        let mut rest = &mesh.indices[..];
        for (number, face) in faces.iter().enumerate() {
            // Without arities, all faces are triangles.
            let arity = mesh.face_arities.get(number).map_or(3, |&arity| arity as usize);
            let (ids, after) = rest.split_at(arity);
            rest = after;
            let polygon: Vec<Vec3> = ids.iter().map(|&id| positions[id as usize]).collect();
            if polygon.iter().all(|position| position.is_finite()) {
                let cut = triangulate(&polygon).into_iter();
                triangles.indices.extend(cut.map(|triangle| (triangle.map(|corner| ids[corner]), face)));
            } else {
                triangles.dropped_faces += 1;
            }
        }
        triangles.normals = triangles.computed_normals(&positions, has_smoothing);
        triangles
    }

    fn computed_normals(&self, positions: &[Vec3], has_smoothing: bool) -> Vec<[Vec3; 3]> {
        if self.indices.iter().all(|(_, face)| face.has_normals) {
            return vec![[Vec3::Z; 3]; self.indices.len()];
        }
        let triangles: Vec<[u32; 3]> = self.indices.iter().map(|&(triangle, _)| triangle).collect();
        let groups: Vec<u32> = self.indices.iter().map(|(_, face)| face.smoothing).collect();
        let by_file = Smoothing::Numbers(&groups);
        let smoothing = if has_smoothing { by_file } else { Smoothing::Crease(CREASE_COS) };
        corner_normals(positions, &triangles, smoothing)
    }

    fn add_to(&self, parts: &mut PartBuilder, materials: &FaceMaterials) {
        for ((triangle, face), computed) in self.indices.iter().zip(&self.normals) {
            let material = materials.of(face);
            let uv_transform = materials.uv_transform(material);
            let corners = std::array::from_fn(|place| {
                let corner = self.corners[triangle[place] as usize];
                let normal = corner.normal.try_normalize().unwrap_or(computed[place]);
                ModelCorner { normal, uv: uv_transform.apply(corner.uv), ..corner }
            });
            parts.triangle(material, corners);
        }
    }
}

/// Vectors with Z up from coordinates with Y up.
fn z_up(coordinates: &[f32]) -> impl Iterator<Item = Vec3> {
    coordinates.as_chunks().0.iter().map(|&[x, y, z]| Vec3::new(x, -z, y))
}

/// From V upward to V downward; zero where a coordinate is not finite.
fn downward(uv: Vec2) -> Vec2 {
    if uv.is_finite() { Vec2::new(uv.x, 1.0 - uv.y) } else { Vec2::ZERO }
}

/// An sRGB color from channels in 0..=1; NaN is 0.
pub(super) fn color_from_channels(channels: [f32; 3]) -> Srgba {
    let [red, green, blue] = channels.map(|channel| (channel * 255.0 + 0.5) as u8);
    Srgba::opaque(red, green, blue)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::obj::read;
    use sandtable_draw::material::{AlphaMode, TextureWrap};

    struct Library(&'static str);

    impl Companions for Library {
        fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
            if name == "my lib.mtl" { Ok(self.0.into()) } else { Err(format!("no {name}").into()) }
        }
    }

    const SQUARE: &str = "mtllib my lib.mtl\nv 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\n";

    #[test]
    fn y_up_becomes_z_up_and_the_front_faces_minus_y() {
        let model = read(format!("{SQUARE}f 1 2 3 4").as_bytes(), &Library("")).expect("a sound file");
        let bounds = model.bounds().expect("four vertices");
        assert_eq!((bounds.min, bounds.max), (Vec3::ZERO, Vec3::new(1.0, 0.0, 2.0)));
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
    fn options_of_maps_place_them_and_end_them_at_their_borders() {
        let library =
            Library("newmtl wall\nmap_Kd -clamp on -s 2 4 1 -o 0.5 0.25 0 lost.png\nnewmtl plain\n");
        let text = format!("{SQUARE}vt 0.25 0.5\nusemtl wall\nf 1/1 2/1 3/1\nusemtl plain\nf 1/1 3/1 4/1");
        let model = read(text.as_bytes(), &library).expect("a sound file");
        assert_eq!(model.materials[0].texture_wrap, [TextureWrap::Clamp; 2]);
        // V runs downward: 1 − (0.5 · 4 + 0.25).
        assert_eq!(model.parts[0].mesh.vertices[0].uv, [1.0, -1.25]);
        assert_eq!(model.parts[1].mesh.vertices[0].uv, [0.25, 0.5]);
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

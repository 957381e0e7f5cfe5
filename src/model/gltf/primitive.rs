//! Converts primitives to triangles with corners.

use ::gltf::mesh::{Mode, Primitive, Semantic};
use ::gltf::{Accessor, Mesh};
use glam::{Mat3, Mat4, Vec2, Vec3};

use crate::Census;
use crate::error::ModelError;
use crate::normals::{Smoothing, corner_normals};
use crate::part::{ModelCorner, PartBuilder, TriangleBudget};
use sandtable_base::message::numbers::counted;
use sandtable_draw::color::{Srgba, srgb_from_linear};
use sandtable_draw::list::MaterialId;

use super::accessor::AccessorReader;
use super::material::{GltfMaterial, GltfUvTransform};
use super::skin::MeshPose;

pub(super) struct MeshReader<'a> {
    pub accessors: AccessorReader<'a>,
    /// The last is for primitives without a material.
    pub materials: Vec<GltfMaterial>,
    budget: TriangleBudget,
    pub notes: Vec<String>,
}

/// The vertices of a primitive in the world, Z up.
struct PrimitiveVertices {
    positions: Vec<Vec3>,
    normals: Option<Vec<Vec3>>,
    uvs: Option<Vec<[f32; 2]>>,
    colors: Vec<Srgba>,
    /// Whether the transform mirrors, so that triangles change their side.
    is_mirrored: bool,
}

impl<'a> MeshReader<'a> {
    pub(super) fn new(accessors: AccessorReader<'a>, materials: Vec<GltfMaterial>) -> Self {
        Self { accessors, materials, budget: TriangleBudget::default(), notes: Vec::new() }
    }

    pub(super) fn add_mesh(
        &mut self,
        mesh: &Mesh<'_>,
        pose: &MeshPose,
        parts: &mut PartBuilder,
    ) -> Result<Census, ModelError> {
        let mut counts = Census::default();
        for primitive in mesh.primitives() {
            let place = format!("meshes[{}].primitives[{}]", mesh.index(), primitive.index());
            counts.meshes += 1;
            if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
                self.notes.push(format!("{place} has points or lines, which are not drawn"));
                continue;
            }
            let material = primitive.material().index().unwrap_or(self.materials.len() - 1);
            let uv = self.materials[material].uv;
            let Some(vertices) = self.vertices(&primitive, pose, uv)? else {
                self.notes.push(format!("{place} has no positions and is not drawn"));
                continue;
            };
            if vertices.uvs.is_none() && self.materials[material].material.texture.is_some() {
                let set = uv.set;
                self.notes.push(format!(
                    "{place} has no TEXCOORD_{set}, which its texture needs; the texture's corner colors it"
                ));
            }
            let triangles = self.triangles(&primitive, &vertices, &place)?;
            let drawn = vertices.add_to(parts, &triangles, MaterialId(material as u32), uv);
            if drawn < triangles.len() {
                let dropped = triangles.len() - drawn;
                self.notes.push(format!(
                    "{place} has {} not finite",
                    counted(dropped, "triangle that is", "triangles that are")
                ));
            }
            counts.vertices += vertices.positions.len();
            counts.faces += triangles.len();
        }
        Ok(counts)
    }

    fn triangles(
        &mut self,
        primitive: &Primitive<'_>,
        vertices: &PrimitiveVertices,
        place: &str,
    ) -> Result<Vec<[u32; 3]>, ModelError> {
        let count = vertices.positions.len();
        let indices = match primitive.indices() {
            Some(accessor) => self.accessors.indices(&accessor)?,
            None => (0..count as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|&&index| index as usize >= count) {
            return Err(ModelError::gltf(place, format!("an index names vertex {index} of {count}")));
        }
        let triangles = triangles(primitive.mode(), &indices, vertices.is_mirrored);
        self.budget.take(triangles.len())?;
        Ok(triangles)
    }

    /// `None` where the primitive has no positions.
    fn vertices(
        &self,
        primitive: &Primitive<'_>,
        pose: &MeshPose,
        uv: GltfUvTransform,
    ) -> Result<Option<PrimitiveVertices>, ModelError> {
        let Some(positions) = self.attribute::<3>(primitive, Semantic::Positions)? else { return Ok(None) };
        let normals = self.attribute::<3>(primitive, Semantic::Normals)?;
        let uvs = self.attribute::<2>(primitive, Semantic::TexCoords(uv.set))?;
        let joints = self.attribute::<4>(primitive, Semantic::Joints(0))?;
        let weights = self.attribute::<4>(primitive, Semantic::Weights(0))?;
        let colors =
            primitive.get(&Semantic::Colors(0)).map(|accessor| self.colors(&accessor)).transpose()?;
        let matrices: Vec<Mat4> = (0..positions.len())
            .map(|index| {
                let at = |list: &Option<Vec<[f32; 4]>>| list.as_ref()?.get(index).copied();
                pose.world_from_vertex(at(&joints), at(&weights))
            })
            .collect();
        let position = |(matrix, &position): (&Mat4, &[f32; 3])| matrix.transform_point3(position.into());
        let normal = |(matrix, &normal): (&Mat4, &[f32; 3])| transform_normal(matrix, normal.into());
        Ok(Some(PrimitiveVertices {
            positions: matrices.iter().zip(&positions).map(position).collect(),
            normals: normals.map(|normals| matrices.iter().zip(&normals).map(normal).collect()),
            uvs,
            colors: colors.unwrap_or_default(),
            is_mirrored: matrices.first().is_some_and(|matrix| matrix.determinant() < 0.0),
        }))
    }

    fn attribute<const N: usize>(
        &self,
        primitive: &Primitive<'_>,
        semantic: Semantic,
    ) -> Result<Option<Vec<[f32; N]>>, ModelError> {
        primitive.get(&semantic).map(|accessor| self.accessors.vectors::<N>(&accessor)).transpose()
    }

    /// Colors from linear light, with or without alpha.
    fn colors(&self, accessor: &Accessor<'_>) -> Result<Vec<Srgba>, ModelError> {
        let color = |[red, green, blue, alpha]: [f32; 4]| {
            let [red, green, blue] = [red, green, blue].map(srgb_from_linear);
            Srgba([red, green, blue, (alpha * 255.0 + 0.5) as u8])
        };
        if accessor.dimensions().multiplicity() == 3 {
            let colors = self.accessors.vectors::<3>(accessor)?.into_iter();
            return Ok(colors.map(|[red, green, blue]| color([red, green, blue, 1.0])).collect());
        }
        Ok(self.accessors.vectors::<4>(accessor)?.into_iter().map(color).collect())
    }
}

impl PrimitiveVertices {
    /// Adds the triangles whose corners are finite; returns how many.
    fn add_to(
        &self,
        parts: &mut PartBuilder,
        triangles: &[[u32; 3]],
        material: MaterialId,
        uv: GltfUvTransform,
    ) -> usize {
        let is_finite =
            |triangle: &&[u32; 3]| triangle.iter().all(|&id| self.positions[id as usize].is_finite());
        let drawn: Vec<[u32; 3]> = triangles.iter().filter(is_finite).copied().collect();
        // The format prescribes flat normals where there are none.
        let flat = match self.normals {
            Some(_) => Vec::new(),
            None => corner_normals(&self.positions, &drawn, Smoothing::Flat),
        };
        for (triangle, ids) in drawn.iter().enumerate() {
            let corner = |place: usize| {
                let id = ids[place] as usize;
                let stored = self.normals.as_ref().and_then(|normals| normals.get(id).copied());
                let computed = || flat.get(triangle).map(|normals| normals[place]);
                let stored_uv = self.uvs.as_ref().and_then(|uvs| uvs.get(id));
                ModelCorner {
                    position: self.positions[id],
                    normal: stored.or_else(computed).unwrap_or(Vec3::Z),
                    uv: stored_uv.map_or(Vec2::ZERO, |&stored| uv.apply(stored.into())),
                    color: self.colors.get(id).copied().unwrap_or(Srgba::WHITE),
                }
            };
            parts.triangle(material, [corner(0), corner(1), corner(2)]);
        }
        drawn.len()
    }
}

/// A unit normal of a surface that `matrix` transforms; +Z where nothing is left of it. A matrix that cannot be
/// inverted transforms normals like points.
fn transform_normal(matrix: &Mat4, normal: Vec3) -> Vec3 {
    let linear = Mat3::from_mat4(*matrix);
    let determinant = linear.determinant();
    let is_invertible = determinant != 0.0 && determinant.is_finite();
    let normal_matrix = if is_invertible { linear.inverse().transpose() } else { linear };
    (normal_matrix * normal).normalize_or(Vec3::Z)
}

/// The triangles of lists, strips and fans; their order is reversed in mirrored space.
fn triangles(mode: Mode, indices: &[u32], is_mirrored: bool) -> Vec<[u32; 3]> {
    let order =
        |[a, b, c]: [u32; 3], reverse: bool| if reverse != is_mirrored { [a, c, b] } else { [a, b, c] };
    let three = |window: &[u32]| [window[0], window[1], window[2]];
    match mode {
        Mode::TriangleStrip => {
            let windows = indices.windows(3).enumerate();
            windows.map(|(place, window)| order(three(window), place % 2 == 1)).collect()
        }
        Mode::TriangleFan => {
            let rim = indices.get(1..).unwrap_or_default().windows(2);
            rim.map(|pair| order([indices[0], pair[0], pair[1]], false)).collect()
        }
        _ => indices.chunks_exact(3).map(|chunk| order(three(chunk), false)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_side() {
        assert_eq!(triangles(Mode::TriangleStrip, &[0, 1, 2, 3], false), [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(triangles(Mode::TriangleFan, &[0, 1, 2, 3], false), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 3], true), [[0, 2, 1]]);
        assert!(triangles(Mode::TriangleFan, &[], false).is_empty());
    }

    #[test]
    fn normals_of_a_flattened_sphere_lean_outward() {
        let flattened = Mat4::from_scale(Vec3::new(1.0, 1.0, 0.5));
        let normal = transform_normal(&flattened, Vec3::new(1.0, 0.0, 1.0));
        assert!(normal.abs_diff_eq(Vec3::new(1.0, 0.0, 2.0).normalize(), 1e-6), "{normal}");
    }
}

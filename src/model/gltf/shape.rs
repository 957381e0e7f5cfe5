//! Primitives to triangles with corners.

use ::gltf::json::Root;
use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use glam::{Mat3, Mat4, Vec2, Vec3};

use crate::draw::color::{Srgba, srgb_from_linear};
use crate::draw::list::MaterialId;
use crate::draw::material::Material;
use crate::draw::pixels::Pixels;
use crate::model::error::ModelError;
use crate::model::normals::{Smoothing, corner_normals};
use crate::model::part::{Budget, ModelCorner, PartBuilder};
use crate::model::texture::Textures;
use crate::model::{Census, Companions};

use super::accessor::Accessors;
use super::data::GltfBuffers;
use super::material::{GltfUvTransform, translate_all};
use super::skin::Pose;
use super::turned;

/// Draws the meshes of one document.
pub(super) struct Painter<'a> {
    root: &'a Root,
    accessors: Accessors<'a>,
    materials: Vec<(Material, GltfUvTransform)>,
    textures: Textures<'a>,
    budget: Budget,
    census: Census,
    notes: Vec<String>,
}

/// The vertices of a primitive, placed.
struct Vertices {
    positions: Vec<Vec3>,
    normals: Option<Vec<Vec3>>,
    uvs: Option<Vec<[f32; 2]>>,
    colors: Vec<Srgba>,
    mirrored: bool,
}

impl<'a> Painter<'a> {
    /// A painter with all materials and textures of the document.
    pub(super) fn new(root: &'a Root, data: &'a GltfBuffers, companions: &'a dyn Companions) -> Self {
        let mut textures = Textures::new(companions);
        let materials = translate_all(root, data, &mut textures);
        Self {
            root,
            accessors: Accessors::new(root, data),
            materials,
            textures,
            budget: Budget::default(),
            census: Census::default(),
            notes: Vec::new(),
        }
    }

    /// What reads the document's accessors.
    pub(super) fn accessors(&self) -> &Accessors<'a> {
        &self.accessors
    }

    /// Adds mesh `index` in `pose`, and to the census where it is `new`; returns how many primitives it has.
    ///
    /// # Errors
    /// [`ModelError::Gltf`] and [`ModelError::TooLarge`].
    pub(super) fn mesh(
        &mut self,
        index: usize,
        pose: &Pose,
        new: bool,
        parts: &mut PartBuilder,
    ) -> Result<usize, ModelError> {
        let root = self.root;
        let primitives = &root.meshes[index].primitives;
        for (place, primitive) in primitives.iter().enumerate() {
            let at = format!("meshes[{index}].primitives[{place}]");
            let (vertices, triangles) = self.primitive(&at, primitive, pose, parts)?;
            if new {
                self.census.vertices += vertices;
                self.census.faces += triangles;
            }
        }
        Ok(primitives.len())
    }

    /// Draws a primitive; returns how many vertices and triangles it has.
    fn primitive(
        &mut self,
        at: &str,
        primitive: &Primitive,
        pose: &Pose,
        parts: &mut PartBuilder,
    ) -> Result<(usize, usize), ModelError> {
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            _ => {
                self.notes.push(format!("{at} consists of points or lines, which are not drawn"));
                return Ok((0, 0));
            }
        };
        let material = primitive.material.map_or(self.materials.len() - 1, |index| index.value());
        let change = self.materials[material].1;
        let Some(vertices) = self.vertices(primitive, pose, change)? else {
            self.notes.push(format!("{at} has no positions and is not drawn"));
            return Ok((0, 0));
        };
        let count = vertices.positions.len();
        let indices = match primitive.indices {
            Some(index) => self.accessors.indices(index.value())?,
            None => (0..count as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|&&index| index as usize >= count) {
            return Err(ModelError::gltf(at, format!("an index names vertex {index} of {count}")));
        }
        let triangles = triangles(mode, &indices, vertices.mirrored);
        self.budget.take(triangles.len())?;
        let drawn = vertices.draw(&triangles, MaterialId(material as u32), change, parts);
        if drawn < triangles.len() {
            self.notes.push(format!("{at} has {} triangles that are not finite", triangles.len() - drawn));
        }
        Ok((count, triangles.len()))
    }

    fn vertices(
        &self,
        primitive: &Primitive,
        pose: &Pose,
        change: GltfUvTransform,
    ) -> Result<Option<Vertices>, ModelError> {
        let named = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|index| index.value());
        let Some(positions) = named(Semantic::Positions) else { return Ok(None) };
        let positions = self.accessors.vectors::<3>(positions)?;
        let normals = named(Semantic::Normals).map(|index| self.accessors.vectors::<3>(index)).transpose()?;
        let uvs = named(Semantic::TexCoords(change.set))
            .map(|index| self.accessors.vectors::<2>(index))
            .transpose()?;
        let joints =
            named(Semantic::Joints(0)).map(|index| self.accessors.vectors::<4>(index)).transpose()?;
        let weights =
            named(Semantic::Weights(0)).map(|index| self.accessors.vectors::<4>(index)).transpose()?;
        let colors =
            named(Semantic::Colors(0)).map(|index| self.colors(index)).transpose()?.unwrap_or_default();
        let moved: Vec<Mat4> = (0..positions.len())
            .map(|at| {
                let of = |list: &Option<Vec<[f32; 4]>>| list.as_ref().and_then(|list| list.get(at).copied());
                pose.of_vertex(of(&joints), of(&weights))
            })
            .collect();
        let normals = normals.map(|normals| {
            let turn = |(matrix, &normal): (&Mat4, &[f32; 3])| {
                turned(&normal_matrix(matrix), normal.into(), Vec3::Z)
            };
            moved.iter().zip(&normals).map(turn).collect()
        });
        let place = |(matrix, &position): (&Mat4, &[f32; 3])| matrix.transform_point3(position.into());
        Ok(Some(Vertices {
            positions: moved.iter().zip(&positions).map(place).collect(),
            normals,
            uvs,
            colors,
            mirrored: moved.first().is_some_and(|matrix| matrix.determinant() < 0.0),
        }))
    }

    /// Linear colors with or without alpha.
    fn colors(&self, index: usize) -> Result<Vec<Srgba>, ModelError> {
        let translate = |[red, green, blue, alpha]: [f32; 4]| {
            let [red, green, blue] = [red, green, blue].map(srgb_from_linear);
            Srgba([red, green, blue, (alpha * 255.0 + 0.5) as u8])
        };
        if self.accessors.components(index) == 3 {
            let colors = self.accessors.vectors::<3>(index)?.into_iter();
            return Ok(colors.map(|[red, green, blue]| translate([red, green, blue, 1.0])).collect());
        }
        Ok(self.accessors.vectors::<4>(index)?.into_iter().map(translate).collect())
    }

    /// The census, materials, textures and notes.
    pub(super) fn finish(self) -> (Census, Vec<Material>, Vec<Pixels>, Vec<String>) {
        let (textures, notes) = self.textures.finish();
        let materials = self.materials.into_iter().map(|(material, _)| material).collect();
        (self.census, materials, textures, [self.notes, notes].concat())
    }
}

impl Vertices {
    /// Adds the triangles whose corners are finite; returns how many.
    fn draw(
        &self,
        triangles: &[[u32; 3]],
        material: MaterialId,
        change: GltfUvTransform,
        parts: &mut PartBuilder,
    ) -> usize {
        let finite =
            |triangle: &&[u32; 3]| triangle.iter().all(|&id| self.positions[id as usize].is_finite());
        let drawn: Vec<[u32; 3]> = triangles.iter().filter(finite).copied().collect();
        // The format asks for flat normals where there are none.
        let flat = match self.normals {
            Some(_) => Vec::new(),
            None => corner_normals(&self.positions, &drawn, Smoothing::Flat),
        };
        for (triangle, ids) in drawn.iter().enumerate() {
            let corner = |place: usize| {
                let id = ids[place] as usize;
                let stored = self.normals.as_ref().and_then(|normals| normals.get(id).copied());
                let uv = self.uvs.as_ref().and_then(|uvs| uvs.get(id));
                ModelCorner {
                    position: self.positions[id],
                    normal: stored
                        .or_else(|| flat.get(triangle).map(|normals| normals[place]))
                        .unwrap_or(Vec3::Z),
                    uv: uv.map_or(Vec2::ZERO, |&uv| change.apply(uv.into())),
                    color: self.colors.get(id).copied().unwrap_or(Srgba::WHITE),
                }
            };
            parts.triangle(material, [corner(0), corner(1), corner(2)]);
        }
        drawn.len()
    }
}

/// Turns normals as `matrix` turns surfaces; its own linear part where it cannot be inverted.
fn normal_matrix(matrix: &Mat4) -> Mat3 {
    let linear = Mat3::from_mat4(*matrix);
    let determinant = linear.determinant();
    if determinant == 0.0 || !determinant.is_finite() { linear } else { linear.inverse().transpose() }
}

/// The triangles of lists, strips and fans, turned over where their space is mirrored.
fn triangles(mode: Mode, indices: &[u32], mirrored: bool) -> Vec<[u32; 3]> {
    let order = |[a, b, c]: [u32; 3], turn: bool| if turn != mirrored { [a, c, b] } else { [a, b, c] };
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
        let normal = turned(&normal_matrix(&flattened), Vec3::new(1.0, 0.0, 1.0), Vec3::Z);
        assert!(normal.abs_diff_eq(Vec3::new(1.0, 0.0, 2.0).normalize(), 1e-6), "{normal}");
    }
}

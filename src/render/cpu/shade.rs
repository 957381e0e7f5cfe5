//! What a face shows at a pixel: the draw list's formulas put together.

use glam::{Mat3, Vec3};
use rayon::prelude::*;

use crate::draw::list::{DrawItem, DrawList, DrawVertex};
use crate::draw::material::{Albedo, AlphaMode, Material, NormalSource};
use crate::render::cpu::cutout::Cutout;
use crate::render::cpu::geometry::ScreenFace;
use crate::render::cpu::ground_shade::{GroundPoint, GroundShader};
use crate::render::cpu::hit::{FacePoint, Barycentric};
use crate::render::cpu::screen::Screen;
use crate::render::cpu::texture::{Texel, TexelFootprint, Texture, Weighting};

/// A draw list with everything that is made once a frame for shading it.
#[derive(Debug)]
pub struct Shader<'a> {
    list: &'a DrawList,
    screen: &'a Screen,
    textures: Vec<Texture<'a>>,
    ground: Option<GroundShader<'a>>,
    most_taps: u32,
}

/// A face's vertices and their shares at a point.
type FaceCorners<'a> = ([&'a DrawVertex; 3], Barycentric);

/// What a surface sends to the eye.
#[derive(Clone, Copy, Debug)]
pub struct Shaded {
    /// Lit and seen through the haze; linear, in 0..=1.
    pub color: Vec3,
    /// The share of the light from behind that it stops, 0..=1.
    pub alpha: f32,
}

impl<'a> Shader<'a> {
    /// The shader of a checked list. `most_taps` bounds the readings of a texture along a grazing pixel.
    pub fn new(list: &'a DrawList, screen: &'a Screen, most_taps: u32) -> Self {
        Self {
            list,
            screen,
            textures: list.textures.par_iter().map(Texture::new).collect(),
            ground: list.ground.as_deref().map(GroundShader::new),
            most_taps,
        }
    }

    /// The item a face belongs to.
    pub fn item(&self, face: &ScreenFace) -> &'a DrawItem {
        &self.list.items[face.item as usize]
    }

    /// Whether a face looks the same as any other at its place: colored and lit by the ground map alone.
    pub fn is_mapped(&self, face: &ScreenFace) -> bool {
        let material = self.material(self.item(face));
        material.albedo == Albedo::GroundMap && material.normals == NormalSource::Ground
    }

    /// What `face` shows at pixel position `at`.
    pub fn shade(&self, face: &ScreenFace, at: [f32; 2]) -> Shaded {
        let item = self.item(face);
        let material = self.material(item);
        let hit = FacePoint::of(face, self.screen, at);
        let ground = self.ground_beneath(material, &hit);
        let corners = || (self.corners(item, face), Barycentric::of(face, at));
        let (albedo, alpha) = match (material.albedo, &ground) {
            (Albedo::GroundMap, Some((ground, point))) => (ground.albedo(point, &hit), 1.0),
            _ => self.surface_color(material, corners()),
        };
        let (normal, [sun, sky]) = match (material.normals, &ground) {
            (NormalSource::Ground, Some((_, point))) => (point.normal(), point.visibility()),
            _ => (vertex_normal(item, face, corners()), [1.0, 1.0]),
        };
        let lighting = &self.list.lighting;
        let lit = lighting.shade(albedo, normal, sun, sky);
        let seen =
            if lighting.haze.distance_m.is_finite() { lighting.add_haze(lit, hit.distance_m) } else { lit };
        // Clamped before samples are averaged, as a picture with 8-bit samples would be: an overexposed
        // surface would otherwise eat away the smooth border of its neighbor.
        Shaded { color: seen.max(Vec3::ZERO).min(Vec3::ONE), alpha }
    }

    /// A masked face with its mask; one without a mask has no hole.
    pub fn cutout<'b>(&'b self, face: &'b ScreenFace) -> Cutout<'b> {
        let item = self.item(face);
        let material = self.material(item);
        let corners = self.corners(item, face);
        Cutout {
            face,
            cutoff: if let AlphaMode::Mask(cutoff) = material.alpha { cutoff } else { 0.0 },
            alphas: corners.map(|corner| material.base_color.alpha() * corner.color.alpha()),
            texture: material
                .texture
                .map(|id| (&self.textures[id.0 as usize], corners.map(|corner| corner.uv))),
            most_taps: self.most_taps,
        }
    }

    fn material(&self, item: &DrawItem) -> &'a Material {
        &self.list.materials[item.material.0 as usize]
    }

    fn corners(&self, item: &DrawItem, face: &ScreenFace) -> [&'a DrawVertex; 3] {
        let mesh = &self.list.meshes[item.mesh.0 as usize];
        mesh.triangles[face.triangle as usize].map(|id| &mesh.vertices[id.index()])
    }

    fn ground_beneath(
        &self,
        material: &Material,
        hit: &FacePoint,
    ) -> Option<(&GroundShader<'a>, GroundPoint)> {
        let wanted = material.albedo == Albedo::GroundMap || material.normals == NormalSource::Ground;
        self.ground.as_ref().filter(|_| wanted).map(|ground| (ground, ground.at(hit, self.most_taps)))
    }

    /// Base color × vertex color × texture, in linear light, and alpha.
    fn surface_color(&self, material: &Material, (corners, shares): FaceCorners) -> (Vec3, f32) {
        let texel = self.texel(material, &corners, &shares);
        let vertex = shares.blend(corners.map(|corner| corner.color.linear()));
        let alpha = match material.alpha {
            AlphaMode::Blend => alpha(material, &corners, &shares, &texel),
            AlphaMode::Opaque | AlphaMode::Mask(_) => 1.0,
        };
        (material.base_color.linear() * vertex * texel.color, alpha)
    }

    fn texel(&self, material: &Material, corners: &[&DrawVertex; 3], shares: &Barycentric) -> Texel {
        let Some(id) = material.texture else { return Texel { color: Vec3::ONE, alpha: 1.0 } };
        let texture = &self.textures[id.0 as usize];
        let [uv, right, down] = shares.blend_uv(corners.map(|corner| corner.uv));
        let footprint = TexelFootprint::new(right, down, texture.size(), self.most_taps);
        let weighting =
            if material.alpha == AlphaMode::Opaque { Weighting::Even } else { Weighting::ByAlpha };
        texture.sample(uv, &footprint, weighting)
    }
}

/// Base alpha × vertex alpha × texture alpha, 0..=1.
fn alpha(material: &Material, corners: &[&DrawVertex; 3], shares: &Barycentric, texel: &Texel) -> f32 {
    let vertex = shares.blend_number(corners.map(|corner| corner.color.alpha()));
    material.base_color.alpha() * vertex * texel.alpha
}

/// The unit normal in world space on the side that is seen; the triangle's own where vertices have none.
fn vertex_normal(item: &DrawItem, face: &ScreenFace, (corners, shares): FaceCorners) -> Vec3 {
    let blended = shares.blend(corners.map(|corner| Vec3::from(corner.normal)));
    let to_world = Mat3::from_mat4(item.world_from_mesh);
    let normal = (to_world * blended).try_normalize().unwrap_or_else(|| {
        let [a, b, c] = corners.map(|corner| Vec3::from(corner.position));
        (to_world * (b - a).cross(c - a)).normalize_or_zero()
    });
    if face.planes.faces_eye { normal } else { -normal }
}

//! The color of a face at a pixel, by the formulas of the draw list.

use std::cell::LazyCell;

use glam::{Mat3, Vec2, Vec3};
use rayon::prelude::*;

use crate::cpu::cutout::Cutout;
use crate::cpu::geometry::ScreenFace;
use crate::cpu::ground_shade::{GroundPoint, GroundShader};
use crate::cpu::hit::{Barycentric, FacePoint};
use crate::cpu::screen::Screen;
use crate::cpu::texture::{Reading, Texel, TexelFootprint, Texture, Weighting};
use crate::shadow::Shadows;
use crate::shadow::filter::ShadowReceiver;
use sandtable_draw::area_texture::{AreaPixel, AreaTexture};
use sandtable_draw::ground_inset::GroundInset;
use sandtable_draw::hatching::hatching_cover;
use sandtable_draw::lighting::ReceivedLight;
use sandtable_draw::list::{DrawItem, DrawList, DrawVertex};
use sandtable_draw::material::{Albedo, AlphaMode, Material, NormalSource};
use sandtable_draw::water::{WaterMirror, ripples};
use sandtable_draw::water_relief::RayEnd;
use sandtable_draw::wireframe::{self, edge_cover};

#[derive(Debug)]
pub struct Shader<'a> {
    list: &'a DrawList,
    screen: &'a Screen,
    shadows: &'a Shadows,
    textures: Vec<Texture<'a>>,
    ground: Option<GroundShader<'a>>,
    /// Those of finer maps, the finest first.
    insets: Vec<InsetShader<'a>>,
    most_taps: u32,
}

/// The shader of a finer map.
#[derive(Debug)]
struct InsetShader<'a> {
    ground: GroundShader<'a>,
    origin: Vec2,
    corners: [Vec2; 2],
}

struct FaceVertices<'a> {
    corners: [&'a DrawVertex; 3],
    weights: Barycentric,
}

/// The finest ground map at a pixel.
#[derive(Debug)]
struct MappedGround<'a> {
    ground: &'a GroundShader<'a>,
    /// The pixel in the map's world space.
    hit: FacePoint,
    point: GroundPoint,
}

/// A pixel of a face that is colored and lit by the ground map alone, in a row of others.
#[derive(Debug)]
pub struct MappedPixel<'a> {
    /// Its column in the picture.
    pub column: u32,
    face: &'a ScreenFace,
    at: [f32; 2],
    hit: FacePoint,
    mapped: MappedGround<'a>,
}

#[derive(Clone, Copy, Debug)]
pub struct Shaded {
    /// Lit and seen through the haze; linear, in 0..=1.
    pub color: Vec3,
    /// The share of the light from behind that it stops, 0..=1.
    pub alpha: f32,
}

impl<'a> Shader<'a> {
    /// The shader of a checked list. `most_taps` bounds the readings of a texture along a grazing pixel.
    pub fn new(list: &'a DrawList, screen: &'a Screen, shadows: &'a Shadows, most_taps: u32) -> Self {
        let to_sun = list.lighting.to_sun;
        Self {
            list,
            screen,
            shadows,
            textures: list.textures.par_iter().map(Texture::new).collect(),
            ground: list.ground.as_deref().map(|map| GroundShader::new(map, to_sun)),
            insets: list.insets.iter().rev().map(|inset| InsetShader::new(inset, to_sun)).collect(),
            most_taps,
        }
    }

    pub fn item(&self, face: &ScreenFace) -> &'a DrawItem {
        &self.list.items[face.item as usize]
    }

    /// Whether a face is colored and lit by the ground map alone: all such faces look alike at the same place.
    pub fn is_mapped(&self, face: &ScreenFace) -> bool {
        let material = self.material(self.item(face));
        let is_ground = material.albedo == Albedo::GroundMap && material.normals == NormalSource::Ground;
        is_ground && !material.shows_edges
    }

    pub fn backdrop(&self, at: [f32; 2]) -> Vec3 {
        let down = at[1] / self.screen.size[1] as f32;
        self.list.lighting.backdrop_color(self.screen.ray_at(at), down)
    }

    /// Whether the ground has a cover.
    pub fn has_cover(&self) -> bool {
        let mut grounds = self.insets.iter().map(|inset| &inset.ground).chain(&self.ground);
        grounds.any(GroundShader::has_cover)
    }

    /// The pixel at `at` in a column, of a face that [is mapped](Self::is_mapped); `None` where there is no map.
    pub fn mapped<'b>(&'b self, face: &'b ScreenFace, at: [f32; 2], column: u32) -> Option<MappedPixel<'b>> {
        let hit = FacePoint::new(face, self.screen, at);
        let (ground, map_hit) = self.finest_ground(&hit)?;
        let point = ground.read(&map_hit, self.most_taps);
        Some(MappedPixel { column, face, at, hit, mapped: MappedGround { ground, hit: map_hit, point } })
    }

    /// Covers the ground of pixels that are to be [shaded](Self::shade_mapped): those of one map together.
    pub fn cover_mapped(pixels: &mut [MappedPixel<'_>]) {
        for pixels in pixels.chunk_by_mut(|a, b| std::ptr::eq(a.mapped.ground, b.mapped.ground)) {
            let ground = pixels[0].mapped.ground;
            ground.cover_each(
                pixels.iter_mut().map(|MappedPixel { mapped, .. }| (&mut mapped.point, &mapped.hit)),
            );
        }
    }

    /// [`Self::shade`] of a pixel whose ground is known; it is opaque.
    pub fn shade_mapped(&self, pixel: &MappedPixel<'_>) -> Vec3 {
        self.shade_known(pixel.face, pixel.at, Some(pixel)).color
    }

    pub fn shade(&self, face: &ScreenFace, at: [f32; 2]) -> Shaded {
        self.shade_known(face, at, None)
    }

    fn shade_known(&self, face: &ScreenFace, at: [f32; 2], known: Option<&MappedPixel<'_>>) -> Shaded {
        let item = self.item(face);
        let material = self.material(item);
        let vertices = LazyCell::new(|| FaceVertices {
            corners: self.corners(item, face),
            weights: Barycentric::new(face, at),
        });
        let has_surface = !matches!(material.albedo, Albedo::GroundMap | Albedo::Hatching);
        let hit = LazyCell::new(|| FacePoint::new(face, self.screen, at));
        let surface = has_surface.then(|| self.surface_color(material, &vertices, &hit));
        if let Some((_, 0.0)) = surface {
            // Nothing shows of it: most of a tint of the ground that has none there.
            return Shaded { color: Vec3::ZERO, alpha: 0.0 };
        }
        let hit = known.map_or_else(|| *hit, |pixel| pixel.hit);
        let read =
            LazyCell::new(|| if material.reads_ground_map() { self.mapped_ground(&hit) } else { None });
        let ground = known.map_or_else(|| read.as_ref(), |pixel| Some(&pixel.mapped));
        let (mut albedo, alpha) = match (material.albedo, ground) {
            (Albedo::GroundMap, Some(MappedGround { ground, hit, point })) => {
                (ground.albedo(point, hit), 1.0)
            }
            (Albedo::Hatching, _) => {
                let Material { base_color, .. } = material;
                (base_color.linear(), base_color.alpha() * hatching_cover(at))
            }
            _ => surface.unwrap_or_else(|| self.surface_color(material, &vertices, &hit)),
        };
        if let (true, Some(MappedGround { ground, hit, point })) = (material.is_natural, ground) {
            albedo *= ground.grain(point, hit);
        }
        let lighting = &self.list.lighting;
        let mut color = match (material.normals, ground) {
            (NormalSource::Ground, Some(MappedGround { ground, point, .. })) => {
                let unlit =
                    if material.albedo == Albedo::GroundMap { ground.unlit_share(point) } else { 0.0 };
                if unlit < 1.0 {
                    let received = self.received(&hit, ShadowReceiver::Ground, true);
                    let form = self.ground.as_ref().unwrap_or(ground).form(hit.world.truncate());
                    ground.lit(albedo, point, &form, received).lerp(albedo, unlit)
                } else {
                    albedo
                }
            }
            _ if material.albedo == Albedo::Hatching => albedo,
            _ => {
                let normal = vertices.normal(item, face);
                let is_sunlit = normal.dot(lighting.to_sun) > 0.0;
                let received = if material.receives_shadows {
                    self.received(&hit, ShadowReceiver::Solid, is_sunlit)
                } else {
                    ReceivedLight::ALL
                };
                lighting.shade_received(albedo, normal, received)
            }
        };
        let water = match (material.albedo, ground) {
            (Albedo::GroundMap, Some(MappedGround { ground, hit, point })) => {
                ground.water_cover(point, hit) * (1.0 - point.draped.share)
            }
            _ => f32::from(u8::from(material.is_water)),
        };
        if water > 0.0 {
            let screen = self.screen;
            let ray = if screen.is_parallel { screen.forward.as_vec3() } else { screen.ray_at(at) };
            let ray = ray.normalize_or_zero();
            let slope = ripples(hit.world.truncate(), hit.pixel_m(), ray);
            let mirror = WaterMirror { share: water, slope };
            color = lighting.mirror(color, ray, mirror, |ray| self.mirrored_relief(&hit, ray));
        }
        if material.shows_edges {
            // At the center, wherever the samples of the face are: both faces of an edge draw the same line.
            let center = at.map(|place| place.floor() + 0.5);
            let [from_px, heights_px] = Barycentric::extended(face, center).edges_px();
            color = color
                .lerp(wireframe::LINE.linear(), edge_cover(from_px, heights_px) * wireframe::LINE.alpha());
        }
        if lighting.haze.distance_m.is_finite() {
            color = lighting.add_haze(color, hit.distance_m);
        }
        // Clamped before samples are averaged, as in a picture with 8-bit samples: an overexposed surface would
        // otherwise spoil the smooth border of its neighbor.
        Shaded { color: color.max(Vec3::ZERO).min(Vec3::ONE), alpha }
    }

    /// The finest map at a place, and the place in its world space.
    fn finest_ground(&self, hit: &FacePoint) -> Option<(&GroundShader<'a>, FacePoint)> {
        let at = hit.world.truncate();
        match self.insets.iter().find(|inset| inset.holds(at)) {
            Some(inset) => {
                let world = hit.world - inset.origin.extend(0.0);
                Some((&inset.ground, FacePoint { world, ..*hit }))
            }
            None => Some((self.ground.as_ref()?, *hit)),
        }
    }

    fn mapped_ground(&self, hit: &FacePoint) -> Option<MappedGround<'_>> {
        let (ground, hit) = self.finest_ground(hit)?;
        Some(MappedGround { ground, hit, point: ground.at(&hit, self.most_taps) })
    }

    /// The light of the ground that a ray meets which water at a point mirrors, as it reaches the water through the haze;
    /// `None` where it meets none.
    ///
    /// The ray goes from the finest map that holds the point out into coarser ones.
    fn mirrored_relief(&self, hit: &FacePoint, direction: Vec3) -> Option<Vec3> {
        let outer = self.ground.as_ref()?;
        let at = hit.world.truncate();
        let insets = self.insets.iter().filter(|inset| inset.holds(at));
        let mut grounds =
            insets.map(|inset| (&inset.ground, inset.origin)).chain([(outer, Vec2::ZERO)]).peekable();
        let (finest, origin) = *grounds.peek()?;
        let ray = finest.mirrored_ray(at - origin, direction)?.within(-origin);
        let mut start_m = 0.0_f32;
        for (ground, origin) in grounds {
            match ground.met_by(&ray.within(origin), start_m) {
                RayEnd::Ground(along_m) => {
                    let (place, way_m) = (ray.at(along_m), ray.length_m(along_m));
                    let distance_m = hit.distance_m + way_m;
                    // Rays part with distance from the eye, and parallel ones do not.
                    let parted = if self.screen.is_parallel { 1.0 } else { distance_m / hit.distance_m };
                    let pixel_m = hit.across_m() * parted;
                    let met = FacePoint {
                        world: (place - origin).extend(ray.z + ray.rise * along_m),
                        distance_m,
                        right: Vec3::X * pixel_m,
                        down: Vec3::Y * pixel_m,
                    };
                    let light = ground.mirrored(&met, &outer.form(place), self.most_taps);
                    return Some(self.list.lighting.add_haze_beyond(light, hit.distance_m, distance_m));
                }
                RayEnd::Beyond(along_m) => start_m = along_m.max(0.0),
            }
        }
        None
    }

    /// The light that reaches a point past solids; the sun is looked for only where the surface turns to it.
    fn received(&self, hit: &FacePoint, receiver: ShadowReceiver, is_sunlit: bool) -> ReceivedLight {
        let sun = self.shadows.sun.as_ref().filter(|_| is_sunlit);
        let sky = self.shadows.sky.as_ref();
        ReceivedLight {
            sun: sun.map_or(1.0, |map| map.sun(hit.world, hit.right.cross(hit.down), receiver)),
            sky: sky.map_or(1.0, |map| map.contact(hit.world, receiver)),
        }
    }

    /// A masked face with its mask; a face without a mask has no hole.
    pub fn cutout<'b>(&'b self, face: &'b ScreenFace) -> Cutout<'b> {
        let item = self.item(face);
        let material = self.material(item);
        let corners = self.corners(item, face);
        let texture = material.texture.map(|id| &self.textures[id.0 as usize]);
        Cutout {
            face,
            cutoff: if let AlphaMode::Mask(cutoff) = material.alpha { cutoff } else { 0.0 },
            alphas: corners.map(|corner| material.base_color.alpha() * corner.color.alpha()),
            texture: texture.map(|texture| (texture, corners.map(|corner| corner.uv))),
            wrap: material.texture_wrap,
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

    /// Base color × vertex color × texture in linear light, and alpha.
    fn surface_color(
        &self,
        material: &Material,
        vertices: &FaceVertices<'_>,
        hit: &FacePoint,
    ) -> (Vec3, f32) {
        let texel = match &material.area {
            Some(area) => area_texel(area, vertices, hit),
            None => self.texel(material, vertices),
        };
        let FaceVertices { corners, weights } = vertices;
        let vertex = weights.blend(corners.map(|corner| corner.color.linear()));
        let alpha = match material.alpha {
            AlphaMode::Blend => {
                let vertex = weights.blend_number(corners.map(|corner| corner.color.alpha()));
                material.base_color.alpha() * vertex * texel.alpha
            }
            AlphaMode::Opaque | AlphaMode::Mask(_) => 1.0,
        };
        (material.base_color.linear() * vertex * texel.color, alpha)
    }

    fn texel(&self, material: &Material, vertices: &FaceVertices) -> Texel {
        let Some(id) = material.texture else { return Texel::WHITE };
        let texture = &self.textures[id.0 as usize];
        let [uv, right, down] = vertices.weights.blend_uv(vertices.corners.map(|corner| corner.uv));
        let footprint = TexelFootprint::new(right, down, texture.size(), self.most_taps);
        let weighting =
            if material.alpha == AlphaMode::Opaque { Weighting::Even } else { Weighting::ByAlpha };
        texture.sample(uv, &footprint, Reading { weighting, wrap: material.texture_wrap })
    }
}

/// The cover of an area at a point of a face.
fn area_texel(area: &AreaTexture, vertices: &FaceVertices<'_>, hit: &FacePoint) -> Texel {
    let [uv, _, _] = vertices.weights.blend_uv(vertices.corners.map(|corner| corner.uv));
    let color = area.color(&AreaPixel {
        at: hit.world.truncate(),
        mean_m: hit.mean_pixel_m(),
        longest_m: hit.pixel_m(),
        inward: (2.0 * uv.x - 1.0).abs(),
    });
    Texel { color: color.truncate(), alpha: color.w }
}

impl<'a> InsetShader<'a> {
    fn new(inset: &'a GroundInset, to_sun: Vec3) -> Self {
        let ground = GroundShader::new(&inset.map, to_sun).within(inset.origin);
        Self { ground, origin: inset.origin, corners: inset.corners() }
    }

    fn holds(&self, at: Vec2) -> bool {
        let [min, max] = self.corners;
        min.cmple(at).all() && at.cmple(max).all()
    }
}

impl FaceVertices<'_> {
    /// The unit normal in world space on the side that is seen; the triangle's own where vertices have none.
    fn normal(&self, item: &DrawItem, face: &ScreenFace) -> Vec3 {
        let blended = self.weights.blend(self.corners.map(|corner| Vec3::from(corner.normal)));
        let to_world = Mat3::from_mat4(item.world_from_mesh);
        let normal = (to_world * blended).try_normalize().unwrap_or_else(|| {
            let [a, b, c] = self.corners.map(|corner| Vec3::from(corner.position));
            (to_world * (b - a).cross(c - a)).normalize_or_zero()
        });
        if face.planes.faces_eye { normal } else { -normal }
    }
}

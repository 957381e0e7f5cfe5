//! The color of a face at a pixel, by the formulas of the draw list.

use std::cell::LazyCell;

use glam::{Mat3, Vec2, Vec3};
use rayon::prelude::*;

use crate::cpu::cutout::Cutout;
use crate::cpu::geometry::ScreenFace;
use crate::cpu::ground_shade::{CoveredPoint, GroundPoint, GroundShader};
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

/// A point of a face, which is to be shaded.
#[derive(Clone, Copy, Debug)]
pub struct FaceAt<'a> {
    pub face: &'a ScreenFace,
    /// On the picture, in pixels.
    pub at: [f32; 2],
}

/// A point that shows the ground map, or what lies on it.
struct GroundedPoint<'a> {
    /// Its place among the points that are shaded together.
    index: usize,
    on: FaceAt<'a>,
    material: &'a Material,
    hit: FacePoint,
    /// The finest map there is of it, and where that lies in the world.
    ground: &'a GroundShader<'a>,
    origin: Vec2,
    point: GroundPoint,
    /// Its own color, where it has one.
    surface: Option<(Vec3, f32)>,
}

#[derive(Clone, Copy, Debug)]
pub struct Shaded {
    /// Lit and seen through the haze; linear, in 0..=1.
    pub color: Vec3,
    /// The share of the light from behind that it stops, 0..=1.
    pub alpha: f32,
}

impl Shaded {
    /// Where nothing shows of a face.
    const NOTHING: Self = Self { color: Vec3::ZERO, alpha: 0.0 };
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

    /// The colors of faces at points, each as it is alone. Those of ground, and of what lies on it, are computed together: that
    /// takes less time.
    pub fn shade_each<'b>(&'b self, points: &[FaceAt<'b>]) -> Vec<Shaded> {
        let mut shaded = vec![Shaded::NOTHING; points.len()];
        let mut grounded = Vec::with_capacity(points.len());
        for ((index, on), shaded) in points.iter().enumerate().zip(&mut shaded) {
            if let Some(known) = self.read(index, *on, &mut grounded) {
                *shaded = known;
            }
        }
        for points in grounded.chunk_by_mut(|a, b| std::ptr::eq(a.ground, b.ground)) {
            self.shade_grounded(points, &mut shaded);
        }
        shaded
    }

    /// Adds a point to those that show the ground map, where it does; else its color.
    fn read<'b>(
        &'b self,
        index: usize,
        on: FaceAt<'b>,
        grounded: &mut Vec<GroundedPoint<'b>>,
    ) -> Option<Shaded> {
        let FaceAt { face, at } = on;
        let item = self.item(face);
        let material = self.material(item);
        let vertices = LazyCell::new(|| FaceVertices {
            corners: self.corners(item, face),
            weights: Barycentric::new(face, at),
        });
        let has_surface = !matches!(material.albedo, Albedo::GroundMap | Albedo::Hatching);
        let hit = FacePoint::new(face, self.screen, at);
        let surface = has_surface.then(|| self.surface_color(material, &vertices, &hit));
        if let Some((_, 0.0)) = surface {
            // Nothing shows of it: most of a tint of the ground that has none there.
            return Some(Shaded::NOTHING);
        }
        let finest = if material.reads_ground_map() { self.finest_ground(&hit) } else { None };
        if let Some((ground, origin)) = finest {
            let point = GroundPoint::default();
            grounded.push(GroundedPoint { index, on, material, hit, ground, origin, point, surface });
            if let Some(GroundedPoint { point, hit, .. }) = grounded.last_mut() {
                ground.read_to(point, &within(*hit, origin), self.most_taps);
            }
            return None;
        }
        let (albedo, alpha) = match material.albedo {
            Albedo::Hatching => hatched(material, at),
            _ => surface.unwrap_or_else(|| self.surface_color(material, &vertices, &hit)),
        };
        let color = match material.albedo {
            Albedo::Hatching => albedo,
            _ => self.lit_solid(albedo, face, &vertices, &hit),
        };
        let water = f32::from(u8::from(material.is_water));
        Some(Shaded { color: self.finished(color, &on, &hit, water), alpha })
    }

    /// Shades points of one map.
    fn shade_grounded(&self, points: &mut [GroundedPoint<'_>], shaded: &mut [Shaded]) {
        let Some((ground, origin)) = points.first().map(|point| (point.ground, point.origin)) else { return };
        let shows_map = |material: &Material| material.albedo == Albedo::GroundMap;
        let on_map: Vec<FacePoint> = points.iter().map(|point| within(point.hit, origin)).collect();
        let with_places = points.iter_mut().zip(&on_map);
        ground.cover_each(with_places.map(|(GroundedPoint { point, material, .. }, hit)| CoveredPoint {
            point,
            hit,
            shows_map: shows_map(material),
        }));
        // What is lit by the ground's slopes, with the share of it that is shown without light.
        let (mut to_light, mut relief) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
        for (GroundedPoint { index, on, material, hit, point, surface, .. }, map_hit) in
            points.iter().zip(&on_map)
        {
            let (mut albedo, alpha) = match (material.albedo, surface) {
                (Albedo::GroundMap, _) => (ground.albedo(point, map_hit), 1.0),
                (Albedo::Hatching, _) => hatched(material, on.at),
                (_, Some(surface)) => *surface,
                (_, None) => (Vec3::ZERO, 0.0),
            };
            if material.is_natural {
                albedo *= ground.grain(point, map_hit);
            }
            let color = match (material.normals, material.albedo) {
                (NormalSource::Ground, _) => {
                    let unlit = if shows_map(material) { ground.unlit_share(point) } else { 0.0 };
                    if unlit < 1.0 {
                        let received = self.received(hit, ShadowReceiver::Ground, true);
                        let form = self.ground.as_ref().unwrap_or(ground).form(hit.world.truncate());
                        to_light.push((*index, unlit));
                        relief.push(ground.relief_pixel(albedo, point, &form, received));
                    }
                    albedo
                }
                (_, Albedo::Hatching) => albedo,
                _ => {
                    let item = self.item(on.face);
                    let weights = Barycentric::new(on.face, on.at);
                    let vertices = FaceVertices { corners: self.corners(item, on.face), weights };
                    self.lit_solid(albedo, on.face, &vertices, hit)
                }
            };
            shaded[*index] = Shaded { color, alpha };
        }
        for ((index, unlit), lit) in to_light.into_iter().zip(ground.lit_each(&relief)) {
            let color = &mut shaded[index].color;
            *color = lit.lerp(*color, unlit);
        }
        for (GroundedPoint { index, on, material, hit, point, .. }, map_hit) in points.iter().zip(&on_map) {
            let water = if shows_map(material) {
                ground.water_cover(point, map_hit) * (1.0 - point.draped.share)
            } else {
                f32::from(u8::from(material.is_water))
            };
            let color = &mut shaded[*index].color;
            *color = self.finished(*color, on, hit, water);
        }
    }

    /// The light that a point of a solid returns.
    fn lit_solid(
        &self,
        albedo: Vec3,
        face: &ScreenFace,
        vertices: &FaceVertices<'_>,
        hit: &FacePoint,
    ) -> Vec3 {
        let lighting = &self.list.lighting;
        let item = self.item(face);
        let normal = vertices.normal(item, face);
        let is_sunlit = normal.dot(lighting.to_sun) > 0.0;
        let received = if self.material(item).receives_shadows {
            self.received(hit, ShadowReceiver::Solid, is_sunlit)
        } else {
            ReceivedLight::ALL
        };
        lighting.shade_received(albedo, normal, received)
    }

    /// What is seen of a point that returns the light `color`: mirrored in the `water` on it, between its edges, through the haze.
    fn finished(&self, mut color: Vec3, on: &FaceAt<'_>, hit: &FacePoint, water: f32) -> Vec3 {
        let FaceAt { face, at } = *on;
        let lighting = &self.list.lighting;
        if water > 0.0 {
            let screen = self.screen;
            let ray = if screen.is_parallel { screen.forward.as_vec3() } else { screen.ray_at(at) };
            let ray = ray.normalize_or_zero();
            let slope = ripples(hit.world.truncate(), hit.pixel_m(), ray);
            let mirror = WaterMirror { share: water, slope };
            color = lighting.mirror(color, ray, mirror, |ray| self.mirrored_relief(hit, ray));
        }
        if self.material(self.item(face)).shows_edges {
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
        color.max(Vec3::ZERO).min(Vec3::ONE)
    }

    /// The finest map at a place, and where it lies in the world.
    fn finest_ground(&self, hit: &FacePoint) -> Option<(&GroundShader<'a>, Vec2)> {
        let at = hit.world.truncate();
        match self.insets.iter().find(|inset| inset.holds(at)) {
            Some(inset) => Some((&inset.ground, inset.origin)),
            None => Some((self.ground.as_ref()?, Vec2::ZERO)),
        }
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

/// A place in the world space of a map that lies at `origin` in the world.
fn within(hit: FacePoint, origin: Vec2) -> FacePoint {
    FacePoint { world: hit.world - origin.extend(0.0), ..hit }
}

/// The color and the alpha of hatching.
fn hatched(material: &Material, at: [f32; 2]) -> (Vec3, f32) {
    (material.base_color.linear(), material.base_color.alpha() * hatching_cover(at))
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

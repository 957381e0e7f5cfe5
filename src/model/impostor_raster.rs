//! An orthographic view of a model: colors and normals of the front surface on a grid of samples.
//!
//! There is no light, no perspective and no filtering but several samples a pixel. The renderers cannot serve: they are on
//! a higher layer.

use glam::{Vec2, Vec3};

use crate::impostor::{INNER, ViewAxes};
use crate::{Model, ModelPart};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, DrawVertex};
use sandtable_draw::material::{AlphaMode, Material, TextureWrap};
use sandtable_draw::pixels::Pixels;

/// Samples along the side of a pixel.
pub(super) const SAMPLES: u32 = 3;

const SIDE: usize = (INNER * SAMPLES) as usize;

/// How often the triangles' boxes may cover the grid: bounds the time of all views of a hostile model to about a second.
const MAX_LAYERS: usize = 256;

/// Textures are reduced until no side is longer: two of their pixels for each pixel of a tile.
const MAX_TEXTURE_SIDE: u32 = 128;

pub(super) struct ImpostorSource<'a> {
    parts: &'a [ModelPart],
    materials: &'a [Material],
    textures: Vec<Pixels>,
    center: Vec3,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceSample {
    /// Position along the view; greater is nearer to the eye.
    depth: f32,
    /// In linear light.
    pub color: Vec3,
    normal: Vec3,
}

pub(super) struct ImpostorRaster {
    /// The lower left corner of the model, along the axes to the right and up.
    pub low: Vec2,
    /// The upper right corner.
    pub high: Vec2,
    samples: Vec<Option<SurfaceSample>>,
}

impl<'a> ImpostorSource<'a> {
    /// `model` with the shape of `parts`; `None` where there is nothing to see.
    pub(super) fn new(model: &'a Model, parts: &'a [ModelPart]) -> Option<Self> {
        let center = model.bounds()?.center();
        parts.iter().any(|part| !part.mesh.triangles.is_empty()).then(|| Self {
            parts,
            materials: &model.materials,
            textures: model.textures.iter().map(reduced).collect(),
            center,
        })
    }

    /// The position of the view's quad along the view: through the model's center.
    pub(super) fn depth(&self, axes: &ViewAxes) -> f32 {
        self.center.dot(axes.toward_eye)
    }

    fn triangles(&self) -> impl Iterator<Item = (&'a DrawMesh, &'a Material, [&'a DrawVertex; 3])> {
        let materials = self.materials;
        self.parts.iter().flat_map(move |ModelPart { mesh, material, .. }| {
            let material = &materials[material.0 as usize];
            let corners = mesh.triangles.iter().map(|ids| ids.map(|id| &mesh.vertices[id.index()]));
            corners.map(move |corners| (mesh, material, corners))
        })
    }
}

impl ImpostorRaster {
    /// The view along `axes`; `None` where more than [`MAX_LAYERS`] triangles are on top of each other.
    pub(super) fn new(source: &ImpostorSource<'_>, axes: &ViewAxes) -> Option<Self> {
        let plan = |vertex: &DrawVertex| {
            let at = Vec3::from(vertex.position);
            Vec2::new(at.dot(axes.right), at.dot(axes.up))
        };
        let all = source.triangles().flat_map(|(_, _, corners)| corners.map(plan));
        let (low, high) =
            all.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        // A board seen from its edge has no width.
        let least = Vec2::splat(((high - low).max_element() * 1e-3).max(f32::MIN_POSITIVE));
        let size = (high - low).max(least);
        let (low, high) = ((low + high - size) * 0.5, (low + high + size) * 0.5);
        let mut raster = Self { low, high, samples: vec![None; SIDE * SIDE] };
        let mut left = MAX_LAYERS * SIDE * SIDE;
        for (_, material, corners) in source.triangles() {
            let at = corners.map(|corner| {
                let share = (plan(corner) - low) / size;
                Vec2::new(share.x, 1.0 - share.y) * SIDE as f32
            });
            let (from, to) = window(&at);
            left = left.checked_sub((to[0] - from[0]) * (to[1] - from[1]))?;
            raster.draw(source, axes, material, corners, at);
        }
        Some(raster)
    }

    fn draw(
        &mut self,
        source: &ImpostorSource<'_>,
        axes: &ViewAxes,
        material: &Material,
        corners: [&DrawVertex; 3],
        [a, b, c]: [Vec2; 3],
    ) {
        let area = (b - a).perp_dot(c - a);
        // Rows run downward: triangles that are counter-clockwise in the world have a negative area here.
        let is_back = area > 0.0;
        if area == 0.0 || !area.is_finite() || (is_back && !material.two_sided) {
            return;
        }
        let depths = corners.map(|corner| Vec3::from(corner.position).dot(axes.toward_eye));
        let (from, to) = window(&[a, b, c]);
        for row in from[1]..to[1] {
            for column in from[0]..to[0] {
                let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                let weights = [(c - b).perp_dot(at - b), (a - c).perp_dot(at - c), (b - a).perp_dot(at - a)]
                    .map(|doubled| doubled / area);
                if weights.iter().any(|&weight| weight < 0.0) {
                    continue;
                }
                let depth = depths.iter().zip(weights).map(|(depth, weight)| depth * weight).sum();
                let place = &mut self.samples[row * SIDE + column];
                if place.is_none_or(|there| depth > there.depth)
                    && let Some((color, normal)) = shade(source, material, corners, weights)
                {
                    *place =
                        Some(SurfaceSample { depth, color, normal: if is_back { -normal } else { normal } });
                }
            }
        }
    }

    /// The covered samples of a pixel.
    pub(super) fn samples_of(&self, column: u32, row: u32) -> impl Iterator<Item = &SurfaceSample> {
        let first = [column, row].map(|pixel| (pixel * SAMPLES) as usize);
        let all = (0..(SAMPLES * SAMPLES) as usize)
            .map(move |at| [first[0] + at % SAMPLES as usize, first[1] + at / SAMPLES as usize]);
        all.filter_map(|[x, y]| self.samples[y * SIDE + x].as_ref())
    }

    /// The places of all covered samples, across and down in 0..=1, with their normals.
    pub(super) fn normals(&self) -> impl Iterator<Item = (Vec2, Vec3)> {
        self.samples.iter().enumerate().filter_map(|(index, sample)| {
            let at = Vec2::new((index % SIDE) as f32 + 0.5, (index / SIDE) as f32 + 0.5) / SIDE as f32;
            sample.map(|sample| (at, sample.normal))
        })
    }
}

/// The samples whose centers a triangle may cover, column and row: the first, and past the last.
fn window(corners: &[Vec2; 3]) -> ([usize; 2], [usize; 2]) {
    let [a, b, c] = *corners;
    let low = a.min(b).min(c).max(Vec2::ZERO);
    let high = a.max(b).max(c).max(Vec2::ZERO);
    let from = low.to_array().map(|side| (side as usize).min(SIDE));
    (from, [(high.x.ceil() as usize).clamp(from[0], SIDE), (high.y.ceil() as usize).clamp(from[1], SIDE)])
}

/// The color in linear light and the unit normal; `None` where the surface has a hole.
fn shade(
    source: &ImpostorSource<'_>,
    material: &Material,
    corners: [&DrawVertex; 3],
    weights: [f32; 3],
) -> Option<(Vec3, Vec3)> {
    let mean = |value: &dyn Fn(&DrawVertex) -> Vec3| {
        corners.iter().zip(weights).fold(Vec3::ZERO, |sum, (corner, weight)| sum + value(corner) * weight)
    };
    let texel = material.texture.and_then(|id| {
        texel(
            source.textures.get(id.0 as usize)?,
            mean(&|vertex| Vec2::from(vertex.uv).extend(0.0)).truncate(),
            material.texture_wrap,
        )
    });
    let texel = texel.unwrap_or(Srgba::WHITE);
    if let AlphaMode::Mask(cutoff) = material.alpha {
        let vertex = mean(&|vertex| Vec3::splat(vertex.color.alpha())).x;
        if material.base_color.alpha() * vertex * texel.alpha() < cutoff {
            return None;
        }
    }
    let color = material.base_color.linear() * mean(&|vertex| vertex.color.linear()) * texel.linear();
    let [a, b, c] = corners.map(|corner| Vec3::from(corner.position));
    let normal = mean(&|vertex| vertex.normal.into()).try_normalize();
    Some((color, normal.unwrap_or_else(|| (b - a).cross(c - a).normalize_or_zero())))
}

/// The nearest pixel of a texture; `None` where it is empty.
fn texel(texture: &Pixels, uv: Vec2, wrap: [TextureWrap; 2]) -> Option<Srgba> {
    let size = [texture.width(), texture.height()];
    if size.contains(&0) {
        return None;
    }
    Some(texture.at(wrap[0].texel(uv.x, size[0]), wrap[1].texel(uv.y, size[1])))
}

/// The texture with blocks of pixels averaged until no side is longer than [`MAX_TEXTURE_SIDE`].
fn reduced(texture: &Pixels) -> Pixels {
    let step = texture.width().max(texture.height()).div_ceil(MAX_TEXTURE_SIDE);
    if step <= 1 {
        return texture.clone();
    }
    let side = |side: u32| side.div_ceil(step);
    Pixels::from_fn(side(texture.width()), side(texture.height()), |x, y| {
        let (mut light, mut seen, mut count) = (Vec3::ZERO, 0.0, 0.0);
        for row in y * step..((y + 1) * step).min(texture.height()) {
            for column in x * step..((x + 1) * step).min(texture.width()) {
                let pixel = texture.at(column, row);
                light += pixel.linear() * pixel.alpha();
                seen += pixel.alpha();
                count += 1.0;
            }
        }
        let Srgba([red, green, blue, _]) = Srgba::from_linear(light / f32::max(seen, f32::MIN_POSITIVE));
        Srgba([red, green, blue, (seen / f32::max(count, 1.0) * 255.0 + 0.5) as u8])
    })
}

//! A model seen from infinitely far in one direction: colors and normals of what is in front, on a grid of samples.
//!
//! No light, no perspective, no filtering but several samples a pixel: what an impostor needs and nothing more. The
//! renderers stand above this room and do not lend themselves.

use glam::{Vec2, Vec3};

use crate::draw::color::Srgba;
use crate::draw::list::{DrawMesh, DrawVertex};
use crate::draw::material::{AlphaMode, Material};
use crate::draw::pixels::Pixels;
use crate::model::impostor::{INNER, ViewAxes};
use crate::model::{Model, ModelPart};

/// Samples along the side of a pixel.
pub(super) const SAMPLES: u32 = 3;

/// Samples along the side of the grid.
const SIDE: usize = (INNER * SAMPLES) as usize;

/// How many times over the triangles' boxes may cover the grid: bounds the time that a hostile model can take to
/// about a second for all views.
pub(super) const MOST_LAYERS: usize = 256;

/// Textures are halved until no side is longer: two of their pixels for each pixel of a tile.
const MOST_TEXTURE_SIDE: u32 = 128;

/// A model made ready for being seen from many sides.
pub(super) struct ImpostorSource<'a> {
    parts: &'a [ModelPart],
    materials: &'a [Material],
    textures: Vec<Pixels>,
    middle: Vec3,
}

/// What a sample sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Toward the eye; greater is nearer.
    depth: f32,
    /// In linear light.
    pub color: Vec3,
    normal: Vec3,
}

/// A model seen along one direction.
pub(super) struct ImpostorRaster {
    /// The lower left corner of what is seen, along the axes to the right and up.
    pub low: Vec2,
    /// The upper right corner.
    pub high: Vec2,
    samples: Vec<Option<Sample>>,
}

impl<'a> ImpostorSource<'a> {
    /// The model whose shape is `parts`; `None` where there is nothing to see.
    pub(super) fn new(model: &'a Model, parts: &'a [ModelPart]) -> Option<Self> {
        let (min, max) = model.bounds()?;
        parts.iter().any(|part| !part.mesh.triangles.is_empty()).then(|| Self {
            parts,
            materials: &model.materials,
            textures: model.textures.iter().map(reduced).collect(),
            middle: (min + max) * 0.5,
        })
    }

    /// How far along the view its quad stands: through the model's middle.
    pub(super) fn depth(&self, axes: &ViewAxes) -> f32 {
        self.middle.dot(axes.toward_eye)
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
    /// The model seen along `axes`; `None` where its triangles lie more than [`MOST_LAYERS`] deep.
    pub(super) fn of(source: &ImpostorSource<'_>, axes: &ViewAxes) -> Option<Self> {
        let plan = |vertex: &DrawVertex| {
            let at = Vec3::from(vertex.position);
            Vec2::new(at.dot(axes.right), at.dot(axes.up))
        };
        let all = source.triangles().flat_map(|(_, _, corners)| corners.map(plan));
        let (low, high) =
            all.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        // A board seen from its edge has no width of its own.
        let least = Vec2::splat(((high - low).max_element() * 1e-3).max(f32::MIN_POSITIVE));
        let size = (high - low).max(least);
        let (low, high) = ((low + high - size) * 0.5, (low + high + size) * 0.5);
        let mut raster = Self { low, high, samples: vec![None; SIDE * SIDE] };
        let mut left = MOST_LAYERS * SIDE * SIDE;
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
        // Rows run down, so what turns counter-clockwise in the world has a negative area here.
        let is_back = area > 0.0;
        if area == 0.0 || !area.is_finite() || (is_back && !material.two_sided) {
            return;
        }
        let depths = corners.map(|corner| Vec3::from(corner.position).dot(axes.toward_eye));
        let (from, to) = window(&[a, b, c]);
        for row in from[1]..to[1] {
            for column in from[0]..to[0] {
                let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                let shares = [(c - b).perp_dot(at - b), (a - c).perp_dot(at - c), (b - a).perp_dot(at - a)]
                    .map(|doubled| doubled / area);
                if shares.iter().any(|&share| share < 0.0) {
                    continue;
                }
                let depth = depths.iter().zip(shares).map(|(depth, share)| depth * share).sum();
                let place = &mut self.samples[row * SIDE + column];
                if place.is_none_or(|there| depth > there.depth)
                    && let Some((color, normal)) = looks(source, material, corners, shares)
                {
                    *place = Some(Sample { depth, color, normal: if is_back { -normal } else { normal } });
                }
            }
        }
    }

    /// What the samples of a pixel see, those that see anything.
    pub(super) fn samples_of(&self, column: u32, row: u32) -> impl Iterator<Item = &Sample> {
        let first = [column, row].map(|pixel| (pixel * SAMPLES) as usize);
        let all = (0..(SAMPLES * SAMPLES) as usize)
            .map(move |at| [first[0] + at % SAMPLES as usize, first[1] + at / SAMPLES as usize]);
        all.filter_map(|[x, y]| self.samples[y * SIDE + x].as_ref())
    }

    /// The normals of all samples that see anything, with their places across and down, 0..=1.
    pub(super) fn normals(&self) -> impl Iterator<Item = (Vec2, Vec3)> {
        self.samples.iter().enumerate().filter_map(|(index, sample)| {
            let at = Vec2::new((index % SIDE) as f32 + 0.5, (index / SIDE) as f32 + 0.5) / SIDE as f32;
            sample.map(|sample| (at, sample.normal))
        })
    }
}

/// The samples whose centers a triangle may cover: first, and past the last.
fn window(corners: &[Vec2; 3]) -> ([usize; 2], [usize; 2]) {
    let [a, b, c] = *corners;
    let low = a.min(b).min(c).max(Vec2::ZERO);
    let high = a.max(b).max(c).max(Vec2::ZERO);
    let from = low.to_array().map(|side| (side as usize).min(SIDE));
    (from, [(high.x.ceil() as usize).clamp(from[0], SIDE), (high.y.ceil() as usize).clamp(from[1], SIDE)])
}

/// Color in linear light and unit normal; `None` where the surface has a hole.
fn looks(
    source: &ImpostorSource<'_>,
    material: &Material,
    corners: [&DrawVertex; 3],
    shares: [f32; 3],
) -> Option<(Vec3, Vec3)> {
    let mean = |value: &dyn Fn(&DrawVertex) -> Vec3| {
        corners.iter().zip(shares).fold(Vec3::ZERO, |sum, (corner, share)| sum + value(corner) * share)
    };
    let texel = material.texture.and_then(|id| {
        texel(
            source.textures.get(id.0 as usize)?,
            mean(&|vertex| Vec2::from(vertex.uv).extend(0.0)).truncate(),
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

/// The nearest pixel of a texture that repeats; `None` where it is empty.
fn texel(texture: &Pixels, uv: Vec2) -> Option<Srgba> {
    let size = [texture.width(), texture.height()];
    if size.contains(&0) {
        return None;
    }
    let place = |share: f32, side: u32| (((share - share.floor()) * side as f32) as u32).min(side - 1);
    Some(texture.at(place(uv.x, size[0]), place(uv.y, size[1])))
}

/// A texture halved until no side is longer than [`MOST_TEXTURE_SIDE`].
fn reduced(texture: &Pixels) -> Pixels {
    let step = texture.width().max(texture.height()).div_ceil(MOST_TEXTURE_SIDE);
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

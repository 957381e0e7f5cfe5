//! Impostors: pictures of a model from all sides, one of which replaces it where it is small.
//!
//! # How
//! ```text
//!   rings of views, by the eye's elevation        one view: a quad across its direction,
//!   90° ─ 1     60° ─ 21                          cropped to what the model covers there
//!   32° ─ 21     5° ─ 21     64 in all                ┌──▲──┐
//!                                                     │ ▲▲▲ │  alpha: share covered
//!   texture: 8 × 8 tiles, a view each                 │  ┃  │  color: without light
//!                                                     └──╨──┘
//! ```
//! The quad of the view nearest to the eye is drawn like any other mesh: two triangles, a masked texture, normals at its
//! corners. So both renderers and the exporter draw impostors without knowing of them, light is computed when they are
//! drawn, and a model turned about its axis shows another side.
//!
//! The normals are the affine function on the quad that fits the model's best; both triangles reproduce it, so a round
//! crown is lit as one. The alpha cutoff keeps the area that the model covers from afar; with a cutoff of one half, fine
//! twigs would vanish with distance.
//!
//! # Why not the obvious way
//! Two crossed quads show each other's edges, are lit as two boards and have no top. Blended views (octahedral impostors)
//! need a shader in each renderer for a difference that is invisible at thirty pixels.

use glam::{DMat3, DVec3, Vec2, Vec3};
use rayon::prelude::*;

use crate::impostor_raster::{ImpostorRaster, ImpostorSource, SAMPLES};
use crate::{Model, ModelPart};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, DrawVertex};
use sandtable_draw::material::{AlphaMode, Material};
use sandtable_draw::pixels::Pixels;
use sandtable_mesh::sink::MeshSink;

/// Pixels along the side of a tile: twice the size at which an impostor is drawn, so that masks stay crisp.
pub(super) const TILE: u32 = 64;

/// Empty pixels along the border of a tile: two mip levels keep neighbors apart.
const GUTTER: u32 = 4;

/// Pixels along the side of the view in a tile.
pub(super) const INNER: u32 = TILE - 2 * GUTTER;

/// Tiles along the side of the texture.
const TILES: u32 = 8;

/// Views around each ring; three rings and the view from above fill the texture.
const AROUND: usize = 21;

/// The elevations of the rings in degrees: eyes over a landscape look a little down, maps straight down.
const RINGS_DEG: [f32; 4] = [5.0, 32.0, 60.0, 90.0];

const VIEWS: usize = AROUND * (RINGS_DEG.len() - 1) + 1;

/// Models of fewer triangles have no impostor: the quad would cost about as much.
const MIN_TRIANGLES: usize = 16;

/// One of the views of every impostor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ImpostorDirection(u8);

/// Pictures of a model from all sides.
#[derive(Clone, Debug)]
pub struct Impostor {
    /// A quad for each view, in the model's space.
    pub mesh: DrawMesh,
    /// The pictures.
    pub texture: Pixels,
    /// How the quads are drawn; without the texture's id.
    pub material: Material,
}

impl ImpostorDirection {
    /// The view nearest to the direction `toward_eye` in the model's space, which must not be zero.
    pub fn nearest(toward_eye: Vec3) -> Self {
        let elevation = libm::atan2f(toward_eye.z, toward_eye.truncate().length()).to_degrees();
        let ring = RINGS_DEG.windows(2).filter(|pair| elevation > (pair[0] + pair[1]) * 0.5).count();
        if ring == RINGS_DEG.len() - 1 {
            return Self(VIEWS as u8 - 1);
        }
        let turns = libm::atan2f(toward_eye.y, toward_eye.x) / std::f32::consts::TAU;
        let step = (turns * AROUND as f32).round().rem_euclid(AROUND as f32) as usize % AROUND;
        Self((ring * AROUND + step) as u8)
    }

    /// The triangles of [`Impostor::mesh`] that show this view.
    pub fn triangles(self) -> std::ops::Range<u32> {
        let first = u32::from(self.0) * 2;
        first..first + 2
    }

    fn axes(self) -> ViewAxes {
        let (ring, step) = (usize::from(self.0) / AROUND, usize::from(self.0) % AROUND);
        let (sin_up, cos_up) = libm::sincosf(RINGS_DEG[ring].to_radians());
        let (sin, cos) = libm::sincosf(step as f32 / AROUND as f32 * std::f32::consts::TAU);
        let toward_eye = Vec3::new(cos_up * cos, cos_up * sin, sin_up);
        let right = Vec3::new(-sin, cos, 0.0);
        ViewAxes { right, up: toward_eye.cross(right), toward_eye }
    }
}

/// The orthonormal axes of a view in the model's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewAxes {
    pub right: Vec3,
    pub up: Vec3,
    pub toward_eye: Vec3,
}

struct ImpostorView {
    pixels: Vec<Srgba>,
    corners: [DrawVertex; 4],
}

impl Impostor {
    /// The impostor of `model`, drawn from `parts`: its own or those of a coarser level.
    ///
    /// `None` where a picture would fail or not pay: few triangles, blended materials, nothing to see, or hundreds of
    /// triangles on top of each other.
    pub fn new(model: &Model, parts: &[ModelPart]) -> Option<Self> {
        let is_blended =
            |part: &ModelPart| model.materials[part.material.0 as usize].alpha == AlphaMode::Blend;
        if model.triangle_count() < MIN_TRIANGLES || model.parts.iter().any(is_blended) {
            return None;
        }
        let source = ImpostorSource::new(model, parts)?;
        let views: Vec<ImpostorView> = (0..VIEWS as u8)
            .into_par_iter()
            .map(|view| ImpostorView::draw(&source, ImpostorDirection(view)))
            .collect::<Option<_>>()?;
        let mut mesh = DrawMesh::default();
        for view in &views {
            let [a, b, c, d] = view.corners.map(|corner| mesh.vertex(corner));
            mesh.triangle([a, b, c]);
            mesh.triangle([a, c, d]);
        }
        let texture = Pixels::from_fn(TILE * TILES, TILE * TILES, |x, y| {
            let view = &views[(y / TILE * TILES + x / TILE) as usize];
            view.pixels[(y % TILE * TILE + x % TILE) as usize]
        });
        let material = Material {
            name: "impostor".into(),
            alpha: AlphaMode::Mask(area_keeping_cutoff(&views)),
            two_sided: true,
            ..Material::default()
        };
        Some(Self { mesh, texture, material })
    }
}

impl ImpostorView {
    fn draw(source: &ImpostorSource<'_>, view: ImpostorDirection) -> Option<Self> {
        let axes = view.axes();
        let raster = ImpostorRaster::new(source, &axes)?;
        let normals = QuadNormals::fit(&raster);
        // The mean of normals is shorter than they are, and so is the sunlight on them. Renderers normalize it; half of
        // what that adds is taken back here, as about half of all light is the sun's.
        let color = Srgba::from_linear(Vec3::splat((1.0 + normals.mean_length(&raster)) * 0.5));
        let corner = |across: f32, down: f32| {
            let at = raster.low + (raster.high - raster.low) * Vec2::new(across, 1.0 - down);
            let [left, top] = [u32::from(view.0) % TILES, u32::from(view.0) / TILES]
                .map(|tile| (tile * TILE + GUTTER) as f32);
            let uv =
                Vec2::new(left + across * INNER as f32, top + down * INNER as f32) / (TILE * TILES) as f32;
            let position = axes.right * at.x + axes.up * at.y + axes.toward_eye * source.depth(&axes);
            DrawVertex {
                position: position.to_array(),
                normal: normals.at(Vec2::new(across, down), axes.toward_eye).to_array(),
                uv: uv.to_array(),
                color,
            }
        };
        let corners = [corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0), corner(0.0, 0.0)];
        Some(Self { pixels: tile(&raster), corners })
    }
}

/// The raster's samples as a tile with its gutter: color, and in alpha the share of each pixel that is covered.
fn tile(raster: &ImpostorRaster) -> Vec<Srgba> {
    let mut pixels = vec![Srgba([0; 4]); (TILE * TILE) as usize];
    for row in 0..INNER {
        for column in 0..INNER {
            let covered = raster.samples_of(column, row);
            let (count, sum) =
                covered.fold((0u32, Vec3::ZERO), |(count, sum), sample| (count + 1, sum + sample.color));
            if count > 0 {
                let Srgba([red, green, blue, _]) = Srgba::from_linear(sum / count as f32);
                let alpha = (count * 255 + SAMPLES * SAMPLES / 2) / (SAMPLES * SAMPLES);
                pixels[((row + GUTTER) * TILE + column + GUTTER) as usize] =
                    Srgba([red, green, blue, alpha as u8]);
            }
        }
    }
    pixels
}

/// The alpha cutoff that keeps the covered area where four pixels of a tile are seen as one.
fn area_keeping_cutoff(views: &[ImpostorView]) -> f32 {
    /// A smaller cutoff would turn thin things to noise, a larger one erode the borders of solids.
    const RANGE: [f32; 2] = [0.15, 0.6];
    const CELL: usize = 4;
    let mut sums = Vec::new();
    for view in views {
        for row in (0..TILE as usize).step_by(CELL) {
            for column in (0..TILE as usize).step_by(CELL) {
                let cell = (0..CELL * CELL).map(|at| (row + at / CELL) * TILE as usize + column + at % CELL);
                sums.push(cell.map(|at| u32::from(view.pixels[at].0[3])).sum::<u32>());
            }
        }
    }
    sums.sort_unstable_by(|a, b| b.cmp(a));
    let full = (255 * CELL * CELL) as u64;
    let covered = sums.iter().map(|&sum| u64::from(sum)).sum::<u64>() / full;
    let cutoff = sums.get(covered as usize).copied().unwrap_or(0);
    (cutoff as f32 / full as f32).clamp(RANGE[0], RANGE[1])
}

struct QuadNormals {
    mean: Vec3,
    across: Vec3,
    down: Vec3,
}

impl QuadNormals {
    /// The least-squares fit to the raster's normals; their mean where the samples are on a line.
    fn fit(raster: &ImpostorRaster) -> Self {
        let (mut matrix, mut sums) = (DMat3::ZERO, [DVec3::ZERO; 3]);
        for (place, normal) in raster.normals() {
            let terms = DVec3::new(1.0, place.x.into(), place.y.into());
            matrix += DMat3::from_cols(terms, terms * terms.y, terms * terms.z);
            for (sum, term) in sums.iter_mut().zip(terms.to_array()) {
                *sum += normal.as_dvec3() * term;
            }
        }
        let one = matrix.x_axis.x;
        if matrix.determinant().abs() <= 1e-9 * one * one * one {
            let mean = (sums[0] / one.max(1.0)).as_vec3();
            return Self { mean, across: Vec3::ZERO, down: Vec3::ZERO };
        }
        let inverse = matrix.inverse();
        let row = |row: usize| {
            (sums[0] * inverse.col(0)[row] + sums[1] * inverse.col(1)[row] + sums[2] * inverse.col(2)[row])
                .as_vec3()
        };
        Self { mean: row(0), across: row(1), down: row(2) }
    }

    /// The mean length of the fitted normals over the covered samples; 1 where nothing is covered.
    fn mean_length(&self, raster: &ImpostorRaster) -> f32 {
        let lengths =
            raster.normals().map(|(at, _)| (self.mean + self.across * at.x + self.down * at.y).length());
        let (sum, count) =
            lengths.fold((0.0, 0.0), |(sum, count), length| (sum + f64::from(length), count + 1.0));
        if count > 0.0 { ((sum / count) as f32).min(1.0) } else { 1.0 }
    }

    /// The normal at a place of the quad, not longer than 1; `fallback` where its length is nearly 0.
    fn at(&self, place: Vec2, fallback: Vec3) -> Vec3 {
        let normal = self.mean + self.across * place.x + self.down * place.y;
        if normal.length_squared() > 1e-6 { normal } else { fallback }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::list::MaterialId;

    /// A ball of radius 2 around (5, 0, 2), its upper half red.
    fn ball() -> Model {
        let mut mesh = DrawMesh::default();
        let (rows, columns) = (12u32, 24u32);
        for row in 0..=rows {
            for column in 0..=columns {
                let (sin, cos) = libm::sincosf(row as f32 / rows as f32 * std::f32::consts::PI);
                let (east, north) = libm::sincosf(column as f32 / columns as f32 * std::f32::consts::TAU);
                let normal = Vec3::new(sin * north, sin * east, cos);
                mesh.vertex(DrawVertex {
                    position: (normal * 2.0 + Vec3::new(5.0, 0.0, 2.0)).to_array(),
                    normal: normal.to_array(),
                    uv: [0.0; 2],
                    color: if normal.z > 0.0 { Srgba::opaque(255, 0, 0) } else { Srgba::WHITE },
                });
            }
        }
        let id = |column: u32, row: u32| sandtable_mesh::sink::VertexId(row * (columns + 1) + column);
        for row in 0..rows {
            for column in 0..columns {
                mesh.triangle([id(column, row), id(column, row + 1), id(column + 1, row + 1)]);
                mesh.triangle([id(column, row), id(column + 1, row + 1), id(column + 1, row)]);
            }
        }
        let part = ModelPart { name: "ball".into(), mesh, material: MaterialId(0) };
        Model { parts: vec![part], materials: vec![Material::default()], ..Model::default() }
    }

    fn impostor() -> Impostor {
        let model = ball();
        Impostor::new(&model, &model.parts).expect("a ball can be pictured")
    }

    #[test]
    fn the_quad_of_every_view_is_across_its_direction_around_the_model() {
        let impostor = impostor();
        assert_eq!(impostor.mesh.triangles.len(), VIEWS * 2);
        for view in (0..VIEWS as u8).map(ImpostorDirection) {
            let toward_eye = view.axes().toward_eye;
            assert_eq!(ImpostorDirection::nearest(toward_eye), view);
            let range = view.triangles();
            for triangle in &impostor.mesh.triangles[range.start as usize..range.end as usize] {
                let corners = triangle.map(|id| Vec3::from(impostor.mesh.vertices[id.index()].position));
                let [a, b, c] = corners;
                assert!((b - a).cross(c - a).normalize().dot(toward_eye) > 0.999);
                let center = Vec3::new(5.0, 0.0, 2.0);
                assert!(corners.iter().all(|corner| (corner.distance(center) - 8f32.sqrt()).abs() < 0.1));
            }
        }
    }

    #[test]
    fn a_ball_covers_a_disc_and_shows_its_colors_in_place() {
        let impostor = impostor();
        let level = (0..TILE * TILE).map(|at| impostor.texture.at(at % TILE, at / TILE));
        let covered: f32 = level.map(Srgba::alpha).sum();
        let disc = std::f32::consts::FRAC_PI_4 * (INNER * INNER) as f32;
        assert!((covered / disc - 1.0).abs() < 0.02, "{covered} of {disc}");
        let [top, foot] = [8, 55].map(|row| impostor.texture.at(TILE / 2, row));
        assert_eq!((top, foot), (Srgba::opaque(255, 0, 0), Srgba::WHITE));
        assert!(matches!(impostor.material.alpha, AlphaMode::Mask(cutoff) if (0.3..=0.6).contains(&cutoff)));
    }

    #[test]
    fn normals_at_the_corners_lean_outward_as_those_of_the_ball() {
        let impostor = impostor();
        for view in (0..VIEWS as u8).map(ImpostorDirection) {
            let ViewAxes { right, up, toward_eye } = view.axes();
            let first = usize::from(view.0) * 4;
            let normals: Vec<Vec3> =
                impostor.mesh.vertices[first..first + 4].iter().map(|vertex| vertex.normal.into()).collect();
            assert!(normals.iter().all(|normal| normal.dot(toward_eye) > 0.3));
            assert!(normals[1].dot(right) > 0.3 && normals[0].dot(right) < -0.3);
            assert!(normals[2].dot(up) > 0.3 && normals[1].dot(up) < -0.3);
        }
    }

    #[test]
    fn blended_and_empty_models_have_no_impostor() {
        let mut glass = ball();
        glass.materials[0].alpha = AlphaMode::Blend;
        assert!(Impostor::new(&glass, &glass.parts).is_none());
        assert!(Impostor::new(&Model::default(), &[]).is_none());
    }
}

//! The triangles of a draw list in the space of a light.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{DMat4, Vec2, Vec3};
use rayon::prelude::*;

use crate::cpu::alpha::AlphaMask;
use crate::mip_levels::smaller_levels;
use crate::shadow::LightAxes;
use crate::shadow::cut::cut_at;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList};
use sandtable_draw::material::AlphaMode;
use sandtable_mesh::sink::VertexId;
use sandtable_view::camera::{Camera, ParallelFrame};

/// How far outside the picture a corner still counts as seen, as a share of its half.
const SEEN_MARGIN: f32 = 1.05;

/// Corners farther from the eye than this, in meters, are left out: squares of it are still finite.
const FARTHEST_M: f32 = 1e15;

/// Corners up to here, in meters from the eye, are those of real scenes, which adapters clip as the processor does: a
/// quarter of the way around the Earth.
const FARTHEST_REAL_M: f32 = 1e7;

/// A finite triangle, in meters from the eye.
#[derive(Clone, Copy, Debug)]
pub struct CasterTriangle {
    pub corners: [Vec3; 3],
    pub item: u32,
    pub triangle: u32,
}

/// A box across the light, in meters from the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBox {
    pub low: Vec2,
    pub high: Vec2,
}

/// The use of a list's triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriangleUse {
    /// Maps are planned and drawn.
    Draw,
    /// Maps are planned alone: of the ground its depths are needed.
    Plan,
}

/// The shadow casters of a list, along the world's axes.
#[derive(Debug)]
pub struct ListTriangles {
    /// Of solids that cast shadows, in the list's order; never empty.
    pub solids: Vec<CasterTriangle>,
    /// Of the ground; none for [`TriangleUse::Plan`].
    pub ground: Vec<CasterTriangle>,
    /// The least and greatest depth of what is seen, in meters; above 0 in perspective.
    pub depths_m: [f32; 2],
    /// The masks of the textures of solids, by texture; none for [`TriangleUse::Plan`].
    pub masks: BTreeMap<u32, AlphaMask>,
    /// Whether every corner is finite and no farther away than those of real scenes; for [`TriangleUse::Plan`].
    pub is_real: bool,
}

/// What a plan knows of triangles that it does not keep.
#[derive(Clone, Copy, Debug)]
struct TriangleMeasure {
    /// [`seen_depths`].
    depths_m: [f32; 2],
    is_real: bool,
}

/// Triangles along the axes of a light, each with its box.
#[derive(Debug)]
pub struct LightTriangles {
    pub triangles: Vec<(CasterTriangle, LightBox)>,
    pub bounds: LightBox,
}

impl LightBox {
    pub const EMPTY: Self = Self { low: Vec2::INFINITY, high: Vec2::NEG_INFINITY };

    pub fn around(corners: &[Vec3]) -> Self {
        corners.iter().fold(Self::EMPTY, |bounds, corner| {
            let at = corner.truncate();
            Self { low: bounds.low.min(at), high: bounds.high.max(at) }
        })
    }

    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    pub fn intersection(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    pub fn grown(self, by: f32) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    pub fn is_empty(&self) -> bool {
        !(self.low.x <= self.high.x && self.low.y <= self.high.y)
    }
}

impl ListTriangles {
    /// The memory that the triangles of a checked list take, with those along the light of a map; 0 where no solid casts.
    pub fn bytes_of(list: &DrawList, wanted: TriangleUse) -> u64 {
        const COLLECTED: u64 = 2;
        const BYTES: u64 = COLLECTED * (size_of::<CasterTriangle>() + LightTriangles::BYTES) as u64;
        if !list.items.iter().any(|item| is_caster(list, item)) {
            return 0;
        }
        let has_ground = wanted == TriangleUse::Draw;
        let counted = list
            .items
            .iter()
            .filter(|item| (has_ground && item.layer == DepthLayer::Ground) || is_caster(list, item));
        counted.map(|item| item.triangles.len() as u64).sum::<u64>() * BYTES
    }

    /// The shadow casters of a checked list; `None` where no solid casts or nothing is seen.
    pub fn new(list: &DrawList, camera: &Camera, wanted: TriangleUse) -> Option<Self> {
        let is_caster = |item: &DrawItem| is_caster(list, item);
        let first = list.items.partition_point(|item| item.layer < DepthLayer::Solid);
        if !list.items[first..].iter().any(is_caster) {
            return None;
        }
        let ground_end = list.items.partition_point(|item| item.layer == DepthLayer::Ground);
        let portions = |items: Range<usize>| -> Vec<(usize, Range<u32>)> {
            let casting = items.filter(|&index| index < first || is_caster(&list.items[index]));
            casting.flat_map(|index| portions(&list.items[index]).map(move |part| (index, part))).collect()
        };
        let collected = |portions: Vec<(usize, Range<u32>)>| -> Vec<CasterTriangle> {
            let lists: Vec<_> = portions
                .into_par_iter()
                .fold(Vec::new, |mut triangles, (index, part)| {
                    add_triangles(&mut triangles, list, camera.eye(), (index, part));
                    triangles
                })
                .collect();
            lists.concat()
        };
        let measured = |portions: Vec<(usize, Range<u32>)>| {
            let of_portion = |(index, part): (usize, Range<u32>)| {
                let (mut triangles, wanted) = (Vec::new(), part.len());
                add_triangles(&mut triangles, list, camera.eye(), (index, part));
                TriangleMeasure::new(&triangles, wanted, camera)
            };
            let none = || TriangleMeasure::new(&[], 0, camera);
            portions.into_par_iter().map(of_portion).reduce(none, TriangleMeasure::and)
        };
        let (of_solids, of_ground) = (portions(first..list.items.len()), portions(0..ground_end));
        let solid_count = of_solids.iter().map(|(_, part)| part.len()).sum();
        let solids = collected(of_solids);
        let (ground, depths_m, is_real) = match wanted {
            TriangleUse::Draw => {
                let ground = collected(of_ground);
                let [of_solids, of_ground] =
                    [&solids, &ground].map(|triangles| seen_depths(triangles, camera));
                (ground, wider(of_solids, of_ground), false)
            }
            TriangleUse::Plan => {
                let of_solids = TriangleMeasure::new(&solids, solid_count, camera);
                let TriangleMeasure { depths_m, is_real } = of_solids.and(measured(of_ground));
                (Vec::new(), depths_m, is_real)
            }
        };
        let masks = match wanted {
            TriangleUse::Draw => masks(list, &list.items[first..]),
            TriangleUse::Plan => BTreeMap::new(),
        };
        let is_seen = !solids.is_empty() && depths_m[0] <= depths_m[1];
        is_seen.then_some(Self { solids, ground, depths_m, masks, is_real })
    }
}

impl TriangleMeasure {
    /// That of what is left of so many triangles.
    fn new(triangles: &[CasterTriangle], count: usize, camera: &Camera) -> Self {
        let is_near = |corner: &Vec3| corner.abs().cmple(Vec3::splat(FARTHEST_REAL_M)).all();
        let all_near = || triangles.iter().all(|triangle| triangle.corners.iter().all(is_near));
        let is_real = triangles.len() == count && all_near();
        Self { depths_m: seen_depths(triangles, camera), is_real }
    }

    fn and(self, other: Self) -> Self {
        let is_real = self.is_real && other.is_real;
        Self { depths_m: wider(self.depths_m, other.depths_m), is_real }
    }
}

/// Whether an item of a checked list casts a shadow.
fn is_caster(list: &DrawList, item: &DrawItem) -> bool {
    let alpha = list.materials[item.material.0 as usize].alpha;
    item.layer == DepthLayer::Solid && alpha != AlphaMode::Blend && !item.triangles.is_empty()
}

impl LightTriangles {
    /// The bytes of a triangle.
    const BYTES: usize = size_of::<(CasterTriangle, LightBox)>();

    /// `triangles` along `axes`, those of them whose box `is_near`.
    pub fn new(
        triangles: &[CasterTriangle],
        axes: &LightAxes,
        is_near: impl Fn(LightBox) -> bool + Sync,
    ) -> Self {
        let turned = |triangle: &CasterTriangle| {
            let [a, b, c] = triangle.corners;
            let corners = [axes.turned(a), axes.turned(b), axes.turned(c)];
            let [a, b, c] = corners.map(Vec3::truncate);
            let bounds = LightBox { low: a.min(b).min(c), high: a.max(b).max(c) };
            is_near(bounds).then_some((CasterTriangle { corners, ..*triangle }, bounds))
        };
        let triangles: Vec<_> = triangles.par_iter().with_min_len(1024).filter_map(turned).collect();
        let bounds = triangles.iter().fold(LightBox::EMPTY, |all, (_, bounds)| all.union(*bounds));
        Self { triangles, bounds }
    }
}

/// The triangles of an item in ranges for which threads work apart.
fn portions(item: &DrawItem) -> impl Iterator<Item = Range<u32>> + use<> {
    /// Triangles of a portion: some tenths of a millisecond.
    const PORTION: u32 = 4096;
    let Range { start, end } = item.triangles;
    (start..end).step_by(PORTION as usize).map(move |from| from..from.saturating_add(PORTION).min(end))
}

/// Adds the finite triangles of a part of an item.
fn add_triangles(
    triangles: &mut Vec<CasterTriangle>,
    list: &DrawList,
    eye: Vec3,
    (index, part): (usize, Range<u32>),
) {
    let item = &list.items[index];
    let mesh = &list.meshes[item.mesh.0 as usize];
    let to_world: DMat4 = item.world_from_mesh.as_dmat4();
    let eye = eye.as_dvec3();
    let corner =
        |position: [f32; 3]| (to_world.transform_point3(Vec3::from(position).as_dvec3()) - eye).as_vec3();
    triangles.reserve(part.len());
    for triangle in part {
        let [a, b, c] = mesh.triangles[triangle as usize];
        let position = |id: VertexId| corner(mesh.vertices[id.index()].position);
        let corners = [position(a), position(b), position(c)];
        if corners.iter().all(|corner| corner.abs().max_element() < FARTHEST_M) {
            triangles.push(CasterTriangle { corners, item: index as u32, triangle });
        }
    }
}

/// The least and greatest depth of what the camera sees, in meters: in perspective of corners, with parallel rays of
/// triangles, since there one map must hold all of it; the first is the greater where it sees nothing.
fn seen_depths(triangles: &[CasterTriangle], camera: &Camera) -> [f32; 2] {
    if let Some(frame) = camera.parallel_frame() {
        return depths_in_frame(triangles, camera, frame);
    }
    let tan = camera.tan_half_fov() * SEEN_MARGIN;
    let (near, far) = camera.planes();
    let (right, up) = (camera.right() / tan.x, camera.up() / tan.y);
    let widened = |[least, most]: [f32; 2], triangle: &CasterTriangle| {
        let mut range = [least, most];
        for corner in &triangle.corners {
            let depth = corner.dot(camera.forward());
            let is_seen = depth > near
                && depth < far
                && corner.dot(right).abs() <= depth
                && corner.dot(up).abs() <= depth;
            if is_seen {
                range = [range[0].min(depth), range[1].max(depth)];
            }
        }
        range
    };
    let none = || [f32::MAX, 0.0];
    triangles.par_iter().with_min_len(1024).fold(none, widened).reduce(none, wider)
}

/// The wider of two ranges of depths.
fn wider(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// The least and greatest depth of what parallel rays see of triangles; no plane cuts it off.
fn depths_in_frame(
    triangles: &[CasterTriangle],
    camera: &Camera,
    ParallelFrame { half_m, .. }: ParallelFrame,
) -> [f32; 2] {
    let half = half_m * SEEN_MARGIN;
    let widened = |range: [f32; 2], triangle: &CasterTriangle| {
        let seen = triangle.corners.map(|corner| {
            let across = Vec2::new(corner.dot(camera.right()), corner.dot(camera.up()));
            (across / half).extend(corner.dot(camera.forward()))
        });
        wider(range, depths_in_square(&seen))
    };
    let none = || [f32::MAX, f32::MIN];
    triangles.par_iter().with_min_len(1024).fold(none, widened).reduce(none, wider)
}

/// The least and greatest Z of the part of a triangle between −1 and 1 along X and Y; the first is the greater where there
/// is none.
fn depths_in_square(corners: &[Vec3; 3]) -> [f32; 2] {
    let range = |corners: &[Vec3]| {
        corners.iter().fold([f32::MAX, f32::MIN], |range, corner| wider(range, [corner.z, corner.z]))
    };
    let [a, b, c] = corners.map(Vec3::truncate);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    if low.min_element() >= -1.0 && high.max_element() <= 1.0 {
        return range(corners);
    }
    if low.max_element() > 1.0 || high.min_element() < -1.0 {
        return range(&[]);
    }
    let mut outline = corners.to_vec();
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
        outline = cut_at(&outline, |corner| 1.0 - sign * corner[axis]);
    }
    range(&outline)
}

fn masks(list: &DrawList, solids: &[DrawItem]) -> BTreeMap<u32, AlphaMask> {
    let mut masks = BTreeMap::new();
    for item in solids {
        let material = &list.materials[item.material.0 as usize];
        if let (AlphaMode::Mask(_), Some(id)) = (material.alpha, material.texture) {
            masks.entry(id.0).or_insert_with(|| {
                let base = &list.textures[id.0 as usize];
                AlphaMask::new(base, &smaller_levels(base))
            });
        }
    }
    masks
}

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

/// The triangles that a thread turns toward the light in one go.
const TURNED: usize = 1024;

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

/// The shadow casters of a list, along the world's axes.
#[derive(Debug)]
pub struct ListTriangles {
    /// Of solids that cast shadows, in the list's order; never empty.
    pub solids: Vec<CasterTriangle>,
    /// Of the ground.
    pub ground: Vec<CasterTriangle>,
    /// The least and greatest depth of what is seen, in meters; above 0 in perspective.
    pub depths_m: [f32; 2],
    /// The masks of the textures of solids, by texture.
    pub masks: BTreeMap<u32, AlphaMask>,
}

/// Triangles along the axes of a light, or what of them is needed, each with its box.
#[derive(Debug)]
pub struct LightTriangles<T = CasterTriangle> {
    pub triangles: Vec<(T, LightBox)>,
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

    pub fn of_triangle(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3::truncate);
        Self { low: a.min(b).min(c), high: a.max(b).max(c) }
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
    pub fn bytes_of(list: &DrawList) -> u64 {
        const COLLECTED: u64 = 2;
        const BYTES: u64 = COLLECTED * (size_of::<CasterTriangle>() + LightTriangles::BYTES) as u64;
        if !list.items.iter().any(|item| is_caster(list, item)) {
            return 0;
        }
        let counted =
            list.items.iter().filter(|item| item.layer == DepthLayer::Ground || is_caster(list, item));
        counted.map(|item| item.triangles.len() as u64).sum::<u64>() * BYTES
    }

    /// The shadow casters of a checked list; `None` where no solid casts or nothing is seen.
    pub fn new(list: &DrawList, camera: &Camera) -> Option<Self> {
        let is_caster = |item: &DrawItem| is_caster(list, item);
        let first = list.items.partition_point(|item| item.layer < DepthLayer::Solid);
        if !list.items[first..].iter().any(is_caster) {
            return None;
        }
        let ground_end = list.items.partition_point(|item| item.layer == DepthLayer::Ground);
        let triangles = |items: Range<usize>| -> Vec<CasterTriangle> {
            let lists: Vec<_> = portions(list, items)
                .into_par_iter()
                .fold(Vec::new, |mut triangles, (index, part)| {
                    add_triangles(&mut triangles, list, camera.eye(), (index, part));
                    triangles
                })
                .collect();
            lists.concat()
        };
        let (solids, ground) = (triangles(first..list.items.len()), triangles(0..ground_end));
        let [of_solids, of_ground] = [&solids, &ground].map(|triangles| seen_depths(triangles, camera));
        let depths_m = [of_solids[0].min(of_ground[0]), of_solids[1].max(of_ground[1])];
        let masks = masks(list, &list.items[first..]);
        (!solids.is_empty() && depths_m[0] <= depths_m[1]).then_some(Self { solids, ground, depths_m, masks })
    }
}

/// Whether an item of a checked list casts a shadow.
pub fn is_caster(list: &DrawList, item: &DrawItem) -> bool {
    let alpha = list.materials[item.material.0 as usize].alpha;
    item.layer == DepthLayer::Solid && alpha != AlphaMode::Blend && !item.triangles.is_empty()
}

impl LightTriangles {
    /// The bytes of a triangle.
    const BYTES: usize = size_of::<(CasterTriangle, LightBox)>();

    /// `triangles` along `axes`.
    pub fn new(triangles: &[CasterTriangle], axes: &LightAxes) -> Self {
        Self::around(
            triangles.par_iter().with_min_len(TURNED).map(|triangle| triangle.turned(axes)).collect(),
        )
    }

    /// As [`Self::new`], those of them whose box `is_near`.
    pub fn near(
        triangles: &[CasterTriangle],
        axes: &LightAxes,
        is_near: impl Fn(LightBox) -> bool + Sync,
    ) -> Self {
        let turned = triangles.par_iter().with_min_len(TURNED).map(|triangle| triangle.turned(axes));
        Self::around(turned.filter(|(_, bounds)| is_near(*bounds)).collect())
    }

    fn around(triangles: Vec<(CasterTriangle, LightBox)>) -> Self {
        let boxes = triangles.par_iter().with_min_len(TURNED).map(|(_, bounds)| *bounds);
        let bounds = boxes.reduce(|| LightBox::EMPTY, LightBox::union);
        Self { triangles, bounds }
    }
}

impl CasterTriangle {
    /// The triangle along `axes`, and its box.
    fn turned(&self, axes: &LightAxes) -> (Self, LightBox) {
        let corners = self.corners.map(|corner| axes.turned(corner));
        (Self { corners, ..*self }, LightBox::of_triangle(corners))
    }
}

/// The triangles of the ground and of casters among these items of a checked list, by item, in ranges for which threads
/// work apart.
pub fn portions(list: &DrawList, items: Range<usize>) -> Vec<(usize, Range<u32>)> {
    /// Triangles of a portion: some tenths of a millisecond.
    const PORTION: u32 = 4096;
    let casting = items.filter(|&index| {
        let item = &list.items[index];
        item.layer == DepthLayer::Ground || is_caster(list, item)
    });
    let of_item = |index: usize| {
        let Range { start, end } = list.items[index].triangles;
        let starts = (start..end).step_by(PORTION as usize);
        starts.map(move |from| (index, from..from.saturating_add(PORTION).min(end)))
    };
    casting.flat_map(of_item).collect()
}

/// Adds the finite triangles of a part of an item.
pub fn add_triangles(
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
pub fn seen_depths(triangles: &[CasterTriangle], camera: &Camera) -> [f32; 2] {
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
pub fn wider(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
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

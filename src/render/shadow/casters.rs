//! The triangles of a draw list in the space of a light.

use std::collections::BTreeMap;
use std::mem;
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

/// Triangles of a portion, which a thread works on in one go: some tenths of a millisecond.
const PORTION: u32 = 4096;

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

/// The shadow casters of a list, along the world's axes: in portions that are never joined, since that is work of one
/// thread.
#[derive(Debug)]
pub struct ListTriangles {
    /// Of solids that cast shadows, in the list's order; there is at least one.
    pub solids: Vec<Vec<CasterTriangle>>,
    /// Of the ground.
    pub ground: Vec<Vec<CasterTriangle>>,
    /// The least and greatest depth of what is seen, in meters; above 0 in perspective.
    pub depths_m: [f32; 2],
    /// The masks of the textures of solids, by texture.
    pub masks: BTreeMap<u32, AlphaMask>,
}

/// Triangles along the axes of a light, or what of them is needed, each with its box; in portions.
#[derive(Debug)]
pub struct LightTriangles<T = CasterTriangle> {
    pub portions: Vec<Vec<(T, LightBox)>>,
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
        // A portion of those near a light grows as they are found.
        const BYTES: u64 = (size_of::<CasterTriangle>() + 2 * LightTriangles::BYTES) as u64;
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
        let triangles = |items: Range<usize>| -> (Vec<Vec<CasterTriangle>>, [f32; 2]) {
            let of_portion = |portion: &Portion| {
                let triangles = portion_triangles(list, camera.eye(), portion);
                let depths_m = seen_depths(&triangles, camera);
                (triangles, depths_m)
            };
            let (portions, depths_m): (_, Vec<_>) = portions(list, items).par_iter().map(of_portion).unzip();
            (portions, depths_m.into_iter().fold([f32::MAX, f32::MIN], wider))
        };
        let (solids, of_solids) = triangles(first..list.items.len());
        let (ground, of_ground) = triangles(0..ground_end);
        let depths_m = wider(of_solids, of_ground);
        let masks = masks(list, &list.items[first..]);
        let has_any = solids.iter().any(|portion| !portion.is_empty());
        (has_any && depths_m[0] <= depths_m[1]).then_some(Self { solids, ground, depths_m, masks })
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

    /// Triangles along `axes`.
    pub fn new(portions: &[Vec<CasterTriangle>], axes: &LightAxes) -> Self {
        let turned =
            |portion: &Vec<CasterTriangle>| portion.iter().map(|triangle| triangle.turned(axes)).collect();
        Self::around(portions.par_iter().map(turned).collect())
    }

    /// As [`Self::new`], those of them whose box `is_near`.
    pub fn near(
        portions: &[Vec<CasterTriangle>],
        axes: &LightAxes,
        is_near: impl Fn(LightBox) -> bool + Sync,
    ) -> Self {
        let turned = |portion: &Vec<CasterTriangle>| {
            let turned = portion.iter().map(|triangle| triangle.turned(axes));
            turned.filter(|(_, bounds)| is_near(*bounds)).collect()
        };
        Self::around(portions.par_iter().map(turned).collect())
    }
}

impl<T: Sync> LightTriangles<T> {
    /// Triangles with the box around them all.
    pub fn around(portions: Vec<Vec<(T, LightBox)>>) -> Self {
        let of_portion = |portion: &Vec<(T, LightBox)>| {
            portion.iter().fold(LightBox::EMPTY, |all, (_, bounds)| all.union(*bounds))
        };
        let bounds = portions.par_iter().map(of_portion).reduce(|| LightBox::EMPTY, LightBox::union);
        Self { portions, bounds }
    }
}

impl CasterTriangle {
    /// The triangle along `axes`, and its box.
    fn turned(&self, axes: &LightAxes) -> (Self, LightBox) {
        let corners = self.corners.map(|corner| axes.turned(corner));
        (Self { corners, ..*self }, LightBox::of_triangle(corners))
    }
}

/// Parts of items, [`PORTION`] triangles or fewer together.
pub type Portion = Vec<(usize, Range<u32>)>;

/// The triangles of the ground and of casters among these items of a checked list, in its order.
pub fn portions(list: &DrawList, items: Range<usize>) -> Vec<Portion> {
    let casting = items.filter(|&index| {
        let item = &list.items[index];
        item.layer == DepthLayer::Ground || is_caster(list, item)
    });
    let (mut portions, mut portion, mut room) = (Vec::new(), Vec::new(), PORTION);
    for index in casting {
        let Range { mut start, end } = list.items[index].triangles;
        while start < end {
            let part = start..end.min(start.saturating_add(room));
            (start, room) = (part.end, room - part.len() as u32);
            portion.push((index, part));
            if room == 0 {
                portions.push(mem::take(&mut portion));
                room = PORTION;
            }
        }
    }
    if !portion.is_empty() {
        portions.push(portion);
    }
    portions
}

/// The finite triangles of a portion of a checked list.
pub fn portion_triangles(list: &DrawList, eye: Vec3, portion: &Portion) -> Vec<CasterTriangle> {
    let mut triangles = Vec::with_capacity(portion.iter().map(|(_, part)| part.len()).sum());
    for (index, part) in portion {
        let item = &list.items[*index];
        let mesh = &list.meshes[item.mesh.0 as usize];
        let to_world: DMat4 = item.world_from_mesh.as_dmat4();
        let eye = eye.as_dvec3();
        let corner =
            |position: [f32; 3]| (to_world.transform_point3(Vec3::from(position).as_dvec3()) - eye).as_vec3();
        for triangle in part.clone() {
            let [a, b, c] = mesh.triangles[triangle as usize];
            let position = |id: VertexId| corner(mesh.vertices[id.index()].position);
            let corners = [position(a), position(b), position(c)];
            if corners.iter().all(|corner| corner.abs().max_element() < FARTHEST_M) {
                triangles.push(CasterTriangle { corners, item: *index as u32, triangle });
            }
        }
    }
    triangles
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
    let widened = |mut range: [f32; 2], triangle: &CasterTriangle| {
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
    triangles.iter().fold([f32::MAX, 0.0], widened)
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
    triangles.iter().fold([f32::MAX, f32::MIN], widened)
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

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::*;
    use sandtable_draw::list::{DrawMesh, FeatureId};
    use sandtable_draw::material::Material;

    #[test]
    fn portions_hold_each_triangle_of_casters_once_and_in_order() {
        let mut list = DrawList::default();
        let material = list.add_material(Material::default());
        let mesh = list.add_mesh(DrawMesh::default());
        let counts = [1, 5000, 0, 3, 4092, 9000];
        for (feature, count) in (0..).map(FeatureId).zip(counts) {
            let layer = DepthLayer::Solid;
            let world_from_mesh = Mat4::IDENTITY;
            list.items.push(DrawItem {
                mesh,
                triangles: 7..7 + count,
                material,
                world_from_mesh,
                layer,
                feature,
            });
        }
        let portions = portions(&list, 0..counts.len());
        let sizes: Vec<usize> =
            portions.iter().map(|portion| portion.iter().map(|(_, part)| part.len()).sum()).collect();
        assert_eq!(sizes, [4096, 4096, 4096, 4096, 1712]);
        let held: Vec<_> = portions
            .iter()
            .flatten()
            .flat_map(|(index, part)| part.clone().map(move |triangle| (*index, triangle)))
            .collect();
        let all: Vec<_> = (counts.iter().enumerate())
            .flat_map(|(index, count)| (7..7 + count).map(move |triangle| (index, triangle)))
            .collect();
        assert_eq!(held, all);
    }
}

//! The triangles of a draw list in the space of a light.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3, Vec2, Vec3};
use rayon::prelude::*;

use crate::draw::list::{DepthLayer, DrawItem, DrawList};
use crate::draw::material::AlphaMode;
use crate::render::cpu::alpha::AlphaMask;
use crate::render::mip_levels::smaller_levels;
use crate::render::shadow::LightAxes;
use crate::view::camera::Camera;

/// How far outside the picture a corner still counts as seen, as a share of its half.
const SEEN_MARGIN: f32 = 1.05;

#[derive(Clone, Copy, Debug)]
pub struct CasterTriangle {
    /// Meters from the eye along the light's axes; finite.
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

/// The solids of a list that cast shadows, and the masks of their textures.
#[derive(Debug)]
pub struct Casters {
    pub axes: LightAxes,
    /// In the list's order.
    pub triangles: Vec<CasterTriangle>,
    pub bounds: LightBox,
    /// The least and greatest depth of what is seen, in meters; above 0.
    pub depths_m: [f32; 2],
    /// By texture.
    pub masks: BTreeMap<u32, AlphaMask>,
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

impl Casters {
    /// What casts shadows in a checked list; `None` where nothing does or nothing is seen.
    pub fn of_solids(list: &DrawList, camera: &Camera, axes: LightAxes) -> Option<Self> {
        let is_caster = |item: &DrawItem| {
            let alpha = list.materials[item.material.0 as usize].alpha;
            item.layer == DepthLayer::Solid && alpha != AlphaMode::Blend && !item.triangles.is_empty()
        };
        let first = list.items.partition_point(|item| item.layer < DepthLayer::Solid);
        let solids = &list.items[first..];
        if !solids.iter().any(is_caster) {
            return None;
        }
        let lists: Vec<_> = (first..list.items.len())
            .into_par_iter()
            .filter(|&index| is_caster(&list.items[index]))
            .map(|index| turned(list, camera.eye(), &axes, index))
            .collect();
        let triangles = lists.concat();
        let bounds = triangles.par_iter().map(|triangle| LightBox::around(&triangle.corners));
        let bounds = bounds.reduce(|| LightBox::EMPTY, LightBox::union);
        let depths_m = seen_depths(list, camera)?;
        (!bounds.is_empty()).then(|| Self { axes, triangles, bounds, depths_m, masks: masks(list, solids) })
    }
}

/// The triangles of the ground that lie over or under `bounds`.
pub fn ground_triangles(
    list: &DrawList,
    eye: Vec3,
    axes: &LightAxes,
    bounds: LightBox,
) -> Vec<CasterTriangle> {
    let end = list.items.partition_point(|item| item.layer == DepthLayer::Ground);
    let near =
        |triangle: &CasterTriangle| !LightBox::around(&triangle.corners).intersection(bounds).is_empty();
    (0..end).flat_map(|index| turned(list, eye, axes, index)).filter(near).collect()
}

/// The finite triangles of an item.
fn turned(list: &DrawList, eye: Vec3, axes: &LightAxes, index: usize) -> Vec<CasterTriangle> {
    let item = &list.items[index];
    let mesh = &list.meshes[item.mesh.0 as usize];
    let to_world: DMat4 = item.world_from_mesh.as_dmat4();
    let eye = eye.as_dvec3();
    let corner = |position: [f32; 3]| {
        let offset = to_world.transform_point3(DVec3::from(position.map(f64::from))) - eye;
        axes.turned(offset.as_vec3())
    };
    let triangles = item.triangles.clone().map(|triangle| {
        let ids = mesh.triangles[triangle as usize];
        let corners = ids.map(|id| corner(mesh.vertices[id.index()].position));
        CasterTriangle { corners, item: index as u32, triangle }
    });
    triangles.filter(|triangle| triangle.corners.iter().all(|corner| corner.is_finite())).collect()
}

/// The least and greatest depth of the vertices that the camera sees, in meters.
fn seen_depths(list: &DrawList, camera: &Camera) -> Option<[f32; 2]> {
    let tan = camera.tan_half_fov() * SEEN_MARGIN;
    let (near, far) = camera.planes();
    let of_item = |item: &DrawItem| {
        let mesh = &list.meshes[item.mesh.0 as usize];
        let ids = mesh.triangles[item.triangles.start as usize..item.triangles.end as usize].iter().flatten();
        ids.fold([f32::MAX, 0.0], |[least, most]: [f32; 2], id| {
            let position = Vec3::from(mesh.vertices[id.index()].position);
            let offset = item.world_from_mesh.transform_point3(position) - camera.eye();
            let depth = offset.dot(camera.forward());
            let aside = [offset.dot(camera.right()) / tan.x, offset.dot(camera.up()) / tan.y];
            let is_seen = depth > near && depth < far && aside.iter().all(|part| part.abs() <= depth);
            if is_seen { [least.min(depth), most.max(depth)] } else { [least, most] }
        })
    };
    let drawn = list.items.par_iter().filter(|item| !matches!(item.layer, DepthLayer::Draped(_)));
    let wider = |a: [f32; 2], b: [f32; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let [least, most] = drawn.map(of_item).reduce(|| [f32::MAX, 0.0], wider);
    (least <= most).then_some([least, most])
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

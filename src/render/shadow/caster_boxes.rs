//! What a plan knows of a list's triangles: the boxes of solids across each light, and how deep what is seen lies.
//!
//! The triangles themselves are not kept, since the processor draws none of them.

use std::mem;

use glam::Vec3;
use rayon::prelude::*;

use crate::shadow::LightAxes;
use crate::shadow::casters::{
    CasterTriangle, LightBox, LightTriangles, Portion, is_caster, portion_triangles, portions, seen_depths,
    wider,
};
use sandtable_draw::list::{DepthLayer, DrawList};
use sandtable_view::camera::Camera;

/// Corners up to here, in meters from the eye, are those of real scenes, which adapters clip as the processor does: a
/// quarter of the way around the Earth.
const FARTHEST_REAL_M: f32 = 1e7;

/// The boxes of a list's solids that cast shadows.
#[derive(Debug)]
pub struct CasterBoxes {
    /// By light, in the list's order; with the item of each.
    pub by_light: Vec<LightTriangles<u32>>,
    /// The least and greatest depth of what is seen, in meters; above 0 in perspective.
    pub depths_m: [f32; 2],
    /// Whether every corner is finite and no farther away than those of real scenes.
    pub is_real: bool,
}

/// What a portion of a list adds.
struct PortionBoxes {
    by_light: Vec<Vec<(u32, LightBox)>>,
    depths_m: [f32; 2],
    is_real: bool,
}

impl CasterBoxes {
    /// The memory that the boxes of a checked list take.
    pub fn bytes_of(list: &DrawList, lights: usize) -> u64 {
        // Twice while they are collected.
        let bytes = 2 * lights * size_of::<(u32, LightBox)>();
        let casters = list.items.iter().filter(|item| is_caster(list, item));
        casters.map(|item| item.triangles.len() as u64).sum::<u64>() * bytes as u64
    }

    /// The boxes of a checked list along the axes of these lights; `None` where no solid casts or nothing is seen.
    pub fn new(list: &DrawList, camera: &Camera, lights: &[LightAxes]) -> Option<Self> {
        if !list.items.iter().any(|item| is_caster(list, item)) {
            return None;
        }
        let of_portion = |portion: &Portion| {
            let count: usize = portion.iter().map(|(_, part)| part.len()).sum();
            let triangles = portion_triangles(list, camera.eye(), portion);
            let is_solid =
                |triangle: &&CasterTriangle| list.items[triangle.item as usize].layer != DepthLayer::Ground;
            let boxes = |axes: &LightAxes| -> Vec<(u32, LightBox)> {
                let solids = triangles.iter().filter(is_solid);
                solids.map(|triangle| (triangle.item, box_of(triangle, axes))).collect()
            };
            PortionBoxes {
                by_light: lights.iter().map(boxes).collect(),
                depths_m: seen_depths(&triangles, camera),
                is_real: triangles.len() == count && triangles.iter().all(is_real),
            }
        };
        let mut portions: Vec<PortionBoxes> =
            portions(list, 0..list.items.len()).par_iter().map(of_portion).collect();
        let depths_m = portions.iter().map(|portion| portion.depths_m).reduce(wider)?;
        let is_real = portions.iter().all(|portion| portion.is_real);
        let has_any = portions.iter().any(|portion| portion.by_light.iter().any(|boxes| !boxes.is_empty()));
        let of_light = |light: usize| {
            let boxes = portions.iter_mut().map(|portion| mem::take(&mut portion.by_light[light]));
            LightTriangles::around(boxes.filter(|boxes| !boxes.is_empty()).collect())
        };
        let by_light = (0..lights.len()).map(of_light).collect();
        // What is not real may have no depths.
        (has_any && depths_m[0] <= depths_m[1] || !is_real).then_some(Self { by_light, depths_m, is_real })
    }
}

fn box_of(triangle: &CasterTriangle, axes: &LightAxes) -> LightBox {
    LightBox::of_triangle(triangle.corners.map(|corner| axes.turned(corner)))
}

fn is_real(triangle: &CasterTriangle) -> bool {
    triangle.corners.iter().all(|corner| corner.abs().cmple(Vec3::splat(FARTHEST_REAL_M)).all())
}

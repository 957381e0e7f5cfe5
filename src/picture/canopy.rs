//! Woods so far away that a tree is smaller than a pixel or two: their canopy, drawn in place of the trees.
//!
//! The plants of a feature are drawn alike within squares of the map ([`canopies`]): where they are small in the mean, all of
//! them go, and what they cover together is drawn ([`add`]). It is a closed surface over a grid of some two pixels:
//!
//! ```text
//!        ▲  ▲ ▲   ▲▲ ▲                  ▁▂▃▃▂▃▃▂▁          top: the highest of the trees around a post, and as high
//!   ─────┴──┴─┴───┴┴─┴────  ground   ───▔▔▔▔▔▔▔▔▔───       as the share of the ground that crowns cover
//! ```
//!
//! So a wood keeps its height and its rough top, takes sun and shade as its trees do, and casts its shadow. It falls to the
//! ground where crowns cover little of it, so that it has no wall where trees are drawn beyond it.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::add_mesh;
use crate::detail::PlacedModel;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh, DrawVertex, FeatureId};
use sandtable_draw::material::Material;
use sandtable_draw::undergrowth::Undergrowth;
use sandtable_mesh::sink::MeshSink;
use sandtable_model::Model;
use sandtable_model::detail::ApparentSize;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::undergrowth::{CrownGround, crown_reach};
use sandtable_terrain::support_surface::SupportSurface;

/// Plants smaller than this in the picture, in pixels, are not drawn one by one: thousands of specks would say less and
/// cost more.
const CANOPY_PX: f32 = 1.5;

/// Squares along the longer side of the map within which the plants of a feature are drawn alike: more follow the distance
/// closer, fewer have fewer borders.
const SQUARES: f64 = 48.0;

/// The least plants of a feature that have a canopy: the ground's tone says enough of fewer.
const LEAST_PLANTS: usize = 30;

/// Pixels between posts of a canopy where the plants are nearest.
const POST_PX: f32 = 2.0;

/// The most posts of the canopies of one feature: more than a picture's pixels show.
const MOST_POSTS: f32 = 1_000_000.0;

/// The least share of a cell under crowns that is drawn.
const LEAST_COVER: f32 = 0.2;

/// The light that the trees of a wood keep from each other's crowns, which the canopy's smooth top does not show, as a factor
/// on their color.
const CROWN_SHADE: f32 = 0.75;

/// A plant that is part of a canopy.
#[derive(Clone, Copy, Debug)]
pub(super) struct CanopyPlant {
    at: Vec2,
    reach_m: f32,
    height_m: f32,
    /// Linear.
    color: Vec3,
    pixel_m: f32,
    feature: FeatureId,
}

/// Whether each model is part of a canopy: a plant in a square of the map where those of its feature are smaller than
/// [`CANOPY_PX`] in the mean.
pub(super) fn canopies(scene: &SceneModel, stands: &[&PlacedModel], sizes: &[ApparentSize]) -> Vec<bool> {
    let is_plant = |stand: &PlacedModel| !scene.models[stand.model].tints.is_empty();
    let is_small =
        |(stand, size): (&&PlacedModel, &ApparentSize)| size.across_px < CANOPY_PX && is_plant(stand);
    if !stands.iter().zip(sizes).any(is_small) {
        return vec![false; stands.len()];
    }
    let side_m = (scene.lattice.extent().size().max_element() / SQUARES) as f32;
    let square = |stand: &PlacedModel| {
        let at = stand.world_from_model.w_axis / side_m;
        (stand.feature, at.x.floor() as i32, at.y.floor() as i32)
    };
    let mut squares: BTreeMap<_, (f64, f64)> = BTreeMap::new();
    for (stand, size) in stands.iter().zip(sizes).filter(|(stand, _)| is_plant(stand)) {
        let (sum_px, count) = squares.entry(square(stand)).or_default();
        (*sum_px, *count) = (*sum_px + f64::from(size.across_px), *count + 1.0);
    }
    let is_canopy = |stand: &&PlacedModel| {
        let found = squares.get(&square(stand)).filter(|_| is_plant(stand));
        found.is_some_and(|(sum_px, count)| *sum_px < f64::from(CANOPY_PX) * count)
    };
    stands.par_iter().map(is_canopy).collect()
}

impl CanopyPlant {
    /// A placed model of an apparent size; `None` where it has no size.
    pub(super) fn new(scene: &SceneModel, stand: &PlacedModel, size: &ApparentSize) -> Option<Self> {
        let model = &scene.models[stand.model];
        let scale = stand.world_from_model.x_axis.truncate().length();
        let [reach_m, height_m] = [crown_reach(model), model.bounds()?.max.z].map(|length| length * scale);
        let pixel_m = scale / size.px_per_unit;
        let sound =
            reach_m > 0.0 && height_m > 0.0 && pixel_m > 0.0 && (reach_m + height_m + pixel_m).is_finite();
        let tint = model.tints.get(usize::from(stand.tint)).map_or(Vec3::ONE, |tint| tint.linear());
        sound.then(|| Self {
            at: stand.world_from_model.w_axis.truncate().truncate(),
            reach_m,
            height_m,
            color: mean_color(model) * tint,
            pixel_m,
            feature: stand.feature,
        })
    }
}

/// The mean color of a model's faces by their area, linear.
fn mean_color(model: &Model) -> Vec3 {
    let (mut sum, mut whole) = (Vec3::ZERO, 0.0);
    for part in &model.parts {
        let base = model.materials[part.material.0 as usize].base_color.linear();
        for triangle in &part.mesh.triangles {
            let [a, b, c] = triangle.map(|id| &part.mesh.vertices[id.index()]);
            let [at, second, third] = [a, b, c].map(|corner| Vec3::from(corner.position));
            let area = (second - at).cross(third - at).length();
            let color = (a.color.linear() + b.color.linear() + c.color.linear()) / 3.0;
            (sum, whole) = (sum + base * color * area, whole + area);
        }
    }
    if whole > 0.0 { sum / whole } else { Vec3::ONE }
}

/// Adds the canopies of `plants` over `ground`, feature by feature.
pub(super) fn add(list: &mut DrawList, ground: SupportSurface<'_>, plants: &[CanopyPlant]) {
    let mut features: BTreeMap<FeatureId, Vec<&CanopyPlant>> = BTreeMap::new();
    for plant in plants {
        features.entry(plant.feature).or_default().push(plant);
    }
    let mut material = None;
    for (feature, plants) in features.into_iter().filter(|(_, plants)| plants.len() >= LEAST_PLANTS) {
        let mesh = CanopyGrid::new(&plants).mesh(ground);
        if !mesh.triangles.is_empty() {
            let material = *material.get_or_insert_with(|| {
                list.add_material(Material { name: "canopy".into(), ..Material::default() })
            });
            add_mesh(list, mesh, material, DepthLayer::Solid, feature);
        }
    }
}

/// What grows around the posts of a grid.
struct CanopyGrid {
    crowns: CrownGround,
    low: Vec2,
    step_m: f32,
    /// The height of the highest tree around, by post.
    tops_m: Vec<f32>,
    /// The sum of the colors of the trees around, and of their weights.
    colors: Vec<(Vec3, f32)>,
}

/// A post of a canopy.
#[derive(Clone, Copy)]
struct CanopyPost {
    at: Vec3,
    cover: f32,
}

impl CanopyGrid {
    fn new(plants: &[&CanopyPlant]) -> Self {
        let pixel_m = plants.iter().map(|plant| plant.pixel_m).fold(f32::INFINITY, f32::min);
        let reach_m = plants.iter().map(|plant| plant.reach_m).fold(0.0, f32::max);
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for plant in plants {
            (low, high) = (low.min(plant.at), high.max(plant.at));
        }
        // Steps are powers of two, and posts lie at multiples of them: a little nearer, they are the same.
        let mut step_m = libm::exp2f(libm::log2f((pixel_m * POST_PX).max(reach_m)).ceil());
        let (corner, size) = loop {
            let margin = 2.0 * reach_m + 2.0 * step_m;
            let corner = ((low - margin) / step_m).floor() * step_m;
            let size = ((high + margin - corner) / step_m).ceil() + 1.0;
            if size.x * size.y <= MOST_POSTS {
                break (corner, size);
            }
            step_m *= 2.0;
        };
        let crowns = CrownGround::new(Vec2::splat(step_m), [size.x as u32, size.y as u32]);
        let count = crowns.shares.len();
        let (tops_m, colors) = (vec![0.0; count], vec![(Vec3::ZERO, 0.0); count]);
        let mut grid = Self { crowns, low: corner, step_m, tops_m, colors };
        for plant in plants {
            let at = plant.at - grid.low;
            grid.crowns.add(at, plant.reach_m);
            grid.crowns.visit(at, plant.reach_m, |index, near| {
                grid.tops_m[index] =
                    grid.tops_m[index].max(plant.height_m * (1.0 - (1.0 - near) * (1.0 - near)));
                let (sum, weight) = grid.colors[index];
                grid.colors[index] = (sum + plant.color * near, weight + near);
            });
        }
        grid
    }

    /// The canopy over the ground; empty where crowns cover too little of it.
    fn mesh(&self, ground: SupportSurface<'_>) -> DrawMesh {
        let columns = self.crowns.columns as usize;
        let post = |index: usize| -> Option<CanopyPost> {
            let cover = self.crowns.shares[index];
            let at = self.low + Vec2::new((index % columns) as f32, (index / columns) as f32) * self.step_m;
            // Beside crowns, where the surface meets the ground, too.
            let z = if self.is_beside_crowns(index) { ground.z(at.as_dvec2())? } else { return None };
            Some(CanopyPost { at: at.extend(z as f32 + self.tops_m[index] * cover), cover })
        };
        let posts: Vec<Option<CanopyPost>> =
            (0..self.crowns.shares.len()).into_par_iter().map(post).collect();
        let mut mesh = DrawMesh::default();
        let mut ids = vec![None; posts.len()];
        for row in 1..self.crowns.rows as usize {
            for column in 1..columns {
                let first = (row - 1) * columns + column - 1;
                let cell = [first, first + 1, first + columns + 1, first + columns];
                let [Some(a), Some(b), Some(c), Some(d)] = cell.map(|index| posts[index]) else { continue };
                if (a.cover + b.cover + c.cover + d.cover) * 0.25 < LEAST_COVER {
                    continue;
                }
                let [a, b, c, d] = cell
                    .map(|index| *ids[index].get_or_insert_with(|| mesh.vertex(self.vertex(&posts, index))));
                mesh.triangle([a, b, c]);
                mesh.triangle([a, c, d]);
            }
        }
        mesh
    }

    /// Whether a post has crowns around it, or one beside it has.
    fn is_beside_crowns(&self, index: usize) -> bool {
        let columns = self.crowns.columns as usize;
        let shares = &self.crowns.shares;
        let near = [0, 1, columns - 1, columns, columns + 1];
        near.iter().any(|&away| {
            let beside = [index.checked_sub(away), index.checked_add(away)];
            beside.into_iter().flatten().filter_map(|at| shares.get(at)).any(|&share| share > 0.0)
        })
    }

    fn vertex(&self, posts: &[Option<CanopyPost>], index: usize) -> DrawVertex {
        let columns = self.crowns.columns as usize;
        let CanopyPost { at, cover } = posts[index].expect("only posts with ground are corners");
        let rise = |away: usize| {
            let beside = |index: Option<usize>| index.and_then(|index| *posts.get(index)?);
            let [before, after] = [index.checked_sub(away), index.checked_add(away)].map(beside);
            match (before, after) {
                (Some(before), Some(after)) => (after.at.z - before.at.z) / (2.0 * self.step_m),
                (Some(before), None) => (at.z - before.at.z) / self.step_m,
                (None, Some(after)) => (after.at.z - at.z) / self.step_m,
                (None, None) => 0.0,
            }
        };
        let (sum, weight) = self.colors[index];
        let ground = Undergrowth::COLOR.linear();
        let crown = if weight > 0.0 { sum / weight * CROWN_SHADE } else { ground };
        DrawVertex {
            position: at.to_array(),
            normal: Vec3::new(-rise(1), -rise(columns), 1.0).normalize().to_array(),
            uv: [0.0; 2],
            color: Srgba::from_linear(ground.lerp(crown, cover)),
        }
    }
}

//! Picking: what a ray through the cursor meets in a scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::Walk;
use sandtable_draw::list::{DrawItem, DrawList, FeatureId};
use sandtable_geom::aabb::Aabb;
use sandtable_geom::crs::Crs;
use sandtable_geom::mgrs;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture_buffers::PickedPlace;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::gradient::{GradientSurface, ground_gradient};
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::ray::Ray;
use sandtable_view::camera::Camera;

/// Digits of each part of a grid reference: meters.
const MGRS_DIGITS: u8 = 5;

/// The first thing that a ray meets.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkPick {
    /// Where, in world space.
    pub world: DVec3,
    /// Map coordinates, elevation, distance and feature.
    pub place: PickedPlace,
    /// Longitude and latitude on WGS 84, degrees; `None` in a local system.
    pub lonlat: Option<DVec2>,
    /// The grid reference of the square meter; `None` where there is none.
    pub mgrs: Option<String>,
    /// The elevation of the ground there, meters, true to scale; `None` without data.
    pub ground_m: Option<f64>,
    /// The slope of the ground there in degrees from the horizontal; `None` without data.
    pub slope_deg: Option<f64>,
    /// The direction that the ground faces there, degrees clockwise from north; `None` where it is level.
    pub aspect_deg: Option<f64>,
}

/// A draw list, indexed for rays.
pub struct StandingIndex {
    list: Arc<DrawList>,
    /// The box of each item, world space; `None` for one without triangles.
    boxes: Vec<Option<Aabb>>,
}

impl StandingIndex {
    /// The items of a list of [`Walk::static_list`].
    pub fn new(list: Arc<DrawList>) -> Self {
        let key = |item: &DrawItem| (item.mesh, item.triangles.start, item.triangles.end);
        let mut of_mesh = BTreeMap::new();
        for item in &list.items {
            of_mesh.entry(key(item)).or_insert_with(|| {
                let mesh = &list.meshes[item.mesh.0 as usize];
                let corners =
                    mesh.triangles[item.triangles.start as usize..item.triangles.end as usize].iter();
                Aabb::around(corners.flatten().map(|id| Vec3::from(mesh.vertices[id.index()].position)))
            });
        }
        let world = |item: &DrawItem| {
            let corners = of_mesh[&key(item)]?.corners();
            Aabb::around(corners.map(|corner| item.world_from_mesh.transform_point3(corner)))
        };
        let boxes = list.items.iter().map(world).collect();
        Self { list, boxes }
    }

    /// The first item that `ray` meets, at most `farthest_m` along it: the distance in meters and the feature.
    pub fn pick(&self, ray: Ray, farthest_m: f64) -> Option<(f64, FeatureId)> {
        let direction = ray.direction.try_normalize()?;
        let ray = Ray { direction, ..ray };
        let meets = |bounds: &Option<Aabb>| bounds.is_some_and(|bounds| is_met(&bounds, ray, farthest_m));
        let items = self.boxes.par_iter().zip(&self.list.items).filter(|(bounds, _)| meets(bounds));
        let hits = items.filter_map(|(_, item)| Some((self.distance_m(item, ray)?, item.feature)));
        hits.filter(|(distance_m, _)| *distance_m <= farthest_m).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Where a ray of unit length first meets an item's triangles, from either side.
    fn distance_m(&self, item: &DrawItem, ray: Ray) -> Option<f64> {
        let mesh = &self.list.meshes[item.mesh.0 as usize];
        let from_world = item.world_from_mesh.as_dmat4().inverse();
        let (origin, direction) =
            (from_world.transform_point3(ray.origin), from_world.transform_vector3(ray.direction));
        let triangles = &mesh.triangles[item.triangles.start as usize..item.triangles.end as usize];
        let corner =
            |id: sandtable_mesh::sink::VertexId| Vec3::from(mesh.vertices[id.index()].position).as_dvec3();
        let distances =
            triangles.iter().filter_map(|ids| triangle_distance(ids.map(corner), origin, direction));
        distances.min_by(f64::total_cmp)
    }
}

/// Where a ray meets a triangle, in lengths of its direction; `None` where it does not (Möller and Trumbore 1997).
fn triangle_distance([a, b, c]: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let det = ab.dot(across);
    if det == 0.0 {
        return None;
    }
    let from_a = origin - a;
    let u = from_a.dot(across) / det;
    let around = from_a.cross(ab);
    let v = direction.dot(around) / det;
    let distance = ac.dot(around) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= 0.0).then_some(distance)
}

/// Whether a ray of unit length meets a box.
fn is_met(bounds: &Aabb, ray: Ray, farthest_m: f64) -> bool {
    let (mut near, mut far) = (0.0f64, farthest_m);
    for axis in 0..3 {
        let (low, high) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
        let (at, along) = (ray.origin[axis], ray.direction[axis]);
        if along == 0.0 {
            if at < low || at > high {
                return false;
            }
            continue;
        }
        let (first, last) = ((low - at) / along, (high - at) / along);
        (near, far) = (near.max(first.min(last)), far.min(first.max(last)));
    }
    near <= far
}

/// The ray through a place of a camera's picture, in pixels from its upper left corner.
pub fn pixel_ray(camera: &Camera, pixel: glam::Vec2) -> Ray {
    Ray { origin: camera.ray_origin(pixel).as_dvec3(), direction: camera.ray_through(pixel).as_dvec3() }
}

impl Walk {
    /// The ground for rays and lines of sight, true to scale, with all edits.
    pub fn sight(&self) -> &SightGround {
        self.sight.get_or_init(|| SightGround::new(Arc::clone(self.elevations())))
    }

    /// The first thing that a ray in world space meets: the ground, a draped feature, or something of `standing`; `None`
    /// for the sky.
    pub fn pick(&self, ray: Ray, standing: Option<&StandingIndex>) -> Option<WalkPick> {
        let direction = ray.direction.try_normalize()?;
        let ground = self.pick_ground(ray);
        let ground_m = ground.map_or(f64::INFINITY, |at| at.distance(ray.origin));
        let solid = standing.and_then(|index| index.pick(ray, ground_m.min(f64::MAX)));
        let (world, feature) = match (solid, ground) {
            (Some((distance_m, feature)), _) => (ray.origin + direction * distance_m, feature),
            (None, Some(world)) => (world, self.feature_at(world.truncate()).unwrap_or(FeatureId::GROUND)),
            (None, None) => return None,
        };
        Some(self.described(world, world.distance(ray.origin), feature))
    }

    /// The point where a ray in world space meets the ground, in world space.
    pub fn pick_ground(&self, ray: Ray) -> Option<DVec3> {
        // Elevations are true to scale, the ray is not: scaled alike, both meet at the same place.
        let scale = f64::from(self.scene.scale.0);
        let unscaled = |at: DVec3| at.with_z(at.z / scale);
        let unscaled = Ray { origin: unscaled(ray.origin), direction: unscaled(ray.direction) };
        let hit = self.sight().pick(unscaled, f64::INFINITY)?;
        Some(hit.at.with_z(hit.at.z * scale))
    }

    /// World Z of the ground at a world position; `None` without data.
    pub fn ground_z(&self, at: DVec2) -> Option<f64> {
        let elevations = self.elevations();
        let height = ground_height(elevations, Interpolation::Planar, at + elevations.origin());
        height.height_m().map(|height_m| self.scene.scale.world_z(height_m))
    }

    /// The uppermost draped feature at a world position, of those in view in the last update.
    pub fn feature_at(&self, at: DVec2) -> Option<FeatureId> {
        let lattice = self.lattice();
        let layout = self.mesh.source().ground().layout;
        let (east, north) = layout.patch_grid();
        let patch = (lattice.grid_at(at) / f64::from(layout.patch())).floor();
        let is_inside = patch.cmpge(DVec2::ZERO).all() && patch.x < east as f64 && patch.y < north as f64;
        is_inside.then(|| self.laid.feature_at(patch.y as usize * east + patch.x as usize, at)).flatten()
    }

    /// All that is known of a place in world space.
    fn described(&self, world: DVec3, distance_m: f64, feature: FeatureId) -> WalkPick {
        let at = self.elevations().origin() + world.truncate();
        described(&self.scene, Some(self.elevations()), PickedWorld { world, at, distance_m, feature })
    }
}

/// A place that was picked.
#[derive(Clone, Copy, Debug)]
pub struct PickedWorld {
    /// In world space.
    pub world: DVec3,
    /// Map coordinates.
    pub at: DVec2,
    /// How far away, meters.
    pub distance_m: f64,
    /// The feature there.
    pub feature: FeatureId,
}

/// All that is known of a place by the elevations around it, true to scale; without them, nothing of the ground.
pub fn described(scene: &SceneModel, elevations: Option<&Lattice>, picked: PickedWorld) -> WalkPick {
    let PickedWorld { world, at, distance_m, feature } = picked;
    let crs = &scene.crs;
    let lonlat = (*crs != Crs::local()).then(|| crs.transform(&Crs::wgs84(), at).ok()).flatten();
    let gradient =
        elevations.and_then(|elevations| ground_gradient(elevations, GradientSurface::Planar, at).ok());
    let ground = elevations.map(|elevations| ground_height(elevations, Interpolation::Planar, at));
    WalkPick {
        world,
        place: PickedPlace { at, elevation_m: scene.scale.elevation_m(world.z), distance_m, feature },
        mgrs: lonlat.and_then(|place| mgrs::reference(place, MGRS_DIGITS)),
        lonlat,
        ground_m: ground.and_then(|ground| ground.height_m()),
        slope_deg: gradient.map(|gradient| gradient.slope_deg()),
        aspect_deg: gradient.and_then(|gradient| gradient.aspect_deg()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Mat4;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{DepthLayer, DrawMesh, DrawVertex, MaterialId};
    use sandtable_mesh::sink::MeshSink;

    #[test]
    fn the_nearest_item_is_picked_wherever_it_is_placed() {
        let mut list = DrawList::default();
        let mut mesh = DrawMesh::default();
        let ids = [[0.0, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 2.0]].map(|position| {
            mesh.vertex(DrawVertex { position, normal: [0.0; 3], uv: [0.0; 2], color: Srgba::WHITE })
        });
        mesh.triangle(ids);
        let mesh = list.add_mesh(mesh);
        for (feature, x) in [(7, 40.0), (8, 25.0), (9, -30.0)] {
            list.items.push(DrawItem {
                mesh,
                triangles: 0..1,
                material: MaterialId(0),
                world_from_mesh: Mat4::from_translation(Vec3::new(x, 5.0, 0.0))
                    * Mat4::from_scale(Vec3::splat(3.0)),
                layer: DepthLayer::Solid,
                feature: FeatureId(feature),
            });
        }
        let index = StandingIndex::new(Arc::new(list));
        let ray = |y: f64, along: f64| Ray { origin: DVec3::new(0.0, y, 0.0), direction: DVec3::X * along };
        let (distance_m, feature) = index.pick(ray(5.5, 2.0), 1e9).expect("met");
        assert_eq!((feature, (distance_m - 25.0).abs() < 1e-6), (FeatureId(8), true));
        assert_eq!(index.pick(ray(5.5, -0.1), 1e9).map(|hit| hit.1), Some(FeatureId(9)));
        assert_eq!(index.pick(ray(5.5, 1.0), 24.0), None);
        assert_eq!(index.pick(ray(9.0, 1.0), 1e9), None);
    }
}

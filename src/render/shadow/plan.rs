//! Maps that are planned here and drawn elsewhere: their levels and pages as those of [`Shadows`](super::Shadows), without
//! texels.
//!
//! Pages are those that triangles of solids touch, so that the processor looks at each of these; a graphics adapter then
//! draws what it has in its memory. Of the ground only the depths are needed.

use rayon::prelude::*;

use glam::Vec3;

use crate::shadow::caster_boxes::CasterBoxes;
use crate::shadow::casters::LightTriangles;
use crate::shadow::levels::{KeptPages, LightView};
use crate::shadow::{LightAxes, SKY_TEXEL_PX, SUN_TEXEL_PX, ShadowMap, ShadowPurpose};
use sandtable_base::limits::memory::{MemoryRefused, check_memory};
use sandtable_draw::list::DrawList;
use sandtable_view::camera::Camera;

/// A map whose texels are to be drawn.
#[derive(Clone, Debug)]
pub struct PlannedShadowMap {
    /// The map without texels: nothing can read it. Its pages are numbered, and know no highest values.
    pub map: ShadowMap,
    /// How many pages are stored, at least one.
    pub stored: u32,
    /// What counts as a shadow.
    pub purpose: ShadowPurpose,
    /// By level: the items of solids on its stored pages, rising, as indices of the list.
    pub casters: Vec<Vec<u32>>,
}

/// The maps of the sun and of the sky whose texels are to be drawn.
#[derive(Clone, Debug, Default)]
pub struct ShadowPlan {
    /// `None` where [`Shadows::sun`](super::Shadows::sun) is.
    pub sun: Option<PlannedShadowMap>,
    /// `None` where [`Shadows::sky`](super::Shadows::sky) is.
    pub sky: Option<PlannedShadowMap>,
}

impl ShadowPlan {
    /// The plan of a checked list's maps for what `camera` sees; `None` where a corner is not finite or more than 10,000 km
    /// away, which adapters clip each in its own way.
    ///
    /// # Errors
    /// There is not the memory for the triangles of solids.
    pub fn new(list: &DrawList, camera: &Camera) -> Result<Option<Self>, MemoryRefused> {
        let to_sun = list.lighting.to_sun;
        let sun = (to_sun.z > 0.0).then_some(to_sun);
        let lights: Vec<LightAxes> =
            [Some(Vec3::Z), sun].into_iter().flatten().map(|toward| LightAxes::new(toward, camera)).collect();
        let bytes = CasterBoxes::bytes_of(list, lights.len());
        check_memory(bytes, "planning shadows", "draw fewer or coarser solids")?;
        let Some(boxes) = CasterBoxes::new(list, camera, &lights) else { return Ok(Some(Self::default())) };
        if !boxes.is_real {
            return Ok(None);
        }
        let map = |light: usize, texel_px: f32, purpose: ShadowPurpose| {
            let view = LightView { camera, axes: *lights.get(light)?, depths_m: boxes.depths_m };
            PlannedShadowMap::new(&view, &boxes.by_light[light], texel_px, purpose)
        };
        let (sky, sun) =
            (map(0, SKY_TEXEL_PX, ShadowPurpose::Contact), map(1, SUN_TEXEL_PX, ShadowPurpose::Sun));
        Ok(Some(Self { sun, sky }))
    }

    /// The maps of the sun and of the sky.
    pub fn maps(&self) -> [Option<&PlannedShadowMap>; 2] {
        [self.sun.as_ref(), self.sky.as_ref()]
    }
}

impl PlannedShadowMap {
    fn new(
        view: &LightView,
        solids: &LightTriangles<u32>,
        texel_px: f32,
        purpose: ShadowPurpose,
    ) -> Option<Self> {
        let map = ShadowMap::planned(view, solids, texel_px)?;
        let on_level = |level| {
            let kept = KeptPages::new(level, &map.pages);
            let mut items = Vec::new();
            for (item, bounds) in solids.portions.iter().flatten() {
                // Triangles come item by item.
                if items.last() != Some(item) && kept.pages_on(*bounds).is_some() {
                    items.push(*item);
                }
            }
            items
        };
        let casters = map.levels.par_iter().map(on_level).collect();
        let stored = map.stored() as u32;
        Some(Self { map, stored, purpose, casters })
    }
}

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::*;
    use crate::shadow::Shadows;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{DepthLayer, DrawItem, DrawMesh, DrawVertex, FeatureId};
    use sandtable_draw::material::Material;
    use sandtable_mesh::sink::MeshSink;

    /// Ground, and roofs on it at these distances north of the origin.
    fn roofs(side_m: f32, norths_m: &[f32]) -> DrawList {
        let mut list = DrawList::default();
        let material = list.add_material(Material::default());
        let mut add = |half_m: f32, at: Vec3, layer: DepthLayer| {
            let mut mesh = DrawMesh::default();
            let ids = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]: [f32; 2]| {
                let (position, normal) = ([x * half_m, y * half_m, 0.0], [0.0, 0.0, 1.0]);
                mesh.vertex(DrawVertex { position, normal, uv: [0.0; 2], color: Srgba::WHITE })
            });
            mesh.triangle([ids[0], ids[1], ids[2]]);
            mesh.triangle([ids[0], ids[2], ids[3]]);
            let (mesh, world_from_mesh) = (list.add_mesh(mesh), Mat4::from_translation(at));
            let feature = FeatureId::GROUND;
            list.items.push(DrawItem { mesh, triangles: 0..2, material, world_from_mesh, layer, feature });
        };
        add(side_m, Vec3::ZERO, DepthLayer::Ground);
        norths_m.iter().for_each(|&north| add(6.0, Vec3::new(0.0, north, 8.0), DepthLayer::Solid));
        list
    }

    fn camera() -> Camera {
        Camera::new(Vec3::new(0.0, -80.0, 60.0), Vec3::ZERO, 0.8, (640, 480), (1.0, 20_000.0)).expect("sound")
    }

    #[test]
    fn a_plan_has_the_pages_of_the_maps_that_are_drawn_and_their_casters() {
        let list = roofs(5_000.0, &[0.0, 30.0, 60.0, -3_000.0]);
        let plan = ShadowPlan::new(&list, &camera()).expect("memory").expect("real");
        let drawn = Shadows::new(&list, &camera()).expect("memory");
        for (planned, drawn) in plan.maps().into_iter().zip([drawn.sun, drawn.sky]) {
            let (planned, drawn) = (planned.expect("solids"), drawn.expect("solids"));
            assert_eq!((&planned.map.levels, planned.map.scale), (&drawn.levels, drawn.scale));
            let numbers = |map: &ShadowMap| map.pages.iter().map(|page| page.number).collect::<Vec<_>>();
            assert_eq!(numbers(&planned.map), numbers(&drawn));
            assert_eq!(planned.stored as usize * 1024, drawn.texels.len());
            assert_eq!(planned.casters.len(), drawn.levels.len());
            let casting: Vec<u32> = (1..5).filter(|item| planned.casters.concat().contains(item)).collect();
            assert_eq!(casting, [1, 2, 3], "one lies far behind the eye");
        }
    }

    #[test]
    fn corners_that_are_not_of_a_real_scene_are_not_planned_for() {
        for far in [1e9, 1e30, f32::INFINITY, f32::NAN] {
            for (side_m, north_m) in [(far, 0.0), (5_000.0, far)] {
                let plan = ShadowPlan::new(&roofs(side_m, &[0.0, north_m]), &camera());
                assert!(plan.expect("memory").is_none(), "{side_m} {north_m}");
            }
        }
        let empty = ShadowPlan::new(&roofs(5_000.0, &[]), &camera()).expect("memory").expect("real");
        assert!(empty.sun.is_none() && empty.sky.is_none());
    }
}

//! The shadow maps of a picture: drawn by the processor, or planned and then drawn by the adapter.

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::geometry::GpuGeometry;
use crate::layouts::Layouts;
use crate::materials::{GpuMaterials, TexturePlaces, TextureScope};
use crate::memory::Loader;
use crate::plan::Plan;
use crate::shadow::{ShadowTextures, TABLE_FORMAT, TEXEL_FORMAT};
use crate::shadow_maps::ShadowMaker;
use crate::shadow_maps::caster_calls::PlanCasters;
use crate::shadow_maps::drawer::{LoadedCasters, ShadowDrawer, ShadowScene, fits};
use crate::shadow_maps::pipelines::{STORAGE_BUFFERS, STORAGE_TEXTURES, WORKGROUP};
use sandtable_draw::list::{DepthLayer, DrawList};
use sandtable_render::shadow::plan::ShadowPlan;
use sandtable_render::shadow::{ShadowMap, Shadows};
use sandtable_view::camera::Camera;

/// The shadow maps of a picture, or what the adapter is to draw.
#[derive(Debug)]
pub enum CastShadows {
    Drawn(Shadows),
    Planned(ShadowPlan),
}

/// A checked list on the device, for a picture.
#[derive(Clone, Copy)]
pub struct LoadedList<'a> {
    pub list: &'a DrawList,
    pub places: &'a TexturePlaces,
    pub plan: &'a Plan,
    pub geometry: &'a GpuGeometry,
    pub materials: &'a GpuMaterials,
}

impl CastShadows {
    /// The maps of a checked list for what `camera` sees, drawn or planned.
    pub fn new(gpu: &Gpu, maker: ShadowMaker, list: &DrawList, camera: &Camera) -> Result<Self, GpuError> {
        if maker == ShadowMaker::Adapter && can_draw(gpu) {
            let plan = ShadowPlan::new(list, camera)?.filter(|plan| fits(gpu, plan));
            if let Some(plan) = plan {
                return Ok(Self::Planned(plan));
            }
        }
        Ok(Self::Drawn(Shadows::new(list, camera)?))
    }

    /// The maps of the sun and of the sky; planned ones have no texels.
    pub fn maps(&self) -> [Option<&ShadowMap>; 2] {
        match self {
            Self::Drawn(shadows) => shadows.maps(),
            Self::Planned(plan) => plan.maps().map(|planned| planned.map(|planned| &planned.map)),
        }
    }

    /// The maps on the device; planned ones are still to be drawn.
    pub fn textures(&self, loader: &Loader<'_>) -> Result<ShadowTextures, GpuError> {
        match self {
            Self::Drawn(shadows) => ShadowTextures::upload(loader, shadows),
            Self::Planned(plan) => ShadowTextures::to_draw(loader, plan),
        }
    }
}

/// Whether the device can draw maps.
fn can_draw(gpu: &Gpu) -> bool {
    let needed = wgpu::DownlevelFlags::FRAGMENT_WRITABLE_STORAGE | wgpu::DownlevelFlags::COMPUTE_SHADERS;
    let can_store = |format| {
        let usages = gpu.adapter().get_texture_format_features(format).allowed_usages;
        usages.contains(wgpu::TextureUsages::STORAGE_BINDING)
    };
    let limits = &gpu.limits;
    gpu.adapter().get_downlevel_capabilities().flags.contains(needed)
        && limits.max_storage_buffers_per_shader_stage >= STORAGE_BUFFERS
        && limits.max_storage_textures_per_shader_stage >= STORAGE_TEXTURES
        && limits.max_compute_invocations_per_workgroup >= WORKGROUP
        && limits.max_compute_workgroup_size_x >= WORKGROUP
        && [TEXEL_FORMAT, TABLE_FORMAT].into_iter().all(can_store)
}

/// Draws planned maps to textures that are made for them, and waits until they are drawn. Solids that cast and are not in
/// the picture are sent. `drawer` is made at first use.
pub fn draw_planned(
    loader: &Loader<'_>,
    layouts: &Layouts,
    drawer: &mut Option<ShadowDrawer>,
    loaded: LoadedList<'_>,
    (plan, to): (&ShadowPlan, &ShadowTextures),
) -> Result<(), GpuError> {
    let LoadedList { list, places, plan: shown, geometry, materials } = loaded;
    let mut is_missing = vec![false; list.items.len()];
    let casters = plan.maps().into_iter().flatten().flat_map(|planned| planned.casters.iter().flatten());
    casters.for_each(|&item| is_missing[item as usize] = true);
    let merged = shown.merged.iter().map(|part| part.item);
    merged.chain(shown.placed.iter().copied()).for_each(|item| is_missing[item] = false);
    let hidden = Plan::new(list, places, |item| is_missing[item]);
    let hidden_geometry = geometry.upload_more(loader, list, &hidden)?;
    let [shown, hidden] = [shown, &hidden].map(|plan| PlanCasters::new(list, places, plan));
    let drawer = drawer.get_or_insert_with(|| ShadowDrawer::new(loader.gpu, layouts));
    drawer.make(loader.gpu, &[&shown, &hidden]);
    let casters = [
        LoadedCasters { geometry, casters: &shown },
        LoadedCasters { geometry: &hidden_geometry, casters: &hidden },
    ];
    drawer.draw(loader, plan, ShadowScene { casters: &casters, materials }, to)
}

/// Draws the planned maps of a checked list that is not on the device, to textures of their own: of the list is sent what
/// they need. Waits until they are drawn.
pub fn draw_alone(
    loader: &Loader<'_>,
    layouts: &Layouts,
    drawer: &mut Option<ShadowDrawer>,
    list: &DrawList,
    plan: &ShadowPlan,
) -> Result<ShadowTextures, GpuError> {
    let to = ShadowTextures::to_draw(loader, plan)?;
    if plan.maps().iter().all(Option::is_none) {
        return Ok(to);
    }
    let places = TexturePlaces::new(list, TextureScope::Masks, &loader.gpu.limits);
    let ground = Plan::new(list, &places, |item| list.items[item].layer == DepthLayer::Ground);
    let loaded = LoadedList {
        list,
        places: &places,
        plan: &ground,
        geometry: &GpuGeometry::upload(loader, list, &ground, None)?,
        materials: &GpuMaterials::upload(loader, layouts, list, &places)?,
    };
    draw_planned(loader, layouts, drawer, loaded, (plan, &to))?;
    Ok(to)
}

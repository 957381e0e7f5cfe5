//! Maps that the adapter has drawn, brought back to the processor: to compare them with those that it draws itself.

use bytemuck::cast_slice;

use crate::adapter::Gpu;
use crate::error::{DriverError, GpuError};
use crate::layouts::Layouts;
use crate::memory::Loader;
use crate::readback::{TextureCopy, wait};
use crate::shadow::{PAGE_COLUMNS, ShadowTextures};
use crate::shadow_maps::ShadowMaker;
use crate::shadow_maps::maker::{CastShadows, draw_alone};
use sandtable_draw::list::DrawList;
use sandtable_render::shadow::plan::{PlannedShadowMap, ShadowPlan};
use sandtable_render::shadow::{PAGE, ShadowMap, ShadowPage, ShadowTexel, Shadows};
use sandtable_view::camera::Camera;

/// The shadow maps of a list for what `camera` sees, as `gpu` draws them; `None` where it cannot, or their plan does not
/// fit its buffers or has corners that no real scene has.
///
/// # Errors
/// See [`GpuError`].
pub fn drawn_shadows(gpu: &Gpu, list: &DrawList, camera: &Camera) -> Result<Option<Shadows>, GpuError> {
    list.check()?;
    let plan = match CastShadows::new(gpu, ShadowMaker::Adapter, list, camera)? {
        CastShadows::Planned(plan) => plan,
        CastShadows::Drawn(_) => return Ok(None),
    };
    gpu.guarded("drawing shadow maps", || {
        let (loader, layouts) = (Loader::new(gpu), Layouts::new(gpu));
        let textures = draw_alone(&loader, &layouts, &mut None, list, &plan)?;
        read(gpu, plan, &textures).map(Some)
    })
}

/// Reads the textures of the maps of a plan.
fn read(gpu: &Gpu, plan: ShadowPlan, textures: &ShadowTextures) -> Result<Shadows, GpuError> {
    let mut encoder = gpu.encoder("copy of shadows");
    let pages = TextureCopy::record(gpu, &mut encoder, &textures.pages)?;
    let texels = TextureCopy::record(gpu, &mut encoder, &textures.texels)?;
    gpu.queue.submit([encoder.finish()]);
    let read = || -> Result<Shadows, DriverError> {
        wait(gpu, &[&pages, &texels], None)?;
        let (entries, texels) = (pages.texels::<16>()?, texels.texels::<8>()?);
        let (entries, texels): (&[[u32; 4]], &[ShadowTexel]) = (cast_slice(&entries), cast_slice(&texels));
        let sun = plan.sun.map(|planned| read_map(planned, 0, (entries, texels)));
        let before = sun.as_ref().map_or(0, ShadowMap::stored) as u32;
        let others = &entries[sun.as_ref().map_or(0, |map| map.pages.len())..];
        let sky = plan.sky.map(|planned| read_map(planned, before, (others, texels)));
        Ok(Shadows { sun, sky })
    };
    read().map_err(|error| gpu.driver_error("reading shadow maps back", error))
}

/// The map of these entries of the table, after so many stored pages, whose texels lie in rows of pages.
fn read_map(
    planned: PlannedShadowMap,
    before: u32,
    (entries, texels): (&[[u32; 4]], &[ShadowTexel]),
) -> ShadowMap {
    let PlannedShadowMap { mut map, stored, .. } = planned;
    for (page, &[number, solid, ground, _]) in map.pages.iter_mut().zip(entries) {
        let highest = ShadowTexel { solid: f32::from_bits(solid), ground: f32::from_bits(ground) };
        *page = ShadowPage { number: number.saturating_sub(before), highest };
    }
    let width = (PAGE_COLUMNS * PAGE) as usize;
    for page in (before..before + stored).map(|page| [page % PAGE_COLUMNS, page / PAGE_COLUMNS]) {
        let [x, y] = page.map(|page| (page * PAGE) as usize);
        for row in y..y + PAGE as usize {
            map.texels.extend_from_slice(&texels[row * width + x..][..PAGE as usize]);
        }
    }
    map
}

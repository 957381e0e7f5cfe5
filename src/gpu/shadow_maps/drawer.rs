//! Records the drawing of planned maps.

use bytemuck::{bytes_of, cast_slice};

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::geometry::GpuGeometry;
use crate::layouts::Layouts;
use crate::materials::GpuMaterials;
use crate::memory::{Loader, bind, texture, view};
use crate::shadow::ShadowTextures;
use crate::shadow_maps::caster_calls::{CasterCall, PlanCasters};
use crate::shadow_maps::constants::{LevelConstants, LevelTile, PagesBefore, stored_on, tiles};
use crate::shadow_maps::pipelines::{ShadowPipelines, TABLE_WORKGROUP, TARGET_FORMAT};
use sandtable_render::shadow::plan::{PlannedShadowMap, ShadowPlan};
use sandtable_render::shadow::{PAGE, ShadowPurpose};

/// Bytes between the constants of two tiles: no adapter asks for more.
const CONSTANTS_APART: usize = 256;

/// Draws shadow maps on one device.
#[derive(Debug)]
pub struct ShadowDrawer(ShadowPipelines);

/// Casters on the device.
#[derive(Clone, Copy)]
pub struct LoadedCasters<'a> {
    pub geometry: &'a GpuGeometry,
    pub casters: &'a PlanCasters,
}

/// The casters of all maps and their materials.
#[derive(Clone, Copy)]
pub struct ShadowScene<'a> {
    pub casters: &'a [LoadedCasters<'a>],
    pub materials: &'a GpuMaterials,
}

/// A level that is to be drawn.
struct LevelWork {
    tiles: Vec<LevelTile>,
    /// The number of the constants of its first tile, or of the level where it has none.
    first: usize,
    stored: u32,
    entries: u32,
}

/// The buffers that maps are drawn to, one after the other.
struct ShadowBuffers {
    heights: wgpu::Buffer,
    drawn: wgpu::BindGroup,
    finished: wgpu::BindGroup,
    target: wgpu::TextureView,
}

/// Heights of a texel: of a solid, of the ground and, for contact, of the underside of a solid.
fn heights_of(purpose: ShadowPurpose) -> u64 {
    match purpose {
        ShadowPurpose::Sun => 2,
        ShadowPurpose::Contact => 3,
    }
}

/// Bytes of the heights of a map.
fn height_bytes(planned: &PlannedShadowMap) -> u64 {
    u64::from(planned.stored) * u64::from(PAGE * PAGE) * heights_of(planned.purpose) * size_of::<u32>() as u64
}

/// Whether the device's buffers can hold the maps of a plan.
pub fn fits(gpu: &Gpu, plan: &ShadowPlan) -> bool {
    let most = gpu.limits.max_storage_buffer_binding_size.min(gpu.limits.max_buffer_size);
    plan.maps().into_iter().flatten().all(|planned| height_bytes(planned) <= most)
}

impl ShadowDrawer {
    pub fn new(gpu: &Gpu, layouts: &Layouts) -> Self {
        Self(ShadowPipelines::new(gpu, layouts))
    }

    /// Makes the pipelines for casters that are missing.
    pub fn make(&mut self, gpu: &Gpu, casters: &[&PlanCasters]) {
        self.0.make(gpu, casters.iter().flat_map(|casters| casters.keys()));
    }

    /// Draws the maps of a plan to textures that are made for it, and waits until they are drawn.
    pub fn draw(
        &self,
        loader: &Loader<'_>,
        plan: &ShadowPlan,
        scene: ShadowScene<'_>,
        to: &ShadowTextures,
    ) -> Result<(), GpuError> {
        let gpu = loader.gpu;
        let (mut work, mut constants) = (Vec::new(), Vec::new());
        let mut before = PagesBefore::default();
        for planned in plan.maps().into_iter().flatten() {
            work.push((planned, level_works(gpu, planned, before, &mut constants)));
            before.entries += planned.map.pages.len() as u32;
            before.of_maps += planned.stored;
        }
        if work.is_empty() {
            return Ok(());
        }
        let buffers = self.buffers(loader, &work, &constants, to)?;
        let mut encoder = gpu.encoder("shadows");
        for (planned, levels) in &work {
            encoder.clear_buffer(&buffers.heights, 0, None);
            for (level, casting) in levels.iter().zip(&planned.casters) {
                self.draw_level(&mut encoder, &buffers, level, casting, scene);
            }
            self.finish(&mut encoder, &buffers, levels);
        }
        gpu.queue.submit([encoder.finish()]);
        gpu.finish_sending()
    }

    fn buffers(
        &self,
        loader: &Loader<'_>,
        work: &[(&PlannedShadowMap, Vec<LevelWork>)],
        constants: &[LevelConstants],
        to: &ShadowTextures,
    ) -> Result<ShadowBuffers, GpuError> {
        let gpu = loader.gpu;
        let storage = wgpu::BufferUsages::STORAGE;
        let numbers: Vec<u32> =
            work.iter().flat_map(|(planned, _)| planned.map.pages.iter().map(|page| page.number)).collect();
        let mut apart = vec![0; constants.len() * CONSTANTS_APART];
        for (slot, constants) in apart.chunks_exact_mut(CONSTANTS_APART).zip(constants) {
            slot[..size_of::<LevelConstants>()].copy_from_slice(bytes_of(constants));
        }
        let constants =
            loader.filled_buffer(|| "levels of shadows".into(), wgpu::BufferUsages::UNIFORM, &apart)?;
        let numbers = loader.filled_buffer(|| "pages of shadows".into(), storage, cast_slice(&numbers))?;
        let bytes = work.iter().map(|(planned, _)| height_bytes(planned)).max().unwrap_or(0);
        let heights =
            loader.buffer(|| "heights of shadows".into(), storage | wgpu::BufferUsages::COPY_DST, bytes)?;
        let stored = work.iter().map(|(planned, _)| u64::from(planned.stored)).max().unwrap_or(0);
        let highest =
            loader.buffer(|| "highest shadows".into(), storage, stored * size_of::<[u32; 2]>() as u64)?;
        let tiles = || work.iter().flat_map(|(_, levels)| levels.iter().flat_map(|level| &level.tiles));
        let [width, height] = [0, 1].map(|axis| tiles().map(|tile| tile.size[axis]).max().unwrap_or(PAGE));
        let mut descriptor = texture("target of shadows", width, height, TARGET_FORMAT);
        descriptor.usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let target = view(&loader.texture(|| "the target of shadows".into(), &descriptor)?);
        let of_level = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &constants,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<LevelConstants>() as u64),
        });
        let [numbers, drawn, highest] = [&numbers, &heights, &highest].map(wgpu::Buffer::as_entire_binding);
        let [texels, pages] = [&to.texels, &to.pages].map(view);
        let [texels, pages] = [&texels, &pages].map(wgpu::BindingResource::TextureView);
        let finished = [of_level.clone(), numbers.clone(), drawn.clone(), highest, texels, pages];
        let (drawn, finished) = (
            bind(gpu, "drawing of shadows", &self.0.drawn, [of_level, numbers, drawn]),
            bind(gpu, "finishing of shadows", &self.0.finished, finished),
        );
        Ok(ShadowBuffers { heights: heights.clone(), drawn, finished, target })
    }

    /// Draws the ground and the items that cast on a level.
    fn draw_level(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        buffers: &ShadowBuffers,
        level: &LevelWork,
        casting: &[u32],
        scene: ShadowScene<'_>,
    ) {
        if level.tiles.is_empty() {
            return;
        }
        let mut casts = vec![false; casting.last().map_or(0, |&last| last as usize + 1)];
        casting.iter().for_each(|&item| casts[item as usize] = true);
        let is_on = |item: usize| casts.get(item).copied().unwrap_or(false);
        let calls: Vec<(&GpuGeometry, Vec<CasterCall>)> =
            scene.casters.iter().map(|loaded| (loaded.geometry, loaded.casters.on_level(is_on))).collect();
        for (tile, number) in level.tiles.iter().zip(level.first..) {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadows"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &buffers.target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Discard,
                    },
                })],
                ..Default::default()
            });
            let [width, height] = tile.size.map(|side| side as f32);
            pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
            pass.set_scissor_rect(0, 0, tile.size[0], tile.size[1]);
            pass.set_bind_group(0, &buffers.drawn, &[offset_of(number)]);
            let (mut key, mut array) = (None, None);
            for (geometry, calls) in &calls {
                for call in calls {
                    let Some(pipeline) = self.0.get(call.key) else { continue };
                    if key.replace(call.key) != Some(call.key) {
                        pass.set_pipeline(pipeline);
                    }
                    if array.replace(call.array) != Some(call.array) {
                        pass.set_bind_group(1, scene.materials.group(call.array), &[]);
                    }
                    geometry.draw(&mut pass, &call.shape);
                }
            }
        }
    }

    /// Turns the heights of a map to texels and its table.
    fn finish(&self, encoder: &mut wgpu::CommandEncoder, buffers: &ShadowBuffers, levels: &[LevelWork]) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("finishing of shadows"),
            ..Default::default()
        });
        pass.set_pipeline(&self.0.finish_page);
        for level in levels.iter().filter(|level| level.stored > 0) {
            pass.set_bind_group(0, &buffers.finished, &[offset_of(level.first)]);
            pass.dispatch_workgroups(level.stored, 1, 1);
        }
        pass.set_pipeline(&self.0.finish_table);
        for level in levels {
            pass.set_bind_group(0, &buffers.finished, &[offset_of(level.first)]);
            pass.dispatch_workgroups(level.entries.div_ceil(TABLE_WORKGROUP), 1, 1);
        }
    }
}

/// The levels of a map, whose constants are added to `constants`.
fn level_works(
    gpu: &Gpu,
    planned: &PlannedShadowMap,
    mut before: PagesBefore,
    constants: &mut Vec<LevelConstants>,
) -> Vec<LevelWork> {
    let work = |(index, level)| {
        let tiles = tiles(&planned.map, level, gpu.limits.max_texture_dimension_2d);
        let (first, stored) = (constants.len(), stored_on(&planned.map, level));
        let none = [LevelTile { first: [0; 2], size: [PAGE; 2] }];
        let slots = if tiles.is_empty() { &none[..] } else { &tiles };
        constants.extend(slots.iter().map(|&tile| LevelConstants::new(planned, index, before, tile)));
        before.of_levels += stored;
        LevelWork { tiles, first, stored, entries: level.columns * level.rows }
    };
    planned.map.levels.iter().enumerate().map(work).collect()
}

/// Where the constants of this number begin.
fn offset_of(number: usize) -> u32 {
    (number * CONSTANTS_APART) as u32
}

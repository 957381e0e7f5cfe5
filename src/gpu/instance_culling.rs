//! Instances that the device leaves out of a frame by itself: those out of view, and those that are too small.
//!
//! ```text
//!   boxes of a run      □ ■ ■ □ │ ■ □ □ ■        ■ in view; in blocks of 256, a group of threads each
//!   count_seen              2   │     2          how many of each block
//!   place_seen          instances 1 2 4 7        one behind the other, and 4 into the arguments of the run's call
//! ```
//!
//! The processor records the same calls whatever the camera sees. Each instance is tested as [`CullingView`](crate::culling)
//! tests a group of one item. Sums of blocks rather than atomic counters place what is seen, so that a run keeps its order:
//! where two instances have equal depths, the same one is drawn in every frame. Each block sums the counts of those before it in
//! its run, in all of its threads, so that no third dispatch sums them.
//!
//! Whole instances are copied, not their numbers: they are read as vertices like those that the processor sends, by the same
//! pipelines.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable, cast_slice};
use glam::Vec3;
use wgpu::wgt::DrawIndexedIndirectArgs;

use crate::adapter::Gpu;
use crate::buffer_writes::BufferWrites;
use crate::compute::compute_pipelines;
use crate::culling::LEAST_PX;
use crate::draw_call::DrawShape;
use crate::error::GpuError;
use crate::layouts::group_layout;
use crate::memory::{Loader, bind};
use crate::pass_timer::PassTimer;
use crate::plan::Plan;
use crate::uniforms::Instance;
use sandtable_geom::aabb::Aabb;
use sandtable_view::camera::{Camera, ViewProjection};

const SHADER: &str = include_str!("instance_culling.wgsl");

/// Instances of a block, as the shader has them: the most threads of a group that every device has.
pub const BLOCK_INSTANCES: u32 = 256;

/// The storage buffers that the shader binds.
pub const STORAGE_BUFFERS: u32 = 6;

/// What leaves out the instances of a window that it does not show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstanceCulling {
    /// The device, one by one.
    Device,
    /// The processor, group by group.
    Processor,
}

/// The pipelines that cull.
#[derive(Debug)]
pub struct InstanceCuller {
    layout: wgpu::BindGroupLayout,
    count: wgpu::ComputePipeline,
    place: wgpu::ComputePipeline,
}

/// The instances of a scene that the device culls.
#[derive(Debug)]
pub struct CulledInstances {
    culler: Arc<InstanceCuller>,
    view: wgpu::Buffer,
    group: wgpu::BindGroup,
    blocks: u32,
    /// Those that the last recorded view shows: those of each run from the place on that its first one has in the plan.
    seen: wgpu::Buffer,
    /// The arguments of each run's call.
    calls: wgpu::Buffer,
}

/// `View` in the shader.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct CullingUniforms {
    eye: [f32; 4],
    right: [f32; 4],
    up: [f32; 4],
    forward: [f32; 4],
    half_and_far: [f32; 4],
    scale: [f32; 4],
}

/// `InstanceBox` in the shader.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct InstanceBox {
    low: [f32; 4],
    high: [f32; 4],
}

/// `Block` in the shader.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct InstanceBlock {
    first: u32,
    count: u32,
    run: u32,
    run_block: u32,
}

impl InstanceCulling {
    /// Where `gpu` has `items` instances at the most culled: on the processor where they exceed a buffer that shaders bind.
    pub fn of(gpu: &Gpu, items: usize) -> Self {
        let bytes = items as u64 * size_of::<Instance>() as u64;
        let blocks = items as u64 / u64::from(BLOCK_INSTANCES) + 1;
        let most_blocks = gpu.limits.max_compute_workgroups_per_dimension;
        let fits =
            bytes <= gpu.limits.max_storage_buffer_binding_size && blocks * 2 <= u64::from(most_blocks);
        if gpu.culls_instances && fits { Self::Device } else { Self::Processor }
    }
}

impl InstanceCuller {
    /// The culler of a device; `None` where its driver cannot do that, or refuses the shader.
    pub fn open(gpu: &Gpu) -> Option<Arc<Self>> {
        let made = gpu.culls_instances.then(|| gpu.guarded("building its shaders", || Ok(Self::new(gpu))));
        made?.ok().map(Arc::new)
    }

    fn new(gpu: &Gpu) -> Self {
        let label = "culling of instances";
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let storage = |read_only| buffer(wgpu::BufferBindingType::Storage { read_only });
        let (read, written) = (storage(true), storage(false));
        let bindings =
            [buffer(wgpu::BufferBindingType::Uniform), read, read, read, written, written, written];
        let layout = group_layout(gpu, label, &bindings.map(|ty| (wgpu::ShaderStages::COMPUTE, ty)));
        let constants = [("words", (size_of::<Instance>() / size_of::<u32>()) as f64)];
        let entries = ["count_seen", "place_seen"];
        let [count, place] = compute_pipelines(gpu, (label, SHADER), &layout, &constants, entries);
        Self { layout, count, place }
    }

    /// The instances that `plan` has culled, which `instances` holds in the order of the plan; `None` where there are none.
    pub fn load(
        self: &Arc<Self>,
        loader: &Loader<'_>,
        plan: &Plan,
        instances: &wgpu::Buffer,
    ) -> Result<Option<CulledInstances>, GpuError> {
        use wgpu::BufferUsages;
        if plan.culled.is_empty() {
            return Ok(None);
        }
        let (blocks, calls) = blocks_and_calls(plan);
        let boxes: Vec<InstanceBox> = plan.culled_bounds.iter().map(InstanceBox::of).collect();
        let what = || format!("the culling of {} instances", boxes.len());
        let filled = |usage, bytes: &[u8]| loader.filled_buffer(what, usage, bytes);
        let bytes = boxes.len() as u64 * size_of::<Instance>() as u64;
        let uniforms = size_of::<CullingUniforms>() as u64;
        let view = loader.buffer(what, BufferUsages::UNIFORM | BufferUsages::COPY_DST, uniforms)?;
        let counts =
            loader.buffer(what, BufferUsages::STORAGE, blocks.len() as u64 * size_of::<u32>() as u64)?;
        let seen_usage = BufferUsages::STORAGE | BufferUsages::VERTEX | BufferUsages::COPY_SRC;
        let seen = loader.buffer(what, seen_usage, bytes)?;
        let calls_usage = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
        let calls = filled(calls_usage, cast_slice(&calls))?;
        let boxes = filled(BufferUsages::STORAGE, cast_slice(&boxes))?;
        let block_buffer = filled(BufferUsages::STORAGE, cast_slice(&blocks))?;
        let of_plan =
            wgpu::BufferBinding { buffer: instances, offset: 0, size: wgpu::BufferSize::new(bytes) };
        let resources = [
            view.as_entire_binding(),
            boxes.as_entire_binding(),
            block_buffer.as_entire_binding(),
            wgpu::BindingResource::Buffer(of_plan),
            counts.as_entire_binding(),
            seen.as_entire_binding(),
            calls.as_entire_binding(),
        ];
        let group = bind(loader.gpu, "culling of instances", &self.layout, resources);
        let culler = Arc::clone(self);
        Ok(Some(CulledInstances { culler, view, group, blocks: blocks.len() as u32, seen, calls }))
    }
}

impl CulledInstances {
    /// Sets the camera of the cullings that are recorded.
    pub fn see(&self, writes: &mut BufferWrites<'_>, camera: &Camera) {
        writes.write(&self.view, 0, cast_slice(&[CullingUniforms::new(camera)]));
    }

    /// Records which instances the camera sees.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: Option<&PassTimer>) {
        let label = "culling of instances";
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: timer.and_then(|timer| timer.compute_writes(label)),
        });
        pass.set_bind_group(0, &self.group, &[]);
        for pipeline in [&self.culler.count, &self.culler.place] {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(self.blocks, 1, 1);
        }
    }

    /// The instances that are seen of a run whose first has this place in the plan, and of those behind it.
    pub fn seen_from(&self, first: u32) -> wgpu::BufferSlice<'_> {
        self.seen.slice(u64::from(first) * size_of::<Instance>() as u64..)
    }

    /// The arguments of the call of a run, and where they lie in their buffer.
    pub fn call(&self, run: usize) -> (&wgpu::Buffer, u64) {
        (&self.calls, (run * size_of::<DrawIndexedIndirectArgs>()) as u64)
    }
}

impl CullingUniforms {
    fn new(camera: &Camera) -> Self {
        let (tan, (near, far)) = (camera.tan_half_fov(), camera.planes());
        let (half, is_parallel) = match camera.projection() {
            ViewProjection::Perspective { .. } => (glam::Vec2::ZERO, 0.0),
            ViewProjection::Parallel(frame) => (frame.half_m, 1.0),
        };
        let with = |vector: Vec3, w: f32| vector.extend(w).to_array();
        Self {
            eye: with(camera.eye(), is_parallel),
            right: with(camera.right(), tan.x),
            up: with(camera.up(), tan.y),
            forward: with(camera.forward(), near),
            half_and_far: [half.x, half.y, far, 0.0],
            scale: [camera.pixels_per_meter(1.0), LEAST_PX, 0.0, 0.0],
        }
    }
}

impl InstanceBox {
    /// What is not finite is always shown: shaders need not know such numbers.
    fn of(bounds: &Aabb) -> Self {
        let diagonal_m = bounds.size().length();
        if !(bounds.min.is_finite() && bounds.max.is_finite() && diagonal_m.is_finite()) {
            return Self { low: [0.0, 0.0, 0.0, -1.0], high: [0.0; 4] };
        }
        Self { low: bounds.min.extend(diagonal_m).to_array(), high: bounds.max.extend(0.0).to_array() }
    }
}

/// The blocks of a plan's culled runs, and the arguments of their calls before anything is seen.
fn blocks_and_calls(plan: &Plan) -> (Vec<InstanceBlock>, Vec<DrawIndexedIndirectArgs>) {
    let (mut blocks, mut calls) = (Vec::new(), Vec::new());
    for (run, call) in (0..).zip(&plan.culled) {
        let DrawShape::Placed { indices, instances, .. } = &call.shape else { continue };
        let run_block = blocks.len() as u32;
        blocks.extend(instances.clone().step_by(BLOCK_INSTANCES as usize).map(|first| {
            let count = (instances.end - first).min(BLOCK_INSTANCES);
            InstanceBlock { first, count, run, run_block }
        }));
        calls.push(DrawIndexedIndirectArgs {
            index_count: indices.len() as u32,
            instance_count: 0,
            first_index: indices.start,
            base_vertex: 0,
            first_instance: 0,
        });
    }
    (blocks, calls)
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec2};

    use super::*;
    use crate::adapter::GpuApi;
    use crate::culling::{CullingView, ItemGroup};
    use crate::geometry::GpuGeometry;
    use crate::materials::{TexturePlaces, TextureScope};
    use crate::test_device::{gpu, read};
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId};
    use sandtable_draw::material::{AlphaMode, Material};
    use sandtable_mesh::sink::{MeshSink, VertexId};
    use sandtable_view::axes::DirectionAxes;
    use sandtable_view::camera::ParallelFrame;

    /// Meters along the side of the ground that instances stand on.
    const SIDE_M: f32 = 2000.0;

    /// Runs of these lengths, strewn over the ground; those of odd number are glass.
    fn list(runs: &[usize]) -> DrawList {
        let mut list = DrawList::default();
        for (number, &count) in runs.iter().enumerate() {
            let mut mesh = DrawMesh::default();
            for position in [[0.0; 3], [3.0, 0.5, 0.0], [0.0, 0.0, 7.0]] {
                let corner = DrawVertex { position, normal: [0.0; 3], uv: [0.0; 2], color: Srgba::WHITE };
                mesh.vertex(corner);
            }
            mesh.triangle([VertexId(0), VertexId(1), VertexId(2)]);
            let mesh = list.add_mesh(mesh);
            let alpha = if number % 2 == 0 { AlphaMode::Opaque } else { AlphaMode::Blend };
            let material = list.add_material(Material { alpha, ..Default::default() });
            let share = |index: usize, ratio: f64| (0.5 + index as f64 * ratio).fract() as f32;
            list.items.extend((0..count).map(|index| {
                let at = Vec3::new(share(index, 0.754_877_666), share(index, 0.569_840_291), 0.0) * SIDE_M;
                let world_from_mesh = Mat4::from_translation(at)
                    * Mat4::from_scale(Vec3::splat(0.5 + share(index, 0.618_033_989)));
                let (layer, feature) = (DepthLayer::Solid, FeatureId(list_number(number, index)));
                DrawItem { mesh, triangles: 0..1, material, world_from_mesh, layer, feature }
            }));
        }
        list
    }

    fn list_number(run: usize, index: usize) -> u32 {
        (run * 10_000 + index) as u32
    }

    /// Cameras that see all, some, those far away, and nothing.
    fn cameras() -> Vec<Camera> {
        let middle = Vec3::new(SIDE_M * 0.5, SIDE_M * 0.5, 0.0);
        let mut cameras: Vec<Camera> = (0..40u16)
            .map(|turn| {
                let toward = Vec2::from_angle(f32::from(turn) * 0.37);
                let eye = middle + (toward * f32::from(turn) * 45.0).extend(5.0 + f32::from(turn) * 9.0);
                let forward = (toward.perp() * 1.3 + toward).extend(-0.1 * f32::from(turn % 7));
                Camera::new(eye, eye + forward, 0.3 + f32::from(turn) * 0.03, (1024, 768), (1.0, 3000.0))
                    .expect("sound")
            })
            .collect();
        let from_above = Vec3::new(0.01, 0.0, -1.0);
        let above = middle + Vec3::Z * 5000.0;
        cameras.push(Camera::new(above, above + from_above, 1.0, (1024, 1024), (1.0, 1e5)).expect("sound"));
        cameras.push(Camera::new(above, above - from_above, 1.0, (1024, 768), (1.0, 1e5)).expect("sound"));
        // So far away that some of them are too small.
        let far = middle + Vec3::Z * 13_000.0;
        cameras.push(Camera::new(far, far + from_above, 1.0, (1024, 1024), (1.0, 1e5)).expect("sound"));
        for half_m in [300.0, 9000.0] {
            let frame = ParallelFrame { half_m: Vec2::new(half_m, half_m * 0.75), dpi: 96.0 };
            let axes = DirectionAxes::new(0.7, 0.4);
            let camera = Camera::parallel(middle, &axes, frame, (1024, 768), (1.0, 4000.0));
            cameras.push(camera.expect("sound"));
        }
        cameras
    }

    /// What `buffer` holds, as numbers of 32 bits.
    fn numbers(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<u32> {
        let bytes = read(gpu, gpu.encoder("copy"), buffer);
        bytes.as_chunks().0.iter().map(|bytes| u32::from_ne_bytes(*bytes)).collect()
    }

    /// Compares what the device finds to be seen with what the processor does, for all cameras, on every adapter.
    fn compare(list: &DrawList) -> Vec<usize> {
        let mut totals = Vec::new();
        for api in [GpuApi::Vulkan, GpuApi::Gl] {
            let Some(gpu) = gpu(&[api]) else { continue };
            if InstanceCulling::of(&gpu, list.items.len()) == InstanceCulling::Processor {
                eprintln!("SKIPPED: {} culls nothing", gpu.name());
                continue;
            }
            let places = TexturePlaces::new(list, TextureScope::All, &gpu.limits);
            let plan = Plan::of_solids(list, &places, InstanceCulling::Device);
            let loader = Loader::new(&gpu);
            let geometry = GpuGeometry::upload(&loader, list, &plan, None).expect("sent");
            let culler = InstanceCuller::open(&gpu).expect("shaders");
            let culled = culler.load(&loader, &plan, geometry.instances()).expect("sent").expect("some");
            totals =
                cameras().iter().map(|camera| compare_seen(&gpu, list, (&plan, &culled), camera)).collect();
        }
        totals
    }

    /// Compares what `camera` sees, and returns how much that is.
    fn compare_seen(
        gpu: &Gpu,
        list: &DrawList,
        (plan, culled): (&Plan, &CulledInstances),
        camera: &Camera,
    ) -> usize {
        let mut encoder = gpu.encoder("culling");
        culled.see(&mut BufferWrites::by_queue(gpu), camera);
        culled.record(&mut encoder, None);
        gpu.queue.submit([encoder.finish()]);
        let (calls, seen) = (numbers(gpu, &culled.calls), numbers(gpu, &culled.seen));
        let view = CullingView::new(camera);
        let mut total = 0;
        for (run, call) in plan.culled.iter().enumerate() {
            let DrawShape::Placed { instances, .. } = &call.shape else { panic!("{call:?}") };
            let shows = |index: &usize| view.shows(&ItemGroup::of(plan.culled_bounds[*index]));
            let range = instances.start as usize..instances.end as usize;
            let expected: Vec<u32> =
                range.filter(shows).map(|index| list.items[plan.placed[index]].feature.0).collect();
            let count = calls[run * 5 + 1] as usize;
            let words = size_of::<Instance>() / 4;
            let found = seen.chunks(words).skip(instances.start as usize).take(count).map(|words| words[0]);
            assert_eq!(found.collect::<Vec<u32>>(), expected, "run {run} by {camera:?} on {}", gpu.name());
            total += count;
        }
        total
    }

    #[test]
    fn the_device_shows_those_instances_that_the_processor_would_in_their_order() {
        // Of one block, of a block and one, of many blocks; glass and a short run are the processor's.
        let list = list(&[256, 100, 257, 100, 3000, 100, 64, 100, 63]);
        let totals = compare(&list);
        if totals.is_empty() {
            return;
        }
        let all = 256 + 257 + 3000 + 64;
        assert!(totals.contains(&all) && totals.contains(&0), "{totals:?}");
        assert!(totals.iter().filter(|total| (1..all).contains(*total)).count() > 20, "{totals:?}");
    }

    #[test]
    fn instances_at_places_that_are_not_finite_are_always_shown() {
        let mut list = list(&[64]);
        for (item, at) in list.items.iter_mut().zip([f32::NAN, f32::INFINITY, 3e38]) {
            item.world_from_mesh =
                Mat4::from_translation(Vec3::splat(at)) * Mat4::from_scale(Vec3::splat(1e3));
        }
        let totals = compare(&list);
        assert!(totals.iter().all(|total| *total >= 1), "{totals:?}");
    }

    #[test]
    fn the_constants_are_laid_out_as_the_shader_declares_them() {
        let module = naga::front::wgsl::parse_str(SHADER).unwrap_or_else(|error| panic!("{error}"));
        let size = |name: &str| {
            let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
            match found.expect("it is declared").1.inner {
                naga::TypeInner::Struct { span, .. } => span as usize,
                _ => panic!("{name} is no structure"),
            }
        };
        assert_eq!(size("View"), size_of::<CullingUniforms>());
        assert_eq!(size("InstanceBox"), size_of::<InstanceBox>());
        assert_eq!(size("Block"), size_of::<InstanceBlock>());
    }
}

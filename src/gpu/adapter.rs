//! Opening an adapter, and running commands on it safely.
//!
//! A device reports errors and exhaustion not where they occur but to the innermost error scope, and `wgpu` panics
//! where a device vanishes during a wait. `Gpu::guarded` turns all of these into values.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::{DriverError, GpuError};
use crate::formats::{COLOR, DEPTH};
use crate::instance_culling::{BLOCK_INSTANCES, STORAGE_BUFFERS};

/// The most readings of a texture along a pixel seen at a grazing angle; on a software adapter those of the CPU renderer,
/// since each costs time there.
const ANISOTROPY: u16 = 16;
const SOFTWARE_ANISOTROPY: u16 = 8;

/// The label of devices in the messages of drivers and debuggers.
const DEVICE_LABEL: &str = "sandtable";

/// Samples per pixel, where the adapter supports them; every WebGPU adapter has one and four, nothing else is common.
const SAMPLES: u32 = 4;

/// The interface to a GPU's driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GpuApi {
    /// Vulkan: the full feature set.
    Vulkan,
    /// OpenGL or OpenGL ES through EGL: older drivers and machines without a display.
    Gl,
}

/// An open device; drawing with it again saves the 0.1 to 0.3 seconds that opening takes.
#[derive(Clone, Debug)]
pub struct Gpu {
    adapter: wgpu::Adapter,
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) limits: wgpu::Limits,
    pub(super) samples: u32,
    pub(super) anisotropy: u16,
    /// Whether the processor draws.
    pub(super) is_software: bool,
    /// Whether it reads from a buffer what a call is to draw.
    pub(super) draws_indirectly: bool,
    /// Whether it can leave out instances of what stands by itself.
    pub(super) culls_instances: bool,
    api: GpuApi,
    name: String,
    failure: DeviceFailure,
}

/// The first failure that a device reported outside an error scope: its loss, or a stray error.
type DeviceFailure = Arc<Mutex<Option<Arc<DriverError>>>>;

impl Gpu {
    /// Opens the first of `apis` that offers an adapter, and its fastest adapter.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] where none does.
    pub fn open(apis: &[GpuApi]) -> Result<Self, GpuError> {
        let mut tried = Vec::new();
        for &api in apis {
            match catch_unwind(|| pollster::block_on(open(api))).unwrap_or(Err(DriverError::Crash)) {
                Ok(gpu) => return Ok(gpu),
                Err(error) => tried.push((api, error)),
            }
        }
        Err(GpuError::NoAdapter(tried))
    }

    /// A device that a window has opened; its errors outside of error scopes are recorded here from now on.
    pub fn from_parts(adapter: &wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let flags = adapter.get_downlevel_capabilities().flags;
        let info = adapter.get_info();
        let api = api_of(adapter);
        let limits = device.limits();
        Self {
            adapter: adapter.clone(),
            failure: watch(&device),
            culls_instances: culls_instances(flags, &limits),
            limits,
            device,
            queue,
            samples: if supports_samples(adapter) { SAMPLES } else { 1 },
            anisotropy: match flags.contains(wgpu::DownlevelFlags::ANISOTROPIC_FILTERING) {
                true if is_software(adapter) => SOFTWARE_ANISOTROPY,
                true => ANISOTROPY,
                false => 1,
            },
            is_software: is_software(adapter),
            draws_indirectly: flags
                .contains(wgpu::DownlevelFlags::INDIRECT_EXECUTION | wgpu::DownlevelFlags::BASE_VERTEX),
            api,
            name: format!("{} ({api:?})", info.name),
        }
    }

    /// The adapter's name as its driver gives it, with the interface.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The interface.
    pub fn api(&self) -> GpuApi {
        self.api
    }

    /// Whether the processor draws.
    pub fn is_software(&self) -> bool {
        self.is_software
    }

    /// The adapter.
    pub fn adapter(&self) -> &wgpu::Adapter {
        &self.adapter
    }

    /// The longest side of a texture, in pixels.
    pub fn longest_side(&self) -> u32 {
        self.limits.max_texture_dimension_2d
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue of its commands.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// The same device, with at most so many readings of a texture along a pixel.
    pub(super) fn with_anisotropy(&self, anisotropy: u16) -> Self {
        Self { anisotropy, ..self.clone() }
    }

    pub(super) fn encoder(&self, label: &'static str) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }

    /// Runs `work`; returns the errors of the device and its driver.
    pub(super) fn guarded<T>(
        &self,
        doing: &'static str,
        work: impl FnOnce() -> Result<T, GpuError>,
    ) -> Result<T, GpuError> {
        let scopes =
            [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::OutOfMemory]
                .map(|filter| self.device.push_error_scope(filter));
        let result = catch_unwind(AssertUnwindSafe(work));
        // Scopes are a stack: the last one pushed is popped first. All of them must be popped.
        let errors = scopes.into_iter().rev().map(|scope| pollster::block_on(scope.pop()));
        let error = errors.fold(None, |first, error| first.or(error));
        if let Some(wgpu::Error::OutOfMemory { .. }) = error {
            return Err(GpuError::OutOfMemory { doing, adapter: self.name.clone() });
        }
        if let Some(failure) = self.failure.lock().unwrap_or_else(PoisonError::into_inner).clone() {
            let adapter = self.name.clone();
            return Err(match &*failure {
                DriverError::Lost(reason) => GpuError::DeviceLost { doing, adapter, reason: reason.clone() },
                _ => GpuError::Driver { doing, adapter, source: failure },
            });
        }
        match error {
            Some(error) => Err(self.driver_error(doing, error)),
            None => result.unwrap_or_else(|_| Err(self.driver_error(doing, DriverError::Crash))),
        }
    }

    pub(super) fn driver_error(&self, doing: &'static str, source: impl Into<DriverError>) -> GpuError {
        GpuError::Driver { doing, adapter: self.name.clone(), source: Arc::new(source.into()) }
    }
}

async fn open(api: GpuApi) -> Result<Gpu, DriverError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: match api {
            GpuApi::Vulkan => wgpu::Backends::VULKAN,
            GpuApi::Gl => wgpu::Backends::GL,
        },
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let options = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        ..Default::default()
    };
    let adapter = instance.request_adapter(&options).await?;
    open_device(&adapter).await
}

async fn open_device(adapter: &wgpu::Adapter) -> Result<Gpu, DriverError> {
    let wanted = wgpu::Features::POLYGON_MODE_LINE | wgpu::Features::TIMESTAMP_QUERY;
    // Exactly the adapter's own limits: within downlevel limits wherever the adapter is.
    let descriptor = wgpu::DeviceDescriptor {
        label: Some(DEVICE_LABEL),
        required_features: adapter.features() & wanted,
        required_limits: adapter.limits(),
        memory_hints: memory_hints(adapter),
        ..Default::default()
    };
    let (device, queue) = adapter.request_device(&descriptor).await?;
    Ok(Gpu::from_parts(adapter, device, queue))
}

/// Where the processor draws, a block of memory is filled with zeros when it is made: small blocks waste less.
fn memory_hints(adapter: &wgpu::Adapter) -> wgpu::MemoryHints {
    if is_software(adapter) { wgpu::MemoryHints::MemoryUsage } else { wgpu::MemoryHints::Performance }
}

fn is_software(adapter: &wgpu::Adapter) -> bool {
    adapter.get_info().device_type == wgpu::DeviceType::Cpu
}

/// OpenGL's adapters say so; whatever else there is reads depth as Vulkan does.
fn api_of(adapter: &wgpu::Adapter) -> GpuApi {
    if adapter.get_info().backend == wgpu::Backend::Gl { GpuApi::Gl } else { GpuApi::Vulkan }
}

/// Where the failure of `device` will be recorded; also keeps stray errors from ending the program.
fn watch(device: &wgpu::Device) -> DeviceFailure {
    let failure = DeviceFailure::default();
    let record = |error: DriverError, failure: &DeviceFailure| {
        *failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(error));
    };
    let lost = Arc::clone(&failure);
    device.set_device_lost_callback(move |reason, message| {
        if reason != wgpu::DeviceLostReason::Destroyed {
            record(DriverError::Lost(message), &lost);
        }
    });
    let stray = Arc::clone(&failure);
    device.on_uncaptured_error(Arc::new(move |error| record(DriverError::Command(error), &stray)));
    failure
}

/// Whether shaders that compute may write what calls draw, with as many threads and buffers as the culling of instances has.
fn culls_instances(flags: wgpu::DownlevelFlags, limits: &wgpu::Limits) -> bool {
    flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS | wgpu::DownlevelFlags::INDIRECT_EXECUTION)
        && limits.max_storage_buffers_per_shader_stage >= STORAGE_BUFFERS
        && limits.max_compute_invocations_per_workgroup.min(limits.max_compute_workgroup_size_x)
            >= BLOCK_INSTANCES
}

fn supports_samples(adapter: &wgpu::Adapter) -> bool {
    let flags = |format| adapter.get_texture_format_features(format).flags;
    [COLOR, DEPTH].into_iter().all(|format| flags(format).sample_count_supported(SAMPLES))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_device::gpu;

    #[test]
    fn a_lost_device_and_exhausted_memory_are_errors_of_their_own() {
        let Some(gpu) = gpu(&[GpuApi::Vulkan, GpuApi::Gl]) else { return };
        let exhausted = gpu.guarded("testing", || {
            let usage = wgpu::BufferUsages::STORAGE;
            let size = 1 << 60;
            let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
            drop(gpu.device.create_buffer(&descriptor));
            Ok(())
        });
        let error = exhausted.expect_err("no device holds an exbibyte");
        assert!(matches!(error, GpuError::OutOfMemory { .. } | GpuError::Driver { .. }), "{error}");
        assert!(gpu.guarded("testing", || Ok(())).is_ok(), "the device still works");
        let lost = Arc::new(DriverError::Lost("unplugged".into()));
        *gpu.failure.lock().expect("not poisoned") = Some(lost);
        let error = gpu.guarded("drawing a frame", || Ok(())).expect_err("it is lost");
        assert!(matches!(error, GpuError::DeviceLost { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains("drawing a frame") && text.contains("unplugged"), "{text}");
    }
}

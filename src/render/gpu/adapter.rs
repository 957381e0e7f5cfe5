//! Finding a GPU and talking to it safely.
//!
//! A device reports mistakes and exhaustion not where they happen but to the innermost error scope, and the
//! library panics where a device vanishes in the middle of a wait. `Gpu::guarded` is the one place that
//! turns all of these into values.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

use crate::render::gpu::error::GpuError;

/// How many samples a pixel's color is averaged from, where the adapter can; every WebGPU adapter offers
/// one and four, nothing else is common.
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
#[derive(Debug)]
pub struct Gpu {
    pub(in crate::render::gpu) device: wgpu::Device,
    pub(in crate::render::gpu) queue: wgpu::Queue,
    pub(in crate::render::gpu) limits: wgpu::Limits,
    pub(in crate::render::gpu) samples: u32,
    pub(in crate::render::gpu) anisotropy: u16,
    api: GpuApi,
    name: String,
    lost: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens the first of `apis` that offers an adapter, the fastest one where there are several.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] where none does.
    pub fn open(apis: &[GpuApi]) -> Result<Self, GpuError> {
        let mut tried = Vec::new();
        for &api in apis {
            match catch_unwind(|| pollster::block_on(open(api))) {
                Ok(Ok(gpu)) => return Ok(gpu),
                Ok(Err(reason)) => tried.push(format!("{api:?}: {reason}")),
                Err(_) => tried.push(format!("{api:?}: the driver crashed")),
            }
        }
        Err(GpuError::NoAdapter { tried: tried.join("; ") })
    }

    /// The adapter's name as its driver gives it, with the interface it is reached by.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The interface it is reached by.
    pub fn api(&self) -> GpuApi {
        self.api
    }

    /// Does `work` and reports whatever the device or its driver holds against it.
    pub(in crate::render::gpu) fn guarded<T>(
        &self,
        doing: &'static str,
        work: impl FnOnce() -> Result<T, GpuError>,
    ) -> Result<T, GpuError> {
        let failed = |reason: String| GpuError::Failed { doing, adapter: self.name.clone(), reason };
        let scopes =
            [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::OutOfMemory]
                .map(|filter| self.device.push_error_scope(filter));
        let result = catch_unwind(AssertUnwindSafe(work));
        // Scopes are a stack: the last one pushed is popped first.
        let errors = scopes.into_iter().rev().map(|scope| pollster::block_on(scope.pop()));
        let error = errors.collect::<Vec<_>>().into_iter().flatten().next();
        let lost = self.lost.lock().unwrap_or_else(PoisonError::into_inner).clone();
        match (error, lost, result) {
            (Some(wgpu::Error::OutOfMemory { .. }), _, _) => {
                Err(GpuError::OutOfMemory { doing, adapter: self.name.clone() })
            }
            (_, Some(reason), _) => Err(failed(format!("the device was lost ({reason})"))),
            (Some(error), None, _) => Err(failed(error.to_string())),
            (None, None, Ok(result)) => result,
            (None, None, Err(_)) => Err(failed("the driver crashed".into())),
        }
    }

    /// `bytes` where one buffer can hold them.
    ///
    /// # Errors
    /// [`GpuError::BufferSize`].
    pub(in crate::render::gpu) fn fitting(
        &self,
        what: impl FnOnce() -> String,
        bytes: u64,
    ) -> Result<u64, GpuError> {
        // Offsets into buffers are 32 bits wide, however large a buffer may be.
        let limit = self.limits.max_buffer_size.min(u64::from(u32::MAX));
        if bytes <= limit {
            return Ok(bytes);
        }
        Err(GpuError::BufferSize { what: what(), bytes, limit, adapter: self.name.clone() })
    }
}

async fn open(api: GpuApi) -> Result<Gpu, String> {
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
    let adapter = instance.request_adapter(&options).await.map_err(|error| error.to_string())?;
    // What the adapter has is asked for, no more: that is within downlevel limits wherever the adapter is.
    let limits = adapter.limits();
    let descriptor = wgpu::DeviceDescriptor { required_limits: limits.clone(), ..Default::default() };
    let (device, queue) = adapter.request_device(&descriptor).await.map_err(|error| error.to_string())?;
    let info = adapter.get_info();
    let flags = adapter.get_downlevel_capabilities().flags;
    Ok(Gpu {
        lost: watch(&device),
        device,
        queue,
        limits,
        samples: samples_of(&adapter),
        anisotropy: if flags.contains(wgpu::DownlevelFlags::ANISOTROPIC_FILTERING) { 16 } else { 1 },
        api,
        name: format!("{} ({api:?})", info.name),
    })
}

/// Where the loss of `device` will be noted; also keeps stray errors from ending the program.
fn watch(device: &wgpu::Device) -> Arc<Mutex<Option<String>>> {
    let lost = Arc::new(Mutex::new(None));
    let note = Arc::clone(&lost);
    device.set_device_lost_callback(move |reason, message| {
        if reason != wgpu::DeviceLostReason::Destroyed {
            *note.lock().unwrap_or_else(PoisonError::into_inner) = Some(message);
        }
    });
    let note = Arc::clone(&lost);
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        *note.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.to_string());
    }));
    lost
}

fn samples_of(adapter: &wgpu::Adapter) -> u32 {
    let formats = [crate::render::gpu::pipelines::COLOR, crate::render::gpu::pipelines::DEPTH];
    let all = formats
        .iter()
        .all(|&format| adapter.get_texture_format_features(format).flags.sample_count_supported(SAMPLES));
    if all { SAMPLES } else { 1 }
}

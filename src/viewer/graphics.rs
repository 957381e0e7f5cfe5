//! The window's surface, and the presenting of frames on it.

use std::sync::Arc;

use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use crate::app::ViewerApp;
use crate::error::ViewerError;
use crate::frame_drawer::{DrawnFrame, LaidFrame, PanelTarget};
use crate::frame_graphics::FrameGraphics;
use sandtable_gpu::adapter::Gpu;

/// How often in turn a surface may fail to fit its window before that is an error: more than a second of frames.
const MOST_FAILED_CONFIGURATIONS: u32 = 1000;

/// The surface, and what draws the frames on it.
pub struct WindowGraphics {
    window: Arc<Window>,
    instance: wgpu::Instance,
    /// What draws frames.
    pub frames: FrameGraphics,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    /// How often in turn the surface could not be made as it is to be.
    failed_configurations: u32,
}

/// Whether a frame is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramePresented {
    /// It is shown on the screen.
    Yes,
    /// Nothing can be seen now; the next event tries again.
    Hidden,
    /// The surface changed; the next frame is due at once.
    Again,
}

impl WindowGraphics {
    /// Opens the adapter that can draw on `window`.
    ///
    /// # Errors
    /// [`ViewerError::NoAdapter`] and [`ViewerError::Adapter`].
    pub fn open(event_loop: &ActiveEventLoop, window: Arc<Window>) -> Result<Self, ViewerError> {
        let display = Box::new(event_loop.owned_display_handle());
        let descriptor = wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN | wgpu::Backends::GL,
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_with_display_handle_from_env(display)
        };
        let instance = wgpu::Instance::new(descriptor);
        let no_adapter = |error: &dyn std::fmt::Display| ViewerError::NoAdapter(error.to_string());
        let surface = instance.create_surface(Arc::clone(&window)).map_err(|error| no_adapter(&error))?;
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: Some(&surface),
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options));
        let adapter = adapter.map_err(|error| no_adapter(&error))?;
        let descriptor =
            wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..wgpu::DeviceDescriptor::default() };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| no_adapter(&error))?;
        let size = window.inner_size();
        let configuration = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| ViewerError::NoAdapter("its surface has no format".to_owned()))?;
        let formats = surface.get_capabilities(&adapter).formats;
        // Panels are blended as their designers saw them, in gamma space.
        let format = formats.iter().copied().find(|format| !format.is_srgb()).unwrap_or(configuration.format);
        let configuration = wgpu::SurfaceConfiguration { format, ..configuration };
        surface.configure(&device, &configuration);
        let frames = FrameGraphics::new(Gpu::from_parts(&adapter, device, queue), format);
        Ok(Self { window, instance, frames, surface, configuration, failed_configurations: 0 })
    }

    /// Follows the window's size; of a minimized window, whose size is 0, it keeps the last. Returns the frame that it had to
    /// wait for.
    pub fn resize(&mut self, (width, height): (u32, u32), app: &mut ViewerApp) -> Option<DrawnFrame> {
        if width == 0 || height == 0 {
            return None;
        }
        let longest = self.frames.longest_side();
        self.configuration.width = width.min(longest);
        self.configuration.height = height.min(longest);
        // What fails now is done by the next frame; so is what was sent.
        let drawn = self.frames.finish(app).ok()?;
        let _ = self.configure();
        drawn
    }

    /// Whether a frame is of the size that the panels are laid out for.
    fn fits(&self, frame: &wgpu::SurfaceTexture) -> bool {
        let wgpu::SurfaceConfiguration { width, height, .. } = self.configuration;
        (frame.texture.width(), frame.texture.height()) == (width, height)
    }

    /// Makes the surface as it is to be. That fails while another thread sends to the device; the surface then stays as it was,
    /// and a frame that does not fit it does this again.
    fn configure(&mut self) -> Result<(), ViewerError> {
        let device = self.frames.gpu().device();
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        self.surface.configure(device, &self.configuration);
        let Some(error) = pollster::block_on(scope.pop()) else {
            self.failed_configurations = 0;
            return Ok(());
        };
        self.failed_configurations += 1;
        match self.failed_configurations < MOST_FAILED_CONFIGURATIONS {
            true => Ok(()),
            false => Err(ViewerError::Adapter {
                doing: "fitting its surface to the window",
                cause: error.to_string(),
            }),
        }
    }

    /// Draws a frame, presents it on `surface`, where it is seen, and returns while that is done.
    pub fn present(&mut self, app: &mut ViewerApp, frame: LaidFrame, surface: Option<wgpu::SurfaceTexture>) {
        let size = (self.configuration.width, self.configuration.height);
        let target = surface.as_ref().map(|surface| {
            let view = surface.texture.create_view(&wgpu::TextureViewDescriptor::default());
            PanelTarget { view, size }
        });
        if surface.is_some() {
            self.window.pre_present_notify();
        }
        let present = |gpu: &Gpu, _| {
            surface.into_iter().for_each(|surface| gpu.queue().present(surface));
            Ok(())
        };
        self.frames.draw(app, frame, (target, Box::new(present)));
    }

    /// Waits for the texture of the surface that the next frame is shown on; there is none where nothing is seen. The frame
    /// before is to be finished.
    ///
    /// # Errors
    /// [`ViewerError::Adapter`] where the surface cannot be made anew.
    pub fn acquire(&mut self) -> Result<(FramePresented, Option<wgpu::SurfaceTexture>), ViewerError> {
        use wgpu::CurrentSurfaceTexture as Current;
        match self.surface.get_current_texture() {
            Current::Success(frame) if self.fits(&frame) => return Ok((FramePresented::Yes, Some(frame))),
            Current::Success(frame) | Current::Suboptimal(frame) => drop(frame),
            Current::Timeout | Current::Occluded => return Ok((FramePresented::Hidden, None)),
            Current::Outdated | Current::Validation => {}
            Current::Lost => {
                let surface = self.instance.create_surface(Arc::clone(&self.window));
                let failed = |error: wgpu::CreateSurfaceError| ViewerError::Adapter {
                    doing: "making its surface anew",
                    cause: error.to_string(),
                };
                self.surface = surface.map_err(failed)?;
            }
        }
        self.configure()?;
        Ok((FramePresented::Again, None))
    }
}

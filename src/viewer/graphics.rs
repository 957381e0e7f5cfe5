//! The window's surface: the scene in a picture of its own, and the panels over it.
//!
//! The scene is drawn into a texture that `egui` shows like any other, so that it is as large as the room between the
//! panels, and the pointer's place on it is a pixel of its camera.

use std::sync::Arc;

use egui::{ClippedPrimitive, TextureId, TexturesDelta};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use crate::error::ViewerError;

/// How often in turn a surface may fail to fit its window before that is an error: more than a second of frames.
const MOST_FAILED_CONFIGURATIONS: u32 = 1000;

/// The device, the surface and what paints the panels.
pub struct WindowGraphics {
    window: Arc<Window>,
    instance: wgpu::Instance,
    adapter: wgpu::Adapter,
    /// The device, for the renderer of scenes.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    /// How often in turn the surface could not be made as it is to be.
    failed_configurations: u32,
    painter: Renderer,
}

/// The input for painting the panels of one frame.
pub struct PaintedPanels<'a> {
    /// Their triangles.
    pub primitives: &'a [ClippedPrimitive],
    /// Textures that are new or not needed any more.
    pub textures: TexturesDelta,
    /// Pixels per point.
    pub pixels_per_point: f32,
}

/// The outcome of presenting a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramePresented {
    /// It is on the screen.
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
        // The scene's picture among the panels is shown as it is.
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let painter = Renderer::new(&device, format, options);
        let failed_configurations = 0;
        Ok(Self {
            window,
            instance,
            adapter,
            device,
            queue,
            surface,
            configuration,
            failed_configurations,
            painter,
        })
    }

    /// The adapter's name and interface.
    pub fn name(&self) -> String {
        let info = self.adapter.get_info();
        format!("{} ({})", info.name, info.backend)
    }

    /// The adapter.
    pub fn adapter(&self) -> &wgpu::Adapter {
        &self.adapter
    }

    /// The longest side of a texture, in pixels.
    pub fn longest_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// Follows the window's size; of a minimized window, whose size is 0, it keeps the last.
    pub fn resize(&mut self, (width, height): (u32, u32)) {
        if width == 0 || height == 0 {
            return;
        }
        let longest = self.longest_side();
        self.configuration.width = width.min(longest);
        self.configuration.height = height.min(longest);
        // What fails now is done by the next frame.
        let _ = self.configure();
    }

    /// Whether a frame is of the size that the panels are laid out for.
    fn fits(&self, frame: &wgpu::SurfaceTexture) -> bool {
        let wgpu::SurfaceConfiguration { width, height, .. } = self.configuration;
        (frame.texture.width(), frame.texture.height()) == (width, height)
    }

    /// Makes the surface as it is to be. That fails while another thread sends to the device; the surface then stays as it was,
    /// and a frame that does not fit it does this again.
    fn configure(&mut self) -> Result<(), ViewerError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        self.surface.configure(&self.device, &self.configuration);
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

    /// Shows a texture of the device as `known`, or as a new texture of the panels.
    pub fn show_texture(&mut self, known: Option<TextureId>, view: &wgpu::TextureView) -> TextureId {
        let filter = wgpu::FilterMode::Nearest;
        match known {
            Some(id) => {
                self.painter.update_egui_texture_from_wgpu_texture(&self.device, view, filter, id);
                id
            }
            None => self.painter.register_native_texture(&self.device, view, filter),
        }
    }

    /// Paints the panels on the surface, after the commands of `before`, and presents it.
    ///
    /// # Errors
    /// [`ViewerError::Adapter`] where the surface cannot be made anew.
    pub fn present(
        &mut self,
        mut before: wgpu::CommandEncoder,
        mut panels: PaintedPanels<'_>,
    ) -> Result<FramePresented, ViewerError> {
        for (id, deltas) in &panels.textures.set {
            for delta in deltas {
                self.painter.update_texture(&self.device, &self.queue, *id, delta);
            }
        }
        let presented = self.paint(&mut before, &panels);
        for id in &panels.textures.free {
            self.painter.free_texture(id);
        }
        // The deltas insist on being taken.
        panels.textures.clear();
        let (presented, frame, commands) = presented?;
        self.queue.submit(commands.into_iter().chain([before.finish()]));
        if let Some(frame) = frame {
            self.window.pre_present_notify();
            self.queue.present(frame);
        }
        Ok(presented)
    }

    #[allow(clippy::type_complexity, reason = "the three parts of a frame that is on its way")]
    fn paint(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        panels: &PaintedPanels<'_>,
    ) -> Result<(FramePresented, Option<wgpu::SurfaceTexture>, Vec<wgpu::CommandBuffer>), ViewerError> {
        use wgpu::CurrentSurfaceTexture as Current;
        let (frame, presented) = match self.surface.get_current_texture() {
            Current::Success(frame) if self.fits(&frame) => (frame, FramePresented::Yes),
            Current::Success(frame) | Current::Suboptimal(frame) => {
                drop(frame);
                self.configure()?;
                return Ok((FramePresented::Again, None, Vec::new()));
            }
            Current::Timeout | Current::Occluded => return Ok((FramePresented::Hidden, None, Vec::new())),
            Current::Outdated | Current::Validation => {
                self.configure()?;
                return Ok((FramePresented::Again, None, Vec::new()));
            }
            Current::Lost => {
                let surface = self.instance.create_surface(Arc::clone(&self.window));
                let failed = |error: wgpu::CreateSurfaceError| ViewerError::Adapter {
                    doing: "making its surface anew",
                    cause: error.to_string(),
                };
                self.surface = surface.map_err(failed)?;
                self.configure()?;
                return Ok((FramePresented::Again, None, Vec::new()));
            }
        };
        let screen = ScreenDescriptor {
            size_in_pixels: [self.configuration.width, self.configuration.height],
            pixels_per_point: panels.pixels_per_point,
        };
        let commands =
            self.painter.update_buffers(&self.device, &self.queue, encoder, panels.primitives, &screen);
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panels"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        self.painter.render(&mut pass.forget_lifetime(), panels.primitives, &screen);
        Ok((presented, Some(frame), commands))
    }
}

//! The drawing of frames, whatever they are shown on: the scene in a picture of its own, and the panels over it.

use std::sync::Arc;
use std::time::Instant;

use egui::{ClippedPrimitive, Context, PlatformOutput, RawInput, TexturesDelta};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

use crate::app::{ViewerApp, WindowRequest};
use crate::drawn_size::{DrawnSize, FramePurpose};
use crate::error::ViewerError;
use crate::frame_sending::{AfterSending, FrameSending};
use crate::frame_times::{FrameLoad, FrameTime};
use crate::opened::SceneFrame;
use crate::picture_paint::{PictureFit, PicturePaint, blended_format};
use crate::scene_graphics::{SceneGraphics, milliseconds};
use sandtable_base::message::chain::error_text;
use sandtable_gpu::adapter::Gpu;
use sandtable_gpu::live::LiveOptions;
use sandtable_gpu::pass_timer::PassTimer;
use sandtable_view::camera::Camera;

/// The device, what paints the panels, and the renderer of scenes.
pub struct FrameGraphics {
    gpu: Gpu,
    painter: Renderer,
    /// `None` until there is a scene, and after its renderer failed.
    scene: Option<SceneGraphics>,
    timer: Option<Arc<PassTimer>>,
    /// The sizes of the scene's pictures; `None` where all of them are whole.
    size: Option<DrawnSize>,
    sending: FrameSending,
    format: wgpu::TextureFormat,
}

/// The input for painting the panels of one frame.
pub struct PaintedPanels {
    /// Their triangles.
    primitives: Vec<ClippedPrimitive>,
    /// Textures that are new or not needed any more.
    textures: TexturesDelta,
    pixels_per_point: f32,
}

/// A frame whose scene is recorded and whose panels are laid out.
pub struct RecordedFrame {
    /// Its commands.
    pub encoder: wgpu::CommandEncoder,
    /// What was drawn of the scene; `None` where there is none.
    pub drawn: Option<(FrameTime, FrameLoad)>,
    /// What the app wants of the window.
    pub requests: Vec<WindowRequest>,
    /// What the panels want of the system.
    pub platform: PlatformOutput,
    /// The panels that are to be painted over it.
    pub panels: PaintedPanels,
}

/// A texture that the panels are painted on.
#[derive(Clone, Copy)]
pub struct PanelTarget<'a> {
    /// The texture.
    pub view: &'a wgpu::TextureView,
    /// Its size in pixels.
    pub size: (u32, u32),
}

impl FrameGraphics {
    /// Frames by a device, on textures of `format`.
    pub fn new(gpu: Gpu, format: wgpu::TextureFormat) -> Self {
        // The scene's picture among the panels is shown as it is.
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let mut painter = Renderer::new(gpu.device(), format, options);
        painter.callback_resources.insert(PicturePaint::new(gpu.device(), format));
        let size = gpu.is_software().then(DrawnSize::new);
        Self { gpu, painter, scene: None, timer: None, size, sending: FrameSending::default(), format }
    }

    /// Times the passes of the frames that follow, where the device has a clock.
    pub fn time_passes(&mut self) -> Option<Arc<PassTimer>> {
        self.timer = PassTimer::new(&self.gpu).map(Arc::new);
        self.timer.clone()
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The format of the textures that frames are painted on.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// The adapter's name and interface.
    pub fn name(&self) -> String {
        let info = self.gpu.adapter().get_info();
        format!("{} ({})", info.name, info.backend)
    }

    /// The longest side of a texture, in pixels.
    pub fn longest_side(&self) -> u32 {
        self.gpu.longest_side()
    }

    /// Notes what a frame took in all, milliseconds: the sizes of those that follow depend on it.
    pub fn note_time(&mut self, taken_ms: f32) {
        self.size.iter_mut().for_each(|size| size.note_time(taken_ms));
    }

    /// The size in pixels of the scene's picture of the next frame.
    fn picture_size(&mut self, camera: &Camera, purpose: FramePurpose) -> (u32, u32) {
        self.size.as_mut().map_or(camera.size(), |size| size.of_next(camera, purpose))
    }

    /// How many pipelines the renderer of scenes has made.
    pub fn pipelines(&self) -> usize {
        self.scene.as_ref().map_or(0, SceneGraphics::pipelines)
    }

    /// Makes the renderer of scenes. What fails is said among the panels, which stay.
    pub fn open_scene(&mut self, app: &mut ViewerApp) {
        match SceneGraphics::new(&self.gpu, blended_format(&self.gpu), self.timer.clone()) {
            Ok(scene) => {
                app.slot.fill(scene.loader());
                self.scene = Some(scene);
            }
            Err(error) => app.warn(error_text(&error)),
        }
    }

    /// Sends what was recorded of a frame; see [`FrameSending::send`].
    ///
    /// # Errors
    /// What `after` returns.
    pub fn send(
        &mut self,
        commands: Vec<wgpu::CommandBuffer>,
        after: AfterSending,
    ) -> Result<(), ViewerError> {
        self.sending.send(&self.gpu, commands, after)
    }

    /// Waits until the frames before are sent.
    ///
    /// # Errors
    /// What followed their sending returned.
    pub fn finish_sending(&mut self) -> Result<(), ViewerError> {
        self.sending.finish()
    }

    /// Lays out the panels of a frame and records its scene, once the frame before is sent.
    ///
    /// # Errors
    /// What followed the sending of the frame before returned.
    pub fn record(
        &mut self,
        context: &Context,
        app: &mut ViewerApp,
        input: RawInput,
    ) -> Result<RecordedFrame, ViewerError> {
        let laying_out = Instant::now();
        let output = context.run_ui(input, |ui| app.show(ui));
        let primitives = context.tessellate(output.shapes, output.pixels_per_point);
        let panels_ms = milliseconds(laying_out);
        let label = wgpu::CommandEncoderDescriptor { label: Some("frame") };
        let mut encoder = self.gpu.device().create_command_encoder(&label);
        let requests = app.take_requests();
        let is_kept = requests.iter().any(|request| matches!(request, WindowRequest::Picture(_)));
        let purpose = if is_kept { FramePurpose::Kept } else { FramePurpose::Shown };
        let mut frame = app.scene_frame(|camera| self.picture_size(camera, purpose));
        let waiting = Instant::now();
        self.finish_sending()?;
        let wait_ms = milliseconds(waiting);
        let drawn = frame.as_mut().and_then(|frame| self.draw_scene(&mut encoder, frame, app));
        if self.size.as_ref().is_some_and(DrawnSize::is_lowered) {
            context.request_repaint();
        }
        let drawn = drawn.map(|(time, load)| (FrameTime { panels_ms, wait_ms, ..time }, load));
        let (textures, pixels_per_point) = (output.textures_delta, output.pixels_per_point);
        let panels = PaintedPanels { primitives, textures, pixels_per_point };
        Ok(RecordedFrame { encoder, drawn, requests, platform: output.platform_output, panels })
    }

    /// Records the scene's picture. What fails is said among the panels, which stay.
    fn draw_scene(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &mut SceneFrame,
        app: &mut ViewerApp,
    ) -> Option<(FrameTime, FrameLoad)> {
        if self.scene.is_none() {
            self.open_scene(app);
        }
        let mut scene = self.scene.take()?;
        let options = LiveOptions { wireframe: app.shows_edges(), ..LiveOptions::default() };
        let is_loaded = frame.load.is_some();
        let drawn = scene.draw(self, encoder, frame, &options);
        match drawn {
            Ok(drawn) => {
                if is_loaded {
                    app.slot.fill(scene.loader());
                }
                self.scene = Some(scene);
                Some(drawn)
            }
            Err(error) => {
                // A renderer that failed is made anew, and takes over the scene again.
                app.warn(error_text(&error));
                app.reload_scene();
                None
            }
        }
    }

    /// Shows a texture of the device as the scene's picture among the panels.
    pub fn show_picture(&mut self, view: &wgpu::TextureView, fit: PictureFit) {
        if let Some(paint) = self.painter.callback_resources.get_mut::<PicturePaint>() {
            paint.show(self.gpu.device(), view, fit);
        }
    }

    /// Takes over the textures that are new to the panels.
    pub fn take_textures(&mut self, panels: &PaintedPanels) {
        for (id, deltas) in &panels.textures.set {
            for delta in deltas {
                self.painter.update_texture(self.gpu.device(), self.gpu.queue(), *id, delta);
            }
        }
    }

    /// Records the panels; returns what is to be submitted before.
    pub fn paint(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        panels: &PaintedPanels,
        target: PanelTarget<'_>,
    ) -> Vec<wgpu::CommandBuffer> {
        let screen = ScreenDescriptor {
            size_in_pixels: target.size.into(),
            pixels_per_point: panels.pixels_per_point,
        };
        let (device, queue) = (self.gpu.device(), self.gpu.queue());
        let commands = self.painter.update_buffers(device, queue, encoder, &panels.primitives, &screen);
        let label = "panels";
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            timestamp_writes: self.timer.as_ref().and_then(|timer| timer.writes(label)),
            ..wgpu::RenderPassDescriptor::default()
        });
        self.painter.render(&mut pass.forget_lifetime(), &panels.primitives, &screen);
        commands
    }

    /// Forgets the textures that the panels need no more.
    pub fn free_textures(&mut self, panels: &mut PaintedPanels) {
        for id in &panels.textures.free {
            self.painter.free_texture(id);
        }
        // The deltas insist on being taken.
        panels.textures.clear();
    }
}

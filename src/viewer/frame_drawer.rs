//! What draws frames, whatever they are shown on: the scene in a picture of its own, and the panels over it.

use std::sync::Arc;
use std::time::Instant;

use egui::{ClippedPrimitive, TexturesDelta};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

use crate::error::ViewerError;
use crate::frame_times::{FrameLoad, FrameTime};
use crate::opened::SceneFrame;
use crate::picture_paint::{PictureFit, PicturePaint, blended_format};
use crate::scene_graphics::{SceneGraphics, milliseconds};
use sandtable_gpu::adapter::Gpu;
use sandtable_gpu::error::GpuError;
use sandtable_gpu::live::LiveOptions;
use sandtable_gpu::live::prepared::LiveLoader;
use sandtable_gpu::pass_timer::PassTimer;

/// What follows the sending of a frame's commands, of which it takes the number.
pub type AfterSending = Box<dyn FnOnce(&Gpu, wgpu::SubmissionIndex) -> Result<(), ViewerError> + Send>;

/// The device, what paints the panels, and the renderer of scenes.
pub struct FrameDrawer {
    gpu: Gpu,
    painter: Renderer,
    /// `None` until there is a scene, and after its renderer failed.
    scene: Option<SceneGraphics>,
    timer: Option<Arc<PassTimer>>,
}

/// The input for painting the panels of one frame.
pub struct PaintedPanels {
    /// Their triangles.
    pub primitives: Vec<ClippedPrimitive>,
    /// Textures that are new or not needed any more.
    pub textures: TexturesDelta,
    /// The pixels of a point.
    pub pixels_per_point: f32,
}

/// A texture that the panels are painted on.
#[derive(Clone, Debug)]
pub struct PanelTarget {
    /// The texture.
    pub view: wgpu::TextureView,
    /// Its size in pixels.
    pub size: (u32, u32),
}

/// A frame whose panels are laid out and whose ground is up to date.
pub struct LaidFrame {
    /// The scene; `None` where there is none.
    pub scene: Option<SceneFrame>,
    /// Its options.
    pub options: LiveOptions,
    /// The panels over it.
    pub panels: PaintedPanels,
    /// What was spent on it so far.
    pub time: FrameTime,
}

/// The outcome of drawing a frame.
#[derive(Debug, Default)]
pub struct DrawnFrame {
    /// What the scene took and showed; `None` where there is none.
    pub scene: Option<(FrameTime, FrameLoad)>,
    /// Why the scene is not drawn; its renderer is to be made anew.
    pub failure: Option<GpuError>,
    /// The loader of the renderer, where it has taken over a list.
    pub loader: Option<LiveLoader>,
    /// How many pipelines the renderer of scenes has made.
    pub pipelines: usize,
}

impl DrawnFrame {
    /// Whether the app has to know of it even where nothing else happens.
    pub fn is_news(&self) -> bool {
        self.failure.is_some() || self.loader.is_some()
    }
}

impl FrameDrawer {
    /// Frames by a device, on textures of `format`.
    pub fn new(gpu: Gpu, format: wgpu::TextureFormat) -> Self {
        // The scene's picture among the panels is shown as it is.
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let mut painter = Renderer::new(gpu.device(), format, options);
        painter.callback_resources.insert(PicturePaint::new(gpu.device(), format));
        Self { gpu, painter, scene: None, timer: None }
    }

    /// Lets `timer` time the passes of the frames that follow.
    pub fn set_timer(&mut self, timer: Option<Arc<PassTimer>>) {
        self.timer = timer;
    }

    /// Makes the renderer of scenes; returns its loader, and `None` where there is one.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn open_scene(&mut self) -> Result<Option<LiveLoader>, GpuError> {
        if self.scene.is_some() {
            return Ok(None);
        }
        let scene = SceneGraphics::new(&self.gpu, blended_format(&self.gpu), self.timer.clone())?;
        let loader = scene.loader();
        self.scene = Some(scene);
        Ok(Some(loader))
    }

    /// Draws a frame and sends it; without a target its panels are left out, as where the window is hidden.
    ///
    /// # Errors
    /// What `after` returns.
    pub fn draw(
        &mut self,
        LaidFrame { scene, options, mut panels, time }: LaidFrame,
        target: Option<PanelTarget>,
        after: AfterSending,
    ) -> Result<DrawnFrame, ViewerError> {
        let label = wgpu::CommandEncoderDescriptor { label: Some("frame") };
        let mut encoder = self.gpu.device().create_command_encoder(&label);
        let mut drawn = scene.map_or_else(DrawnFrame::default, |mut frame| {
            self.draw_scene(&mut encoder, &mut frame, &options)
        });
        let painting = Instant::now();
        self.take_textures(&panels);
        let commands = target.map_or_else(Vec::new, |target| self.paint(&mut encoder, &panels, &target));
        self.free_textures(&mut panels);
        self.timer.iter().for_each(|timer| timer.finish(&mut encoder));
        let sent = self.gpu.queue().submit(commands.into_iter().chain([encoder.finish()]));
        self.timer.iter().for_each(|timer| timer.request());
        after(&self.gpu, sent)?;
        if let Some((taken, _)) = &mut drawn.scene {
            let FrameTime { upload_ms, draw_ms, .. } = *taken;
            *taken = FrameTime { upload_ms, draw_ms: draw_ms + milliseconds(painting), ..time };
        }
        Ok(drawn)
    }

    /// Records the scene's picture.
    fn draw_scene(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &mut SceneFrame,
        options: &LiveOptions,
    ) -> DrawnFrame {
        let Some(mut scene) = self.scene.take() else { return DrawnFrame::default() };
        let is_loaded = frame.load.is_some();
        match scene.draw(self, encoder, frame, options) {
            Ok(drawn) => {
                let (loader, pipelines) = (is_loaded.then(|| scene.loader()), scene.pipelines());
                self.scene = Some(scene);
                DrawnFrame { scene: Some(drawn), failure: None, loader, pipelines }
            }
            Err(error) => DrawnFrame { failure: Some(error), ..DrawnFrame::default() },
        }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Shows a texture of the device as the scene's picture among the panels.
    pub fn show_picture(&mut self, view: &wgpu::TextureView, fit: PictureFit) {
        if let Some(paint) = self.painter.callback_resources.get_mut::<PicturePaint>() {
            paint.show(self.gpu.device(), view, fit);
        }
    }

    /// Takes over the textures that are new to the panels.
    fn take_textures(&mut self, panels: &PaintedPanels) {
        for (id, deltas) in &panels.textures.set {
            for delta in deltas {
                self.painter.update_texture(self.gpu.device(), self.gpu.queue(), *id, delta);
            }
        }
    }

    /// Records the panels; returns what is to be submitted before.
    fn paint(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        panels: &PaintedPanels,
        target: &PanelTarget,
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
                view: &target.view,
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
    fn free_textures(&mut self, panels: &mut PaintedPanels) {
        for id in &panels.textures.free {
            self.painter.free_texture(id);
        }
        // The deltas insist on being taken.
        panels.textures.clear();
    }
}

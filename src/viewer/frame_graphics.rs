//! The drawing of frames, whatever they are shown on: the scene in a picture of its own, and the panels over it.

use std::sync::Arc;

use egui::{ClippedPrimitive, TextureId, TexturesDelta};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

use crate::app::ViewerApp;
use crate::frame_times::{FrameLoad, FrameTime};
use crate::opened::SceneFrame;
use crate::scene_graphics::SceneGraphics;
use sandtable_base::message::chain::error_text;
use sandtable_gpu::adapter::Gpu;
use sandtable_gpu::live::LiveOptions;
use sandtable_gpu::pass_timer::PassTimer;

/// The device, what paints the panels, and the renderer of scenes.
pub struct FrameGraphics {
    gpu: Gpu,
    painter: Renderer,
    /// `None` until there is a scene, and after its renderer failed.
    scene: Option<SceneGraphics>,
    timer: Option<Arc<PassTimer>>,
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
        let painter = Renderer::new(gpu.device(), format, options);
        Self { gpu, painter, scene: None, timer: None }
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

    /// The adapter's name and interface.
    pub fn name(&self) -> String {
        let info = self.gpu.adapter().get_info();
        format!("{} ({})", info.name, info.backend)
    }

    /// The longest side of a texture, in pixels.
    pub fn longest_side(&self) -> u32 {
        self.gpu.longest_side()
    }

    /// The scene's picture among the panels' textures; `None` where there is no scene.
    pub fn texture(&self) -> Option<TextureId> {
        self.scene.as_ref().and_then(|scene| scene.texture)
    }

    /// How many pipelines the renderer of scenes has made.
    pub fn pipelines(&self) -> usize {
        self.scene.as_ref().map_or(0, SceneGraphics::pipelines)
    }

    /// Makes the renderer of scenes. What fails is said among the panels, which stay.
    pub fn open_scene(&mut self, app: &mut ViewerApp) {
        match SceneGraphics::new(&self.gpu, self.timer.clone()) {
            Ok(scene) => {
                app.slot.fill(scene.loader());
                self.scene = Some(scene);
            }
            Err(error) => app.warn(error_text(&error)),
        }
    }

    /// Records the scene's picture. What fails is said among the panels, which stay.
    pub fn draw_scene(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &mut SceneFrame,
        app: &mut ViewerApp,
    ) -> Option<(FrameTime, FrameLoad)> {
        if self.scene.is_none() {
            self.open_scene(app);
        }
        let mut scene = self.scene.take()?;
        let options = LiveOptions { wireframe: app.shows_edges() };
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

    /// Shows a texture of the device as `known`, or as a new texture of the panels.
    pub fn show_texture(&mut self, known: Option<TextureId>, view: &wgpu::TextureView) -> TextureId {
        let filter = wgpu::FilterMode::Nearest;
        match known {
            Some(id) => {
                self.painter.update_egui_texture_from_wgpu_texture(self.gpu.device(), view, filter, id);
                id
            }
            None => self.painter.register_native_texture(self.gpu.device(), view, filter),
        }
    }

    /// Takes over the textures that are new to the panels.
    pub fn take_textures(&mut self, panels: &PaintedPanels<'_>) {
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
        panels: &PaintedPanels<'_>,
        target: PanelTarget<'_>,
    ) -> Vec<wgpu::CommandBuffer> {
        let screen = ScreenDescriptor {
            size_in_pixels: target.size.into(),
            pixels_per_point: panels.pixels_per_point,
        };
        let (device, queue) = (self.gpu.device(), self.gpu.queue());
        let commands = self.painter.update_buffers(device, queue, encoder, panels.primitives, &screen);
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
        self.painter.render(&mut pass.forget_lifetime(), panels.primitives, &screen);
        commands
    }

    /// Forgets the textures that the panels need no more.
    pub fn free_textures(&mut self, panels: &mut PaintedPanels<'_>) {
        for id in &panels.textures.free {
            self.painter.free_texture(id);
        }
        // The deltas insist on being taken.
        panels.textures.clear();
    }
}

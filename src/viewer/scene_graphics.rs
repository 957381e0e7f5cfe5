//! The scene in a texture that the panels show in the view.
//!
//! Its camera's picture is as large as the view, so that the pointer's place there is one of its pixels; the texture may have
//! fewer (`drawn_size`).

use std::sync::Arc;
use std::time::Instant;

use crate::frame_drawer::FrameDrawer;
use crate::frame_times::{FrameLoad, FrameTime};
use crate::opened::SceneFrame;
use crate::picture_paint::PictureFit;
use crate::scene_load::SceneLoad;
use sandtable_gpu::adapter::Gpu;
use sandtable_gpu::error::GpuError;
use sandtable_gpu::live::prepared::LiveLoader;
use sandtable_gpu::live::{LiveDetail, LiveOptions, LiveRenderer};
use sandtable_gpu::pass_timer::PassTimer;

/// The renderer of scenes and its picture.
pub struct SceneGraphics {
    renderer: LiveRenderer,
    /// What the panels blend: colors as they are shown.
    format: wgpu::TextureFormat,
    /// What the renderer draws to: that format, or the same texture seen as one that encodes colors.
    drawn: wgpu::TextureFormat,
    picture: Option<ScenePicture>,
}

struct ScenePicture {
    view: wgpu::TextureView,
    size: (u32, u32),
    fit: PictureFit,
}

impl SceneGraphics {
    /// A renderer of pictures of `format` on a device, whose failures from before are forgotten; `timer` times its passes.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn new(
        gpu: &Gpu,
        format: wgpu::TextureFormat,
        timer: Option<Arc<PassTimer>>,
    ) -> Result<Self, GpuError> {
        let gpu = Gpu::from_parts(gpu.adapter(), gpu.device().clone(), gpu.queue().clone());
        let flags = gpu.adapter().get_downlevel_capabilities().flags;
        let has_views = flags.contains(wgpu::DownlevelFlags::VIEW_FORMATS);
        let drawn = if has_views { format.add_srgb_suffix() } else { format };
        let mut renderer = LiveRenderer::new(&gpu, drawn)?;
        renderer.set_timer(timer);
        Ok(Self { renderer, format, drawn, picture: None })
    }

    /// How many pipelines the renderer has made.
    pub fn pipelines(&self) -> usize {
        self.renderer.pipelines()
    }

    /// The loader that prepares scenes for this renderer on other threads.
    pub fn loader(&self) -> LiveLoader {
        self.renderer.loader()
    }

    /// Hands over what changed for a frame and records its picture; returns what these took and what is shown.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn draw(
        &mut self,
        drawer: &mut FrameDrawer,
        encoder: &mut wgpu::CommandEncoder,
        frame: &mut SceneFrame,
        options: &LiveOptions,
    ) -> Result<(FrameTime, FrameLoad), GpuError> {
        let uploading = Instant::now();
        if let Some(SceneLoad { list, prepared, kept }) = frame.load.take() {
            match prepared {
                Some(prepared) => self.renderer.show(prepared, kept),
                None => self.renderer.load(&list)?,
            }
        }
        if let Some(shadows) = frame.shadows.take() {
            self.renderer.show_shadows(shadows)?;
        }
        if let Some(windows) = frame.windows.take() {
            self.renderer.show_windows(windows)?;
        }
        self.renderer.set_lighting(frame.lighting);
        let sent = self.renderer.update(&frame.changes)?;
        let upload_ms = milliseconds(uploading);
        let drawing = Instant::now();
        let size = frame.drawn;
        let fit = if size == frame.camera.size() { PictureFit::Whole } else { PictureFit::Stretched };
        let view = self.target(drawer, size, fit);
        let detail = if fit == PictureFit::Whole { LiveDetail::Whole } else { LiveDetail::Moving };
        let options = LiveOptions { detail, ..*options };
        let drawn = self.renderer.draw(encoder, &view, size, &frame.camera.resized(size), &options)?;
        let time = FrameTime { upload_ms, draw_ms: milliseconds(drawing), ..FrameTime::default() };
        let load = FrameLoad {
            ground_triangles: frame.statistics.triangles,
            patches: frame.statistics.patches,
            drawn_triangles: drawn.triangles,
            calls: drawn.calls,
            bytes: sent.total(),
            changed_patches: frame.statistics.changed_patches,
            width: size.0,
            view_width: frame.camera.size().0,
        };
        Ok((time, load))
    }

    fn target(&mut self, drawer: &mut FrameDrawer, size: (u32, u32), fit: PictureFit) -> wgpu::TextureView {
        if let Some(picture) =
            self.picture.as_ref().filter(|picture| (picture.size, picture.fit) == (size, fit))
        {
            return picture.view.clone();
        }
        let texture = drawer.gpu().device().create_texture(&wgpu::TextureDescriptor {
            label: Some("picture of the scene"),
            size: wgpu::Extent3d { width: size.0, height: size.1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[self.drawn],
        });
        let seen_as = |format| {
            texture.create_view(&wgpu::TextureViewDescriptor { format: Some(format), ..Default::default() })
        };
        drawer.show_picture(&seen_as(self.format), fit);
        let view = seen_as(self.drawn);
        self.picture = Some(ScenePicture { view: view.clone(), size, fit });
        view
    }
}

/// Milliseconds since `start`.
pub fn milliseconds(start: Instant) -> f32 {
    start.elapsed().as_secs_f32() * 1e3
}

//! Frames without a window, a display or a surface: what a window would show, on a texture, as a script goes on.
//!
//! As with a window, the adapter may be a frame behind: while it draws one, the next is made. Each frame counts the same time,
//! however long it takes, so that a script shows the same on every machine.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use egui::{Context, Pos2, RawInput, Rect};

use crate::app::{ViewerApp, ViewerStage, WindowRequest};
use crate::error::ViewerError;
use crate::frame_drawer::{AfterSending, PanelTarget};
use crate::frame_graphics::{FrameGraphics, MadeFrame};
use crate::picture_paint::blended_format;
use crate::scene_graphics::milliseconds;
use crate::script_run::{FRAME_S, ScriptRun};
use sandtable_base::message::chain::error_text;
use sandtable_editing::viewing::ViewerOptions;
use sandtable_files::disk;
use sandtable_gpu::adapter::{Gpu, GpuApi};
use sandtable_gpu::error::GpuError;
use sandtable_gpu::pass_timer::PassTimer;
use sandtable_gpu::readback::read_pixels;

/// How long the loop rests where there is nothing to draw yet.
const REST: Duration = Duration::from_millis(2);
/// How long a frame may take before the device counts as hung.
const PATIENCE: Duration = Duration::from_secs(600);

/// Draws the frames of a script, `size` pixels each, until it ends.
///
/// # Errors
/// See [`ViewerError`]: unlike a window, it fails where the file cannot be opened.
pub fn run(options: &ViewerOptions, size: (u32, u32), script: &Path) -> Result<(), ViewerError> {
    let started = Instant::now();
    let script = ScriptRun::read(script, options.frames, started)?;
    let gpu = Gpu::open(&[GpuApi::Vulkan, GpuApi::Gl]).map_err(|error| match error {
        GpuError::NoAdapter(_) => ViewerError::NoFrames(error_text(&error)),
        other => other.into(),
    })?;
    let format = blended_format(&gpu);
    let mut frames = FrameGraphics::new(gpu, format);
    let context = Context::default();
    let mut app = ViewerApp::new(options, &context);
    app.adapter = frames.name();
    app.keep_step(FRAME_S);
    let timer = frames.time_passes();
    frames.open_scene(&mut app);
    let target = FrameTarget::new(&frames, size)?;
    let mut view =
        OffscreenView { app, script, context, frames, timer, target, before: Arc::default(), shown: 0 };
    while !view.draw()? {}
    view.finish()?;
    if view.app.stage() == ViewerStage::Failed {
        return Err(ViewerError::File(view.app.failure_text().to_owned()));
    }
    if options.reports {
        view.script.print_report(&view.app.adapter);
    }
    Ok(())
}

/// A script and the texture that it draws on.
struct OffscreenView {
    app: ViewerApp,
    script: ScriptRun,
    context: Context,
    frames: FrameGraphics,
    timer: Option<Arc<PassTimer>>,
    target: FrameTarget,
    /// The commands of the frame before, which the adapter may still draw.
    before: Arc<Mutex<Option<wgpu::SubmissionIndex>>>,
    /// Frames so far.
    shown: u64,
}

/// The texture that frames are drawn on.
struct FrameTarget {
    texture: wgpu::Texture,
    panels: PanelTarget,
}

impl FrameTarget {
    fn new(frames: &FrameGraphics, size: (u32, u32)) -> Result<Self, ViewerError> {
        let ((width, height), longest) = (size, frames.longest_side());
        if width.max(height) > longest {
            return Err(ViewerError::FrameSize { width, height, longest });
        }
        let texture = frames.gpu().device().create_texture(&wgpu::TextureDescriptor {
            label: Some("frame"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: frames.format(),
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self { texture, panels: PanelTarget { view, size } })
    }
}

impl OffscreenView {
    /// Draws a frame; returns whether it was the last.
    fn draw(&mut self) -> Result<bool, ViewerError> {
        let begun = Instant::now();
        self.script.note_begin(begun);
        self.script.step(&mut self.app);
        let input = self.input();
        let MadeFrame { frame, before, requests, .. } =
            self.frames.make(&self.context, &mut self.app, input)?;
        let own_ms = milliseconds(begun) - frame.time.wait_ms;
        self.script.note_frame(&frame, before.as_ref(), own_ms);
        let has_scene = frame.scene.is_some();
        let drawn = (Some(self.target.panels.clone()), self.after_sending());
        self.frames.draw(&mut self.app, frame, drawn);
        if !has_scene {
            thread::sleep(REST);
        }
        if let Some(timer) = &self.timer {
            timer.take().iter().for_each(|passes| self.script.note_passes(passes));
        }
        self.shown += 1;
        self.carry_out(requests)
    }

    /// Waits until the adapter has drawn the frame before, once one is sent.
    fn after_sending(&self) -> AfterSending {
        let before = Arc::clone(&self.before);
        Box::new(move |gpu: &Gpu, sent| {
            let before = before.lock().unwrap_or_else(PoisonError::into_inner).replace(sent);
            before.map_or(Ok(()), |before| wait_for(gpu, before))
        })
    }

    /// Waits until the frame that was begun last is sent.
    fn finish(&mut self) -> Result<(), ViewerError> {
        let drawn = self.frames.finish(&mut self.app)?;
        drawn.iter().for_each(|drawn| self.script.note_drawn(drawn));
        Ok(())
    }

    /// Carries out what the app and the script want of a window; returns whether it is to close.
    fn carry_out(&mut self, requests: Vec<WindowRequest>) -> Result<bool, ViewerError> {
        let mut is_over = false;
        for request in requests {
            match request {
                WindowRequest::Title(_) | WindowRequest::FullScreen => {}
                WindowRequest::Resize(width, height) => {
                    self.target = FrameTarget::new(&self.frames, (width, height))?;
                }
                WindowRequest::Picture(path) => {
                    self.finish()?;
                    self.write(&path)?;
                }
                WindowRequest::Close => is_over = true,
            }
        }
        Ok(is_over)
    }

    /// Writes the frame that was drawn last.
    fn write(&mut self, path: &Path) -> Result<(), ViewerError> {
        let pixels = read_pixels(self.frames.gpu(), &self.target.texture)?;
        let files = self.app.opened.as_ref().map_or(&[][..], |opened| &opened.scene.files);
        disk::check_output(path, files)?;
        disk::write_picture(path, &pixels)?;
        Ok(())
    }

    /// What a frame's panels take in: its size and its time.
    fn input(&self) -> RawInput {
        let (width, height) = self.target.panels.size;
        RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(width as f32, height as f32))),
            max_texture_side: Some(self.frames.longest_side() as usize),
            time: Some(self.shown as f64 * FRAME_S),
            predicted_dt: FRAME_S as f32,
            ..RawInput::default()
        }
    }
}

/// Waits until the adapter has drawn a frame.
fn wait_for(gpu: &Gpu, submission: wgpu::SubmissionIndex) -> Result<(), ViewerError> {
    let wait = wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(PATIENCE) };
    let failed =
        |error: wgpu::PollError| ViewerError::Adapter { doing: "drawing a frame", cause: error.to_string() };
    gpu.device().poll(wait).map(|_| ()).map_err(failed)
}

//! Frames, whatever they are shown on: their panels and their ground are made here, and drawn on a thread of their own.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use egui::{Context, PlatformOutput, RawInput};

use crate::app::{ViewerApp, WindowRequest};
use crate::drawn_size::{DrawnSize, FramePurpose};
use crate::error::ViewerError;
use crate::frame_drawer::{AfterSending, DrawnFrame, FrameDrawer, LaidFrame, PaintedPanels, PanelTarget};
use crate::frame_thread::FrameThread;
use crate::frame_times::FrameTime;
use crate::scene_graphics::milliseconds;
use sandtable_base::message::chain::error_text;
use sandtable_gpu::adapter::Gpu;
use sandtable_gpu::live::LiveOptions;
use sandtable_gpu::pass_timer::PassTimer;
use sandtable_view::camera::Camera;

/// The device, and what draws frames with it on a thread.
pub struct FrameGraphics {
    gpu: Gpu,
    /// The thread has it while it draws.
    drawer: Arc<Mutex<FrameDrawer>>,
    thread: FrameThread,
    /// The sizes of the scene's pictures; `None` where all of them are whole.
    size: Option<DrawnSize>,
    format: wgpu::TextureFormat,
}

/// A frame that is made, and what came of the one before.
pub struct MadeFrame {
    /// What is to be drawn.
    pub frame: LaidFrame,
    /// The frame before, which was drawn meanwhile; `None` of the first.
    pub before: Option<DrawnFrame>,
    /// What the app wants of the window.
    pub requests: Vec<WindowRequest>,
    /// What the panels want of the system.
    pub platform: PlatformOutput,
}

impl FrameGraphics {
    /// Frames by a device, on textures of `format`.
    pub fn new(gpu: Gpu, format: wgpu::TextureFormat) -> Self {
        let drawer = Arc::new(Mutex::new(FrameDrawer::new(gpu.clone(), format)));
        let size = gpu.is_software().then(DrawnSize::new);
        Self { gpu, drawer, thread: FrameThread::default(), size, format }
    }

    /// Times the passes of the frames that follow, where the device has a clock.
    pub fn time_passes(&mut self) -> Option<Arc<PassTimer>> {
        let timer = PassTimer::new(&self.gpu).map(Arc::new);
        self.drawer().set_timer(timer.clone());
        timer
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

    /// Makes the renderer of scenes, where there is none. What fails is said among the panels, which stay.
    pub fn open_scene(&self, app: &mut ViewerApp) {
        match self.drawer().open_scene() {
            Ok(loader) => loader.into_iter().for_each(|loader| app.slot.fill(loader)),
            Err(error) => app.warn(error_text(&error)),
        }
    }

    /// Lays out the panels of a frame and brings its ground up to date, then waits until the frame before is drawn.
    ///
    /// # Errors
    /// Those of the frame before.
    pub fn make(
        &mut self,
        context: &Context,
        app: &mut ViewerApp,
        input: RawInput,
    ) -> Result<MadeFrame, ViewerError> {
        let laying_out = Instant::now();
        let output = context.run_ui(input, |ui| app.show(ui));
        let primitives = context.tessellate(output.shapes, output.pixels_per_point);
        let panels_ms = milliseconds(laying_out);
        let (textures, pixels_per_point) = (output.textures_delta, output.pixels_per_point);
        let panels = PaintedPanels { primitives, textures, pixels_per_point };
        let requests = app.take_requests();
        let is_kept = requests.iter().any(|request| matches!(request, WindowRequest::Picture(_)));
        let purpose = if is_kept { FramePurpose::Kept } else { FramePurpose::Shown };
        let scene = app.scene_frame(|camera| self.picture_size(camera, purpose));
        let update_ms = scene.as_ref().map_or(0.0, |frame| frame.update_ms);
        let waiting = Instant::now();
        let before = self.finish(app)?;
        let time = FrameTime { panels_ms, update_ms, wait_ms: milliseconds(waiting), ..FrameTime::default() };
        if self.size.as_ref().is_some_and(DrawnSize::is_lowered) {
            context.request_repaint();
        }
        let options = LiveOptions { wireframe: app.shows_edges(), ..LiveOptions::default() };
        let frame = LaidFrame { scene, options, panels, time };
        Ok(MadeFrame { frame, before, requests, platform: output.platform_output })
    }

    /// The size in pixels of the scene's picture of the next frame.
    fn picture_size(&mut self, camera: &Camera, purpose: FramePurpose) -> (u32, u32) {
        self.size.as_mut().map_or(camera.size(), |size| size.of_next(camera, purpose))
    }

    /// Draws a frame while the next one is made; its panels are painted on `target` and left out without one.
    pub fn draw(
        &mut self,
        app: &mut ViewerApp,
        frame: LaidFrame,
        (target, after): (Option<PanelTarget>, AfterSending),
    ) {
        if frame.scene.is_some() {
            self.open_scene(app);
            self.size.iter_mut().for_each(|size| size.note_time(frame.time.total_ms()));
        }
        let (drawer, context) = (Arc::clone(&self.drawer), app.context.clone());
        self.thread.start(move || {
            let drawn = drawer.lock().unwrap_or_else(PoisonError::into_inner).draw(frame, target, after);
            if drawn.as_ref().map_or(true, DrawnFrame::is_news) {
                context.request_repaint();
            }
            drawn
        });
    }

    /// Waits until the frame that was begun last is drawn and sent. What fails of its scene is said among the panels, which stay.
    ///
    /// # Errors
    /// What followed its sending returned.
    pub fn finish(&mut self, app: &mut ViewerApp) -> Result<Option<DrawnFrame>, ViewerError> {
        let Some(mut drawn) = self.thread.finish()? else { return Ok(None) };
        drawn.loader.take().into_iter().for_each(|loader| app.slot.fill(loader));
        if let Some(error) = &drawn.failure {
            // A renderer that failed is made anew, and takes over the scene again.
            app.warn(error_text(error));
            app.reload_scene();
        }
        if let Some((time, load)) = drawn.scene {
            app.frames.add(time, load);
        }
        Ok(Some(drawn))
    }

    fn drawer(&self) -> MutexGuard<'_, FrameDrawer> {
        self.drawer.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

//! The window itself: events in, frames out.
//!
//! It sleeps until an event, or until the panels ask for a frame; what happens on threads wakes it through `egui`'s request
//! for a repaint.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Context, ViewportId};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::error::EventLoopError;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Fullscreen, Window, WindowId};

use crate::app::{ViewerApp, WindowRequest};
use crate::error::ViewerError;
use crate::frame_graphics::MadeFrame;
use crate::graphics::{FramePresented, WindowGraphics};
use crate::scene_graphics::milliseconds;
use crate::script_run::{FRAME_S, ScriptRun};
use sandtable_editing::viewing::ViewerOptions;

/// The window's first size, in points; what fits on small screens.
const FIRST_SIZE: LogicalSize<f64> = LogicalSize::new(1280.0, 800.0);
/// Smaller than this, in points, panels cannot be read.
const LEAST_SIZE: LogicalSize<f64> = LogicalSize::new(320.0, 240.0);
/// How long a frame may be asked for ahead; beyond, the window waits for an event.
const LONGEST_WAIT: Duration = Duration::from_secs(3600);

/// What wakes the window besides events of the system.
#[derive(Debug)]
enum WindowNews {
    /// Assistive technology acts on a panel.
    Access(egui_winit::accesskit_winit::Event),
    /// The panels want a frame.
    Repaint(Duration),
}

impl From<egui_winit::accesskit_winit::Event> for WindowNews {
    fn from(event: egui_winit::accesskit_winit::Event) -> Self {
        Self::Access(event)
    }
}

/// Opens the window and runs it until it is closed.
///
/// # Errors
/// See [`ViewerError`].
pub fn run(options: &ViewerOptions) -> Result<(), ViewerError> {
    let started = Instant::now();
    let script =
        options.script.as_deref().map(|path| ScriptRun::read(path, options.frames, started)).transpose()?;
    let no_display = |error: EventLoopError| ViewerError::NoDisplay(reason(&error));
    let event_loop = EventLoop::<WindowNews>::with_user_event().build().map_err(no_display)?;
    let context = Context::default();
    let proxy = event_loop.create_proxy();
    let waker = proxy.clone();
    context.set_request_repaint_callback(move |request| {
        // A window that is closing needs no frame.
        let _ = waker.send_event(WindowNews::Repaint(request.delay));
    });
    let mut window = ViewerWindow {
        app: ViewerApp::new(options, &context),
        script,
        context,
        proxy,
        shown: None,
        due: Some(Instant::now()),
        failure: None,
    };
    if window.script.is_some() {
        window.app.keep_step(FRAME_S);
    }
    event_loop.run_app(&mut window).map_err(no_display)?;
    window.finish();
    if let Some(script) = window.script.as_ref().filter(|_| options.reports) {
        script.print_report(&window.app.adapter);
    }
    window.failure.map_or(Ok(()), Err)
}

/// What the system says, without the place in the source of `winit` that its errors begin with.
fn reason(error: &EventLoopError) -> String {
    let text = error.to_string();
    match error {
        EventLoopError::Os(_) => text
            .split_once(".rs:")
            .map_or(text.as_str(), |(_, rest)| {
                rest.trim_start_matches(|char: char| char.is_ascii_digit() || char == ':').trim()
            })
            .trim_end_matches('.')
            .to_owned(),
        _ => text,
    }
}

struct ViewerWindow {
    app: ViewerApp,
    script: Option<ScriptRun>,
    context: Context,
    proxy: EventLoopProxy<WindowNews>,
    /// `None` until the system lets windows be made.
    shown: Option<ShownWindow>,
    /// When the next frame is due; `None` for not before an event.
    due: Option<Instant>,
    failure: Option<ViewerError>,
}

struct ShownWindow {
    window: Arc<Window>,
    graphics: WindowGraphics,
    input: egui_winit::State,
}

impl ShownWindow {
    fn open(
        event_loop: &ActiveEventLoop,
        context: &Context,
        proxy: &EventLoopProxy<WindowNews>,
    ) -> Result<Self, ViewerError> {
        // Assistive technology must be connected before the window is seen.
        let attributes = Window::default_attributes()
            .with_title("sandtable")
            .with_inner_size(FIRST_SIZE)
            .with_min_inner_size(LEAST_SIZE)
            .with_visible(false);
        let window = event_loop.create_window(attributes);
        let window = Arc::new(window.map_err(|error| ViewerError::NoDisplay(error.to_string()))?);
        let mut input = egui_winit::State::new(
            context.clone(),
            ViewportId::ROOT,
            event_loop,
            Some(window.scale_factor() as f32),
            window.theme(),
            None,
        );
        input.init_accesskit(event_loop, &window, proxy.clone());
        window.set_visible(true);
        let graphics = WindowGraphics::open(event_loop, Arc::clone(&window))?;
        input.set_max_texture_side(graphics.frames.longest_side() as usize);
        Ok(Self { window, graphics, input })
    }
}

impl ApplicationHandler<WindowNews> for ViewerWindow {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.shown.is_some() {
            return;
        }
        match ShownWindow::open(event_loop, &self.context, &self.proxy) {
            Ok(shown) => {
                self.app.adapter = shown.graphics.frames.name();
                shown.graphics.frames.open_scene(&mut self.app);
                shown.window.request_redraw();
                self.shown = Some(shown);
            }
            Err(error) => self.fail(event_loop, error),
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, news: WindowNews) {
        match news {
            WindowNews::Repaint(delay) => self.wake_after(delay),
            WindowNews::Access(event) => {
                use egui_winit::accesskit_winit::WindowEvent as Access;
                match (event.window_event, &mut self.shown) {
                    (Access::InitialTreeRequested, _) => self.context.enable_accesskit(),
                    (Access::AccessibilityDeactivated, _) => self.context.disable_accesskit(),
                    (Access::ActionRequested(request), Some(shown)) => {
                        shown.input.on_accesskit_action_request(request);
                    }
                    (Access::ActionRequested(_), None) => {}
                }
                self.wake_after(Duration::ZERO);
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(shown) = &mut self.shown else { return };
        let response = shown.input.on_window_event(&shown.window, &event);
        match event {
            WindowEvent::CloseRequested => self.app.ask_to_close(),
            WindowEvent::Resized(size) => {
                let drawn = shown.graphics.resize((size.width, size.height), &mut self.app);
                self.script.iter_mut().zip(&drawn).for_each(|(script, drawn)| script.note_drawn(drawn));
            }
            WindowEvent::RedrawRequested => {
                self.due = None;
                if let Err(error) = self.draw(event_loop) {
                    self.fail(event_loop, error);
                }
                return;
            }
            _ if !response.repaint => return,
            _ => {}
        }
        self.wake_after(Duration::ZERO);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        match self.due {
            Some(due) if due <= now => {
                self.due = None;
                if let Some(shown) = &self.shown {
                    shown.window.request_redraw();
                }
                event_loop.set_control_flow(ControlFlow::Wait);
            }
            Some(due) => event_loop.set_control_flow(ControlFlow::WaitUntil(due)),
            None => event_loop.set_control_flow(ControlFlow::Wait),
        }
    }
}

impl ViewerWindow {
    /// Waits for the last frame.
    fn finish(&mut self) {
        let Some(shown) = &mut self.shown else { return };
        match shown.graphics.frames.finish(&mut self.app) {
            Ok(drawn) => {
                self.script.iter_mut().zip(&drawn).for_each(|(script, drawn)| script.note_drawn(drawn))
            }
            Err(error) => _ = self.failure.get_or_insert(error),
        }
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, error: ViewerError) {
        self.failure.get_or_insert(error);
        event_loop.exit();
    }

    /// Asks for a frame after `delay`, or before where one is due earlier.
    fn wake_after(&mut self, delay: Duration) {
        if delay < LONGEST_WAIT {
            let due = Instant::now() + delay;
            self.due = Some(self.due.map_or(due, |earlier| earlier.min(due)));
        }
    }

    fn draw(&mut self, event_loop: &ActiveEventLoop) -> Result<(), ViewerError> {
        let begun = Instant::now();
        let Some(shown) = &mut self.shown else { return Ok(()) };
        let size = shown.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return Ok(());
        }
        if let Some(script) = &mut self.script {
            script.note_begin(begun);
            script.step(&mut self.app);
            self.context.request_repaint();
        }
        let input = shown.input.take_egui_input(&shown.window);
        let MadeFrame { mut frame, before, requests, platform } =
            shown.graphics.frames.make(&self.context, &mut self.app, input)?;
        shown.input.handle_platform_output(&shown.window, platform);
        let acquiring = Instant::now();
        let (presented, surface) = shown.graphics.acquire()?;
        frame.time.wait_ms += milliseconds(acquiring);
        let own_ms = milliseconds(begun) - frame.time.wait_ms;
        if let Some(script) = &mut self.script {
            script.note_frame(&frame, before.as_ref(), own_ms);
        }
        shown.graphics.present(&mut self.app, frame, surface);
        for request in requests {
            match request {
                WindowRequest::Title(title) => shown.window.set_title(&title),
                WindowRequest::FullScreen => {
                    let is_full = shown.window.fullscreen().is_some();
                    shown.window.set_fullscreen((!is_full).then_some(Fullscreen::Borderless(None)));
                }
                WindowRequest::Resize(width, height) => {
                    // What the system grants arrives as an event.
                    let _ = shown.window.request_inner_size(PhysicalSize::new(width, height));
                }
                WindowRequest::Picture(path) => {
                    let name = path.display();
                    let text = format!(
                        "{name}: a window does not write its frames; add --offscreen, or draw a `snapshot`"
                    );
                    self.app.warn(text);
                }
                WindowRequest::Close => event_loop.exit(),
            }
        }
        if presented == FramePresented::Again {
            self.wake_after(Duration::ZERO);
        }
        Ok(())
    }
}

//! All of the window but its surface: what is open, what is shown, what the user asked for.

use std::path::{Path, PathBuf};

use egui::{Align2, CentralPanel, Context, Frame, Panel, RichText, Ui, Window};

use crate::pipeline::files;
use crate::pipeline::viewing::ViewerOptions;
use crate::scene::SceneModel;
use crate::viewer::commands::{ViewCommand, key_text, pressed};
use crate::viewer::loading::SceneLoading;
use crate::viewer::panels::help::help_panel;
use crate::viewer::panels::open::{OpenPanel, open_panel};
use crate::viewer::recent::RecentFiles;

/// What the window has to do for the app.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WindowRequest {
    /// Shows this title.
    Title(String),
    /// Fills the screen, or not any more.
    FullScreen,
    /// Takes this size, in pixels.
    Resize(u32, u32),
    /// Closes.
    Close,
}

/// What the middle of the window shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewerStage {
    /// Nothing is open.
    Empty,
    /// A first file is being opened.
    Loading,
    /// A scene is shown; another may be on its way.
    Ready,
    /// The file cannot be opened, and there is no scene from before.
    Failed,
}

/// A file that could not be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
struct OpeningFailure {
    path: PathBuf,
    message: String,
}

/// An open scene.
struct OpenedScene {
    path: PathBuf,
    scene: Box<SceneModel>,
}

/// The window's state.
pub struct ViewerApp {
    /// The adapter's name.
    pub adapter: String,
    options: ViewerOptions,
    context: Context,
    recent: RecentFiles,
    open_panel: OpenPanel,
    shows_open: bool,
    shows_help: bool,
    loading: Option<SceneLoading>,
    opened: Option<OpenedScene>,
    failure: Option<OpeningFailure>,
    requests: Vec<WindowRequest>,
}

impl ViewerApp {
    /// The state of a window that begins with the file of `options`.
    pub fn new(options: &ViewerOptions, context: &Context) -> Self {
        Self::with_recent(options, context, RecentFiles::of_user())
    }

    fn with_recent(options: &ViewerOptions, context: &Context, recent: RecentFiles) -> Self {
        let folder =
            options.file.as_deref().and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
        let mut app = Self {
            adapter: String::new(),
            options: options.clone(),
            context: context.clone(),
            recent,
            open_panel: OpenPanel::at(folder.unwrap_or(Path::new("."))),
            shows_open: options.file.is_none(),
            shows_help: false,
            loading: None,
            opened: None,
            failure: None,
            requests: Vec::new(),
        };
        if let Some(file) = &options.file {
            app.open(file);
        }
        app
    }

    /// What the middle of the window shows.
    pub fn stage(&self) -> ViewerStage {
        match (&self.opened, &self.loading, &self.failure) {
            (Some(_), _, _) => ViewerStage::Ready,
            (None, Some(_), _) => ViewerStage::Loading,
            (None, None, Some(_)) => ViewerStage::Failed,
            (None, None, None) => ViewerStage::Empty,
        }
    }

    /// What the window has to do since this was called last.
    pub fn take_requests(&mut self) -> Vec<WindowRequest> {
        std::mem::take(&mut self.requests)
    }

    /// The user closes the window.
    pub fn ask_to_close(&mut self) {
        self.requests.push(WindowRequest::Close);
    }

    fn open(&mut self, path: &Path) {
        let context = self.context.clone();
        let wake = move || context.request_repaint();
        self.loading = Some(SceneLoading::start(path, &self.options.allowed, wake));
        self.failure = None;
        self.shows_open = false;
    }

    /// Draws the window of one frame.
    pub fn show(&mut self, ui: &mut Ui) {
        self.follow_loading();
        let is_typing = ui.ctx().text_edit_focused();
        if !is_typing {
            let commands = ui.input_mut(pressed);
            commands.into_iter().for_each(|command| self.run(command));
        }
        self.show_menu(ui);
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| self.show_middle(ui));
        self.show_windows(ui.ctx());
    }

    fn follow_loading(&mut self) {
        let Some(loading) = &mut self.loading else { return };
        let Some(result) = loading.poll() else { return };
        let path = loading.path.clone();
        self.loading = None;
        match result {
            Ok(scene) => {
                self.recent.add(&path);
                self.requests.push(WindowRequest::Title(format!("{} · sandtable", files::file_name(&path))));
                self.opened = Some(OpenedScene { path, scene });
            }
            Err(message) => self.failure = Some(OpeningFailure { path, message }),
        }
    }

    fn run(&mut self, command: ViewCommand) {
        match command {
            ViewCommand::Help => self.shows_help = !self.shows_help,
            ViewCommand::Open => self.shows_open = true,
            ViewCommand::Cancel => (self.shows_help, self.shows_open) = (false, false),
            ViewCommand::FullScreen => self.requests.push(WindowRequest::FullScreen),
            ViewCommand::Quit => self.ask_to_close(),
            _ => {}
        }
    }

    fn show_menu(&mut self, ui: &mut Ui) {
        Panel::top("menu").show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for (text, command) in [("Open", ViewCommand::Open), ("Keys", ViewCommand::Help)] {
                    let button = ui.button(text).on_hover_text(key_text(command));
                    if button.clicked() {
                        self.run(command);
                    }
                }
                if let Some(loading) = &self.loading {
                    ui.spinner();
                    ui.label(format!("{}: {}", files::file_name(&loading.path), loading.step));
                }
            });
        });
    }

    fn show_middle(&mut self, ui: &mut Ui) {
        match self.stage() {
            ViewerStage::Empty => {
                ui.centered_and_justified(|ui| ui.label("Nothing is open."));
            }
            ViewerStage::Loading => {
                if let Some(loading) = &self.loading {
                    let seconds = loading.since.elapsed().as_secs();
                    let text = format!("Opening {} …\n{}, {seconds} s", loading.path.display(), loading.step);
                    ui.centered_and_justified(|ui| ui.label(RichText::new(text).size(18.0)));
                }
            }
            ViewerStage::Failed => {
                if let Some(failure) = &self.failure {
                    ui.vertical_centered(|ui| {
                        ui.add_space(40.0);
                        ui.heading(format!("{} cannot be opened", failure.path.display()));
                        ui.monospace(&failure.message);
                    });
                }
            }
            ViewerStage::Ready => {
                if let Some(opened) = &self.opened {
                    ui.label(format!("{} {}", opened.path.display(), opened.scene.features.len()));
                }
            }
        }
    }

    fn show_windows(&mut self, context: &Context) {
        let mut shows_help = self.shows_help;
        Window::new("Keys")
            .open(&mut shows_help)
            .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
            .show(context, help_panel);
        self.shows_help = shows_help;
        let mut shows_open = self.shows_open;
        let window = Window::new("Open").open(&mut shows_open).default_size([560.0, 460.0]);
        let window = window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]);
        let chosen = window.show(context, |ui| open_panel(ui, &mut self.open_panel, &self.recent));
        self.shows_open = shows_open;
        if let Some(path) = chosen.and_then(|window| window.inner).flatten() {
            self.open(&path);
        }
    }
}

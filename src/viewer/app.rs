//! All of the window but its surface: what is open, what is shown, what the user asked for.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};
use std::time::Instant;

use egui::{CentralPanel, Context, Frame, TextureId, Ui};
use glam::{DVec2, Vec2};

use crate::draw::list::FeatureId;
use crate::pipeline::files;
use crate::pipeline::picture::PictureSize;
use crate::pipeline::view_snapshot::{self, ViewSnapshot};
use crate::pipeline::viewing::{ViewedHeights, ViewerOptions};
use crate::view::navigation::pose::{ViewPose, wrapped};
use crate::view::navigation::{NavigationMode, TRANSITION_S};
use crate::viewer::commands::{ViewCommand, pressed};
use crate::viewer::drawing_job::DrawingJob;
use crate::viewer::frame_times::FrameTimes;
use crate::viewer::loading::{SceneLoading, opening_error};
use crate::viewer::notices::ViewerNotices;
use crate::viewer::opened::{OpenedScene, SceneFrame};
use crate::viewer::panels::detail::DetailSettings;
use crate::viewer::panels::light::LightPanel;
use crate::viewer::panels::open::OpenPanel;
use crate::viewer::panels::tree::TreePanel;
use crate::viewer::place::PlaceText;
use crate::viewer::recent::RecentFiles;
use crate::viewer::view_area::{ViewArea, ViewEvent};
use crate::viewer::watch::{FileWatch, WatchState};

/// What the window has to do for the app.
#[derive(Clone, Debug, PartialEq)]
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
pub(super) struct OpeningFailure {
    pub path: PathBuf,
    pub message: String,
}

/// What was clicked at.
#[derive(Clone, Debug, PartialEq)]
pub struct PickedText {
    /// The kind and the name of the feature; of bare ground, `ground`.
    pub feature: String,
    /// The place on the ground; `None` for the sky.
    pub place: Option<PlaceText>,
}

/// The window's state.
pub struct ViewerApp {
    /// The adapter's name.
    pub adapter: String,
    /// How long frames took.
    pub frames: FrameTimes,
    pub(super) options: ViewerOptions,
    context: Context,
    pub(super) recent: RecentFiles,
    pub(super) open_panel: OpenPanel,
    pub(super) shows_open: bool,
    pub(super) shows_help: bool,
    pub(super) shows_panels: bool,
    pub(super) loading: Option<SceneLoading>,
    pub(super) opened: Option<Box<OpenedScene>>,
    pub(super) failure: Option<OpeningFailure>,
    pub(super) notices: ViewerNotices,
    pub(super) view: ViewArea,
    pub(super) tree: TreePanel,
    pub(super) light: LightPanel,
    pub(super) detail: DetailSettings,
    pub(super) picked: Option<PickedText>,
    pub(super) drawing: Option<DrawingJob>,
    camera_number: usize,
    heights: ViewedHeights,
    watch: Option<FileWatch>,
    requests: Vec<WindowRequest>,
}

impl ViewerApp {
    /// The state of a window that begins with the file of `options`.
    pub fn new(options: &ViewerOptions, context: &Context) -> Self {
        Self::with_recent(options, context, RecentFiles::of_user())
    }

    fn with_recent(options: &ViewerOptions, context: &Context, recent: RecentFiles) -> Self {
        let folder = options.file.as_deref().and_then(Path::parent);
        let folder = folder.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut app = Self {
            adapter: String::new(),
            frames: FrameTimes::default(),
            options: options.clone(),
            context: context.clone(),
            recent,
            open_panel: OpenPanel::at(folder),
            shows_open: options.file.is_none(),
            shows_help: false,
            shows_panels: true,
            loading: None,
            opened: None,
            failure: None,
            notices: ViewerNotices::default(),
            view: ViewArea::new(),
            tree: TreePanel::default(),
            light: LightPanel::default(),
            detail: DetailSettings { tolerance_px: 1.0, wireframe: false, frozen: false },
            picked: None,
            drawing: None,
            camera_number: 0,
            heights: ViewedHeights::AsStated,
            watch: None,
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

    /// What the scene's renderer has to draw; `None` where there is no scene, or its camera sees nothing.
    pub fn scene_frame(&mut self) -> Option<SceneFrame> {
        let opened = self.opened.as_mut().filter(|_| self.view.size.0 > 0)?;
        match opened.frame(self.view.size) {
            Ok(frame) => {
                self.view.camera = Some(frame.camera);
                Some(frame)
            }
            Err(error) => {
                self.notices.warn(opening_error(&error));
                None
            }
        }
    }

    /// Whether the renderer outlines triangles.
    pub fn shows_edges(&self) -> bool {
        self.detail.wireframe
    }

    /// The renderer lost the scene: it takes over all of it again.
    pub fn reload_scene(&mut self) {
        if let Some(opened) = &mut self.opened {
            opened.reload();
        }
    }

    /// Says something that went wrong in the window.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.notices.warn(text);
    }

    /// The user closes the window.
    pub fn ask_to_close(&mut self) {
        self.requests.push(WindowRequest::Close);
    }

    /// Opens a file; the scene from before stays until it is there.
    pub fn open(&mut self, path: &Path) {
        self.heights = ViewedHeights::AsStated;
        self.start_loading(path);
    }

    fn start_loading(&mut self, path: &Path) {
        let context = self.context.clone();
        let wake = move || context.request_repaint();
        self.loading = Some(SceneLoading::start(path, &self.options.allowed, self.heights, wake));
        self.failure = None;
        self.shows_open = false;
    }

    /// Draws the window of one frame; `texture` is the scene's picture.
    pub fn show(&mut self, ui: &mut Ui, texture: Option<TextureId>) {
        self.follow_loading(ui);
        self.follow_drawing(ui);
        self.follow_files(ui);
        if !ui.ctx().text_edit_focused() {
            let commands = ui.input_mut(pressed);
            commands.into_iter().for_each(|command| self.run(command, ui));
        }
        self.show_menu(ui);
        self.show_status(ui);
        self.show_sides(ui);
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
            self.show_middle(ui, texture);
            self.notices.show(ui);
        });
        self.show_windows(ui.ctx());
    }

    fn follow_loading(&mut self, ui: &Ui) {
        let Some(loading) = &mut self.loading else { return };
        let Some(result) = loading.poll() else { return };
        let path = loading.path.clone();
        self.loading = None;
        match result {
            Ok(opened) => self.take_over(path, opened, ui),
            // The last good scene stays, and the error with it.
            Err(message) if self.opened.is_some() => {
                self.notices.warn(format!("{} cannot be opened:\n{message}", files::file_name(&path)));
            }
            Err(message) => self.failure = Some(OpeningFailure { path, message }),
        }
    }

    /// Shows a scene; the camera stays where the same file was shown before.
    fn take_over(&mut self, path: PathBuf, mut opened: Box<OpenedScene>, ui: &Ui) {
        self.notices.clear();
        self.recent.add(&path);
        self.requests.push(WindowRequest::Title(format!("{} · sandtable", files::file_name(&path))));
        match self.opened.as_ref().filter(|before| before.path == path) {
            Some(before) => {
                let mut pose = before.navigator.pose();
                pose.eye.z *= f64::from(opened.scene.scale.0 / before.scene.scale.0);
                opened.navigator.set_mode(before.navigator.mode());
                opened.navigator.place(pose, &|_| None);
                opened.fov_y_rad = before.fov_y_rad;
                let is_there =
                    |id: &FeatureId| id.index().is_some_and(|index| index < opened.scene.features.len());
                self.tree.hidden.retain(is_there);
                if !self.tree.hidden.is_empty() {
                    opened.hide(&self.tree.hidden);
                }
                self.notices.tell(ui.input(|input| input.time), "read again");
            }
            None => {
                self.camera_number = 0;
                self.tree = TreePanel::default();
                self.picked = None;
            }
        }
        self.detail.tolerance_px = opened.walk.tolerance_px();
        self.detail.frozen = false;
        self.light = LightPanel::new(opened.walk.to_sun(), f64::from(opened.scene.scale.0));
        let context = self.context.clone();
        let watched: Vec<PathBuf> = opened.scene.files.iter().cloned().chain([path]).collect();
        self.watch = FileWatch::start(&watched, move || context.request_repaint());
        self.opened = Some(opened);
    }

    fn follow_files(&mut self, ui: &Ui) {
        let Some(watch) = &mut self.watch else { return };
        match watch.poll(Instant::now()) {
            WatchState::Unchanged => {}
            WatchState::Changing(rest) => ui.ctx().request_repaint_after(rest),
            WatchState::Changed => self.reload(),
        }
    }

    fn reload(&mut self) {
        let opened = self.opened.as_ref().map(|opened| opened.path.clone());
        let failed = self.failure.as_ref().map(|failure| failure.path.clone());
        if let Some(path) = opened.or(failed) {
            self.start_loading(&path);
        }
    }

    /// Draws heights another number of times as high: the scene is made anew.
    pub(super) fn exaggerate(&mut self, factor: f64) {
        self.heights = ViewedHeights::Times(factor);
        self.reload();
    }

    fn follow_drawing(&mut self, ui: &Ui) {
        let Some(result) = self.drawing.as_ref().and_then(DrawingJob::poll) else { return };
        let Some(drawing) = self.drawing.take() else { return };
        match result {
            Ok(path) => {
                let ViewSnapshot { name, camera, size, .. } = drawing.snapshot;
                let PictureSize { width, height } = size;
                let text = format!(
                    "{} is the picture of this camera; its table is copied. `sandtable render --camera {name} --size \
                     {width}x{height}` draws it again once the table is in the scene file:",
                    path.display()
                );
                self.notices.tell_with_text(text, camera);
            }
            Err(error) => self.notices.warn(error),
        }
        ui.ctx().request_repaint();
    }

    fn take_snapshot(&mut self, ui: &Ui) {
        let Some((opened, camera)) = self.opened.as_ref().zip(self.view.camera) else { return };
        if self.drawing.is_some() {
            self.notices.tell(ui.input(|input| input.time), "the picture before is still being drawn");
            return;
        }
        let (width, height) = camera.size();
        let snapshot = || -> Result<ViewSnapshot, String> {
            let told = |error: view_snapshot::ViewSnapshotError| opening_error(&error);
            let name = view_snapshot::free_name(&opened.scene, &opened.path).map_err(told)?;
            let camera = view_snapshot::camera_table(&opened.scene, &camera, &name).map_err(told)?;
            let text = view_snapshot::scene_text(&opened.path).map_err(|error| opening_error(&error))?;
            let size = PictureSize { width: width.clamp(16, 16_384), height: height.clamp(16, 16_384) };
            let (file, allowed) = (opened.path.clone(), self.options.allowed.clone());
            Ok(ViewSnapshot { file, text, allowed, name, camera, size })
        };
        match snapshot() {
            Ok(snapshot) => {
                ui.ctx().copy_text(snapshot.camera.clone());
                let context = self.context.clone();
                self.drawing = Some(DrawingJob::start(snapshot, move || context.request_repaint()));
            }
            Err(error) => self.notices.warn(error),
        }
    }

    fn pick(&mut self, pixel: Vec2) {
        let Some((opened, camera)) = self.opened.as_ref().zip(self.view.camera) else { return };
        self.picked = Some(match opened.pick(&camera, pixel) {
            Some(pick) => PickedText {
                feature: feature_text(opened, pick.place.feature),
                place: Some(PlaceText::of(&opened.scene, &pick)),
            },
            None => PickedText { feature: "sky".to_owned(), place: None },
        });
    }

    /// Carries out a command.
    pub(super) fn run(&mut self, command: ViewCommand, ui: &Ui) {
        match command {
            ViewCommand::Help => self.shows_help = !self.shows_help,
            ViewCommand::Open => self.shows_open = true,
            ViewCommand::Cancel => {
                (self.shows_help, self.shows_open) = (false, false);
                self.notices.clear();
            }
            ViewCommand::FullScreen => self.requests.push(WindowRequest::FullScreen),
            ViewCommand::Quit => self.ask_to_close(),
            ViewCommand::Reload => self.reload(),
            ViewCommand::Panels => self.shows_panels = !self.shows_panels,
            ViewCommand::Labels => self.view.shows_labels = !self.view.shows_labels,
            ViewCommand::Wireframe => self.detail.wireframe = !self.detail.wireframe,
            ViewCommand::Freeze => self.set_frozen(!self.detail.frozen),
            ViewCommand::Find => (self.shows_panels, self.tree.focuses_find) = (true, true),
            ViewCommand::Snapshot => self.take_snapshot(ui),
            ViewCommand::Home => self.go_to_camera(0),
            ViewCommand::NextCamera => self.go_to_camera(self.camera_number + 1),
            ViewCommand::PreviousCamera => self.go_to_camera(self.camera_number + usize::MAX),
            ViewCommand::Orbit => self.set_mode(NavigationMode::Orbit),
            ViewCommand::Fly => self.set_mode(NavigationMode::Flight),
            ViewCommand::Walk => self.set_mode(NavigationMode::OnFoot),
            ViewCommand::North => self.look(Some(0.0), None),
            ViewCommand::Down => self.look(None, Some(-FRAC_PI_2)),
            ViewCommand::Save
            | ViewCommand::Undo
            | ViewCommand::Redo
            | ViewCommand::MeasureLine
            | ViewCommand::MeasureArea => {}
        }
        ui.ctx().request_repaint();
    }

    pub(super) fn set_mode(&mut self, mode: NavigationMode) {
        if let Some(opened) = &mut self.opened {
            opened.navigator.set_mode(mode);
        }
    }

    pub(super) fn set_frozen(&mut self, frozen: bool) {
        self.detail.frozen = frozen;
        if let Some(opened) = &mut self.opened {
            opened.frozen = frozen.then_some(opened.navigator.pose());
        }
    }

    /// Goes to a camera of the scene by its number, counted round.
    pub(super) fn go_to_camera(&mut self, number: usize) {
        let Some(opened) = &mut self.opened else { return };
        let count = opened.scene.cameras.len();
        self.camera_number = if number > usize::MAX / 2 { count - 1 } else { number % count };
        let view = opened.scene.cameras[self.camera_number].clone();
        let size = (self.view.size.0.max(16), self.view.size.1.max(16));
        if let Err(error) = opened.go_to_view(&view, size) {
            self.notices.warn(opening_error(&error));
        }
    }

    /// Looks in a direction, about the place in the middle of the picture.
    fn look(&mut self, azimuth_rad: Option<f64>, pitch_rad: Option<f64>) {
        let Some((opened, camera)) = self.opened.as_mut().zip(self.view.camera) else { return };
        let pivot = opened.focus(&camera);
        let before = opened.navigator.pose();
        let pitch = pitch_rad.map_or(0.0, |pitch| pitch - before.pitch_rad);
        let turn =
            DVec2::new(azimuth_rad.map_or(0.0, |azimuth| wrapped(azimuth - before.azimuth_rad)), pitch);
        let after = before.turned(turn);
        let eye = pivot + after.from_frame(before.to_frame(before.eye - pivot));
        opened.navigator.go_to(ViewPose { eye, ..after }, TRANSITION_S);
    }

    pub(super) fn note_view_event(&mut self, event: ViewEvent) {
        match event {
            ViewEvent::Pick(pixel) => self.pick(pixel),
        }
    }
}

/// A feature by kind and name.
fn feature_text(opened: &OpenedScene, feature: FeatureId) -> String {
    let known = feature.index().and_then(|index| opened.scene.features.get(index));
    match known {
        Some(feature) if feature.name.is_empty() => feature.kind.noun(1).to_owned(),
        Some(feature) => format!("{} {}", feature.kind.noun(1), feature.name),
        None if feature == FeatureId::GROUND => "ground".to_owned(),
        None => "the side of the block".to_owned(),
    }
}
